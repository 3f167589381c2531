"""Tests `hapbench plot` of limits, of a tuning and of a convergence study."""
import csv

import numpy as np
from matplotlib.colors import to_hex
from matplotlib.markers import MarkerStyle

from figure_checks import assert_fits, curves_of, legend_labels
from fixture import PROGRAM, hapbench, in_process
from pictures_test import Given, made, make_root, plotted

from hapbench.columns import read_records
from hapbench_pictures.__main__ import main as pictures
from hapbench_pictures.device_plot import (
    ALTERNATING_LABEL,
    BEYOND_LABEL,
    PUBLISHED_LABEL,
    QUOTED,
    QUOTED_LABEL,
    UNQUOTED,
    UNQUOTED_LABEL,
    device_of,
)
from hapbench_looks import SERIES, series
from hapbench_pictures.study_plot import draw_study
from hapbench_style import RED, SHEETS, plt

setUpModule = make_root
OVER = "rendering.damping_N_s_per_m"


def rewrite(file, change):
    """Calls change(row) for each row of a table and writes the table again."""
    rows = read_records(file)
    for row in rows:
        change(row)
    with file.open("w", newline="", encoding="utf-8") as out:
        table = csv.DictWriter(out, list(rows[0]))
        table.writeheader()
        table.writerows(rows)
    return rows


