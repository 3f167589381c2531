"""Tests that hapbench.audit() reports nothing false. The logs have jitter, missing rows, faults of the tracking, noise,
short slides, rests, rigid contacts, curved surfaces, and forces that are means over the points in contact."""
import os
import re
import unittest
from unittest import mock

import numpy as np
from fixture import PROGRAM

os.environ.setdefault("HAPBENCH_PROGRAM", str(PROGRAM))

from hapbench import InputError, audit  # noqa: E402  (finds the program in the environment)
from hapbench_audit import text  # noqa: E402

T = 1e-3  # interval of the rows [s]


def smooth(share):
    """Returns a transition from 0 to 1 without a jump of the acceleration. `share`: time since the start of the
    transition, divided by its duration."""
    share = np.clip(share, 0.0, 1.0)
    return 10 * share**3 - 15 * share**4 + 6 * share**5


def presses(t, count, seconds, depth=3e-3, rise=0.05, every=None):
    """Returns positions [m] of `count` presses into the surface z < 0, to different depths. `seconds`: duration of a
    press [s]. `rise`: duration of its descent and of its ascent [s]. `every`: time between the starts of two presses
    [s]."""
    z = np.full(len(t), 1e-3)
    for i in range(count):
        start = 0.2 + i * (every or seconds + 0.2)
        deep = depth * (1.0 + 0.3 * np.sin(2.0 * i + 1.0))
        up = smooth((t - start - seconds + rise) / rise)
        z -= (1e-3 + deep) * (smooth((t - start) / rise) - up)
    return z


def tremor(t, amplitude=1e-4):
    return amplitude * sum(np.sin(2.0 * np.pi * f * t + f) for f in (3.1, 7.3, 11.9)) / 3.0


def spring(z, stiffness, damping=0.0, delay=0, interval=T):
    speed = np.diff(z, prepend=z[0]) / interval
    force = np.where(z < 0.0, np.maximum(-stiffness * z - damping * speed, 0.0), 0.0)
    return np.concatenate([np.zeros(delay), force[: len(z) - delay]])


def log_of(t, z, force, **more):
    return {"t": t, "position": z, "force": force} | more


def without(log, lost, seed=3):
    """Returns the log without a random fraction `lost` of its rows. The first and the last row are kept."""
    keep = np.random.default_rng(seed).random(len(log["t"])) >= lost
    keep[[0, -1]] = True
    return {name: values[keep] for name, values in log.items()}


def taps(t):
    """Returns positions [m] of a tool that taps the surface z < 0 at 6.5 Hz."""
    return -3.5e-4 + 1.2e-3 * np.sin(13.0 * np.pi * t + 0.3 * np.sin(1.8 * np.pi * t))


def warned(found):
    return " ".join(found["warnings"])


def rules_of(found):
    return {one["rule"]: one for one in found["diagnosis"]}


