"""What the adapters in this folder share: a scene (compare/doc/protocol.md) as one clamped, straight, round rod
in N - 1 equal elements, and its shape as a file. A scene that is more than that is exit status 3."""

import json
import sys
from types import SimpleNamespace


def refuse(why):
    print(f"not supported: {why}", file=sys.stderr)
    sys.exit(3)


def read(file, points):
    """The rod: n elements of length h, EI, GJ, EA, mass per length m, radius, gravity, origin, direction, normal,
    and loads as (node, force)."""
    with open(file, encoding="utf-8") as stream:
        scene = json.load(stream)
    rod, grippers = scene["rod"], scene["grippers"]
    if len(grippers) != 1 or grippers[0]["hold"] != "clamp" or grippers[0]["at_m"] != 0:
        refuse("grippers other than one clamp at arc length 0")
    if rod["natural_curvature_per_m"] or rod["natural_twist_rad_per_m"] or rod["sections"]:
        refuse("natural curvature, sections")
    if rod["bending_stiffness_Nm2"][0] != rod["bending_stiffness_Nm2"][1]:
        refuse("two bending stiffnesses")
    if scene["obstacles"] or scene["distributed_loads"] or any(load["torque_Nm"] for load in scene["loads"]):
        refuse("obstacles, distributed loads, couples")
    n = int(points) - 1
    h = rod["length_m"] / n
    loads = [(load["at_m"] / h, load["force_N"]) for load in scene["loads"]]
    if any(abs(node - round(node)) > 1e-9 for node, _ in loads):
        refuse("loads between nodes")
    EI, d3 = rod["bending_stiffness_Nm2"][0], grippers[0]["direction"]
    least = min(range(3), key=lambda i: abs(d3[i]))
    across = [float(i == least) - d3[least] * d3[i] for i in range(3)]
    size = sum(x * x for x in across) ** 0.5
    return SimpleNamespace(
        n=n, h=h, length=rod["length_m"], EI=EI, EA=rod["axial_stiffness_N"],
        GJ=rod["torsional_stiffness_Nm2"] or rod["assumed_torsional_stiffness_Nm2"],
        m=rod["mass_per_length_kg_per_m"], radius=2 * (EI / rod["axial_stiffness_N"]) ** 0.5,
        gravity=scene["gravity_m_per_s2"], origin=grippers[0]["position_m"], direction=d3,
        normal=[x / size for x in across], loads=[(round(node), force) for node, force in loads])


def straight(rod):
    """Returns the nodes of the straight initial shape."""
    return [[o + i * rod.h * d for o, d in zip(rod.origin, rod.direction)] for i in range(rod.n + 1)]


def write(file, points):
    with open(file, "w", encoding="ascii") as stream:
        stream.write("x,y,z\n")
        stream.writelines("{:.10g},{:.10g},{:.10g}\n".format(*map(float, point)) for point in points)
