"""Tests `hapbench import device` on logs of an independent simulator."""
import json
import os
import threading
import unittest
from functools import partial

import numpy as np
from fixture import PROGRAM, hapbench, ran, scratch_folder
from identify_logs import judged

from hapbench_identify.__main__ import value_text
from hapbench_identify.model import KINDS, design, positions

run = partial(ran, PROGRAM)
TRUE = {
    "handle_mass_kg": 0.12,
    "viscous_N_s_per_m": 0.8,
    "coulomb_N": 0.15,
    "delay_samples": 1.35,
    "encoder_step_m": 1e-5,
}
M, B, C, _, Q = TRUE.values()
DELAY_S = 1e-3 * TRUE["delay_samples"]  # [s]
HANDLE = (M, B, C, DELAY_S, 0.0, 0.0)


def played(time, force, finer, spring=0.0, stribeck=(0.0, 1.0)):
    """Returns positions at `time`, integrated in small steps with the mean speed of each step. Dry friction can stop
    the handle within a small step. `finer`: number of small steps per sample. `stribeck`: (relative increase of dry
    friction at rest, Stribeck speed [m/s]). Above the Stribeck speed, the increase vanishes."""
    x = v = 0.0
    trajectory = [x]
    arrivals = time + DELAY_S
    for start, end in zip(time, time[1:]):
        h = (end - start) / finer
        which = np.searchsorted(arrivals, start + h * (np.arange(finer) + 0.5), side="right") - 1
        for k in which.tolist():
            push = (force[k] if k >= 0 else 0.0) - B * v - spring * x
            free = v + h * push / M
            grip = h * C / M * (1.0 + stribeck[0] * np.exp(-((v / stribeck[1]) ** 2)))
            before, v = v, 0.0 if abs(free) <= grip else free - np.copysign(grip, free)
            x += 0.5 * h * (before + v)
        trajectory.append(x)
    return np.array(trajectory)


class Logs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.root = scratch_folder(cls)
        cls.time, cls.force = design("chirp", 1.5, 0.08, 1000.0, 2.0, 0.1)
        cls.trajectory = positions(cls.time, cls.force, HANDLE)

    def log(self, trajectory, time=None, force=None):
        file = self.root / "log.csv"
        time, force = (self.time if time is None else time), (
            self.force if force is None else force
        )
        np.savetxt(
            file,
            np.column_stack([time, force, trajectory]),
            "%.17g",
            ",",
            header="time_s,force_N,position_m",
            comments="",
        )
        return file

    def identify(self, file, *words):
        done = run("import", "device", file, "--json", "--out", self.root / "device.json", *words)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout), done.stderr

    def refused(self, file, *words):
        error = hapbench(
            "import", "device", file, "--out", self.root / "none.json", *words, expected=2
        )
        self.assertFalse((self.root / "none.json").exists())
        return error

    def assert_holds(self, result):
        # The clock has jitter, so its mean interval differs from 1 ms. The true delay is therefore divided by the mean
        # interval that the program found.
        for name, true in {**TRUE, "delay_samples": DELAY_S / result["step_s"]}.items():
            low, high = result[name]["interval"]
            self.assertTrue(low <= true <= high, f"{name}: {true} in {low} ... {high}")


