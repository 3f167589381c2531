#!/usr/bin/env python3
"""Judges claims of the thesis with two of their deciding assumptions changed at the same time:

    scripts/decider_pairs.py build/release/bin/hapbench [--claims ID,...] [--jobs N]

An assumption decides a claim if another value of this assumption alone changes the verdict. If
several assumptions decide a claim, this script takes for each of them the first value in
results/reference/sensitivity.json that changes the verdict. It judges the claim with every pair of
these values (hapbench reproduce --assumptions). If several claims have the same pair of values, one
run judges all of these claims. All pairs of the claims of appendix D take two hours on one
processor, all other pairs ten minutes.

After each run, the script writes the verdicts to results/reference/pairs.json. After an
interruption, repeat the command: it runs only pairs without a recorded verdict. A recorded verdict
is kept while the verdict on the claim and the two values with their verdicts are the same. Changes
of the program are not detected: to judge all pairs again, delete pairs.json. From pairs.json,
scripts/docs writes a table of scenarios/thesis/README.md.
"""
import argparse
import csv
import itertools
import json
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor, as_completed
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


def pairs_to_judge(claims, cases):
    """Returns the claims that several assumptions decide, as entries of pairs.json whose pairs have no verdict yet."""
    entries = []
    for claim in claims:
        values = deciding_values(claim, cases.get(claim["id"], []))
        pairs = [
            {
                "values": {name: values[name][0] for name in pair},
                "alone": [values[name][1] for name in pair],
            }
            for pair in itertools.combinations(values, 2)
        ]
        if pairs:
            entries.append({"id": claim["id"], "verdict": claim["verdict"], "pairs": pairs})
    return entries


def key_of(pair):
    return json.dumps([pair["values"], pair["alone"]])


def take_from_record(entries, record):
    """Copies into `entries` the verdicts of pairs that `record` has. A pair in `record` is used only if it has the same
    claim, the same values, and the same verdicts: of the claim, and with each of the two values alone.
    """
    known = {
        (claim["id"], claim["verdict"], key_of(pair)): pair
        for claim in record
        for pair in claim["pairs"]
    }
    for entry in entries:
        for pair in entry["pairs"]:
            pair.update(known.get((entry["id"], entry["verdict"], key_of(pair)), {}))


def judged(program, claims, values):
    """Returns the verdict and the number of each claim in `claims`, with the assumptions changed to `values`."""
    with tempfile.TemporaryDirectory() as folder:
        sets = Path(folder) / "sets.csv"
        with open(sets, "w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows([values.keys(), values.values()])
        command = [program, "reproduce", "--jobs", "1", "--only", ",".join(claims)]
        command += ["--assumptions", sets, "--out", folder, "--json"]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode:
        raise RuntimeError(f"{', '.join(claims)}, {' and '.join(values)}: {done.stderr.strip()}")
    [judged_set] = json.loads(done.stdout)["assumption_sets"]
    return {case["id"]: (case["verdict"], case["number"]) for case in judged_set["claims"]}


def write(entries):
    """Writes the pairs that have a verdict to pairs.json, with one line for each pair, so that a comparison of two
    versions shows the changed pairs."""
    lines = []
    for entry in entries:
        pairs = [pair for pair in entry["pairs"] if "verdict" in pair]
        if pairs:
            lines.append(
                f'    {{"id": "{entry["id"]}", "verdict": "{entry["verdict"]}", "pairs": [\n'
                + ",\n".join("      " + json.dumps(pair, ensure_ascii=False) for pair in pairs)
                + "]}"
            )
    about = (
        "Verdicts with two deciding assumptions changed at once; made by scripts/decider_pairs.py."
    )
    text = f'{{\n  "about": "{about}",\n  "claims": [\n' + ",\n".join(lines) + "\n  ]\n}\n"
    unfinished = RECORD.with_suffix(".unfinished")
    unfinished.write_text(text, encoding="utf-8")
    unfinished.replace(RECORD)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "program", type=Path, help="path of hapbench, such as build/release/bin/hapbench"
    )
    parser.add_argument(
        "--claims",
        default="",
        help="ids of the claims to judge, separated by commas (default: all)",
    )
    parser.add_argument("--jobs", type=int, default=1, help="number of parallel runs (default: 1)")
    options = parser.parse_args()
    wanted = [name for name in options.claims.split(",") if name]
    cases = {entry["id"]: entry["cases"] for entry in read("sensitivity.json")}
    entries = pairs_to_judge(read("claims.json"), cases)
    take_from_record(entries, read("pairs.json") if RECORD.exists() else [])

    # Claims with few pairs come first. If the command is interrupted, more claims then have verdicts for all pairs.
    missing = {}
    for entry in sorted(entries, key=lambda entry: len(entry["pairs"])):
        for pair in entry["pairs"]:
            if "verdict" not in pair and (not wanted or entry["id"] in wanted):
                missing.setdefault(json.dumps(pair["values"]), {})[entry["id"]] = pair
    with ThreadPoolExecutor(max_workers=options.jobs) as workers:
        runs = {
            workers.submit(judged, options.program.resolve(), list(pairs), json.loads(text)): pairs
            for text, pairs in missing.items()
        }
        try:
            for done, run in enumerate(as_completed(runs), 1):
                for claim, pair in runs[run].items():
                    pair["verdict"], pair["number"] = run.result()[claim]
                write(entries)
                print(f"{done} of {len(runs)} runs", flush=True)
        except RuntimeError as problem:
            workers.shutdown(cancel_futures=True)
            print(f"scripts/decider_pairs.py: {problem}", file=sys.stderr)
            return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
