"""Tests runs, studies and results with the Python package and its compiled module. Arguments: the program, the folder
of the built package."""
import json
import os
import re
import sys
import threading
import time
import unittest
import warnings
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
from fixture import (
    ENVIRONMENT as OF_TESTS,
    PROGRAM,
    SOURCE,
    hapbench as program,
    must,
    ran,
    scratch_folder,
)

PACKAGES = Path(sys.argv[-1]).resolve()
sys.path.insert(0, str(PACKAGES))

import hapbench  # noqa: E402  (the path comes first)
from hapbench.columns import read_columns  # noqa: E402

PEG = "peg_in_hole_2d_shaped_stiffness"
WEDGE = "wedge_stiffness"  # a scene with a free hand, so that --jitter may shift it
# Settings of short runs with contact in every step from the first on.
SHORT = {"time.steps": 300, "expect": "{}"}
EVERYTHING = {
    "record.contacts": True,
    "record.stiffness_tensor": True,
    "record.energy": True,
    "record.torque": True,
    "record.pose": True,
    "record.ratio_iterations": "[0,3]",
}
ENVIRONMENT = {**OF_TESTS, "PYTHONPATH": str(PACKAGES)}
python = partial(ran, sys.executable, env=ENVIRONMENT)


def words_of(overrides):
    return [
        word
        for field, value in overrides.items()
        for word in ("--set", f"{field}={value if isinstance(value, str) else json.dumps(value)}")
    ]


class Scratch(unittest.TestCase):
    def setUp(self):
        self.root = scratch_folder(self)
        warnings.simplefilter("ignore", hapbench.ScenarioWarning)


def without_diagnosis(run):
    """Returns the summary of a run without the fields that only the command `run` adds."""
    return {key: value for key, value in run.summary.items() if key != "diagnosis"}


