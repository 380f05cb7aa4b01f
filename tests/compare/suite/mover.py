"""A simulator for tests of dlo suite: a released cantilever without weight, by the closed form of its first mode,
correct or with a deliberate defect.

    mover.py DEFECT SCENE POINTS SHAPE
"""

import json
import math
import os
import sys

LAMBDA = 1.8751040687119611


def main():
    defect, scene_file, points, shape_file = sys.argv[1:]
    with open(scene_file) as file:
        scene = json.load(file)
    motion = scene.get("motion")
    if motion is None or scene["loads"] or scene["gravity_m_per_s2"] != [0, 0, 0]:
        sys.exit(3)
    rod = scene["rod"]
    s = motion["begin_arc_length_m"]
    begin = motion["begin_points_m"]
    assert len(s) == int(points)
    if defect == "static":  # knows of no motion
        with open(shape_file, "w") as file:
            file.write("x,y,z\n" + "".join(f"{x},{y},{z}\n" for x, y, z in begin))
        return
    omega = LAMBDA**2 * math.sqrt(rod["bending_stiffness_Nm2"][0] / rod["mass_per_length_kg_per_m"]) / rod["length_m"] ** 2
    if defect == "heavy":
        omega *= 0.9
    rows = []
    for t in motion["times_s"]:
        decay = math.exp(-1.5 * t) if defect == "damped" else 1
        factor = decay * math.cos(omega * t)
        rows.append((t, [(x, y * factor, z) for x, y, z in begin]))
    if defect == "short":
        rows = rows[:5]
    with open(shape_file, "w") as file:
        file.write("time,s,x,y,z\n")
        for t, frame in rows:
            for at, (x, y, z) in zip(s, frame):
                file.write(f"{t},{at},{x},{y},{z}\n")


main()