class Clocks(unittest.TestCase):
    def test_jitter_is_no_missing_row(self):
        """Checks that jitter is not counted as missing rows. In one log, each time stamp has an error of up to 0.3
        intervals, so that the differences of time stamps are between 0.4 and 1.6 intervals. In the other log, each
        interval has an error of up to 0.3 intervals."""
        rng, rows = np.random.default_rng(1), 4000
        kept = np.ones(rows, bool)
        kept[[700, 1500, 1501, 2900]] = False
        clocks = {
            "stamps": np.arange(rows) + 0.3 * rng.uniform(-1.0, 1.0, rows),
            "intervals": np.cumsum(1.0 + 0.3 * rng.uniform(-1.0, 1.0, rows)),
        }
        for name, clock in clocks.items():
            t = T * (clock - clock[0])
            z = presses(t, 3, 0.8)
            for keep, missing in ((np.ones(rows, bool), 0), (kept, 4)):
                found = audit(log_of(t[keep], z[keep], spring(z, 800.0)[keep]))["clock"]
                self.assertEqual(found["rows_missing"], missing, name)
                rate = (rows - 1) / t[-1]
                self.assertAlmostEqual(found["rate_Hz"] / rate, 1.0, delta=2e-3, msg=name)

    def test_held_values_of_a_log_that_lost_rows(self):
        """Checks a log in which each value is repeated in five rows. Then 1 % of the rows are removed."""
        rng, rows = np.random.default_rng(7), 3000
        t = T * np.arange(rows)
        z = np.repeat(presses(t, 2, 1.0)[::5] + tremor(t)[::5], 5)
        force = spring(z[::5], 900.0).repeat(5)
        keep = rng.random(rows) >= 0.01
        keep[[0, -1]] = True
        clock = audit(log_of(t[keep], z[keep], force[keep]))["clock"]
        self.assertAlmostEqual(clock["rows_per_position"], 5.0, delta=0.05)
        self.assertAlmostEqual(clock["rows_per_force"], 5.0, delta=0.05)

    def test_rounded_times_of_an_even_clock_have_no_missing_rows(self):
        """Checks clocks of 667 to 900 Hz whose times are rounded to 1 ms, so that each step is 1 or 2 ms. The loop uses
        its true interval."""
        for rate, delay in ((667, 0), (800, 3), (900, 2)):
            t = np.arange(6 * rate) / rate
            z = presses(t, 4, 0.9) + tremor(t)
            force = spring(z, 1000.0, 2.0, delay, 1.0 / rate)
            found = audit(log_of(np.round(t, 3), z, force))
            self.assertEqual(found["clock"]["rows_missing"], 0)
            self.assertAlmostEqual(found["clock"]["rate_Hz"] / rate, 1.0, delta=1e-3)
            low, high = found["stiffness"]["damping_interval"]
            self.assertTrue(low <= 2.0 <= high, (rate, low, high))
            self.assertIn("times are rounded: no row counts as missing", warned(found))
            self.assertEqual(found["metrics"]["contacts_lost_per_s"], 0.0)
        t = T * np.arange(4000)
        z = presses(t, 3, 0.9)
        self.assertGreater(
            audit(without(log_of(t, z, spring(z, 900.0)), 0.1))["clock"]["rows_missing"], 300
        )

    def test_rows_in_packets_are_refused(self):
        """Checks times of arrival of packets of 2 and of 8 rows. The message names the mean rate. A log that pauses
        after every 40 rows has no packets, because its tool moves during a pause."""
        t = T * np.arange(4000)
        z = presses(t, 3, 0.9) + tremor(t)
        log = log_of(t, z, spring(z, 900.0, 2.0))
        for size in (2, 8):
            row = np.arange(len(t))
            stamps = T * (row - row % size) + 1e-4 * T * (row % size)
            with self.assertRaisesRegex(InputError, "packets.* k / 1000 of the rows k"):
                audit(log | {"t": stamps})
            found = audit(log | {"t": stamps}, columns={"time": "t"})
            self.assertIn("--set sample_rate_Hz=1000 instead of a column", warned(found))
        paused = {name: values[np.arange(4000) % 100 < 40] for name, values in log.items()}
        self.assertGreater(audit(paused)["clock"]["gaps"], 30)

    def test_times_in_days_are_named(self):
        t = T * np.arange(4000)
        z = presses(t, 3, 0.9)
        for start in (46354.25, 740000.5):
            found = warned(audit(log_of(start + t / 86400.0, z, spring(z, 900.0))))
            self.assertIn("--scale time=86400 the rate is 1000 Hz", found)
            self.assertNotIn("time=0.001", found)
        found = warned(audit(log_of(t, 1e3 * z, spring(z, 900.0))))
        self.assertIn("--scale position=0.001 is for millimetres", found)
        self.assertNotIn("--scale time", found)

    def test_times_without_order_have_no_missing_rows(self):
        """Checks that no row counts as missing if the time stamps have errors of up to almost half an interval. Times
        between two neighbouring rows are then almost arbitrary."""
        rng = np.random.default_rng(2)
        t = np.sort(T * (np.arange(3000) + 0.49 * rng.uniform(-1.0, 1.0, 3000)))
        z = presses(t, 2, 0.8)
        self.assertEqual(audit(log_of(t, z, spring(z, 800.0)))["clock"]["rows_missing"], 0)


