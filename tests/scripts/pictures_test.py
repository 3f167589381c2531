"""The modules behind `hapbench plot` and `hapbench report`. Needs numpy and, for a filter to compare with, scipy."""
import re
import unittest

import numpy as np
from scipy import signal

from fixture import main
from pictures_fixture import Given, make_runs

from hapbench.columns import header, read_columns
from hapbench_pictures.quantities import settled_range
from hapbench_report.json_input import InputError
from hapbench_report.recording import force_steps, forces, rows_to_show, settled_rows, tool_profile, worst_moments
from hapbench_report.sound import high_passed, sound, strongest
from hapbench_style import curve, reduced

setUpModule = make_runs


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
        columns = {"time_s": np.arange(n) * 1e-3, "depth_max_m": rng.random(n), **{f"f{axis}_N": rng.normal(size=n) for axis in "xyz"}}
        kept = rows_to_show(columns)
        self.assertLess(len(kept), n / 10)
        for of in (np.linalg.norm(forces(columns), axis=1), force_steps(columns), columns["depth_max_m"]):
            self.assertIn(int(np.argmax(of)), kept)


class Moments(unittest.TestCase):
    def test_a_landing_is_what_follows_a_first_touch(self):
        # Contact from 1 to 3 s, a gap of 0.2 s, then from 3.2 s on; free from 5 to 7 s, contact again.
        t = np.arange(100) / 10
        touching = ((1 <= t) & (t < 3) | (3.2 <= t) & (t < 5) | (t >= 7)).astype(int)
        # A gap shorter than the settling time is no landing.
        np.testing.assert_array_equal(settled_rows(t, touching, 0.5, None), (1.5 <= t) & (t < 3) | (3.2 <= t) & (t < 5) | (t >= 7.5))
        np.testing.assert_array_equal(settled_rows(t, touching, 0.5, 4.0), (4 <= t) & (t < 5) | (t >= 7))

    def test_a_landing_sets_no_scale(self):
        force = np.array([0.0, 10.3, *np.linspace(0.9, 1.1, 500)])
        calm = np.arange(502) > 1
        low, high = settled_range([(calm, force, force)])
        self.assertTrue(0.7 < low < 0.9 and 1.1 < high < 1.3)
        # All is shown where the peak is not far beyond, and without settled contact.
        self.assertIsNone(settled_range([(calm, np.minimum(force, 3), np.minimum(force, 3))]))
        self.assertIsNone(settled_range([(calm & False, force, force)]))
        # So is a run that hammers: what settles of it for a moment tells nothing of the rest.
        hammering = np.where(calm & (np.arange(502) % 2 > 0), 10.0, force)
        self.assertIsNone(settled_range([(calm & (np.arange(502) < 50) & (hammering < 2), hammering, hammering)]))

    def test_the_worst_step_is_not_the_landing(self):
        force, none = np.array([0.0] * 10 + [9.0] + [1.0] * 59 + [1.5] + [1.0] * 29), np.zeros(100)
        columns = {"time_s": np.arange(100) / 100, "colliding": force > 0, "fx_N": force, "fy_N": none, "fz_N": none, "depth_max_m": force / 1000}
        step, depth = worst_moments(columns, {})
        self.assertEqual((step["title"], step["time"], step["value"]), ("settled force step", 0.7, 0.5))
        self.assertEqual((depth["time"], depth["value"]), (0.1, 9.0))
        # Three rows, 0.03 s, are too little to be called settled.
        step, _ = worst_moments({name: values[:18] for name, values in columns.items()}, {})
        self.assertEqual((step["title"], step["value"]), ("force step", 9.0))


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
        found = strongest(np.outer(direction, square))
        np.testing.assert_allclose(abs(found @ direction), 1, atol=1e-9)
        columns = {"time_s": t, "colliding": np.ones(4096), **{f"f{a}_N": square * d for a, d in zip("xyz", direction)}}
        packed = sound(columns)
        self.assertAlmostEqual(packed["rate"], 2048, places=6)
        # A square wave of 100 Hz has little below 30 Hz: its rms of 1 stays within a few per cent.
        self.assertAlmostEqual(packed["rms"], 1, delta=0.05)

    def test_too_few_rows_make_no_sound(self):
        columns = {"time_s": np.arange(50) / 100, **dict.fromkeys(("colliding", "fx_N", "fy_N", "fz_N"), np.ones(50))}
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


if __name__ == "__main__":
    main()
