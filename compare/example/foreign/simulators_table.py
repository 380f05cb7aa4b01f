#!/usr/bin/env python3
"""Errors and times of other people's simulators beside ours: the tables of compare/doc/protocol.md.

    simulators_table.py DLO SCENE... --with NAME=COMMAND... [--points N,N,...] [--seconds S] [--repeats R] [--time-limit S]
    simulators_table.py DLO SCENE... --with NAME=COMMAND --hold-to-chain [--points N,2N]

Each scene is taken with the force model's defaults (its paragraph [force_model] is left out), as `dlo bench` runs it; a
table has RMS distances from `energy` as shares of the length, and wall times. With --hold-to-chain it is a test: the
program has to be a chain of hinges, whose error falls by four when N is doubled, and that of `chain` but for
--apart (where it is given, a share of the length): exit status 1 if it is not.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("dlo")
parser.add_argument("scenes", nargs="+")
parser.add_argument("--with", dest="programs", action="append", default=[])
parser.add_argument("--points", default="8,16,32,64")
parser.add_argument("--seconds", default="60")
parser.add_argument("--repeats", default="3")
parser.add_argument("--time-limit", default="60")
parser.add_argument("--hold-to-chain", action="store_true")
parser.add_argument("--apart", type=float)
options = parser.parse_args()
counts = [int(count) for count in options.points.split(",")]
programs = [word for program in options.programs for word in ("--with", program)]
names = [program.partition("=")[0] for program in options.programs]


def run(*words):
    """Returns the JSON of a command. Exit status 3 is accepted: a program failed, and the JSON has its error."""
    result = subprocess.run([options.dlo, *words, "--time-limit", options.time_limit, "--format", "json"],
                            capture_output=True, text=True, check=False)
    if result.returncode not in (0, 3):
        sys.exit(f"simulators_table.py: dlo {words[0]}: {result.stderr}")
    return json.loads(result.stdout)


def in_words(seconds):
    """Returns a time with two digits and a unit, without exponents."""
    for unit, factor in (("s", 1), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= 0.95 * factor or unit == "us":
            value = seconds / factor
            return f"{round(value, -1):.0f} {unit}" if value >= 100 else f"{value:.2g} {unit}"


def table(scene):
    document = run("bench", scene, "--seconds", options.seconds, "--repeats", options.repeats, *programs)
    runs = [one for one in document["runs"] if one["kind"] == "static" and
            (one["law"], one["bookkeeping"]) in ((None, None), ("hooke", "consistent")) and
            one["stepper"] in (None, "auto") and one["c_c_over_AE"] in (None, 1)]
    cells = {(one["model"], one["size"]): f"{one['rms_over_length']:.1e} {in_words(one['time_s']):>7}" for one in runs}
    failures = {(one["program"], one["points"]): one["problem"] for one in document["failures"]}
    print(f"{document['runs'][0]['scene']}\n{'N':<10}" + "".join(f"{count:>20}" for count in counts) +
          f"{'to the end':>20}")
    for name in ["energy", "chain", "force", *names]:
        sizes = counts + ([0] if name == "energy" else [])
        print(f"{name:<10}" + "".join(
            f"{cells.get((name, size), 'failed' if (name, size) in failures else '-'):>20}" for size in sizes))
    for (name, size), problem in failures.items():
        print(f"{name}, N = {size}: {problem}")
    print(flush=True)


def errors(scene, count):
    """Returns the RMS errors of the first program and of `chain`, divided by the length."""
    document = run("regress", scene, "--model", "chain", "--points", str(count), *programs,
                   "--baseline", f"{scene}-{count}.baseline", "--update")
    measured = {}
    for one in document["cases"]:
        if not one["measured"]:
            sys.exit(f"{one['case']}: {one['message']}")
        measured[one["case"].rpartition(" (")[2].split(",")[0]] = one["measured"]["rms_over_length"]
    return measured[names[0]], measured["chain"]


def hold_to_chain(scene):
    (coarse, _), (fine, chain) = (errors(scene, count) for count in counts)
    print(f"{pathlib.Path(scene).stem:<24} {coarse:.3e} {fine:.3e}, chain {chain:.3e}")
    # Second order in h, which is l / (N - 1) or, between two clamps, l / (N - 2); a tenth for the next orders.
    return coarse / fine > 0.9 * 4 and (options.apart is None or abs(fine - chain) <= options.apart)


with tempfile.TemporaryDirectory() as place:
    right = True
    for source in options.scenes:
        copy = pathlib.Path(place) / pathlib.Path(source).name
        copy.write_text(pathlib.Path(source).read_text(encoding="utf-8").split("[force_model]")[0], encoding="utf-8")
        if options.hold_to_chain:
            right = hold_to_chain(str(copy)) and right
        else:
            table(str(copy))
sys.exit(0 if right else "not a chain of hinges")
