#!/usr/bin/env python3
"""Runs tests of a build that counts lines, and reports the fraction of the lines of four folders that they execute.

  cmake --preset coverage && cmake --build --preset coverage --target fast_tests program_test
  tests/mutants/coverage.py build/coverage >tests/mutants/coverage.txt

It first resets the counters and runs the tests: the fast tests, the tests that run the program, and the known answers.
A line, also of a header, is counted if a library of these folders has code for it, and is executed if any object file
has executed it. With --against FILE the exit status is 1 if the fraction of a folder is more than one percentage point
below the value in the file.
"""
import argparse
import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent.parent
FOLDERS = ("sim", "algorithms", "device_model", "results/observe")
# Selections of tests, as options of ctest. The names of GoogleTest suites contain no dot. The names of tests that are
# scripts contain a dot. The test Library is excluded, because it inspects the libraries, which contain counters of
# coverage in this build.
TESTS = (
    ["-L", "^fast$", "-E", "^Library[.]"],
    ["-L", "^slow$", "-E", "[.]"],
    ["-R", "^KnownAnswers[.]"],
)
# Largest allowed decrease of the executed fraction of a folder's lines [percentage points].
MAX_FALL = 1.0


def run_tests(build):
    for counts in build.rglob("*.gcda"):
        counts.unlink()
    for selection in TESTS:
        done = subprocess.run(
            ["ctest", "--test-dir", build, "--parallel", str(os.cpu_count()), *selection],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        if done.returncode != 0:
            print("\n".join(done.stdout.splitlines()[-20:]), file=sys.stderr)


def lines_of(notes):
    """Returns the lines of the source tree that have code in an object file, as a set of (file, line number, True if
    the line was executed). `notes`: the .gcno file of the object file."""
    report = json.loads(
        subprocess.run(
            ["gcov", "--json-format", "--stdout", notes],
            cwd=notes.parent,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            check=True,
        ).stdout
    )
    found = set()
    for file in report["files"]:
        path = Path(report["current_working_directory"], file["file"]).resolve()
        if path.is_relative_to(SOURCE):
            found |= {(path, line["line_number"], line["count"] != 0) for line in file["lines"]}
    return found


def counted(build):
    """Yields (folder, number of lines with code, number of executed lines) for each folder."""
    libraries = sorted({folder.split("/")[0] for folder in FOLDERS})
    notes = [
        file
        for library in libraries
        for file in (build / library).rglob("hapbench_*.dir/**/*.gcno")
    ]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = set().union(*pool.map(lines_of, notes))
    for folder in FOLDERS:
        lines = [
            (path, number, ran)
            for path, number, ran in found
            if path.is_relative_to(SOURCE / folder)
        ]
        yield folder, len({(path, number) for path, number, _ in lines}), sum(
            ran for _, _, ran in lines
        )


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("build", type=Path, help="a build folder of the preset coverage")
    parser.add_argument(
        "--against", type=Path, metavar="FILE", help="an earlier output to compare with"
    )
    options = parser.parse_args()
    build = options.build.resolve()
    run_tests(build)
    commit = subprocess.check_output(
        ["git", "-C", SOURCE, "describe", "--always", "--dirty"], text=True
    ).strip()
    print(
        f"# Lines of code that tests run, by gcov at commit {commit}: ctest "
        + "; ".join(map(" ".join, TESTS))
    )
    print(f"{'# folder':16}{'lines':>7}{'run':>7}{'%':>7}")
    percent = {}
    for folder, lines, ran in counted(build):
        percent[folder] = 100.0 * ran / lines if lines else 0.0
        print(f"{folder:16}{lines:7}{ran:7}{percent[folder]:7.1f}")
    earlier = options.against.read_text(encoding="utf-8") if options.against else ""
    rows = [row.split() for row in earlier.splitlines() if not row.startswith("#")]
    fallen = [row[0] for row in rows if percent[row[0]] < float(row[3]) - MAX_FALL]
    if fallen:
        print(
            f"more than {MAX_FALL} % below {options.against}: {', '.join(fallen)}", file=sys.stderr
        )
    return 1 if fallen else 0


if __name__ == "__main__":
    sys.exit(main())
