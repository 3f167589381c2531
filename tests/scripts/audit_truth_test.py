"""Tests that hapbench.audit() reports nothing false. The logs have jitter, noise, short slides, rests, rigid contacts,
and forces that are means over the points in contact."""
import os
import unittest
from unittest import mock

import numpy as np
from fixture import PROGRAM

os.environ.setdefault("HAPBENCH_PROGRAM", str(PROGRAM))

from hapbench import audit  # noqa: E402  (finds the program in the environment)
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

    def test_times_without_order_have_no_missing_rows(self):
        """Checks that no row counts as missing if the time stamps have errors of up to almost half an interval. Times
        between two neighbouring rows are then almost arbitrary."""
        rng = np.random.default_rng(2)
        t = np.sort(T * (np.arange(3000) + 0.49 * rng.uniform(-1.0, 1.0, 3000)))
        z = presses(t, 2, 0.8)
        self.assertEqual(audit(log_of(t, z, spring(z, 800.0)))["clock"]["rows_missing"], 0)


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
