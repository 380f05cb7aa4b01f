#!/usr/bin/env python3
"""A scene as PyElastica (pip install pyelastica) solves it; untested here.

    dlo suite --with pyelastica='python3 pyelastica_rod.py {scene} {points} {shape}'

A Cosserat rod with EI, GJ and EA of the scene, which shears and stretches. Damped until it rests."""

import sys

import cantilever
import elastica
import numpy

rod = cantilever.read(sys.argv[1], sys.argv[2])


class Simulator(elastica.BaseSystemCollection, elastica.Constraints, elastica.Forcing, elastica.Damping):
    pass


simulator = Simulator()
E = rod.EI / (numpy.pi * rod.radius**4 / 4)
body = elastica.CosseratRod.straight_rod(
    rod.n, numpy.array(rod.origin), numpy.array(rod.direction), numpy.array(rod.normal), rod.length,
    rod.radius, rod.m / (numpy.pi * rod.radius**2), youngs_modulus=E, shear_modulus=E / 2)
body.bend_matrix[2, 2, :] = rod.GJ
simulator.append(body)
simulator.constrain(body).using(elastica.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,))
simulator.add_forcing_to(body).using(elastica.GravityForces, acc_gravity=numpy.array(rod.gravity))
for node, force in rod.loads:
    if node != rod.n:
        cantilever.refuse("loads other than at the end")
    simulator.add_forcing_to(body).using(
        elastica.EndpointForces, numpy.zeros(3), numpy.array(force), ramp_up_time=0.1)
step = 0.2 * rod.h * (rod.m / rod.EA) ** 0.5
simulator.dampen(body).using(elastica.AnalyticalLinearDamper, damping_constant=2.0, time_step=step)
simulator.finalize()
time = 30 * rod.length**2 * (rod.m / rod.EI) ** 0.5
elastica.integrate(elastica.PositionVerlet(), simulator, time, int(time / step))
cantilever.write(sys.argv[3], body.position_collection.T)
