"""Tests scripts/figures on newly computed results."""
import json
import os
import re
import shutil
import unittest
import xml.etree.ElementTree as xml
from functools import partial
from pathlib import Path
from unittest import mock

from fixture import PROGRAM, SOURCE, in_process, must, ran, scratch_folder

# The package is in scripts/python, which the import of the module `fixture` has added to the path.
from hapbench_figures import __main__ as command

SVG = "{http://www.w3.org/2000/svg}"
REFERENCE = SOURCE / "results" / "reference"
RECORD = REFERENCE / "figures"
LARGEST = 65_000  # largest size of a stored figure of the thesis [bytes]
# Scenarios and settings that make their runs short, because the test is about drawing. The outcomes of the runs need
# not be the expected outcomes.
RUNS = (
    ("task[13]*", ["time.duration_s=1", "record.every=8"]),
    ("task2*", ["time.duration_s=7", "record.every=8"]),  # includes a tap beyond 2 N
    ("force_limit_*", []),
    ("corner_*", []),
    ("peg_in_hole_2d_*", []),
    ("springs_*", []),
    ("tilt_sweep_*", []),
    ("vertical_*", ["hand.trials=1", "hand.task.time_limit_s=2", "hand.task.targets_per_place=1"]),
    (
        "rotational_*",
        ["hand.trials=1", "hand.task.time_limit_s=2", "hand.task.targets_per_place=1"],
    ),
)
# Figures that together use every drawing function: subsampled marks, shaded areas, arrows, rasterised marks, limits.
# One test runs scripts/figures to draw these figures in every format. All other figures are drawn only as SVG, which
# takes a third of the time.
DRAWN_BY_COMMAND = "A.5,C.3,D.7,stability-z_width"
hapbench = partial(must, PROGRAM, statuses=(0, 3))
figures = partial(ran, SOURCE / "scripts" / "figures")
IDS = [figure.id for figure in command.FIGURES]


def make_results(directory):
    for pattern, overrides in RUNS:
        scenarios = sorted((SOURCE / "scenarios" / "library" / "thesis").glob(f"{pattern}.json"))
        assert scenarios, pattern
        # hapbench creates a subdirectory for each scenario only if it runs several scenarios. For a single scenario,
        # the path here includes the subdirectory.
        out = directory / "thesis" / (scenarios[0].stem if len(scenarios) == 1 else "")
        hapbench("run", *scenarios, *(f"--set={text}" for text in overrides), "--out", out)
    name = "corner_continuous_normal_projection"
    hapbench("run", name, "--out", directory / "run_beyond" / name)
    fields = (
        "time_step",
        "damping_ratio",
        "z_width",
        "delay",
        "velocity_filter",
        "hand",
        "integrators",
    )
    for verb, study, *words in (
        ("compare", "stiffness_peg"),
        ("limit", "spring_stiffness"),
        ("limit", "spring_damping"),
        ("sweep", "six_dof", "--jobs=2", "--set=time.step_s=0.1", "--set=time.steps=21"),
        ("limit", "hardware_paddle", "--resolution=0.5"),
        ("limit", "device_limits", "--device=touch,omega.3", "--resolution=0.5"),
        (
            "sweep",
            "checked_force",
            "--set=hand.task.time_limit_s=1",
            "--set=hand.task.targets_per_place=1",
        ),
        *(
            ("limit", f"stability_{field}", "--algorithms=shaped_stiffness", "--resolution=0.5")
            for field in fields
        ),
    ):
        hapbench(verb, study, *words, "--out", directory / study)
    make_accuracy(directory / "accuracy")
    shutil.copy(REFERENCE / "claims.json", directory)
    # The figure of the computing time per step, divided by the period of the loop, is drawn only if timing.json exists.
    loop = directory / "step_latency" / "task2_rotate_signed_distance"
    loop.mkdir(parents=True)
    (loop / "timing.json").write_text(
        json.dumps({"step_latency": {"over_time_s": [1e-6, 2e-6, 3e-6]}})
    )


