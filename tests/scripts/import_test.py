"""`hapbench import stroke` against numpy and scipy."""
import json
import math
import os
import random
import signal as signals
import struct
import subprocess
import sys
import time
import unittest
from functools import partial
from pathlib import Path

import numpy as np
from fixture import ENVIRONMENT, PROGRAM, SOURCE, hapbench, ran, scratch_folder
from scipy import signal
from scipy.spatial.transform import Rotation, Slerp

from hapbench.columns import header
from hapbench_import.__main__ import command_line
from hapbench_command import Faults
from hapbench_import.options import options_of
from hapbench_import.recording import open_recording
from hapbench_import.stroke import import_stroke, resolution_of, stroke_text

DATA = SOURCE / "scenarios" / "library" / "examples" / "data"
PRESETS = SOURCE / "scenarios" / "library" / "presets"
LOG = DATA / "wipe.hapi.txt"
Y_UP = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float)  # x, -z, y
run = partial(ran, PROGRAM)
STRAIGHT = "0,0,0,0\n0.01,0.001,0,0\n0.02,0.002,0,0\n0.03,0.003,0,0\n"


def binary_log(names, samples, number="d"):
    return (
        b"".join(name.encode() + b"\0" for name in names)
        + b"\0"
        + b"".join(struct.pack(f"<{len(s)}{number}", *s) for s in samples)
    )


class Given(unittest.TestCase):
    def setUp(self):
        self.root = scratch_folder(self)

    def write(self, data, name="rec.csv"):
        (self.root / name).write_bytes(data if isinstance(data, bytes) else data.encode())
        return str(self.root / name)

    def report(self, data, columns="time=1,position=2", **options):
        """The stroke of a recording with these contents, and what was found in it, by the package
        that the command starts."""
        words = [self.write(data)] + (["--columns", columns] if columns else [])
        for name, value in options.items():
            if name in ("floats", "force_by_tool", "max_gap", "max_speed", "shift", "tip_axis"):
                words += ["--set", f"{name}={str(value).lower()}"]
            else:
                words += [f"--{name.replace('_', '-')}"] + ([] if value is True else [str(value)])
        given = command_line().parse(words)
        chosen = options_of(given)
        return import_stroke(open_recording(given.file, chosen), chosen)

    def stroke(self, data, columns="time=1,position=2", **options):
        return self.report(data, columns, **options)[0]

    def refusal(self, data, columns="time=1,position=2", **options):
        """What is refused, without the folder; empty when nothing is."""
        try:
            self.report(data, columns, **options)
            return ""
        except Faults as faults:
            return "\n".join(faults.lines).replace(f"{self.root}/", "")

    def imported(self, *words):
        """Report, columns and rows of the stroke that the command makes of the log."""
        file = self.root / "stroke.csv"
        report = json.loads(
            hapbench("import", "stroke", LOG, "--preset", "hapi", "--out", file, "--json", *words)
        )
        return report, header(file), np.genfromtxt(file, delimiter=",", skip_header=1)


