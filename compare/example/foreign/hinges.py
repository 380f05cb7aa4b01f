#!/usr/bin/env python3
"""A chain of hinges at rest, as small as a simulator can be that dlo bench runs (compare/doc/protocol.md).

    hinges.py SCENE POINTS SHAPE

One clamp at arc length 0, all in the x-y plane, law hooke. Points, weights and hinges are the scene's own.
"""
import json
import math
import sys

scene_file, _, shape_file = sys.argv[1:]
with open(scene_file, encoding="utf-8") as file:
    scene = json.load(file)
chain, clamp = scene["force_model"], scene["grippers"][0]
normal = scene["plane_normal"] or [0, 0, 0]
if len(scene["grippers"]) > 1 or clamp["at_m"] != 0 or chain["law"] != "hooke" or abs(normal[2]) < 1:
    sys.exit("hinges.py: only one clamp at arc length 0, in the x-y plane, with the law hooke")
lengths, k = chain["segment_m"], chain["joint_stiffness_Nm"]
n = len(lengths)
pull = [[sum(f[i] for f in chain["point_force_N"][j + 1:]) for i in (0, 1)] for j in range(n)]  # on segments
angle = [math.atan2(clamp["direction"][1], clamp["direction"][0])] * n  # the first one is held
for step in range(100):  # Newton's, while the load grows for fifty steps
    share, upper, change = min(1, (step + 1) / 50), [0] * n, [0] * n
    for j in range(1, n):  # elimination: balance of torques at each hinge
        torque = share * lengths[j] * (pull[j][1] * math.cos(angle[j]) - pull[j][0] * math.sin(angle[j]))
        slope = -share * lengths[j] * (pull[j][1] * math.sin(angle[j]) + pull[j][0] * math.cos(angle[j]))
        half = [(b - a) / 2 for a, b in zip(angle[j - 1:j + 1], angle[j:j + 2])]  # turns of its hinges
        stiff = [spring / math.cos(turn) ** 2 for turn, spring in zip(half, k[j - 1:])] + [0]
        bend = [2 * spring * math.tan(turn) for turn, spring in zip(half, k[j - 1:])] + [0]
        pivot = stiff[0] + stiff[1] - slope - stiff[0] * upper[j - 1]
        upper[j], change[j] = stiff[1] / pivot, (torque - bend[0] + bend[1] + stiff[0] * change[j - 1]) / pivot
    for j in range(n - 2, 0, -1):
        change[j] += upper[j] * change[j + 1]
    angle = [a + b for a, b in zip(angle, change)]
x, y, _ = chain["held"][0]["points_m"][0]
with open(shape_file, "w", encoding="ascii") as file:
    print("x,y,s", "{:.9g},{:.9g},0".format(*clamp["position_m"]), sep="\n", file=file)
    for s, length, a in zip(chain["point_at_m"][1:], lengths, angle):
        x, y = x + length * math.cos(a), y + length * math.sin(a)
        print(f"{x:.9g},{y:.9g},{s:.15g}", file=file)
