"""Tests hapbench.audit() with simulated contacts of known stiffness, damping and delay."""
import json
import os
import unittest

import numpy as np
from fixture import PROGRAM, ran, scratch_folder

os.environ.setdefault("HAPBENCH_PROGRAM", str(PROGRAM))

from hapbench import audit  # noqa: E402  (finds the program in the environment)

T = 1e-3  # sampling period [s]
# Mass of the handle [kg], stiffness [N/m] and damping [N s/m] of the hand.
MASS, HAND, HAND_DAMPING = 0.12, 250.0, 3.5
# A reported interval may miss the true value by at most this fraction of the true value. The model is exact, so the
# only errors are those of the log's rounding: positions have six decimals, forces nine digits.
ROUNDING = 1e-4


def presses(t):
    """Returns the target positions z [m] of a hand at the times t [s]: 4 mm above the wall, and 8 mm inside the wall
    during three presses."""
    return np.where((t > 0.3) & (t % 1.2 < 0.8), -8e-3, 4e-3)


def decay(t):
    """Returns the target positions z [m], at the times t [s], of a hand that presses once and then stays."""
    return np.where(t > 0.3, -8e-3, 4e-3)


def simulated(stiffness, damping, delay, target=presses, friction=0.0, slide=0.0, tremor=0.0):
    """Returns (times [s], positions (x, z) [m], forces (x, z) [N]) of a handle at a wall, integrated with ten steps per
    row. The force follows from the true position and velocity `delay` rows earlier."""
    rng, rows, parts = np.random.default_rng(1), 3000, 10
    at, speed, shake = np.array([0.0, 4e-3]), np.zeros(2), 0.0
    positions, speeds, forces = np.zeros((rows, 2)), np.zeros((rows, 2)), np.zeros((rows, 2))
    goals = target(T * np.arange(rows))
    for k in range(rows):
        shake += -shake * T / 0.02 + tremor * np.sqrt(2.0 * T / 0.02) * rng.normal()
        positions[k], speeds[k] = at, speed
        (_, z), (vx, vz) = positions[max(k - delay, 0)], speeds[max(k - delay, 0)]
        normal = max(0.0, -stiffness * z - damping * vz) if z < 0.0 else 0.0
        forces[k] = -friction * normal * vx / max(abs(vx), 5e-3), normal
        goal = np.array([slide * np.sin(2.0 * k * T), goals[k] + shake])
        for _ in range(parts):
            pull = HAND * (goal - at) - HAND_DAMPING * speed
            speed = speed + (forces[k] + pull) / MASS * T / parts
            at = at + speed * T / parts
    return T * np.arange(rows), np.round(positions, 6), forces


def one_axis(*given, **more):
    t, position, force = simulated(*given, **more)
    return {"t": t, "position": position[:, 1], "force": force[:, 1]}


def three_axes(*given, **more):
    t, position, force = simulated(*given, **more)
    zero = np.zeros(len(t))
    coordinates = {"x": position[:, 0], "y": zero, "z": position[:, 1]}
    return {"t": t, **coordinates, "fx": force[:, 0], "fy": zero, "fz": force[:, 1]}


class Battery(unittest.TestCase):
    def holds(self, interval, truth, message):
        low, high = interval
        slack = ROUNDING * abs(truth)
        self.assertTrue(low - slack <= truth <= high + slack, (message, interval, truth))

    def determined(self, log, stiffness, damping, delay):
        """Asserts that the intervals contain the true values, and that the reported stiffness is accurate to 2 %."""
        spring = audit(log)["stiffness"]
        name = (stiffness, damping, delay)
        self.assertIsNotNone(spring, name)
        self.holds(spring["stiffness_interval"], stiffness, name)
        self.holds(spring["damping_interval"], damping, name)
        first, last = spring["delay_interval_s"]
        self.assertTrue(first - 1e-9 <= delay * T <= last + 1e-9, (name, first, last))
        self.assertAlmostEqual(spring["stiffness_N_per_m"] / stiffness, 1.0, delta=0.02, msg=name)
        return spring

    def test_presses_of_one_axis(self):
        """Checks several walls on one axis. The end of the log cuts off the last contact; all other contacts are
        complete presses."""
        for truth in ((600.0, 2.0, 2), (600.0, 0.0, 0), (1500.0, 1.0, 1), (4000.0, 2.0, 2)):
            self.determined(one_axis(*truth), *truth)

    def test_a_hand_that_trembles(self):
        for truth in ((600.0, 2.0, 2), (1500.0, 1.0, 1)):
            self.determined(one_axis(*truth, tremor=2e-4), *truth)

    def test_sliding_with_friction(self):
        truth = (600.0, 2.0, 2)
        log = three_axes(*truth, friction=0.4, slide=5e-3)
        spring = self.determined(log, *truth)
        # The error of the normal is the resolution of 1 um divided by the travel of 5 mm.
        self.assertAlmostEqual(abs(spring["direction"][2]), 1.0, delta=1e-3)

    def test_no_number_without_motion(self):
        """Checks that no delay is reported for an undisturbed decay, which fits any delay."""
        t, position, force = simulated(600.0, 2.0, 2, target=decay)
        keep = t > 0.45
        log = {"t": t[keep], "position": position[keep, 1], "force": force[keep, 1]}
        found = audit(log)
        spring = found["stiffness"]
        if spring is None:
            self.assertTrue(any("stiffness" in one for one in found["missing"]), found["missing"])
            return
        self.assertIsNone(spring["delay_s"])
        self.holds(spring["stiffness_interval"], 600.0, "decay")

    def test_a_loop_slower_than_the_log(self):
        """Checks a log in which position and force change only in every fourth row. The limit must be computed at the
        rate of the changes."""
        log = one_axis(600.0, 2.0, 0)
        found = audit({name: np.repeat(values, 4) for name, values in log.items() if name != "t"}
                      | {"t": 0.25 * T * np.arange(4 * len(log["t"]))}, "touch")  # fmt: skip
        limits = found["device"], audit(log, "touch")["device"]
        self.assertAlmostEqual(limits[0]["rate_Hz"] * T, 1.0, delta=1e-3)
        for end in (0, 1):
            ends = [one["linear_limit_interval"][end] for one in limits]
            self.assertAlmostEqual(ends[0] / ends[1], 1.0, delta=0.05)


class OneAxis(unittest.TestCase):
    def test_columns_by_any_name(self):
        t, position, force = simulated(600.0, 2.0, 2)
        scratch = scratch_folder(self)
        file = scratch / "log.csv"
        lines = [f"{a!s},{b!s},{c!s}" for a, b, c in zip(t, position[:, 1], force[:, 1])]
        file.write_text("\n".join(["stamp,tip_z,load", *lines]) + "\n")
        for columns in ("time=stamp,position=tip_z,force=load", "time=1,position=2,force=3"):
            words = ("audit", file, "--json", "--out", scratch / "out", "--columns", columns)
            done = ran(PROGRAM, *words)
            self.assertEqual(done.returncode, 0, done.stderr)
            spring = json.loads(done.stdout)["stiffness"]
            low, high = spring["stiffness_interval"]
            self.assertTrue(low <= 600.0 <= high, (columns, low, high))
        done = ran(PROGRAM, "audit", file, "--columns", "time=1,position=tip_z,force=nope")
        self.assertEqual(done.returncode, 2)
        self.assertNotIn("absent", done.stderr)
        self.assertIn("2 tip_z", done.stderr)
        done = ran(PROGRAM, "import", "stroke", file, "--columns", "time=1,position=2")
        self.assertIn("three components", done.stderr)


if __name__ == "__main__":
    unittest.main()
