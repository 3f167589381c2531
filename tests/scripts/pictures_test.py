"""`hapbench plot` and `hapbench report`, and the modules behind them. Arguments: the built program, the source tree.
Needs numpy, matplotlib and, for a filter to compare with, scipy."""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
from scipy import signal

PROGRAM, SOURCE = Path(sys.argv[1]), Path(sys.argv[2])
sys.dont_write_bytecode = True
sys.path.insert(0, str(SOURCE / "scripts" / "python"))

from hapbench.columns import header, read_columns  # noqa: E402  (the path comes first)
from hapbench_pictures.given import given_runs, labels, named  # noqa: E402
from hapbench_pictures.looks import looks  # noqa: E402
from hapbench_pictures.plot import legend_columns, legend_of  # noqa: E402
from hapbench_pictures.reduced import curve, reduced  # noqa: E402
from hapbench_pictures.settled import settled_range, settled_rows  # noqa: E402
from hapbench_report.json_input import InputError  # noqa: E402
from hapbench_report.replay_rows import rows_to_show, settled, sizes, steps, worst_moments  # noqa: E402
from hapbench_report.replay_sound import high_passed, sound, strongest  # noqa: E402
from hapbench_report.replay_tool import tool_profile  # noqa: E402

ENVIRONMENT = {**os.environ, "HAPBENCH_PYTHON": sys.executable, "COLUMNS": "80"}


def hapbench(*words, locale="C", expected=0):
    """Standard output, or the error where one is expected."""
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, encoding="utf-8",
                          env={**ENVIRONMENT, "LC_ALL": locale}, stdin=subprocess.DEVNULL)
    assert done.returncode == expected, (words, done.returncode, done.stderr)
    return done.stderr if expected else done.stdout


def setUpModule():
    scratch = tempfile.TemporaryDirectory(prefix="hapbench-pictures-")
    unittest.addModuleCleanup(scratch.cleanup)
    Given.root = root = Path(scratch.name)
    hapbench("run", "mesh_molar", "--set", "time.duration_s=0.25", "--set", "record.contacts=true", "--set", "expect={}",
             "--out", root / "mesh", "--quiet")
    hapbench("run", "springs_limited_mean", "--set", "time.steps=300", "--set", "expect={}", "--out", root / "springs", "--quiet")
    hapbench("compare", "peg_in_hole_2d_shaped_stiffness", "--algorithms", "mean,proxy,summation", "--out", root / "peg", "--quiet")
    hapbench("sweep", "springs_limited_mean", "--vary", "rendering.stiffness_N_per_m=1e3:1e4:4:log", "--vary",
             "rendering.mass_kg=0.1:0.2:3", "--set", "expect={}", "--out", root / "sweep", "--quiet")


class Given(unittest.TestCase):
    def copy(self, name):
        """A copy of a run to spoil."""
        directory = Path(tempfile.mkdtemp(dir=self.root)) / name
        shutil.copytree(self.root / name, directory)
        return directory


class Columns(Given):
    def test_every_number_is_the_written_one(self):
        for file in self.root.glob("*/trajectory.csv"):
            names = header(file)
            found = read_columns(file, names)
            reference = np.genfromtxt(file, delimiter=",", names=True)
            self.assertEqual(len(found["step"]), len(reference))
            for name in names:
                np.testing.assert_array_equal(found[name], reference[name], name)

    def test_pieces_meet_without_a_seam(self):
        from hapbench import columns
        self.addCleanup(setattr, columns, "PIECE_BYTES", columns.PIECE_BYTES)
        file = self.root / "mesh" / "trajectory.csv"
        whole = read_columns(file, ["px_m", "ratio_min"])
        for columns.PIECE_BYTES in (700, 1001):
            for name, values in read_columns(file, ["px_m", "ratio_min"]).items():
                np.testing.assert_array_equal(values, whole[name])

    def test_what_is_wrong_is_named(self):
        file = self.root / "wrong.csv"
        for text, said in (("a,b\n1,2\n3\n", "line 3: got 1 fields; allowed: 2"), ("a,b\n1,2\n3,x\n", "line 3: b: got x; allowed"),
                           ("a,b\n", "holds no row"), ("a,c\n1,2\n", "line 1: no column b")):
            file.write_text(text)
            with self.assertRaisesRegex(InputError, re.escape(f"{file}: {said}")):
                read_columns(file, ["a", "b"])


