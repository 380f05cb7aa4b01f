# simulate.py
"""A simulator: a chain of hinges that hangs from a clamp. Yours stands in its place."""

import math
import sys

LENGTH, WEIGHT = 1.0, 0.5671  # l [m], of the whole cable [N]


def simulate(count, stiffness=0.02413):
    """Arc lengths [m] and points (x, y, z) [m], from the clamp to the tip. stiffness: EI [N m^2]."""
    h = LENGTH / (count - 1.5)  # the clamp holds the middle of the first segment
    joint = stiffness / h
    beyond = [WEIGHT * (1 - i * h / LENGTH) for i in range(count - 1)]  # weight beyond a segment
    angles = [0.0] * count
    for _ in range(20 * count**2):
        for i in range(1, count - 1):
            after = angles[i + 1] if i < count - 2 else angles[i]
            pull = beyond[i] * h * math.cos(angles[i])
            angles[i] = (angles[i - 1] + after - pull / joint) / 2
    arc, points = [0.0, h / 2], [(0.0, 0.0, 0.0), (h / 2, 0.0, 0.0)]
    for angle in angles[1:-1]:
        x, y, _ = points[-1]
        arc.append(arc[-1] + h)
        points.append((x + h * math.cos(angle), y + h * math.sin(angle), 0.0))
    return arc, points


if __name__ == "__main__":
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write("x,y,z,s\n")
        for s, (x, y, z) in zip(*simulate(int(sys.argv[1]), *map(float, sys.argv[3:]))):
            file.write(f"{x:.9f},{y:.9f},{z:.9f},{s:.9f}\n")
