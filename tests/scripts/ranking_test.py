"""Tests comparisons with seeds: their ranking, the picture of the ranking, and the page of many runs."""
import functools
import json
import re
import shlex
import subprocess
from html import unescape

import numpy as np
from scipy import stats

from figure_checks import assert_fits, curves_of, legend_labels
from fixture import PROGRAM, SOURCE, assert_whole
from pictures_test import Given, drawn, made, make_root, plotted

from hapbench.columns import read_records
from hapbench_pictures.__main__ import plot_line
from hapbench_pictures.bands import band
from hapbench_pictures.given import given_runs, labels
from hapbench_pictures.legibility import with_legible_ticks
from hapbench_pictures.many_runs import between
from hapbench_pictures.over_axes import Axis, over_axes
from hapbench_pictures.plot import figure_of
from hapbench_pictures.ranking_plot import draw_panel, draw_ranking, legend_of
from hapbench_pictures.ranking_values import FAILURES, Law, Scene, scenes_of
from hapbench_report.markup import known_number
from hapbench_style import SETTINGS, SHEETS, plt

LAWS = "mean,shaped_stiffness,summation,least_squares"
METRICS = "force_max_N,force_step_p99_N,inside_max_m"


def setUpModule():
    """Runs two scenes with four laws and four seeds each. Some runs of the peg in the hole fail."""
    make_root()
    made(
        "many",
        "compare",
        "peg_in_hole_2d_shaped_stiffness",
        "tap_wall",
        "--algorithms",
        LAWS,
        "--set",
        "time.steps=300",
        "--seeds",
        "4",
        "--jitter",
        "1e-6",
        "--by",
        METRICS,
    )


class RunOfDepth:
    """A run with a known value of inside_max_m."""

    scenario, path = {}, ""

    def __init__(self, value, outcome, seed):
        self.summary, self.outcome = {"metrics": {"inside_max_m": value}}, outcome
        self.state_hash = f"{value} {seed}"

    def tolerance(self, section, name):
        return 9e-4


class WithRuns(Given):
    @functools.cached_property
    def many(self):
        return self.root / "many"

    def scenes(self):
        return scenes_of(given_runs([self.many]), [self.many])


