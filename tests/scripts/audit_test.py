"""Tests `hapbench audit` and hapbench.audit() on logs with known answers, and on runs of hapbench."""
import json
import math
import os
import unittest
from types import SimpleNamespace

import numpy as np
from fixture import PROGRAM, hapbench, ran, scratch_folder

os.environ.setdefault("HAPBENCH_PROGRAM", str(PROGRAM))

from hapbench import InputError, audit  # noqa: E402  (finds the program in the environment)
from hapbench_audit.audit import energy_by_contact  # noqa: E402

T = 0.001  # sampling period of the logs [s]
# Allowed relative error of parameters that least squares finds from exact data. It covers the rounding of the normal
# equations, and the 1e-6 by which audit widens every confidence interval.
EXACT = 1e-5


def pressed(cycles, amplitude=1e-3, per_cycle=100, depth=3e-3):
    """Returns positions [m] of a tool that lands within 50 rows and then moves up and down `cycles` times inside the
    surface z < 0. `depth`: mean depth. `amplitude`: amplitude of the motion."""
    landing = np.concatenate([np.full(100, 1e-3), np.linspace(1e-3, -depth, 50, endpoint=False)])
    phase = 2.0 * np.pi / per_cycle * np.arange(cycles * per_cycle + 1)
    return np.concatenate([landing, -depth - amplitude * np.sin(phase)])


def delayed(values, rows):
    return np.concatenate([np.full(rows, values[0]), values[: len(values) - rows]])


def table(z, force, **more):
    """Returns a log of a tool that moves along z."""
    zero = np.zeros(len(z))
    return {
        "t": T * np.arange(len(z)),
        "x": zero,
        "y": zero,
        "z": z,
        "fx": zero,
        "fy": zero,
        "fz": force,
    } | more


def csv_text(columns):
    rows = zip(*(values.tolist() for values in columns.values()))
    return "\n".join([",".join(columns), *(",".join(map(str, row)) for row in rows)]) + "\n"


def wall(z, stiffness, damping=0.0):
    """Returns the force of a one-sided spring and damper at z = 0. The velocity is a backward difference of the
    positions."""
    speed = np.diff(z, prepend=z[0]) / T
    return np.where(z < 0.0, -stiffness * z - damping * speed, 0.0)


def rules_of(found):
    return {one["rule"]: one for one in found["diagnosis"]}