class Runs(Scratch):
    def test_are_those_of_the_program(self):
        overrides = {**SHORT, **EVERYTHING}
        run = hapbench.run(PEG, overrides)
        program("run", PEG, *words_of(overrides), "--out", self.root, "--quiet")
        self.assertEqual(set(run.tables), {file.stem for file in self.root.glob("*.csv")})
        self.assertEqual(
            set(run.tables),
            {"trajectory", "contacts", "contact_trace", "stiffness_tensor", "energy", "ratios"},
        )
        for name, table in run.tables.items():
            written = read_columns(self.root / f"{name}.csv", may_be_empty=True)
            self.assertEqual(list(table), list(written))
            for column, values in written.items():
                found = table[column]
                self.assertEqual(found.dtype, np.float64)
                # Values must have equal bits, except NaN, which has several bit patterns.
                np.testing.assert_array_equal(np.isnan(found), np.isnan(values), f"{name} {column}")
                known = ~np.isnan(values)
                np.testing.assert_array_equal(
                    found[known].view(np.int64), values[known].view(np.int64), f"{name} {column}"
                )
        read = hapbench.load(self.root)
        self.assertEqual(run.summary, without_diagnosis(read))
        self.assertEqual(run.scenario, read.scenario)
        self.assertEqual(run.trajectory.units, read.trajectory.units)
        self.assertEqual(run.trajectory.meanings, read.trajectory.meanings)
        self.assertGreater(run.contacts.rows, 1000)
        self.assertEqual(run.trajectory.units["fx_N"], "N")
        self.assertTrue(
            np.isnan(run.trajectory.ratio_min).any() or (run.trajectory.rendered > 0).all()
        )
        self.assertEqual(
            (run.name, run.algorithm, run.outcome), (PEG, "shaped_stiffness", "completes")
        )
        self.assertEqual(repr(run.trajectory), repr(read.trajectory))

    def test_of_several_trials(self):
        name = "vertical_peg_in_hole_shaped_stiffness"
        overrides = {
            "time.duration_s": 0.2,
            "record.trajectory": True,
            "hand.trials": 2,
            "expect": "{}",
        }
        run = hapbench.run(name, overrides)
        program("run", name, *words_of(overrides), "--out", self.root / "trials", "--quiet")
        read = hapbench.load(self.root / "trials")
        self.assertEqual(run.summary, without_diagnosis(read))
        self.assertEqual(len(run.trials), len(read.trials))
        self.assertGreater(len(run.trials), 1)
        for own, other in zip(run.trials, read.trials):
            np.testing.assert_array_equal(own.trajectory["fx_N"], other.trajectory["fx_N"])
        self.assertEqual(list(run.targets), list(read.targets))
        with self.assertRaisesRegex(AttributeError, "trials with tables of their own"):
            run.trajectory

    def test_dicts_and_recorded_tables(self):
        scene = {"extends": PEG, "name": "mine", "time": {"steps": 300}, "expect": {}}
        run = hapbench.run(scene, record=["contacts"])
        self.assertEqual(run.name, "mine")
        self.assertEqual(run.state_hash, hapbench.run(PEG, SHORT).state_hash)
        self.assertGreater(len(run.contacts["depth_m"]), 0)
        with self.assertRaisesRegex(AttributeError, r"record=\['energy'\]"):
            run.energy
        with self.assertRaisesRegex(AttributeError, "tables: .*trajectory"):
            run.nothing
        # A run of the effective scenario must equal the run.
        self.assertEqual(hapbench.run(run.scenario).state_hash, run.state_hash)

    def test_files_that_a_dict_names(self):
        here = os.getcwd()
        self.addCleanup(os.chdir, here)
        os.chdir(SOURCE / "scenarios/library/examples")
        scene = json.loads(Path("mesh_molar.json").read_text())
        scene.update(time={**scene["time"], "duration_s": 0.02}, expect={})
        by_dict = hapbench.run(scene)
        by_name = hapbench.run("mesh_molar", {"time.duration_s": 0.02, "expect": "{}"})
        self.assertEqual(by_dict.state_hash, by_name.state_hash)
        self.assertEqual(
            by_dict.summary["provenance"], by_name.summary["provenance"]
        )  # contains the scenario's hash

    def test_threads_compute_at_once(self):
        stiffness = [2e4, 3e4, 4e4, 5e4]
        alone = [
            hapbench.run(PEG, {**SHORT, "rendering.stiffness_N_per_m": k}).state_hash
            for k in stiffness
        ]
        with ThreadPoolExecutor(4) as pool:
            beside = list(
                pool.map(
                    lambda k: hapbench.run(
                        PEG, {**SHORT, "rendering.stiffness_N_per_m": k}
                    ).state_hash,
                    stiffness,
                )
            )
        self.assertEqual(alone, beside)

    def test_the_interpreter_is_released(self):
        counted = []
        thread = threading.Thread(
            target=lambda: [counted.append(time.sleep(0.001)) for _ in range(1000)], daemon=True
        )
        thread.start()
        before = len(counted)
        hapbench.run(
            PEG,
            {
                "record.trajectory": False,
                "time.steps": 20000,
                "time.stop_when": "[]",
                "expect": "{}",
            },
        )
        self.assertGreater(len(counted), before)

    def test_progress(self):
        seen = []
        hapbench.run(PEG, SHORT, progress=lambda *state: seen.append(state))
        self.assertEqual(seen[-1][::2], (PEG, 300))
        hapbench.run(PEG, SHORT, progress=False)
        with self.assertRaises(ZeroDivisionError):
            hapbench.run(PEG, SHORT, progress=lambda *_: 1 // 0)


class Errors(Scratch):
    def test_name_position_and_problem(self):
        with self.assertRaises(hapbench.ScenarioError) as caught:
            hapbench.run({"extends": PEG, "rendering": {"algoritm": "mean"}})
        self.assertEqual(
            (caught.exception.pointer, caught.exception.nearest),
            ("/rendering/algoritm", "algorithm"),
        )
        self.assertTrue(str(caught.exception).startswith("/rendering/algoritm: "), caught.exception)
        with self.assertRaises(hapbench.ScenarioError) as caught:
            hapbench.run(PEG, {"rendering.algorithm": "shaped_stifness"})
        self.assertEqual(
            (caught.exception.pointer, caught.exception.nearest),
            ("/rendering/algorithm", "shaped_stiffness"),
        )
        self.assertTrue(caught.exception.file.endswith(f"{PEG}.json"))
        with self.assertRaisesRegex(hapbench.ScenarioError, 'nearest valid name: "drag_molar"'):
            hapbench.run("drag_mola")
        with self.assertRaises(hapbench.ScenarioError) as caught:
            hapbench.run(PEG, {"rendering.mass_kg": -1, "time.step_s": -1})
        self.assertEqual(
            {fault.pointer for fault in caught.exception.faults},
            {"/rendering/mass_kg", "/time/step_s"},
        )

    def test_name_the_column_and_the_table(self):
        run = hapbench.run(PEG, SHORT, record="energy,contacts")
        self.assertLessEqual({"energy", "contacts"}, set(run.tables))
        with self.assertRaisesRegex(KeyError, "trajectory has no column 'fz'; it has step, time_s"):
            run.trajectory.plot("fz")
        with self.assertRaisesRegex(KeyError, "trajectory has no column 't'"):
            run.trajectory.plot("fz_N", x="t")
        texts = hapbench.Table({"x": np.zeros(2), "name": np.array(["a", "b"], dtype=object)})
        with self.assertRaisesRegex(ValueError, "column 'name' has texts; allowed: x"):
            texts.plot("name")
        with self.assertRaisesRegex(hapbench.InputError, "^table: got no columns; allowed: .* px"):
            hapbench.audit({})
        with self.assertRaisesRegex(hapbench.InputError, r"^the table has columns of \[2, 3\]"):
            hapbench.audit({"t": [0, 1, 2], "px": [0, 1]})

    def test_commands_without_json_return_their_text(self):
        folder = self.root / "run"
        (run,) = hapbench.command(
            "run", *words_of(SHORT), "--out", folder, "--", PEG, progress=False
        )
        self.assertEqual(run["outcome"], "completes")
        text = hapbench.command("plot", folder, "--y", "force", "--out", self.root / "a.svg")
        self.assertIn("a.svg", text)
        self.assertTrue((self.root / "a.svg").is_file())
        with self.assertRaisesRegex(hapbench.ScenarioError, "^nowhere: no such folder"):
            hapbench.command("plot", "nowhere")
        with self.assertRaisesRegex(hapbench.ScenarioError, 'unknown option "--json"'):
            hapbench.command("plot", folder, "--json")

    def test_of_results(self):
        for folder, message in (
            (self.root / "nothing", "is not a folder"),
            (self.root, "no results"),
        ):
            with self.assertRaisesRegex(hapbench.ResultError, message):
                hapbench.load(folder)

    def test_without_the_module_results_can_be_read(self):
        program("run", PEG, *words_of(SHORT), "--out", self.root / "run", "--quiet")
        code = (
            f"import hapbench; print(hapbench.load({str(self.root / 'run')!r}).trajectory.rows)\n"
            "try:\n    hapbench.run\nexcept ImportError as error:\n    print(error)"
        )
        done = ran(
            sys.executable, "-c", code, env=ENVIRONMENT, PYTHONPATH=str(SOURCE / "scripts/python")
        )
        self.assertEqual(done.stdout.splitlines()[0], "300", done.stderr)
        self.assertIn("compiled module", done.stdout)
        self.assertIn(
            "scripts/build --python && export PYTHONPATH=",
            done.stdout,
        )


class Studies(Scratch):
    def test_compare(self):
        report = hapbench.compare(PEG, ["mean", "summation"], SHORT, jobs=2)
        self.assertEqual(list(report.comparison.algorithm), ["mean", "summation"])
        self.assertEqual([run["algorithm"] for run in report.report], ["mean", "summation"])
        heading, mean, summation, left = str(report.comparison).split("\n", 3)
        self.assertEqual(mean.split()[0], "mean")
        self.assertEqual(len(heading), len(summation))
        self.assertIn(f"{report.comparison.force_max_N[0]:.5g}", mean)
        self.assertIn("and columns ", left)
        alone = hapbench.run(PEG, {**SHORT, "rendering.algorithm": "mean"})
        mean = report.runs["mean"]
        del report  # the folder of a report must exist as long as one of its runs
        self.assertEqual(mean.state_hash, alone.state_hash)
        self.assertEqual(mean.trajectory.rows, 300)
        self.assertIn("and 280 more rows", str(mean.trajectory))

    def test_sweep(self):
        seen = []
        report = hapbench.sweep(
            PEG,
            {"rendering.stiffness_N_per_m": [2e4, 4e4], "rendering.algorithm": "mean,summation"},
            SHORT,
            jobs=2,
            progress=lambda *state: seen.append(state),
        )
        table = report.sweep
        self.assertEqual(table.rows, 4)
        self.assertEqual(seen[-1][1:], (4, 4))
        alone = hapbench.run(
            PEG, {**SHORT, "rendering.stiffness_N_per_m": 4e4, "rendering.algorithm": "mean"}
        )
        row = table.where(**{"rendering.algorithm": "mean", "rendering.stiffness_N_per_m": 4e4})
        self.assertEqual((row.rows, row["state_hash"][0]), (1, alone.state_hash))
        self.assertEqual(row["force_max_N"][0], alone.metrics["force_max_N"])


class Loop(Scratch):
    def test_a_renderer_writes_a_log_that_is_replayed_bit_for_bit(self):
        wall = {
            "name": "wall",
            "time": {"step_s": 0.001, "steps": 10},
            "environment": {"type": "plane", "size_m": 0.006, "spacing_m": 0.0005},
            "initial": {"position_m": [0, 0, 0.002]},
            "tool": {"diameter_m": 0.001, "length_m": 0.01, "tip": "round"},
            "rendering": {"algorithm": "mean", "stiffness_N_per_m": 2000},
        }
        file = self.root / "wall.json"
        file.write_text(json.dumps(wall))
        stiffer = {"rendering.stiffness_N_per_m": 3000}
        renderer = hapbench.Renderer(file, stiffer, max_force_N=5, ramp_s=0.02)
        self.assertEqual(renderer.period_s, 0.001)
        self.assertIn("mode: impedance", renderer.inspection)
        log = renderer.log_header()
        for i in range(300):
            out = renderer.step(
                (i + 1) * 1_000_000,
                (0, 0, 0.002 - 6e-6 * i),
                velocity_m_per_s=(0, 0, -6e-3),
                clutch=200 <= i < 230,
            )
            log += renderer.log_row()
        self.assertEqual((out["call"], out["status"]), (299, "ON"), renderer.fault)
        (self.root / "loop.csv").write_text(log)
        words = [str(file), "--replay", str(self.root / "loop.csv"), *words_of(stiffer)]
        replay = json.loads(program("run", *words, "--json", "--out", str(self.root / "out")))
        self.assertEqual((replay["calls"], replay["equal_calls"]), (300, 300))
        self.assertGreater(replay["loop_force_max_N"], 0.01)
        # Covers a scenario in memory, a fault of the renderer, and rejected input.
        renderer = hapbench.Renderer(wall, max_force_N=5)
        self.assertEqual(renderer.step(1, (float("nan"), 0, 0))["status"], "FAULT")
        self.assertIn("not finite", renderer.fault)
        with self.assertRaisesRegex(hapbench.ScenarioError, "max_force"):
            hapbench.Renderer(wall, max_force_N=0)
        with self.assertRaisesRegex(ValueError, "admittance"):
            hapbench.Renderer(wall, max_force_N=5, mode="other")
        with self.assertRaisesRegex(hapbench.ScenarioError, "stale_s: got 0.01 s, .* is 0.02 s"):
            hapbench.Renderer(wall, {"time.step_s": 0.02}, max_force_N=5)
        hapbench.Renderer(wall, {"time.step_s": 0.02}, max_force_N=5, stale_s=0.2)

    def test_wrong_arguments_are_named(self):
        renderer = hapbench.Renderer("poke_plane", max_force_N=5)
        origin, still = (0, 0, 0), {"velocity_m_per_s": (0, 0, 0)}
        for arguments, more, message in (
            ((1.5, origin), still, r"time_ns: got 1.5; allowed: .*time.monotonic_ns\(\)"),
            ((-1, origin), still, "time_ns: got -1"),
            ((1, (0, 0)), still, r"position_m: got \(0, 0\); allowed: 3 numbers"),
            ((1, "abc"), still, "position_m: got 'abc'"),
            ((1, origin, (1, 0, 0)), still, r"orientation_wxyz: got \(1, 0, 0\); allowed: 4"),
            ((1, origin), {"velocity_m_per_s": 3}, "velocity_m_per_s: got 3"),
            ((1, origin), {"hand_force_N": ("1", 0, 0)}, "hand_force_N: got"),
        ):
            with self.assertRaisesRegex(ValueError, message):
                renderer.step(*arguments, **more)
        good = np.int64(1), np.zeros((3, 1)), np.array([1, 0, 0, 0])
        self.assertEqual(renderer.step(*good, **still)["status"], "WAITING")
        for name, value in (
            ("max_force_N", "3"),
            ("scale", None),
            ("stale_s", (1, 2)),
            ("world_from_device", (0, 0, 0)),
            ("handle_from_tip", ((0, 0, 0), (1, 0, 0))),
        ):
            with self.assertRaisesRegex(ValueError, f"{name}: got .*; allowed"):
                hapbench.Renderer("poke_plane", **{"max_force_N": 5, name: value})
        for steps in (1.5, -1):
            with self.assertRaisesRegex(ValueError, f"steps: got {steps}; allowed: an integer"):
                hapbench.Simulation(PEG, SHORT).advance(steps)


class Steps(Scratch):
    def test_are_those_of_a_run(self):
        run = hapbench.run(PEG, SHORT, record=["contacts"])
        simulation = hapbench.Simulation(PEG, SHORT)
        for _ in range(2):
            self.assertEqual((simulation.rows, simulation.steps), (0, 300))
            rows = 0
            while simulation.step():
                state, contacts = simulation.state, simulation.contacts
                row = {name: column[rows] for name, column in run.trajectory.items()}
                self.assertEqual(state["step"], row["step"])
                for name, key in (("p", "position_m"), ("f", "force_N"), ("h", "handle_m")):
                    unit = "N" if key.endswith("N") else "m"
                    self.assertEqual(
                        [row[f"{name}{axis}_{unit}"] for axis in "xyz"], list(state[key])
                    )
                mine = run.contacts.step == rows
                np.testing.assert_array_equal(contacts["depths_m"], run.contacts.depth_m[mine])
                np.testing.assert_array_equal(
                    contacts["gradients"][:, 1], run.contacts.gradient_y[mine]
                )
                rows += 1
            self.assertEqual((rows, simulation.rows, simulation.outcome), (300, 300, "completes"))
            simulation.reset()
        self.assertEqual(simulation.advance(100), 100)
        self.assertEqual(simulation.state["step"], 99)
        self.assertEqual(simulation.advance(1000), 200)


class Program(Scratch):
    def test_is_the_same(self):
        for words, expected in (
            (["describe", "mean"], 0),
            (["run", "nobody"], 2),
            (["runn"], 2),
            (
                [
                    "run",
                    PEG,
                    *words_of({"expect.outcome": "diverges", "time.steps": 50}),
                    "--out",
                    self.root / "a",
                ],
                3,
            ),
        ):
            own, built = python("-m", "hapbench", *words), ran(PROGRAM, *words)
            self.assertEqual((own.returncode, built.returncode), (expected, expected), own.stderr)
            without_times = [
                re.sub(r"[0-9.]+ (µs|us|s|ms)\b", "", text)
                for text in (own.stdout + own.stderr, built.stdout + built.stderr)
            ]
            if words[0] != "run" or expected == 2:
                self.assertEqual(*without_times)

    def test_reads_and_writes_numbers_of_no_language(self):
        must("localedef", "-i", "de_DE", "-f", "UTF-8", self.root / "de_DE.UTF-8")
        code = (
            "import hapbench, locale, sys\n"
            "locale.setlocale(locale.LC_ALL, sys.argv[1])\n"
            "assert locale.str(0.5) == sys.argv[2]\n"
            f"report = hapbench.compare({WEDGE!r}, ['mean', 'proxy'], {SHORT}, seeds=2, jitter=1.5e-4)\n"
            "print(*[report.ranking[name].tolist() for name in report.ranking])\n"
            "hapbench.main(['new', 'bur', '--out', sys.argv[3], '--quiet'])\n"
            "print(open(sys.argv[3], encoding='utf-8').read())\n"
        )
        comma, point = (
            must(sys.executable, "-c", code, *words, env=ENVIRONMENT, LOCPATH=str(self.root))
            for words in (
                ("de_DE.UTF-8", "0,5", self.root / "a.json"),
                ("C", "0.5", self.root / "b.json"),
            )
        )
        self.assertEqual(comma, point)

    def test_ctrl_c_in_a_script(self):
        """Checks that Ctrl-C ends a script within 0.2 s, even during a call of a slow law. The fastest of three
        attempts counts, because the machine may be busy."""
        code = (
            "import hapbench, os, signal, threading, time\n"
            "@hapbench.force_law('slow')\n"
            "def slow(depths):\n    time.sleep(0.002)\n    return 1 / len(depths)\n"
            "def seconds_to_end(law):\n"
            "    sent = []\n"
            "    def send():\n        sent.append(time.monotonic())\n        os.kill(os.getpid(), signal.SIGINT)\n"
            "    threading.Timer(0.3, send).start()\n"
            "    try:\n"
            f"        hapbench.run({PEG!r}, {{'time.steps': 1_000_000_000, 'time.stop_when': "
            f"'[]', 'record.every': 20_000, 'rendering.algorithm': law}})\n"
            "    except KeyboardInterrupt:\n        return time.monotonic() - sent[0]\n"
            "for law in ('shaped_stiffness', 'slow'):\n    print(min(seconds_to_end(law) for _ in range(3)))\n"
            f"print(hapbench.run({PEG!r}, {{'time.steps': 10}}).trajectory.rows)"
        )
        done = python("-c", code)
        *seconds, rows = map(float, done.stdout.split())
        self.assertEqual((len(seconds), rows), (2, 10), done.stderr)
        self.assertLess(max(seconds), 0.2)