class Reduction(unittest.TestCase):
    def test_no_peak_is_lost(self):
        rng = np.random.default_rng(3)
        time, values = np.arange(1_000_000) * 1e-3, rng.normal(size=1_000_000)
        values[[77_777, 500_001]] = 100, -90
        values[200_000:200_100] = np.nan
        for spans in (10, 900):
            t, low, high = reduced(time, values, values, spans)
            self.assertEqual(len(t), spans)
            of_span = values.reshape(spans, -1) if 1_000_000 % spans == 0 else None
            if of_span is not None:
                np.testing.assert_array_equal(low, np.nanmin(of_span, axis=1))
                np.testing.assert_array_equal(high, np.nanmax(of_span, axis=1))
            self.assertEqual((np.nanmin(low), np.nanmax(high)), (-90, 100))
            self.assertEqual(len(curve(time, values, values, spans)[0]), 2 * spans)

    def test_few_rows_stay(self):
        time = np.arange(7.0)
        self.assertIs(reduced(time, time, time, 900)[1], time)

    def test_the_replay_keeps_the_peaks(self):
        rng = np.random.default_rng(5)
        n = 30_000
        columns = {"time_s": (np.arange(n) * 1e-3).tolist(), "depth_max_m": rng.random(n).tolist(),
                   **{f"f{axis}_N": rng.normal(size=n).tolist() for axis in "xyz"}}
        kept = rows_to_show(columns)
        self.assertLess(len(kept), n / 10)
        for of in (sizes(columns), steps(columns), columns["depth_max_m"]):
            self.assertIn(int(np.argmax(of)), kept)


class Moments(unittest.TestCase):
    def test_a_landing_is_what_follows_a_first_touch(self):
        # Contact from 1 to 3 s, a gap of 0.2 s, then from 3.2 s on; free from 5 to 7 s, contact again.
        times = [i / 10 for i in range(100)]
        touching = [1 if 1 <= t < 3 or 3.2 <= t < 5 or t >= 7 else 0 for t in times]
        columns = {"time_s": times, "colliding": touching}
        calm = [t for t, yes in zip(times, settled(columns, 0.5, None)) if yes]
        # A gap shorter than the settling time is no landing.
        self.assertEqual(calm, [t for t in times if 1.5 <= t < 3 or 3.2 <= t < 5 or t >= 7.5])
        calm = [t for t, yes in zip(times, settled(columns, 0.5, 4.0)) if yes]
        self.assertEqual(calm, [t for t in times if 4 <= t < 5 or t >= 7])

    def test_settled_rows_are_those_of_the_replay(self):
        rng = np.random.default_rng(2)
        times, touching = np.arange(500) / 10, (rng.random(500) < 0.3).astype(int)
        columns = {"time_s": times.tolist(), "colliding": touching.tolist()}
        for from_s in (None, 4.0):
            for settling_s in (0.25, 0.45, 2.0):
                np.testing.assert_array_equal(settled_rows(times, touching, settling_s, from_s), settled(columns, settling_s, from_s))

    def test_a_landing_sets_no_scale(self):
        force = np.array([0.0, 10.3, *np.linspace(0.9, 1.1, 500)])
        calm = np.arange(502) > 1
        low, high = settled_range([(calm, force, force)])
        self.assertTrue(0.7 < low < 0.9 and 1.1 < high < 1.3)
        # All is shown where the peak is not far beyond, and without settled contact.
        self.assertIsNone(settled_range([(calm, np.minimum(force, 3), np.minimum(force, 3))]))
        self.assertIsNone(settled_range([(calm & False, force, force)]))

    def test_the_worst_step_is_not_the_landing(self):
        times = [i / 100 for i in range(100)]
        force = [0.0] * 10 + [9.0] + [1.0] * 59 + [1.5] + [1.0] * 29
        columns = {"time_s": times, "colliding": [int(f > 0) for f in force], "fx_N": force, "fy_N": [0.0] * 100, "fz_N": [0.0] * 100,
                   "depth_max_m": [f / 1000 for f in force]}
        step, depth = worst_moments(columns, {})
        self.assertEqual((step["title"], step["time"], step["value"]), ("settled force step", 0.7, 0.5))
        self.assertEqual((depth["time"], depth["value"]), (0.1, 9.0))