class KnownAnswers(unittest.TestCase):
    def test_sampled_spring_with_delay(self):
        """Compares the work with a closed form. The force f_k = −K x_(k−d) has a delay of d rows and is held until the
        next row. On the motion x_k = A sin(k φ) with φ = 2π/N, it does the work K A² N sin((d + ½) φ) sin(φ/2) per
        cycle of N rows."""
        stiffness, amplitude, per_cycle = 1200.0, 1e-3, 100
        for delay in (0, 1, 3):
            found = []
            for cycles in (10, 30):
                z = pressed(cycles, amplitude, per_cycle)
                found.append(audit(table(z, wall(delayed(z, delay), stiffness))))
            spring = found[1]["stiffness"]
            self.assertEqual(spring["delay_rows"], delay)
            self.assertAlmostEqual(spring["stiffness_N_per_m"] / stiffness, 1.0, delta=EXACT)
            self.assertAlmostEqual(spring["damping_N_s_per_m"], 0.0, delta=EXACT * stiffness * T)
            angle = 2.0 * math.pi / per_cycle
            per = (
                stiffness
                * amplitude**2
                * per_cycle
                * math.sin((delay + 0.5) * angle)
                * math.sin(angle / 2.0)
            )
            work = (found[1]["energy"]["work_J"] - found[0]["energy"]["work_J"]) / 20.0
            # The work is a sum of 3000 products of a force of about 4 N and a displacement of about 0.1 mm. Each
            # product has a relative rounding error of 1e-16.
            self.assertAlmostEqual(work, per, delta=1e-12)

    def test_limit_and_frequency_in_closed_form(self):
        """Compares the stability limit and the frequency with a closed form. For an undamped handle of mass m at a wall
        with stiffness K and damping B, and the sampling period T, let κ = K T²/m and β = B T/m. The loop is stable for
        κ < 2 β (2 − β)/(2 + β). Its angular frequency at the limit is θ/T with cos θ = 1 − κ/4 − β/2.
        """
        mass, damping = 0.1, 5.0
        beta = damping * T / mass
        limit = 2.0 * beta * (2.0 - beta) / (2.0 + beta) * mass / T**2
        scratch = scratch_folder(self)
        device = scratch / "mine.json"
        device.write_text(json.dumps({"type": "impedance", "handle_mass_kg": mass}))
        for factor in (0.5, 1.001):
            z = pressed(20)
            found = audit(table(z, wall(z, factor * limit, damping)), device)["device"]
            # The limit is nearly proportional to B, and the relative error of B is at most EXACT.
            self.assertAlmostEqual(found["linear_limit_N_per_m"] / limit, 1.0, delta=2 * EXACT)
            self.assertAlmostEqual(found["ratio"] / factor, 1.0, delta=3 * EXACT)
            if factor < 1.0:
                self.assertIsNone(found["expected_frequency_Hz"])
                continue
            kappa = limit * T**2 / mass
            frequency = math.acos(1.0 - kappa / 4.0 - beta / 2.0) / (2.0 * math.pi * T)
            # At a stiffness of 1.001 times the limit, the squared frequency is at most 1.001 times the squared
            # frequency at the limit.
            self.assertAlmostEqual(found["expected_frequency_Hz"] / frequency, 1.0, delta=1e-3)
        answer = hapbench(
            "limit", "wall_on_handle", "--device", device, "--json", "--out", scratch / "limit",
            "--set", f"time.step_s={T}", "--set", f"rendering.damping_N_s_per_m={damping}",
        )  # fmt: skip
        row = json.loads(answer)["limits"][0]
        # This loop is linear, so that the theoretical limit and the linear limit are equal. The answer may contain only
        # one of them.
        same = row["theoretical_limit"] or row["linear_limit"]
        self.assertAlmostEqual(found["linear_limit_N_per_m"] / same, 1.0, delta=2 * EXACT)

    def test_passive_spring_and_damper(self):
        """Checks a spring and damper whose force is held between rows. For B > K T / 2, the held force creates no
        energy. Without damping, the held force creates energy, but a force that is interpolated between rows does
        not."""
        rng = np.random.default_rng(1)
        z = pressed(20) + 2e-4 * np.cumsum(rng.normal(size=len(pressed(20)))) / 100.0
        stiffness = 1000.0
        damped = audit(table(z, wall(z, stiffness, 1.0)))["energy"]
        # If a contact begins between two rows, the created energy is larger by at most K d²/2. Here d is the
        # displacement per row at first touch: 80 um plus noise, less than 100 um.
        touch = 0.5 * stiffness * 1e-4**2
        self.assertLessEqual(damped["net_created_J"], damped["net_created_error_J"] + touch)
        bare = audit(table(z, wall(z, stiffness)))["energy"]
        self.assertGreater(bare["work_J"] - bare["work_path_J"], 1e-4)
        self.assertLessEqual(bare["net_created_path_J"], bare["net_created_error_J"] + touch)

    def test_quantised_position(self):
        """Checks that confidence intervals contain the true values, and that the error of the work is within its bound,
        if an encoder quantises the position."""
        rng = np.random.default_rng(2)
        for step in (1e-5, 5e-5):
            z = (
                pressed(20, per_cycle=317)
                + 1e-5 * np.cumsum(rng.normal(size=len(pressed(20, per_cycle=317)))) / 10.0
            )
            seen = step * np.round(z / step)
            force = wall(seen, 1500.0)
            found = audit(table(seen, force))
            self.assertAlmostEqual(found["clock"]["position_resolution_m"] / step, 1.0, delta=1e-6)
            low, high = found["stiffness"]["stiffness_interval"]
            self.assertTrue(low <= 1500.0 <= high, (low, high))
            true_work = float(np.sum(force[:-1] * np.diff(z)))
            energy = found["energy"]
            self.assertLessEqual(abs(energy["work_J"] - true_work), energy["work_error_J"])
            # The error bound must be useful: smaller than 20 cycles * stiffness * mean depth * amplitude. In each
            # cycle, the spring takes up twice the energy stiffness * mean depth * amplitude.
            self.assertLess(energy["work_error_J"], 20.0 * 1500.0 * 3e-3 * 1e-3)

    def test_position_that_moves_by_few_counts(self):
        z = 1e-4 * np.round(pressed(10, amplitude=2e-4) / 1e-4)
        z[100:] = np.where(z[100:] < -2.5e-3, z[100:], -2.8e-3)
        found = audit(table(z, np.where(z < 0.0, -1000.0 * z, 0.0)))
        self.assertIsNone(found["stiffness"])
        self.assertTrue(
            any("steps of its resolution" in one for one in found["missing"]), found["missing"]
        )

    def test_dry_friction(self):
        """Checks that dry friction c dissipates 4 A c per cycle of the amplitude A."""
        stiffness, friction, amplitude = 800.0, 0.4, 1e-3

        def log(cycles):
            z = pressed(cycles, amplitude)
            sign = np.sign(np.diff(z, prepend=z[0]))
            return audit(table(z, np.where(z < 0.0, -stiffness * z - friction * sign, 0.0)))

        found, shorter = log(20), log(10)
        spring = found["stiffness"]
        self.assertAlmostEqual(spring["stiffness_N_per_m"] / stiffness, 1.0, delta=0.01)
        self.assertAlmostEqual(spring["dry_friction_N"] / friction, 1.0, delta=0.01)
        lost = (found["energy"]["work_path_J"] - shorter["energy"]["work_path_J"]) / 10.0
        # Twice per cycle, where the motion reverses, the friction has the wrong sign for half a step. Each time, this
        # changes the work by A (1 − cos φ) c, where φ is the phase per row.
        self.assertAlmostEqual(lost / (-4.0 * amplitude * friction), 1.0, delta=0.005)
        self.assertNotIn("energy", rules_of(found))

    def test_buzz_of_a_device_with_delay(self):
        """Checks that a handle of 0.08 kg with a delay of 2 samples vibrates near the frequency of the linear theory.
        The stiffness is 2.3 times the stability limit."""
        mass, viscous, delay = 0.08, 1.0, 2
        scratch = scratch_folder(self)
        device = scratch / "late.json"
        device.write_text(
            json.dumps(
                {
                    "type": "impedance",
                    "handle_mass_kg": mass,
                    "viscous_N_s_per_m": viscous,
                    "delay_samples": delay,
                }
            )
        )
        # The stability limit of the stiffness is approximated by the formula of Gil and Hulin.
        stiffness = 2.3 * viscous / (T * (0.5 + delay))
        log = handle_at_wall(mass, viscous, delay, stiffness)
        found = audit(log, device)
        self.assertAlmostEqual(
            found["stiffness"]["stiffness_N_per_m"] / stiffness, 1.0, delta=EXACT
        )
        self.assertAlmostEqual(
            found["device"]["ratio"], 2.3, delta=0.14 * 2.3
        )  # relative accuracy of the formula
        expected, seen = found["device"]["expected_frequency_Hz"], found["buzz"][0]["frequency_Hz"]
        # The wall only pushes. A growing oscillation therefore loses contact, and its period then becomes longer.
        self.assertTrue(0.6 * expected < seen < 1.1 * expected, (expected, seen))
        finding = rules_of(found)["edge"]
        self.assertIn(f"expect a buzz near {expected:.0f} Hz", finding["says"])
        self.assertIn("slower because it loses contact", finding["says"])
        self.assertIn("energy", rules_of(found))

    def test_the_script_of_a_hand_is_no_buzz(self):
        """Checks a run whose stiffness is above the limit of a device that the run does not have. The tool bounces once
        while it lands. Then the hand moves it at 2.5 Hz, which gives harmonics at 12.5 Hz and 17.5 Hz.
        """
        folder = scratch_folder(self)
        hapbench("run", "tap_wall", "--quiet", "--out", folder / "tap")
        words = ("audit", folder / "tap/trajectory.csv", "--json", "--device", "omega.3")
        found = json.loads(hapbench(*words, "--out", folder / "audit"))
        self.assertGreater(found["device"]["ratio"], 4.0)
        self.assertGreater(found["metrics"]["contacts_lost_per_s"], 1.0)
        self.assertEqual(found["metrics"]["contacts_lost_after_landing"], 0)
        self.assertEqual(found["buzz"], [])
        self.assertEqual(found["diagnosis"], [])


