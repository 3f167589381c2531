"""Tests how `hapbench audit` finds the columns and the axes of a log, and which logs and options it rejects."""
import json
import os
import re
import unittest

import numpy as np
from fixture import PROGRAM, hapbench, ran, scratch_folder

os.environ.setdefault("HAPBENCH_PROGRAM", str(PROGRAM))

from hapbench import InputError, audit  # noqa: E402  (finds the program in the environment)
from hapbench_audit.log import log_of_table  # noqa: E402

TIME = 0.001 * np.arange(1200)  # [s]
STIFFNESS = 800.0  # [N/m]
DEPTH = -1.5e-3 + 2e-3 * np.cos(25.0 * TIME)  # position along the normal; the wall is at 0 [m]
NORMAL = np.where(DEPTH < 0.0, -STIFFNESS * DEPTH, 0.0)  # [N]
ALONG, ACROSS = 1e-3 * np.sin(13.0 * TIME), -0.2 * NORMAL
ZERO = np.zeros(len(TIME))


def text_of(log):
    rows = zip(*(values.tolist() for values in log.values()))
    return "\n".join([",".join(log), *(",".join(map(repr, row)) for row in rows)]) + "\n"


def log(names, *columns):
    return dict(zip(names.split(","), (TIME, *columns)))


def names_of(found, quantity):
    return [part["name"] for part in found["columns"][quantity]]


