#!/usr/bin/env python3
"""A scene as Project Chrono (https://projectchrono.org, PyChrono) solves it; untested here.

    dlo suite --with chrono='python3 chrono_rod.py {scene} {points} {shape}'

Beam elements of Euler and Bernoulli in a corotated frame; nonlinear statics."""

import sys

import cantilever
import pychrono as chrono
import pychrono.fea as fea
import pychrono.pardisomkl as mkl

rod = cantilever.read(sys.argv[1], sys.argv[2])
system = chrono.ChSystemSMC()
system.SetGravitationalAcceleration(chrono.ChVector3d(*rod.gravity))
mesh = fea.ChMesh()
section = fea.ChBeamSectionEulerAdvancedGeneric()
section.SetAxialRigidity(rod.EA)
section.SetXtorsionRigidity(rod.GJ)
section.SetYbendingRigidity(rod.EI)
section.SetZbendingRigidity(rod.EI)
section.SetMassPerUnitLength(rod.m)
nodes = cantilever.straight(rod)
builder = fea.ChBuilderBeamEuler()
builder.BuildBeam(mesh, section, rod.n, chrono.ChVector3d(*nodes[0]), chrono.ChVector3d(*nodes[-1]),
                  chrono.ChVector3d(*rod.normal))
made = builder.GetLastBeamNodes()
made[0].SetFixed(True)
for node, force in rod.loads:
    made[node].SetForce(chrono.ChVector3d(*force))
mesh.SetAutomaticGravity(True)
system.Add(mesh)
system.SetSolver(mkl.ChSolverPardisoMKL())
analysis = chrono.ChStaticNonLinearAnalysis()
analysis.SetMaxIterations(200)
analysis.SetIncrementalSteps(50)
analysis.SetResidualTolerance(1e-9)
system.DoStaticAnalysis(analysis)
places = [node.GetPos() for node in made]
cantilever.write(sys.argv[3], [(place.x, place.y, place.z) for place in places])