class Limits(Given):
    def test_maps_and_limits(self):
        over = made(
            "over", "limit", "stability_z_width", "--resolution", 0.5, "--algorithms", "mean,proxy"
        )
        self.assert_plot_shows(
            over,
            "linear limit",
            "simulated limit",
            "damping [N s/m]",
            "stiffness K [N/m]",
            "diverged",
            "stable (Gil, Hulin)",
        )
        limit = made(
            "limit",
            "limit",
            "springs_limited_mean",
            "--vary",
            "rendering.stiffness_N_per_m",
            "--set",
            "time.steps=300",
            "--set",
            "expect={}",
            "--resolution",
            0.1,
        )
        self.assert_plot_shows(limit, "simulated limit", "stiffness K [N/m]", "mean")
        # If the loop has no theoretical limit, the closed formulas for stability are not drawn. The linear limit is
        # that of the same loop without friction.
        rubbed = made(
            "rubbed",
            "limit",
            "stability_z_width",
            "--resolution",
            0.5,
            "--algorithms",
            "mean",
            "--set",
            "device.coulomb_N=0.1",
        )
        plotted(rubbed)
        drawn = (rubbed / "plot.svg").read_text()
        for text in ("stable (Gil, Hulin)", "exact, undamped handle"):
            self.assertFalse(text in drawn, text)
        self.assertTrue("linear limit" in drawn)
        for words, message in (
            ((over, limit), "one such folder alone"),
            ((limit, "--y", "force"), "allowed for it: --width, --dpi, --out"),
        ):
            self.assertIn(message, plotted(*words, expected=2))
        (limit / "limit_runs.csv").write_text("algorithm,class\nmean,stable\n")
        self.assertIn("is not a table that hapbench wrote", plotted(limit, expected=2))

    def test_a_change_of_class_is_within_the_panel(self):
        """Adds runs far below the limits: a run that passed through, and a stuck run below it. The panel of classes
        reaches the first of them. The class of the other run, which is outside, is not in the legend.
        """
        words = ("limit", "stability_z_width", "--resolution", 0.5, "--algorithms", "mean")
        folder = made("far", *words)
        rows = read_records(folder / "limit.csv")
        (_, before), (field, over) = self.panel_of_classes(folder), self.fields(rows[0])
        low = before.get_ylim()[0]
        runs = read_records(folder / "limit_runs.csv")
        for value, name in ((low / 10, "went_through"), (low / 1e4, "stuck")):
            runs.append({**runs[0], over: rows[0][over], field: value, "class": name})
        with (folder / "limit_runs.csv").open("w", newline="", encoding="utf-8") as out:
            table = csv.DictWriter(out, list(runs[0]))
            table.writeheader()
            table.writerows(runs)
        figure, after = self.panel_of_classes(folder)
        self.assertAlmostEqual(after.get_ylim()[0], low / 10 / 1.5)
        self.assertEqual(after.get_ylim()[1], before.get_ylim()[1])
        self.assertIn("passed through", legend_labels(figure))
        self.assertNotIn("stuck", legend_labels(figure))
        plt.close("all")

    def panel_of_classes(self, folder):
        figure = draw_study(folder, SHEETS["double"])
        (ax,) = [ax for ax in figure.axes if ax.get_title("left").startswith("class of the runs")]
        return figure, ax

    def fields(self, row):
        """Returns (searched field, field of --over) of a row of limit.csv."""
        names = list(row)
        return row["field"], names[names.index("algorithm") - 1]

    def test_convergence(self):
        folder = made(
            "converge",
            "converge",
            "springs_oscillation",
            "--metric",
            "force_max_N,inside_max_m,final_position_m.x",
            "--levels",
            4,
        )
        self.assert_plot_shows(
            folder,
            "largest force, no order",
            "final position m.x, order 1.",
            "formal order 1",
            "time step [s]",
            "relative error",
            "processor time per run [s]",
        )
        made("converge", "converge", "springs_oscillation", "--metric", "inside_max_m")
        self.assertIn("nothing to draw: no level has an error above 0", plotted(folder, expected=2))

    def test_a_metric_without_an_error_is_named_and_not_drawn(self):
        """Checks a study whose metric force_reversals is 0 at all levels, so that it has no relative error."""
        metrics = "force_max_N,force_reversals,inside_max_m"
        folder = made("zero", "converge", "tap_wall", "--metric", metrics, "--levels", 3)
        words = in_process(pictures, "plot", folder, HAPBENCH_PROGRAM=str(PROGRAM))[2]
        self.assertIn("force_reversals: no relative error above 0; not drawn", words)
        self.assertNotIn("RuntimeWarning", words)
        labels = legend_labels(draw_study(folder))
        self.assertEqual(
            [label.partition(",")[0] for label in labels[:2]], ["largest force", "max depth inside"]
        )

    def test_many_metrics_differ(self):
        """Checks that ten metrics have ten marks, and that more looks than markers still differ."""
        looks = series(30)
        self.assertEqual(tuple(looks[: len(SERIES)]), SERIES)
        self.assertEqual(len({look.marker for look in looks[:10]}), 10)
        for part in ("marker", "dash"):
            self.assertEqual(len({(look.colour, getattr(look, part)) for look in looks}), 30, part)
        for look in looks:
            self.assertTrue(MarkerStyle(look.marker).is_filled(), look.marker)

    def test_bounds_are_hollow_and_agree_with_the_front(self):
        """Checks the picture of a study in which no error of rk4 is resolved. Hollow marks are at the bounds, which
        are the numbers of the printed table. No mark is left of and below a mark of the front."""
        folder = made(
            "bounds",
            "converge",
            "springs_oscillation",
            "--over",
            "integrator.type=rk4,velocity_verlet,event",
            "--levels",
            3,
        )
        errors = read_records(folder / "convergence.csv")
        hidden = [row for row in errors if row["resolved"] == "false"]
        self.assertTrue(hidden)
        bounds = [
            1e6 * (float(row["position_error_m"]) + float(row["reference_position_error_m"]))
            for row in hidden
        ]
        figure = draw_study(folder)
        (ax,) = figure.axes
        hollow = [line for line in ax.lines if line.get_markerfacecolor() == "white"]
        (mark,) = [one for one in figure.legends[0].get_lines() if one.get_mfc() == "white"]
        self.assertIn(mark.get_marker(), {line.get_marker() for line in hollow})
        drawn = np.concatenate([line.get_ydata() for line in hollow])
        np.testing.assert_allclose(sorted(drawn), sorted(bounds))
        points = np.concatenate(
            [
                line.get_xydata()
                for line in ax.lines
                if line.get_marker() not in ("None", "o", None, "")
            ]
            + [line.get_xydata() for line in hollow]
        )
        times = read_records(folder / "convergence_timing.csv")
        front = [i for i, row in enumerate(times) if row["on_front"] == "true"]
        self.assertTrue(front)
        for i in front:
            cost = 1e3 * float(times[i]["seconds_per_simulated_second"])
            error = 1e6 * float(errors[i]["position_error_m"])
            self.assertFalse(((points[:, 0] < cost) & (points[:, 1] < error)).any(), times[i])

    def test_the_program_finds_knees(self):
        """Checks that the program finds the knee of a Pareto front of cost and error. The points of the front have the
        decimal logarithms (0, 0), (1, -3), (2, -3.5) and (3, -4). The second point is farthest below the chord between
        the first and the last point."""
        bent = hapbench("plot", "--knee", "1:1", "1000:1e-4", "10:1e-3", "100:3.2e-4")
        self.assertEqual(bent, "2\n")
        self.assertEqual(
            hapbench("plot", "--knee", "1:1", "2:0.25", "4:0.0625", "8:0.015625"), "\n"
        )
        for wrong in ("1", "1:0", "a:1", "-1:1"):
            self.assertIn("COST:ERROR", hapbench("plot", "--knee", wrong, expected=2))

    def test_laws_against_a_reference_force(self):
        folder = made(
            "model",
            "converge",
            "plane_wiped_round",
            "--over",
            "rendering.algorithm=mean,summation",
            "--set",
            "time.duration_s=0.1",
        )
        self.assert_plot_shows(
            folder,
            "mean",
            "summation",
            "rms error of the force [N]",
            "mean error of the direction [°]",
            "deadline, 0.5 ms",
        )

    def test_tuning(self):
        folder = made(
            "tune",
            "tune",
            "impedance_at_wall",
            "--algorithms",
            "mean,shaped_stiffness",
            "--damping-ratio",
            "0.2:0.3",
        )
        self.assert_plot_shows(
            folder,
            "stiffness [N/m]",
            "max depth inside [mm]",
            "vibration above 30 Hz [N rms]",
            "choice of each law",
            "not feasible",
            "mean",
        )
        table = folder / "tune_trials.csv"
        table.write_text(
            table.read_text().splitlines()[0] + "\nmean,1,1,,,false,settled,vibrating,,,\n"
        )
        self.assertIn("nothing to draw: no trial is settled", plotted(folder, expected=2))

    def test_devices(self):
        own = self.root / "my$own$.json"
        own.write_text('{"type": "impedance", "handle_mass_kg": 0.1}')
        folder = made(
            "devices",
            "limit",
            "tap_wall",
            "--device",
            f"touch,{own}",
            "--algorithms",
            "summation",
            "--set",
            "time.steps=200",
            "--resolution",
            0.5,
        )
        self.assert_plot_shows(
            folder,
            "tap wall",
            "touch",
            "my$own$",
            "summation",
            "published, for a wall",
            "largest stable stiffness K [N/m]",
        )

    def over_field(self):
        """Computes limits for several values of the damping, on a user's device and on a preset device. Returns the
        folder of the results."""
        own = self.root / "mine.json"
        own.write_text('{"type": "impedance", "handle_mass_kg": 0.1, "viscous_N_s_per_m": 0.5}')
        return made(
            "z_width",
            "limit",
            "wall_on_handle",
            "--device",
            f"{own},touch",
            "--over",
            f"{OVER}=1:100:3:log",
            "--between",
            "1e2:1e6",
            "--stable",
            "bounded",
            "--resolution",
            0.5,
        )

    def of_variants(self):
        """Computes limits of a preset device and of its soft and stiff ends. Returns the folder of the results."""
        short = ("--set", "time.steps=200", "--resolution", 0.5)
        return made("touch", "limit", "tap_wall", "--device", "touch", *short)

    def test_devices_over_a_field_have_it_as_their_axis(self):
        folder = self.over_field()
        rows = read_records(folder / "limit.csv")
        figure = draw_study(folder, SHEETS["single"])
        (ax,) = figure.axes
        self.assertEqual((ax.get_xlabel(), ax.get_xscale()), ("damping [N s/m]", "log"))
        self.assertEqual(ax.get_ylabel(), "largest stable\nstiffness K [N/m]")
        linear, simulated = curves_of(ax, "s"), curves_of(ax, "o")
        for device in {row["device"] for row in rows}:
            mine = [row for row in rows if row["device"] == device]
            limits = [
                float(row["linear_limit"] or row["theoretical_limit"] or "nan") for row in mine
            ]
            expected = [
                (float(row[OVER]), limit if np.isfinite(limit) and limit > 0 else np.nan)
                for row, limit in zip(mine, limits)
            ]
            self.assertTrue(
                any(np.array_equal(found, expected, equal_nan=True) for found in linear),
                device,
            )
            expected = {
                (float(row[OVER]), float(row["limit"])) for row in mine if row["first_unstable"]
            }
            self.assertTrue(
                any(
                    expected == {tuple(at) for at in found if np.isfinite(at[1])}
                    for found in simulated
                ),
                device,
            )
        colours = {to_hex(line.get_color()) for line in ax.lines if line.get_marker() == "s"}
        # Variants of a device have the same colour, so that there are two colours.
        self.assertEqual(len(colours), 2)
        (published,) = [
            line
            for line in ax.lines
            if len(set(line.get_ydata())) == 1
            and len(line.get_xdata()) == 2
            and line.get_marker() == "None"
        ]
        self.assertEqual(published.get_ydata()[0], float(rows[-1]["published_N_per_m"]))
        labels = legend_labels(figure)
        self.assertLessEqual({"mine", "touch", "linear limit", PUBLISHED_LABEL}, set(labels))
        plt.close(figure)

    def test_a_limit_at_the_end_of_the_range_is_marked(self):
        folder = self.over_field()

        def no_end(row):
            row["first_unstable"] = ""

        rows = rewrite(folder / "limit.csv", no_end)
        figure = draw_study(folder, SHEETS["double"])
        self.assertIn(BEYOND_LABEL, legend_labels(figure))
        self.assertNotIn("simulated limit", legend_labels(figure))
        # The marks of a device and of its variants are one Line2D. The marks of two devices are at different heights.
        (ax,) = figure.axes
        marks = [line for line in ax.lines if line.get_marker() == "^"]
        devices = list(dict.fromkeys(device_of(row) for row in rows))
        self.assertEqual(len(marks), len(devices))
        for line, name in zip(marks, devices):
            mine = [row for row in rows if device_of(row) == name]
            expected = {(float(row[OVER]), float(row["stable_high"])) for row in mine}
            self.assertEqual(set(map(tuple, line.get_xydata())), expected)
        heights = {line.get_transform().transform((1.0, 1e6))[1] for line in marks}
        self.assertEqual(len(heights), len(devices))
        self.assertTrue(all(line.get_mfc() == "white" for line in marks))
        plt.close(figure)

    def test_limits_to_quote_have_rings(self):
        """Checks that each limit to quote has a ring, and each row without one a mark at the edge, with and without
        --over."""
        folders = self.over_field(), self.of_variants()
        for folder in folders:
            rows = read_records(folder / "limit.csv")
            first = rows[0]["device"]

            def unquoted(row):
                if row["device"] == first:
                    row["quoted_limit"] = ""

            rows = rewrite(folder / "limit.csv", unquoted)
            figure = draw_study(folder, SHEETS["double"])
            self.assertLessEqual({QUOTED_LABEL, UNQUOTED_LABEL}, set(legend_labels(figure)))
            lines = figure.axes[0].lines
            rings = [line for line in lines if line.get_markersize() == QUOTED["ms"]]
            values = np.concatenate([curve.get_xydata().ravel() for curve in rings])
            quoted = [row for row in rows if row["quoted_limit"]]
            self.assertTrue(quoted)
            for row in quoted:
                self.assertIn(float(row["quoted_limit"]), values)
            crosses = [line for line in lines if line.get_marker() == UNQUOTED["marker"]]
            at_end = lambda row: row["stable_high"] and not row["first_unstable"]
            without = [row for row in rows if not row["quoted_limit"] and not at_end(row)]
            self.assertEqual(sum(len(line.get_xdata()) for line in crosses), len(without))
            plt.close(figure)

    def test_alternating_runs_make_single_hollow_points(self):
        folder = self.over_field()

        def alternates(row):
            row["non_monotonic_runs"] = "3"

        rows = rewrite(folder / "limit.csv", alternates)
        figure = draw_study(folder, SHEETS["double"])
        self.assertIn(ALTERNATING_LABEL, legend_labels(figure))
        self.assertNotIn("simulated limit", legend_labels(figure))
        hollow = [
            line
            for line in figure.axes[0].lines
            if line.get_marker() == "o" and line.get_markersize() < QUOTED["ms"]
        ]
        hollow = [line for line in hollow if np.isfinite(line.get_ydata()).any()]
        self.assertTrue(
            all((line.get_ls(), line.get_mfc()) == ("None", "white") for line in hollow)
        )
        found = {tuple(at) for line in hollow for at in line.get_xydata() if np.isfinite(at[1])}
        expected = {
            (float(row[OVER]), float(row["limit"])) for row in rows if row["first_unstable"]
        }
        self.assertEqual(found, expected)
        plt.close(figure)

    def test_a_field_of_texts_is_an_axis(self):
        """Checks the picture of limits over a field whose values are texts, with and without devices. The texts on the
        axis have the order of the table."""
        folder = self.over_field()
        names = {}

        def named(row):
            row[OVER] = names.setdefault(row[OVER], f"filter {len(names)}")

        rewrite(folder / "limit.csv", named)
        for drop in (False, True):
            if drop:
                for name in ("limit.csv", "limit_runs.csv"):
                    rows = [row for row in read_records(folder / name) if row["device"] == "mine"]
                    with (folder / name).open("w", newline="", encoding="utf-8") as out:
                        table = csv.DictWriter(out, [key for key in rows[0] if key != "device"])
                        table.writeheader()
                        for row in rows:
                            row.pop("device")
                            row[OVER] = names.get(row[OVER], row[OVER])
                            table.writerow(row)
            figure = draw_study(folder)
            ticks = [tick.get_text() for tick in figure.axes[0].get_xticklabels()]
            self.assertEqual(ticks, list(names.values()))
            plt.close(figure)

    def test_the_choice_of_tune_is_ringed_and_the_legend_has_what_is_drawn(self):
        folder = made(
            "tuned",
            "tune",
            "impedance_at_wall",
            "--algorithms",
            "mean",
            "--damping-ratio",
            "0.2:0.3",
        )
        (law,) = read_records(folder / "tune.csv")
        figure = draw_study(folder, SHEETS["double"])
        for ax, x in zip(figure.axes, (0, 0, 1)):
            rings = [line for line in ax.lines if line.get_markersize() == 10]
            (at,) = [point for ring in rings for point in ring.get_xydata()]
            (low, high), (bottom, top) = ax.get_xlim(), ax.get_ylim()
            self.assertTrue(low <= at[0] <= high and bottom <= at[1] <= top)
            if x == 0:
                self.assertEqual(at[0], float(law["stiffness_N_per_m"]))
        self.assertIn("choice of each law", legend_labels(figure))
        plt.close(figure)

        def refuse(row):
            row["feasible"] = "false"

        rewrite(folder / "tune_trials.csv", refuse)
        figure = draw_study(folder)
        self.assertEqual(legend_labels(figure), ["mean", "not feasible"])
        (hollow,) = [mark for mark in figure.legends[0].get_lines() if mark.get_mfc() == "white"]
        drawn = {
            (line.get_marker(), line.get_color())
            for ax in figure.axes
            for line in ax.lines
            if line.get_mfc() == "white" and len(line.get_xdata())
        }
        self.assertEqual(drawn, {(hollow.get_marker(), hollow.get_color())})
        plt.close(figure)

    def test_the_bounds_of_tune_are_drawn(self):
        bounds = ("--bound", "inside_max_m=4e-3", "--bound", "force_rms_above_30Hz_N=0.5:20")
        words = ("tune", "impedance_at_wall", "--algorithms", "mean", "--damping-ratio", "0.2:0.3")
        folder = made("bounded", *words, *bounds)
        figure = draw_study(folder, SHEETS["double"])
        depth, vibration = {4.0}, {0.5, 20.0}
        for ax, x, y in zip(figure.axes, (set(), set(), depth), (depth, vibration, vibration)):
            lines = [line for line in ax.lines if line.get_color() == RED]
            drawn = [tuple(map(set, zip(*line.get_xydata()))) for line in lines]
            self.assertEqual({xs.pop() for xs, _ in drawn if len(xs) == 1}, x)
            self.assertEqual({ys.pop() for _, ys in drawn if len(ys) == 1}, y)
            (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
            self.assertTrue(all(left < v < right for v in x) and all(low < v < high for v in y))
        self.assertIn("bound", legend_labels(figure))
        plt.close(figure)

    def test_they_fit_every_sheet(self):
        folders = [
            self.over_field(),
            self.of_variants(),
            made(
                "z", "limit", "stability_z_width", "--resolution", 0.5, "--algorithms", "mean,proxy"
            ),
            made(
                "t",
                "tune",
                "impedance_at_wall",
                "--algorithms",
                "mean",
                "--damping-ratio",
                "0.2:0.3",
            ),
        ]
        for folder in folders:
            for name, sheet in SHEETS.items():
                with self.subTest(folder.name, sheet=name):
                    assert_fits(self, draw_study(folder, sheet), sheet)
                    plt.close()