class Identify(Logs):
    def test_the_model_is_what_small_steps_tend_to(self):
        errors = [
            np.abs(played(self.time[:500], self.force[:500], n) - self.trajectory[:500]).max()
            for n in (20, 100, 400)
        ]
        self.assertLess(errors[2], 1e-6)
        self.assertLess(errors[2], 0.4 * errors[0])

    def test_a_log_in_steps_of_the_encoder_identifies_the_device(self):
        result, warned = self.identify(self.log(np.round(self.trajectory / Q) * Q))
        self.assertEqual(warned, "")
        self.assert_holds(result)
        for name, share in (
            ("handle_mass_kg", 0.01),
            ("viscous_N_s_per_m", 0.05),
            ("coulomb_N", 0.05),
            ("delay_samples", 0.05),
        ):
            self.assertAlmostEqual(result[name]["value"] / TRUE[name], 1.0, delta=share)
        self.assertAlmostEqual(result["residual_m"] / (Q / np.sqrt(12.0)), 1.0, delta=0.15)
        self.assertAlmostEqual(result["step_s"], 1e-3)
        device = json.loads((self.root / "device.json").read_text())
        self.assertAlmostEqual(
            device["handle_mass_kg"], result["handle_mass_kg"]["value"], delta=1e-6
        )
        self.assertTrue((self.root / "device.svg").read_text().startswith("<?xml"))
        self.assertEqual(run("validate", self.root / "device.json").returncode, 0)
        # The delay of the device is in seconds, so that a scene with another step can convert it to its own samples.
        self.assertAlmostEqual(
            device["delay_s"], 1e-3 * result["delay_samples"]["value"], delta=1e-8
        )
        self.assertNotIn("delay_samples", device)
        run(
            "run",
            "tap_wall",
            "--set",
            f"device={json.dumps(device)}",
            "--set",
            "time.steps=2",
            "--out",
            self.root / "run",
        )
        effective = json.loads((self.root / "run" / "scenario.effective.json").read_text())
        self.assertAlmostEqual(
            effective["device"]["delay_samples"],
            device["delay_s"] / effective["time"]["step_s"],
            delta=1e-9,
        )

    def test_noise_missing_samples_jitter_and_units(self):
        random = np.random.default_rng(3)
        time = self.time + np.concatenate(
            [[0.0], 2e-4 * random.uniform(-1.0, 1.0, len(self.time) - 1)]
        )
        trajectory = positions(time, self.force, HANDLE)
        measured = np.round((trajectory + 2e-5 * random.standard_normal(len(trajectory))) / Q) * Q
        kept = random.random(len(time)) > 0.03
        kept[0] = True
        file = self.log(1e3 * measured[kept], 1e6 * time[kept], self.force[kept])
        result, warned = self.identify(file, "--scale", "time=1e-6,position=1e-3")
        self.assert_holds(result)
        self.assertAlmostEqual(result["position_noise_m"]["value"], 2e-5, delta=1e-6)
        self.assertIn(f"{np.count_nonzero(~kept)} samples are missing", warned)
        self.assertRegex(warned, r"the first after 0\.00\d+ s: their forces were interpolated")
        self.assertIn("the sampling is not uniform", warned)

    def test_a_gap_is_no_wrong_sign(self):
        """Checks a log that consists of two recordings with a gap of 6 s, after which the handle is elsewhere, and a
        log of which half a second is missing. The longest part without a gap identifies the device.
        """
        measured = np.round(self.trajectory / Q) * Q
        two = self.log(
            np.concatenate([measured[:900], measured + 0.02]),
            np.concatenate([self.time[:900], self.time + 7.0]),
            np.concatenate([self.force[:900], self.force]),
        )
        result, warned = self.identify(two)
        self.assert_holds(result)
        self.assertEqual(result["samples"], len(measured))
        self.assertIn("a gap of 6.101 s after 0.899 s", warned)
        kept = (self.time < 0.3) | (self.time >= 0.8)
        result, warned = self.identify(self.log(measured[kept], self.time[kept], self.force[kept]))
        self.assert_holds(result)
        self.assertIn("a gap of 0.501 s after 0.299 s", warned)

    def test_missing_rows_are_a_cause_of_the_residual(self):
        """Checks that the unknown forces of missing rows, which change abruptly, are named as a cause of the residual,
        and do not count as noise of the position."""
        force = np.where(np.sin(40.0 * self.time) > 0.0, 1.0, -1.0)
        measured = np.round(positions(self.time, force, HANDLE) / Q) * Q
        kept = np.random.default_rng(1).random(len(measured)) > 0.02
        kept[:2] = True
        result, warned = self.identify(self.log(measured[kept], self.time[kept], force[kept]))
        self.assertIn("the unknown forces of the missing samples", warned)
        self.assertIsNone(result["position_noise_m"]["value"])
        self.assertEqual(result["position_noise_m"]["interval"][0], 0.0)

    def test_wrong_positions_are_reported(self):
        measured = np.round(self.trajectory / Q) * Q
        measured[[300, 900]] += 0.01
        _, warned = self.identify(self.log(measured))
        self.assertRegex(warned, r"2 positions are far .* by up to 0\.0\d+ m, the first at 0\.3 s")

    def test_the_encoder_step_of_a_log_that_rounds_positions(self):
        """Checks encoder steps that are not multiples of the last digit of the log. If the step has only a few last
        digits, it is not determined, but its interval contains it."""
        for step, digit in ((2.34e-5, 1e-6), (2.34371e-5, 1e-7), (5.5e-6, 1e-6)):
            with self.subTest(step=step, digit=digit):
                counts = np.round(self.trajectory / step)
                file = self.log(np.round(np.round(counts * step / digit)) * digit)
                text = file.read_text()
                rows = [line.split(",") for line in text.splitlines()]
                digits = round(-np.log10(digit))
                rows[1:] = [[a, b, f"{float(c):.{digits}f}"] for a, b, c in rows[1:]]
                file.write_text("\n".join(map(",".join, rows)) + "\n")
                result, _ = self.identify(file)
                low, high = result["encoder_step_m"]["interval"]
                self.assertTrue(low <= step <= high, (low, high))
                if result["encoder_step_m"]["value"] is not None:
                    self.assertAlmostEqual(
                        result["encoder_step_m"]["value"], step, delta=1e-3 * step
                    )
                    self.assertLess(high - low, 0.01 * step)

    def test_a_handful_of_the_study_ends_in_the_global_minimum(self):
        ones = [judged(seed) for seed in (0, 10, 11, 16, 25, 43)]
        for one in ones:
            self.assertLessEqual(one["over"], 1.002, one)
            self.assertFalse(one["untold"], one)
        held = [holds for one in ones for holds in one["holds"].values()]
        self.assertGreaterEqual(
            sum(held), 27
        )  # of 30 intervals at 95 %; the probability of fewer than 27 is 1/16, but the seeds are fixed

    def test_what_the_log_does_not_determine_has_no_value(self):
        time = np.arange(2000) * 1e-3
        force = np.where(
            time % 0.5 < 0.1,
            1.0,
            0.0
            # The force pushes in one direction only, so that friction cannot be distinguished from a constant force.
        )
        result, warned = self.identify(
            self.log(
                np.round(positions(time, force, (M, B, 0.0, 0.0, 0.0, 0.3)) / Q) * Q, time, force
            )
        )
        self.assertIsNone(result["coulomb_N"]["value"])
        self.assertRegex(
            warned,
            r"coulomb_N cannot be identified from this log: the handle moved in one direction only "
            r"\(at rest for \d+ % of the log, 1 strokes in one direction and 0",
        )
        self.assertNotIn("coulomb_N", json.loads((self.root / "device.json").read_text()))
        self.assertAlmostEqual(result["handle_mass_kg"]["value"] / M, 1.0, delta=0.02)
        # Even if the handle rests for most of the time, its motion determines the parameters.
        rest = np.concatenate([self.force, np.zeros(4 * len(self.force))])
        time = np.arange(len(rest)) * 1e-3
        result, _ = self.identify(
            self.log(np.round(positions(time, rest, HANDLE) / Q) * Q, time, rest)
        )
        self.assert_holds(result)
        self.assertIn(
            "the handle hardly moves",
            self.refused(
                self.log(1e-5 * np.round(5.0 * self.trajectory / np.ptp(self.trajectory)))
            ),
        )

    def test_exchanged_columns_are_named(self):
        for kind in ("chirp", "steps"):
            time, force = design(kind, 2.0, 0.08, 1000.0, 2.0, 0.1)
            position = np.round(positions(time, force, HANDLE) / Q) * Q
            error = self.refused(
                self.log(position, time, force), "--columns", "force=position_m,position=force_N"
            )
            self.assertIn("Are the columns of force and position exchanged", error)
            self.assertNotIn("hardly moves", error)

    def test_a_device_that_is_written_into_a_pipe_has_no_picture(self):
        pipe = self.root / "pipe"
        os.mkfifo(pipe)
        file, read = self.log(np.round(self.trajectory / Q) * Q), []
        reader = threading.Thread(target=lambda: read.append(json.loads(pipe.read_text())))
        reader.start()
        done = run("import", "device", file, "--json", "--out", pipe)
        self.assertEqual(done.returncode, 0, done.stderr)
        reader.join(timeout=10)
        self.assertEqual(read[0]["type"], "impedance")
        self.assertTrue(pipe.is_fifo())
        self.assertIsNone(json.loads(done.stdout)["picture"])
        self.assertFalse(pipe.with_suffix(".svg").exists())

    def test_it_names_what_a_log_does_not_show(self):
        file = self.log(np.round(self.trajectory / Q) * Q)
        words = ("import", "device", file, "--out", self.root / "said.json")
        output = run(*words).stdout
        missing = "velocity_filter, force_max_N, force_step_N, force_slew_N_per_s, position_filter, transmission"
        self.assertIn(f"not in the log: {missing}; add them to ", output)
        self.assertEqual(
            json.loads(run(*words, "--json").stdout)["not_in_log"], missing.split(", ")
        )
        for ends, force, shown in (
            ([-3e-7, -9e-9], 2.0, "zero within 3e-07"),
            ([-0.1, 0.3], 2.0, "not identifiable"),
            ([0.1, 0.3], 2.0, "not identifiable"),
            ([None, None], 2.0, "not identifiable"),
        ):
            one = {"value": None, "interval": ends}
            self.assertEqual(value_text("offset_N", one, force), shown)
            self.assertEqual(value_text("coulomb_N", one, force), "not identifiable")

    def test_units_that_are_unlikely_are_reported(self):
        file = self.log(1e3 * np.round(self.trajectory / 1e-5) * 1e-5, 1e3 * self.time)
        self.assertIn("are the units s, N and m?", self.refused(file))
        result, _ = self.identify(file, "--scale", "time=1e-3,position=1e-3")
        self.assert_holds(result)
        self.assertGreater(
            self.identify(file, "--scale", "time=1")[0]["handle_mass_kg"]["value"], 100.0
        )

    def test_a_force_of_the_other_sign_is_named_with_the_scale(self):
        trajectory = np.round(self.trajectory / Q) * Q
        for given in (
            self.log(trajectory, force=-self.force),
            self.log(-trajectory),
        ):
            output = self.refused(given)
            self.assertIn("the handle accelerates against the force", output)
            self.assertIn("--scale force=-1", output)
        result, warned = self.identify(given, "--scale", "force=-1")
        self.assert_holds(result)
        self.assertEqual(warned, "")
        both = self.log(1e3 * trajectory, 1e3 * self.time, -self.force)
        self.assertIn("--scale time=0.001,force=-1,position=0.001", self.refused(both))

    def test_units_that_explain_the_log_are_named(self):
        trajectory = np.round(self.trajectory / Q) * Q
        for time, force, position, scale in (
            (1.0, 1.0, 1e3, "position=0.001"),
            (1e3, 1.0, 1.0, "time=0.001"),
            (1e9, 1.0, 1.0, "time=1e-09"),
            (1.0, 1e-3, 1.0, "force=1000"),
            (1.0, 1e3, 1.0, "force=0.001"),
        ):
            output = self.refused(
                self.log(position * trajectory, time * self.time, force * self.force)
            )
            self.assertIn(f"it is a handle of 0.12 kg: --scale {scale}", output)
        # The advice must include the scale that the user has given.
        output = self.refused(
            self.log(1e3 * trajectory, 1e3 * self.time), "--scale", "position=1e-3"
        )
        self.assertIn("--scale position=0.001,time=0.001", output)
        # A handle with a plausible mass is accepted, but with a warning.
        _, warned = self.identify(self.log(trajectory, force=self.force / 9.80665e-3))
        self.assertIn("In s, gf, m it is a handle of 0.12 kg: --scale force=0.00980665", warned)

    def test_units_in_names_and_decimal_commas_are_read(self):
        file = self.log(1e3 * np.round(self.trajectory / Q) * Q, 1e3 * self.time)
        numbers = file.read_text().partition("\n")[2].replace(",", ";").replace(".", ",")
        file.write_text("Time [ms];force [N];position [mm]\n" + numbers)
        result, warned = self.identify(file)
        self.assert_holds(result)
        self.assertIn("numbers have a decimal comma", warned)
        self.assertEqual(result["scales"], {"time": 1e-3, "force": 1.0, "position": 1e-3})
        self.assertEqual(
            [result["columns"][name][0]["name"] for name in ("time", "force", "position")],
            ["Time [ms]", "force [N]", "position [mm]"],
        )

    def test_positions_held_for_several_rows_do_not_bias_the_delay(self):
        for rows in (2, 5):
            held = np.arange(len(self.time)) // rows * rows
            for force in (self.force, self.force[held]):
                trajectory = positions(self.time, force, HANDLE)
                result, warned = self.identify(
                    self.log((np.round(trajectory / Q) * Q)[held], force=force)
                )
                self.assertIn(f"each position is repeated in {rows} rows", warned)
                delay = result["delay_s"]
                self.assertAlmostEqual(delay["value"], DELAY_S, delta=3e-5)
                self.assertLess(np.ptp(delay["interval"]), 1e-4)
                self.assertAlmostEqual(result["handle_mass_kg"]["value"] / M, 1.0, delta=0.01)

    def test_it_reports_when_something_else_is_on_the_handle(self):
        for spring, why in (
            (2.0, "a property of the device that the model lacks"),
            (200.0, "a property of the device that the model lacks|Is a hand or a spring"),
        ):
            trajectory = played(self.time, self.force, 50, spring)
            done = run(
                "import",
                "device",
                self.log(np.round(trajectory / Q) * Q),
                "--out",
                self.root / "device.json",
            )
            self.assertRegex(done.stderr, why)

    def test_refuses_what_is_no_log(self):
        for text, why in (
            ("time_s,force_N\n" + "0,1\n" * 60, "columns: position: no"),
            ("time_s,force_N,position_m\n0,1,2\n", "at least 50"),
            (
                "time_s,force_N,position_m\n" + "".join(f"{i},1,{i}\n" for i in range(60)),
                "every force is 1",
            ),
            (
                "time_s,force_N,position_m\n" + "".join(f"0,{i},{i}\n" for i in range(60)),
                "column 1 time_s: 59 of 60 rows repeat the time of the row before; allowed: increasing times; is the "
                "column with the fractions of a second missing?",
            ),
            (
                "time_s,force_N,position_m\n" + "".join(f"{i // 30},{i},{i}\n" for i in range(60)),
                "58 of 60 rows repeat the time",
            ),
            (
                "time_s,force_N,position_m\n" + "".join(f"{i % 40},{i},{i}\n" for i in range(60)),
                "line 42: got time 0 s after 39 s; allowed: increasing times (20 rows, the last: line 61)",
            ),
            (
                "time_s,force_N,position_m,force_N\n" + "0,1,2,3\n" * 60,
                'two columns are named "force_N"',
            ),
            (
                "time_s,force_N,position_m\n" + "".join(f"{i},1,x\n" for i in range(60)),
                'line 2: column 3 position_m: got "x"; allowed: a finite number (60 rows, the last: line 61)',
            ),
            (
                "time_s;force [mN];position_m\n" + "".join(f"{i},001;1.200;2\n" for i in range(60)),
                'column 2 force [mN]: got "1.200"; allowed: a finite number; the point may separate thousands, because '
                'line 2 has the decimal comma "0,001": write "1200" or "1,200"',
            ),
        ):
            (self.root / "bad.csv").write_text(text)
            self.assertIn(why, self.refused(self.root / "bad.csv"))