class Rankings(WithRuns):
    def test_they_are_those_of_the_program(self):
        scenes = {scene.name: scene for scene in self.scenes()}
        rows = read_records(self.many / "ranking.csv")
        self.assertEqual(len(rows), 2 * 4 * 3)
        for row in rows:
            scene = scenes[row["scenario"]]
            law = next(law for law in scene.laws if law.algorithm == row["algorithm"])
            found = scene.entries(row["metric"])[law.label]
            self.assertEqual(len(law.failures), int(row["failed"]), row)
            self.assertEqual(len(scene.seeds), int(row["common_seeds"]), row)
            self.assertEqual("" if found.rank is None else str(found.rank), row["rank"], row)
            for name in ("mean", "spread"):
                value = getattr(found, name)
                self.assertEqual(value is None, row[name] == "", row)
                if value is not None:
                    # The program adds the values of the four seeds in another order.
                    self.assertAlmostEqual(
                        value, float(row[name]), delta=1e-14 + 1e-12 * abs(value)
                    )

    def test_outcomes_that_fail_are_those_of_the_program(self):
        """Checks FAILURES against the table in results/summary/outcome.cpp, which marks outcomes that are failures with
        true."""
        source = (SOURCE / "results/summary/outcome.cpp").read_text(encoding="utf-8")
        entries = re.findall(r'\{"(\w+)",\s*(?:"[^"]*"\s*)+(,\s*true)?(?:,[^}]*)?\}', source)
        self.assertGreater(len(entries), len(FAILURES))
        self.assertEqual({name for name, fails in entries if fails}, set(FAILURES))

    def test_numbers_within_their_errors_are_not_ranked(self):
        """Ranks three laws with the values 1, 2 and 3. With errors of 5 no law has a rank; with errors of 0.1 all laws
        have ranks."""

        class Run:
            scenario, outcome, path = {}, "completes", ""

            def __init__(self, value, error, seed):
                self.summary, self.error = {"metrics": {"m": value}}, error
                self.state_hash = f"{value} {seed}"

            def tolerance(self, section, name):
                return self.error

        for error, ranks in ((5.0, [None] * 3), (0.1, [1, 2, 3])):
            laws = [
                Law(name, name, {seed: Run(value + 0.01 * seed, error, seed) for seed in range(3)})
                for name, value in (("a", 1.0), ("b", 2.0), ("c", 3.0))
            ]
            scene = Scene("s", laws, {"m": "less"})
            self.assertEqual(list(scene.ranks("m").values()), ranks)
            sentences = list(between(scene, "m"))
            self.assertEqual(len(sentences), 2)
            for sentence in sentences:
                self.assertEqual("cannot be told apart" in sentence, error == 5.0, sentence)

    def test_a_number_below_its_error_is_a_bound(self):
        for value, tolerance, shown in (
            (0.0730, 0.37, "≤ 0.5"),
            (0.0730, 0.93, "≤ 2"),
            (0.98, 0.99, "≤ 2"),
            (0.0, 0.2, "≤ 0.2"),
            (-0.1, 0.2, "0 ± 0.3"),
            (0.4567, 0.1, "0.5"),
            (0.4567, None, "0.457"),
            (None, 1.0, "–"),
        ):
            self.assertEqual(known_number(value, tolerance), shown)

    def test_an_axis_of_bounds_alone_reaches_the_largest(self):
        """Checks a panel in which every number is an upper bound, because its tolerance is not smaller than its value.
        The axis must extend to the largest bound. A law whose runs all failed has no number."""

        laws = [
            Law(name, name, {seed: RunOfDepth(value, outcome, seed) for seed in range(2)})
            for name, value, outcome in (
                ("a", 1e-4, "completes"),
                ("b", 2e-4, "completes"),
                ("c", None, "stuck"),
            )
        ]
        scene = Scene("s", laws, {"inside_max_m": "less"})
        figure, ax = plt.subplots()
        draw_panel(ax, scene, "inside_max_m")
        low, high = ax.get_xlim()
        self.assertEqual(low, 0.0)
        self.assertAlmostEqual(high, 1.1 * 1.1, delta=1e-9)  # bounds of 1.0 and 1.1 mm
        marks = sorted(high * float(at[0]) for dot in curves_of(ax, "<") for at in dot)
        np.testing.assert_allclose(marks, [1.0, 1.1])
        plt.close(figure)
        labels = [label for _, label in legend_of([scene], ["inside_max_m"])]
        self.assertEqual(labels, ["bound: not larger than its error", "failed runs"])

    def test_means_without_common_repetitions_are_said_to_be_so(self):
        """Checks the repetitions of the means. Law "c" fails in each repetition, so it is ignored in both scenes."""

        def scene(outcomes):
            laws = [
                Law(
                    name,
                    name,
                    {seed: RunOfDepth(seed + 1.0, end, seed) for seed, end in enumerate(ends)},
                )
                for name, ends in outcomes.items()
            ]
            return Scene("s", laws, {"inside_max_m": "less"})

        some = scene(
            {"a": ["completes"] * 3, "b": ["stuck"] + ["completes"] * 2, "c": ["stuck"] * 3}
        )
        none = scene({"a": ["stuck"] + ["completes"] * 2, "b": ["completes"] + ["stuck"] * 2})
        self.assertEqual((some.seeds, some.lacks_common_seeds), ({1, 2}, False))
        self.assertEqual((none.seeds, none.lacks_common_seeds), ({0, 1, 2}, True))
        entry = some.entries("inside_max_m")["a"]
        self.assertEqual((entry.mean, entry.others), (2.5, {0: 1.0}))
        # The sample deviation of 2 and 3 is the root of 1/2. The mean of two runs has this, divided by the root of 2.
        self.assertAlmostEqual(entry.shown_error, 0.5)
        labels = [label for _, label in legend_of([none], ["inside_max_m"])]
        self.assertIn("mean over the law's runs that did not fail", labels)
        self.assertIn("mean", [label for _, label in legend_of([some], ["inside_max_m"])])

    def test_seeds_have_the_numbers_of_their_folders(self):
        folder = self.many / "tap_wall"
        runs = given_runs([folder])
        for run, label in zip(runs, labels(runs)):
            self.assertTrue(label.endswith(run.folder.name.replace("seed_", "seed ")), label)