class Axes(unittest.TestCase):
    def assert_planar(self, found, names):
        self.assertEqual(names_of(found, "position") + names_of(found, "force"), names)
        (warning,) = [one for one in found["warnings"] if "the log has the axes" in one]
        self.assertIn(f"--columns position={names[1]},force={names[3]}", warning)

    def test_a_planar_log_is_a_log_of_three_axes_with_zeros(self):
        """The work of a planar log is the sum over both axes. It equals the work of the log with columns of zeros."""
        of_plane = {
            "y": audit(log("t,x,y,z,fx,fy,fz", ALONG, DEPTH, ZERO, ACROSS, NORMAL, ZERO)),
            "z": audit(log("t,x,y,z,fx,fy,fz", ALONG, ZERO, DEPTH, ACROSS, ZERO, NORMAL)),
        }
        work = float(np.sum(NORMAL[:-1] * np.diff(DEPTH) + ACROSS[:-1] * np.diff(ALONG)))
        for names in ("t,x,y,fx,fy", "t,px,pz,fx,fz", "t,tip_x,tip_y,load_x,load_y"):
            first, whole = names.split(","), of_plane[names[-1]]
            given = {"position": first[1], "force": first[3]} if "tip" in names else {}
            for columns in (given, {"position": 2, "force": 4}):
                found = audit(log(names, ALONG, DEPTH, ACROSS, NORMAL), columns=columns)
                self.assert_planar(found, first[1:])
                self.assertAlmostEqual(found["energy"]["work_J"], work, delta=1e-12)
                for section in ("energy", "metrics", "stiffness"):
                    self.assertEqual(found[section], whole[section], (names, section))
                self.assertEqual(whole["warnings"], [])

    def test_velocities_of_a_planar_log_are_read(self):
        speeds = np.gradient(ALONG, TIME), np.gradient(DEPTH, TIME)
        planar = audit(log("t,px,pz,fx,fz,vx,vz", ALONG, DEPTH, ACROSS, NORMAL, *speeds))
        whole = audit(
            log(
                "t,px,py,pz,fx,fy,fz,vx,vy,vz",
                *(ALONG, ZERO, DEPTH, ACROSS, ZERO, NORMAL, speeds[0], ZERO, speeds[1]),
            )
        )
        self.assertEqual(names_of(planar, "velocity"), ["vx", "vz"])
        self.assertEqual(planar["stiffness"], whole["stiffness"])

    def test_a_quantity_with_a_row_that_is_no_number_is_named(self):
        """The warning has the first row, the number of rows and what the audit does without the quantity."""
        plain = log("t,px,pz,fx,fz", ALONG, DEPTH, ACROSS, NORMAL)
        without = audit(plain)
        file = scratch_folder(self) / "log.csv"
        for quantity, names, rows, text, consequence in (
            ("contacts", ("contacts",), range(len(TIME)), "False", "the force decides which rows"),
            ("contacts", ("contacts",), [41], "nan", "the force decides which rows"),
            ("velocity", ("vx", "vz"), [7, 41], "x", "differences of the positions"),
            ("measured", ("measured_x", "measured_z"), [5], "inf", "does not check whether"),
        ):
            lines = text_of(plain | dict.fromkeys(names, ZERO)).splitlines()
            for row in rows:
                lines[row + 1] = ",".join([*lines[row + 1].split(",")[:-1], text])
            file.write_text("\n".join(lines) + "\n")
            words = ("audit", file, "--json", "--out", file.parent / "out")
            found = json.loads(hapbench(*words))
            (warning,) = set(found["warnings"]) - set(without["warnings"])
            column = f"{4 + len(names) + 1} {names[-1]}"
            self.assertIn(
                f'{quantity}: line {rows[0] + 2}: got "{text}" in column {column}; rows without a '
                f"finite number: {len(rows)} of {len(TIME)}; ",
                warning,
            )
            self.assertIn(consequence, warning)
            self.assertNotIn(quantity, found["columns"])
            self.assertEqual(found["energy"], without["energy"])
        given = plain | {"contacts": np.where(TIME == TIME[9], np.nan, 1.0)}
        (warning,) = set(audit(given)["warnings"]) - set(without["warnings"])
        self.assertIn("contacts: row 10: got nan in column 6 contacts", warning)

    def test_one_axis_of_a_planar_log_can_be_named(self):
        planar = log("t,x,y,fx,fy", ALONG, DEPTH, ACROSS, NORMAL)
        for columns, position, force in (
            ({"position": "y", "force": "fy"}, DEPTH, NORMAL),
            ({"px": "x", "mfx": "fx"}, ALONG, ACROSS),
        ):
            found = audit(planar, columns=columns)
            work = float(np.sum(force[:-1] * np.diff(position)))
            self.assertAlmostEqual(found["energy"]["work_J"], work, delta=1e-12)
            self.assertEqual(len(found["columns_not_read"]), 2)

    def test_different_axes_of_position_and_force_are_refused(self):
        for names, option, count in (
            ("t,x,y,f", "py=y,mfy=f", 1),
            ("t,x,y,fx", "px=x,mfx=fx", 1),
            ("t,x,y,z,force", "pz=z,mfz=force", 1),
            ("t,x,y,fx,fy,fz", "px=x,py=y,mfx=fx,mfy=fy", 2),
            ("t,x,y,z,fx,fz", "px=x,pz=z,mfx=fx,mfz=fz", 2),
            ("t,x,z,fx,fy", "px=x,mfx=fx", 1),
        ):
            columns = [DEPTH if name[-1] in "xyz" else NORMAL for name in names.split(",")[1:]]
            with self.assertRaisesRegex(InputError, f"the same axes, as with --columns {option};"):
                audit(log(names, *columns))
            # The option of the message is accepted.
            given = dict(word.split("=") for word in option.split(","))
            found = audit(log(names, *columns), columns=given)
            self.assertEqual(len(found["columns"]["position"]), count)

    def test_a_log_without_times_names_the_rate(self):
        columns = ALONG, ZERO, DEPTH, ACROSS, ZERO, NORMAL
        for names in ("px,py,pz,fx,fy,fz", "dt,px,py,pz,fx,fy,fz"):
            given = dict(zip(names.split(",")[-6:], columns))
            if names.startswith("dt"):
                given = {"dt": 0.001 + ZERO} | given
            with self.assertRaises(InputError) as caught:
                audit(given)
            self.assertIn("--set sample_rate_Hz=", str(caught.exception))
            self.assertNotIn("position=", str(caught.exception))


