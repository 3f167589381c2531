#!/usr/bin/env python3
"""Draws other readings of what the thesis leaves open, a row each, for hapbench reproduce --choices:

    scripts/readings.py 256 >readings.csv

A Latin hypercube of the ranges and options of results/reference/choices.json: along each choice, every reading lies in another of
equal strata. Those of results/reference/readings.csv came from the generator of the program of commit 661d2580, so no seed draws
them again.
"""
import argparse
import csv
import json
import random
import sys
from pathlib import Path

CHOICES = Path(__file__).resolve().parents[1] / "results" / "reference" / "choices.json"


def value(choice, part):
    """What the choice is at a part in [0, 1) of its range or its options."""
    if "options" in choice:
        return choice["options"][int(part * len(choice["options"]))]
    low, high = choice["range"]
    at = low * (high / low) ** part if choice.get("scale") == "log" else low + part * (high - low)
    return f"{at:.6g}"


def column(choice, count, seed):
    """The values of a choice, from random numbers of its own: a choice that is added leaves the others as they are."""
    draw = random.Random(f"{seed} {choice['id']}")
    strata = draw.sample(range(count), count)
    return [value(choice, (stratum + draw.random()) / count) for stratum in strata]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", type=int, help="readings to draw")
    parser.add_argument("--seed", type=int, default=1, help="of the random numbers (default: 1)")
    parser.add_argument("--choices", type=Path, default=CHOICES, help="another file in place of results/reference/choices.json")
    options = parser.parse_args()
    if options.count < 1:
        parser.error(f"count: got {options.count}; allowed: at least 1")
    choices = json.loads(options.choices.read_text(encoding="utf-8"))["choices"]
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(choice["id"] for choice in choices)
    writer.writerows(zip(*(column(choice, options.count, options.seed) for choice in choices)))


if __name__ == "__main__":
    main()
