#!/usr/bin/env python3
"""Prints, for each of four folders, the number and percentage of lines that the tests execute.

  cmake --preset coverage && cmake --build --preset coverage --target fast_tests program_test
  tests/mutants/coverage.py build/coverage >tests/mutants/coverage.txt

The build must count executed lines (preset coverage). The script resets the counters and runs the
fast tests, the tests that run the program, and the tests with known answers. A line of a source or
header is counted if an object file of the libraries has code for this line. The line is executed if
the tests execute its code in at least one object file. If tests fail, the script prints the end of
the output of ctest and counts the lines anyway.

The exit status is 1 if a test fails or, with --against FILE, if the percentage of a folder is more
than one percentage point below the percentage in FILE.
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
    ["-L", "^slow$", "-E", "[.]|_NOT_BUILT$"],
    ["-R", "^KnownAnswers[.]"],
)
# Largest allowed decrease of the executed fraction of a folder's lines [percentage points].
MAX_FALL = 1.0


def run_tests(build):
    """Runs the tests and returns True if all pass. Prints the end of the output of a selection that fails."""
    all_pass = True
    for counts in build.rglob("*.gcda"):
        counts.unlink()
    for selection in TESTS:
        done = subprocess.run(
            ["ctest", "--test-dir", build, "--parallel", str(os.cpu_count()), *selection],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            # Tests kill programs, and a killed program can leave damaged counters. The messages about them would be
            # differences in tests that compare the standard error.
            env={**os.environ, "GCOV_ERROR_FILE": os.devnull},
        )
        if done.returncode != 0:
            all_pass = False
            print("\n".join(done.stdout.splitlines()[-20:]), file=sys.stderr)
    return all_pass


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
    parser.add_argument("build", type=Path, help="build folder of the preset coverage")
    parser.add_argument(
        "--against", type=Path, metavar="FILE", help="earlier output of this script to compare with"
    )
    options = parser.parse_args()
    build = options.build.resolve()
    all_pass = run_tests(build)
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
            f"more than {MAX_FALL} percentage points below {options.against}: {', '.join(fallen)}",
            file=sys.stderr,
        )
    return 0 if all_pass and not fallen else 1


if __name__ == "__main__":
    sys.exit(main())