class MissingRows(unittest.TestCase):
    def test_the_error_contains_the_work_of_the_missing_rows(self):
        """Checks a passive loop that lost 10 or 30 % of its rows. Holding the force over the missing rows would create
        energy. With a delay of 4 rows, the loop really creates energy."""
        t = T * np.arange(8000)
        z = (1.8e-3 + 1.2e-3 * np.sin(0.8 * np.pi * t)) * np.sin(6.0 * np.pi * t)
        for delay in (0, 4):
            full = log_of(t, z, spring(z, 2000.0, 1.2, delay))
            sums = np.append(0.0, np.cumsum(full["force"][:-1] * np.diff(z)))
            for lost in (0.1, 0.3):
                found = audit(without(full, lost))
                energy = found["energy"]
                for name, truth in (("work", sums[-1]), ("net_created", sums.max())):
                    self.assertLessEqual(
                        abs(energy[f"{name}_J"] - truth), energy[f"{name}_error_J"] + 1e-12
                    )
                # The work across a missing row is interpolated. Without delay, the mean error is 0.
                self.assertAlmostEqual(energy["work_J"], sums[-1], delta=0.1 * abs(sums[-1]))
                self.assertEqual("energy" in rules_of(found), delay > 0, (delay, lost))
                self.assertIn("work across them is interpolated", warned(found))

    def test_landings_and_losses_are_in_seconds(self):
        """Checks taps with times of at least 60 ms without contact. 30 % of the rows are lost."""
        t = T * np.arange(12000)
        z = taps(t)
        full = log_of(t, z, spring(z, 1500.0, 1.5))
        found, truth = audit(without(full, 0.3)), audit(full)
        self.assertGreater(truth["metrics"]["landings"], 70)
        for name in ("contacts", "landings", "contacts_lost_per_s", "contacts_lost_in_spectrum"):
            self.assertEqual(found["metrics"][name], truth["metrics"][name], name)
        for name in ("force_mean_in_contact_N", "settled_s", "contact_share"):
            ratio = found["metrics"][name] / truth["metrics"][name]
            self.assertAlmostEqual(ratio, 1.0, delta=0.05, msg=name)
        self.assertEqual(found["buzz"], [])

    def test_rates_do_not_count_the_time_of_missing_rows(self):
        """Checks force reversals, of which the log shows only those between neighbouring rows."""
        t = T * np.arange(6000)
        z = presses(t, 2, 2.0) + tremor(t)
        force = spring(z, 500.0)
        force[::7] *= -0.8
        full = log_of(t, z, force)
        rates = [
            audit(one)["metrics"]["force_reversals_per_s"] for one in (full, without(full, 0.3))
        ]
        self.assertAlmostEqual(rates[1] / rates[0], 1.0, delta=0.1)

    def test_a_time_of_uncertain_length_is_named(self):
        t = T * np.arange(3000)
        z = np.where((t > 0.5) & ((t < 1.0) | (t >= 1.05)), -1e-3, 1e-3)
        log = log_of(t, z, spring(z, 900.0))
        keep = np.ones(len(t), bool)
        self.assertNotIn("leave open", warned(audit(log)))
        keep[1046:1050] = False
        found = audit({name: values[keep] for name, values in log.items()})
        self.assertIn("leave open whether 1 time without contact", warned(found))


class Tracking(unittest.TestCase):
    def setUp(self):
        t = T * np.arange(8000)
        z = presses(t, 6, 0.9) + tremor(t)
        self.log = log_of(t, z, spring(z, 1000.0, 2.0))
        self.pressed = np.flatnonzero(self.log["force"] > 0.8)[[100, 300, 500, 700]]

    def moved(self, rows, z):
        positions = self.log["position"].copy()
        positions[rows] = z
        return audit(self.log | {"position": positions})

    def test_a_glitch_creates_no_energy(self):
        truth = audit(self.log)["energy"]
        for rows, z in ((self.pressed[:1], 0.25), (self.pressed, 1e-3)):
            found = self.moved(rows, z)
            self.assertNotIn("energy", rules_of(found))
            self.assertAlmostEqual(
                found["energy"]["work_J"],
                truth["work_J"],
                delta=found["energy"]["work_error_J"] + 1e-9,
            )
            self.assertIn(f"the first: row {rows[0] + 1}, by ", warned(found))
            self.assertEqual(found["clock"]["rows_missing"], len(rows))

    def test_a_jump_of_the_position_creates_no_energy(self):
        row = self.pressed[2]
        found = self.moved(slice(row, row + 200), self.log["position"][row : row + 200] + 0.02)
        self.assertNotIn("energy", rules_of(found))
        self.assertIn(
            f"the position jumps 2 times, first by 20 mm in the row at {T * row:g} s", warned(found)
        )

    def test_a_vibration_and_a_coarse_encoder_have_no_glitches(self):
        """Checks an oscillation at half the sampling rate, and a position that moves by one step of its encoder and
        back."""
        log = self.log["position"]
        shaken = log + 5e-4 * (-1.0) ** np.arange(len(log)) * (log < -1e-3)
        coarse = 5e-4 * np.round(log / 5e-4)
        coarse[self.pressed] += 5e-4
        for z in (shaken, coarse):
            self.assertEqual(audit(self.log | {"position": z})["clock"]["rows_missing"], 0)

    def test_a_velocity_that_contradicts_the_positions_is_not_used(self):
        speed = np.gradient(self.log["position"], T)
        plain = audit(self.log)["stiffness"]
        for factor in (-1.0, 1000.0):
            found = audit(self.log | {"velocity": factor * speed})
            (stated,) = re.findall("column 4 velocity is (.*) times the change", warned(found))
            self.assertAlmostEqual(float(stated) / factor, 1.0, delta=0.01)
            self.assertEqual(found["stiffness"], plain)
            self.assertEqual(found["columns_not_read"], ["4 velocity"])
        noise = np.random.default_rng(1).normal(size=len(speed))
        found = audit(self.log | {"velocity": noise})
        self.assertIn("does not follow the changes of the position", warned(found))
        self.assertIn("velocity", audit(self.log | {"velocity": speed})["columns"])


