#!/usr/bin/env python3
"""Judges the claims of the thesis with programs that have a deliberate fault (a control).

    tests/mutants/controls.py [BUILD] [--only NAME,...] [--claims ID,...]

Most controls make a law wrong. If the verdict on a claim is the same with every wrong law, the rule
of this claim proves nothing.

For each control of controls.json, the script inserts the fault into the source, builds hapbench in
BUILD, judges the claims with this program (hapbench reproduce), restores the source, and writes the
verdicts to the record results/reference/controls.json. After an interruption, the source is
restored, but hapbench in BUILD may contain a fault.

Claims about computing time and claims that are not testable are never judged. Without --claims, the
claims of appendix D are omitted, too, because they take a minute with each control.

The script judges only cases (a control and a claim) that are missing in the record, or whose claim
has a new verdict or number in results/reference/claims.json. After an interruption, repeat the
command to continue. Other changes, such as a new rule that gives the same verdict and number, or a
new text of a control, are not detected: delete the record to judge all cases again.

Without BUILD, the script only checks that the text to replace occurs exactly once in the file of
each control. From the record, scripts/docs writes a table of scenarios/thesis/README.md.
"""
import argparse
import importlib
import json
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
mutants = importlib.import_module("try")  # imported by name, because `try` is a keyword of Python

REFERENCE = mutants.SOURCE / "results" / "reference"
RECORD = REFERENCE / "controls.json"
NOT_MEASURED = "not measured"  # verdict if a run diverged, so that the rule has no number to judge


def read(file):
    return json.loads(file.read_text(encoding="utf-8"))


def program_of(build):
    status, output = mutants.output_of("cmake", "--build", build, "--target", "bin/hapbench")
    if status:
        raise RuntimeError(
            f"{build}: hapbench does not compile:\n" + "\n".join(output.splitlines()[-20:])
        )
    return build / "bin" / "hapbench"


def verdicts(program, ids):
    """Returns the verdict and the number of each claim by its identifier. If the command fails for several claims,
    judges each half separately. A single claim for which the command fails is "not measured"."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [program, "reproduce", "--only", ",".join(ids), "--out", folder, "--json"],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
    if done.returncode in (0, 3):  # 3: a run did not end as its scenario expects
        return {claim["id"]: claim for claim in json.loads(done.stdout)["claims"]}
    if len(ids) == 1:
        return {ids[0]: {"verdict": NOT_MEASURED, "number": ""}}
    half = len(ids) // 2
    return {**verdicts(program, ids[:half]), **verdicts(program, ids[half:])}


def faults(control):
    """Returns the text with the fault for each file of the control. The field `file` may be a pattern; the fault is
    then put into every file that contains the text to replace."""
    files = sorted(mutants.SOURCE.glob(control["file"]))
    if "*" in control["file"]:
        files = [path for path in files if control["find"] in path.read_text(encoding="utf-8")]
    texts = {
        path: mutants.mutated({**control, "file": str(path.relative_to(mutants.SOURCE))})
        for path in files
    }
    if not texts:
        raise RuntimeError(
            f"{control['name']}: no file {control['file']} contains {control['find']!r}"
        )
    return texts


def with_fault(control, work):
    """Puts the fault into its files, calls `work()`, restores the files, and returns the result of work()."""
    texts = faults(control)
    originals = {path: path.read_bytes() for path in texts}
    try:
        for path, text in texts.items():
            path.write_text(text, encoding="utf-8")
        return work()
    finally:
        for path, original in originals.items():
            path.write_bytes(original)


def write(record):
    """Writes the record, with one line for each case, so that a comparison of two versions shows the changed cases."""
    lines = [
        f'    {{"name": {json.dumps(one["name"])}, "meaning": {json.dumps(one["meaning"])}, "cases": [\n'
        + ",\n".join("      " + json.dumps(case, ensure_ascii=False) for case in one["cases"])
        + "]}"
        for one in record
    ]
    about = "Verdicts with a wrong law; made by tests/mutants/controls.py."
    RECORD.write_text(
        f'{{\n  "about": "{about}",\n  "controls": [\n' + ",\n".join(lines) + "\n  ]\n}\n",
        encoding="utf-8",
    )


def judged(build, controls, claims):
    recorded = read(RECORD)["controls"] if RECORD.exists() else []
    for control in controls:
        entry = next((one for one in recorded if one["name"] == control["name"]), None)
        if entry is None:
            entry = {"name": control["name"], "cases": []}
            recorded.append(entry)
        entry["meaning"] = control["meaning"]
        # Keep only cases that were compared with the verdict and number that claims.json has now.
        now = {
            claim["id"]: [claim["verdict"], claim["number"]]
            for claim in read(REFERENCE / "claims.json")["claims"]
        }
        entry["cases"] = [
            case for case in entry["cases"] if case["recorded"] == now.get(case["id"])
        ]
        known = {case["id"] for case in entry["cases"]}
        missing = [claim for claim in claims if claim not in known]
        if not missing:
            continue
        found = with_fault(control, lambda: verdicts(program_of(build), missing))
        if all(found[claim]["verdict"] == NOT_MEASURED for claim in missing):
            raise RuntimeError(
                f"{control['name']}: hapbench with this fault judged no claim; check that hapbench runs at all"
            )
        entry["cases"] += [
            {
                "id": claim,
                "recorded": now[claim],
                "verdict": found[claim]["verdict"],
                "number": found[claim]["number"],
            }
            for claim in missing
        ]
        write(recorded)
        moved = sum(case["verdict"] != case["recorded"][0] for case in entry["cases"])
        print(f"{control['name']:20} changes {moved} of {len(entry['cases'])} verdicts", flush=True)
    program_of(build)


def chosen(all_of, names, what):
    if unknown := set(names) - set(all_of):
        raise RuntimeError(f"no {what} is called {', '.join(sorted(unknown))}")
    return [name for name in all_of if name in names or not names]


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "build",
        type=Path,
        nargs="?",
        help="build folder, such as build/release (default: only check the controls)",
    )
    parser.add_argument(
        "--only",
        default="",
        help="names of the controls to use, separated by commas (default: all)",
    )
    parser.add_argument(
        "--claims",
        default="",
        help="ids of the claims to judge, separated by commas (default: see above)",
    )
    options = parser.parse_args()
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # restores the source
    listed = lambda text: [name for name in text.split(",") if name]  # noqa: E731
    try:
        controls = {one["name"]: one for one in read(HERE / "controls.json")}
        names = chosen(list(controls), listed(options.only), "control")
        for name in names:
            faults(controls[name])
        if options.build is None:
            return 0
        ledger = [
            claim
            for claim in read(REFERENCE / "claims.json")["claims"]
            if not claim["timing"] and claim["verdict"] != "not testable"
        ]
        wanted = listed(options.claims)
        claims = chosen([claim["id"] for claim in ledger], wanted, "judged claim")
        if not wanted:
            claims = [claim for claim in claims if not claim.startswith("D")]
        judged(options.build.resolve(), [controls[name] for name in names], claims)
        return 0
    except RuntimeError as problem:
        print(f"tests/mutants/controls.py: {problem}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(
            f"interrupted; hapbench in {options.build} may contain a fault: build it again before you use it",
            file=sys.stderr,
        )
        return 130


if __name__ == "__main__":
    sys.exit(main())
