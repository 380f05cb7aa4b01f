#!/usr/bin/env python3
"""A scene as Drake (pip install drake) solves it; untested here.

    dlo suite --with drake='python3 drake_rod.py {scene} {points} {shape}'

Rigid links with ball joints and springs linear in roll, pitch and yaw, an element's length apart, EI/h and 2 EI/h
at the clamp. Damped until it rests."""

import sys

import cantilever
import numpy
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.multibody.tree import BallRpyJoint, FixedOffsetFrame, LinearBushingRollPitchYaw, SpatialInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

rod = cantilever.read(sys.argv[1], sys.argv[2])
if rod.loads:
    cantilever.refuse("loads")
builder = DiagramBuilder()
plant, _ = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
plant.mutable_gravity_field().set_gravity_vector(rod.gravity)
turn = RotationMatrix.MakeFromOneVector(numpy.array(rod.direction), 0)
before = plant.AddFrame(FixedOffsetFrame("clamp", plant.world_frame(), RigidTransform(turn, rod.origin)))
links, slow = [], rod.length**2 * (rod.m / rod.EI) ** 0.5
for i in range(rod.n):
    # Thick enough that its own axis has a moment of inertia.
    inertia = SpatialInertia.SolidCylinderWithMass(rod.m * rod.h, 0.1 * rod.h, rod.h, [1, 0, 0])
    link = plant.AddRigidBody(f"link{i}", inertia)
    start = plant.AddFrame(FixedOffsetFrame(f"start{i}", link.body_frame(), RigidTransform([-rod.h / 2, 0, 0])))
    plant.AddJoint(BallRpyJoint(f"joint{i}", before, start, damping=0.1 * rod.EI / rod.h * slow))
    k = rod.EI / rod.h * (2 if i == 0 else 1)
    plant.AddForceElement(LinearBushingRollPitchYaw(
        before, start, [rod.GJ / rod.h * k / (rod.EI / rod.h), k, k], numpy.zeros(3), numpy.zeros(3), numpy.zeros(3)))
    before = plant.AddFrame(FixedOffsetFrame(f"end{i}", link.body_frame(), RigidTransform([rod.h / 2, 0, 0])))
    links.append(before)
plant.Finalize()
simulator = Simulator(builder.Build())
simulator.AdvanceTo(30 * slow)
context = plant.GetMyContextFromRoot(simulator.get_context())
cantilever.write(sys.argv[3], [rod.origin, *(end.CalcPoseInWorld(context).translation() for end in links)])