class Measured(unittest.TestCase):
    def test_sign_and_certainty_of_the_delay(self):
        t = T * np.arange(8000)
        z = presses(t, 6, 0.9) + tremor(t)
        log = log_of(t, z, spring(z, 1000.0, 2.0))
        late = np.append(np.zeros(5), log["force"][:-5])
        for factor in (0.8, -1.0):
            found = audit(log | {"measured": factor * late})
            self.assertAlmostEqual(found["measured"]["delay_s"], 5 * T, delta=1e-9)
            self.assertAlmostEqual(found["measured"]["gain"], factor, delta=1e-6)
            self.assertEqual("has the other sign" in warned(found), factor < 0.0)
            lossy = audit(without(log | {"measured": factor * late}, 0.1))["measured"]
            self.assertAlmostEqual(lossy["delay_s"], 5 * T, delta=1e-6)
        noise = np.random.default_rng(1).normal(size=len(t))
        noisy = audit(log | {"measured": late + 0.1 * noise})["measured"]
        self.assertAlmostEqual(noisy["delay_s"], 5 * T, delta=2.1 * T)
        wave = np.maximum(0.2 + np.sin(20.0 * np.pi * t), 0.0)  # a period of 100 rows
        waves = log_of(t, -1e-3 * wave, wave) | {"measured": -np.append(np.zeros(5), wave[:-5])}
        self.assertAlmostEqual(audit(waves)["measured"]["delay_s"], 5 * T, delta=1e-9)
        for measured, why in ((0.0 * t + 0.3, "is constant"), (noise, "correlates by at most")):
            found = audit(log | {"measured": measured})
            self.assertIsNone(found["measured"]["delay_s"])
            self.assertIn(why, found["measured"]["why"])
            self.assertTrue(any(why in one for one in found["missing"]))
            self.assertIn(why, dict(text.measured_rows(found["measured"]))["force"])