def handle_at_wall(mass, viscous, delay, stiffness, seconds=3.0):
    """Returns the log of a handle that a hand with a stiffness of 200 N/m presses into a wall. The motion is integrated
    with twenty steps per sampling period."""
    z, v, waiting, rows = 1e-3, 0.0, [0.0] * delay, []
    parts = 20
    for k in range(int(seconds / T)):
        force = -stiffness * min(z, 0.0)
        rows.append((z, force))
        waiting.append(force)
        acting = waiting.pop(0)
        target = 1e-3 - min(k * T, 1.0) * 8e-3
        for _ in range(parts):
            v += (acting + 200.0 * (target - z) - viscous * v) / mass * T / parts
            z += v * T / parts
    z, force = np.array(rows).T
    return table(z, force)


class Clocks(unittest.TestCase):
    def test_jitter_missing_and_held(self):
        z = pressed(20)
        log = table(z, wall(z, 1000.0))
        rng = np.random.default_rng(3)
        jittered = log | {"t": log["t"] + 1e-4 * rng.uniform(-0.5, 0.5, len(z))}
        clock = audit(jittered)["clock"]
        # A difference of two uniform errors of width w has the standard deviation w/√6. The estimate from 2000
        # differences has an error of 3 %.
        self.assertAlmostEqual(clock["jitter_s"] / (1e-4 / math.sqrt(6.0)), 1.0, delta=0.1)
        kept = np.ones(len(z), bool)
        kept[[500, 900, 901]] = False
        gaps = audit({name: values[kept] for name, values in log.items()})
        self.assertEqual(gaps["clock"]["rows_missing"], 3)
        self.assertEqual(gaps["clock"]["rows_missing_in_a_row"], 2)
        self.assertTrue(any("3 rows are missing" in one for one in gaps["warnings"]))
        held = np.repeat(z[::4], 4)[: len(z)]
        found = audit(table(held, wall(held, 1000.0)))
        self.assertEqual(found["clock"]["rows_per_position"], 4.0)
        self.assertAlmostEqual(found["stiffness"]["stiffness_N_per_m"] / 1000.0, 1.0, delta=EXACT)

    def test_a_gap_ends_a_contact(self):
        z = pressed(20)
        log = table(z, wall(z, 1000.0))
        log["t"] = log["t"] + np.where(np.arange(len(z)) >= 1000, 0.2, 0.0)
        self.assertEqual(audit(log)["metrics"]["contacts"], 2)

    def test_nothing_is_said_about_the_force_between_rows_with_missing_rows_between(self):
        """Checks a force that changes its sign between two rows. The metrics count the reversal and the step of the
        force if no row is missing, but not if rows are missing between the two rows."""
        z = pressed(20)
        force = wall(z, 1000.0)
        force[1000:] *= -1.0
        log = table(z, force)
        self.assertEqual(audit(log)["metrics"]["force_reversals"], 1)
        kept = np.ones(len(z), bool)
        kept[[1000, 1001]] = False
        found = audit({name: values[kept] for name, values in log.items()})["metrics"]
        self.assertEqual(found["force_reversals"], 0)
        # Without the change of sign, the force changes by at most 1000 N/m times the displacement between two rows,
        # which is less than 0.1 N.
        self.assertLess(found["force_step_max_N"], 0.1)


