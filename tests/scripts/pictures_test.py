"""Tests the modules that `hapbench plot`, `hapbench report` and the figures use, and the looks of the algorithms: each
algorithm has a different look that is legible on a light and on a dark background. Needs numpy."""
import json
import re
import shutil
import sys
import tempfile
import unittest
from functools import partial
from pathlib import Path
from unittest import mock

import matplotlib
import numpy as np
from skimage.color import deltaE_ciede2000, rgb2lab

from fixture import PROGRAM, SOURCE, hapbench, in_process, must, scratch_folder

import hapbench_looks
import hapbench_style as style
from hapbench import columns
from hapbench.errors import InputError
from hapbench_pictures import work_precision_plot
from hapbench_pictures.__main__ import main as pictures
from hapbench_pictures.panels import draw_over_time, looks
from hapbench_pictures.given import given_runs, labels
from hapbench_pictures.over_axes import Axis, over_axes
from hapbench_pictures.quantities import SHORT, Samples, settled_range
from hapbench_report.markup import TITLES
from hapbench_report.recording import (
    force_steps,
    forces,
    rows_to_show,
    settled_rows,
    sound,
    strongest,
    tool_profile,
)


def drawn(command, *words, expected=0):
    """Calls `hapbench plot` or `report` in this process, which has loaded matplotlib. Returns the standard output, or
    the standard error if input is refused."""
    status, output, error = in_process(pictures, command, *words, HAPBENCH_PROGRAM=str(PROGRAM))
    assert status == expected, (words, status, error)
    return error if expected == 2 else output


plotted = partial(drawn, "plot")


def make_root():
    """Creates the folder for the results of a test module; setUpModule calls this function."""
    Given.root = scratch_folder(unittest)


def make_runs():
    """Computes short runs, a comparison and a sweep once for a test module; setUpModule calls this function."""
    make_root()
    made(
        "mesh",
        "run",
        "mesh_molar",
        "--set",
        "time.duration_s=0.25",
        "--set",
        "record.contacts=true",
        "--set",
        "expect={}",
    )
    made("springs", "run", "springs_limited_mean", "--set", "time.steps=300", "--set", "expect={}")
    made(
        "peg",
        "compare",
        "peg_in_hole_2d_shaped_stiffness",
        "--algorithms",
        "mean,proxy,shaped_stiffness,summation",
    )
    made(
        "sweep",
        "sweep",
        "springs_limited_mean",
        "--vary",
        "rendering.stiffness_N_per_m=1e3:1e4:4:log",
        "--vary",
        "rendering.mass_kg=0.1:0.2:3",
        "--set",
        "expect={}",
    )


def made(name, *words):
    """Runs the program with these arguments. Returns the folder `name` with its output."""
    hapbench(*words, "--out", Given.root / name, "--quiet")
    return Given.root / name


class Given(unittest.TestCase):
    def assert_shows(self, picture, *texts):
        drawn = picture.read_text()
        for text in texts:
            self.assertIn(text, drawn)

    def assert_plot_shows(self, folder, *texts):
        self.assertEqual(plotted(folder), f"picture in {folder}/plot.svg\n")
        self.assert_shows(folder / "plot.svg", *texts)

    def copy(self, name):
        """Returns the folder of a copy of a run, which the test may modify."""
        directory = Path(tempfile.mkdtemp(dir=self.root)) / name
        shutil.copytree(self.root / name, directory)
        return directory


setUpModule = make_runs


class Columns(Given):
    def test_every_number_is_the_written_one(self):
        for file in self.root.glob("*/trajectory.csv"):
            reference = np.genfromtxt(file, delimiter=",", names=True)
            for piece in (700, columns.PIECE_BYTES):
                with mock.patch.object(columns, "PIECE_BYTES", piece):
                    found = columns.read_columns(file)
                for name in reference.dtype.names:
                    np.testing.assert_array_equal(found[name], reference[name], name)

    def test_gaps_and_what_is_wrong(self):
        file = self.root / "wrong.csv"
        file.write_text("a,b,c\r\n,,\r\n1,,3\r\n,2,3\r\n")
        np.testing.assert_array_equal(
            list(columns.read_columns(file).values()),
            [[np.nan, 1, np.nan], [np.nan, np.nan, 2], [np.nan, 3, 3]],
        )
        for text, message in (
            ("a,b\n1,2\n3\n", "line 3: got 1 fields; allowed: 2"),
            ("a,b\n1,2\n3,x\n", "line 3: b: got x; allowed"),
            ("a,b\n", "holds no row"),
            ("a,c\n1,2\n", "line 1: no column b"),
        ):
            file.write_text(text)
            with self.assertRaisesRegex(InputError, re.escape(f"{file}: {message}")):
                columns.read_columns(file, ["a", "b"])