class Recordings(Given):
    def test_resamples_and_smooths_as_scipy_does(self):
        log = np.loadtxt(LOG, skiprows=1)
        time = log[:, 0] - log[0, 0]
        turns = Rotation.from_matrix(Y_UP) * Rotation.from_rotvec(
            log[:, 4:7] / np.linalg.norm(log[:, 4:7], axis=1, keepdims=True) * log[:, 7:8]
        )
        for rate, window, order in ((150, 9, 3), (333, 21, 2)):
            report, names, stroke = self.imported(
                "--rate", rate, "--smooth", f"window={window},order={order}"
            )
            self.assertEqual(names, "time_s px_m py_m pz_m qw qx qy qz mfx_N mfy_N mfz_N".split())
            grid = np.arange(len(stroke)) / rate
            np.testing.assert_allclose(stroke[:, 0], grid, atol=1e-12)
            place = np.column_stack(
                [np.interp(grid, time, part) for part in (log[:, 1:4] @ Y_UP.T).T]
            )
            force = np.column_stack(
                [np.interp(grid, time, part) for part in (log[:, 8:11] @ Y_UP.T).T]
            )
            smooth = signal.savgol_filter(place, window, order, axis=0, mode="interp")
            np.testing.assert_allclose(stroke[:, 1:4], smooth, atol=1e-13)
            np.testing.assert_allclose(stroke[:, 8:], force, atol=1e-12)
            moved = np.linalg.norm(smooth - place, axis=1)
            self.assertAlmostEqual(
                report["smoothing"]["position_largest_m"], moved.max(), delta=1e-13
            )
            self.assertAlmostEqual(
                report["smoothing"]["position_rms_m"], np.sqrt(np.mean(moved**2)), delta=1e-13
            )
            # Their components, of one sign, are smoothed and normalised again.
            quaternions = Slerp(time, turns)(np.minimum(grid, time[-1])).as_quat()
            signs = np.cumprod(
                np.sign(np.concatenate([[1], np.sum(quaternions[1:] * quaternions[:-1], axis=1)]))
            )
            smooth = Rotation.from_quat(
                signal.savgol_filter(
                    quaternions * signs[:, None], window, order, axis=0, mode="interp"
                )
            )
            written = Rotation.from_quat(stroke[:, [5, 6, 7, 4]])
            self.assertLess((smooth.inv() * written).magnitude().max(), 1e-7)

    def test_columns_are_taken_by_number_name_and_alone(self):
        rows, fast = "7,0,1,2,3\n8,1,1.5,2,3\n", {"max_speed": 10, "max_gap": 1}
        named = "n,t,x,y,z\n" + rows
        for data, columns, place in (
            (rows, "time=2,position=3", [1.5, 2, 3]),
            (named, "time=t,position=x", [1.5, 2, 3]),
            (named.replace(",", ";"), "time=t,px=z,py=x,pz=4", [3, 1.5, 2]),
        ):
            self.assertEqual(self.stroke(data, columns, **fast).position[1].tolist(), place)
        header = "t,tip_x,tip_yy,tip_z\n0,0,0,0\n1,0,0,0\n"
        self.assertRegex(
            self.refusal(header, "time=t,position=tap_x"),
            'rec.csv: columns: position: got "tap_x"; nearest valid name: '
            '"tip_x"; the file has 1 t, 2 tip_x, 3 tip_yy, 4 tip_z$',
        )
        self.assertEqual(
            self.refusal(STRAIGHT, "time=1,position=3"),
            "rec.csv: columns: position: takes columns 3 ... 5; the file has 1, 2, 3, 4",
        )

    def test_clocks_of_other_units_are_refused(self):
        even = "".join(f"{1999 * i},{1e-5 * i},0,0\n" for i in range(5))  # [us]
        self.assertEqual(
            self.refusal(even),
            "rec.csv: got a median interval of 1999 s; allowed: 0.5 s (--set max_gap=...); are times "
            "in other units? (--scale time=1e-06)",
        )
        self.assertEqual(self.refusal(even, scale="time=1e-6"), "")
        # Four times the median are no gap, but longer than allowed.
        slow = "0,0,0,0\n0.2,0.001,0,0\n0.4,0.002,0,0\n1.2,0.003,0,0\n"
        self.assertEqual(
            self.refusal(slow),
            "rec.csv, line 3: a gap of 0.8 s follows; allowed: 0.5 s (--set max_gap=...)",
        )
        self.assertEqual(self.report(slow, max_gap=0.8)[1]["gaps"], 0)

    def test_the_mean_direction_of_the_tip_shows_a_wrong_order(self):
        # Two turns about x, by 0.2 +- 0.1 rad, written w first.
        rows = "".join(
            f"{0.01 * i},0,0,0,{math.cos(a / 2)!r},{math.sin(a / 2)!r},0,0\n"
            for i, a in enumerate((0.1, 0.3))
        )
        layout = (
            "--columns",
            "time=1,position=2,orientation=5",
            "--out",
            self.root / "s.csv",
            "--json",
        )
        report = json.loads(
            hapbench("import", "stroke", self.write(rows), "--orientation", "quat_wxyz", *layout)
        )
        np.testing.assert_allclose(
            report["tip_direction"], [0, math.sin(0.2), -math.cos(0.2)], atol=1e-12
        )
        self.assertAlmostEqual(report["tip_direction_spread_rad"], 0.1, delta=1e-8)
        wrong = run("import", "stroke", self.write(rows), "--orientation", "quat_xyzw", *layout)
        self.assertIn("the tip points upwards in the mean", wrong.stderr)
        self.assertGreater(json.loads(wrong.stdout)["tip_direction"][2], 0.5)

    def test_units_and_frames_are_put_right(self):
        stroke, found = self.report(
            "5e6,1,2,3,1,0,2\n5.1e6,1,2,4,1,0,2\n",
            "time=1,position=2,force=5",
            frame="x,-z,y",
            shift="0.5,0,0",
            scale="time=1e-6,position=1e-3,force=9.81",
            force_by_tool=True,
        )
        np.testing.assert_allclose(stroke.position[1], [0.501, -0.004, 0.002], atol=1e-15)
        np.testing.assert_allclose(stroke.force[0], [-9.81, 19.62, 0], atol=1e-14)
        np.testing.assert_allclose(stroke.time, [0, 0.1], atol=1e-12)
        self.assertEqual(found["first_time_s"], 5.0)

    def test_every_way_to_write_an_orientation_is_the_same_turn(self):
        noise = np.random.default_rng(2)
        for _ in range(20):
            turn, tip = Rotation.random(random_state=noise.integers(1 << 30)), noise.normal(size=3)
            x, y, z, w = turn.as_quat()
            vector = turn.as_rotvec()
            angle = np.linalg.norm(vector)
            written = {
                "quat_wxyz": (w, x, y, z),
                "quat_xyzw": (-x, -y, -z, -w),
                "axis_angle": (*vector / angle, angle),
                "matrix": turn.as_matrix().ravel(),
                "axis": turn.apply(tip),
            }
            for kind, numbers in written.items():
                cells = "".join(f",{number!r}" for number in map(float, numbers))
                found = self.stroke(
                    f"0,0,0,0{cells}\n0.4,0,0,0{cells}\n",
                    "time=1,position=2,orientation=5",
                    orientation=kind,
                    tip_axis=",".join(map(repr, map(float, tip))),
                ).turn[1]
                np.testing.assert_allclose(
                    found.apply([0, 0, -1]),
                    turn.apply(tip) / np.linalg.norm(tip),
                    atol=1e-7,
                    err_msg=kind,
                )

    def test_bad_rows_are_refused_with_their_lines(self):
        start, line = "t,x,y,z\n0,0,0,0\n", "rec.csv, line 3: "
        fix = "; --skip-bad-rows leaves bad rows out"
        number = "; allowed: a finite number"
        for rows, problem in (
            ("0.1,nan,0,0\n", line + f'column 2 x: got "nan"{number}'),
            ("0.1,,0,0\n", line + f'column 2 x: got ""{number}'),
            ("0.1,1_0,0,0\n", line + f'column 2 x: got "1_0"{number}'),
            ("0.1,0,+-1,0\n", line + f'column 3 y: got "+-1"{number}'),
            ("0.1,0,0,1e999\n", line + f'column 4 z: got "1e999"{number}'),
            ("0.1,0,0\n", line + "got 3 values; allowed: 4"),
            ("0,0,0,0\n", line + "got time 0 s after 0 s; allowed: increasing times"),
            ("-1,0,0,0\n", line + "got time -1 s after 0 s; allowed: increasing times"),
            (
                "0.1,1,0,0\n",
                line
                + "got a jump of 1000 mm in 100 ms, 10 m/s; allowed: 5 m/s (is the scale right?)",
            ),
            (
                "0.1,0,0,0\n0.2,0,0,0\n0.3,0,0,0\n1.5,0,0,0\n",
                "rec.csv, line 5: a gap of 1.2 s follows; allowed: 0.5 s (--set max_gap=...)",
            ),
            (
                "0.1,2e6,0,0\n",
                line
                + "too large a number; allowed: positions below 1e6 m, forces below 1e9 N, times below 1e12 s",
            ),
        ):
            found = self.refusal(start + rows, "time=t,position=x")
            self.assertEqual(found, problem + ("" if "a gap of" in problem else fix))
        self.assertEqual(
            self.refusal(start + "x,0,0,0\n0,0,0\n", "time=t,position=x").count("\n"),
            1,
            "each with its line",
        )
        self.assertEqual(
            self.refusal("0,0,0,0\n"), "rec.csv: 1 usable samples of 1; allowed: at least 2"
        )
        self.assertEqual(self.refusal(""), "rec.csv: no samples; allowed: a line for each")

    def test_orientations_that_are_none_are_refused(self):
        for kind, cells, problem in (
            (
                "quat_wxyz",
                "0.9,0,0,0",
                "line 1: got a quaternion of norm 0.9; allowed: 1 within 0.001",
            ),
            ("quat_wxyz", "0.9991,0,0,0", None),
            ("axis_angle", "0,0,0,1", "got a turn's axis of norm 0"),
            ("axis_angle", "0,0,0,0", None),
            ("matrix", "1,0,0,0,1,0,0,0,-1", "not a rotation"),
            ("axis", "0,0,0", "axis of length 0"),
        ):
            found = self.refusal(
                f"0,0,0,0,{cells}\n0.1,0,0,0,{cells}\n",
                "time=1,position=2,orientation=5",
                orientation=kind,
            )
            self.assertTrue(problem in found if problem else found == "", (kind, cells, found))

    def test_options_are_refused_by_name(self):
        for options, problem in (
            (
                {"smooth": "window=4,order=2"},
                "smooth: got a window of 4 samples; allowed: odd, 3 ... 4",
            ),
            ({"smooth": "window=3,order=3"}, "order 3"),
            ({"smooth": "window=x"}, '--smooth: window: got "x"'),
            ({"scale": "time=0"}, "scale: time: got 0; allowed: > 0"),
            ({"scale": "tyme=1"}, 'nearest valid name: "time"'),
            ({"frame": "x,y,-z"}, "right-handed"),
            ({"frame": "x,y,y"}, "each once"),
            ({"tip_axis": "0,0,0"}, "tip_axis: allowed: a direction"),
            ({"shift": "1,2"}, "shift: got [1,2]; allowed: three numbers"),
            ({"set": "max_gab=1"}, 'nearest valid name: "max_gap"'),
            ({"rate": "0"}, "rate: got 0 Hz"),
            ({"columns": "position"}, '--columns: got "position"; allowed: NAME=VALUE'),
        ):
            self.assertIn(problem, self.refusal(STRAIGHT, **options))

    def test_bad_rows_are_left_out_where_asked(self):
        stroke, found = self.report(
            "0,0,0,0\n0.01,x,0,0\n0.02,0.002,0,0\n0.015,0,0,0\n0.03,9,0,0\n0.04,0.004,0,0\n",
            skip_bad_rows=True,
        )
        self.assertEqual(stroke.position[:, 0].tolist(), [0, 0.002, 0.004])
        self.assertEqual(
            [said.split(": ")[0].rpartition(" ")[2] for said in found["warnings"][1:4]],
            ["2", "4", "5"],
        )

    def test_a_regular_clock_is_kept_and_an_irregular_one_evened(self):
        _, found = self.report(STRAIGHT)
        self.assertFalse(found["resampled"])
        self.assertAlmostEqual(found["rate_Hz"], 100, delta=1e-9)
        stroke, found = self.report(
            "1,0,0,0\n1.008,0.0008,0,0\n1.02,0.002,0,0\n1.03,0.003,0,0\n1.04,0.004,0,0\n"
        )
        self.assertTrue(found["resampled"])
        self.assertEqual(found["rate_Hz"], 100)
        np.testing.assert_allclose(stroke.time, np.arange(5) / 100, atol=1e-15)
        np.testing.assert_allclose(stroke.position[:, 0], 0.1 * stroke.time, atol=1e-12)
        turn = self.stroke(
            "0,0,0,0,0,1,0,0\n1,0,0,0,0,1,0,1.2\n",
            "time=1,position=2,orientation=5",
            orientation="axis_angle",
            rate=8,
            max_gap=2,
        ).turn
        np.testing.assert_allclose(
            (turn[0].inv() * turn).magnitude(), 0.15 * np.arange(9), atol=1e-12
        )

    def test_the_resolution_is_the_step_of_rounded_numbers(self):
        noise = random.Random(1)
        for step in (1e-3, 1e-5, 5.5e-5, 1e-6, 1e-8):
            for offset in (0.0, -0.03, 7.0):
                found = resolution_of(
                    np.array(
                        [step * round((offset + 0.1 * noise.random()) / step) for _ in range(1000)]
                    )
                )
                if step < 2e-9 * abs(offset):
                    self.assertIsNone(found, "rounding hides it")
                else:
                    self.assertAlmostEqual(found / step, 1, delta=1e-6)
        self.assertAlmostEqual(
            resolution_of(np.array([0.0, 6e-5, 15e-5, 25e-5])),
            1e-5,
            delta=1e-15,
            msg="no neighbours are a step apart",
        )
        for full in ([noise.random() for _ in range(1000)], [0.25, 0.25]):
            self.assertIsNone(resolution_of(np.array(full)))

    def test_text_and_binary_logs_are_the_same_stroke(self):
        names, samples = ["TIME", "POSITION", "ORIENTATION", "FORCE"], [
            [0.5, 0.001, 0.002, 0.003, 0, 1, 0, 0.25, 1, 2, 3],
            [0.51, 0.001, 0.002, 0.004, 0, 1, 0, 0.5, 1, 2, 4],
        ]
        text = (
            " ".join(names)
            + "\n"
            + "".join(" ".join(map(repr, sample)) + " \r\n" for sample in samples)
        )
        expected = self.stroke(text, "", preset="hapi")
        np.testing.assert_allclose(expected.position[1], [0.001, -0.004, 0.002], atol=1e-15)
        self.assertEqual(expected.force[1].tolist(), [1, -4, 2])
        self.assertEqual(
            stroke_text(self.stroke(binary_log(names, samples), "", preset="hapi_binary")),
            stroke_text(expected),
        )
        floats = self.stroke(binary_log(names, samples, "f"), "", preset="hapi_binary", floats=True)
        np.testing.assert_allclose(floats.position, expected.position, atol=1e-9)
        buttons = (
            b"BUTTONS\0"
            + binary_log(["TIME", "POSITION"], [])
            + b"".join(struct.pack("<idddd", 3, t, 0.001 * t, 0.002, 0.003) for t in (1, 1.25))
        )
        stroke, found = self.report(buttons, "", preset="hapi_binary")
        self.assertEqual((stroke.time[1], stroke.force, stroke.has_roll), (0.25, None, False))
        self.assertEqual(
            sum("as the preset names them: left out" in said for said in found["warnings"]),
            2,
            "neither orientation nor force",
        )
        cut, found = self.report(
            binary_log(["TIME", "POSITION"], [[0, 0, 0, 0], [0.1, 0, 0, 0], [0.2, 0, 0, 0]])[:-3],
            "",
            preset="hapi_binary",
        )
        self.assertEqual(len(cut.time), 2)
        self.assertIn("behind sample 2 are 29 bytes", found["warnings"][2])

    def test_what_is_no_log_is_refused(self):
        for number in ("9" * 400, "NaN", "Infinity"):
            own = self.write(f'{{"sample_rate_Hz": {number}}}', "own.json")
            self.assertIn("sample_rate_Hz: got", self.refusal("0 0 0\n", "position=1", preset=own))
        for data, preset, problem in (
            ("TIME POSITON\n0 0 0 0\n", "hapi", 'rec.csv, line 1: unknown field "POSITON"'),
            ("TIME TIME\n0 0\n", "hapi", 'rec.csv, line 1: field "TIME" twice; allowed: once'),
            ("TIME POSITION\n" + "0 0 0 0\n" * 8, "hapi_binary", "--format hapi"),
            (b"\0", "hapi_binary", "no field names"),
        ):
            self.assertIn(problem, self.refusal(data, "", preset=preset))

    def test_of_two_names_in_a_preset_the_one_in_the_file_counts(self):
        self.assertEqual(
            self.stroke(
                "h_pos_x,h_pos_y,h_pos_z\n0,0,0\n0.001,0,0\n", "", preset="falcon_traces"
            ).time[1],
            0.001,
        )

    def test_whatever_the_bytes_have_become_they_are_read_or_refused(self):
        noise = random.Random(4)
        text = LOG.read_bytes()[:2000]
        binary = binary_log(
            ["TIME", "POSITION", "ORIENTATION", "FORCE"],
            [[0.01 * i, 0, 0, 0.001, 0, 1, 0, 0.5, 1, 2, 3] for i in range(9)],
        )
        for i in range(120):
            for data, preset in (
                (text, "hapi"),
                (binary, "hapi_binary"),
                (noise.randbytes(noise.randrange(300)), "traj"),
            ):
                data = bytearray(data)
                for _ in range(noise.randrange(4)):
                    at = noise.randrange(len(data) + 1)
                    data[at : at + noise.randrange(3)] = noise.choice(
                        [
                            b"",
                            b"\0",
                            b"\xff",
                            b" ",
                            b"\n",
                            b"e",
                            b"-",
                            b"9" * 400,
                            b"nan",
                            bytes(data[at : at + 30]),
                        ]
                    )
                try:
                    stroke = self.stroke(
                        bytes(data),
                        "",
                        preset=preset,
                        max_gap=1e9,
                        **({"skip_bad_rows": True} if i % 2 else {}),
                        **({"smooth": "window=3,order=1"} if i % 3 == 0 else {}),
                    )
                    self.assertTrue(
                        (np.diff(stroke.time) > 0).all()
                        and np.isfinite(stroke.position).all()
                        and len(stroke_text(stroke)) > 50
                    )
                except Faults as faults:
                    self.assertLess(len(str(faults)), 8000)