class Contact(unittest.TestCase):
    def test_a_log_without_contact_is_refused(self):
        base = "t,x,y,z,fx,fy,fz"
        position, none = (ALONG, ZERO, DEPTH), (ZERO, ZERO, ZERO)
        still, pushed = position + none, position + (ZERO, ZERO, NORMAL)
        measured = "force_measured_x,force_measured_y,force_measured_z"
        for names, columns, touch, problem in (
            (base, still, None, "no row is in contact: every force is 0, in columns 5 fx, 6 fy"),
            (base, still, 0.0, "no row is in contact: every force is 0"),
            (base, pushed, 1e3, "the largest force is 2.8 N; allowed: a smaller touch_N, got 1000"),
            (f"{base},contacts", (*pushed, ZERO), None, "column 8 contacts.*--set touch_N=0 uses"),
            (
                f"{base},{measured}",
                (*still, ZERO, ZERO, NORMAL),
                None,
                "every force is 0.*--columns force=force_measured_x",
            ),
            (f"{base},contacts", (*still, 1.0 + ZERO), None, "no row has a force"),
        ):
            with self.assertRaisesRegex(InputError, problem):
                audit(log(names, *columns), touch=touch)

    def test_the_command_exits_with_status_2(self):
        file = scratch_folder(self) / "log.csv"
        file.write_text(text_of(log("t,x,fx", DEPTH, ZERO)))
        out = file.parent / "out"
        self.assertIn("no row is in contact", hapbench("audit", file, "--out", out, expected=2))
        self.assertFalse(out.exists())

    def test_further_quantities_have_the_units_of_their_names(self):
        speed = np.gradient(DEPTH, TIME)
        expected = log_of_table(
            dict(zip("t x f v".split(), (TIME, DEPTH, NORMAL, speed))), {}, {}, False, None
        )
        for velocity, factor in (
            ("v [mm/s]", 1e3),
            ("v_mm_per_s", 1e3),
            ("v_m_per_s", 1.0),
            ("v (um/s)", 1e6),
        ):
            names = ("t", "x", "f [mN]", velocity, "f_measured [N]")
            columns = (TIME, DEPTH, 1e3 * NORMAL, factor * speed, NORMAL)
            found = log_of_table(
                dict(zip(names, columns)),
                {"velocity": velocity, "measured": names[4]},
                {},
                False,
                None,
            )
            np.testing.assert_allclose(found.velocity, expected.velocity, rtol=1e-12)
            np.testing.assert_allclose(found.measured, found.force, rtol=1e-12)
        found = log_of_table(
            {**dict(zip("t x f".split(), (TIME, DEPTH, NORMAL))), "v [km/h]": speed},
            {"velocity": "v [km/h]"},
            {},
            False,
            None,
        )
        self.assertIn('the unit "km/h" of column', "".join(found.notes))

    def test_a_point_is_not_a_decimal_sign_among_decimal_commas(self):
        file, millinewtons = scratch_folder(self) / "log.csv", (1e3 * NORMAL).round().astype(int)
        lines = [f"{t:.3f};{x:.6f}".replace(".", ",") for t, x in zip(TIME, DEPTH)]

        def written(number):
            rows = (f"{line};{number(f)};{number(f)}" for line, f in zip(lines, millinewtons))
            file.write_text("\n".join(["t;x;f [mN];velocity", *rows, ""]))
            return ["audit", file, "--out", file.parent / "out"]

        words = written(lambda number: f"{number:,}".replace(",", "."))
        self.assertIn("the point may separate thousands", hapbench(*words, expected=2))
        hapbench(*written(str))
        # A further quantity is left out, and the message names the cell.
        file.write_text(file.read_text().replace(";velocity", ";load"))
        file.write_text(re.sub(r"(?m)^0,500;(.*);.*$", r"0,500;\1;1.200", file.read_text()))
        done = ran(PROGRAM, *words, "--columns", "velocity=load")
        self.assertIn('velocity: line 502: got "1.200" in column 4 load', done.stderr)
        self.assertIn("the audit does not use this quantity", done.stderr)
        self.assertIn("the point may separate thousands", done.stderr)

    def test_a_few_rows_in_contact_are_audited(self):
        for rows in ([300], [300, 301], [300, 700], [0], [len(TIME) - 1]):
            force = ZERO.copy()
            force[rows] = 1.0
            found = audit(log("t,x,f", DEPTH, force))
            self.assertIsNone(found["stiffness"])
            self.assertEqual(sum(one["rows"] for one in found["contacts"]), len(rows))
        file = scratch_folder(self) / "log.csv"
        file.write_text(text_of(log("t,x,f", DEPTH, force)))
        written = file.parent / "out" / "audit.json"
        hapbench("audit", file, "--out", written.parent, "--device", "touch")
        self.assertEqual(len(json.loads(written.read_text())["contacts"]), 1)