class Reduction(unittest.TestCase):
    def test_no_peak_is_lost(self):
        rng = np.random.default_rng(3)
        time, values = np.arange(100_000) * 1e-3, rng.normal(size=100_000)
        values[[7_777, 50_001]] = 100, -90
        values[20_000:20_100] = np.nan
        t, low, high = style.reduced(time, values, values, 1000)
        np.testing.assert_array_equal(low, np.nanmin(values.reshape(1000, -1), axis=1))
        self.assertEqual((len(t), np.nanmin(low), np.nanmax(high)), (1000, -90, 100))
        self.assertEqual(len(style.curve(time, values, values, 1000)[0]), 2000)
        self.assertIs(style.reduced(time[:7], time, time, 900)[1], time)

    def test_the_replay_keeps_the_peaks(self):
        rng, n = np.random.default_rng(5), 30_000
        table = {
            "time_s": np.arange(n) * 1e-3,
            "depth_max_m": rng.random(n),
            **{f"f{axis}_N": rng.normal(size=n) for axis in "xyz"},
        }
        kept = rows_to_show(table)
        self.assertLess(len(kept), n / 10)
        for of in (np.linalg.norm(forces(table), axis=1), force_steps(table), table["depth_max_m"]):
            self.assertIn(int(np.argmax(of)), kept)


class Equal(Given):
    def test_equal_curves_take_turns(self):
        """Checks that the stripes of n coinciding lines together cover the line without overlap. A line without
        coinciding lines keeps its style."""
        a, b = np.arange(9.0), np.ones(9)
        self.assertEqual(style.equal_curves([(a, b), (a, a), (a, b)]), [(0, 2), (0, 1), (1, 2)])
        turns = [style.striped("-", index, 3) for index in range(3)]
        self.assertEqual(
            {on * 3 for _, (on, _) in turns} | {on + off for _, (on, off) in turns},
            {3 * style.STRIPE},
        )
        self.assertEqual([offset for offset, _ in turns], [0, style.STRIPE, 2 * style.STRIPE])
        self.assertEqual(style.striped("--", 0, 1), "--")
        _, ax = style.plt.subplots()
        over_axes(
            ax,
            Axis.of("x", a),
            Axis.of("y", b),
            [(name, a, b, {"ls": "-", "marker": "o"}) for name in "pq"],
        )
        marked = [
            set(range(9)[slice(line.get_markevery()[0], None, line.get_markevery()[1])])
            for line in ax.lines
        ]
        self.assertEqual((marked[0] & marked[1], marked[0] | marked[1]), (set(), set(range(9))))
        style.plt.close()

    def test_equal_runs_take_turns(self):
        runs = given_runs([self.root / "springs"]) * 2
        _, ax = style.plt.subplots()
        draw_over_time(
            ax,
            SHORT["force"],
            [Samples(run, [SHORT["force"]]) for run in runs],
            looks(runs, labels(runs)),
        )
        self.assertEqual(
            len({line.get_linestyle() for line in ax.lines if len(line.get_xdata()) > 2}), 1
        )
        self.assertEqual(
            len({line._unscaled_dash_pattern for line in ax.lines if len(line.get_xdata()) > 2}), 2
        )
        style.plt.close()