class Springs(unittest.TestCase):
    def holds(self, found, stiffness, delay):
        spring = found["stiffness"]
        low, high = spring["stiffness_interval"]
        self.assertTrue(low <= stiffness <= high, (low, high))
        first, last = np.array(spring["delay_interval_s"]) / found["clock"]["interval_s"]
        self.assertTrue(round(first) <= delay <= round(last), (first, last))

    def test_averaged_contacts_are_no_delay(self):
        """Checks that a delay of zero is not excluded if the force is a mean over the points in contact. The mean falls
        whenever a further point touches. No spring and damper explains this, and the residuals repeat in each contact.
        """
        t = 2e-3 * np.arange(2000)
        z = presses(t, 12, 0.12, depth=1.5e-3, every=0.3)
        depths = -z[:, None] - np.linspace(0.0, 4e-4, 5)
        counts = np.sum(depths > 0.0, axis=1)
        force = 450.0 * np.sum(np.maximum(depths, 0.0), axis=1) / np.maximum(counts, 1)
        found = audit(log_of(t, z, force, contacts=counts.astype(float)))
        if found["stiffness"] is not None:
            self.assertEqual(found["stiffness"]["delay_interval_s"][0], 0.0)

    def test_coarse_positions_do_not_exclude_the_truth(self):
        """Checks for coarse positions that the confidence intervals of stiffness and delay contain the true values. The
        rounding of the positions makes the fitted damping at the true delay negative, but its interval contains 0.
        """
        rng = np.random.default_rng(3)
        t = T * np.arange(9000)
        z = presses(t, 40, 0.1, rise=0.04, every=0.2) + tremor(t)
        force = spring(z, 180.0, delay=2)
        force += 0.03 * rng.normal(size=len(t)) * (force > 0.0)
        stamps = t + 0.2 * T * rng.uniform(-1.0, 1.0, len(t))
        self.holds(audit(log_of(stamps, 5e-5 * np.round(z / 5e-5), force)), 180.0, 2)

    def test_a_delay_is_shorter_than_half_of_a_contact(self):
        t = T * np.arange(1600)
        z = presses(t, 6, 0.06, rise=0.03, every=0.2)
        found = audit(log_of(t, z + tremor(t, 1e-5), spring(z + tremor(t, 1e-5), 900.0, 0.5)))
        for one in found["contacts"]:
            spring_of = one["spring"] or {}
            if "delay_interval_s" in spring_of:
                self.assertLessEqual(spring_of["delay_interval_s"][1], 0.5 * one["rows"] * T)

    def test_lost_rows_are_no_shorter_delay(self):
        """Checks a log from which rows were removed. The delay in rows must count the missing rows, and no velocity may
        be a difference of positions before and after missing rows."""
        rng = np.random.default_rng(6)
        t = T * np.arange(3000)
        z = presses(t, 2, 1.0) + tremor(t)
        for lost in (0.004, 0.01):
            keep = rng.random(len(t)) >= lost
            keep[[0, -1]] = True
            log = log_of(t[keep], z[keep], spring(z, 820.0, 1.2, 1)[keep])
            found = audit(log)
            self.holds(found, 820.0, 1)
            low, high = found["stiffness"]["damping_interval"]
            self.assertTrue(low <= 1.2 <= high, (low, high))

    def test_short_slides_with_friction(self):
        """Checks short contacts that each slide along a straight line. One contact does not distinguish friction from a
        tilted normal; all contacts together do."""
        t = 4e-3 * np.arange(400)
        z = presses(t, 5, 0.12, rise=0.06, every=0.28) + tremor(t, 5e-5)
        force = spring(z, 1000.0, 0.3, 1, 4e-3)
        along = 0.03 * np.array([np.sin(7.0 * t), np.cos(5.0 * t)])
        speed = np.gradient(along, t, axis=1)
        sideways = -0.4 * force * speed / np.linalg.norm(speed, axis=0)
        coordinates = {"x": along[0], "y": along[1], "z": z}
        found = audit({"t": t} | coordinates | {"fx": sideways[0], "fy": sideways[1], "fz": force})
        self.holds(found, 1000.0, 1)
        # Friction with a coefficient of 0.4 tilts the force by 22 degrees.
        self.assertGreater(abs(found["stiffness"]["direction"][2]), np.cos(np.radians(1.0)))

    def test_a_force_of_the_other_sign_in_short_contacts(self):
        t = 1e-2 * np.arange(1200)
        z = presses(t, 40, 0.12, depth=4e-3, rise=0.06, every=0.28)
        for interval in (1.0, 0.7):  # contacts of up to 12 and of up to 17 rows
            log = log_of(interval * t, z, spring(z, 800.0))
            log = {name: np.interp(interval * t, t, values) for name, values in log.items()}
            self.assertNotIn("force_by_tool", warned(audit(log)))
            found = audit(log | {"force": -log["force"]})
            self.assertIn("--set force_by_tool=true", warned(found))

    def test_an_offset_of_the_force_is_named(self):
        t = T * np.arange(8000)
        z = presses(t, 6, 0.6, every=1.2) + tremor(t)
        force = spring(z, 1000.0, 2.0)
        noise = 5e-3 * np.random.default_rng(2).normal(size=len(t))
        for offset in (force + 0.2, force + 0.2 + noise):
            found = audit(log_of(t, z, offset))
            (warning,) = [one for one in found["warnings"] if "have an offset?" in one]
            self.assertNotIn("tap, and press", " ".join(found["missing"]))
            touch = float(warning.partition("touch_N=")[2].rstrip(")"))
            spring_of = audit(log_of(t, z, offset), touch=touch)["stiffness"]
            low, high = spring_of["stiffness_interval"]
            self.assertTrue(low <= 1000.0 <= high, (low, high))
        self.assertNotIn("offset", warned(audit(log_of(t, z, force))))

    def test_contacts_without_force_are_named(self):
        t = T * np.arange(4000)
        z = presses(t, 4, 0.2, every=0.9)
        log = log_of(t, z, spring(z, 1000.0))
        found = warned(audit(log | {"contacts": np.full(len(t), 4.0)}))
        self.assertIn("column 4 contacts is above 0, the force is nearly 0", found)
        self.assertIn("--set touch_N=0 ", found)
        self.assertEqual(audit(log | {"contacts": (z < 0.0).astype(float)})["warnings"], [])

    def test_a_curved_surface_has_no_stiffness(self):
        """Checks a ball with a radius of 10 mm, with and without friction, and a plane. The tool slides during the
        presses."""
        t = T * np.arange(8000)
        tilt = 0.25 * np.array([np.sin(2.0 * t), np.cos(1.7 * t)])
        outwards = np.vstack([tilt, np.ones(len(t))]) / np.sqrt(1.0 + np.sum(tilt**2, axis=0))
        height = presses(t, 8, 0.7, depth=1e-3)
        push = spring(height, 1000.0, 2.0, 3)
        names = ("px", "py", "pz", "fx", "fy", "fz")
        for friction in (0.0, 0.2):
            position = outwards * (0.01 + height)
            speed = np.gradient(position, T, axis=1)
            along = speed - outwards * np.sum(speed * outwards, axis=0)
            along /= np.linalg.norm(along, axis=0)
            force = push * (outwards - friction * along)
            found = audit({"t": t} | dict(zip(names, [*position, *force])), "touch")
            self.assertIsNone(found["stiffness"])
            self.assertIsNone(found["device"])
            self.assertIn("the surface is curved, with a radius of about", found["missing"][0])
            self.assertAlmostEqual(found["surface_radius_m"], 0.01, delta=2e-3)
        plane = [*(0.01 * tilt), height, 0.0 * t, 0.0 * t, push]
        found = audit({"t": t} | dict(zip(names, plane)))
        self.assertIsNotNone(found["stiffness"])
        self.assertIsNone(found["surface_radius_m"])

    def test_impulses_have_no_stiffness(self):
        """Checks that no stiffness is reported for a rigid contact, which stops the tool within one row. The correction
        of the depth is not a spring."""
        for correction, restitution in ((0.2, 0.0), (0.2, 0.4), (0.1, 0.2)):
            found = audit(impulses(correction, restitution))
            self.assertIsNone(found["stiffness"], (correction, restitution))
            self.assertTrue(any(one.startswith("stiffness") for one in found["missing"]))

    def test_each_model_is_fitted_once(self):
        """Checks that no fit is computed twice: the fits of as_good() are used again, and widened() does not modify
        them."""
        from hapbench_audit import models

        t = T * np.arange(2000)
        z, made = presses(t, 3, 0.4) + tremor(t), []
        new_fit = models.new_fit

        def counted(motion, model, with_sign):
            made.append((id(motion), model, with_sign))
            return new_fit(motion, model, with_sign)

        with mock.patch.object(models, "new_fit", counted):
            first = audit(log_of(t, z, spring(z, 800.0, 1.0, 1)))["stiffness"]
        self.assertEqual(len(made), len(set(made)))
        self.assertEqual(first, audit(log_of(t, z, spring(z, 800.0, 1.0, 1)))["stiffness"])


