"""Tests `import stroke` with recordings of other programs: columns, texts, units, clocks and held rows."""
import re
from datetime import datetime, timedelta
from types import SimpleNamespace

import numpy as np
from scipy.spatial.transform import Rotation

from recordings import Given, moved, table

from hapbench_identify.log import read_log


class Layouts(Given):
    """Tests that recordings of other programs are read with their intended meaning. Unclear recordings must be refused
    or cause a note."""

    TIME = 0.002 * np.arange(100)
    POSITIONS = moved(TIME)
    TURNS = Rotation.from_rotvec(
        np.column_stack([0.3 + 0.2 * np.sin(6 * TIME), 0.5 + 0 * TIME, 0.8 + 0.1 * TIME])
    )
    PLAIN = table("t,x,y,z", TIME, POSITIONS)

    def columns(self, found, quantity):
        return [part["column"] for part in found["columns"][quantity]]

    def assert_positions(self, data, columns="time=t,position=x", positions=POSITIONS, **options):
        stroke, found = self.report(data, columns, **options)
        np.testing.assert_allclose(stroke.position, positions, atol=1e-9)
        return "\n".join(found["warnings"]), found

    def assert_tip(self, data, columns, warned="", **options):
        """Asserts that the imported tool points in the direction of TURNS, and that the warnings contain the text
        `warned`. If `warned` is empty, asserts that there are no warnings."""
        stroke, found = self.report(data, f"time=t,position=x,{columns}", **options)
        down = [0, 0, -1]
        np.testing.assert_allclose(stroke.turn.apply(down), self.TURNS.apply(down), atol=1e-6)
        self.assertIn(warned, "\n".join(found["warnings"]))
        self.assertEqual(bool(warned), bool(found["warnings"]), found["warnings"])

    def test_components_are_found_by_their_names(self):
        t, (x, y, z) = self.TIME, self.POSITIONS.T
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
            warned, found = self.assert_positions(table(names, t, *columns), f"{time},{given}")
            self.assertEqual(self.columns(found, "position"), expected, names)
            self.assertEqual(warned, "")
        self.assertEqual(
            self.report(table("t,x,vx,y,vy,z,vz", t, x, t, y, t, z, t), "time=t,position=x")[1][
                "columns_not_read"
            ],
            ["3 vx", "5 vy", "7 vz"],
        )

    def test_columns_that_the_names_do_not_decide_are_refused(self):
        turned = table("t,x,y,z,q0,q1,q2,q3", self.TIME, self.POSITIONS, self.TURNS.as_quat())
        for data, columns, problem in (
            (
                table("t,a,b,c", self.TIME, self.POSITIONS),
                "position=a",
                'do not say which columns go with "a"; allowed: px=...,py=...,pz=..., or position=2 for',
            ),
            (self.PLAIN, "position=y", "not its first component by name; allowed: position=x"),
            (self.PLAIN, "position=x,px=x", "its columns are given by position and by px"),
            (self.PLAIN, "position=x,force=x", "column 2 x is also named for position"),
            (turned, "position=x,orientation=q0", "--orientation is missing; allowed: axis, quat_"),
            (turned, "position=x,orientation=5", "--orientation is missing"),
            (turned, "position=x,qw=q3,qx=q0", "qy: is missing; --columns names other"),
        ):
            self.assertIn(problem, self.refusal(data, f"time=t,{columns}"))
        self.assertIn(
            "allowed: one of them",
            self.refusal(self.PLAIN, "time=t,position=x", set="sample_rate_Hz=500"),
        )

    def test_a_number_takes_what_follows_and_reports_the_order_by_names(self):
        data = table("t,x,vx,y,z", self.TIME, self.POSITIONS[:, [0, 0, 1, 2]])
        _, found = self.report(data, "time=1,position=2")
        self.assertEqual(self.columns(found, "position"), [2, 3, 4])
        self.assertIn("by their names the order would be 2 x, 4 y, 5 z", found["warnings"][0])

    def test_a_quaternion_is_read_by_the_names_of_its_columns(self):
        xyzw = self.TURNS.as_quat()
        last = table("t,x,y,z,qx,qy,qz,qw", self.TIME, self.POSITIONS, xyzw)
        first = table("t,x,y,z,qw,qx,qy,qz", self.TIME, self.POSITIONS, np.roll(xyzw, 1, axis=1))
        self.assert_tip(last, "orientation=qx")
        self.assert_tip(first, "orientation=qw")
        self.assert_tip(first, "orientation=qx")
        self.assert_tip(last, "qw=qw,qx=qx,qy=qy,qz=qz")
        self.assert_tip(last, "orientation=5", orientation="quat_xyzw")
        # The option orientation contradicts the order in the names of the columns.
        contradicted = "was read by the names of its columns (qx, qy, qz, qw)"
        self.assert_tip(last, "orientation=qx", contradicted, orientation="quat_wxyz")
        self.assertIn(
            "by their names the order would be 8 qw, 5 qx, 6 qy, 7 qz",
            self.report(last, "time=t,position=x,orientation=5", orientation="quat_wxyz")[1][
                "warnings"
            ][0],
        )
        self.assertIn(
            "their names say otherwise",
            self.report(last, "time=t,position=x,qw=qx,qx=qy,qy=qz,qz=qw")[1]["warnings"][0],
        )
        # With --orientation none, columns for an orientation are refused.
        for columns in ("orientation=qx", "qw=qw,qx=qx,qy=qy,qz=qz"):
            self.assertIn(
                "is not used: --orientation none takes no columns",
                self.refusal(last, f"time=t,position=x,{columns}", orientation="none"),
            )

    def test_other_orientations_are_read_by_their_names(self):
        vector = self.TURNS.as_rotvec()
        angle = np.linalg.norm(vector, axis=1)
        turn = (self.TIME, self.POSITIONS, vector / angle[:, None])
        self.assert_tip(table("t,x,y,z,ax,ay,az,angle", *turn, angle), "orientation=ax")
        degrees = np.degrees(angle)
        self.assert_tip(table("t,x,y,z,ax,ay,az,angle [deg]", *turn, degrees), "orientation=ax")
        for values, scale, warning in (
            (degrees, "1", "look like degrees"),
            (angle, "0.0174533", "look like radians"),
        ):
            _, found = self.report(
                table("t,x,y,z,ax,ay,az,angle", *turn, values),
                "time=t,position=x,orientation=ax",
                scale=f"angle={scale}",
            )
            self.assertIn(warning, found["warnings"][0])
        cells = self.TURNS.as_matrix()
        by_columns = cells.transpose(0, 2, 1).reshape(-1, 9)
        names = "t,x,y,z,r11,r21,r31,r12,r22,r32,r13,r23,r33"
        self.assert_tip(table(names, self.TIME, self.POSITIONS, by_columns), "orientation=r11")

    def test_texts_of_every_program_are_the_same_numbers(self):
        comma = self.PLAIN.replace(",", ";").replace(".", ",")
        quoted = table('"t","x","y","z"', self.TIME, self.POSITIONS, number='"%.9g"')
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
            ("# t x y z\n" + self.PLAIN.partition("\n")[2].replace(",", "\t"), ""),
            ("# made by hand\n#" + self.PLAIN, "1 comment line skipped, the first: line 1"),
            (self.PLAIN.replace("\n", ",\n"), "a separator at the end of every line ignored"),
            (self.PLAIN.replace("\n", ",\n").replace("z,", "z"), "at the end of 100 lines ignored"),
            (self.PLAIN.replace("z", "z,"), "a separator at the end of the header ignored"),
        ):
            warning, _ = self.assert_positions(data)
            self.assertIn(warned, warning)
            self.assertEqual(bool(warned), bool(warning), warning)
        bare = comma.partition("\n")[2]
        self.assert_positions(bare, "time=1,position=2")
        self.assertEqual(self.assert_positions(comma, decimal="comma")[0], "")

    def test_headers_of_several_lines_are_read(self):
        rows = self.PLAIN.partition("\n")[2]
        tabs = rows.replace(",", "\t")
        below = "the names of columns are those of line"
        for data, columns, warning in (
            ("Time,Tip,Tip,Tip\n" + self.PLAIN, "time=t,position=x", f"{below} 2"),
            (",Tip,Tip,Tip\n,pos,pos,pos\n" + self.PLAIN, "time=t,position=x", f"{below} 3"),
            (
                "Version,1.23,Rate,500\n\n,Body,Body,Body\n,Tip,Tip,Tip\nTime (Seconds),X,Y,Z\n"
                + rows,
                "time=Time,position=X",
                f"lines 3 ... 5 are the header: {below} 5",
            ),
            (
                "LabVIEW Measurement\t\nWriter_Version\t2\n***End_of_Header***\t\n\nChannels\t3\t\t\t\n"
                f"***End_of_Header***\t\t\t\t\nX_Value\tx\ty\tz\tComment\n{tabs}",
                "time=X_Value,position=x",
                "column 5 Comment has no value in 100 lines, the first: line 8",
            ),
            (
                "t;x;y;z;Comment\n" + rows.replace(",", ";").replace("\n", ";begin\n", 1),
                "time=t,position=x",
                "has no value in 99 lines, the first: line 3",
            ),
            ('"t" "x" "y" "z"\n' + rows.replace(",", " "), "time=t,position=x", ""),
            (self.PLAIN.replace("\n0.1,", "\n,,,\n0.1,"), "time=t,position=x", ""),
        ):
            warned, _ = self.assert_positions(data, columns)
            self.assertIn(warning, warned)
            self.assertEqual(bool(warning), bool(warned), warned)
        # The header has two lines: groups and components. In each line, a name occurs several times. The name of a
        # column therefore joins the names of both lines.
        named = "Tip,Tip,Tip,Hand,Hand,Hand\nx,y,z,x,y,z\n"
        data = (
            "Time,"
            + named.replace("\n", "\n,", 1)
            + "\n".join(f"{row},1,1,1" for row in rows.splitlines())
        )
        warned, found = self.assert_positions(data, "time=Time,position=Tip")
        self.assertIn('join them, as in "Hand.z"', warned)
        self.assertEqual(self.columns(found, "position"), [2, 3, 4])
        # For an unknown unit, the message requests the option --scale.
        self.assertIn(
            'the unit "counts" is unknown: give the unit with --scale position=...',
            self.refusal("t,x,y,z\ns,counts,counts,counts\n" + rows, "time=t,position=x"),
        )
        # A header of several lines needs numbers below it. Otherwise only the first line is a header.
        self.assertIn(
            'line 2: column 1 t: got "a"; allowed: a finite number',
            self.refusal("t,x,y,z\na,b,c,d\ne,f,g,h\n", "time=t,position=x"),
        )
        self.assertIn(
            'line 2: column 1 t: got "NA"',
            self.refusal("t,x,y,z\nNA,NA,NA,NA\n" + rows, "time=t,position=x"),
        )

    def test_what_is_no_text_is_named(self):
        wide = self.PLAIN.encode("utf-16-le")
        for data, warning in (
            (wide, "the text is UTF-16; it was read as such"),
            (self.PLAIN.encode("utf-16-be"), "the text is UTF-16"),
            (self.PLAIN.encode("utf-32"), "the text is UTF-32"),
            (("# 3 µm\n" + self.PLAIN).encode("cp1252"), "not UTF-8; it was read as Windows-1252"),
            (self.PLAIN.encode() + b"\0\0\0", "3 bytes after the text ignored (zero)"),
            (self.PLAIN.encode() + b"\x1a", "1 byte after the text ignored (Ctrl-Z"),
        ):
            self.assertIn(warning, self.assert_positions(data)[0])
        units = table("t [µs],x [µm],y [µm],z [µm]", 1e6 * self.TIME, 1e6 * self.POSITIONS)
        self.assert_positions(units.encode("cp1252"))
        for data, warning in (
            (
                b"\x1f\x8b\x08",
                "rec.csv: is compressed (gzip), not a text; allowed: a text, such as CSV",
            ),
            (b"PK\x03\x04", "a workbook .xlsx"),
            (b"\x89HDF\r\n", "an HDF5 file"),
            (b"#ROSBAG V2.0\n", "a ROS bag"),
            (
                self.PLAIN.encode() + b"\0\1\2" + self.PLAIN.encode(),
                "line 102: has a zero byte, so the file is not a text",
            ),
            (
                self.PLAIN.replace(",", "|"),
                'got "t"; allowed between columns: commas, semicolons, tabs or blanks',
            ),
        ):
            self.assertIn(warning, self.refusal(data, "time=t,position=x"))

    def test_clocks_in_two_columns_counters_and_days(self):
        log = "header.stamp.secs,header.stamp.nsecs,x,y,z\n" + "".join(
            f"{1764288000 + (2 * i) // 1000},{(2 * i) % 1000 * 10**6},{','.join(map(str, row))}\n"
            for i, row in enumerate(self.POSITIONS.tolist())
        )
        for names in (
            "stamp_sec,stamp_nanosec",
            "sec,nsec",
            "header.stamp.secs,header.stamp.nsecs",
        ):
            stroke, found = self.report(
                log.replace("header.stamp.secs,header.stamp.nsecs", names, 1),
                f"time={names.partition(',')[0]},position=x",
            )
            np.testing.assert_allclose(stroke.time, self.TIME, atol=1e-9)
            self.assertEqual(self.columns(found, "time"), [1, 2])
            self.assertEqual(found["warnings"], [])
        rows = table("t,x,y,z", np.arange(100), self.POSITIONS)
        self.assertIn(
            "or numbers of rows? (--set sample_rate_Hz=", self.refusal(rows, "time=t,position=x")
        )
        days = table("t,x,y,z", 46354.25 + self.TIME / 86400, self.POSITIONS, number="%.17g")
        _, found = self.report(days, "time=t,position=x")
        self.assertIn(
            "are the times in days, as in spreadsheets and MATLAB? (with --scale time=86400",
            found["warnings"][0],
        )
        of_day = "t,x,y,z\n" + "".join(
            f"2026/11/28 05:59:{0.002 * i:06.3f},{','.join(map(str, row))}\n"
            for i, row in enumerate(self.POSITIONS.tolist())
        )
        self.assertIn("are read as seconds since the first", self.assert_positions(of_day)[0])
        self.assertIn(
            'allowed: a finite number or a time of day, such as "05:59:00.002"',
            self.refusal(of_day.replace("2026/11/28", "28.11.2026"), "time=t,position=x"),
        )
        fortran = (
            table("t,x,y,z", self.TIME, self.POSITIONS, number="%.9e")
            .replace("e-", "D-")
            .replace("e+", "D+")
        )
        self.assertIn(
            "; write an exponent as in 1e-3 (100 rows", self.refusal(fortran, "time=t,position=x")
        )

    def test_a_log_of_a_device_is_read_by_the_same_rules(self):
        force = np.sin(20 * self.TIME)
        seconds = 1764288000 + np.floor(self.TIME)
        nanoseconds = np.round(self.TIME % 1 * 1e9)
        columns = (self.TIME, force, self.POSITIONS[:, 0])

        def read(data, *words):
            options = SimpleNamespace(
                columns=list(words),
                scale=[],
                decimal=None,
                skip_bad_rows=False,
                log=self.write(data),
            )
            return read_log(options)

        names = "time_s,force_N,position_m"
        for data, words, warning in (
            (table(names, *columns).encode("utf-16-be"), (), "the text is UTF-16"),
            ("Time,Command,Encoder\n" + table(names, *columns), (), "those of line 2"),
            (table(names, *columns)[:-1], (), "line 101, the last line, has no line end"),
            (
                table(f"stamp.secs,stamp.nsecs,{names[7:]}", seconds, nanoseconds, *columns[1:]),
                ("time=stamp.secs",),
                "",
            ),
            (
                table("time_s,force_N,x_cm", *columns),
                ("position=x_cm",),
                "is read as m; if its name says cm",
            ),
            (
                table("time_s,position_m,force_N", *columns),
                ("force=2", "position=3"),
                "the column of force is 2 position_m, which is named as position",
            ),
        ):
            log = read(data, *words)
            np.testing.assert_allclose(log.time - log.time[0], self.TIME, atol=1e-9)
            np.testing.assert_allclose(log.force, force, atol=1e-8)
            np.testing.assert_allclose(log.position, self.POSITIONS[:, 0], atol=1e-9)
            self.assertIn(warning, "".join(log.warnings))
            self.assertEqual(bool(warning), bool(log.warnings))

    def test_names_against_quantities_and_lengths_of_axes(self):
        force = np.column_stack([0.1 + 0 * self.TIME, 0 * self.TIME, 0.5 + 0 * self.TIME])
        _, found = self.report(
            table("t,fx,fy,fz,x,y,z", self.TIME, 1e-3 * force, self.POSITIONS),
            "time=1,position=2,force=5",
        )
        self.assertIn(
            "columns of position are 2 fx, 3 fy, 4 fz, which are named as force",
            found["warnings"][0],
        )
        self.assertIn(
            "columns of force are 5 x, 6 y, 7 z, which are named as position", found["warnings"][1]
        )
        warned, _ = self.assert_positions(
            table("t,fx,fy,fz,x,y,z", self.TIME, force, self.POSITIONS), "time=1,position=5,force=2"
        )
        self.assertEqual(warned, "")
        for vectors, warning in (
            (np.degrees(self.TURNS.as_euler("xyz")), "Euler angles"),
            (self.TURNS.as_rotvec(), "the axes have lengths of 0.9"),
        ):
            _, found = self.report(
                table("t,x,y,z,a,b,c", self.TIME, self.POSITIONS, vectors),
                "time=t,position=x,orientation=5",
                orientation="axis",
            )
            self.assertIn(warning, found["warnings"][0])
        self.assertIn(
            "column 2 x_cm is read as m; if its name says cm, --scale position=0.01",
            self.report(
                table("t,x_cm,y_cm,z_cm", self.TIME, self.POSITIONS), "time=t,position=x_cm"
            )[1]["warnings"],
        )
        self.assertIn(
            "--scale position=1e-06 is for micrometres",
            self.refusal(table("t,x,y,z", self.TIME, 1e6 * self.POSITIONS), "time=t,position=x"),
        )

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

    def test_a_last_line_without_a_line_end_is_reported(self):
        warning = "line {}, the last line, has no line end: is the file cut short?"
        for end in ("\n", "\r\n", "\r"):
            whole = self.PLAIN.replace("\n", end)
            self.assertEqual(self.report(whole)[1]["warnings"], [])
            self.assertEqual(self.report(whole + "  ")[1]["warnings"], [])
            cut = whole[: -len(end) - 3]
            for data in (cut, cut.encode("utf-16"), cut + " ", cut.encode() + b"\0\0"):
                self.assertIn(warning.format(101), self.report(data)[1]["warnings"])
        self.assertIn(warning.format(102), self.report(self.PLAIN + "# the e")[1]["warnings"])

    def test_options_without_effect_are_not_ignored_in_silence(self):
        preset = self.root / "preset.json"
        by_name = "time=t,position=x"
        for columns, options, problem in (
            (by_name + ",time=x", {}, '--columns: got "time" twice; allowed: once'),
            (by_name, {"scale": "force=1,force=2"}, '--scale: got "force" twice'),
            (by_name, {"smooth": "window=5,window=7"}, '--smooth: got "window" twice'),
            (by_name, {"max_gap": 1, "set": "max_gap=2"}, '--set: got "max_gap" twice'),
            (by_name, {"floats": True}, "floats=true: got format csv; allowed: --format hapi-bin"),
            (by_name, {"decimal": "comma", "format": "hapi-binary"}, "decimal: got comma; allowed"),
            (by_name, {"decimal": "comma", "set": "decimal=auto"}, "--decimal and --set decimal"),
            ("position=x", {"set": 'columns={"position":"y"}'}, "--columns and --set columns: all"),
            (by_name, {"set": "sample_rate_Hz=5"}, "--columns time and --set sample_rate_Hz"),
        ):
            self.assertIn(problem, self.refusal(self.PLAIN, columns, **options))
        both = '{"columns": {"time": "t", "position": "x"}, "sample_rate_Hz": 500, "max_speed": 9}'
        preset.write_text(both)
        self.assertIn(
            "preset.json: columns: time and sample_rate_Hz: allowed: one of them",
            self.refusal(self.PLAIN, None, preset=preset),
        )
        preset.write_text(both.replace('"sample_rate_Hz": 500, "max_speed": 9', '"floats": true'))
        self.assertIn("floats=true: got", self.refusal(self.PLAIN, None, preset=preset))
        scale = "force=2,angle=3,position=1"
        warned = self.assert_positions(self.PLAIN, scale=scale, force_by_tool=True)[0]
        for warning in (
            "the scale force=2 has no effect: no column of force is read",
            "the scale angle=3 has no effect",
            "force_by_tool=true has no effect",
        ):
            self.assertIn(warning, warned)
        self.assertNotIn("position=1", warned)
        rate = {"set": "sample_rate_Hz=500", "scale": "time=1e-3"}
        warned = self.assert_positions(self.PLAIN, "position=x", **rate)[0]
        self.assertIn("the scale time=0.001 has no effect", warned)
        axes = table("t,x,y,z,axis_x,axis_y,axis_z", self.TIME, self.POSITIONS, self.POSITIONS + 1)
        columns = by_name + ",orientation=axis_x"
        _, found = self.report(axes, columns, orientation="axis", tip_axis="1,0,0")
        self.assertIn("tip_axis has no effect", "\n".join(found["warnings"]))
        # A preset may describe columns that a file omits. The note about these columns suffices.
        preset.write_text(
            '{"columns": {"time": "t", "position": "x", "force": "fx"}, "scale": {"force": 2}, '
            '"force_by_tool": true}'
        )
        _, found = self.report(self.PLAIN, None, preset=preset)
        self.assertEqual(len(found["warnings"]), 1, found["warnings"])
        self.assertIn("the stroke has no force", found["warnings"][0])

    def test_seconds_and_their_fractions_are_joined(self):
        time = 17.9 + self.TIME
        for unit, names in (
            (1e-6, ("tv_sec", "tv_usec")),
            (1e-6, ("seconds", "microseconds")),
            (1e-6, ("t_s [s]", "t_us [us]")),
            (1e-3, ("Time.Sec", "Time.mSec")),
            (1e-9, ("tv_sec", "tv_nsec")),
            (1e-9, ("header.stamp.sec", "header.stamp.nanosec")),
        ):
            whole = np.floor(time + 1e-9)
            fractions = np.rint((time - whole) / unit)
            header = ",".join([*names, "x,y,z"])
            data = table(header, whole, fractions, self.POSITIONS, number="%.12g")
            warned, found = self.assert_positions(data, f"time={names[0]},position=x")
            self.assertEqual((self.columns(found, "time"), warned), ([1, 2], ""), names)
            self.assertAlmostEqual(found["duration_s"], self.TIME[-1], delta=1e-9)
            self.assertAlmostEqual(found["first_time_s"], 17.9, delta=1e-9)
            # Without names that state the fractions, the remedy of the message works.
            data = data.replace(",".join(names), "a,b")
            for options in ({}, {"skip_bad_rows": True}):
                problem = self.refusal(data, "time=a,position=x", **options)
                self.assertIn("column 1 a: 98 of 100 rows repeat the time", problem)
                self.assertNotIn("skip-bad-rows", problem)
            other = re.search(r"2 b may .* name the columns t_sec and (t_\wsec) in the", problem)[1]
            data = data.replace("a,b", f"t_sec,{other}")
            self.assert_positions(data, "time=t_sec,position=x")
            rate = {"set": "sample_rate_Hz=500"}
            self.assert_positions(data, "position=x", **rate)
        # A column that counts all microseconds has no fractions of the seconds.
        slow = 0.05 * np.arange(100)
        data = table("t_s,t_us,x,y,z", np.floor(slow), np.rint(1e6 * slow), self.POSITIONS)
        self.assertIn(
            "2 t_us does not have their fractions", self.refusal(data, "time=t_s,position=x")
        )
        self.assert_positions(data, "time=t_us,position=x")
        data = table("t_s,t_us,x,y,z", self.TIME, np.rint(1e6 * self.TIME), self.POSITIONS)
        self.assertEqual(self.assert_positions(data, "time=t_s,position=x")[0], "")
        data = table("t_s,x,y,z", 0 * self.TIME, self.POSITIONS)
        self.assertIn("is the column with the", self.refusal(data, "time=t_s,position=x"))

    def test_a_file_has_one_decimal_sign(self):
        """A point may separate thousands in a file whose other columns have decimal commas."""
        cells = [
            (f"{t:.3f}".replace(".", ","), *(f"{1e6 * v + 5000:,.0f}".replace(",", ".") for v in p))
            for t, p in zip(self.TIME, self.POSITIONS)
        ]
        data = "".join(
            ";".join(row) + "\n" for row in [("t", "x [um]", "y [um]", "z [um]"), *cells]
        )
        columns = "time=t,position=x"
        for options, problem in (
            (
                {},
                'line 2: column 2 x [um]: got "5.000"; allowed: a finite number; the point may separate thousands, '
                'because line 2 has the decimal comma "0,000": write "5000" or "5,000" (--decimal point reads the '
                "point as decimal, if column 1 t is not needed) (100 rows, the last: line 101)",
            ),
            (
                {"decimal": "comma"},
                '; with --decimal comma, the point may separate thousands: write "5000" or "5,000", or omit --decimal',
            ),
            ({"decimal": "point"}, 'line 2: column 1 t: got "0,000"; allowed: a finite number'),
        ):
            self.assertIn(problem, self.refusal(data, columns, **options))
        # Each remedy of the message works.
        expected = self.POSITIONS + 5e-3
        without = data.replace(".", "")
        for remedy in ({}, {"decimal": "comma"}):
            stroke = self.stroke(without, columns, **remedy)
            np.testing.assert_allclose(stroke.position, expected, atol=1e-6)
        rate = {"set": "sample_rate_Hz=500", "decimal": "point", "scale": "position=0.001"}
        stroke = self.stroke(data, "position=x", **rate)
        np.testing.assert_allclose(stroke.position, expected, atol=1e-6)
        # Decimal commas of a column that is not read count too.
        noted = "t;x;y;z;note\n" + "".join(
            f"{t:.3f};{x};{y};{z};1,5\n" for t, (x, y, z) in zip(self.TIME, self.POSITIONS)
        )
        self.assertIn('has the decimal comma "1,5"', self.refusal(noted, columns))
        self.assert_positions(noted, columns, decimal="point")
        # Numbers with both signs.
        both = without.replace("5000", "5.000,5")
        self.assertIn('got "5.000,5"', self.refusal(both, columns))

    def test_a_fault_is_reported_once_with_its_repetitions(self):
        lines = self.PLAIN.split("\n")
        lines[10:40] = [line.rpartition(",")[0] + ",nan" for line in lines[10:40]]
        self.assertEqual(
            self.refusal("\n".join(lines), "time=t,position=x"),
            'rec.csv, line 11: column 4 z: got "nan"; allowed: a finite number (30 rows, the last: line 40); '
            "--skip-bad-rows skips bad rows",
        )

    def test_a_log_of_rostopic_is_read_by_its_names(self):
        # Nanoseconds since 1970 exceed the precision of a double.
        pose = np.column_stack([self.POSITIONS, self.TURNS.as_quat()])
        ends = [f".{c}" for c in "xyz"], [f".{c}" for c in "xyzw"]
        names = ["field.pose.position" + end for end in ends[0]] + [
            "field.pose.orientation" + end for end in ends[1]
        ]
        log = f"%time,field.header.seq,{','.join(names)}\n" + "".join(
            f"{1600000000123456789 + 2000000 * i},{i},{','.join(map(str, row))}\n"
            for i, row in enumerate(pose.tolist())
        )
        columns = "time=%time,position=field.pose.position.x,orientation=field.pose.orientation.x"
        self.assertIn("are times in other units? (--scale time=1e-09)", self.refusal(log, columns))
        _, found = self.assert_positions(log, columns, scale="time=1e-9")
        self.assertFalse(found["resampled"])
        self.assertAlmostEqual(found["rate_Hz"], 500, delta=1e-9)
        self.assertAlmostEqual(found["first_time_s"], 1600000000.123, delta=1e-3)
        self.assertTrue(found["has_roll"])

    def test_units_in_names_are_applied(self):
        millimetres = table("t [ms],x [mm],y [mm],z [mm]", 1e3 * self.TIME, 1e3 * self.POSITIONS)
        _, found = self.assert_positions(millimetres)
        self.assertEqual(found["scales"], {"time": 1e-3, "position": 1e-3})
        self.assert_positions(
            millimetres.replace("[", "(")
            .replace("]", ")")
            .replace("x", "X")
            .replace("y", "Y")
            .replace("z", "Z"),
            "time=t,position=X",
        )
        self.assert_positions(
            table("t_ms,x_mm,y_mm,z_mm", 1e3 * self.TIME, 1e3 * self.POSITIONS),
            "time=t_ms,position=x_mm",
        )
        rows = millimetres.partition("\n")[2]
        for header in ("t/ms,x/mm,y/mm,z/mm\n", '"t, ms","x, mm","y, mm","z, mm"\n'):
            self.assert_positions(header + rows)
        warning, _ = self.assert_positions("t,x,y,z\nms,mm,mm,mm\n" + rows)
        self.assertEqual(warning, "line 2 has the units of the columns")
        self.assert_positions(self.PLAIN.replace("z\n", "z [-]\n", 1).replace("x", "x [-]"))
        counts = millimetres.replace("mm", "counts")
        self.assertIn(
            'column 2 x [counts]: the unit "counts" is unknown: give the unit with --scale position=...',
            self.refusal(counts, "time=t,position=x"),
        )
        self.assert_positions(counts, scale="position=0.001")
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

    def test_ticks_of_100_ns_are_named(self):
        """Checks times of .NET, which count from the year 1, of Windows, which count from 1601, and from 0. Times from
        0 can also be microseconds at a lower rate."""
        for start, unit in ((637 * 10**15, "1e-07"), (134 * 10**15, "1e-07"), (0, "1e-06")):
            data = "t,x,y,z\n" + "".join(
                f"{start + 10_000 * i},{','.join(map(str, row))}\n"
                for i, row in enumerate(self.POSITIONS.tolist())
            )
            refused = self.refusal(data, "time=t,position=x")
            self.assertIn(f"(--scale time={unit})", refused)
            text = "for ticks of 100 ns, as of .NET and Unity: --scale time=1e-07, at 1000 Hz"
            self.assertEqual(text in refused, start == 0, refused)
            refused = self.refusal(data, "time=t,position=x", scale="time=1e-6")
            self.assertNotIn("time=1e-09", refused)

    def test_the_rate_of_held_poses_is_the_mean_rate(self):
        time = 0.001 * np.arange(4000)
        for rate in (60, 72, 90, 120):
            held = np.floor(time * rate + 1e-9) / rate
            _, found = self.report(table("t,x,y,z", time, moved(held)), "time=t,position=x")
            self.assertEqual(found["rate_Hz"], rate)
            (stated,) = re.findall(r"measured at ([\d.]+) Hz", " ".join(found["warnings"]))
            self.assertAlmostEqual(float(stated), rate, delta=0.1)

    def test_a_rounded_clock_has_its_mean_rate(self):
        time = np.arange(3600) / 900.0
        data = table("t,x,y,z", np.round(time, 3), moved(time))
        self.assertEqual(self.report(data, "time=t,position=x")[1]["rate_Hz"], 900.0)

    def test_rows_in_packets_have_their_mean_rate(self):
        time = 0.001 * np.arange(4000)
        row = np.arange(len(time))
        stamps = time - 0.9e-3 * (row % 2)
        _, found = self.report(table("t,x,y,z", stamps, moved(time)), "time=t,position=x")
        self.assertEqual(found["rate_Hz"], 1000.0)
        self.assertIn("the rows arrive in packets", " ".join(found["warnings"]))

    def test_times_of_day_are_seconds_since_the_first(self):
        rows = self.PLAIN.partition("\n")[2].splitlines()
        midnight = datetime(2026, 11, 27, 23, 59, 59, 900000)
        for text, warning in (
            ("%Y-%m-%dT%H:%M:%S.%fZ", "2026-11-27T23:59:59.900000Z"),
            ("%Y-%m-%d %H:%M:%S.%f+02:00", "2026-11-27 23:59:59.900000+02:00"),
        ):
            data = "t,x,y,z\n" + "".join(
                f"{(midnight + timedelta(seconds=float(time))):{text}},{row.partition(',')[2]}\n"
                for time, row in zip(self.TIME, rows)
            )
            self.assertIn(
                f'such as "{warning}" are read as seconds', self.assert_positions(data)[0]
            )
            self.assertIn(
                "the times are times of day, in seconds",
                self.refusal(data, "time=t,position=x", scale="time=0.001"),
            )
        of_day = data.replace("2026-11-27 ", "").replace("2026-11-28 ", "").replace("+02:00", "")
        self.assertIn("line 52: the clock passes midnight", self.assert_positions(of_day)[0])
        self.assertIn(
            'column 1 t: got "2026-13-01 00:00:00"',
            self.refusal("t,x,y,z\n" + "2026-13-01 00:00:00,0,0,0\n" * 3, "time=t,position=x"),
        )

    def test_poses_held_for_several_rows_are_reduced_to_the_true_samples(self):
        time = 1e-3 * np.arange(1200)
        for rows in (2, 3, 5, 10):
            held = time[np.arange(1200) // rows * rows]
            stroke, found = self.report(table("t,x,y,z", time, moved(held)), "time=t,position=x")
            self.assertEqual((found["rows_per_held_sample"], found["resampled"]), (rows, False))
            self.assertAlmostEqual(found["rate_Hz"], 1000 / rows, delta=1e-6)
            np.testing.assert_allclose(stroke.position, moved(time[::rows]), atol=1e-9)
            self.assertIn(f"each pose is repeated in {rows} rows", found["warnings"][0])
        # In the first log, positions are measured at 60 Hz and logged at 1000 Hz, which is not a multiple of 60 Hz. The
        # speed is the change between two measurements, divided by the time between them. Divided by the time between
        # two rows, it would be too high. In the second log, the tool rests for some time.
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
        # If the clock has jitter, each sample is repeated in 3, 4 or 5 rows.
        lengths = np.random.default_rng(7).choice([3, 4, 5], 300, p=[0.2, 0.6, 0.2])
        held = time[np.repeat(np.cumsum(lengths) - lengths, lengths)[:1200].clip(max=1199)]
        _, found = self.report(
            table("t,x,y,z", time[: len(held)], moved(held)), "time=t,position=x"
        )
        self.assertAlmostEqual(found["rows_per_held_sample"], 4.0, delta=0.1)
        # Coarse positions are equal in successive rows, but they are not held samples. The same is true for a constant
        # speed at which the position increases by one encoder step after several rows.
        for positions in (np.round(moved(time), 4), np.round(np.outer(time, [0.0025, 0, 0]), 5)):
            _, found = self.report(table("t,x,y,z", time, positions), "time=t,position=x")
            self.assertEqual((found["rows_per_held_sample"], found["samples"]), (1, 1200))

    def test_a_force_into_the_surface_is_reported(self):
        force = np.column_stack(
            [0.1 + 0 * self.TIME, 0 * self.TIME, 0.5 + 0.3 * np.sin(8 * self.TIME)]
        )
        for sign, by_tool, warning in (
            (1, False, ""),
            (-1, False, "--set force_by_tool=true"),
            (-1, True, ""),
            (1, True, "omit force_by_tool=true"),
        ):
            _, found = self.report(
                table("t,x,y,z,fx,fy,fz", self.TIME, self.POSITIONS, sign * force),
                "time=t,position=x,force=fx",
                force_by_tool=by_tool,
            )
            self.assertIn(warning, "".join(found["warnings"]))
            self.assertEqual(bool(warning), bool(found["warnings"]))