def make_accuracy(directory):
    """Writes results in the format of the program hapbench_accuracy. Running this program would take longer than all
    other tests. In each series of settings, the time doubles with each setting. The error halves with each setting
    except the last, where it stays the same."""
    directory.mkdir()
    columns = (
        "error_rms_m",
        "tensor_error_rms",
        "force_error_relative",
        "ideal_height_error_rms_m",
        "created_by_sampling_J",
    )
    panels = {
        "integrators": [
            f"{name} dt={step}"
            for name in ("leapfrog", "rk4", "implicit_euler")
            for step in ("0.001", "0.0001")
        ],
        "shaping": ["m=0", "m=1", "exact"],
        "reduction": ["shaped_stiffness 0.9", "exact_shaping 0.9"],
        "merging": ["merged_shaping 0.0001"],
        "spacing": ["signed_distance 0.0004", "binary 0.0002"],
        "algorithms": [
            "original_averaging",
            "one_without_a_look",
            "mean",
            "mean + angular_damping",
        ],
        "multi_rate_contacts": [
            f"shaped_stiffness {between} {every}"
            for between in ("hold", "linear")
            for every in (2, 8)
        ],
        "skips": ["taken", "off"],
        "events": ["leapfrog dt=0.001", "event dt=0.001"],
    }
    settings = [
        {
            "name": f"{panel}/{name}/manual_time",
            "label": "diverges" if name.startswith("original") else "completes",
            "step_s": 0.001,
            "seconds_per_step": 1e-6 * 2**i,
            "seconds_per_call": 1e-6 * 2**i,
            **dict.fromkeys(columns, 0.001 / 2 ** min(i, len(names) - 2)),
        }
        for panel, names in panels.items()
        for i, name in enumerate(names)
    ]
    (directory / "accuracy.json").write_text(json.dumps({"benchmarks": settings}))