class Tables(unittest.TestCase):
    """Tables of hapbench.audit(), whose columns are arrays of any type."""

    TABLE = {"t": TIME, "position": DEPTH, "force": NORMAL}

    def test_arrays_of_other_types_are_read(self):
        expected = audit(self.TABLE | {"contacts": (NORMAL > 0.0).astype(int)})
        start = np.datetime64("2026-11-30T12:00:00")
        times = start + np.rint(1e9 * TIME).astype("timedelta64[ns]")
        for changed in (
            {"contacts": NORMAL > 0.0},
            {"position": DEPTH.astype(object)},
            {"force": [repr(float(value)) for value in NORMAL]},
            {"t": times},
        ):
            found = audit(self.TABLE | {"contacts": NORMAL > 0.0} | changed)
            self.assertEqual(found["contact_rule"], expected["contact_rule"])
            self.assertEqual(found["columns"], expected["columns"])
            for name in ("contacts", "landings", "force_max_N"):
                self.assertEqual(found["metrics"][name], expected["metrics"][name], changed.keys())
        vectors = {"position": np.column_stack([ZERO, ZERO, DEPTH])}
        vectors["load"] = np.column_stack([ZERO, ZERO, NORMAL])
        found = audit({"t": TIME} | vectors, columns={"force": "load"})
        self.assertEqual(names_of(found, "force"), ["load_x", "load_y", "load_z"])
        self.assertEqual(found["energy"]["work_J"], audit(self.TABLE)["energy"]["work_J"])

    def test_a_column_that_cannot_be_read_is_named(self):
        four = np.zeros((len(TIME), 4))
        for name, values, problem in (
            ("position", four, r"column position: got shape \(1200, 4\); allowed: one column"),
            ("force", ["a"] * len(TIME), "column force: got no numbers; allowed: numbers"),
            ("t", TIME + 0j, "column t: got complex128 values; allowed: numbers"),
        ):
            with self.assertRaisesRegex(InputError, problem):
                audit(self.TABLE | {name: values})
        found = audit(self.TABLE | {"velocity": four, "label": ["a"] * len(TIME)})
        self.assertEqual(found["columns_not_read"], ["velocity", "label"])
        (warning,) = found["warnings"]
        self.assertIn("column velocity: got shape (1200, 4)", warning)

    def test_masked_and_missing_values_are_no_numbers(self):
        hidden = np.arange(len(TIME)) % 100 == 7
        masked = np.ma.masked_array(np.where(hidden, 9.0, NORMAL), mask=hidden)
        absent = NORMAL.astype(object)
        absent[hidden] = None
        for force in (masked, absent):
            with self.assertRaisesRegex(
                InputError, "row 8: .*force: got nan; .*leave such rows out"
            ):
                audit(self.TABLE | {"force": force})
            found = audit(self.TABLE | {"measured": force})
            self.assertIn("measured: row 8: got nan in column 4", " ".join(found["warnings"]))


class Values(unittest.TestCase):
    def test_options_without_effect_and_shared_columns_are_refused(self):
        file = scratch_folder(self) / "log.csv"
        file.write_text(text_of(log("t,x,f,v", DEPTH, NORMAL, ZERO)))
        for option, word, problem in (
            ("--set", "held_rows=thin", "--set held_rows: has no effect"),
            ("--set", "tip_axis=1,0,0", "--set tip_axis: has no effect"),
            ("--columns", "measured=f", "columns: measured: column 3 f is also named for force"),
            ("--columns", "velocity=2", "velocity: column 2 x is also named for position"),
            ("--columns", "velocity=v,measured=v", "column 4 v is also named for velocity"),
        ):
            words = ("audit", file, option, word, "--out", file.parent / "out")
            self.assertIn(problem, hapbench(*words, expected=2))
        # A column that the user names for another quantity is not read by its usual name.
        found = audit(log("t,v,f", DEPTH, NORMAL), columns={"position": "v"})
        self.assertNotIn("velocity", found["columns"])

    def test_the_number_of_columns_is_that_of_the_file(self):
        file = scratch_folder(self) / "log.csv"
        text = text_of(log("t,x,f", DEPTH, NORMAL))
        for line, count in (("end 1", 2), ("1,2,3,0,0,0,0", 7)):
            file.write_text(text + line.replace(" ", ",") + "\n")
            error = hapbench("audit", file, "--out", file.parent / "out", expected=2)
            self.assertIn(f"got {count} values; allowed: 3", error)

    def test_impossible_values_are_refused(self):
        file = scratch_folder(self) / "log.csv"
        file.write_text(text_of(log("t,x,f", DEPTH, NORMAL)))
        for option, word, problem in (
            ("--expect", "energy_mJ=2:1", '"energy_mJ=2:1", a minimum above the maximum'),
            ("--set", "max_speed=-1", "max_speed: got -1; allowed: a number > 0"),
            ("--set", "max_gap=0", "max_gap: got 0; allowed: a number > 0"),
            ("--set", "max_speed=true", "max_speed: got true; allowed: a number > 0"),
        ):
            out = file.parent / "out"
            self.assertIn(problem, hapbench("audit", file, option, word, "--out", out, expected=2))


if __name__ == "__main__":
    unittest.main()