class Picture(WithRuns):
    def test_rows_are_sorted_with_mean_spread_runs_and_failures(self):
        scenes = self.scenes()
        figure = draw_ranking(
            given_runs([self.many]), ["inside_max_m", "force_max_N"], [self.many], SHEETS["double"]
        )
        panels = [(scene, metric) for scene in scenes for metric in ("inside_max_m", "force_max_N")]
        self.assertEqual(len([ax for ax in figure.axes if ax.get_visible()]), len(panels))
        for ax, (scene, metric) in zip(figure.axes, panels):
            laws, found = scene.sorted_laws(metric), scene.entries(metric)
            factor = 1e3 if "[mm]" in ax.get_xlabel() else 1.0
            dots = curves_of(ax, "o")
            for row, law in enumerate(laws):
                of = found[law.label]
                means = [at[0] for dot in dots for at in dot if at[1] == row]
                expected = [] if of.mean is None or of.is_unknown else [factor * of.mean]
                np.testing.assert_allclose(means, expected, rtol=1e-12)
                if of.mean is None or of.is_unknown:
                    continue
                singles = [at[0] for dot in dots for at in dot if row < at[1] < row + 0.5]
                np.testing.assert_allclose(
                    sorted(singles), sorted(factor * v for v in of.values.values()), rtol=1e-12
                )
                # Segments of the error bars reach from mean - spread to mean + spread.
                spans = [
                    segment[:, 0]
                    for lines in ax.collections
                    if hasattr(lines, "get_segments")
                    for segment in lines.get_segments()
                    if (segment[:, 1] == row).all()
                ]
                if of.spread is not None:
                    np.testing.assert_allclose(
                        spans, [[factor * (of.mean - of.spread), factor * (of.mean + of.spread)]]
                    )
            order = [(len(law.failures), found[law.label].mean) for law in laws]
            known = [(failures, mean) for failures, mean in order if mean is not None]
            self.assertEqual(known, sorted(known))
            failing = [row for row, law in enumerate(laws) if law.failures]
            marked = [int(at[1]) for dot in curves_of(ax, "x") for at in dot]
            self.assertEqual(marked, failing)
            for row, tick in enumerate(ax.get_yticklabels()):
                failures = laws[row].failures
                self.assertEqual(f"{len(failures)} of 4" in tick.get_text(), bool(failures))
        self.assertLessEqual({"mean", "single run", "failed runs"}, set(legend_labels(figure)))
        plt.close(figure)

    def test_a_comparison_with_a_ranking_is_drawn_by_law(self):
        plotted(self.many)
        self.assert_shows(
            self.many / "plot.svg", "failed runs", "max depth inside [mm]", "largest force [N]"
        )
        plotted(self.many / "tap_wall" / "mean", "--out", self.root / "time.svg")
        self.assert_shows(self.root / "time.svg", "time [s]")
        plotted(
            self.many / "tap_wall" / "mean", "--metric", "force_max_N", "--out", self.root / "m.svg"
        )
        self.assertNotIn("time [s]", (self.root / "m.svg").read_text())
        error = plotted(self.many, "--metric", "force_maks_N", expected=2)
        self.assertIn('nearest valid name: "force_max_N"', error)

    def test_it_fits_every_sheet(self):
        runs = given_runs([self.many])
        for name, sheet in SHEETS.items():
            for metrics in (["force_max_N"], METRICS.split(",")):
                with self.subTest(sheet=name, metrics=metrics):
                    assert_fits(self, draw_ranking(runs, metrics, [self.many], sheet), sheet)
                    plt.close()

    def test_numbers_with_many_digits_and_powers_of_ten_are_legible(self):
        """Checks metrics that differ by little, and metrics near 1e-9. A law whose runs all failed has a long label,
        which makes the panels narrow. The power of ten is in the title of the axis."""
        for first, step, title in (
            (2.655e-3, 1.7e-5, "[10⁻³ N]"),
            (1.4e-9, 1e-10, "[10⁻⁹ N]"),
            (123.4567, 1e-4, "[N]"),
        ):
            folder = self.copy("many") / "tap_wall"
            for i, law in enumerate(LAWS.split(",")):
                for file in (folder / law).glob("*/summary.json"):
                    summary = json.loads(file.read_text()) | {"tolerances": {}}
                    if law == "summation":
                        is_odd = file.parent.name in ("seed_1", "seed_3")
                        summary["outcome"] = "went_through" if is_odd else "diverges"
                    for name in METRICS.split(","):
                        summary["metrics"][name] = first + i * step
                    file.write_text(json.dumps(summary))
            for name, sheet in SHEETS.items():
                with self.subTest(sheet=name, first=first):
                    words = [str(folder), "--metric", METRICS, "--width", name]
                    figure = figure_of(plot_line().parse(words))
                    assert_fits(self, figure, sheet)
                    for ax in figure.axes[:2]:
                        self.assertIn(title, ax.get_xlabel())
                        (low, high), ticks = ax.get_xlim(), ax.get_xticks()
                        self.assertGreater(len([at for at in ticks if low <= at <= high]), 1)
                    plt.close(figure)

    def test_ticks_at_integers_are_legible(self):
        values = np.arange(1000.0, 13000.0, 1000.0)
        with plt.rc_context(SETTINGS):
            figure, axes = SHEETS["double"].panels(1, 3, 2)
            for ax in axes.flat:
                curve = [(None, values, values, {})]
                over_axes(ax, Axis.of("mass [g]", values), Axis.of("force [N]", values), curve)
        assert_fits(self, with_legible_ticks(figure), SHEETS["double"])
        plt.close(figure)


