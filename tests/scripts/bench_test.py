"""scripts/bench: the table on record, its statistics, and the comparison of two commits of a small project."""
import copy
import json
import random
import shutil
import signal
import subprocess
import tempfile
import unittest
from pathlib import Path

from fixture import SOURCE, main

from hapbench_bench import peers, table
from hapbench_bench.against import compare
from hapbench_bench.program import BenchError
from hapbench_bench.targets import GROUPS

RECORD = json.loads((SOURCE / "results" / "reference" / "performance.json").read_text(encoding="utf-8"))


class Table(unittest.TestCase):
    def test_the_manual_shows_what_is_on_record(self):
        manual = (SOURCE / "tests" / "README.md").read_text(encoding="utf-8")
        self.assertEqual(table.spliced(manual, table.markdown(RECORD)), manual, "renew it with scripts/docs --tables")

        peers_ = table.spliced(manual, peers.markdown(peers.record()), peers.BEGIN, peers.END)
        self.assertEqual(peers_, manual, "renew it with scripts/docs --tables")

    def test_every_target_is_on_record(self):
        rows = {row["what"]: row for row in RECORD["ratios"]}
        for row in (row for group in GROUPS for row in group):
            self.assertEqual(rows[f"`{row.what}`"]["at_most"], row.at_most, "renew it with scripts/bench --record")

    def test_it_fits_a_terminal(self):
        self.assertLessEqual(max(map(len, table.aligned(table.markdown(RECORD)).splitlines())), 100)

    def test_what_is_missed_is_marked(self):
        record = copy.deepcopy(RECORD)
        record["ratios"] = [{"what": "a", "over": "b", "ratio": r, "low": r, "high": r, "seconds": 1e-6, "at_most": limit}
                            for r, limit in ((0.2, 0.1), (0.1, 0.1), (0.3, None))]
        record["limits"] = [{"what": "c", "value": 5e-4, "unit": "s", "at_most": 4.88e-4}]
        text = table.markdown(record)
        self.assertIn("| a | b | 0.2 ± 0 % | ≤ 0.1 | **no** | 1 µs |", text)
        self.assertIn("| a | b | 0.1 ± 0 % | ≤ 0.1 | yes | 1 µs |", text)
        self.assertIn("| a | b | 0.3 ± 0 % |  |  | 1 µs |", text)
        self.assertIn("| c | 500 µs | ≤ 488 µs | **no** |", text)

    def test_numbers_have_the_unit_that_suits_them(self):
        for value, unit, shown in ((3.2e-9, "s", "3.2 ns"), (4.5e-5, "s", "45 µs"), (0.0123, "s", "12.3 ms"), (2, "s", "2 s"),
                                   (57.5e6, "B", "57.5 MB"), (98, "B", "98 B"), (73.21, "", "73.2"), (6e-4, "", "0.0006")):
            self.assertEqual(table.quantity(value, unit), shown)

    def test_a_manual_without_the_marks_is_refused(self):
        with self.assertRaisesRegex(BenchError, "performance"):
            table.spliced("# hapbench\n", "x")


class Significance(unittest.TestCase):
    BENCHMARKS, ROUNDS = 80, 10

    def series(self, chance, factor, noise=0.01):
        """Two programs on a machine whose speed drifts by a third while they take turns."""
        drift = [chance.uniform(1.0, 1.33) for _ in range(self.ROUNDS)]
        old = [d * chance.lognormvariate(0, noise) for d in drift]
        return old, [factor * d * chance.lognormvariate(0, noise) for d in drift]

    def verdict(self, old, new):
        return compare(old, new, self.BENCHMARKS).verdict

    def test_equal_programs_are_the_same(self):
        chance = random.Random(1)
        # Of 50 comparisons of 80 benchmarks at most one in twenty may call anything different: 2.5 of them expected, and
        # more than 7 by chance once in two hundred times. (What is below 2 % counts as the same in any case.)
        wrong = sum(any(self.verdict(*self.series(chance, 1.0, 0.03)) != "same" for _ in range(self.BENCHMARKS)) for _ in range(50))
        self.assertLessEqual(wrong, 7)

    def test_what_differs_is_found_beneath_the_drift(self):
        chance = random.Random(2)
        for factor, verdict in ((1.05, "slower"), (0.95, "faster"), (1.01, "same")):
            found = [self.verdict(*self.series(chance, factor)) for _ in range(100)]
            self.assertGreaterEqual(found.count(verdict), 99, factor)

    def test_a_disturbed_round_decides_nothing(self):
        chance = random.Random(3)
        for _ in range(100):
            old, new = self.series(chance, 1.0)
            new[chance.randrange(self.ROUNDS)] *= 5
            self.assertEqual(self.verdict(old, new), "same")

    def test_identical_times(self):
        self.assertEqual(compare([1.0] * 4, [1.0] * 4, 1).verdict, "same")
        self.assertEqual(compare([1.0] * 4, [2.0] * 4, 1).verdict, "slower")


