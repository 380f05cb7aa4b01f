#!/usr/bin/env python3
"""A scene as DisMech's Python (pip install dismech-python) solves it; untested here.

    dlo suite --with dismech='python3 dismech_rod.py {scene} {points} {shape}'

Discrete elastic rods. Two nodes and the edge between them are held: the first element does not bend."""

import sys

import cantilever
import dismech
import numpy

rod = cantilever.read(sys.argv[1], sys.argv[2])
if rod.loads:
    cantilever.refuse("loads")
area = numpy.pi * rod.radius**2
E = rod.EI / (numpy.pi * rod.radius**4 / 4)
nodes = numpy.array(cantilever.straight(rod))
edges = numpy.array([[i, i + 1] for i in range(rod.n)])
geometry = dismech.Geometry(nodes, edges, numpy.empty((0, 3), dtype=int))
material = dismech.Material(
    density=rod.m / area, youngs_rod=E, youngs_shell=0, poisson_rod=E * area * rod.radius**2 / 4 / rod.GJ - 1,
    poisson_shell=0.5)
options = dismech.SimParams(
    static_sim=True, two_d_sim=False, use_mid_edge=False, use_line_search=True, show_floor=False, log_data=True,
    log_step=1, dt=1e-2, max_iter=50, total_time=1.0, plot_step=1, tol=1e-6, ftol=1e-6, dtol=1e-9)
environment = dismech.Environment()
environment.add_force("gravity", g=numpy.array(rod.gravity))
robot = dismech.SoftRobot(dismech.GeomParams(rod_r0=rod.radius, shell_h=0), material, geometry, options, environment)
robot = robot.fix_nodes(numpy.array([0, 1]))
stepper = dismech.ImplicitEulerTimeStepper(robot)
robots = stepper.simulate(robot)
cantilever.write(sys.argv[3], robots[-1].state.q[: 3 * (rod.n + 1)].reshape(-1, 3))
