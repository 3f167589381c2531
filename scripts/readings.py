#!/usr/bin/env python3
"""Draws other readings of what the thesis leaves open, a row each, for hapbench reproduce --choices:

    scripts/readings.py 256 --calibrate >readings.csv

A Latin hypercube of the ranges and options of results/reference/choices.json: along each choice,
every reading lies in another of equal strata. With --calibrate a hand that is calibrated gets, in
each reading, the value at which its scenario has the raw points that it should, which takes some
runs of the built program. The strata of results/reference/readings.csv came from an
earlier generator, so no seed draws them again.
"""
import argparse
import csv
import json
import math
import random
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from fnmatch import fnmatchcase
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CHOICES = ROOT / "results" / "reference" / "choices.json"
PROGRAM = ROOT / "build" / "release" / "bin" / "hapbench"
TRIES, NEAR = 8, 0.03  # runs of a search, and how near the raw points must come


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


def run(scenario, sets, folder):
    """The summary of a run, without its tables."""
    words = [
        word
        for text in ("record.trajectory=false", "record.ratio_iterations=[]", "expect={}", *sets)
        for word in ("--set", text)
    ]
    done = subprocess.run(
        [PROGRAM, "run", scenario, *words, "--out", folder, "--quiet"],
        capture_output=True,
        text=True,
    )
    if done.returncode not in (
        0,
        3,
    ):  # 3: it ended otherwise than its scenario expects, as a short one may
        sys.exit(done.stderr)
    return json.loads((Path(folder) / "summary.json").read_text(encoding="utf-8"))


def sets_of(reading, choices, scenario, base):
    """The overrides that a reading makes to a scenario, whose fields are `base`."""
    sets = []
    for choice in choices:
        for field in choice.get("fields", []):
            if not any(fnmatchcase(scenario, pattern) for pattern in field["scenarios"]):
                continue
            text = reading[choice["id"]]
            if field.get("times"):
                node = base
                for key in field["path"].split("."):
                    node = node[int(key)] if isinstance(node, list) else node[key]
                text = repr(float(text) * node)
            sets.append(f"{field['path']}={text}")
    return sets


def calibrated(choice, reading, choices):
    """The value at which the scenario has its raw points, by secants in logarithms from the value
    on record; the points grow with it."""
    scenario, raw = choice["calibrated"]["scenario"], choice["calibrated"]["raw"]
    low, high = map(math.log, choice["range"])
    with tempfile.TemporaryDirectory(prefix="hapbench-readings-") as folder:
        run(scenario, ["time.duration_s=0.01"], folder)
        base = json.loads((Path(folder) / "scenario.effective.json").read_text(encoding="utf-8"))

        def excess(logarithm):
            sets = sets_of(
                reading | {choice["id"]: repr(math.exp(logarithm))}, choices, scenario, base
            )
            metrics = run(scenario, sets, folder)["metrics"]
            return math.log(
                max(metrics["colliding_mean"] / max(metrics["contact_share"], 1e-9), 1e-9) / raw
            )

        at, slope, before = math.log(choice["value"]), 1.0, None
        for _ in range(TRIES):
            off = excess(at)
            if abs(off) <= NEAR:
                break
            if before and off != before[1]:
                slope = min(max((off - before[1]) / (at - before[0]), 0.3), 5.0)
            before, at = (at, off), min(max(at - off / slope, low), high)
            if at == before[0]:
                break  # an end of the range
        return f"{math.exp(at):.6g}"


def calibrate(readings, choices, jobs):
    for choice in choices:
        if "calibrated" not in choice:
            continue
        with ThreadPoolExecutor(jobs) as pool:
            values = list(pool.map(lambda reading: calibrated(choice, reading, choices), readings))
        for reading, found in zip(readings, values):
            reading[choice["id"]] = found


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("count", type=int, help="readings to draw")
    parser.add_argument("--seed", type=int, default=1, help="of the random numbers (default: 1)")
    parser.add_argument(
        "--choices",
        type=Path,
        default=CHOICES,
        help="another file in place of results/reference/choices.json",
    )
    parser.add_argument(
        "--calibrate",
        action="store_true",
        help="search the values of calibrated choices, with the built program",
    )
    parser.add_argument("--jobs", type=int, default=2, help="runs at once (default: 2)")
    options = parser.parse_args()
    if options.count < 1:
        parser.error(f"count: got {options.count}; allowed: at least 1")
    choices = json.loads(options.choices.read_text(encoding="utf-8"))["choices"]
    columns = [column(choice, options.count, options.seed) for choice in choices]
    readings = [dict(zip((choice["id"] for choice in choices), row)) for row in zip(*columns)]
    if options.calibrate:
        calibrate(readings, choices, options.jobs)
    writer = csv.DictWriter(sys.stdout, [choice["id"] for choice in choices], lineterminator="\n")
    writer.writeheader()
    writer.writerows(readings)


if __name__ == "__main__":
    main()
