#!/usr/bin/env python3
"""Draws assumption sets, a row each, for hapbench reproduce --assumptions:

    scripts/assumption_sets.py 16 >sets.csv

A Latin hypercube of the ranges and options of results/reference/assumptions.json: along each
assumption, every set lies in another of equal strata. It shows interactions, which one assumption at
a time cannot. Calibrated inputs have no column: reproduce calibrates them anew in each set.
"""
import argparse
import csv
import json
import random
import sys
from pathlib import Path

ASSUMPTIONS = Path(__file__).resolve().parents[1] / "results" / "reference" / "assumptions.json"


def value(assumption, part):
    """Returns the value of an assumption at the fraction `part`, in [0, 1), of its range or of its list of options."""
    if "options" in assumption:
        return assumption["options"][int(part * len(assumption["options"]))]
    low, high = assumption["range"]
    if assumption.get("scale") == "log":
        return f"{low * (high / low) ** part:.6g}"
    return f"{low + part * (high - low):.6g}"


def column(assumption, count, seed):
    """Returns the values of an assumption in the `count` sets, in random order. The range is divided into `count` equal
    parts (strata), and each part contributes one random value. Each assumption has a separate random generator, so that
    a new assumption does not change the values of the other assumptions."""
    draw = random.Random(f"{seed} {assumption['id']}")
    strata = draw.sample(range(count), count)
    return [value(assumption, (stratum + draw.random()) / count) for stratum in strata]


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("count", type=int, help="sets to draw")
    parser.add_argument("--seed", type=int, default=1, help="of the random numbers (default: 1)")
    options = parser.parse_args()
    if options.count < 1:
        parser.error(f"count: got {options.count}; allowed: at least 1")
    recorded = json.loads(ASSUMPTIONS.read_text(encoding="utf-8"))["assumptions"]
    free = [assumption for assumption in recorded if "calibrated" not in assumption]
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(assumption["id"] for assumption in free)
    writer.writerows(zip(*(column(assumption, options.count, options.seed) for assumption in free)))


if __name__ == "__main__":
    main()