class Energy(unittest.TestCase):
    def test_contacts_with_unknown_energy_are_left_out_of_the_rate(self):
        """Checks the created energy per second in contact. The first contact lasts 1 s and creates 2 J. The second
        contact lasts 3 s, and its energy is unknown."""
        every = [
            {"start_s": 0.0, "end_s": 1.0, "rows": 1000, "created_J": 2.0, "error_J": 0.0},
            {"start_s": 2.0, "end_s": 5.0, "rows": 3000, "created_J": None, "error_J": None},
        ]
        found = energy_by_contact(SimpleNamespace(interval=1e-3), every)
        self.assertEqual(found["created_per_contact_J"], 2.0)
        self.assertAlmostEqual(found["created_per_s_in_contact_W"], 2.0, delta=1e-12)


class Formats(unittest.TestCase):
    def test_other_engine(self):
        """Checks a log with nanoseconds since 1970, millimetres, a quaternion, and the force of the tool on the
        object."""
        z = pressed(20)
        force = wall(z, 1000.0, 1.0)
        start = 1_700_000_000_000_000_000
        scratch = scratch_folder(self)
        file = scratch / "engine.csv"
        lines = ["stamp_ns,tip.x [mm],tip.y [mm],tip.z [mm],qw,qx,qy,qz,load_x,load_y,load_z"]
        lines += [
            f"{start + 1_000_000 * k},0,0,{1e3 * z[k]!s},1,0,0,0,0,0,{-force[k]!s}"
            for k in range(len(z))
        ]
        file.write_text("\n".join(lines) + "\n")
        words = (
            "--columns",
            "time=stamp_ns,position=tip.x,force=load_x",
            "--json",
            "--out",
            scratch / "out",
        )
        done = ran(PROGRAM, "audit", file, *words)
        self.assertIn("--set force_by_tool=true", done.stderr)
        found = json.loads(hapbench("audit", file, "--set", "force_by_tool=true", *words))
        self.assertAlmostEqual(found["stiffness"]["stiffness_N_per_m"] / 1000.0, 1.0, delta=EXACT)
        self.assertEqual(found["clock"]["rows_missing"], 0)
        self.assertEqual(found["columns"]["orientation"][0]["name"], "qw")
        for name in ("audit.json", "audit.svg", "audit.html"):
            self.assertTrue((scratch / "out" / name).is_file(), name)
        self.assertEqual(json.loads((scratch / "out" / "audit.json").read_text()), found)

    def test_the_log_of_the_renderer_has_usual_names(self):
        z = pressed(20)
        named = {
            "time_s": T * np.arange(len(z)),
            "fx_N": 0 * z,
            "fy_N": 0 * z,
            "fz_N": wall(z, 1000.0),
        }
        for of in "hp":  # columns of the renderer's log and of trajectory.csv
            log = named | {f"{of}x_m": 0 * z, f"{of}y_m": 0 * z, f"{of}z_m": z}
            found = audit(log)
            self.assertEqual(
                [column["name"] for column in found["columns"]["position"]],
                [f"{of}x_m", f"{of}y_m", f"{of}z_m"],
            )
            self.assertAlmostEqual(
                found["stiffness"]["stiffness_N_per_m"] / 1000.0, 1.0, delta=EXACT
            )

    def test_one_axis_and_usual_names(self):
        z = pressed(20)
        for names in (
            ("time_s", "position_m", "force_N"),
            ("t", "pos", "f"),
            ("Time [ms]", "position [mm]", "force [mN]"),
        ):
            factors = (1e3, 1e3, 1e3) if "[ms]" in names[0] else (1.0, 1.0, 1.0)
            columns = (T * np.arange(len(z)), z, wall(z, 1000.0))
            log = {name: factor * values for name, factor, values in zip(names, factors, columns)}
            spring = audit(log)["stiffness"]
            self.assertAlmostEqual(
                spring["stiffness_N_per_m"] / 1000.0, 1.0, delta=EXACT, msg=names
            )
        with self.assertRaisesRegex(InputError, "columns: force: no usual name"):
            audit({"t": T * np.arange(len(z)), "x": z, "load": z})
        with self.assertRaisesRegex(InputError, "--columns position=pz,force=fz"):
            audit({"t": T * np.arange(len(z)), "pz": z, "fz": z})
        with self.assertRaisesRegex(InputError, 'columns: force: got "f"'):
            audit(
                {"t": T * np.arange(len(z)), "pz": z, "fz": z},
                columns={"position": "pz", "force": "f"},
            )

    def test_a_clock_in_other_units_is_reported(self):
        z = pressed(20)
        for factor, is_reported in ((1.0, False), (1e-3, True)):
            log = {"t": factor * T * np.arange(len(z)), "x": z, "f": wall(z, 1000.0)}
            warned = " ".join(audit(log)["warnings"])
            self.assertEqual("in other units" in warned, is_reported, (factor, warned))

    def test_the_reason_is_of_the_contact_that_moves_furthest(self):
        # In the first contact, the position changes by only a few counts. In both contacts, the force has the wrong
        # sign.
        short, far = -4e-5 * np.hanning(40), -2e-3 * np.hanning(400)
        z = np.concatenate([np.full(60, 1e-4), short, np.full(60, 1e-4), far, np.full(60, 1e-4)])
        z = 2e-5 * np.round(z / 2e-5)
        log = {"t": T * np.arange(len(z)), "x": z, "f": -wall(z, 1000.0)}
        found = audit(log)
        self.assertIsNone(found["stiffness"])
        warned = " ".join(found["missing"])
        self.assertIn("grows along its own direction", warned)

    def test_command_and_function_agree(self):
        z = pressed(20)
        log = table(z, wall(z, 1000.0, 1.0), contacts=(z < 0.0).astype(float))
        scratch = scratch_folder(self)
        file = scratch / "log.csv"
        file.write_text(csv_text(log))
        by_command = json.loads(hapbench("audit", file, "--json", "--out", scratch / "out"))
        by_function = audit(log)
        for section in ("clock", "metrics", "energy", "stiffness", "diagnosis", "missing"):
            self.assertEqual(
                by_command[section], json.loads(json.dumps(by_function[section])), section
            )

    def test_files_of_a_failed_audit_are_those_of_the_earlier_audit(self):
        z = pressed(20)
        scratch = scratch_folder(self)
        file, out = scratch / "log.csv", scratch / "out"
        file.write_text(csv_text(table(z, wall(z, 1000.0))))
        hapbench("audit", file, "--quiet", "--out", out)
        earlier = [(out / name).read_bytes() for name in ("audit.json", "audit.svg")]
        (out / "audit.html").unlink()
        (out / "audit.html").mkdir()
        file.write_text(csv_text(table(z, wall(z, 2000.0))))
        error = hapbench("audit", file, "--quiet", "--out", out, expected=2)
        self.assertIn(str(out / "audit.html"), error)
        self.assertEqual(
            [(out / name).read_bytes() for name in ("audit.json", "audit.svg")], earlier
        )
        self.assertEqual(sorted(os.listdir(out)), ["audit.html", "audit.json", "audit.svg"])

    def test_expectations(self):
        z = pressed(20)
        scratch = scratch_folder(self)
        file = scratch / "log.csv"
        file.write_text(csv_text(table(z, wall(z, 1000.0, 1.0))))
        words = ("audit", file, "--quiet", "--out", scratch / "out", "--expect")
        hapbench(*words, "energy_mJ=1,stiffness_N_per_m=990:1010")
        done = ran(PROGRAM, *words, "stiffness_N_per_m=900,force_max_N=1e3")
        self.assertEqual(done.returncode, 3)
        self.assertIn("expected stiffness_N_per_m of at most 900, got 1000", done.stderr)
        self.assertNotIn("force_max_N", done.stderr)
        done = ran(PROGRAM, *words, "stiffness_of_limit=1")
        self.assertEqual((done.returncode, "no value" in done.stderr), (3, True))
        done = ran(PROGRAM, *words, "energy_mj=1")
        self.assertEqual(
            (done.returncode, 'nearest valid name: "energy_mJ"' in done.stderr), (2, True)
        )


