#!/usr/bin/env python3
"""Judges claims with two of their deciding assumptions changed at once:

    scripts/decider_pairs.py build/release/bin/hapbench [--claims ID,...]

For each claim that several assumptions decide, takes of each such assumption the first value in
results/reference/sensitivity.json that changes the verdict, and judges every pair of
these values with hapbench reproduce --assumptions. Adds the verdicts to results/reference/pairs.json;
claims on record are kept, so an interrupted command continues. Without --claims, the claims of
appendix D, whose pairs take hours, are left out. scripts/docs writes the table of
scenarios/thesis/README.md.
"""
import argparse
import csv
import itertools
import json
import subprocess
import sys
import tempfile
from pathlib import Path

REFERENCE = Path(__file__).resolve().parents[1] / "results" / "reference"
RECORD = REFERENCE / "pairs.json"


def read(name):
    return json.loads((REFERENCE / name).read_text(encoding="utf-8"))["claims"]


def deciding_values(claim, cases):
    """Returns (value, verdict) for each assumption that changes the verdict of the claim: the first recorded value that
    changes the verdict, and the verdict at this value. Values without a verdict are skipped."""
    values = {}
    for case in cases:
        changes = case["verdict"] not in (claim["verdict"], "not judged", "not measured")
        if changes:
            values.setdefault(case["assumption"], (case["value"], case["verdict"]))
    return values


def judged(program, claim, values):
    """Returns the verdict and the number of the claim for each pair of assumptions. `values`: result of
    deciding_values()."""
    pairs = list(itertools.combinations(values, 2))
    with tempfile.TemporaryDirectory() as folder:
        # Each pair needs its own file of assumption sets: all sets of a file have the same columns, and a pair without
        # a calibrated input must not set this input.
        found = []
        for pair in pairs:
            sets = Path(folder) / "sets.csv"
            with open(sets, "w", newline="", encoding="utf-8") as file:
                csv.writer(file, lineterminator="\n").writerows(
                    [pair, [values[name][0] for name in pair]]
                )
            command = [
                program,
                "reproduce",
                "--only",
                claim,
                "--assumptions",
                sets,
                "--out",
                folder,
                "--json",
            ]
            done = subprocess.run(
                command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
            )
            if done.returncode:
                raise RuntimeError(f"{claim}, {' and '.join(pair)}: {done.stderr.strip()}")
            [case] = json.loads(done.stdout)["assumption_sets"][0]["claims"]
            found.append(
                {
                    "values": {name: values[name][0] for name in pair},
                    "alone": [values[name][1] for name in pair],
                    "verdict": case["verdict"],
                    "number": case["number"],
                }
            )
    return found


def write(record):
    """Writes `record` to pairs.json, with one line for each pair, so that a comparison of two versions shows the
    changed pairs."""
    lines = [
        f'    {{"id": "{one["id"]}", "verdict": "{one["verdict"]}", "pairs": [\n'
        + ",\n".join("      " + json.dumps(pair, ensure_ascii=False) for pair in one["pairs"])
        + "]}"
        for one in record
    ]
    about = (
        "Verdicts with two deciding assumptions changed at once; made by scripts/decider_pairs.py."
    )
    RECORD.write_text(
        f'{{\n  "about": "{about}",\n  "claims": [\n' + ",\n".join(lines) + "\n  ]\n}\n",
        encoding="utf-8",
    )


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "program", type=Path, help="the program, such as build/release/bin/hapbench"
    )
    parser.add_argument("--claims", default="", help="claims to judge")
    options = parser.parse_args()
    wanted = [name for name in options.claims.split(",") if name]
    cases = {entry["id"]: entry["cases"] for entry in read("sensitivity.json")}
    record = read("pairs.json") if RECORD.exists() else []
    ids = []
    for claim in read("claims.json"):
        ids.append(claim["id"])
        if not (claim["id"] in wanted if wanted else not claim["id"].startswith("D")):
            continue
        values = deciding_values(claim, cases.get(claim["id"], []))
        known = next((one for one in record if one["id"] == claim["id"]), None)
        pairs = [
            dict(zip(pair, (values[name][0] for name in pair)))
            for pair in itertools.combinations(values, 2)
        ]
        same = known and known["verdict"] == claim["verdict"]
        if not pairs or same and [one["values"] for one in known["pairs"]] == pairs:
            continue
        record = [one for one in record if one["id"] != claim["id"]]
        try:
            found = judged(options.program.resolve(), claim["id"], values)
        except RuntimeError as problem:
            print(f"scripts/decider_pairs.py: {problem}", file=sys.stderr)
            return 2
        record.append({"id": claim["id"], "verdict": claim["verdict"], "pairs": found})
        write(record)
        print(f"{claim['id']:4} {len(found)} pairs", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
