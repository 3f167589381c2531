"""Tests the order in which scripts/reproduce runs its parts, with a dummy program in place of hapbench. Also tests the
sets of assumptions that scripts/assumption_sets.py draws at random."""
import csv
import json
import math
import os
import signal
import subprocess
import time
import unittest

from fixture import SOURCE, must, ran, scratch_folder

NOTHING = "#!/bin/sh\nexit 0\n"


class Reproduce(unittest.TestCase):
    def setUp(self):
        self.root = scratch_folder(self)
        self.environment = {**os.environ, "PATH": f"{self.root / 'bin'}:{os.environ['PATH']}"}
        (self.root / "results" / "reference").mkdir(parents=True)
        (self.root / "scripts" / "python").mkdir(parents=True)
        self.put(
            "scripts/reproduce", (SOURCE / "scripts" / "reproduce").read_text(encoding="utf-8")
        )
        for study in ("stability_z_width", "spring_stiffness"):
            self.put(f"scenarios/library/studies/{study}.json", '{\n  "ask": "limit"\n}\n')
        for name in (
            "scripts/setup",
            "scripts/figures",
            "scripts/report",
            "bin/cmake",
            "build/release/bin/hapbench_accuracy",
        ):
            self.put(name, NOTHING)

    def put(self, name, text):
        file = self.root / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
        file.chmod(0o755)

    def run_with(self, program, *words):
        self.put("build/release/bin/hapbench", program)
        done = ran(self.root / "scripts" / "reproduce", *words, env=self.environment)
        return done.returncode, done.stdout, done.stderr

    def test_one_part_failed(self):
        self.put("build/release/bin/hapbench_accuracy", "#!/bin/sh\nexit 7\n")
        status, out, _ = self.run_with(NOTHING)
        self.assertEqual(status, 1)
        self.assertIn("FAILED: Run time against error (exit status 7)", out)
        self.assertIn("== Report", out)  # the other parts were run

    def test_words_that_are_no_option_are_refused(self):
        for words in (["T1"], ["--only", "T1", "--figure", "A.2"], ["--figure", "A.2", "A.3"]):
            with self.subTest(words=words):
                status, _, err = self.run_with(NOTHING, *words)
                self.assertEqual(status, 2)
                self.assertIn(f'unknown argument "{words[2 if len(words) > 1 else 0]}"', err)

    def test_a_second_call_has_nothing_to_do(self):
        self.put("scripts/report", "#!/bin/sh\n: >results/out/reproduce/report.html\n")
        program = '#!/bin/sh\necho "$@" >>ran\n'
        self.assertEqual(self.run_with(program)[0], 0)
        made = (self.root / "ran").read_text().splitlines()
        self.assertEqual(len(made), 3)
        status, out, _ = self.run_with(program)
        self.assertEqual((status, (self.root / "ran").read_text().splitlines()), (0, made))
        self.assertIn("Nothing has changed", out)
        self.put(
            "scenarios/library/studies/spring_stiffness.json",
            '{\n  "ask": "limit", "summary": "another"\n}\n',
        )
        self.run_with(program)
        self.assertEqual(
            sorted((self.root / "ran").read_text().splitlines()), sorted(2 * made)
        )  # two parts at a time

    def test_a_figure_after_what_it_needs(self):
        """Checks that scripts/reproduce first computes the results that a figure needs: scenes of the thesis, and
        studies. A dummy program writes the result files."""
        out = "results/out/reproduce"
        needs = {
            "2": "thesis/wedge/trajectory.csv",
            "A.4-root-locus": "spring_stiffness/limit.csv",
            "stability-z_width": "stability_z_width/limit.csv",
            "proxy": "proxy_in_hole/proxy/summary.json",
        }
        for study in ("spring_stiffness", "proxy_in_hole"):
            self.put(f"scenarios/library/studies/{study}.json", '{\n  "ask": "compare"\n}\n')
        self.put(
            "scripts/figures",
            '#!/bin/sh\necho "$@" >> asked\n'
            + "".join(
                f'[ -e {out}/{file} ] || echo "figures: skipped {name} (no {file})" >&2\n'
                for name, file in needs.items()
            )
            + "exit 0\n",
        )
        makes = "".join(
            f"*\" --out {out}/{folder}\"*) mkdir -p {out}/{file.rpartition('/')[0]}; touch {out}/{file};;\n"
            for folder, file in (
                ("thesis/wedge", needs["2"]),
                ("spring_stiffness", needs["A.4-root-locus"]),
                ("proxy_in_hole", needs["proxy"]),
                ("stability_z_width", needs["stability-z_width"]),
            )
        )
        program = f'#!/bin/sh\necho "$@" >> ran\ncase "$* " in\n{makes}esac\n'
        status, output, err = self.run_with(program, "--figure", ",".join(needs))
        self.assertEqual(status, 0, err)
        ran = (self.root / "ran").read_text().splitlines()
        self.assertIn(f"run wedge --out {out}/thesis/wedge", ran)
        self.assertEqual(len(ran), 4, ran)  # each part once, and nothing else
        self.assertEqual(
            (self.root / "asked").read_text().splitlines(),
            2 * [f"{out} --out {out}/figures --only {','.join(needs)}"],
        )
        # An input that no part creates is reported, and scripts/reproduce stops.
        self.put(
            "scripts/figures",
            '#!/bin/sh\necho "figures: skipped 2 (no nowhere/x.csv)" >&2\nexit 1\n',
        )
        status, output, err = self.run_with(NOTHING, "--figure", "2")
        self.assertEqual(status, 1)
        self.assertIn("no study computes the folder nowhere", err)
        self.assertIn("skipped 2", output)

    def test_a_claim_with_its_figures(self):
        self.put("scripts/figures", '#!/bin/sh\necho "drawn: $*"\n')
        program = (
            '#!/bin/sh\n[ "$1" != describe ] || printf \'{\\n  "place": "2.4, Fig. A.2, '
            'Fig. 2c, Table A.1",\\n  "why": "Fig. 9"\\n}\\n\'\n'
        )
        status, out, err = self.run_with(program, "--only", "A1")
        self.assertEqual(status, 0, err)
        self.assertIn(
            "drawn: results/out/reproduce --out results/out/reproduce/figures --only A.2,2\n", out
        )
        # The claim T4 names no figure, so that none is drawn.
        self.assertNotIn("drawn", self.run_with(NOTHING, "--only", "T4")[1])

    def test_a_signal_ends_its_parts(self):
        # In the dummy program, `exec` replaces the shell by `sleep`. A child process would outlive the shell and write
        # while the folder is removed.
        self.put("build/release/bin/hapbench", "#!/bin/sh\n: >began\nexec sleep 50\n")
        process = subprocess.Popen(
            [self.root / "scripts" / "reproduce"],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=self.environment,
        )
        while not (self.root / "began").exists():
            self.assertIsNone(process.poll())
            time.sleep(0.02)
        process.send_signal(signal.SIGTERM)
        # Waits until the parts have ended, which closes their pipes.
        process.communicate()
        self.assertEqual(process.returncode, 143)


class AssumptionSets(unittest.TestCase):
    def test_lie_in_every_stratum_of_each_assumption(self):
        drawn = must(SOURCE / "scripts" / "assumption_sets.py", "8")
        sets = list(csv.DictReader(drawn.splitlines()))
        recorded = json.loads(
            (SOURCE / "results" / "reference" / "assumptions.json").read_text(encoding="utf-8")
        )["assumptions"]
        free = [assumption for assumption in recorded if "calibrated" not in assumption]
        self.assertEqual(list(sets[0]), [assumption["id"] for assumption in free])
        for assumption in free:
            values = [one[assumption["id"]] for one in sets]
            if "options" in assumption:
                self.assertLessEqual(set(values), set(assumption["options"]))
                self.assertEqual(
                    len(set(values)), min(8, len(assumption["options"])), assumption["id"]
                )
                continue
            scale = math.log if assumption.get("scale") == "log" else float
            low, high = map(scale, assumption["range"])
            self.assertEqual(
                sorted(int(8 * (scale(float(value)) - low) / (high - low)) for value in values),
                list(range(8)),
                assumption["id"],
            )
