#!/usr/bin/env python3
"""Runs tests of a build that counts lines, and tells what share of the lines of four folders they run.

    cmake --preset coverage && cmake --build --preset coverage --target fast_tests program_test
    tests/mutants/coverage.py build/coverage >tests/mutants/coverage.txt

It first forgets what was counted and runs the tests: the fast ones, those that run the program, and the known answers. A line counts, in headers too, if a library of these folders has code of it, and as run if any of its object
files has run it. With --against FILE the exit status is 1 if the share of a folder is more than one per cent below that.
"""
import argparse
import json
import os
import subprocess
import sys
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent.parent
FOLDERS = ("sim", "algorithms", "device_model", "results/observe")
# Suites of GoogleTest have no dot in their names, tests that are scripts have; one of these looks into the libraries, which
# the counters change.
TESTS = (["-L", "^fast$", "-E", "^Library[.]"], ["-L", "^slow$", "-E", "[.]"], ["-R", "^KnownAnswers[.]"])
MOST_FALL = 1.0  # per cent of a folder's lines


def run_tests(build: Path) -> None:
    for counts in build.rglob("*.gcda"):
        counts.unlink()
    for selection in TESTS:
        done = subprocess.run(["ctest", "--test-dir", build, "--parallel", str(os.cpu_count()), *selection],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode != 0:
            print("\n".join(done.stdout.splitlines()[-20:]), file=sys.stderr)


def lines_of(notes: Path) -> dict[Path, dict[int, bool]]:
    """The lines of our folders in an object file, and whether they were run."""
    report = json.loads(subprocess.run(["gcov", "--json-format", "--stdout", notes], cwd=notes.parent,
                                       stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=True).stdout)
    found: dict[Path, dict[int, bool]] = {}
    for file in report["files"]:
        path = Path(report["current_working_directory"], file["file"]).resolve()
        if path.is_relative_to(SOURCE) and path.relative_to(SOURCE).as_posix().startswith(tuple(f + "/" for f in FOLDERS)):
            lines = found.setdefault(path.relative_to(SOURCE), {})
            for line in file["lines"]:
                lines[line["line_number"]] = lines.get(line["line_number"], False) or line["count"] != 0
    return found


def counted(build: Path) -> dict[str, tuple[int, int]]:
    """Lines, and lines that were run, of each folder."""
    files: dict[Path, dict[int, bool]] = defaultdict(dict)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        libraries = sorted({build / Path(folder).parts[0] for folder in FOLDERS})
        for found in pool.map(lines_of, (notes for library in libraries for notes in library.rglob("*.gcno"))):
            for path, lines in found.items():
                for number, ran in lines.items():
                    files[path][number] = files[path].get(number, False) or ran
    sums = {}
    for folder in FOLDERS:
        runs = [ran for path, lines in files.items() if path.is_relative_to(folder) for ran in lines.values()]
        sums[folder] = len(runs), sum(runs)
    return sums


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path, help="a build folder of the preset coverage")
    parser.add_argument("--against", type=Path, metavar="FILE", help="an earlier output to compare with")
    options = parser.parse_args()
    build = options.build.resolve()
    run_tests(build)
    commit = subprocess.run(["git", "-C", SOURCE, "describe", "--always", "--dirty"], stdout=subprocess.PIPE, text=True,
                            check=True).stdout.strip()
    print(f"# Lines of code that tests run, by gcov at commit {commit}: ctest " + "; ".join(map(" ".join, TESTS)))
    print(f"{'# folder':16}{'lines':>7}{'run':>7}{'%':>7}")
    percent = {}
    for folder, (lines, ran) in counted(build).items():
        percent[folder] = 100.0 * ran / lines if lines else 0.0
        print(f"{folder:16}{lines:7}{ran:7}{percent[folder]:7.1f}")
    if not options.against:
        return 0
    rows = [row.split() for row in options.against.read_text(encoding="utf-8").splitlines() if not row.startswith("#")]
    fallen = [row[0] for row in rows if percent[row[0]] < float(row[3]) - MOST_FALL]
    if fallen:
        print(f"more than {MOST_FALL} % below {options.against}: {', '.join(fallen)}", file=sys.stderr)
    return 1 if fallen else 0


if __name__ == "__main__":
    sys.exit(main())
