#!/usr/bin/python3
"""What calls from Python cost beside those in C++, by hand:

    cmake --build build/release --target dlo_python_cost
    PYTHONPATH=build/release/compare/python/package tests/python/cost.py build/release/bin data/scenes/cable.toml

The programs run in turn, so that a busy machine is busy for both; medians of seven.
"""

import os
import resource
import statistics
import subprocess
import sys
import time

import dlo


def check_time(scene, points):
    times = []
    for _ in range(200):
        begin = time.perf_counter()
        dlo.check(scene, points)
        times.append(time.perf_counter() - begin)
    return 1e6 * statistics.median(times)


def loop_time(scene):
    loop = dlo.ForceModel(scene)
    step = loop.step
    begin = time.perf_counter()
    for _ in range(33_334):
        step(30)
    return time.perf_counter() - begin


def sweep_rates(folder, path):
    """Rows a second of 1e5 scenes: the command's and the module's."""
    begin = time.perf_counter()
    subprocess.run([folder + "/dlo", "sweep", path, "--vary", "gamma=lin:0.1:2:100000", "-o", os.devnull],
                   check=True)
    middle = time.perf_counter()
    rows = len(dlo.sweep(path, {"gamma": "lin:0.1:2:100000"})["row"])
    return rows / (middle - begin), rows / (time.perf_counter() - middle)


def growth(scene):
    """Memory that 1e5 solves and 1e5 exceptions take and do not give back [kB]."""

    def work(times):
        for _ in range(times):
            dlo.solve(scene, samples=11)
            try:
                dlo.solve(scene, model="none")
            except dlo.InputError:
                pass

    work(1000)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    work(100_000)
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before


def main():
    folder, path = sys.argv[1:3]
    scene = dlo.Scene.from_file(path)
    points = dlo.solve(scene, model="exact", samples=16).points
    checks, loops = [], []
    for _ in range(7):
        done = subprocess.run([folder + "/dlo_python_cost", path], capture_output=True, text=True, check=True)
        check, loop = map(float, done.stdout.split())
        checks.append((check_time(scene, points), check))
        loops.append((loop_time(scene), loop))
    for what, pairs, unit in (("check of 16 points", checks, "us"), ("1e6 steps in blocks of 30", loops, "s")):
        here, there = (statistics.median(side) for side in zip(*pairs))
        print(f"{what:26s} {here:.4g} {unit} in Python, {there:.4g} {unit} in C++: {here / there:.3f} times")
        if unit == "s":
            print(f"{'':26s} {1e6 * (here - there) / 33_334:.2f} us more a block")
    rates = [sweep_rates(folder, path) for _ in range(3)]
    print("sweep of 1e5 scenes        {1:.0f} rows/s in Python, {0:.0f} by the command".format(
        *(statistics.median(side) for side in zip(*rates))))
    print(f"memory                     {growth(scene)} kB more after 1e5 solves and 1e5 exceptions")


if __name__ == "__main__":
    main()
