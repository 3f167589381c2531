"""Checks that `run` does not condemn what `tune` recommends: for random bundled scenes, with the device of the scene
and with two devices of the library, without bounds and with two bounds. As a script:

    tests/scripts/recommendations.py PROGRAM [--cases N] [--seed S] [--log FILE] [--seconds T]

judges N cases (default 24; all: every case, many hours). A case whose search takes more than T seconds
of processor time (default 60) counts as unfinished. With --log, each judged case is written to a file, and a further
call judges only cases that the file lacks, or that were unfinished after less than T seconds.
"""
import argparse
import json
import random
import resource
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

LIBRARY = Path(__file__).resolve().parents[2] / "scenarios/library"
GROUPS = ("examples", "beyond", "thesis", "limits", "validation")
DEVICES = ("own", "touch", "omega.3")
BOUNDS = {"force_rms_above_30Hz_N": 0.05, "inside_max_m": 5e-4}
# Rules of the diagnosis that condemn a recommendation: the run fails, or a hand feels more than the force. Other rules
# give hints that do not concern stiffness, damping and law, such as a motor that saturates. The list stands here and is
# not read from the program, because `tune` rejects a choice by the program's list.
CONDEMN = {"fault", "diverged", "sank", "lost", "stuck", "servo", "edge", "loop"}
CONDEMN |= {"buzz", "pop", "shake", "bounces", "chatter", "energy"}


def all_cases(seed):
    """Returns (scene, device, with bounds) of every case, in random order. The scene is its path in the library."""
    scenes = [
        f"{group}/{file.name}"
        for group in GROUPS
        for file in sorted((LIBRARY / group).glob("*.json"))
    ]
    cases = [
        (scene, device, bound) for scene in scenes for device in DEVICES for bound in (False, True)
    ]
    random.Random(seed).shuffle(cases)
    return cases


def ran(*words, **options):
    return subprocess.run([*map(str, words)], capture_output=True, text=True, **options)


def faults(run, bound):
    """Returns what a finished run says against the recommendation."""
    if run.returncode:
        return [f"exit status {run.returncode}: {run.stderr.strip()}"]
    [summary] = json.loads(run.stdout)
    found = [one["rule"] for one in summary["diagnosis"] if one["rule"] in CONDEMN]
    for metric, most in BOUNDS.items() if bound else ():
        value = summary["metrics"].get(metric)
        if value is not None and value > most:
            found.append(f"{metric} = {value}, bound {most}")
    return found


def judged(program, seconds, scene, device, bound):
    """Returns a dictionary with the answer of `tune` (recommended, infeasible, refused or unfinished) and, for a
    recommendation, the faults that `run` finds."""
    with tempfile.TemporaryDirectory() as folder:
        words = [program, "tune", LIBRARY / scene, "--json", "--jobs", 1, "--out", f"{folder}/tune"]
        words += [] if device == "own" else ["--device", device]
        for metric, most in BOUNDS.items() if bound else ():
            words += ["--bound", f"{metric}={most}"]
        tuned = ran(
            *words,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds)),
        )
        case = {"case": [scene, device, bound], "faults": []}
        if tuned.returncode < 0:
            return {**case, "answer": "unfinished", "seconds": seconds}
        if tuned.returncode == 2:
            return {**case, "answer": "refused", "why": tuned.stderr.strip()}
        if tuned.returncode not in (0, 3):
            return {**case, "answer": "failed", "faults": [tuned.stderr.strip()]}
        answer = json.loads(tuned.stdout)
        if not answer.get("scenario"):
            return {**case, "answer": "infeasible", "why": answer["algorithms"][0]["why"]}
        run = ran(program, "run", answer["scenario"], "--json", "--out", f"{folder}/run")
        return {**case, "answer": "recommended", "faults": faults(run, bound)}


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("program", type=Path)
    parser.add_argument("--cases", default="24")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--log", type=Path)
    parser.add_argument("--seconds", type=int, default=60)
    options = parser.parse_args()
    cases = all_cases(options.seed)
    if options.cases != "all":
        cases = cases[: int(options.cases)]
    known = []
    if options.log and options.log.exists():
        logged = [json.loads(line) for line in options.log.read_text(encoding="utf-8").splitlines()]
        # The last entry of a case counts.
        last = {tuple(one["case"]): one for one in logged}
        known = [
            one
            for one in last.values()
            if one["answer"] != "unfinished" or one["seconds"] >= options.seconds
        ]
    done = {tuple(one["case"]) for one in known}
    with ThreadPoolExecutor(2) as workers:
        new = workers.map(
            lambda case: judged(options.program.resolve(), options.seconds, *case),
            [case for case in cases if case not in done],
        )
        for one in new:
            known.append(one)
            if options.log:
                with options.log.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(one) + "\n")
    rules = json.loads(ran(options.program, "describe", "diagnosis", "--json", check=True).stdout)
    if (kinds := {rule["rule"] for rule in rules if rule["kind"] != "hint"}) != CONDEMN:
        print(
            "rules of failure and vibration differ from the list of this script:",
            *(kinds ^ CONDEMN),
        )
        return 1
    answers = [one["answer"] for one in known]
    counts = ", ".join(f"{answers.count(answer)} {answer}" for answer in sorted(set(answers)))
    print(f"{len(known)} cases: {counts}")
    condemned = [one for one in known if one["faults"]]
    for one in condemned:
        print(*one["case"], "; ".join(one["faults"]), sep=" | ")
    if "recommended" not in answers:
        print("no case has a recommendation, so that nothing was tested")
    return bool(condemned) or "recommended" not in answers


if __name__ == "__main__":
    sys.exit(main())