class Hearing(unittest.TestCase):
    def test_the_filter_is_a_butterworth_of_fourth_order(self):
        x = np.random.default_rng(1).normal(size=2000) + 3
        sections = signal.butter(4, 30, "high", fs=2048, output="sos")
        expected, _ = signal.sosfilt(sections, x, zi=signal.sosfilt_zi(sections) * x[0])
        # Same filter in another order of operations: rounding grows by the poles' 1 / (1 - |p|), here about 30.
        np.testing.assert_allclose(high_passed(x.tolist(), 2048), expected, rtol=0, atol=30 * 2000 ** 0.5 * 2.0 ** -50 * 10)

    def test_a_force_that_turns_round_is_heard(self):
        t = np.arange(4096) / 2048
        square = np.sign(np.sin(2 * np.pi * 100 * t))
        direction = np.array([0.6, 0.0, 0.8])
        found = np.array(strongest([(square * d).tolist() for d in direction]))
        np.testing.assert_allclose(abs(found @ direction), 1, atol=1e-9)
        columns = {"time_s": t.tolist(), "colliding": [1] * 4096, **{f"f{a}_N": (square * d).tolist() for a, d in zip("xyz", direction)}}
        packed = sound(columns)
        self.assertAlmostEqual(packed["rate"], 2048, places=6)
        # A square wave of 100 Hz has little below 30 Hz: its rms of 1 stays within a few per cent.
        self.assertAlmostEqual(packed["rms"], 1, delta=0.05)

    def test_too_few_rows_make_no_sound(self):
        columns = {"time_s": [i / 100 for i in range(50)], "colliding": [1] * 50, "fx_N": [1.0] * 50, "fy_N": [0.0] * 50, "fz_N": [0.0] * 50}
        self.assertIsNone(sound(columns))


class Tool(unittest.TestCase):
    def test_a_round_tip_is_a_hemisphere(self):
        flat = tool_profile({"tool": {"diameter_m": 2, "length_m": 5, "tip": "flat"}}, {})
        self.assertEqual(flat, [[-5, 0], [-5, 1], [0, 1], [0, 0]])
        round_ = tool_profile({"tool": {"diameter_m": 2, "length_m": 5, "tip": "round"}}, {})
        for s, r in round_[2:]:
            self.assertAlmostEqual(s * s + r * r, 1)
        self.assertIsNone(tool_profile({"tool": {}}, {}))

    def test_the_summary_has_the_outline_of_a_tool_that_is_no_cylinder(self):
        outline = [[-5, 0], [-5, 1], [0, 2.5], [0, 0]]
        self.assertEqual(tool_profile({"tool": {"type": "bur"}}, {"tool": {"outline_m": outline}}), outline)
        for wrong in ([], [[0, 1]], [[0, 1], [2]], [[0, 1], [1, None]], "outline", [[0, 1], 5]):
            self.assertIsNone(tool_profile({"tool": {"type": "bur"}}, {"tool": {"outline_m": wrong}}), wrong)


