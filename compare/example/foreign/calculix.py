#!/usr/bin/env python3
"""A scene as CalculiX solves it, for dlo bench and dlo regress (compare/doc/protocol.md).

    calculix.py SCENE POINTS SHAPE [THINNER]

SCENE is what `dlo scene --format json` writes, SHAPE becomes a CSV file of the rod's axis. Needs CalculiX's
ccx (Debian: calculix-ccx) and no Python package.

The rod is one layer of 20-node bricks with reduced integration (C3D20R), with large rotations (NLGEOM): what
CalculiX makes of its beam elements B32R, but here grips prescribe all of an end's nodes, because the
rotational degrees of freedom of an expanded beam's end stop converging at 0.3 rad. The section is the
square with the scene's EI and EA, which two points of integration a side take exactly; of SECTION=CIRC they
make 2.4 % too much bend. Poisson's ratio is zero, since a clamp hinders the section's change of shape all
over its first element; G alone determines the torsional stiffness. Such a rod also stretches and shears, unlike
that of `energy`. The distance between both shapes follows from the thickness: with THINNER = 4 the section has
the same EI and GJ and a quarter of the thickness, and the distance is a sixteenth.

The rod starts straight from its first grip. If a second one holds its end, the rod is first bent upwards to a
circle, which takes no force along it and lets it hang below its end; then the end goes to its place, then it
is turned.
"""

import json
import math
import os
import subprocess
import sys
import tempfile

INCREMENTS = (0.1, 0.05, 0.025, 0.015, 0.01, 0.005)  # largest ones of the load and of the way
# Numbers have 12 digits: CalculiX reads no more than 20 characters of one.
PER_STAGE = 100  # places of the second grip between which its nodes go straight
FEWEST_TWISTED = 7  # bricks of a rod whose end is turned: three came to no end, or to another one


def refuse(why):
    print(f"calculix.py: not supported: {why}", file=sys.stderr)
    sys.exit(3)  # exit status of a scene that it does not have


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    return [x / math.hypot(*a) for x in a]


def mix(*terms):
    """Returns the sum of numbers times vectors, given as pairs."""
    return [sum(factor * vector[i] for factor, vector in terms) for i in range(3)]


def turned(vector, axis, angle):
    """Returns a vector rotated about a unit axis (Rodrigues' formula)."""
    along = sum(a * v for a, v in zip(axis, vector))
    c = math.cos(angle)
    return mix((c, vector), (math.sin(angle), cross(axis, vector)), ((1 - c) * along, axis))