def moved(time):
    """Places of a tip [m] at the times [s]."""
    angle = 6.0 * time
    return np.column_stack(
        [0.004 * np.sin(angle), 0.0025 * (1 - np.cos(angle)), 0.0008 - 0.0002 * np.sin(angle)]
    )


def table(names, *columns, separator=",", end="\n", number="%.9g"):
    rows = [separator.join(number % value for value in row) for row in np.column_stack(columns)]
    return end.join([names] * bool(names) + rows) + end


class Layouts(Given):
    """Recordings of other programs: what is read is what they mean, and what is not clear is refused or said."""

    TIME = 0.002 * np.arange(100)
    PLACES = moved(TIME)
    TURNS = Rotation.from_rotvec(
        np.column_stack([0.3 + 0.2 * np.sin(6 * TIME), 0.5 + 0 * TIME, 0.8 + 0.1 * TIME])
    )
    PLAIN = table("t,x,y,z", TIME, PLACES)

    def columns(self, found, quantity):
        return [part["column"] for part in found["columns"][quantity]]

    def assert_places(self, data, columns="time=t,position=x", places=PLACES, **options):
        stroke, found = self.report(data, columns, **options)
        np.testing.assert_allclose(stroke.position, places, atol=1e-9)
        return "\n".join(found["warnings"]), found

    def assert_tip(self, data, columns, warned="", **options):
        """The tool points where the true turns say."""
        stroke, found = self.report(data, f"time=t,position=x,{columns}", **options)
        down = [0, 0, -1]
        np.testing.assert_allclose(stroke.turn.apply(down), self.TURNS.apply(down), atol=1e-6)
        self.assertIn(warned, "\n".join(found["warnings"]))
        self.assertEqual(bool(warned), bool(found["warnings"]), found["warnings"])

    def test_components_are_found_by_their_names(self):
        t, (x, y, z) = self.TIME, self.PLACES.T
        for names, columns, given, expected in (
            ("t,x,vx,y,vy,z,vz", (x, t, y, t, z, t), "position=x", [2, 4, 6]),
            ("t,px,vx,py,vy,pz,vz", (x, t, y, t, z, t), "position=px", [2, 4, 6]),
            ("t,x,z,y", (x, z, y), "position=x", [2, 4, 3]),
            ("t,x_m,y_m,z_m", (x, y, z), "position=x_m", [2, 3, 4]),
            ("t,pose.z,pose.y,pose.x", (z, y, x), "position=pose.x", [4, 3, 2]),
            ("t,pose.z,pose.y,pose.x", (z, y, x), "position=pose", [4, 3, 2]),
            ("t,tipX,tipY,tipZ", (x, y, z), "position=tipX", [2, 3, 4]),
            ("t,p[0],p[1],p[2]", (x, y, z), "position=p[0]", [2, 3, 4]),
            ("t,a,b,c", (x, y, z), "position=2", [2, 3, 4]),
            ("", (x, y, z), "position=2", [2, 3, 4]),
        ):
            time = "time=1" if names == "" else "time=t"
            warned, found = self.assert_places(table(names, t, *columns), f"{time},{given}")
            self.assertEqual(self.columns(found, "position"), expected, names)
            self.assertEqual(warned, "")
        self.assertEqual(
            self.report(table("t,x,vx,y,vy,z,vz", t, x, t, y, t, z, t), "time=t,position=x")[1][
                "columns_not_read"
            ],
            ["3 vx", "5 vy", "7 vz"],
        )

    def test_columns_that_the_names_do_not_decide_are_refused(self):
        turned = table("t,x,y,z,q0,q1,q2,q3", self.TIME, self.PLACES, self.TURNS.as_quat())
        for data, columns, problem in (
            (
                table("t,a,b,c", self.TIME, self.PLACES),
                "position=a",
                'do not say which columns go with "a"; allowed: px=...,py=...,pz=..., or position=2 for',
            ),
            (self.PLAIN, "position=y", "not its first by name; allowed: position=x"),
            (self.PLAIN, "position=x,px=x", "is named as a whole and by px"),
            (self.PLAIN, "position=x,force=x", "column 2 x is also named for position"),
            (turned, "position=x,orientation=q0", "--orientation is missing; allowed: axis, quat_"),
            (turned, "position=x,orientation=5", "--orientation is missing"),
            (turned, "position=x,qw=q3,qx=q0", "qy: is missing beside others"),
        ):
            self.assertIn(problem, self.refusal(data, f"time=t,{columns}"))
        self.assertIn(
            "allowed: one of them",
            self.refusal(self.PLAIN, "time=t,position=x", set="sample_rate_Hz=500"),
        )

    def test_a_number_takes_what_follows_and_says_what_the_names_say(self):
        data = table("t,x,vx,y,z", self.TIME, self.PLACES[:, [0, 0, 1, 2]])
        _, found = self.report(data, "time=1,position=2")
        self.assertEqual(self.columns(found, "position"), [2, 3, 4])
        self.assertIn("by their names it would be 2 x, 4 y, 5 z", found["warnings"][0])

    def test_a_quaternion_is_read_by_the_names_of_its_columns(self):
        xyzw = self.TURNS.as_quat()
        last = table("t,x,y,z,qx,qy,qz,qw", self.TIME, self.PLACES, xyzw)
        first = table("t,x,y,z,qw,qx,qy,qz", self.TIME, self.PLACES, np.roll(xyzw, 1, axis=1))
        self.assert_tip(last, "orientation=qx")
        self.assert_tip(first, "orientation=qw")
        self.assert_tip(first, "orientation=qx")
        self.assert_tip(last, "qw=qw,qx=qx,qy=qy,qz=qz")
        self.assert_tip(last, "orientation=5", orientation="quat_xyzw")
        # An order that contradicts the names.
        contradicted = "was read by the names of its columns (qx, qy, qz, qw)"
        self.assert_tip(last, "orientation=qx", contradicted, orientation="quat_wxyz")
        self.assertIn(
            "by their names it would be 8 qw, 5 qx, 6 qy, 7 qz",
            self.report(last, "time=t,position=x,orientation=5", orientation="quat_wxyz")[1][
                "warnings"
            ][0],
        )
        self.assertIn(
            "their names say otherwise",
            self.report(last, "time=t,position=x,qw=qx,qx=qy,qy=qz,qz=qw")[1]["warnings"][0],
        )
        # Columns that no orientation takes.
        for columns in ("orientation=qx", "qw=qw,qx=qx,qy=qy,qz=qz"):
            self.assertIn(
                "is not used: --orientation none takes no columns",
                self.refusal(last, f"time=t,position=x,{columns}", orientation="none"),
            )

    def test_other_orientations_are_read_by_their_names(self):
        vector = self.TURNS.as_rotvec()
        angle = np.linalg.norm(vector, axis=1)
        turn = (self.TIME, self.PLACES, vector / angle[:, None])
        self.assert_tip(table("t,x,y,z,ax,ay,az,angle", *turn, angle), "orientation=ax")
        degrees = np.degrees(angle)
        self.assert_tip(table("t,x,y,z,ax,ay,az,angle [deg]", *turn, degrees), "orientation=ax")
        for values, scale, said in (
            (degrees, "1", "look like degrees"),
            (angle, "0.0174533", "look like radians"),
        ):
            _, found = self.report(
                table("t,x,y,z,ax,ay,az,angle", *turn, values),
                "time=t,position=x,orientation=ax",
                scale=f"angle={scale}",
            )
            self.assertIn(said, found["warnings"][0])
        cells = self.TURNS.as_matrix()
        by_columns = cells.transpose(0, 2, 1).reshape(-1, 9)
        names = "t,x,y,z,r11,r21,r31,r12,r22,r32,r13,r23,r33"
        self.assert_tip(table(names, self.TIME, self.PLACES, by_columns), "orientation=r11")

    def test_texts_of_every_program_are_the_same_numbers(self):
        comma = self.PLAIN.replace(",", ";").replace(".", ",")
        quoted = table('"t","x","y","z"', self.TIME, self.PLACES, number='"%.9g"')
        for data, warned in (
            ("\ufeff" + self.PLAIN, ""),
            (self.PLAIN.encode("utf-16"), "the text is UTF-16"),
            (self.PLAIN.replace("\n", "\r\n"), ""),
            (self.PLAIN.replace("\n", "\r"), ""),
            (self.PLAIN.replace(",", "\t"), ""),
            (self.PLAIN.replace(",", " "), ""),
            (quoted, ""),
            (quoted.replace('"', "'"), ""),
            ("Rate: 500\n" + self.PLAIN, "1 line above the header skipped, the first: line 1"),
            (comma, 'line 3: got "0,002": numbers have a decimal comma'),
            (comma.replace(";", "\t"), "numbers have a decimal comma"),
            (comma.replace(";", " "), "numbers have a decimal comma"),
            (quoted.replace(".", ","), "numbers have a decimal comma"),
            ("% " + self.PLAIN, ""),
            ("# made by hand\n#" + self.PLAIN, "1 comment line skipped, the first: line 1"),
            (self.PLAIN.replace("\n", ",\n"), "a separator at the end of every line ignored"),
            (self.PLAIN.replace("\n", ",\n").replace("z,", "z"), "at the end of 100 lines ignored"),
            (self.PLAIN.replace("z", "z,"), "a separator at the end of the header ignored"),
        ):
            said, _ = self.assert_places(data)
            self.assertIn(warned, said)
            self.assertEqual(bool(warned), bool(said), said)
        bare = comma.partition("\n")[2]
        self.assert_places(bare, "time=1,position=2")
        self.assertEqual(self.assert_places(comma, decimal="comma")[0], "")

    def test_commas_that_are_not_clear_are_refused(self):
        between = (
            "got 5 values; allowed: 4. Numbers with a decimal comma cannot be separated by commas"
        )
        self.assertIn(between, self.refusal(self.PLAIN.replace(".", ","), "time=t,position=x"))
        grouped = "t;x;y;z\n" + "".join(f"{i};{i};1,{200 + i};3\n" for i in range(9))
        self.assertIn(
            'line 2: column 3 y: got "1,200": is the comma a decimal comma? --decimal comma',
            self.refusal(grouped, "time=t,position=x"),
        )
        self.assertIn(
            'line 3: column 1 t: got "0,002"; allowed: a finite number (99 rows, the last: line 101)',
            self.refusal(
                self.PLAIN.replace(",", ";").replace(".", ","), "time=t,position=x", decimal="point"
            ),
        )

    def test_a_fault_is_told_once_with_its_repetitions(self):
        lines = self.PLAIN.split("\n")
        lines[10:40] = [line.rpartition(",")[0] + ",nan" for line in lines[10:40]]
        self.assertEqual(
            self.refusal("\n".join(lines), "time=t,position=x"),
            'rec.csv, line 11: column 4 z: got "nan"; allowed: a finite number (30 rows, the last: line 40); '
            "--skip-bad-rows leaves bad rows out",
        )

    def test_a_log_of_rostopic_is_read_by_its_names(self):
        # Nanoseconds since 1970 are more than a double holds.
        pose = np.column_stack([self.PLACES, self.TURNS.as_quat()])
        ends = [f".{c}" for c in "xyz"], [f".{c}" for c in "xyzw"]
        names = ["field.pose.position" + end for end in ends[0]] + [
            "field.pose.orientation" + end for end in ends[1]
        ]
        log = f"%time,field.header.seq,{','.join(names)}\n" + "".join(
            f"{1600000000123456789 + 2000000 * i},{i},{','.join(map(repr, row))}\n"
            for i, row in enumerate(pose.tolist())
        )
        columns = "time=%time,position=field.pose.position.x,orientation=field.pose.orientation.x"
        self.assertIn("are times in other units? (--scale time=1e-09)", self.refusal(log, columns))
        _, found = self.assert_places(log, columns, scale="time=1e-9")
        self.assertFalse(found["resampled"])
        self.assertAlmostEqual(found["rate_Hz"], 500, delta=1e-9)
        self.assertAlmostEqual(found["first_time_s"], 1600000000.123, delta=1e-3)
        self.assertTrue(found["has_roll"])

    def test_units_in_names_are_applied(self):
        millimetres = table("t [ms],x [mm],y [mm],z [mm]", 1e3 * self.TIME, 1e3 * self.PLACES)
        _, found = self.assert_places(millimetres)
        self.assertEqual(found["scales"], {"time": 1e-3, "position": 1e-3})
        self.assert_places(
            millimetres.replace("[", "(")
            .replace("]", ")")
            .replace("x", "X")
            .replace("y", "Y")
            .replace("z", "Z"),
            "time=t,position=X",
        )
        self.assert_places(
            table("t_ms,x_mm,y_mm,z_mm", 1e3 * self.TIME, 1e3 * self.PLACES),
            "time=t_ms,position=x_mm",
        )
        rows = millimetres.partition("\n")[2]
        for header in ("t/ms,x/mm,y/mm,z/mm\n", '"t, ms","x, mm","y, mm","z, mm"\n'):
            self.assert_places(header + rows)
        said, _ = self.assert_places("t,x,y,z\nms,mm,mm,mm\n" + rows)
        self.assertEqual(said, "line 2 has the units of the columns")
        self.assert_places(self.PLAIN.replace("z\n", "z [-]\n", 1).replace("x", "x [-]"))
        counts = millimetres.replace("mm", "counts")
        self.assertIn(
            'column 2 x [counts]: the unit "counts" is unknown: --scale position=...',
            self.refusal(counts, "time=t,position=x"),
        )
        self.assert_places(counts, scale="position=0.001")
        _, found = self.report(millimetres, "time=t,position=x", scale="position=0.0005")
        self.assertIn(
            "says mm, a scale of 0.001; --scale position=0.0005 was used", found["warnings"][0]
        )
        self.assertIn(
            "different units (m, mm)",
            self.refusal(millimetres.replace("y [mm]", "y [m]"), "time=t,position=x"),
        )

    def test_a_clock_in_other_units_is_named_with_the_scale(self):
        for factor, scale in ((1e3, "0.001"), (1e6, "1e-06"), (1e9, "1e-09")):
            for rate in (100, 500, 4000):
                time = self.TIME * 500 / rate
                data = table("t,x,y,z", 1e9 * factor + factor * time, moved(time), number="%.19g")
                self.assertIn(f"(--scale time={scale})", self.refusal(data, "time=t,position=x"))
        _, found = self.report(
            table("t,x,y,z", 50 * self.TIME, moved(0.05 * self.TIME)), "time=t,position=x"
        )
        self.assertIn("with --scale time=0.001 the rate is 1e+04 Hz", found["warnings"][0])
        _, found = self.report(self.PLAIN, "time=t,position=x", scale="time=1e-3")
        self.assertIn("with --scale time=1 the rate is 500 Hz", found["warnings"][0])

    def test_poses_held_for_several_rows_are_thinned_to_the_true_samples(self):
        time = 1e-3 * np.arange(1200)
        for rows in (2, 3, 5, 10):
            held = time[np.arange(1200) // rows * rows]
            stroke, found = self.report(table("t,x,y,z", time, moved(held)), "time=t,position=x")
            self.assertEqual((found["rows_per_held_sample"], found["resampled"]), (rows, False))
            self.assertAlmostEqual(found["rate_Hz"], 1000 / rows, delta=1e-6)
            np.testing.assert_allclose(stroke.position, moved(time[::rows]), atol=1e-9)
            self.assertIn(f"each pose is repeated in {rows} rows", found["warnings"][0])
        # Rates that are no multiples, a speed that looks too fast in one row, and a rest.
        held = np.floor(60 * time) / 60
        _, found = self.report(table("t,x,y,z", time, 40 * moved(held)), "time=t,position=x")
        self.assertAlmostEqual(found["rows_per_held_sample"], 1000 / 60, delta=0.1)
        self.assertLess(found["speed_max_m_per_s"], 1.2)
        at_rest = np.maximum(time[np.arange(1200) // 4 * 4] - 0.4, 0)
        _, found = self.report(table("t,x,y,z", time, moved(at_rest)), "time=t,position=x")
        self.assertEqual((found["samples"], found["gaps"]), (300, 0))
        kept = self.stroke(
            table("t,x,y,z", time, moved(held)), "time=t,position=x", set="held_rows=keep"
        )
        self.assertEqual(len(kept.time), 1200)
        # A clock with jitter: runs of 3, 4 and 5 rows.
        lengths = np.random.default_rng(7).choice([3, 4, 5], 300, p=[0.2, 0.6, 0.2])
        held = time[np.repeat(np.cumsum(lengths) - lengths, lengths)[:1200].clip(max=1199)]
        _, found = self.report(
            table("t,x,y,z", time[: len(held)], moved(held)), "time=t,position=x"
        )
        self.assertAlmostEqual(found["rows_per_held_sample"], 4.0, delta=0.1)
        # Coarse numbers, and an even speed in steps, are no held samples.
        for places in (np.round(moved(time), 4), np.round(np.outer(time, [0.0025, 0, 0]), 5)):
            _, found = self.report(table("t,x,y,z", time, places), "time=t,position=x")
            self.assertEqual((found["rows_per_held_sample"], found["samples"]), (1, 1200))

    def test_a_force_into_the_surface_is_told(self):
        force = np.column_stack(
            [0.1 + 0 * self.TIME, 0 * self.TIME, 0.5 + 0.3 * np.sin(8 * self.TIME)]
        )
        for sign, by_tool, said in (
            (1, False, ""),
            (-1, False, "--set force_by_tool=true"),
            (-1, True, ""),
            (1, True, "leave out force_by_tool=true"),
        ):
            _, found = self.report(
                table("t,x,y,z,fx,fy,fz", self.TIME, self.PLACES, sign * force),
                "time=t,position=x,force=fx",
                force_by_tool=by_tool,
            )
            self.assertIn(said, "".join(found["warnings"]))
            self.assertEqual(bool(said), bool(found["warnings"]))


class Command(Given):
    def test_makes_a_stroke_that_runs_at_once_and_is_compared_with_its_force(self):
        report, _, _ = self.imported("--set", "shift=0,0,-0.001")
        self.assertEqual(
            (report["rate_Hz"], report["resampled"], report["has_roll"]), (99, True, True)
        )
        self.assertAlmostEqual(report["quantum_force_N"], 0.2, delta=1e-7)
        hapbench(
            "new", "stroke", "--from", self.root / "stroke.csv", "--out", self.root / "stroke.json"
        )
        hapbench("validate", self.root / "stroke.json")
        # Shifted by a millimetre, it leads the edge of the tool deeper than its half width: went_through.
        done = json.loads(
            hapbench(
                "run",
                self.root / "stroke.json",
                "--set",
                "record.force_reference=true",
                "--set",
                "expect.outcome=went_through",
                "--out",
                self.root / "run",
                "--json",
            )
        )
        self.assertGreater(done[0]["fidelity"]["rows"], 100)

    def test_writes_nothing_of_a_bad_recording(self):
        rec = self.write("t,x,y,z\n0,0,0,0\n1,0,0\n0.5,nan,0,0\n")
        said = hapbench(
            "import",
            "stroke",
            rec,
            "--columns",
            "time=t,position=x",
            "--out",
            self.root / "new" / "stroke.csv",
            expected=2,
        )
        self.assertIn("line 3: got 3 values; allowed: 4", said)
        self.assertIn('line 4: column 2 x: got "nan"', said)
        self.assertEqual(os.listdir(self.root), ["rec.csv"])

    def test_does_not_depend_on_the_locale(self):
        rec = self.write("zeit,größe_x,größe_y,größe_z\n0,0,0,0\n0.5,0.001,0,0\n", "prüfung.csv")
        for locale in ("C", "C.UTF-8", "de_DE.ISO-8859-1"):
            done = run(
                "import",
                "stroke",
                rec,
                "--columns",
                "time=zeit,position=größe",
                "--out",
                self.root / "ö.csv",
                LC_ALL=locale,
            )
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("ö.csv", done.stdout)
            self.assertIn(
                "prüfung.csv: columns: position",
                run(
                    "import", "stroke", rec, "--columns", "time=zeit,position=no", LC_ALL=locale
                ).stderr,
            )

    def test_reads_a_pipe_once(self):
        pipe = self.root / "pipe"
        os.mkfifo(pipe)
        with subprocess.Popen(["sh", "-c", 'printf %s "$1" > "$0"', pipe, STRAIGHT]) as writer:
            hapbench(
                "import",
                "stroke",
                pipe,
                "--columns",
                "time=1,position=2",
                "--out",
                self.root / "a.csv",
            )
            self.assertEqual(writer.wait(), 0)
        file = self.write(STRAIGHT)
        hapbench(
            "import", "stroke", file, "--columns", "time=1,position=2", "--out", self.root / "b.csv"
        )
        self.assertEqual((self.root / "a.csv").read_bytes(), (self.root / "b.csv").read_bytes())

    def test_presets_and_devices_may_come_from_a_pipe(self):
        for name, text in (
            ("preset", '\ufeff{"columns": {"time": 1, "position": 2}}'),
            ("device", '{"type": "impedance", "handle_mass_kg": 0.1}'),
        ):
            (self.root / name).write_text(text, encoding="utf-8")
        file = self.write(STRAIGHT)
        for words in (
            f"import stroke {file} --preset <(cat {self.root}/preset) --out {self.root}/s.csv",
            f"limit tap_wall --device <(cat {self.root}/device) --vary rendering.stiffness_N_per_m "
            f"--between 1000:2000 --out {self.root}/limit",
        ):
            done = ran("bash", "-c", f"{PROGRAM} {words}")
            self.assertEqual(done.returncode, 0, done.stderr)
        missing = run(
            "limit", "tap_wall", "--device", "./none", "--vary", "rendering.stiffness_N_per_m"
        )
        self.assertIn("none: ", missing.stderr)

    def test_numbers_may_have_a_plus_sign(self):
        signed = STRAIGHT.replace("0.0", "+0.0").replace("0,0\n", "+0,+0\n")
        np.testing.assert_array_equal(self.stroke(signed).position, self.stroke(STRAIGHT).position)
        semicolons = signed.replace(",", ";").replace(".", ",")
        np.testing.assert_array_equal(
            self.stroke(semicolons).position, self.stroke(STRAIGHT).position
        )

    def test_ctrl_c_stops_it_at_any_time(self):
        file = self.write(
            table("t,x,y,z", 0.001 * np.arange(60000), moved(0.001 * np.arange(60000)))
        )
        words = [
            "import",
            "stroke",
            file,
            "--columns",
            "time=t,position=x",
            "--out",
            self.root / "s.csv",
        ]
        for seconds in (0.02, 0.1, 0.2, 0.3, 0.45, 0.6):
            with subprocess.Popen(
                [*map(str, (PROGRAM, *words))],
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                env=ENVIRONMENT,
                text=True,
                # As from a terminal, which does not ignore Ctrl-C.
                preexec_fn=lambda: signals.signal(signals.SIGINT, signals.SIG_DFL),
            ) as process:
                time.sleep(seconds)
                is_over = process.poll() is not None
                process.send_signal(signals.SIGINT)
                said = process.communicate()[1]
                # A shell reports both as 130; at first, nothing has a handler.
                self.assertIn(process.returncode, (130, -signals.SIGINT), said)
                self.assertNotIn("Traceback", said)
                self.assertLessEqual(said.count("\n"), 1, said)
                self.assertFalse(is_over, "a longer recording is needed")
        self.assertEqual([name for name in os.listdir(self.root) if name.endswith(".tmp")], [])

    def test_any_other_failure_is_one_line(self):
        program = "from hapbench_command import stop_on_ctrl_c\nstop_on_ctrl_c('import stroke')\n"
        for failure, said in (
            ("1 / 0", "internal error: ZeroDivisionError: division by zero (<string>, line 3)"),
            ("raise MemoryError", "not enough memory (<string>, line 3)"),
            (
                "import no_such_module",
                "internal error: ModuleNotFoundError: No module named 'no_such_module'",
            ),
        ):
            done = ran(
                sys.executable,
                "-c",
                program + failure,
                env={"PYTHONPATH": str(SOURCE / "scripts" / "python")},
            )
            self.assertEqual(done.returncode, 1)
            self.assertIn(f"hapbench: error: import stroke: {said}", done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1)
        full = run("import", "stroke", LOG, "--preset", "hapi", "--out", self.root / "s.csv")
        self.assertEqual(full.returncode, 0)
        with open("/dev/full", "w", encoding="utf-8") as no_room:
            done = subprocess.run(
                [*map(str, (PROGRAM, "import", "stroke"))],
                stdout=no_room,
                stderr=subprocess.PIPE,
                text=True,
                env=ENVIRONMENT,
            )
        self.assertEqual(
            (done.returncode, done.stderr),
            (1, "hapbench: error: cannot write to standard output: No space left on device\n"),
        )

    def test_the_next_command_can_be_pasted(self):
        file = self.write(STRAIGHT, "my 'log'.csv")
        said = ran(
            PROGRAM,
            "import",
            "stroke",
            file,
            "--columns",
            "time=1,position=2",
            "--json",
            cwd=self.root,
        )
        line = (
            json.loads(said.stdout)["next"].replace("hapbench", str(PROGRAM)).partition(" && ")[0]
        )
        self.assertEqual(ran("sh", "-c", line, cwd=self.root).returncode, 0)
        self.assertTrue((self.root / "my 'log'_stroke.json").exists())

    def test_names_the_packages_that_are_missing(self):
        bare = self.root / "python"
        bare.write_text(f'#!/bin/sh\nexec {sys.executable} -S -I "$@"\n')
        bare.chmod(0o755)
        launch = (
            (SOURCE / "scripts" / "python" / "launch")
            .read_text()
            .replace("/usr/bin/python3 python3;", f"{bare};")
        )
        done = ran(
            "bash",
            self.write(launch, "launch"),
            "hapbench_import",
            env={"PATH": os.environ["PATH"]},
        )
        self.assertEqual(done.returncode, 1)
        self.assertRegex(
            done.stderr, "^hapbench: error: import needs a python3 with numpy, scipy, .*\n$"
        )

    def test_lists_presets_that_can_be_copied(self):
        presets = json.loads(hapbench("import", "stroke", "--json"))
        refusal_of = partial(
            hapbench, "import", "stroke", "--out", self.root / "out.csv", expected=2
        )
        self.assertEqual(
            [preset["preset"] for preset in presets],
            sorted(file.stem for file in PRESETS.iterdir()),
        )
        for preset in presets:
            copy = self.write(Path(preset["file"]).read_bytes(), "copy.json")
            self.assertIn(
                "missing: cannot be read",
                refusal_of(self.root / "missing", "--preset", copy),
                "the preset is right",
            )
        for text, problem in (
            ("{,}", "is not JSON: syntax error at line 1, column 2"),
            ("[1]", "got [1]; allowed: an object"),
            ('{"colums": {}}', 'nearest valid name: "columns"'),
            ('{"floats": 1}', "floats: got 1; allowed: true, false"),
        ):
            self.assertIn(
                "bad.json: ", found := refusal_of(LOG, "--preset", self.write(text, "bad.json"))
            )
            self.assertIn(problem, found)