class Moments(unittest.TestCase):
    def test_a_landing_is_what_follows_a_first_touch(self):
        # Contact from 1 to 3 s and from 3.2 to 5 s, free from 5 to 7 s, then contact again. The gap of 0.2 s is shorter
        # than the settling time, so that no landing follows it.
        t = np.arange(100) / 10
        touching = ((1 <= t) & (t < 3) | (3.2 <= t) & (t < 5) | (t >= 7)).astype(int)
        rows = {"time_s": t, "colliding": touching}
        for metrics, settled in (
            ({"settling_s": 0.5}, (1.5 <= t) & (t < 3) | (3.2 <= t) & (t < 5) | (t >= 7.5)),
            ({"from_s": 4.0}, (4 <= t) & (t < 5) | (t >= 7)),
        ):
            np.testing.assert_array_equal(settled_rows(rows, {"metrics": metrics}), settled)

    def test_a_landing_sets_no_scale(self):
        force = np.array([0.0, 10.3, *np.linspace(0.9, 1.1, 500)])
        settled = np.arange(502) > 1
        low, high = settled_range([(settled, force, force)])
        self.assertTrue(0.7 < low < 0.9 and 1.1 < high < 1.3)
        # The axis shows the whole range in three cases: the peak is not far above the range of the settled contact,
        # there is no settled contact, or the tool bounces until the end of the run.
        self.assertIsNone(settled_range([(settled, np.minimum(force, 3), np.minimum(force, 3))]))
        self.assertIsNone(settled_range([(settled & False, force, force)]))
        hammering = np.where(settled & (np.arange(502) % 2 > 0), 10.0, force)
        self.assertIsNone(
            settled_range(
                [(settled & (np.arange(502) < 50) & (hammering < 2), hammering, hammering)]
            )
        )


class ModelErrors(unittest.TestCase):
    """Tests the picture of laws that are compared with a reference force."""

    def drawn(self, displacement, failed=()):
        """Returns the panels for two laws. `displacement`: texts in the table for the displacement [m] of each law. The
        cells for the errors of the laws in `failed` are empty."""
        laws = ("mean", "proxy")
        errors = [
            {
                "problem": law,
                "force_direction_error_rad": "" if law in failed else "0.1",
                "force_error_rms_N": "" if law in failed else "0.5",
                "displacement_rms_m": of_law,
                "shares_reference": "true" if law == "proxy" else "false",
            }
            for law, of_law in zip(laws, displacement)
        ]
        times = [{"step_median_s": "1e-6", "step_p99_9_s": "2e-6", "deadline_s": "0.00025"}] * 2
        files = mock.Mock()
        files.records = {
            work_precision_plot.MODEL_ERRORS: errors,
            work_precision_plot.MODEL_TIMES: times,
        }.get
        with matplotlib.rc_context(style.SETTINGS):
            figure = work_precision_plot.draw_model_errors(files)
        self.assertIn(
            "deadline, 0.25 ms", [text.get_text() for text in figure.legends[0].get_texts()]
        )
        return {ax.get_ylabel(): ax for ax in figure.axes if ax.get_visible()}

    def test_the_displacement_is_drawn_where_a_hand_moves_the_tool(self):
        panels = self.drawn(["1e-4", "2e-4"])
        self.assertEqual(len(panels), 3)
        marks = [
            line.get_ydata()[0]
            for line in panels["rms displacement of the tip [mm]"].lines
            if len(line.get_ydata()) == 1
        ]
        np.testing.assert_allclose(marks, [0.1, 0.2])

    def test_a_prescribed_path_has_no_displacement(self):
        self.assertEqual(len(self.drawn(["", ""])), 2)

    def test_a_law_whose_run_failed_is_left_out(self):
        panels = self.drawn(["1e-4", ""], failed=["proxy"])
        named = panels["rms error of the force [N]"].get_legend_handles_labels()[1]
        self.assertEqual(named, ["mean"])


