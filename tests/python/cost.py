#!/usr/bin/python3
"""Prints how much longer blocks of 30 steps take than the same steps within one call, and the time to make scenes, by
hand:

    PYTHONPATH=build/release/compare/python/package tests/python/cost.py data/scenes/cable.toml

Both run in turn, so that a busy machine is busy for both; the median of seven.
"""

import statistics
import sys
import time
import timeit

import dlo

BLOCKS = 33_334


def seconds(scene, calls, steps):
    """Returns the time [s] of `calls` calls of a new loop, each of `steps` steps."""
    step = dlo.ForceModel(scene).step
    begin = time.perf_counter()
    for _ in range(calls):
        step(steps)
    return time.perf_counter() - begin


def main():
    scene = dlo.Scene.from_file(sys.argv[1])
    more = [seconds(scene, BLOCKS, 30) - seconds(scene, 1, 30 * BLOCKS) for _ in range(7)]
    print(f"a block of 30 steps: {1e6 * statistics.median(more) / BLOCKS:.2f} us more than within one call")
    clamp = dlo.clamp(at=0, position=(0, 0, 0), direction="0 deg")
    made = dlo.Scene(0.5, diameter="2 mm", material="spring_steel", grippers=[clamp])
    for name, make in (
        ("dlo.Scene()", lambda: dlo.Scene(0.5, diameter="2 mm", material="spring_steel", grippers=[clamp])),
        ("replace()", lambda: made.replace(length=0.4)),
        ("dlo.Scene.from_text()", lambda: dlo.Scene.from_text(made.to_toml())),
    ):
        print(f"{name}: {min(timeit.repeat(make, number=200, repeat=9)) / 200 * 1e6:.0f} us")


if __name__ == "__main__":
    main()