class Page(WithRuns):
    @staticmethod
    @functools.cache
    def page(*words):
        out = Given.root / "page.html"
        drawn("report", *words, "--out", out)
        return out.read_text(encoding="utf-8")

    def test_a_comparison_over_seeds_reports_the_difference_of_laws(self):
        out = made(
            "seeds",
            "compare",
            "peg_in_hole_2d_shaped_stiffness",
            "--algorithms",
            "mean,shaped_stiffness,summation",
            "--set",
            "time.steps=200",
            "--seeds",
            "4",
            "--jitter",
            "1e-6",
            "--by",
            "force_max_N",
        )
        compared = re.findall(
            r"<code>force_max_N</code>: ([\w ]+) is (\S+) ± (\S+) above ([\w ]+) over 4 seeds: (\w+)",
            re.search(r'<section id="seeds".*?</section>', self.page(out), re.S)[0],
        )
        alike = re.findall(
            r"<code>force_max_N</code>: ([\w ]+) and ([\w ]+) cannot be told apart: they differ by "
            r"less than 0.1 %",
            self.page(out),
        )
        (scene,) = scenes_of(given_runs([out]))
        succeeding = [law for law in scene.laws if not law.failures]
        self.assertGreater(len(compared), 0)
        self.assertEqual(len(compared) + len(alike), len(succeeding) - 1)
        value = lambda law: np.array(
            [
                json.loads(
                    (out / law.replace(" ", "_") / f"seed_{k}" / "summary.json").read_text()
                )["metrics"]["force_max_N"]
                for k in range(4)
            ]
        )
        for law, mean, within, best, word in compared:
            more = value(law) - value(best)
            low, high = stats.t.interval(0.95, 3, more.mean(), stats.sem(more))
            self.assertAlmostEqual(float(mean) / more.mean(), 1, delta=0.006)
            self.assertAlmostEqual(float(within) / (0.5 * (high - low)), 1, delta=0.06)
            self.assertEqual(word, "significant" if low > 0 else "not")
        for law, best in alike:
            difference = (value(law) - value(best)).mean()
            self.assertLessEqual(abs(difference), 1e-3 * value(best).max())

    def test_it_begins_with_laws_by_metrics(self):
        page = self.page(self.many)
        assert_whole(self, page)
        sections = re.findall(r'<section id="(\w+)"', page)
        self.assertEqual(sections[:2], ["summary", "seeds"])
        summary = re.search(r'<section id="summary".*?</section>', page, re.S)[0]
        self.assertIn("32 runs, 2 scenes, 4 laws, 4 seeds", summary)
        self.assertEqual(summary.count("<table"), 2)
        self.assertLess(summary.index("<table"), summary.index("Ranking, best on top"))
        for scene, table in zip(self.scenes(), re.findall(r"<tbody>(.*?)</tbody>", summary, re.S)):
            self.assertEqual(table.count("<tr>"), len(scene.laws))
            for law in scene.laws:
                if law.failures:
                    self.assertIn(f"{len(law.failures)} of 4", table)
        self.assertLess(len(page), 3e6)

    def test_what_many_runs_warn_of_stands_once(self):
        """Checks that warnings that differ only in their numbers share one entry, which states the number of runs."""
        folder = self.copy("many")
        for i, file in enumerate(sorted(folder.rglob("summary.json"))):
            summary = json.loads(file.read_text()) | {
                "warnings": [f"the tool moved by {i + 1.5} mm"]
            }
            file.write_text(json.dumps(summary))
        page = self.page(folder)
        section = re.search(r'<section id="warnings".*?</section>', page, re.S)[0]
        self.assertEqual(section.count("<li>"), 1)
        self.assertIn("<b>32 runs</b>", section)
        self.assertEqual(len(re.findall(r"the tool moved by [\d.]+ mm", section)), 1)

    def test_one_command_runs_all_again(self):
        page = self.page(self.many)
        section = re.search(r'<section id="rerun".*?</section>', page, re.S)[0]
        commands = [unescape(found) for found in re.findall(r"<code>(.*?)</code>", section, re.S)]
        self.assertEqual(commands[0].count("\n"), 0)
        words = shlex.split(commands[0])
        self.assertEqual(words[:2], ["find", str(self.many)])
        bin_folder = self.root / "bin"
        bin_folder.mkdir(exist_ok=True)
        (bin_folder / "hapbench").symlink_to(PROGRAM)
        line = commands[0].replace(str(self.many), str(self.many / "tap_wall" / "mean"))
        subprocess.run(
            ["sh", "-c", line],
            cwd=self.root,
            env={"PATH": f"{bin_folder}:/usr/bin:/bin"},
            check=True,
            stdin=subprocess.DEVNULL,
            capture_output=True,
        )
        for seed in range(4):
            first = self.many / "tap_wall" / "mean" / f"seed_{seed}" / "trajectory.csv"
            again = self.root / f"again{first}"
            self.assertEqual(again.read_bytes(), first.read_bytes())

    def test_a_band_is_mean_smallest_and_largest(self):
        time = np.array([0.0, 0.1, 0.6, 1.0])
        a, b = np.array([1.0, 2.0, 5.0, np.nan]), np.array([3.0, 4.0, 9.0, 7.0])
        middle, low, high = band(
            [(time, a, a), (time[:3], b[:3], b[:3])], np.array([0, 0.5, 0.9, 2])
        )
        np.testing.assert_array_equal(middle, [2.5, 7.0, np.nan])
        np.testing.assert_array_equal(low[:2], [1.0, 5.0])
        np.testing.assert_array_equal(high[:2], [4.0, 9.0])