class Plot(Given):
    def test_a_sketch_and_a_picture(self):
        said = hapbench("plot", self.root / "mesh")
        for text in ("rendered force [N]", "largest depth [mm]", "stiffness ratio [K]", "colliding points", "first touch at"):
            self.assertIn(text, said)
        self.assertIn(f"picture in {self.root / 'mesh' / 'plot.svg'}", said)
        picture = (self.root / "mesh" / "plot.svg").read_text()
        for text in ("rendered force [N]", "tip x [mm]", "tip z [mm]", "(dots: surface)", "time [s]"):
            self.assertIn(text, picture)

    def test_the_sketch_fits_the_terminal_and_its_characters(self):
        for locale, known in (("C", str.isascii), ("C.UTF-8", lambda line: all(ord(c) < 128 or 0x2800 <= ord(c) < 0x2900 for c in line))):
            lines = hapbench("plot", self.root / "mesh", "--out", self.root / "m.svg", locale=locale).splitlines()
            for line in lines[:-1]:
                self.assertLessEqual(len(line), 80)
                self.assertTrue(known(line), line)
            self.assertEqual(any(not line.isascii() for line in lines), locale != "C")

    def test_the_sketch_names_the_peak(self):
        columns = read_columns(self.root / "mesh" / "trajectory.csv", ["time_s", "fx_N", "fy_N", "fz_N"])
        size = np.sqrt(columns["fx_N"] ** 2 + columns["fy_N"] ** 2 + columns["fz_N"] ** 2)
        said = hapbench("plot", self.root / "mesh", "--y", "force", "--out", self.root / "m.svg")
        self.assertIn(f"rendered force [N], most {size.max():.4g} at {columns['time_s'][size.argmax()]:.4g} s", said)

    def test_kinds_of_files(self):
        for name, start in (("a.svg", b"<?xml"), ("a.png", b"\x89PNG"), ("a.pdf", b"%PDF")):
            self.assertEqual(hapbench("plot", self.root / "springs", "--no-sketch", "--out", self.root / name),
                             f"picture in {self.root / name}\n")
            self.assertTrue((self.root / name).read_bytes().startswith(start))

    def test_same_runs_same_bytes(self):
        pictures = []
        for _ in range(2):
            hapbench("plot", self.root / "peg", "--quiet", "--out", self.root / "same.svg")
            pictures.append((self.root / "same.svg").read_bytes())
        self.assertEqual(*pictures)

    def test_a_span_of_time_and_a_peak_that_is_cut_off(self):
        run = self.copy("mesh")
        table = run / "trajectory.csv"
        names, (first, *rows) = header(table), table.read_text().splitlines()
        cells = [row.split(",") for row in rows]
        touching = next(i for i, row in enumerate(cells) if int(row[names.index("colliding")]) > 0)
        cells[touching][names.index("fz_N")] = "1234.5"
        table.write_text("\n".join([first, *(",".join(row) for row in cells)]) + "\n")
        said = hapbench("plot", run, "--y", "force")
        self.assertRegex(said, r"rendered force \[N\], most 123\d.* \(cut off\)")
        self.assertIn("peak 1.23e+03 N", (run / "plot.svg").read_text())
        after = float(cells[touching + 1][names.index("time_s")])
        said = hapbench("plot", run, "--y", "force", "--from", after, "--to", 0.24)
        self.assertNotIn("cut off", said)
        self.assertNotIn("first touch", said)

    def test_columns_by_their_names(self):
        said = hapbench("plot", self.root / "mesh", "--y", "fz_N,hx_m,speed", "--out", self.root / "m.svg")
        for text in ("fz [N]", "hx [mm]", "speed of the tip [m/s]"):
            self.assertIn(text, said)

    def test_a_comparison_is_overlaid(self):
        said = hapbench("plot", self.root / "peg", "--y", "force")
        self.assertIn("a mean   b proxy   c summation   + several", said)
        # One of 13 800 N beside one of 3 N.
        self.assertIn("logarithmic", said)

    def test_what_an_earlier_comparison_left_is_not_drawn(self):
        folder = self.copy("peg")
        table = (folder / "comparison.csv").read_text().splitlines()
        (folder / "comparison.csv").write_text("\n".join(line for line in table if not line.startswith("proxy")) + "\n")
        self.assertEqual(sorted(run.algorithm for run in given_runs([folder])), ["mean", "summation"])

    def test_labels_tell_runs_apart(self):
        runs = given_runs([self.root / "peg"])
        self.assertEqual(labels(runs), ["mean", "proxy", "summation"])
        runs = given_runs([self.root / "peg" / "mean", self.root / "springs"])
        self.assertEqual(labels(runs), ["peg_in_hole_2d_shaped_stiffness", "springs_limited_mean"])
        runs = self.variants({"seed": 1}, {"seed": 2})
        self.assertEqual(named(runs), (["mean, seed 1", "mean, seed 2"], ["mean", "mean"]))
        runs = self.variants({"rendering.stiffness_N_per_m": 10000}, {"rendering.stiffness_N_per_m": 4e4})
        self.assertEqual(labels(runs), ["K = 10 000 N/m", "K = 40 000 N/m"])
        runs = self.variants({"hand.mass_kg": 0.1}, {"rendering.mass_kg": 0.33})
        self.assertIn("rendering.mass_kg=0.33", labels(runs)[1])
        runs = self.variants({}, {})
        self.assertEqual(labels(runs), ["mean, 0/springs", "mean, 1/springs"])

    def variants(self, *changes):
        """Copies of a run whose scenarios have other values."""
        folder = Path(tempfile.mkdtemp(dir=self.root))
        for i, change in enumerate(changes):
            shutil.copytree(self.root / "springs", folder / str(i) / "springs")
            file = folder / str(i) / "springs" / "scenario.effective.json"
            scenario = json.loads(file.read_text())
            for path, value in change.items():
                section, _, name = path.rpartition(".")
                (scenario.setdefault(section, {}) if section else scenario)[name] = value
            file.write_text(json.dumps(scenario))
        return given_runs([folder])

    def test_the_legend_has_an_entry_for_all_seeds_and_is_not_cut(self):
        runs = self.variants({"seed": 1}, {"seed": 2}, {"seed": 3})
        self.assertEqual(list(legend_of(looks(runs, *named(runs)))), ["mean (3 seeds)"])
        self.assertEqual([legend_columns(["x" * n], 7.0) for n in (5, 30, 90)], [4, 2, 1])

    def test_a_sweep_over_two_fields_is_a_map(self):
        said = hapbench("plot", self.root / "sweep", "--metric", "speed_max_m_per_s")
        self.assertIn("mass [kg]; upwards stiffness K [N/m]", said)
        picture = (self.root / "sweep" / "plot.svg").read_text()
        for text in ("mass [kg]", "stiffness K [N/m]", "speed max [m/s]"):
            self.assertIn(text, picture)

    def test_failed_runs_of_a_sweep_have_no_value(self):
        folder = self.copy("sweep")
        table = (folder / "sweep.csv").read_text().splitlines()
        names = table[0].split(",")
        failed, empty = table[1].split(","), table[2].split(",")
        failed[names.index("outcome")], failed[names.index("speed_max_m_per_s")] = "diverges", "1e9"
        empty[names.index("speed_max_m_per_s")] = ""
        (folder / "sweep.csv").write_text("\n".join([table[0], ",".join(failed), ",".join(empty), *table[3:]]) + "\n")
        said = hapbench("plot", folder, "--metric", "speed_max_m_per_s")
        self.assertIn("x diverges   ? no value", said)
        self.assertIn(" |xx??", said)
        self.assertNotIn("e+09", said)
        picture = (folder / "plot.svg").read_text()
        for text in ("diverges", "no value"):
            self.assertIn(text, picture)

    def test_maps_and_limits(self):
        maps, limit = self.root / "maps", self.root / "limit"
        hapbench("stability", "--map", "time_step", "--size", 3, "--algorithms", "mean,proxy", "--integrators", "leapfrog,rk4", "--out", maps,
                 "--quiet")
        self.assertEqual(hapbench("plot", maps), "".join(f"picture in {maps}/plot_time_step_{name}.svg\n" for name in ("leapfrog", "rk4")))
        picture = (maps / "plot_time_step_leapfrog.svg").read_text()
        for text in ("limit, theory", "limit, bisection", "time step [s]", "stiffness [N/m]", "diverged"):
            self.assertIn(text, picture)
        hapbench("limit", "springs_limited_mean", "--vary", "rendering.stiffness_N_per_m", "--set", "time.steps=300", "--set", "expect={}",
                 "--resolution", 0.1, "--out", limit, "--quiet")
        hapbench("plot", limit, "--quiet")
        for text in ("limit, bisection", "stiffness K [N/m]", "mean"):
            self.assertIn(text, (limit / "plot.svg").read_text())
        for words, said in (((maps, limit), "one such folder alone"), ((limit, "--y", "force"), "allowed for it: --out")):
            self.assertIn(said, hapbench("plot", *words, expected=2))
        (limit / "limit_runs.csv").write_text("algorithm,class\nmean,stable\n")
        self.assertIn("is not a table that hapbench wrote", hapbench("plot", limit, expected=2))

    def test_bad_input(self):
        mesh, sweep = self.root / "mesh", self.root / "sweep"
        bare = self.copy("springs")
        (bare / "trajectory.csv").unlink()
        for words, said in (
                ((mesh, "--y", "forse"), 'nearest valid name: "force"'), ((mesh, "--y", "fz"), 'nearest valid name: "fz_N"'),
                ((mesh, "--y", "energy"), "run it with --set record.energy=true"),
                ((mesh, "--y", "torque"), "has no tx_Nm; run it with --set record.torque=true"), ((mesh, "--out", "x.gif"), "allowed: .svg, .png, .pdf"),
                ((self.root / "mseh",), 'nearest valid name: "mesh"'), ((self.root / "nothing" / "here",), "no such folder"),
                ((sweep, "--metric", "speed_max"), 'nearest valid name: "speed_max_m_per_s"'), ((sweep, "--y", "force"), "allowed for it: --metric"),
                ((mesh, "--from", "5"), "no row of trajectory.csv between 5 and inf s; allowed: a span with rows between 0 and"), ((mesh, "--to", "x"), "a time in seconds"),
                ((mesh, "--from", "0.2", "--to", "0.1"), "--from before --to"), ((sweep, "--from", "1"), "--from: "), ((sweep, mesh), "one sweep alone"), ((mesh, "--metric", "x"), "is for a sweep"), ((bare,), "record.trajectory=true")):
            error = hapbench("plot", *words, expected=2)
            self.assertTrue(error.startswith("hapbench: error: ") and said in error and error.count("\n") == 1, error)


