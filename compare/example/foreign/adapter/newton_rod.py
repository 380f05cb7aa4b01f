#!/usr/bin/env python3
"""A scene as Newton (pip install newton-physics, on Warp) solves it; untested here.

    dlo suite --with newton='python3 newton_rod.py {scene} {points} {shape}'

A cable of its model builder: capsules joined by cable joints, whose bend stiffness is given by joint. Its
first body is held, so that the first element does not bend: the results table reports this."""

import sys

import cantilever
import newton
import warp

rod = cantilever.read(sys.argv[1], sys.argv[2])
if rod.loads:
    cantilever.refuse("loads")
g = sum(x * x for x in rod.gravity) ** 0.5
if g == 0:
    cantilever.refuse("no gravity")
builder = newton.ModelBuilder(up_axis=newton.Axis.Y, gravity=-g)
if rod.gravity[1] != -g:
    cantilever.refuse("gravity other than along -y")
nodes = [warp.vec3(*node) for node in cantilever.straight(rod)]
turn = warp.quat_between_vectors(warp.vec3(0.0, 0.0, 1.0), warp.vec3(*rod.direction))
radius = 0.1 * rod.h
# Only weight bends it: the capsules' own density makes it, their caps with it.
builder.default_shape_cfg.density = rod.m / (3.14159265 * radius**2)
bodies, _ = builder.add_rod(
    positions=nodes, quaternions=[turn] * rod.n, radius=radius,
    bend_stiffness=rod.EI / rod.h, bend_damping=0.1, stretch_stiffness=rod.EA / rod.h, stretch_damping=0.0)
builder.body_mass[bodies[0]], builder.body_inv_mass[bodies[0]] = 0.0, 0.0
builder.body_inv_inertia[bodies[0]] = warp.mat33(0.0)
builder.color()
model = builder.finalize()
solver = newton.solvers.SolverVBD(model, iterations=20)
state, after, control = model.state(), model.state(), model.control()
for _ in range(20000):
    state.clear_forces()
    solver.step(state, after, control, None, 1 / 600)
    state, after = after, state
poses = [warp.transform(*pose) for pose in state.body_q.numpy()[bodies]]
ends = [warp.transform_point(pose, warp.vec3(0.0, 0.0, rod.h)) for pose in poses]
cantilever.write(sys.argv[3], [rod.origin, *ends])
