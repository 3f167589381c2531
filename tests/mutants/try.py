#!/usr/bin/env python3
"""Tries the faults of mutants.json on a build of the tests: each is put in and has to fail a test.

    tests/mutants/try.py BUILD [NAME ...]

For each mutant, or those named: replaces its text, builds what the tests in its `killed_by` run, and runs these; if they
pass, builds everything and runs all tests. Before that the same tests have to pass without any mutant. The source is
restored after each, also if interrupted, and the build at the end. Exit status 1 if a mutant survives, 2 if one could not
be tried.
"""
import argparse
import json
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parent.parent


class Untried(Exception):
    """Nothing can be said about a mutant."""


class Build:
    def __init__(self, folder: Path):
        self.folder = folder.resolve()

    def targets(self, regex: str) -> list[str]:
        """What is built for the tests that the regular expression selects: the programs that they run."""
        listing = subprocess.run(["ctest", "--test-dir", self.folder, "--show-only=json-v1", "-R", regex],
                                 stdout=subprocess.PIPE, text=True, check=True).stdout
        tests = json.loads(listing)["tests"]
        if not tests or any("command" not in test for test in tests):
            raise Untried(f"{self.folder}: no built test is called {regex}; build all tests first")
        words = {Path(word) for test in tests for word in test["command"]}
        return sorted(str(word.relative_to(self.folder)) for word in words if word.is_relative_to(self.folder / "bin"))

    def make(self, targets: list[str]) -> None:
        command = ["cmake", "--build", self.folder, *(["--target", *targets] if targets else [])]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode != 0:
            raise Untried("it does not compile:\n" + "\n".join(done.stdout.splitlines()[-20:]))

    def failing(self, *selection: str) -> str:
        """The first test that fails of those selected; empty if all pass."""
        done = subprocess.run(["ctest", "--test-dir", self.folder, "--stop-on-failure", "--no-tests=error", *selection],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode == 0:
            return ""
        failed = re.search(r"^\s*\d+ - (\S+) \(", done.stdout, re.MULTILINE)
        if not failed:
            raise Untried("ctest failed without a test:\n" + done.stdout[-2000:])
        return failed[1]


def mutated(mutant: dict) -> str:
    """The file with the fault."""
    path = SOURCE / mutant["file"]
    text = path.read_text(encoding="utf-8") if path.is_file() else ""
    found = text.count(mutant["find"])
    if found != 1:
        raise Untried(f"{mutant['name']}: {mutant['file']} has {found} times what is to be replaced: {mutant['find']!r}")
    return text.replace(mutant["find"], mutant["replace"])


def killer(mutant: dict, build: Build) -> str:
    """The name of a test that fails with the mutant; empty if none does."""
    path = SOURCE / mutant["file"]
    original, fault = path.read_bytes(), mutated(mutant)
    try:
        path.write_text(fault, encoding="utf-8")
        build.make(build.targets(mutant["killed_by"]))
        killed = build.failing("-R", mutant["killed_by"])
        if not killed:
            print(f"{mutant['name']} passes {mutant['killed_by']}: trying all tests", file=sys.stderr)
            build.make([])
            killed = build.failing("-L", "^(fast|slow)$")
        return killed
    finally:
        path.write_bytes(original)


def chosen(names: list[str]) -> list[dict]:
    mutants = json.loads((HERE / "mutants.json").read_text(encoding="utf-8"))
    known = {mutant["name"] for mutant in mutants}
    if unknown := set(names) - known:
        raise Untried(f"no mutant is called {', '.join(sorted(unknown))}; there are {', '.join(sorted(known))}")
    return [mutant for mutant in mutants if mutant["name"] in names or not names]


def check(mutants: list[dict], build: Build) -> list[str]:
    """Refuses everything that would make a result mean nothing; returns what the tests run."""
    if subprocess.run(["git", "-C", SOURCE, "status", "--porcelain", "--untracked-files=no"], stdout=subprocess.PIPE,
                      check=True).stdout:
        raise Untried("the tree has changes that are not committed")
    for mutant in mutants:
        mutated(mutant)
    killers = sorted({mutant["killed_by"] for mutant in mutants})
    targets = sorted({target for regex in killers for target in build.targets(regex)})
    build.make(targets)
    for regex in killers:
        if failed := build.failing("-R", regex):
            raise Untried(f"{failed} fails without a mutant")
    return targets


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path, help="a build folder with all tests, such as build/release")
    parser.add_argument("names", nargs="*", metavar="NAME", help="mutants to try instead of all")
    options = parser.parse_args()
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # restores the source
    survivors = 0
    try:
        build, mutants = Build(options.build), chosen(options.names)
        targets = check(mutants, build)
        for mutant in mutants:
            began = time.monotonic()
            killed = killer(mutant, build)
            survivors += not killed
            print(f"{mutant['name']:32} {'killed by ' + killed if killed else 'SURVIVES: ' + mutant['meaning']}"
                  f"  ({time.monotonic() - began:.0f} s)", flush=True)
        build.make([] if survivors else targets)
        print(f"{len(mutants) - survivors} of {len(mutants)} killed")
    except Untried as problem:
        print(f"tests/mutants/try.py: {problem}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(f"interrupted: build {options.build} before its tests are run", file=sys.stderr)
        return 130
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