class Doubt(Logs):
    """Tests logs that follow the model only approximately or not at all."""

    def setUp(self):
        self.random = np.random.default_rng(5)

    def test_a_clock_that_varies_misses_no_samples(self):
        rows = len(self.time)
        clocks = {
            "loops of varying length": np.cumsum(
                1e-3 * np.maximum(0.1, 1.0 + 0.4 * self.random.standard_normal(rows))
            ),
            "times around a raster": np.sort(
                self.time + 4e-4 * self.random.uniform(-1.0, 1.0, rows)
            ),
            "stalls": np.cumsum(
                1e-3
                * np.where(
                    self.random.random(rows) < 0.01, self.random.uniform(1.5, 6.0, rows), 1.0
                )
            ),
        }
        for name, time in clocks.items():
            with self.subTest(clock=name):
                trajectory = positions(time - time[0], self.force, HANDLE)
                result, warned = self.identify(
                    self.log(np.round(trajectory / Q) * Q, time - time[0])
                )
                self.assertNotIn("missing", warned)
                self.assertIn("the sampling is not uniform", warned)
                self.assertEqual(result["confidence"], 0.95)
                self.assert_holds(result)

    def test_times_that_are_not_those_of_the_samples_are_not_trusted(self):
        sampled = np.sort(self.time + 4e-4 * self.random.uniform(-1.0, 1.0, len(self.time)))
        trajectory = positions(sampled, self.force, HANDLE)
        for stamps in (self.time, self.time + self.random.uniform(0.0, 6e-4, len(self.time))):
            result, warned = self.identify(self.log(np.round(trajectory / Q) * Q, stamps))
            self.assert_distrusted(result, warned)

    def test_friction_that_depends_on_the_speed_is_not_trusted(self):
        for more, speed in ((0.2, 0.05), (0.3, 0.02), (0.5, 0.01)):
            with self.subTest(more=more, speed=speed):
                trajectory = played(self.time, self.force, 40, stribeck=(more, speed))
                result, warned = self.identify(self.log(np.round(trajectory / Q) * Q))
                self.assert_distrusted(result, warned)

    def test_logs_that_begin_in_motion(self):
        for first in (150, 400, 700):
            with self.subTest(first=first):
                result, warned = self.identify(
                    self.log(
                        np.round(self.trajectory[first:] / Q) * Q,
                        self.time[first:],
                        self.force[first:],
                    )
                )
                self.assertEqual(warned, "")
                self.assert_holds(result)

    def assert_distrusted(self, result, warned):
        self.assertIsNone(result["confidence"])
        self.assertIn("do not read them as 95 % intervals", warned)
        printed = run("import", "device", self.root / "log.csv", "--out", self.root / "d.json")
        self.assertNotIn("95 %", printed.stdout)
        self.assertIn("interval from", printed.stdout)


