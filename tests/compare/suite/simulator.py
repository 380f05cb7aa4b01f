#!/usr/bin/env python3
"""A simulator for tests of dlo suite: a plane chain of hinges under one clamp, correct or with a deliberate defect.

    simulator.py DEFECT SCENE POINTS SHAPE

    right          springs EI/h, 2 EI/h at the clamp: half an element is between it and the clamp
    middle         the clamp is in the middle of an element; springs linear in 2 tan(angle/2)
    linear         the same with springs linear in the angle
    welded         the first element does not bend
    hinge          a spring EI/h at the clamp
    no_h           springs EI/m instead of EI/h
    soft           springs 0.7 EI/h
    light          0.8 of the weight
    weightless     no weight
    caps           each element also has the weight of a ball of radius 0.005 l, as a capsule has
    limp           no springs
    not_at_rest    stopped on its way to rest

A scene that it does not support ends in exit status 3.
"""

import json
import math
import sys


def tridiagonal(lower, diagonal, right):
    """Solves a symmetric tridiagonal system by elimination. Returns None if it is not positive definite."""
    diagonal, right = diagonal[:], right[:]
    for i in range(1, len(diagonal)):
        if not diagonal[i - 1] > 0:
            return None
        factor = lower[i - 1] / diagonal[i - 1]
        diagonal[i] -= factor * lower[i - 1]
        right[i] -= factor * right[i - 1]
    if not diagonal[-1] > 0:
        return None
    result = right[:]
    result[-1] /= diagonal[-1]
    for i in range(len(diagonal) - 2, -1, -1):
        result[i] = (right[i] - lower[i] * result[i + 1]) / diagonal[i]
    return result


class Chain:
    def __init__(self, scene, points, defect):
        rod = scene["rod"]
        stiffness = rod["bending_stiffness_Nm2"][0]
        gripper, = scene["grippers"]
        self.origin = gripper["position_m"]
        self.clamp = math.atan2(gripper["direction"][1], gripper["direction"][0])
        length, n = rod["length_m"], points - 1
        is_half = defect in ("middle", "linear", "weightless", "light", "soft", "caps", "limp")
        h = length / (n - 0.5 if is_half else n)
        self.lengths = [h / 2 if is_half else h] + [h] * (n - 1)
        # Spring constants of the joint before each segment; the first joint is at the clamp.
        first = {"right": 2.0, "hinge": 1.0, "no_h": 2.0, "not_at_rest": 2.0}.get(defect)
        spring = stiffness if defect == "no_h" else stiffness / h * (0.7 if defect == "soft" else 1)
        self.springs = [1e6 * spring if first is None else first * spring] + [spring] * (n - 1)
        self.is_linear = defect == "linear"
        shares = {"light": 0.8, "weightless": 0.0, "caps": 1 + 4 / 3 * 0.005 * length / h}
        self.forces(scene, rod["mass_per_length_kg_per_m"], shares.get(defect, 1.0))
        self.relaxation = length**2 / stiffness / (math.pi / 2) ** 2

    def forces(self, scene, mass_per_length, share):
        g = scene["gravity_m_per_s2"]
        s = [0.0]
        for h in self.lengths:
            s.append(s[-1] + h)
        nodes = [[0.0, 0.0] for _ in s]
        for i, h in enumerate(self.lengths):
            for k in (i, i + 1):
                for axis in (0, 1):
                    nodes[k][axis] += share * mass_per_length * g[axis] * h / 2
        for load in scene["loads"]:
            i = next(i for i in range(len(self.lengths)) if load["at_m"] <= s[i + 1] * (1 + 1e-12))
            part = (load["at_m"] - s[i]) / self.lengths[i]
            for axis in (0, 1):
                nodes[i][axis] += (1 - part) * load["force_N"][axis]
                nodes[i + 1][axis] += part * load["force_N"][axis]
        # The force that each segment carries: of all nodes beyond it.
        self.carried = []
        total = [0.0, 0.0]
        for node in reversed(nodes[1:]):
            total = [total[0] + node[0], total[1] + node[1]]
            self.carried.insert(0, total)

    def moment(self, angle):
        return angle if self.is_linear else 2 * math.tan(angle / 2)

    def slope(self, angle):
        return 1.0 if self.is_linear else 1 + math.tan(angle / 2) ** 2

    def derivatives(self, angles):
        n = len(angles)
        gradient, diagonal, lower = [0.0] * n, [0.0] * n, [0.0] * (n - 1)
        for k, angle in enumerate(angles):
            turn = angle - (angles[k - 1] if k else self.clamp)
            moment, slope = self.springs[k] * self.moment(turn), self.springs[k] * self.slope(turn)
            force = self.carried[k]
            gradient[k] += moment - self.lengths[k] * (force[1] * math.cos(angle) - force[0] * math.sin(angle))
            diagonal[k] += slope + self.lengths[k] * (force[0] * math.cos(angle) + force[1] * math.sin(angle))
            if k:
                gradient[k - 1] -= moment
                diagonal[k - 1] += slope
                lower[k - 1] -= slope
        return gradient, diagonal, lower

    def moved(self, steps, growth):
        """Returns the angles after implicit steps towards rest, each `growth` times as long as the previous one. A
        step without a positive definite system moves nothing and halves the length of the next one."""
        angles = [self.clamp] * len(self.lengths)
        time = self.relaxation / 100
        for _ in range(steps):
            gradient, diagonal, lower = self.derivatives(angles)
            step = tridiagonal(lower, [d + h / time for d, h in zip(diagonal, self.lengths)], [-g for g in gradient])
            if step is None:
                time /= 2
                continue
            angles = [a + d for a, d in zip(angles, step)]
            time *= growth
        return angles

    def points(self, angles):
        x, y = self.origin[0], self.origin[1]
        yield x, y
        for h, angle in zip(self.lengths, angles):
            x, y = x + h * math.cos(angle), y + h * math.sin(angle)
            yield x, y


def not_supported(scene):
    """Returns why a scene is not supported; None if it is."""
    rod, grippers = scene["rod"], scene["grippers"]
    if len(grippers) != 1 or grippers[0]["at_m"] != 0 or grippers[0]["hold"] != "clamp":
        return "grippers other than one clamp at the begin"
    if scene["obstacles"] or rod["sections"] or scene["distributed_loads"]:
        return "obstacles, sections, distributed loads"
    if rod["bending_stiffness_Nm2"][0] != rod["bending_stiffness_Nm2"][1] or rod["natural_curvature_per_m"]:
        return "two bending stiffnesses, natural curvature"
    if any(load["torque_Nm"] or load["force_N"][2] for load in scene["loads"]) or scene["gravity_m_per_s2"][2]:
        return "what is not in the plane"
    return None


def shape(defect, scene, points):
    """Returns the points as rows of x, y."""
    chain = Chain(scene, points, defect)
    if defect == "limp":
        return list(chain.points([-math.pi / 2] * len(chain.lengths)))
    return list(chain.points(chain.moved(100, 1) if defect == "not_at_rest" else chain.moved(200, 1.2)))


def main():
    defect, scene, points, shape_file = sys.argv[1:]
    with open(scene, encoding="utf-8") as file:
        scene = json.load(file)
    problem = not_supported(scene)
    if problem:
        print(f"not supported: {problem}", file=sys.stderr)
        sys.exit(3)
    with open(shape_file, "w", encoding="utf-8") as file:
        file.write("x,y,z\n")
        for x, y in shape(defect, scene, int(points)):
            file.write(f"{x:.12f},{y:.12f},0\n")


if __name__ == "__main__":
    main()
