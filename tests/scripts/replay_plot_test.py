"""Tests `hapbench plot` of logs of a haptic loop, the options of its pictures, and curves whose peaks would flatten all
other curves."""
import re
import shutil

import numpy as np

from figure_checks import legend_labels
from fixture import PROGRAM, SOURCE, ran
from pictures_test import Given, make_root, plotted

from hapbench_pictures.log_faults import COLUMNS
from hapbench_pictures.panels import largest_shown
from hapbench_pictures.replay_plot import Log, draw_logs, share_period
from hapbench_style import SHEETS, plt

setUpModule = make_root
LOG = SOURCE / "tests/data/loop.csv"


class Replays(Given):
    def other(self):
        """Returns a folder of a replay. Its last call has another force than the log, and its third-last call is
        missing."""
        folder = self.root / "replay"
        folder.mkdir(exist_ok=True)
        about, names, *rows = LOG.read_text(encoding="utf-8").splitlines()
        cells = rows[-1].split(",")
        cells[names.split(",").index("fz_N")] = "0.5"
        rows[-1] = ",".join(cells)
        del rows[-3]
        (folder / "replay.csv").write_text("\n".join([about, names, *rows]) + "\n")
        return folder

    def test_the_picture_of_a_log_is_beside_it(self):
        log = self.root / "alone" / "loop.csv"
        log.parent.mkdir()
        shutil.copy(LOG, log)
        plotted(log)
        self.assertEqual({file.name for file in log.parent.iterdir()}, {"loop.csv", "plot.svg"})

    def test_a_log_and_its_replay(self):
        folder = self.other()
        first, second = Log(LOG), Log(folder / "replay.csv")
        self.assertEqual(len(first.call), len(second.call) + 1)
        figure = draw_logs([folder / "replay.csv", LOG], SHEETS["single"])
        above, below = figure.axes
        self.assertEqual(len([line for line in above.lines if line.get_marker() == "None"]), 2)
        late = int(first.late.sum()) + 1
        self.assertIn(f"late or missing calls: {late}", legend_labels(figure))
        (difference,) = [line for line in below.lines if line.get_marker() == "None"]
        change = np.linalg.norm(first.applied[-1] - second.applied[-1])
        self.assertGreater(change, 0)
        self.assertAlmostEqual(max(difference.get_ydata()), change, delta=1e-15)
        plt.close(figure)
        plotted(folder, LOG, "--out", self.root / "both.svg")
        self.assert_shows(self.root / "both.svg", "|force| [N]", "|difference| [N]")

    def test_faults_for_which_a_replay_is_refused_are_named(self):
        """Each warning has the line and the cause. `run --replay` rejects the same logs, except for a field nan and a
        time that goes back."""
        whole = LOG.read_text(encoding="utf-8").splitlines()
        names = whole[1].split(",")
        self.assertEqual(names, COLUMNS)
        file = self.root / "faulty.csv"

        def changed(lines, line, old, new):
            self.assertIn(old, lines[line - 1])
            return [*lines[: line - 1], lines[line - 1].replace(old, new, 1), *lines[line:]]

        def field(name, text):
            cells = whole[19].split(",")
            cells[names.index(name)] = text
            return [*whole[:19], ",".join(cells), *whole[20:]]

        for lines, text in (
            (whole, ""),
            ([*whole[:9], "", *whole[9:]], ""),
            ([*whole[:19], *whole[20:]], "line 20: got call 18 where call 17 is expected"),
            ([*whole[:20], *whole[19:]], "line 21: got call 17 where call 18 is expected"),
            (changed(whole, 1, '"scale":1.0', '"scale":0'), "line 1: mount.scale: got 0; allowed"),
            (
                changed(whole, 1, 'wxyz":[1.0', 'wxyz":[2.0'),
                "orientation_wxyz: got a quaternion of",
            ),
            (changed(whole, 1, '"version":1', '"version":2'), "line 1: version: got 2; allowed: 1"),
            (changed(whole, 1, '"ramp_s"', '"ramp"'), "line 1: mount.ramp_s: got null; allowed"),
            (changed(whole, 2, "hx_m,hy_m", "hy_m,hx_m"), 'line 2: column 4: got "hy_m"; allowed:'),
            (field("has", "-1"), 'line 20: has: got "-1"; allowed: a whole number >= 0'),
            (field("hx_m", ""), "line 20: hx_m: got an empty field; allowed: a finite number"),
            (field("hx_m", "nan"), 'line 20: hx_m: got "nan"; allowed: a finite number'),
            (field("time_ns", "5"), "line 20: time_ns: got a time "),
        ):
            file.write_text("\n".join(lines) + "\n")
            faults = Log(file).faults
            self.assertEqual(len(faults), bool(text), (text, faults))
            error = ran(PROGRAM, "plot", file, "--quiet").stderr if text else ""
            self.assertEqual(error.count("warning"), bool(text))
            self.assertIn(f"{file}: " if text else "", error)
            self.assertIn(text, error)
            is_accepted = not text or "nan" in text or "time_ns" in text
            replayed = ran(PROGRAM, "run", "drag_molar", "--replay", file, "--out", self.root / "r")
            self.assertEqual(replayed.returncode == 2, not is_accepted, replayed.stderr)

    def test_a_wrong_number_of_fields_is_refused(self):
        """Checks a decimal comma, a field too many, a field too few behind the drawn columns, and two rows in one line.
        With these rows, columns would contain numbers of other columns. `run --replay` rejects the same logs.
        """
        whole = LOG.read_text(encoding="utf-8").splitlines()
        file, row = self.root / "fields.csv", whole[19]
        number = next(cell for cell in row.split(",") if "." in cell)
        for wrong, count in (
            (row.replace(number, number.replace(".", ",")), 42),
            (f"{row},0", 42),
            (row.rpartition(",")[0], 40),
            (f"{row},{whole[20]}", 82),
        ):
            # An empty line is no fault. It counts as a line.
            file.write_text("\n".join([*whole[:9], "", *whole[9:19], wrong, *whole[20:]]) + "\n")
            error = plotted(file, expected=2)
            self.assertIn(f"{file}: line 21: got {count} fields; allowed: 41\n", error)
            replayed = ran(PROGRAM, "run", "drag_molar", "--replay", file, "--out", self.root / "r")
            self.assertEqual(replayed.returncode, 2)
            self.assertIn("line 21", replayed.stderr)

    def test_a_replay_with_another_time_step_has_the_late_calls_of_its_log(self):
        """The first line of replay.csv has the time step of the scenario that rendered the log again. The period of the
        loop is in the log, and else is the median of the recorded intervals."""
        folder = self.root / "other_step"
        folder.mkdir(exist_ok=True)
        about, names, *rows = LOG.read_text(encoding="utf-8").splitlines()
        period = re.search(r'"period_s":([\d.e-]+)', about)[1]
        late = [row.split(",") for row in rows]
        for cells in late[20:]:
            cells[1] = str(int(cells[1]) + int(1e9 * float(period)))  # call 20 is late by a period
        log = self.root / "late.csv"
        for file, step in ((log, period), (folder / "replay.csv", "1e-6")):
            first = about.replace(f'"period_s":{period}', f'"period_s":{step}')
            file.write_text("\n".join([first, names, *map(",".join, late)]) + "\n")
        expected = int(Log(log).late.sum())
        self.assertTrue(Log(log).late[20])
        self.assertLess(expected, 5)
        replay = Log(folder / "replay.csv")
        self.assertAlmostEqual(replay.period / float(period), 1, delta=0.05)
        np.testing.assert_array_equal(replay.late, Log(log).late)
        for files in ([folder / "replay.csv"], [folder / "replay.csv", log], [log]):
            figure = draw_logs(files, SHEETS["single"])
            self.assertIn(f"late or missing calls: {expected}", legend_labels(figure))
            plt.close(figure)
        # If all calls of the loop are late by its own period, a replay of the log has the same late calls.
        text = log.read_text().replace(f'"period_s":{period}', f'"period_s":{float(period) / 2}')
        log.write_text(text)
        replay, recorded = Log(folder / "replay.csv"), Log(log)
        share_period([replay, recorded])
        self.assertGreater(recorded.late.sum(), len(rows) / 2)
        np.testing.assert_array_equal(replay.late, recorded.late)

    def test_a_log_whose_name_begins_with_an_underscore_is_in_the_legend(self):
        folder = self.root / "underscore"
        folder.mkdir()
        text = re.sub('"scenario":"[^"]*"', '"scenario":"_mine"', LOG.read_text(encoding="utf-8"))
        (folder / "replay.csv").write_text(text)
        (folder / "loop.csv").write_text(text)
        figure = draw_logs([folder / "replay.csv", folder / "loop.csv"], SHEETS["single"])
        self.assertLessEqual({"_mine, replay", "_mine, loop"}, set(legend_labels(figure)))
        plt.close(figure)

    def test_what_is_refused(self):
        folder = self.other()
        table = self.root / "laws"
        table.mkdir(exist_ok=True)
        (table / "replay_comparison.csv").write_text("algorithm,calls\nmean,5\n")
        copy = self.root / "copy.csv"
        shutil.copy(LOG, copy)
        for words, message in (
            ((table,), 'allowed: a folder of "hapbench run --replay"'),
            ((folder, copy, LOG), "or two of them for their difference"),
            ((folder, "--y", "force"), "allowed for them: --width, --dpi, --out"),
            ((folder, "--to", "file.png"), "--out file.png names the file of the picture"),
            ((folder, "--out", self.root / "a.svg", "--dpi", "300"), "has no pixels"),
            ((folder, "--out", self.root / "a.png", "--dpi", "5"), "allowed: 50 to 1200"),
        ):
            self.assertIn(message, plotted(*words, expected=2))

    def test_resolution_and_fonts(self):
        folder, sizes = self.other(), []
        for words in ((), ("--dpi", "150")):
            file = self.root / "a.png"
            plotted(folder, "--width", "single", "--out", file, *words)
            sizes.append(int.from_bytes(file.read_bytes()[16:20], "big"))
        # Width of a picture of 89 mm at 300 and at 150 pixels per inch, truncated to whole pixels.
        self.assertEqual(sizes, [1051, 525])
        plotted(folder, "--out", self.root / "a.pdf")
        found = set(
            re.findall(rb"/Subtype /(Type3|CIDFontType2)", (self.root / "a.pdf").read_bytes())
        )
        self.assertEqual(found, {b"CIDFontType2"})


class Thrown(Given):
    def test_the_axis_belongs_to_the_other_runs(self):
        """Checks largest_shown(), which returns the largest peak that the axis must show. Each case below has the peaks
        of the runs, True for each run that failed, and the expected result."""
        fine = [False] * 4
        for peaks, failed, largest in (
            ([3, 5, 45, 14000], fine, 45),
            ([3, 5, 45, 60], fine, np.inf),
            ([1, 2, 7], [False, False, True], 10),
            ([1, 2, 11], [False, False, True], 10),
            ([1, 1000, 1000], fine[:3], np.inf),
            ([0, 0, 5], fine[:3], np.inf),
            ([1, 2], [True, True], np.inf),
        ):
            self.assertEqual(largest_shown(peaks, failed), largest, peaks)
