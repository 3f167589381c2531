"""Tests how `import stroke` reads headers: units in names and in comments, orientations that are not named, and lines
that are neither a header nor a sample."""
import re

import numpy as np
from scipy.spatial.transform import Rotation

from recordings import Given, moved, table

from hapbench_import.columns import unclear_unit, unit_in, without_unit

TIME = 0.002 * np.arange(80)
METRES = moved(TIME)
MILLIMETRES = 1e3 * METRES
BY_NAME = "time=t,position=x"


def rows(positions, time=TIME):
    return table("", time, positions)


class Headers(Given):
    def assert_metres(self, data, columns=BY_NAME, warned="", **options):
        stroke, found = self.report(data, columns, **options)
        np.testing.assert_allclose(stroke.position, METRES, atol=1e-9)
        self.assertIn(warned, "\n".join(found["warnings"]))
        return found

    def test_units_in_comments_are_those_of_the_columns(self):
        for header in (
            "% t,x,y,z\n% s,mm,mm,mm\n",
            "# t x y z\n#\n# [s] [mm] [mm] [mm]\n",
            "t,x,y,z\n% s,mm,mm,mm\n",
            "% s,mm,mm,mm\nt,x,y,z\n",
            "% t,x,y,z\ns,mm,mm,mm\n",
            "# Units: s,mm,mm,mm\nt,x,y,z\n",
        ):
            found = self.assert_metres(header + rows(MILLIMETRES), warned="has the units of the")
            self.assertEqual(found["scales"]["position"], 0.001, header)

    def test_names_that_are_only_units(self):
        only = "% s,mm,mm,mm\n" + rows(MILLIMETRES)
        self.assertIn('got "t"; the file has 1 [s], 2 [mm], 3 [mm]', self.refusal(only, BY_NAME))
        self.assertIn("two columns are named", self.refusal(only, "time=s,position=mm"))
        for columns in ("time=1,position=2", "time=s,position=2"):
            self.assert_metres(only, columns)

    def test_another_header_line_is_named(self):
        data = "% t,x,y,z\n% time,tip x,tip y,tip z\n" + rows(METRES)
        self.assertIn("line 1 has this name", self.refusal(data, BY_NAME))
        self.assert_metres(data, "time=time,position=tip x")

    def test_units_in_names_are_read(self):
        for name in (
            "x mm|x<mm>|x{mm}|x-mm|x:mm|x, mm|x/mm|x_mm|x [mm]|x (mm)|x (mm) raw|x [mm] raw|max_mm"
        ).split("|"):
            unit = without_unit(name)[1]
            self.assertEqual(unit and unit.text, "mm", name)
        for name in "x|q[0]|r<0>|tip[x]|x 1|x raw|comm|x cm|xmm|x_m|pose.position.x".split("|"):
            self.assertIsNone(without_unit(name)[1], name)
        for form in ("{} mm", "{}<mm>", "{}{{mm}}", "{}-mm", "{}:mm", "{} (mm) raw"):
            names = ";".join(["t", *(form.format(axis) for axis in "xyz")])
            data = table(names, TIME, MILLIMETRES, separator=";")
            first = "x raw" if "raw" in form else "x"
            self.assert_metres(data, f"time=t,position={first}")

    def test_names_that_may_have_a_unit_cause_a_warning(self):
        for quantity, names in (
            (
                "position",
                "xMM x_Mm x_MM xcm xmm tipXmm posmm mm_x x_mm_raw x_cm x.mm x_in hip_xcm xum cm_x",
            ),
            ("time", "tms timems ms_since_start stamp_us_utc T_MS"),
            ("force", "fxmN force_mN_raw fx_MN forcemN lbf_x"),
        ):
            for name in names.split():
                self.assertIsNotNone(unclear_unit(quantity, name), name)
        self.assertIsNotNone(unclear_unit("position", "x cm"))

    def test_ordinary_names_cause_no_warning(self):
        for quantity, names in (
            (
                "position",
                "x px xm x_m comm summ gamma_x com_x tip_in_base_x in_x xin position posx p_x mm cm zoom drum alum "
                "medium pose.position.x x_minimum ecm_x pos0 hip_x",
            ),
            (
                "time",
                "t times items stamp timestamp header.stamp.secs time_s stamp.nsecs rosbagTimestamp ms",
            ),
            ("force", "fx f fn f_n force forces force_norm fx_N wrench.force.x"),
        ):
            for name in names.split():
                self.assertIsNone(unclear_unit(quantity, name), name)

    def test_a_unit_that_is_not_read_is_reported_with_its_scale(self):
        slow = 0.05 * MILLIMETRES  # slow enough that no jump is rejected
        for header, warning in (
            (
                "t,xMM,yMM,zMM",
                "column 2 xMM is read as m; if its name says MM, --scale position=0.001",
            ),
            ("t,x_mm_raw,y_mm_raw,z_mm_raw", "if its name says mm, --scale position=0.001"),
            ("t,mm_x,mm_y,mm_z", "if its name says mm, --scale position=0.001"),
            ("t,xcm,ycm,zcm", "if its name says cm, --scale position=0.01"),
            ("# units: mm\nt,x,y,z", "line 1 states the unit mm, but column 2 x is read as m"),
            ("# x, y and z in mm\nt,x,y,z", "line 1 states the unit mm"),
        ):
            first = header.rpartition("\n")[2].split(",")[1]
            _, found = self.report(f"{header}\n{rows(slow)}", f"time=t,position={first}")
            self.assertIn(warning, "\n".join(found["warnings"]))
        for header in ("# recorded in May\nt,x,y,z", "# units: m, s\nt,x,y,z"):
            _, found = self.report(f"{header}\n{rows(METRES)}", BY_NAME)
            self.assertEqual(found["warnings"], ["1 comment line skipped, the first: line 1"])

    def test_a_unit_of_one_column_is_applied_to_the_others_with_a_warning(self):
        warning = (
            "columns 3 y, 4 z have no unit and are read in mm, the unit of column 2 x [mm] (--scale position=0.001 "
            "confirms this; --scale position=1 reads the position in m)"
        )
        for header in ("t,x [mm],y,z\n", "t,x,y,z\n,mm,,\n", "# ,mm,-,\nt,x,y,z\n"):
            data = header + rows(MILLIMETRES)
            found = self.assert_metres(data, warned=warning)
            self.assertEqual(found["scales"]["position"], 0.001)
            found = self.assert_metres(data, scale="position=0.001")
            self.assertNotIn("have no unit", "\n".join(found["warnings"]))
            found = self.assert_metres(header + rows(METRES), scale="position=1")
            self.assertIn("column 2 x [mm] says mm", "\n".join(found["warnings"]))
        _, found = self.report("t,x,y,z [mm]\n" + rows(MILLIMETRES), BY_NAME)
        self.assertIn("columns 2 x, 3 y have no unit", found["warnings"][0])
        _, found = self.report("t,x [mm],y [mm],z\n" + rows(MILLIMETRES), BY_NAME)
        self.assertIn("column 4 z has no unit and is read in mm", found["warnings"][0])
        # Metres are the default.
        self.assertEqual(
            self.report("t [s],x [m],y,z\n" + rows(METRES), BY_NAME)[1]["warnings"], []
        )

    def test_mega_is_not_milli(self):
        for quantity, text, unit in (
            ("force", "MN", None),
            ("force", "mN", "mN"),
            ("force", "KN", "kn"),
            ("position", "Mm", None),
            ("position", "MM", "mm"),
            ("time", "Ms", None),
            ("time", "SEC", "sec"),
            ("angle", "Mrad", None),
        ):
            self.assertEqual(unit_in(quantity, text), unit, text)
        columns = f"{BY_NAME},force=fx [MN]"
        data = table("t,x,y,z,fx [MN],fy [MN],fz [MN]", TIME, METRES, METRES)
        self.assertIn(
            'the unit "MN" is unknown (it begins with mega; mn begins with milli): give the unit with --scale force',
            self.refusal(data, columns),
        )
        self.assertEqual(self.report(data, columns, scale="force=1e6")[1]["scales"]["force"], 1e6)

    def test_an_orientation_that_is_not_named_is_not_dropped_silently(self):
        turns = Rotation.from_rotvec(np.column_stack([0.3 + TIME, 0.5 - TIME, 0.8 + 0 * TIME]))
        xyzw = turns.as_quat()
        wxyz = np.roll(xyzw, 1, axis=1)
        for names, values in (
            ("qw,qx,qy,qz", wxyz),
            ("qx,qy,qz,qw", xyzw),
            ("orientation.x,orientation.y,orientation.z,orientation.w", xyzw),
        ):
            data = table(f"t,x,y,z,{names}", TIME, METRES, values)
            stroke, found = self.report(data, BY_NAME)
            down = [0, 0, -1]
            np.testing.assert_allclose(stroke.turn.apply(down), turns.apply(down), atol=1e-6)
            self.assertIn("the orientation is read from the columns", found["warnings"][0])
            stroke, found = self.report(data, BY_NAME, orientation="none")
            self.assertEqual((stroke.has_roll, found["warnings"]), (False, []))
        for names, values in (
            ("object_qw,object_qx,object_qy,object_qz", wxyz),
            ("axis_x,axis_y,axis_z", turns.apply([0, 0, 1])),
            ("roll,pitch,yaw", turns.as_euler("xyz")),
        ):
            data = table(f"t,x,y,z,{names}", TIME, METRES, values)
            stroke, found = self.report(data, BY_NAME)
            self.assertFalse(stroke.has_roll)
            self.assertIn("so the tool does not rotate", "\n".join(found["warnings"]))

    def test_every_usual_name_of_an_orientation_is_reported(self):
        turns = Rotation.from_rotvec(np.column_stack([0.3 + TIME, 0.5 - TIME, 0.8 + 0 * TIME]))
        xyzw, vectors = turns.as_quat(), turns.as_rotvec()
        wxyz, angles = np.roll(xyzw, 1, axis=1), np.linalg.norm(vectors, axis=1, keepdims=True)
        with_angle = np.column_stack([vectors / angles, angles])
        matrices = turns.as_matrix().reshape(-1, 9)
        for names, values in (
            ("q0,q1,q2,q3", wxyz),
            ("q1,q2,q3,q4", wxyz),
            ("tool.q[0],tool.q[1],tool.q[2],tool.q[3]", wxyz),
            ("qi,qj,qk,qr", xyzw),
            ("quat_r,quat_x,quat_y,quat_z", wxyz),
            ("ax,ay,az,angle", with_angle),
            ("axis_x,axis_y,axis_z,theta", with_angle),
            ("R11,R12,R13,R21,R22,R23,R31,R32,R33", matrices),
            ("tip.axis.x,tip.axis.y,tip.axis.z", -turns.as_matrix()[:, :, 2]),
            ("rx [deg],ry [deg],rz [deg]", None),
            ("rx_deg,ry_deg,rz_deg", None),
            ("toolRx,toolRy,toolRz", None),
            ("euler_x,euler_y,euler_z", None),
            ("Roll,Pitch,Yaw", None),
            ("alpha,beta,gamma", None),
        ):
            data = table(f"t,x,y,z,{names}", TIME, METRES, vectors if values is None else values)
            stroke, found = self.report(data, BY_NAME)
            warning = "\n".join(found["warnings"])
            first = names.split(",")[0]
            self.assertIn(f"the file has an orientation, 5 {first}, 6 ", warning)
            self.assertIn("so the tool does not rotate", warning)
            self.assertFalse(stroke.has_roll)
            self.assertEqual(self.report(data, BY_NAME, orientation="none")[1]["warnings"], [])
            if values is None:
                self.assertRegex(warning, "convert .* into a quaternion")
                continue
            # The remedy works.
            words = re.search(r"\(--columns (\S+)(?: --orientation (\S+))? reads it", warning)
            options = {"orientation": words[2]} if words[2] else {}
            stroke, _ = self.report(data, f"{BY_NAME},{words[1]}", **options)
            down = [0, 0, -1]
            np.testing.assert_allclose(stroke.turn.apply(down), turns.apply(down), atol=1e-6)
        # Joint angles, accelerations, rates and lengths are no orientation.
        for names in (
            "q1,q2,q3,q4,q5",
            "ax,ay,az",
            "roll_rate,yaw_rate",
            "rx [mm],ry [mm],rz [mm]",
        ):
            values = np.zeros((len(TIME), names.count(",") + 1))
            _, found = self.report(table(f"t,x,y,z,{names}", TIME, METRES, values), BY_NAME)
            self.assertEqual(found["warnings"], [])
        data = table("t,rx,ry,rz", TIME, METRES)
        self.assertEqual(self.report(data, "time=t,position=rx")[1]["warnings"], [])

    def test_a_line_break_in_a_quoted_cell(self):
        notes = ['"touch\n# and\npress"' if i in (7, 20) else '"5"' for i in range(len(TIME))]
        lines = rows(METRES).splitlines()
        data = "t,x,y,z,note\n" + "".join(f"{a},{b}\n" for a, b in zip(lines, notes))
        found = self.assert_metres(data, warned="2 quoted cells with a line break read as one cell")
        self.assertIn("the first: line 9", "\n".join(found["warnings"]))
        # An inch sign does not begin a quoted cell.
        data = "t,x,y,z,note\n" + "".join(f'{line},pipe 5"\n' for line in lines)
        self.assertEqual(self.assert_metres(data)["rows_read"], len(TIME))

    def test_times_of_day_over_midnight(self):
        def clock(time):
            of_day = (86399.9 + time) % 86400
            hours, minutes = of_day // 3600, of_day % 3600 // 60
            return f"{hours:02.0f}:{minutes:02.0f}:{of_day % 60:06.3f}"

        cells = [line.split(",", 1)[1] for line in rows(METRES).splitlines()]
        lines = [f"{clock(time)},{cell}\n" for time, cell in zip(TIME, cells)]
        found = self.assert_metres(
            "t,x,y,z\n" + "".join(lines), warned="line 52: the clock passes midnight"
        )
        self.assertAlmostEqual(found["duration_s"], TIME[-1], delta=1e-6)
        # A time that only decreases is a bad row.
        lines[10], lines[11] = lines[11], lines[10]
        self.assertIn(
            "allowed: increasing times", self.refusal("t,x,y,z\n" + "".join(lines), BY_NAME)
        )

    def test_a_row_of_column_numbers(self):
        for numbers in ("1,2,3,4", "0,1,2,3"):
            found = self.assert_metres(
                f"t,x,y,z\n{numbers}\n{rows(METRES)}",
                warned="line 2 has the numbers of the columns",
            )
            self.assertEqual(found["rows_read"], len(TIME))
        whole = "t,x,y,z\n" + "".join(f"{i},{i + 1},{i + 2},{i + 3}\n" for i in range(1, 9))
        self.assertEqual(self.report(whole, BY_NAME, max_speed=1e9, max_gap=9)[1]["rows_read"], 8)

    def test_the_span_of_the_positions(self):
        slow = 2e-3 * np.arange(80)
        for span, is_reported in ((0.6, False), (0.9, False), (1.2, True), (8.0, True)):
            positions = np.column_stack([np.linspace(0.0, span, 80), 0 * slow, 0 * slow])
            _, found = self.report(table("t,x,y,z", 20 * slow, positions), BY_NAME)
            warned = "unusual for a hand" in "\n".join(found["warnings"])
            self.assertEqual(warned, is_reported, span)
