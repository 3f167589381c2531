"""Tests that the edits that the manuals describe are sufficient for an extension.

  python3 tests/scripts/fixture.py tests/scripts/adding_test.py [--keep]

Copies the source tree to a scratch folder and adds a law, a tool, an environment, a named file, a device field, a
section of metrics, a column of trajectory.csv and a command. Then it builds the program (minutes) and tests that
reader, schema, describe, list, results, sweep, help and completion know each addition. `--keep` keeps the folder
/tmp/hapbench_adding_….
"""
import csv
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from additions import ADDITIONS, INSIDE, Tree
from fixture import must, ran, scratch_folder

# A scenario that uses all added parts.
SCENARIO = {
    "time": {"step_s": 0.0005, "steps": 20},
    "environment": {"type": "ridge", "height_m": 0.001},
    "initial": {"position_m": [0, 0, 0.00099]},
    "tool": {"type": "taper", "width_m": 0.003},
    "expect": {"outcome": ["completes", "no_contact", "lost_contact"]},
}
STROKE = "time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z\n0,0,0,0,0,0,-1\n"


class Adding(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.scratch = (
            Path(tempfile.mkdtemp(prefix="hapbench_adding_"))
            if "--keep" in sys.argv
            else scratch_folder(cls)
        )
        tree = Tree(cls.scratch / "tree")
        cls.touched = {
            thing: {edit(tree, *of) for edit, *of in edits}
            for thing, (_, edits) in ADDITIONS.items()
        }
        build = cls.scratch / "build"
        must(
            "cmake",
            "-G",
            "Ninja",
            "-S",
            tree.folder,
            "-B",
            build,
            "-DCMAKE_BUILD_TYPE=Debug",
            "-DCMAKE_CXX_FLAGS_DEBUG=-O0",
            "-DCMAKE_UNITY_BUILD=ON",
            "-DCMAKE_UNITY_BUILD_BATCH_SIZE=24",
            "-DHAPBENCH_BUILD_TESTS=OFF",
            "-DHAPBENCH_BUILD_PYTHON=OFF",
            "-DHAPBENCH_INSTALL=OFF",
            "-DHAPBENCH_WERROR=ON",
        )
        must("cmake", "--build", build, "--target", "bin/hapbench")
        cls.program = build / "bin" / "hapbench"

    def setUp(self):
        self.folder = self.scratch / self.id().rpartition(".")[2]
        self.folder.mkdir()

    def hapbench(self, *words, status=0):
        """Runs the program and returns its standard output. If the expected `status` is not 0, returns its standard
        error."""
        done = ran(self.program, *words, cwd=self.folder, env={**os.environ, "NO_COLOR": "1"})
        self.assertEqual(done.returncode, status, f"{words}\n{done.stdout}{done.stderr}")
        return done.stdout if status == 0 else done.stderr

    def write(self, **parts):
        (self.folder / "scene.json").write_text(json.dumps(SCENARIO | parts))

    def run_scene(self, *words, status=0):
        """Runs the scenario into the folder out. Returns [summary, effective scenario]."""
        self.hapbench("run", "scene.json", *words, "--out", "out", "--quiet", status=status)
        return [
            json.loads((self.folder / "out" / name).read_text())
            for name in ("summary.json", "scenario.effective.json")
        ]

    def first_row(self):
        header, row = (
            line.split(",")
            for line in (self.folder / "out/trajectory.csv").read_text().splitlines()[:2]
        )
        return dict(zip(header, row, strict=True))

    def test_each_thing_takes_few_files(self):
        for thing, (limit, _) in ADDITIONS.items():
            self.assertLessEqual(
                len(self.touched[thing]), limit, f"{thing}: {sorted(self.touched[thing])}"
            )

    def test_the_reader_accepts_and_refuses(self):
        self.write()
        _, effective = self.run_scene()
        self.assertEqual(
            effective["environment"], {"type": "ridge", "height_m": 0.001, "spacing_m": 0.0005}
        )
        self.assertEqual(effective["tool"], {"type": "taper", "width_m": 0.003})
        for field, value, problem in (
            (
                "environment.height_m",
                "-1",
                "--set environment.height_m=-1: got -1; allowed: a number > 0 and <= 1000 [m]",
            ),
            ("environment.heigth_m", "1", 'nearest valid name: "height_m"'),
            (
                "tool.width_m",
                "wide",
                '--set tool.width_m=wide: got "wide"; allowed: a number > 0 and <= 1000 [m]',
            ),
            ("tool.type", "tapered", 'nearest valid name: "taper"'),
            (
                "device",
                '{"type":"impedance","handle_mass_kg":0.1,"play_m":2}',
                "/device/play_m: got 2; allowed: a number >= 0 and <= 1 [m]",
            ),
            ("hand", '{"type":"push","force_N":1,"file":5}', "/hand/file: got 5; allowed: a text"),
        ):
            self.assertIn(
                problem, self.hapbench("run", "scene.json", "--set", f"{field}={value}", status=2)
            )

    def test_schema_describe_and_list_know_them(self):
        schema = json.loads(self.hapbench("describe", "schema"))["else"]["properties"]
        ridge = schema["environment"]["oneOf"][1]["properties"]
        self.assertEqual((ridge["type"]["const"], ridge["height_m"]["default"]), ("ridge", 0.001))
        self.assertIn(
            "taper", [tool["properties"]["type"]["const"] for tool in schema["tool"]["oneOf"]]
        )
        devices = {
            device["properties"]["type"]["const"]: device["properties"]
            for device in schema["device"]["oneOf"]
        }
        self.assertEqual(devices["impedance"]["play_m"]["description"], "play of the transmission")
        self.assertIn("a cone that ends in a narrow tip", self.hapbench("describe", "tools"))
        for name, text in (
            ("ridge", "height of the row"),
            ("taper", "width of the far end"),
            ("hand.file", "a stroke to compare with"),
            ("device.play_m", "a number >= 0 and <= 1 [m]"),
            ("environment.type", "a row of points"),
        ):
            self.assertIn(text, self.hapbench("describe", name))

    def test_an_environment_defines_its_inside(self):
        self.write()
        summary, _ = self.run_scene()
        self.assertAlmostEqual(summary["metrics"]["inside_max_m"], 1e-5, delta=1e-6)
        self.assertIn(
            "went_through",
            self.hapbench(
                "run",
                "scene.json",
                "--set",
                "environment.height_m=0.003",
                "--out",
                "deep",
                status=3,
            ),
        )
        silent = (
            (self.scratch / "tree/scenarios/scene/environments.cpp").read_text().replace(INSIDE, "")
        )
        done = subprocess.run(
            [
                "c++",
                "-std=c++20",
                "-fsyntax-only",
                "-DEIGEN_DONT_VECTORIZE",
                "-I",
                self.scratch / "tree",
                "-isystem",
                "/usr/include/eigen3",
                "-x",
                "c++",
                "-",
            ],
            input=silent,
            capture_output=True,
            text=True,
        )
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("make_solid(const hapbench::RidgeEnvironment&)", done.stderr)

    def test_the_theory_claims_nothing_of_a_device_with_a_field_that_it_does_not_know(self):
        for play in (0, 1e-4):
            self.hapbench(
                "limit",
                "wall_on_handle",
                "--resolution",
                0.5,
                "--set",
                f"device.play_m={play}",
                "--out",
                "limit",
                "--quiet",
            )
            header, *rows = csv.reader((self.folder / "limit/limit.csv").read_text().splitlines())
            for row in (dict(zip(header, row)) for row in rows):
                claims = {
                    name
                    for name in row
                    if name.startswith(
                        ("theoretical_limit", "worst_hand_limit", "passive", "stable_gil", "exact")
                    )
                    and row[name]
                }
                self.assertEqual(
                    ("device.play_m" in row["no_theory_reason"], bool(claims)),
                    (play > 0, play == 0),
                    row,
                )

    def test_a_named_file_is_read_checked_hashed_and_moved(self):
        self.write(hand={"type": "push", "force_N": 1, "file": "stroke.csv"})
        self.assertIn(
            "scene.json: /hand/file: stroke.csv: ",
            self.hapbench("validate", "scene.json", status=2),
        )
        hashes = set()
        for more in ("", "1,0,0,0,0,0,-1\n"):
            (self.folder / "stroke.csv").write_text(STROKE + more)
            summary, effective = self.run_scene()
            hashes.add(summary["provenance"]["scenario_hash"])
            self.assertEqual(effective["hand"]["file"], "../stroke.csv")
        self.assertEqual(len(hashes), 2)
        (self.folder / "below").mkdir()
        (self.folder / "below/other.json").write_text('{"extends": "../scene.json"}')
        self.hapbench("validate", "below/other.json")
        (self.folder / "stroke.csv").write_text("nothing\n")
        self.assertIn("/hand/file: ", self.hapbench("run", "scene.json", status=2))

    def test_a_law_runs_by_its_name(self):
        self.write()
        first = {}
        for law in ("halved", "summation"):
            self.run_scene("--set", f"rendering.algorithm={law}")
            first[law] = float(self.first_row()["fspring_z_N"])
        self.assertGreater(first["halved"], 0)
        self.assertEqual(first["halved"], first["summation"] / 2)
        self.assertIn("c_i = 1/2", self.hapbench("describe", "halved"))
        self.assertIn("half of all penalty springs", self.hapbench("describe", "algorithms"))
        self.assertIn(
            'nearest valid name: "halved"',
            self.hapbench("run", "scene.json", "--set", "rendering.algorithm=halvd", status=2),
        )
        self.assertIn('"halved"', self.hapbench("describe", "schema"))
        self.assertIn(
            "halved", self.hapbench("compare", "scene.json", "--algorithms", "all", "--out", "all")
        )

    def test_a_command_is_in_the_help(self):
        self.assertEqual(self.hapbench("twice", "this"), "this this\n")
        self.assertIn("what is a word two times?", self.hapbench())
        self.assertIn("Print a word two times", self.hapbench("twice", "--help"))

    def test_a_column_of_the_trajectory_has_a_field_that_adds_it(self):
        self.assertIn("add the tip's speed", self.hapbench("describe", "record.speed"))
        self.assertIn("norm of its velocity", self.hapbench("describe", "speed_m_per_s"))
        self.write()
        for speed, found in (("true", True), ("false", False)):
            self.run_scene("--set", f"record.speed={speed}", "--set", "record.pose=true")
            self.assertEqual(
                list(self.first_row())[-5:] == ["speed_m_per_s", "qw", "qx", "qy", "qz"], found
            )
            self.assertEqual(
                "speed_m_per_s" in (self.folder / "out/columns.json").read_text(), found
            )

    def test_a_section_of_metrics_is_in_all_results(self):
        self.write(
            record={"pose": True},
            expect={
                "outcome": ["completes", "no_contact", "lost_contact"],
                "metrics": {"stillness.still": {"min": 100}},
            },
        )
        summary, _ = self.run_scene(status=3)
        self.assertIn("still", summary["stillness"])
        self.assertIn("stillness.still", (self.folder / "out/columns.json").read_text())
        self.assertIn(
            "rows in which the tool did not move", self.hapbench("describe", "stillness.still")
        )
        self.assertIn("stillness.still", self.hapbench("describe", "metrics"))
        self.assertIn(
            "stillness.still",
            json.dumps(
                json.loads(self.hapbench("describe", "schema"))["else"]["properties"]["expect"]
            ),
        )
        for pose, found in (("true", True), ("false", False)):
            self.hapbench(
                "sweep",
                "scene.json",
                "--vary",
                "seed=1,2",
                "--set",
                f"record.pose={pose}",
                "--out",
                f"sweep_{pose}",
                "--quiet",
            )
            header = (self.folder / f"sweep_{pose}/sweep.csv").read_text().splitlines()[0]
            self.assertEqual("stillness.still" in header, found)