class Design(unittest.TestCase):
    def test_signals_keep_their_limits(self):
        for kind in KINDS:
            for mass, force, travel in ((0.05, 1.0, 0.02), (0.3, 5.0, 0.1)):
                time, values = design(kind, force, travel, 1000.0, 3.0, mass)
                self.assertLessEqual(np.abs(values).max(), force * (1 + 1e-12), kind)
                self.assertGreater(np.abs(values).max(), 0.1 * force, kind)
                # Integrates the motion of a free mass by the trapezoidal rule, which is exact for held forces.
                speed = np.concatenate([[0.0], np.cumsum(values[:-1])]) * 1e-3 / mass
                position = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))]) * 1e-3
                self.assertLessEqual(np.ptp(position), travel * (1 + 1e-9), kind)

    def test_signals_keep_their_travel_with_friction(self):
        dry, viscous = (
            part.ravel() for part in np.meshgrid(np.linspace(0.0, 0.6, 41), (0.0, 0.3, 3.0))
        )
        for kind in KINDS:
            for mass, force, travel in ((0.06, 3.0, 0.03), (0.1, 2.0, 0.08), (0.2, 1.0, 0.1)):
                with self.subTest(kind=kind, mass=mass):
                    time, values = design(kind, force, travel, 1000.0, 4.0, mass)
                    # Integrates semi-implicit steps of 0.1 ms for all frictions at once, with a delay of two samples.
                    x, v, low, high = np.zeros((4, len(dry)))
                    grip = 1e-4 * dry * np.abs(values).max() / mass
                    for push in np.repeat(np.concatenate([[0.0, 0.0], values[:-2]]), 10).tolist():
                        free = v + 1e-4 * (push - viscous * v) / mass
                        v = np.sign(free) * np.maximum(np.abs(free) - grip, 0.0)
                        x = x + 1e-4 * v
                        low, high = np.minimum(low, x), np.maximum(high, x)
                    # Steps of 0.1 ms overestimate the travel by up to 0.5 % of the travel.
                    self.assertLessEqual(high.max() - low.min(), 1.005 * travel)

    def test_travel_that_limits_the_force_is_reported(self):
        designed = partial(
            run, "import", "device", "--out", scratch_folder(self) / "signal.csv", "--design"
        )
        warned = designed("chirp,travel=0.08,mass=0.1,force=2").stderr
        self.assertIn(
            "the signal has at most 0.544 N, not 2 N: it begins at a low frequency, where a larger force moves the "
            "handle further than the travel of 0.08 m. That is enough for dry friction of up to 0.327 N",
            warned,
        )
        requested = warned.split("force=")[1].split()[0]
        self.assertGreaterEqual(
            json.loads(designed(f"chirp,travel=0.08,mass=0.1,force={requested}", "--json").stdout)[
                "force_max_N"
            ],
            0.99 * 2.0,
        )
        self.assertNotIn("not 2 N", designed("multisine,travel=0.08,force=2").stderr)