def impulses(correction, restitution, mass=0.1):
    """Returns the log of a tool that a hand presses against a rigid surface. An impulse within one row stops the tool.
    `correction`: fraction of the depth that is removed per row."""
    t = T * np.arange(6000)
    target = presses(t, 7, 0.6, every=0.8) + tremor(t)
    z, v, positions, forces = 1e-3, 0.0, [], []
    for goal in target:
        hand = 300.0 * (goal - z) - 4.0 * v
        force = 0.0
        if z < 0.0:
            bounce = -restitution * v if v < -0.05 else 0.0
            force = max(mass * ((correction * -z / T + bounce - v) / T) - hand, 0.0)
        positions.append(z)
        forces.append(force)
        v += T * (hand + force) / mass
        z += T * v
    return log_of(t, np.array(positions), np.array(forces))


class Diagnosis(unittest.TestCase):
    def test_a_rest_is_no_saturation(self):
        """Checks that a resting tool is not reported as saturated, and that a limited force is. The force of a resting
        tool is constant; a limited force is constant while the tool moves."""
        t = T * np.arange(4000)
        z = presses(t, 3, 0.9)
        self.assertNotIn("saturated", rules_of(audit(log_of(t, z, spring(z, 900.0)))))
        moving = z + 3.0 * tremor(t, 5e-4)
        cut = np.minimum(spring(moving, 900.0), 1.8)
        self.assertIn("saturated", rules_of(audit(log_of(t, moving, cut))))

    def test_a_rounded_force_is_no_saturation(self):
        t = T * np.arange(6000)
        z = -1e-3 * (1.0 - np.cos(np.pi * t)) + 1e-4
        force = spring(z, 1000.0)
        self.assertNotIn("saturated", rules_of(audit(log_of(t, z, np.round(force, 2)))))
        cut = np.minimum(np.round(force, 2), 1.5)
        self.assertIn("saturated", rules_of(audit(log_of(t, z, cut))))

    def test_the_first_landing_is_no_bounce(self):
        t = T * np.arange(100)
        z = np.where(t < 0.02, 1e-3, -1e-3 * np.sin(12.0 * np.pi * (t - 0.02)))
        self.assertNotIn("bounces", rules_of(audit(log_of(t, z, spring(z, 1000.0)))))
        t = T * np.arange(3000)
        z = 1e-3 * np.sin(20.0 * np.pi * t) + 5e-4
        self.assertIn("bounces", rules_of(audit(log_of(t, z, spring(z, 1000.0)))))

    def test_noise_neither_chatters_nor_hammers(self):
        rng = np.random.default_rng(4)
        t = T * np.arange(4000)
        z = presses(t, 3, 0.9, rise=0.3) + tremor(t, 2e-5)
        force = spring(z, 400.0)
        noise = 0.05 * rng.normal(size=len(t))
        everywhere = audit(log_of(t, z, force + noise))
        self.assertEqual(everywhere["metrics"]["contacts"], 3)
        touching = audit(log_of(t, z, force + noise * (force > 0.0)))
        counted = audit(log_of(t, z, force + noise, contacts=(force > 0.0).astype(float)))
        for found in (everywhere, touching, counted):
            self.assertFalse({"chatter", "buzz"} & set(rules_of(found)), rules_of(found))

    def test_flips_of_the_force_still_chatter(self):
        t = T * np.arange(3000)
        z = presses(t, 2, 1.0) + tremor(t)
        force = spring(z, 500.0)
        force[::7] *= -0.8
        self.assertIn("chatter", rules_of(audit(log_of(t, z, force))))

    def test_energy_of_a_delay_that_the_log_does_not_determine(self):
        """Checks the advice for contacts of 12 rows each, from which no stiffness can be determined. It must name the
        delay as a possible cause of the created energy."""
        t = 1e-2 * np.arange(1200)
        z = presses(t, 40, 0.12, depth=4e-3, rise=0.06, every=0.28)
        energy = rules_of(audit(log_of(t, z, spring(z, 800.0, delay=2))))["energy"]
        self.assertIn("delay", energy["try"])

    def test_no_damping_is_advised_against_a_delay(self):
        """Checks a delay of 6 ms and a motion of 25 Hz. Damping has the same delay. With 0.5 and with 7 N s/m, the log
        creates energy, although both dampings would suffice against slow motion or nearly so (K d = 6 N s/m).
        """
        t = T * np.arange(4000)
        z = -1e-3 - 5e-4 * np.sin(50.0 * np.pi * t) - 1e-3 * np.sin(2.6 * np.pi * t)
        z[t < 0.1] = 1e-3
        for damping in (0.5, 7.0):
            energy = rules_of(audit(log_of(t, z, spring(z, 1000.0, damping, delay=6))))["energy"]
            self.assertIn("a shorter delay", energy["try"])
            self.assertNotIn("N s/m", energy["try"])

    def test_a_log_that_is_nearly_always_in_contact(self):
        """Checks a log with 15 rows without force before a contact that lasts to the end: any force is contact. With
        noise around zero in place of a contact, the audit still chooses a threshold."""
        t = T * np.arange(4000)
        z = -8e-4 + 7e-4 * np.cos(24.0 * np.pi * t)
        z[:15] = 1e-3
        found = audit(log_of(t, z, spring(z, 1000.0)))
        self.assertEqual(found["metrics"]["contacts"], 1)
        self.assertEqual(found["contact_rule"], "any force")
        noise = 0.02 * np.random.default_rng(2).normal(size=len(t))
        noise[:15] = 0.0
        noisy = audit(log_of(t, z, spring(presses(t, 3, 0.9), 900.0) + noise))
        self.assertEqual(noisy["metrics"]["contacts"], 3)
        self.assertIn("only 0.38 % of the rows are without force", noisy["contact_rule"])

    def test_the_reason_for_an_uncertain_stiffness(self):
        """Checks a contact of thousands of rows whose force oscillates independently of the motion: its stiffness is
        too uncertain, which is not a lack of rows."""
        t = T * np.arange(6000)
        z = np.where(t < 0.2, 1e-3, -5e-4 - 2e-4 * np.sin(2.0 * np.pi * t))
        force = spring(z, 800.0)
        force += (force > 0.0) * (0.2 * np.sin(274.0 * np.pi * t) + 0.1 * np.sin(84.0 * np.pi * t))
        found = audit(log_of(t, z, np.where(z < 0.0, np.maximum(force, 1e-3), 0.0)))
        self.assertIsNone(found["stiffness"])
        self.assertNotIn("no contact has", " ".join(found["missing"]))

    def test_a_fast_motion_is_no_jump_of_contacts(self):
        t = 1e-2 * np.arange(400)
        z = presses(t, 8, 0.15, depth=6e-3, rise=0.05, every=0.4)
        force = spring(z, 500.0)
        pop = rules_of(audit(log_of(t, z, force, contacts=(force > 0.0).astype(float))))["pop"]
        self.assertIn("mm in one row", pop["try"])

    def test_encoder_steps_matter_to_a_rough_force_only(self):
        """Checks that the rule `encoder` is not applied if the log does not show encoder steps. The encoder of the
        device that the user names may differ from the encoder of the log."""
        t = T * np.arange(3000)
        z = presses(t, 2, 1.0) + tremor(t, 1e-5)
        found = audit(log_of(t, z, spring(z, 300.0, 4.0)), device="touch")
        self.assertNotIn("encoder", rules_of(found))


