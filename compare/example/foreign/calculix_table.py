#!/usr/bin/env python3
"""How far CalculiX is from `energy`, over its mesh: the table of compare/doc/protocol.md.

    calculix_table.py DLO SCENE... [--points N,N,...] [--thinner T,T,...] [--at-most SHARE]

Each row is a scene (TOML) and a thickness (calculix.py), each column a number of points along the rod; the
numbers are RMS distances as shares of the length. Exit status 1: with --at-most, a row that does not end
within it; a run that failed.
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
parser.add_argument("--points", default="17,33,65,129")
parser.add_argument("--thinner", default="1,4")
parser.add_argument("--at-most", type=float)
options = parser.parse_args()
counts = [int(count) for count in options.points.split(",")]
script = pathlib.Path(__file__).with_name("calculix.py")

errors, problems = {}, []  # (case, thinner, points) -> share
with tempfile.TemporaryDirectory() as folder:
    for count in counts:
        command = [options.dlo, "regress", "--model", "chain", "--points", str(count), "--time-limit", "600",
                   "--baseline", f"{folder}/baseline.toml", "--update", "--format", "json", *options.scenes]
        for thinner in options.thinner.split(","):
            command += ["--with", f"thinner-{thinner}='{sys.executable}' '{script}' "
                                  f"{{scene}} {{points}} {{shape}} {thinner}"]
        result = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
        if result.returncode not in (0, 3):
            sys.exit(f"calculix_table.py: dlo regress: exit status {result.returncode}")
        for case in json.loads(result.stdout)["cases"]:
            scene, _, solver = case["case"].rpartition(" (")
            if not solver.startswith("thinner-"):
                continue
            thinner = solver.split(",")[0].removeprefix("thinner-")
            if case["measured"]:
                errors[scene, thinner, count] = case["measured"]["rms_over_length"]
            else:
                problems.append(f"{case['case']}: {case['message']}")
print(f"{'':<28} {'thinner':>7}" + "".join(f" {f'N = {count}':>9}" for count in counts))
for scene, thinner in dict.fromkeys(key[:2] for key in sorted(errors)):
    row = [errors.get((scene, thinner, count)) for count in counts]
    print(f"{scene:<28} {thinner:>7}" + "".join(f" {'failed' if e is None else f'{e:.1e}':>9}" for e in row))
    if options.at_most and not (row[-1] is not None and row[-1] <= options.at_most):
        problems.append(f"{scene}, thinner {thinner}: not within {options.at_most:g}")
print("\n".join(problems))
sys.exit(1 if problems else 0)