class Figures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = scratch_folder(cls)
        cls.results, cls.drawn = cls.directory / "results", cls.directory / "figures"
        make_results(cls.results)
        # The figures call the program to find the knee of a curve of error over run time.
        program = mock.patch.dict(os.environ, {"HAPBENCH_PROGRAM": str(PROGRAM)})
        program.start()
        cls.addClassCleanup(program.stop)
        with mock.patch.object(command, "FORMATS", ("svg",)):
            cls.status, _, cls.errors = in_process(command.main, cls.results, "--out", cls.drawn)

    def index(self, directory=None):
        return json.loads(((directory or self.drawn) / "figures.json").read_text(encoding="utf-8"))[
            "figures"
        ]

    def test_every_figure_is_drawn(self):
        self.assertEqual(self.status, 0, self.errors)
        self.assertEqual([entry["id"] for entry in self.index()], IDS, self.errors)
        self.assertEqual([line.split()[0] for line in figures("--list").stdout.splitlines()], IDS)
        redrawn = "2 4 5 6 7a-c 8 A.1 A.2a-b A.4 A.5 B.3 B.4 B.5 C.1 C.2 C.3 C.4 D.6 D.7 D.8 E.1 E.2 E.3 E.4 F.4 F.5"
        found = " ".join(entry["thesis_figure"] or "" for entry in self.index())
        for name in redrawn.split():
            self.assertRegex(found, rf"(^|\s){re.escape(name)}(,|\s|$)")

    def test_those_of_the_thesis_are_on_record(self):
        page = (RECORD / "figures.md").read_text(encoding="utf-8")
        for entry in filter(lambda entry: entry["thesis_figure"], self.index()):
            with self.subTest(entry["id"]):
                file = RECORD / entry["files"][0]
                self.assertLess(file.stat().st_size, LARGEST)
                self.assertIn(f"({file.name})", page)
                self.assertIn(f"## Figure {entry['thesis_figure']}: {entry['title']}", page)
        for name in re.findall(r"\((figure_\S+\.svg)\)", page):
            self.assertTrue((RECORD / name).is_file(), name)

    def test_those_on_record_show_the_verdicts_of_the_ledger(self):
        claims = json.loads((REFERENCE / "claims.json").read_text(encoding="utf-8"))["claims"]
        drawn = json.loads((RECORD / command.ROWS).read_text(encoding="utf-8"))
        for figure in command.FIGURES:
            if figure.id in drawn:
                self.assertEqual(
                    drawn[figure.id],
                    command.measured(figure, claims),
                    f"{figure.id}: draw it with scripts/figures --record",
                )
        self.assertEqual(set(drawn["D.7"]), {"D1", "D2"})
        self.assertEqual(set(drawn["density"]), {"P1"})

    def test_each_describes_what_it_shows(self):
        for entry in self.index():
            with self.subTest(entry["id"]):
                self.assertGreater(len(entry["caption"]), 40)
                self.assertRegex(entry["caption"], r"\b[Oo]urs\b")
                self.assertNotRegex(entry["caption"], r"[{}]")
                for source in entry["sources"]:
                    self.assertTrue((self.results / source).is_file(), source)
                root = xml.parse(self.drawn / entry["files"][0]).getroot()
                known = {e.get("id") for e in root.iter()}
                self.assertLessEqual(
                    set(
                        re.findall(
                            r'(?:href="#|url\(#)(\w+)',
                            (self.drawn / entry["files"][0]).read_text(encoding="utf-8"),
                        )
                    ),
                    known,
                )
                # Empty axes have about ten paths and only numbers as text. All dots of one colour are one path.
                self.assertGreater(sum(1 for _ in root.iter(f"{SVG}path")), 12)
                self.assertRegex(
                    " ".join(root.itertext()),
                    r"\[(1|%|mm|s|ms|µs|N|N/m|N s/m|Hz|rad|kg|mm/s|m|m/s)\]|/ K|iterations|real "
                    r"part|points in contact|contacts",
                )

    def test_same_data_same_bytes(self):
        again, alone = self.directory / "again", self.directory / "alone"
        for out, only in ((again, DRAWN_BY_COMMAND), (alone, "A.5")):
            done = figures(
                self.results,
                "--out",
                out,
                "--only",
                only,
                PYTHONHASHSEED="7" if out == again else "8",
            )
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(len(self.index(out)), len(only.split(",")))
        for entry in self.index(again):
            self.assertEqual(
                {Path(name).suffix for name in entry["files"]}, {".svg", ".pdf", ".png"}
            )
            self.assertEqual(
                (again / entry["files"][0]).read_bytes(),
                (self.drawn / entry["files"][0]).read_bytes(),
                entry["id"],
            )
        for entry in self.index(alone):
            for name in entry["files"]:
                self.assertEqual((again / name).read_bytes(), (alone / name).read_bytes(), name)

    def test_missing_data_is_skipped_and_reported(self):
        empty, out = self.directory / "empty", self.directory / "nothing"
        empty.mkdir()
        status, _, errors = in_process(command.main, empty, "--out", out)
        self.assertEqual(status, 1)
        for id_ in IDS:
            self.assertRegex(errors, rf"skipped {re.escape(id_)} \(no .+\)")
        self.assertEqual(self.index(out), [])

    def test_usage(self):
        x = self.directory / "x"
        occupied = self.drawn / "figures.json"
        for words in (
            [self.results, "--out", x, "--only", "99"],
            [self.directory / "nowhere", "--out", x],
            [],
            ["--no-such"],
            [self.results, "--out", occupied, "--only", "6"],
        ):
            status, _, errors = in_process(command.main, *words)
            self.assertEqual((status, errors.count("\n")), (2, 1), errors)
            self.assertTrue(errors.startswith("hapbench: error: "), errors)
