#!/usr/bin/env python3
"""A scene as SOFA (https://www.sofa-framework.org, SofaPython3) solves it; untested here.

    dlo suite --with sofa='python3 sofa_rod.py {scene} {points} {shape}'

Beam elements with corotational large rotations (BeamFEMForceField), one static solution at a time."""

import sys

import cantilever
import Sofa
import Sofa.Core
import Sofa.Simulation
import SofaRuntime

rod = cantilever.read(sys.argv[1], sys.argv[2])
E = rod.EI / (3.14159265358979 * rod.radius**4 / 4)
nu = rod.EI / rod.GJ - 1
d = rod.direction  # the beams' x axis, rotated the shortest way
w = ((1 + d[0]) / 2) ** 0.5
turn = [0.0, -d[2] / (2 * w), d[1] / (2 * w), w] if w > 1e-6 else [0.0, 0.0, 1.0, 0.0]
SofaRuntime.importPlugin("Sofa.Component")
root = Sofa.Core.Node("root")
root.gravity = rod.gravity
root.dt = 1e-2
root.addObject("DefaultAnimationLoop")
beam = root.addChild("beam")
beam.addObject("EulerImplicitSolver", rayleighStiffness=0.1, rayleighMass=1.0)
beam.addObject("BTDLinearSolver", template="BTDMatrix6d", verbose=False)
beam.addObject("MeshTopology", lines=[[i, i + 1] for i in range(rod.n)],
               position=[[*node] for node in cantilever.straight(rod)])
state = beam.addObject("MechanicalObject", template="Rigid3d",
                       position=[[*node, *turn] for node in cantilever.straight(rod)])
beam.addObject("UniformMass", totalMass=rod.m * rod.length)
beam.addObject("BeamFEMForceField", radius=rod.radius, youngModulus=E, poissonRatio=nu)
beam.addObject("FixedConstraint", indices=[0])
for node, force in rod.loads:
    beam.addObject("ConstantForceField", indices=[node], forces=[[*force, 0, 0, 0]])
Sofa.Simulation.init(root)
for _ in range(5000):
    Sofa.Simulation.animate(root, root.dt.value)
cantilever.write(sys.argv[3], [row[:3] for row in state.position.value])
