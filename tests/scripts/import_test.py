"""Tests `hapbench import stroke` against numpy and scipy."""
import json
import math
import random
import struct

import numpy as np
from fixture import hapbench
from scipy import signal
from scipy.spatial.transform import Rotation, Slerp

from hapbench_command import Faults
from hapbench_import.stroke import resolution_of, stroke_text

from recordings import LOG, STRAIGHT, Y_UP, Given, binary_log, run


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
            position = np.column_stack(
                [np.interp(grid, time, part) for part in (log[:, 1:4] @ Y_UP.T).T]
            )
            force = np.column_stack(
                [np.interp(grid, time, part) for part in (log[:, 8:11] @ Y_UP.T).T]
            )
            smooth = signal.savgol_filter(position, window, order, axis=0, mode="interp")
            np.testing.assert_allclose(stroke[:, 1:4], smooth, atol=1e-13)
            np.testing.assert_allclose(stroke[:, 8:], force, atol=1e-12)
            moved = np.linalg.norm(smooth - position, axis=1)
            self.assertAlmostEqual(
                report["smoothing"]["position_largest_m"], moved.max(), delta=1e-13
            )
            self.assertAlmostEqual(
                report["smoothing"]["position_rms_m"], np.sqrt(np.mean(moved**2)), delta=1e-13
            )
            # The expected rotations: quaternions with consistent signs, whose components are smoothed and then
            # normalised.
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
        for data, columns, position in (
            (rows, "time=2,position=3", [1.5, 2, 3]),
            (named, "time=t,position=x", [1.5, 2, 3]),
            (named.replace(",", ";"), "time=t,px=z,py=x,pz=4", [3, 1.5, 2]),
        ):
            self.assertEqual(self.stroke(data, columns, **fast).position[1].tolist(), position)
        header = "t,tip_x,tip_yy,tip_z\n0,0,0,0\n1,0,0,0\n"
        self.assertRegex(
            self.refusal(header, "time=t,position=tap_x"),
            'rec.csv: columns: position: got "tap_x"; nearest valid name: '
            '"tip_x"; the file has 1 t, 2 tip_x, 3 tip_yy, 4 tip_z$',
        )
        self.assertEqual(
            self.refusal(STRAIGHT, "time=1,position=3"),
            "rec.csv: columns: position: takes columns 3 ... 5 for x, y and z: a stroke has three components. "
            "Add columns of zeros to a recording of one axis (hapbench audit reads it as it is); the file has 1, 2, "
            "3, 4",
        )

    def test_clocks_of_other_units_are_refused(self):
        even = "".join(f"{1999 * i},{1e-5 * i},0,0\n" for i in range(5))  # [us]
        self.assertEqual(
            self.refusal(even),
            "rec.csv: got a median interval of 1999 s; allowed: 0.5 s (--set max_gap=...); are times "
            "in other units? (--scale time=1e-06)",
        )
        self.assertEqual(self.refusal(even, scale="time=1e-6"), "")
        # The last interval is four times the median interval. This alone would not make it a gap, but it also exceeds
        # max_gap.
        slow = "0,0,0,0\n0.2,0.001,0,0\n0.4,0.002,0,0\n1.2,0.003,0,0\n"
        self.assertEqual(
            self.refusal(slow),
            "rec.csv, line 3: a gap of 0.8 s follows; allowed: 0.5 s (--set max_gap=...)",
        )
        self.assertEqual(self.report(slow, max_gap=0.8)[1]["gaps"], 0)

    def test_the_mean_direction_of_the_tip_shows_a_wrong_order(self):
        # Two orientations: rotations about x by 0.1 and 0.3 rad, with w first.
        rows = "".join(
            f"{0.01 * i},0,0,0,{math.cos(a / 2)!s},{math.sin(a / 2)!s},0,0\n"
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

    def test_every_notation_of_an_orientation_is_the_same_turn(self):
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
        fix = "; --skip-bad-rows skips bad rows"
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
            ("axis_angle", "0,0,0,1", "got a rotation axis of norm 0"),
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

    def test_bad_rows_are_left_out_on_request(self):
        stroke, found = self.report(
            "0,0,0,0\n0.01,x,0,0\n0.02,0.002,0,0\n0.015,0,0,0\n0.03,9,0,0\n0.04,0.004,0,0\n",
            skip_bad_rows=True,
        )
        self.assertEqual(stroke.position[:, 0].tolist(), [0, 0.002, 0.004])
        self.assertEqual(
            [warning.split(": ")[0].rpartition(" ")[2] for warning in found["warnings"][1:4]],
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
            + "".join(" ".join(map(str, sample)) + " \r\n" for sample in samples)
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
            sum(
                "with the names of the preset: the stroke has no" in warning
                for warning in found["warnings"]
            ),
            2,
            "neither orientation nor force",
        )
        cut, found = self.report(
            binary_log(["TIME", "POSITION"], [[0, 0, 0, 0], [0.1, 0, 0, 0], [0.2, 0, 0, 0]])[:-3],
            "",
            preset="hapi_binary",
        )
        self.assertEqual(len(cut.time), 2)
        self.assertIn("after sample 2 follow 29 bytes", found["warnings"][2])

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
