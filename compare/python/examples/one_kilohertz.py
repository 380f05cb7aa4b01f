# %% [markdown]
# # Which N for 1 kHz?
#
# A haptic loop has 1 ms for everything, 30 steps of the force model among it. More points are nearer
# to the rod and take longer: here are both, for a steel wire in a hand.

# %%
import time

import numpy

import dlo

wire = dlo.Scene(
    length="30 cm",
    diameter="0.5 mm",
    material="spring_steel",
    grippers=[dlo.clamp(at=0, position=(0, 0, 0), direction="0 deg")],
)
print("   N   error/l   30 steps")
for points in (8, 16, 32, 64):
    scene = wire.replace(force_model={"points": points})
    # 64 points take a million steps to come to rest: a slow machine needs more than the usual limit.
    error = dlo.compare(scene, modulus=False, time_limit=120).deviation["rms_over_length"]
    loop = dlo.ForceModel(scene)
    out = numpy.empty((len(loop), 3))
    times = []
    for frame in range(200):
        begin = time.perf_counter()
        loop.move_gripper(0, position=(0.01 * numpy.sin(0.01 * frame), 0, 0))
        loop.step(30)
        loop.points(out=out)
        times.append(time.perf_counter() - begin)
    print(f"{points:4d}   {error:.1e}   {1e6 * numpy.median(times):.0f} us")
    assert error < 0.05