class Shapes(unittest.TestCase):
    def test_a_force_that_turns_round_is_audible(self):
        t = np.arange(4096) / 2048
        square, direction = np.sign(np.sin(2 * np.pi * 100 * t)), np.array([0.6, 0.0, 0.8])
        np.testing.assert_allclose(
            abs(strongest(np.outer(direction, square)) @ direction), 1, atol=1e-9
        )
        packed = sound(
            {
                "time_s": t,
                "colliding": np.ones(4096),
                **{f"f{a}_N": square * d for a, d in zip("xyz", direction)},
            }
        )
        # A square wave of 100 Hz has little power below 30 Hz. The high-pass changes its rms of 1 by a few per cent.
        self.assertAlmostEqual(packed["rms"], 1, delta=0.05)

    def test_the_tool_is_a_cylinder_or_as_in_the_summary(self):
        self.assertEqual(
            tool_profile({"tool": {"diameter_m": 2, "length_m": 5, "tip": "flat"}}, {}),
            [[-5, 0], [-5, 1], [0, 1], [0, 0]],
        )
        for s, r in tool_profile({"tool": {"diameter_m": 2, "length_m": 5, "tip": "round"}}, {})[
            2:
        ]:
            self.assertAlmostEqual(s * s + r * r, 1)
        outline = [[-5, 0], [-5, 1], [0, 2.5], [0, 0]]
        self.assertEqual(
            tool_profile({"tool": {"type": "bur"}}, {"tool": {"outline_m": outline}}), outline
        )
        for wrong in ([], [[0, 1]], [[0, 1], [2]], [[0, 1], [1, None]], "outline"):
            self.assertIsNone(
                tool_profile({"tool": {"type": "bur"}}, {"tool": {"outline_m": wrong}}), wrong
            )


