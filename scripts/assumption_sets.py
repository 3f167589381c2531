#!/usr/bin/env python3
"""Draws random assumption sets, one per row of a CSV table, for hapbench reproduce --assumptions:

    scripts/assumption_sets.py 16 >sets.csv

The sets are a Latin hypercube: the range (or list of options) of each assumption in
results/reference/assumptions.json is divided into as many equal parts as there are sets, and every
set has a value from a different part. The sets change all assumptions at once. They therefore show
interactions, which a change of a single assumption cannot show. Calibrated inputs have no column,
because hapbench reproduce calibrates them again for each set.
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
    parser.add_argument("count", type=int, help="number of sets to draw")
    parser.add_argument(
        "--seed", type=int, default=1, help="seed of the random numbers (default: 1)"
    )
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