class Oscillations(unittest.TestCase):
    def test_amplitude_at_uneven_times(self):
        """Checks the amplitude of an oscillation at a quarter of the sampling rate in a log with irregular times.
        Linear interpolation between the times would reduce it by a fifth."""
        rng = np.random.default_rng(5)
        steps = T * (1.0 + 0.3 * rng.uniform(-1.0, 1.0, 3000))
        t = np.cumsum(steps)
        z = presses(t, 1, 2.5)
        force = spring(z, 800.0)
        force = np.where(force > 0.0, force + 0.3 * np.sin(2.0 * np.pi * 240.0 * t), 0.0)
        strongest = audit(log_of(t, z, force))["buzz"][0]
        self.assertAlmostEqual(strongest["frequency_Hz"], 240.0, delta=0.5)
        # Errors of less than 2 % come from noise of the other forces, and from the scalloping loss of the window with
        # zero padding to four times the length.
        self.assertAlmostEqual(strongest["amplitude_N"], 0.3, delta=6e-3)

    def test_the_amplitude_is_the_largest_magnitude_of_the_vector(self):
        """Checks a lateral force of constant magnitude that rotates, and an oscillation along an oblique line. The
        normal force of 0 or 1 N shows no resolution."""
        t = T * np.arange(4000)
        z = np.where(t < 0.2, 1e-3, -1e-3)
        touching = (z < 0.0).astype(float)
        angle = 240.0 * np.pi * t
        for x, y in ((np.cos(angle), np.sin(angle)), (0.6 * np.cos(angle), 0.8 * np.cos(angle))):
            log = {"t": t, "x": 1e-6 * np.sin(t), "y": 0.0 * t, "z": z}
            log |= {"fx": 0.3 * x * touching, "fy": 0.3 * y * touching, "fz": touching}
            found = audit(log)
            self.assertAlmostEqual(found["buzz"][0]["amplitude_N"], 0.3, delta=5e-3)
            # The smallest difference between two computed forces counts as resolution: 0, or far below the amplitude.
            self.assertLess(found["clock"]["force_resolution_N"], 1e-6)

    def test_an_oscillation_during_slow_motion(self):
        """Checks an oscillation at 60 Hz whose frequency is a multiple of the frequency of a slow motion, 2.5 Hz. Its
        amplitude exceeds the largest amplitude of a harmonic, 2 / 24 of 1 N."""
        t = T * np.arange(4000)
        z = np.where(t < 0.2, 1e-3, -2e-3 - 1e-3 * np.sin(2.0 * np.pi * 2.5 * t))
        force = spring(z, 1000.0)
        for amplitude, frequencies in ((0.2, [60.0]), (0.0, [])):
            added = amplitude * np.sin(2.0 * np.pi * 60.0 * t)
            found = audit(log_of(t, z, np.where(force > 0.0, force + added, 0.0)))
            self.assertEqual([round(one["frequency_Hz"], 0) for one in found["buzz"]], frequencies)

    def test_a_tool_that_hammers_loses_contact_three_times(self):
        """Checks logs with several losses of contact after the landing. Two losses are no repetition."""
        t = T * np.arange(1500)
        for count in (2, 3):
            z = np.where(t < 0.2, 1e-3, -1e-3 - 2e-4 * np.sin(2.0 * np.pi * 3.0 * t))
            for i in range(count):
                z[600 + 200 * i : 610 + 200 * i] = 1e-4
            found = audit(log_of(t, z, spring(z, 5000.0)), device="omega.3")
            self.assertEqual(found["metrics"]["contacts_lost_after_landing"], count)
            self.assertEqual(found["metrics"]["contacts_lost_in_spectrum"], count)
            self.assertEqual(text.hammers(found["metrics"]), count >= 3)

    def test_a_press_is_no_oscillation(self):
        for seconds in (0.1, 0.15, 0.3):
            t = T * np.arange(2400)
            z = presses(t, 6, seconds, rise=0.3 * seconds, every=0.37)
            self.assertEqual(audit(log_of(t, z, spring(z, 900.0)))["buzz"], [])


if __name__ == "__main__":
    unittest.main()