def contrast(first, second):
    low, high = sorted(
        hapbench_looks.luminance([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
        for colour in (first, second)
    )
    return (high + 0.05) / (low + 0.05)


class Looks(unittest.TestCase):
    def test_algorithms_are_distinguishable(self):
        names = {
            entry["name"]
            for entry in json.loads(hapbench("describe", "--json"))
            if entry["kind"] == "algorithm"
        }
        self.assertGreaterEqual(names, set(hapbench_looks.ALGORITHMS), "an entry for no algorithm")
        looks = [hapbench_looks.look(name) for name in names]
        for part in ("label", "colour", "dark", "marker"):
            entries = {getattr(look, part) for look in hapbench_looks.ALGORITHMS.values()}
            self.assertEqual(len(entries), len(hapbench_looks.ALGORITHMS), part)
        self.assertEqual(len({(look.colour, look.dash, look.marker) for look in looks}), len(names))

    def test_an_algorithm_without_an_entry_has_a_look_by_its_name(self):
        looks = [hapbench_looks.look(f"law_{i}") for i in range(200)]
        # Another process must give the same result, which must not depend on the order of calls or on the hash seed.
        output = must(
            sys.executable,
            "-c",
            "import hapbench_looks; print(hapbench_looks.look('law_7'))",
            PYTHONPATH=str(SOURCE / "scripts" / "python"),
            PYTHONHASHSEED="1",
        )
        self.assertEqual(output.strip(), repr(looks[7]))
        # With 360 hues, 4 dashes and 7 markers, few of 200 names have the same look.
        self.assertGreater(len({(look.colour, look.dash, look.marker) for look in looks}), 190)

    def test_colours_can_be_read(self):
        sheet = (SOURCE / "scripts/python/hapbench_report/assets/style.css").read_text(
            encoding="utf-8"
        )
        light, dark = (
            re.findall(rf"--{name}: (#[0-9a-f]{{6}})", sheet) for name in ("page", "panel")
        )
        light, dark = [light[0], "#ffffff"], [light[1], dark[1]]
        published = hapbench_looks.Look(
            "", hapbench_looks.PUBLISHED, hapbench_looks.PUBLISHED_DARK, (), ""
        )
        for look in (
            *hapbench_looks.ALGORITHMS.values(),
            *hapbench_looks.SERIES,
            *map(hapbench_looks.look, map(str, range(400))),
            published,
        ):
            for colour, grounds in ((look.colour, light), (look.dark, dark)):
                for ground in grounds:
                    self.assertGreaterEqual(
                        contrast(colour, ground), 4.5, (look.label, colour, ground)
                    )  # required contrast of text, WCAG 2.1, level AA

    def test_colours_are_distinguishable_with_every_kind_of_colour_vision(self):
        """Checks the colours as simulated by the method of Machado, Oliveira and Fernandes (IEEE TVCG 15, 2009,
        severity 1). A CIEDE2000 difference of 1 is just noticeable side by side; 6 is clearly visible between lines of
        a figure."""
        algorithms, series = hapbench_looks.ALGORITHMS.values(), hapbench_looks.SERIES
        for among, smallest in ((algorithms, 6.0), (series, 12.0)):
            for ground in ("colour", "dark"):
                colours = [getattr(look, ground) for look in among]
                for vision, matrix in hapbench_looks.VISIONS.items():
                    lab = rgb2lab(simulated(colours, matrix))
                    differences = deltaE_ciede2000(lab[:, None], lab[None]) + 99 * np.eye(len(lab))
                    self.assertGreaterEqual(differences.min(), smallest, (ground, vision))
        # No two algorithms have the same marker, and no two series have the same marker or dash.
        for part, among in (("marker", algorithms), ("marker", series), ("dash", series)):
            found = [getattr(look, part) for look in among]
            self.assertEqual(len(set(found)), len(found), part)

    def test_own_laws_are_distinguishable_from_the_others_of_a_picture(self):
        """Checks that all colours in a picture of two user laws and six other laws differ by at least 5 in CIEDE2000,
        which corresponds to MIN_DISTANCE in OKLab. If the colours depended only on the names, many user laws would look
        alike."""
        others = ("mean", "shaped_stiffness", "summation", "proxy", "least_squares", "tandpasta")
        too_close = 0
        for first in range(12):
            own = (f"law_{first}", f"own{7 * first}")
            hapbench_looks.distinguish((*own, *others))
            by_name = [hapbench_looks.by_name(name) for name in own]
            drawn = [hapbench_looks.look(name) for name in (*own, *others)]
            self.assertEqual(len({one.marker for one in drawn}), len(drawn))
            too_close += closest([*by_name, *drawn[2:]]) < 6.0
            self.assertGreaterEqual(closest(drawn), 5.0, own)
        self.assertGreater(too_close, 3)
        hapbench_looks.distinguish(())

    def test_the_titles_of_metrics_have_the_words_of_the_tables(self):
        """Compares TITLES with the headings in scenarios/program/run_table.hpp."""
        source = (SOURCE / "scenarios/program/run_table.hpp").read_text(encoding="utf-8")
        source = source[source.index("kRunHeadings[]") : source.index("};", source.index("kRunH"))]
        headings = re.findall(r'\{"([^"]*)", "(\w+)"', source)
        self.assertEqual({metric for _, metric in headings}, set(TITLES))
        for heading, metric in headings:
            title, unit, _ = TITLES[metric]
            words, _, of = heading.replace("\\n", " ").partition(" [")
            self.assertLessEqual(set(words.split()), set(title.split()), metric)
            self.assertEqual(of.rstrip("]"), unit, metric)

    def test_the_simulation_sees_what_is_known(self):
        """Checks that simulated colour blindness of any type leaves a grey unchanged. Deuteranopia must reduce the
        CIEDE2000 difference between a red and an olive to less than half of the difference in usual vision.
        """
        for matrix in hapbench_looks.VISIONS.values():
            # The published matrices have six digits.
            np.testing.assert_allclose(simulated(["#808080"], matrix), 128 / 255, atol=1e-5)
        (pair,) = (
            rgb2lab(simulated(["#B43C3C", "#6E6E00"], hapbench_looks.VISIONS["deuteranopia"])),
        )
        plain = rgb2lab(simulated(["#B43C3C", "#6E6E00"], np.eye(3)))
        self.assertLess(deltaE_ciede2000(*pair), 0.5 * deltaE_ciede2000(*plain))


def closest(looks):
    """Returns the smallest CIEDE2000 difference between the colours of `looks`, over both backgrounds and all types of
    vision."""
    smallest = np.inf
    for ground in ("colour", "dark"):
        for matrix in hapbench_looks.VISIONS.values():
            lab = rgb2lab(simulated([getattr(one, ground) for one in looks], matrix))
            differences = deltaE_ciede2000(lab[:, None], lab[None]) + 99 * np.eye(len(lab))
            smallest = min(smallest, differences.min())
    return smallest


def simulated(colours, matrix):
    """Returns the simulated sRGB values of colours for one type of vision, with a row for each colour."""
    rgb = np.array([[int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)] for colour in colours])
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    seen = np.clip(linear @ matrix.T, 0, 1)
    return np.where(seen <= 0.0031308, 12.92 * seen, 1.055 * seen ** (1 / 2.4) - 0.055)