class OwnRuns(unittest.TestCase):
    def test_numbers_are_those_of_the_summary(self):
        """Compares audit with the summary of a run: for an ideal device, for a handle on a device, and for a run with
        several landings."""
        scratch = scratch_folder(self)
        for scene in ("device_at_wall", "tap_wall", "impedance_at_wall"):
            run = scratch / scene
            hapbench("run", scene, "--quiet", "--out", run)
            summary = json.loads((run / "summary.json").read_text())
            found = json.loads(
                hapbench("audit", run / "trajectory.csv", "--json", "--out", scratch / "audit")
            )
            shared = set(found["metrics"]) & set(summary["metrics"])
            self.assertGreater(len(shared), 14)
            for name in sorted(shared):
                self.agree(scene, name, found["metrics"][name], summary, name)
            if scene == "device_at_wall":
                continue  # for a free virtual tool, run uses the mean velocity of a step
            # The tool does not rotate, so that moments do no work. All work is done by the force.
            created = summary["passivity"]["net_created_J"]
            self.assertAlmostEqual(
                found["energy"]["net_created_J"], created, delta=1e-9 + 1e-9 * created
            )

    def agree(self, scene, name, value, summary, metric):
        stated = summary["metrics"][metric]
        if stated is None or value is None:
            self.assertEqual(value, stated, (scene, name))
            return
        # Sums in another order round differently. For metrics from a histogram, the summary states a tolerance.
        within = 1e-9 * abs(stated) + summary["tolerances"].get(metric, 0.0) + 1e-12
        self.assertAlmostEqual(value, stated, delta=within, msg=(scene, name))


if __name__ == "__main__":
    unittest.main()