class Rod:
    """The bricks of a straight rod. Planes of nodes lie at the elements' ends, with the corners and the
    middles of the edges of a square, and in the elements' middles, with the corners."""

    def __init__(self, scene, points, thinner=1):
        rod, held = scene["rod"], scene["grippers"][0]
        if "motion" in scene:
            refuse("motion")
        if rod["natural_curvature_per_m"] or rod["natural_twist_rad_per_m"] or scene["obstacles"]:
            refuse("natural curvature, obstacles")
        if scene["distributed_loads"] or any(load["torque_Nm"] for load in scene["loads"]):
            refuse("distributed loads, couples")
        EI, second_EI = rod["bending_stiffness_Nm2"]
        if EI != second_EI or held["hold"] != "clamp" or held["at_m"] != 0:
            refuse("other than a round rod with a clamp at arc length 0")
        self.scene, self.direction, self.origin = scene, held["direction"], held["position_m"]
        self.side = math.sqrt(12 * EI / rod["axial_stiffness_N"]) / thinner
        self.ends = self.element_ends(max(1, (points - 1) // 2))
        self.s = sorted(self.ends + [(a + b) / 2 for a, b in zip(self.ends, self.ends[1:])])
        down = scene["gravity_m_per_s2"]
        self.axis = cross(self.direction, down)  # about which weight turns the rod
        if math.hypot(*self.axis) < 1e-3 * math.hypot(*down) or not any(down):
            self.axis = cross(self.direction, [0, 0, 1] if abs(self.direction[2]) < 0.9 else [1, 0, 0])
        self.axis = unit(self.axis)
        self.across = cross(self.axis, self.direction)
        self.planes, self.nodes = [], {}  # nodes of each plane; places of nodes

        corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
        for i, at in enumerate(self.s):
            offsets = corners + ([(0, -1), (1, 0), (0, 1), (-1, 0)] if i % 2 == 0 else [])
            self.planes.append([])
            for u, v in offsets:
                self.planes[-1].append(len(self.nodes) + 1)
                self.nodes[len(self.nodes) + 1] = mix(
                    (1, self.origin), (at, self.direction),
                    (u * self.side / 2, self.across), (v * self.side / 2, self.axis))

    def element_ends(self, elements):
        """Returns the ends of the elements: those of rod and sections, grips, loads, and equal parts between them."""
        rod = self.scene["rod"]
        marks = {0.0, rod["length_m"]}
        marks |= {place["at_m"] for place in self.scene["grippers"] + self.scene["loads"]}
        marks |= {section[end] for section in rod["sections"] for end in ("from_m", "to_m")}
        marks = sorted(marks)
        ends = marks[:1]
        for begin, end in zip(marks, marks[1:]):
            count = max(1, round(elements * (end - begin) / rod["length_m"]))
            ends += [begin + (end - begin) * i / count for i in range(1, count)] + [end]
        return ends

    def mesh(self):
        lines = ["*NODE,NSET=ALL"]
        lines += [f"{node}," + ",".join(f"{x:.12g}" for x in place)
                  for node, place in self.nodes.items()]
        rod = self.scene["rod"]
        parts = {f"S{i}": section for i, section in enumerate(rod["sections"])}
        members = {"ROD": [], **{name: [] for name in parts}}
        for i, (begin, end) in enumerate(zip(self.ends, self.ends[1:])):
            inside = [name for name, part in parts.items()
                      if part["from_m"] < (begin + end) / 2 < part["to_m"]]
            members[inside[0] if inside else "ROD"].append(i)
        for name, part in {"ROD": rod, **parts}.items():
            if not members[name]:
                continue
            lines.append(f"*ELEMENT,TYPE=C3D20R,ELSET={name}")
            for i in members[name]:
                low, middle, high = self.planes[2 * i:2 * i + 3]
                order = [i + 1] + low[:4] + high[:4] + low[4:] + high[4:] + middle
                lines += [",".join(map(str, order[:11])) + ",", ",".join(map(str, order[11:]))]
            lines += self.material(name, part)
        return lines, [name for name in members if members[name]]

    def straight_edges(self, led):
        """Returns constraints that keep the middle of each edge of a section halfway between its corners. They
        prevent an hourglass mode. Planes that grips move are excluded."""
        lines = []
        for plane in self.planes[::2]:
            if plane in led:
                continue
            for k, node in enumerate(plane[4:]):
                for i in (1, 2, 3):
                    lines += ["*EQUATION", "3", f"{node},{i},1.,{plane[k]},{i},-0.5,"
                              f"{plane[(k + 1) % 4]},{i},-0.5"]
        return lines

    def material(self, name, part):
        """Returns a material of cubic symmetry, in which E and G are independent and Poisson's ratio is zero."""
        E = part["bending_stiffness_Nm2"][0] / (self.side**4 / 12)
        # Bricks of this order do not warp: their J is the polar moment, twice I.
        GJ = part["torsional_stiffness_Nm2"]
        G = GJ / (self.side**4 / 6) if GJ else E / 2
        return [f"*MATERIAL,NAME={name}", "*ELASTIC,TYPE=ENGINEERING CONSTANTS",
                f"{E:.12g},{E:.12g},{E:.12g},0,0,0,{G:.12g},{G:.12g}", f"{G:.12g}",
                "*DENSITY", f"{part['mass_per_length_kg_per_m'] / self.side**2:.12g}",
                f"*SOLID SECTION,ELSET={name},MATERIAL={name}"]

    def axis_of(self, moved):
        """Returns the positions of the planes' middles, from the nodes' displacements."""
        middles = []
        for at, plane in zip(self.s, self.planes):
            by = mix(*((0.25, moved[node]) for node in plane[:4]))
            middles.append(mix((1, self.origin), (at, self.direction), (1, by)))
        return middles


def path_of_second_grip(rod):
    """Yields the poses of the second grip on its path: (position, function that rotates a vector)."""
    first, second = rod.scene["grippers"]
    length, direction = rod.s[-1], rod.direction
    if second["at_m"] != length or second["direction"] != direction:
        refuse("two grips other than parallel clamps at both ends of the rod")
    apart = math.dist(first["position_m"], second["position_m"]) / length
    low, high = 1e-3, 2 * math.pi  # of a circle's arc that is as long as the rod
    for _ in range(60):
        angle = (low + high) / 2
        low, high = (angle, high) if 2 * math.sin(angle / 2) / angle > apart else (low, angle)
    for i in range(PER_STAGE + 1):
        a = angle * i / PER_STAGE
        place = mix((1, rod.origin), (length * (math.sin(a) / a if a else 1), direction),
                    (-length * ((1 - math.cos(a)) / a if a else 0), rod.across))
        yield place, lambda v, a=a: turned(v, rod.axis, -a)
    for i in range(1, PER_STAGE + 1):
        share, a = i / PER_STAGE, angle * (1 - i / PER_STAGE)
        yield (mix((1 - share, place), (share, second["position_m"])),
               lambda v, a=a: turned(v, rod.axis, -a))
    if not second["frame"]:
        return
    if len(rod.ends) - 1 < FEWEST_TWISTED:
        refuse(f"twist of fewer than {FEWEST_TWISTED} bricks, which end in a fold")
    roll = second["frame"]["roll_rad"] - first["frame"]["roll_rad"]
    for i in range(1, PER_STAGE + 1):
        yield second["position_m"], lambda v, a=roll * i / PER_STAGE: turned(v, direction, a)


def loading(rod, parts, increment):
    """Returns one step with grips and loads, which grow in its first unit of time. The tolerance of the balance
    of forces is 1e-5; the default of CalculiX is 5e-3."""
    scene = rod.scene
    fixed = ["*BOUNDARY"] + [f"{node},1,3" for node in rod.planes[0]]
    tables = ["*AMPLITUDE,NAME=LOADS", "0.,0.", "1.,1.", "9.,1."]
    led, held, duration = [], [rod.planes[0]], 1
    if len(scene["grippers"]) > 2:
        refuse("more than two grips")
    if len(scene["grippers"]) == 2:
        held.append(rod.planes[-1])
        way = list(path_of_second_grip(rod))
        duration = (len(way) - 1) / PER_STAGE
        straight = mix((1, rod.origin), (rod.s[-1], rod.direction))
        for node in rod.planes[-1]:
            arm = mix((1, rod.nodes[node]), (-1, straight))
            places = [mix((1, place), (1, turn(arm)), (-1, rod.nodes[node])) for place, turn in way]
            for i in range(3):
                tables += [f"*AMPLITUDE,NAME=A{node}D{i}"]
                tables += [f"{k / PER_STAGE:.12g},{by[i]:.12g}" for k, by in enumerate(places)]
                led += [f"*BOUNDARY,AMPLITUDE=A{node}D{i}", f"{node},{i + 1},{i + 1},1."]
    loads = []
    gravity = scene["gravity_m_per_s2"]
    g = math.hypot(*gravity)
    if g > 0:
        down = ",".join(f"{x / g:.12g}" for x in gravity)
        loads = ["*DLOAD,AMPLITUDE=LOADS"] + [f"{name},GRAV,{g:.12g},{down}" for name in parts]
    for load in scene["loads"]:
        plane = rod.planes[rod.s.index(load["at_m"])]
        loads += ["*CLOAD,AMPLITUDE=LOADS"]
        loads += [f"{node},{i + 1},{x / 4:.12g}" for node in plane[:4]
                  for i, x in enumerate(load["force_N"]) if x]
    step = ["*STEP,NLGEOM,INC=10000", "*STATIC",
            f"{increment / 5:.12g},{duration:.12g},1e-6,{increment:.12g}",
            "*CONTROLS,PARAMETERS=FIELD", "1e-5,1e-2,,,1e-5", *led, *loads,
            "*NODE PRINT,NSET=ALL,FREQUENCY=1000000", "U", "*END STEP"]
    return tables + fixed + rod.straight_edges(held) + step


def displacements(lines, count):
    """Runs CalculiX. Returns the displacements of the nodes at the end of the step and "", or None and the error."""
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "rod.inp"), "w", encoding="ascii") as file:
            file.write("\n".join(lines) + "\n")
        run = subprocess.run(["ccx", "rod"], cwd=folder, capture_output=True, text=True, check=False,
                             env=dict(os.environ, OMP_NUM_THREADS="1"))
        if run.returncode != 0:
            errors = [line.strip() for line in run.stdout.splitlines() if "*ERROR" in line]
            return None, f"ccx: exit status {run.returncode} {' '.join(errors[-1:])}"
        with open(os.path.join(folder, "rod.dat"), encoding="ascii") as file:
            rows = [line.split() for line in file]
    rows = [row for row in rows if len(row) == 4 and row[0].isdigit()]
    return {int(row[0]): [float(x) for x in row[1:]] for row in rows[-count:]}, ""