# Builds a "program" that is a script, whose times are in the file beside it.
PROJECT = """cmake_minimum_required(VERSION 3.25)
project(fake NONE)
add_custom_command(OUTPUT ${CMAKE_BINARY_DIR}/bin/hapbench_bench DEPENDS ${CMAKE_SOURCE_DIR}/program.py ${CMAKE_SOURCE_DIR}/times.json
  COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/bin
  COMMAND ${CMAKE_COMMAND} -E copy ${CMAKE_SOURCE_DIR}/program.py ${CMAKE_BINARY_DIR}/bin/hapbench_bench
  COMMAND ${CMAKE_COMMAND} -E copy ${CMAKE_SOURCE_DIR}/times.json ${CMAKE_BINARY_DIR}/bin/times.json)
add_custom_target(all_of_it ALL DEPENDS ${CMAKE_BINARY_DIR}/bin/hapbench_bench)
"""
PROGRAM = """#!/usr/bin/env python3
import json, os, random, re, sys, time
from pathlib import Path
times = json.loads((Path(__file__).parent / "times.json").read_text())
if "--benchmark_list_tests" in sys.argv:
    print(*times, sep="\\n")
    sys.exit()
time.sleep(times.get("slow", 0))
chosen = next(a.split("=", 1)[1] for a in sys.argv if a.startswith("--benchmark_filter="))
print(json.dumps({"context": {}, "benchmarks": [
    {"run_name": name, "run_type": "iteration", "cpu_time": t * random.uniform(0.99, 1.01), "real_time": 7, "time_unit": "us",
     **({"error_occurred": True, "error_message": "wrong"} if t == 0 else {})}
    for name, t in times.items() if re.search(chosen, name)]}))
"""


class Against(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="hapbench-bench-")
        self.addCleanup(scratch.cleanup)
        self.root = Path(scratch.name) / "tree"
        shutil.copytree(SOURCE / "scripts", self.root / "scripts", ignore=shutil.ignore_patterns("__pycache__"))
        (self.root / "scripts" / "setup").write_text("#!/bin/sh\n")
        (self.root / "CMakeLists.txt").write_text(PROJECT)
        (self.root / "program.py").write_text(PROGRAM)
        (self.root / "program.py").chmod(0o755)
        self.git("init", "--quiet")
        self.times({"a/x": 100, "a/y": 100, "b/z": 100, "b/gone": 1})
        self.git("add", ".")
        self.git("-c", "user.name=a", "-c", "user.email=a@b", "commit", "--quiet", "--message=first")
        self.times({"a/x": 50, "a/y": 130, "b/z": 100, "b/more": 1})

    def git(self, *words):
        subprocess.run(["git", "-C", self.root, *words], check=True)

    def times(self, values):
        (self.root / "times.json").write_text(json.dumps(values))

    def start(self, *words):
        return subprocess.Popen([self.root / "scripts" / "bench", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                text=True, cwd=self.root.parent)

    def bench(self, *words):
        process = self.start(*words)
        out, err = process.communicate()
        self.assertNotIn("Traceback", err)
        self.assertFalse(list(self.root.glob("build/against/*/source")), "the other commit's sources stay")
        return process.returncode, out, err

    def test_tells_faster_slower_and_same(self):
        status, out, err = self.bench("--against", "HEAD", "--rounds", "5", "--fail-above", "20")
        verdicts = {line.split()[0]: line.split()[-1] for line in out.splitlines() if "/" in line.split(" ")[0]}
        self.assertEqual({name: verdicts[name] for name in ("a/x", "a/y", "b/z")}, {"a/x": "faster", "a/y": "slower", "b/z": "same"})
        self.assertIn("only before: b/gone", out)
        self.assertIn("only now: b/more", out)
        self.assertIn("a/y has become slower by more than 20 %", err)
        self.assertEqual(status, 1)
        self.assertLessEqual(max(map(len, out.splitlines())), 100)
        # A second time there is nothing to build, and less is asked.
        status, out, _ = self.bench("--against", "HEAD", "--rounds", "5", "--filter", "^a/x", "--fail-above", "20")
        self.assertEqual(status, 0)
        self.assertNotIn("a/y", out)

    def test_bad_input_is_named(self):
        for words, said in ((["--against", "no_such_commit"], "no commit of that name"),
                            (["--against", "HEAD", "--filter", "nothing"], "no benchmark of that name"),
                            (["--against", "HEAD", "--filter", "("], "--filter ("),
                            (["--against", "HEAD", "--rounds", "1"], "at least 3"),
                            (["--fail-above", "3"], "belong to --against"),
                            (["--against", "HEAD", "--record"], "not for --against"),
                            (["--agianst", "HEAD"], "--agianst")):
            status, out, err = self.bench(*words)
            self.assertEqual((status, out), (2, ""), words)
            self.assertIn(said, err)

    def test_a_refuted_benchmark_is_named(self):
        self.times({"a/x": 0, "a/y": 1})
        status, _, err = self.bench("--against", "HEAD", "--rounds", "3")
        self.assertEqual(status, 2)
        self.assertIn("a/x: wrong", err)

    def test_leaves_no_sources_when_it_is_ended(self):
        self.times({"a/x": 1, "a/y": 1, "slow": 0.2})
        process = self.start("--against", "HEAD", "--rounds", "5000")
        for line in process.stderr:
            if "round 2" in line:
                break
        process.send_signal(signal.SIGTERM)
        process.communicate()
        self.assertEqual(process.returncode, 128 + signal.SIGTERM)
        self.assertFalse(list(self.root.glob("build/against/*/source")))


if __name__ == "__main__":
    main()