class Page(Given):
    def page(self, *words):
        out = self.root / "page.html"
        hapbench("report", *words, "--out", out)
        return out.read_text(encoding="utf-8")

    def test_refers_to_nothing_outside_itself(self):
        page = self.page(self.root / "mesh")
        for reference in re.findall(r'(?:src|href)="([^"]*)"', page):
            self.assertRegex(reference, r"^(#|data:)")
        names = re.findall(r'\bid="([^"]+)"', page)
        self.assertEqual(len(names), len(set(names)))
        self.assertLessEqual(set(re.findall(r'href="#([^"]+)"', page)), set(names))

    def test_holds_nothing_of_the_thesis(self):
        for name in ("mesh", "springs", "peg"):
            page = self.page(self.root / name)
            # A bundled scenario names its source itself.
            page = re.sub(r"<(style|script|details)\b.*?</\1>|<p class=lead>.*?</p>", "", page, flags=re.S)
            self.assertEqual(re.findall(r"(?i)thesis|ledger|T\. C\. Lee|not reproduced", page), [])

    def test_sections_are_there_when_they_have_content(self):
        page = self.page(self.root / "mesh")
        self.assertEqual(re.findall(r'<section id="(\w+)"', page), ["summary", "replay", "curves", "metrics", "scenario", "rerun", "provenance"])
        run = self.copy("mesh")
        (run / "trajectory.csv").unlink()
        summary = json.loads((run / "summary.json").read_text())
        summary["warnings"] = ["in contact 4.9 % of the run <b>"]
        summary["metrics"] |= {"landing_force_max_N": 7.25, "force_rms_above_30Hz_N": 0.125}
        (run / "summary.json").write_text(json.dumps(summary))
        page = self.page(run)
        self.assertEqual(re.findall(r'<section id="(\w+)"', page), ["summary", "warnings", "metrics", "scenario", "rerun", "provenance"])
        for text in ("in contact 4.9 % of the run &lt;b&gt;", "Landing max, N", "7.25", "Force above 30 Hz rms, N", "0.125"):
            self.assertTrue(text in page, text)

    def test_the_commands_repeat_the_run(self):
        page = self.page(self.root / "springs")
        command = re.search(r"hapbench (run [^\n<]*scenario.effective.json) --out", page)[1]
        again = self.root / "again"
        hapbench(*command.split(), "--out", again, "--quiet")
        self.assertEqual((again / "trajectory.csv").read_bytes(), (self.root / "springs" / "trajectory.csv").read_bytes())

    def test_the_replay_has_every_run(self):
        scene, = self.scenes(self.root / "peg")
        self.assertEqual([r["label"] for r in scene["recordings"]], ["mean", "proxy", "summation"])
        self.assertTrue(scene["planar"])
        self.assertTrue(scene["shell"])
        self.assertIsNotNone(scene["recordings"][0]["sound"])

    def test_runs_of_several_scenes_are_several_replays(self):
        scenes = self.scenes(self.root / "mesh", self.root / "springs")
        self.assertEqual([scene["id"] for scene in scenes], ["mesh_molar", "springs_limited_mean-2"])
        self.assertFalse(scenes[0]["planar"])
        self.assertEqual((scenes[1]["tool"], scenes[1]["shell"]), (None, ""))
        self.assertTrue(scenes[1]["springs"])

    def scenes(self, *words):
        data = re.search(r'<script type="application/json" id="replay-data">(.*?)</script>', self.page(*words), re.S)[1]
        return json.loads(data)

    def test_markup_in_the_input_is_text_in_the_page(self):
        run = self.copy("springs")
        hostile = '</script><script>alert(1)</script><img src="https://example.org/x">'
        summary = json.loads((run / "summary.json").read_text())
        summary |= {"name": hostile, "algorithm": hostile, "outcome": hostile, "warnings": [hostile]}
        (run / "summary.json").write_text(json.dumps(summary))
        page = self.page(run)
        self.assertFalse("<script>alert" in page or '<img src="https' in page)

    def test_bad_input(self):
        for words, said in (((self.root / "sweep",), "is a sweep"), ((self.root / "mesh", "--out", "x.pdf"), "allowed: .html"),
                            ((self.root / "none",), "no such folder")):
            error = hapbench("report", *words, expected=2)
            self.assertTrue(said in error and error.count("\n") == 1, error)


if __name__ == "__main__":
    assert PROGRAM.is_file(), PROGRAM
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