def is_folded(axis, s):
    """Whether the middles of two adjacent planes are more than 10 % nearer or farther than at the beginning, as those
    of an inverted brick. Its Green's strain may be zero, so that it stays inverted."""
    return any(abs(math.dist(a, b) / (t - r) - 1) > 0.1
               for a, b, r, t in zip(axis, axis[1:], s, s[1:]))


def solved(rod):
    """Returns the positions of the axis. Increments of the load are reduced if larger ones fail or fold the rod."""
    lines, parts = rod.mesh()
    for increment in INCREMENTS:
        moved, problem = displacements(lines + loading(rod, parts, increment), len(rod.nodes))
        axis = rod.axis_of(moved) if moved else []
        if moved and not is_folded(axis, rod.s):
            return axis
    sys.exit(f"calculix.py: {problem or 'ccx: an element was turned inside out'}")


def main(scene_file, points, shape_file, thinner=1):
    with open(scene_file, encoding="utf-8") as file:
        rod = Rod(json.load(file), int(points), float(thinner))
    axis = solved(rod)
    with open(shape_file, "w", encoding="ascii") as file:
        file.write("x,y,z,s\n")
        for at, place in zip(rod.s, axis):
            file.write(",".join(f"{x:.10g}" for x in place) + f",{at:.15g}\n")


if __name__ == "__main__":
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    main(*sys.argv[1:])
