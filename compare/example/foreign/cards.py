#!/usr/bin/env python3
"""The score cards of other people's simulators and of our own polygons: the tables of doc/simulators.md.

    cards.py DLO PAGE --with NAME=COMMAND... [--update | --hold] [OPTION...]

Runs `dlo suite` on the whole battery with N = 8, 16 and 32; `--with` and further options, such as --jobs and --state,
are the suite's. Each NAME is a row of the
page's first table and a column of its second one, where what it is stands already. --update writes what is found into
the page, --hold ends with exit status 1 if it is not what the page has; without these it is printed. Rows and columns of
simulators that are not named stay as they are.
"""

import argparse
import json
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

POINTS = 8
COUNTS = ("right", "wrong", "failed", "not supported")
SMALL = 1e-5  # error over the length below which the order is not meaningful
SHARE = 0.1  # of a number, by which it may differ where processors round otherwise


def cards(dlo, programs, more):
    """Runs `dlo suite` with the programs and returns the results table of each simulator, by its name."""
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "cards.json")
        words = [word for program in programs for word in ("--with", program)]
        run = subprocess.run([dlo, "suite", "--points", str(POINTS), "--time-limit", "300", *words, *more,
                              "-o", file], capture_output=True, text=True, check=False)
        if run.returncode != 0:
            sys.exit(f"cards.py: dlo suite: {run.stderr}")
        return {card["simulator"]: card for card in json.loads(pathlib.Path(file).read_text(encoding="utf-8"))["cards"]}


def order_words(card):
    """Returns the median order of convergence of scenes with an error above SMALL, and the smallest order."""
    orders = [scene["order"] for scene in card["scenes"]
              if scene["order"] is not None and scene["runs"][-1]["rms_over_length"] > SMALL]
    return f"{statistics.median(orders):.1f} ({min(orders):.1f})" if orders else "-"


def causes_words(card):
    """Returns each cause once, with the range of its factor and the number of scenes."""
    found = {}
    for scene in card["scenes"]:
        for cause in scene["causes"]:
            found.setdefault(cause["name"], []).append(cause["factor"])
    words = []
    for name, factors in found.items():
        known = sorted(f"{factor:.2g}" for factor in factors if factor is not None)
        sizes = " to ".join(dict.fromkeys((known[0], known[-1]))) if known else ""
        words.append(f"{name}{' ' + sizes if sizes else ''} ({len(factors)})")
    return ", ".join(words) or "none"


def row(card):
    total = card["total"]
    counts = (total["right"], total["solved"] - total["right"], total["failed"], total["not_supported"])
    return dict(zip(COUNTS, map(str, counts)), **{"order": order_words(card), "causes": causes_words(card)})


def column(card):
    """Returns the largest error at the largest N of each class, as text."""
    errors = {one["class"]: one["largest_rms_over_length"][-1] for one in card["classes"]}
    return {name: "-" if error is None else f"{error:.1e}" for name, error in errors.items()}


def last_digit_unit(number):
    """Returns the value of one unit in the last digit of a number that is given as text."""
    mantissa, _, exponent = number.partition("e")
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def same(ours, theirs):
    """Whether texts are equal, up to one unit in the last digit, or SHARE, of numbers with a point."""
    number = r"\d+\.\d+(?:e[-+]\d+)?"
    if re.sub(number, "#", ours) != re.sub(number, "#", theirs):
        return False
    return all(abs(float(a) - float(b)) <= max(1.01 * last_digit_unit(a), 1.01 * last_digit_unit(b), SHARE * float(a))
               for a, b in zip(re.findall(number, ours), re.findall(number, theirs)))


class Page:
    """A page with two tables: one has a row, the other a column for each simulator."""

    def __init__(self, file):
        self.file = pathlib.Path(file)
        self.lines = self.file.read_text(encoding="utf-8").split("\n")
        self.differences = []

    def table(self, first):
        """Returns the line indices and the column names of the table whose first column has this name."""
        begin = next(i for i, line in enumerate(self.lines) if line.startswith(f"| {first} |"))
        end = begin
        while self.lines[end].startswith("|"):
            end += 1
        return range(begin + 2, end), self.cells(begin)

    def cells(self, i):
        return [cell.strip() for cell in self.lines[i].strip("|").split("|")]

    def set(self, i, k, text):
        cells = self.cells(i)
        if not same(cells[k], text):
            self.differences.append(f"{self.file}:{i + 1}: {cells[0]}: {cells[k]} (now: {text})")
            cells[k] = text
            self.lines[i] = "| " + " | ".join(cells) + " |"

    def take(self, card):
        name = card["simulator"]
        lines, heads = self.table("simulator")
        mine = [i for i in lines if self.cells(i)[0].strip("[]`").split("]")[0].strip("`") == name]
        if not mine:
            sys.exit(f"cards.py: {self.file}: no row of {name}")
        for head, text in row(card).items():
            self.set(mine[0], heads.index(head), text)
        lines, heads = self.table("class")
        errors = column(card)
        for i in lines:
            self.set(i, heads.index(name), errors[self.cells(i)[0]])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dlo")
    parser.add_argument("page")
    parser.add_argument("--with", dest="programs", action="append", required=True)
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--update", action="store_true")
    what.add_argument("--hold", action="store_true")
    options, more = parser.parse_known_args()
    page = Page(options.page)
    for card in cards(options.dlo, options.programs, more).values():
        if options.update or options.hold:
            page.take(card)
        else:
            print(card["simulator"], row(card), column(card))
    print("\n".join(page.differences) or "the page has what was found")
    if options.update:
        new = page.file.with_name(page.file.name + ".new")
        new.write_text("\n".join(page.lines), encoding="utf-8")
        new.replace(page.file)
    return 1 if options.hold and page.differences else 0


if __name__ == "__main__":
    sys.exit(main())
