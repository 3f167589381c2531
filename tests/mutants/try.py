#!/usr/bin/env python3
"""Checks that the tests detect each fault (mutant) of mutants.json.

  tests/mutants/try.py [BUILD [NAME ...]]

Tries each mutant, or only the mutants NAME. First, the tests that should detect the mutants must
pass without any mutant. Then, for each mutant, the script inserts the fault into the source, builds
the tests of this mutant (field `killed_by`) in BUILD and runs them. If a test fails, this test has
killed the mutant; if all tests pass, the mutant survives. After each mutant, the script restores
the source; after the last mutant, it builds the tests without a fault. After an interruption, the
source is restored, but tests in BUILD may contain a mutant.

The exit status is 1 if a mutant survives, and 2 if a mutant could not be tried. Without BUILD, the
script only checks that the text to replace occurs exactly once in the file of each mutant.
"""
import argparse
import json
import re
import signal
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parent.parent


def output_of(*words):
    done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return done.returncode, done.stdout


def make(build, regex):
    """Builds the programs of the tests whose names match the regular expression."""
    tests = json.loads(
        output_of("ctest", "--test-dir", build, "--show-only=json-v1", "-R", regex)[1]
    )["tests"]
    if not tests or any("command" not in test for test in tests):
        raise RuntimeError(
            f"{build}: no built test has a name that matches {regex}; build all tests first"
        )
    programs = {
        word
        for test in tests
        for word in test["command"]
        if Path(word).is_relative_to(build / "bin")
    }
    status, output = output_of(
        "cmake",
        "--build",
        build,
        "--target",
        *sorted(str(Path(word).relative_to(build)) for word in programs),
    )
    if status:
        raise RuntimeError(
            f"{build}: the tests do not compile:\n" + "\n".join(output.splitlines()[-20:])
        )


def failing(build, regex):
    """Runs the tests whose names match the regular expression, and returns the name of the first failing test; empty if
    all pass."""
    status, output = output_of(
        "ctest", "--test-dir", build, "--stop-on-failure", "--no-tests=error", "-R", regex
    )
    failed = re.search(r"^\s*\d+ - (\S+) \(", output, re.MULTILINE)
    if status and not failed:
        raise RuntimeError("ctest failed, but reported no failed test:\n" + output[-2000:])
    return failed[1] if status else ""


def mutated(mutant):
    path = SOURCE / mutant["file"]
    text = path.read_text(encoding="utf-8") if path.is_file() else ""
    if (times := text.count(mutant["find"])) != 1:
        raise RuntimeError(
            f"{mutant['name']}: {mutant['file']} must contain this text once, but contains it {times} times: "
            f"{mutant['find']!r}"
        )
    return text.replace(mutant["find"], mutant["replace"])


def killer(mutant, build):
    """Puts the mutant into its file, builds its tests and runs them. Returns the name of a failing test; empty if none
    fails. Restores the file."""
    path = SOURCE / mutant["file"]
    original, fault = path.read_bytes(), mutated(mutant)
    try:
        path.write_text(fault, encoding="utf-8")
        make(build, mutant["killed_by"])
        return failing(build, mutant["killed_by"])
    finally:
        path.write_bytes(original)


def tried(build, names):
    """Tries the mutants `names` (empty: all) and returns the number of surviving mutants. Without a `build`, only
    checks the mutants."""
    mutants = json.loads((HERE / "mutants.json").read_text(encoding="utf-8"))
    if unknown := set(names) - {mutant["name"] for mutant in mutants}:
        raise RuntimeError(f"no mutant is called {', '.join(sorted(unknown))}")
    mutants = [mutant for mutant in mutants if mutant["name"] in names or not names]
    for mutant in mutants:
        mutated(mutant)
    if build is None:
        return 0
    if output_of("git", "-C", SOURCE, "status", "--porcelain", "--untracked-files=no")[1]:
        raise RuntimeError("the working tree has uncommitted changes; commit them first")
    killers = "|".join(sorted({mutant["killed_by"] for mutant in mutants}))
    make(build, killers)
    if failed := failing(build, killers):
        raise RuntimeError(f"{failed} fails without a mutant")
    survivors = 0
    for mutant in mutants:
        killed = killer(mutant, build)
        survivors += not killed
        print(
            f"{mutant['name']:32} {'killed by ' + killed if killed else 'SURVIVES: ' + mutant['meaning']}",
            flush=True,
        )
    make(build, killers)
    print(f"{len(mutants) - survivors} of {len(mutants)} killed")
    return survivors


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "build", type=Path, nargs="?", help="build folder with all tests, such as build/release"
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="mutants to try (default: all)")
    options = parser.parse_args()
    signal.signal(
        signal.SIGTERM, signal.default_int_handler
    )  # SIGTERM then restores the source, as Ctrl-C does
    try:
        return 1 if tried(options.build and options.build.resolve(), options.names) else 0
    except RuntimeError as problem:
        print(f"tests/mutants/try.py: {problem}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(
            f"interrupted; tests in {options.build} may contain a mutant: build them again before you run them",
            file=sys.stderr,
        )
        return 130


if __name__ == "__main__":
    sys.exit(main())
