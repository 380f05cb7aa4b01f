#!/usr/bin/python3
"""Prints how much longer blocks of 30 steps take than the same steps within one call, by hand:

    PYTHONPATH=build/release/compare/python/package tests/python/cost.py data/scenes/cable.toml

Both run in turn, so that a busy machine is busy for both; the median of seven.
"""

import statistics
import sys
import time

import dlo

BLOCKS = 33_334


def seconds(scene, calls, steps):
    """Returns the time of calls of a new loop, each of as many steps."""
    step = dlo.ForceModel(scene).step
    begin = time.perf_counter()
    for _ in range(calls):
        step(steps)
    return time.perf_counter() - begin


def main():
    scene = dlo.Scene.from_file(sys.argv[1])
    more = [seconds(scene, BLOCKS, 30) - seconds(scene, 1, 30 * BLOCKS) for _ in range(7)]
    print(f"a block of 30 steps: {1e6 * statistics.median(more) / BLOCKS:.2f} us more than within one call")


if __name__ == "__main__":
    main()
