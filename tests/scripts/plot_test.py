"""`hapbench plot`, the pages of `hapbench report`, and what that says of two results with --tolerance."""
import functools
import html
import json
import math
import os
import re
import shlex
import shutil
import tempfile
from pathlib import Path
from unittest import mock

import numpy as np
from scipy import stats

from fixture import PROGRAM, SOURCE, assert_whole, hapbench
from pictures_test import Given, drawn, made, make_runs, plotted

from hapbench.columns import header
from hapbench_looks import CLASSES
from hapbench_pictures.differences import are_equal, differences
from hapbench_pictures.given import given_runs, labels, named
from hapbench_pictures.panels import looks
from hapbench_pictures.plot import legend_columns, legend_of
from hapbench_pictures.sweep_plot import Sweep, sensitivity
from hapbench_style import picture, plt

setUpModule = make_runs
SECTIONS = ["summary", "replay", "curves", "metrics", "scenario", "rerun", "provenance"]
FEW_STEPS = ("--set", "time.steps=20", "--set", "expect={}")


class Plot(Given):
    def test_a_picture(self):
        self.assertEqual(
            hapbench("plot", self.root / "mesh"), f"picture in {self.root / 'mesh' / 'plot.svg'}\n"
        )
        self.assert_shows(
            self.root / "mesh" / "plot.svg",
            "|rendered force| [N]",
            "largest depth [mm]",
            "stiffness ratio [K]",
            "colliding points",
            "tip x [mm]",
            "tip z [mm]",
            "filled: section of the solid",
            "outlines: the tool at four times",
            "time [s]",
        )
        for name, start in (("a.svg", b"<?xml"), ("a.png", b"\x89PNG"), ("a.pdf", b"%PDF")):
            self.assertEqual(
                plotted(self.root / "springs", "--out", self.root / name),
                f"picture in {self.root / name}\n",
            )
            self.assertTrue((self.root / name).read_bytes().startswith(start))

    def test_names_with_dollars_are_no_formulas(self):
        figure, ax = plt.subplots()
        ax.plot([0, 1], [1e-3, 1e3], label="$a$ and $b$")
        ax.set_yscale("log")
        ax.set_title(r"$\bad{$")
        ax.set_xticks([0, 1], ["$x$", "y"])
        ax.legend()
        drawn_as = picture(figure, "svg").decode()
        plt.close(figure)
        for name in ("$a$ and $b$", r"$\bad{$", "$x$"):
            self.assertIn(f">{name}</text>", drawn_as)
        self.assertNotIn("mathdefault", drawn_as)  # ticks of the logarithmic axis are formulas

    def test_a_span_of_time_and_a_peak_that_is_cut_off(self):
        run = self.copy("mesh")
        table = run / "trajectory.csv"
        names, (first, *rows) = header(table), table.read_text().splitlines()
        cells = [row.split(",") for row in rows]
        touching = next(i for i, row in enumerate(cells) if int(row[names.index("colliding")]) > 0)
        cells[touching][names.index("fz_N")] = "1234.5"
        table.write_text("\n".join([first, *(",".join(row) for row in cells)]) + "\n")
        plotted(run, "--y", "force")
        self.assert_shows(run / "plot.svg", "peak 1.23e+03 N")
        after = float(cells[touching + 1][names.index("time_s")])
        plotted(run, "--y", "force", "--from", after, "--to", 0.24)
        self.assertNotIn("peak", (run / "plot.svg").read_text())

    def test_labels_tell_runs_apart(self):
        runs = given_runs([self.root / "peg"])
        self.assertEqual(labels(runs), ["mean", "proxy", "shaped stiffness", "summation"])
        runs = given_runs([self.root / "peg" / "mean", self.root / "springs"])
        self.assertEqual(labels(runs), ["peg_in_hole_2d_shaped_stiffness", "springs_limited_mean"])
        runs = self.variants({"seed": 1}, {"seed": 2})
        self.assertEqual(named(runs), (["mean, seed 1", "mean, seed 2"], ["mean", "mean"]))
        runs = self.variants(
            {"rendering.stiffness_N_per_m": 10000}, {"rendering.stiffness_N_per_m": 4e4}
        )
        self.assertEqual(labels(runs), ["K = 10 000 N/m", "K = 40 000 N/m"])
        runs = self.variants({"hand.mass_kg": 0.1}, {"rendering.mass_kg": 0.33})
        self.assertIn("rendering.mass_kg=0.33", labels(runs)[1])
        runs = self.variants({}, {})
        self.assertEqual(labels(runs), ["mean, 0/springs", "mean, 1/springs"])

    def variants(self, *changes, places="{}/springs"):
        """Copies of a run whose scenarios have other values."""
        folder = Path(tempfile.mkdtemp(dir=self.root))
        for i, change in enumerate(changes):
            shutil.copytree(self.root / "springs", folder / places.format(i))
            file = folder / places.format(i) / "scenario.effective.json"
            scenario = json.loads(file.read_text())
            for path, value in change.items():
                section, _, name = path.rpartition(".")
                (scenario.setdefault(section, {}) if section else scenario)[name] = value
            file.write_text(json.dumps(scenario))
        return given_runs([folder])

    def test_the_legend_has_an_entry_for_all_seeds_and_is_not_cut(self):
        runs = self.variants({"seed": 1}, {"seed": 2}, {"seed": 3})
        self.assertEqual(list(legend_of(looks(runs, *named(runs)))), ["mean (3 seeds)"])
        jittered = [{"seed": i, "initial.position_m": [0.001 * i, 0, 0]} for i in range(3)]
        runs = self.variants(*jittered, places="mean/seed_{}")
        self.assertEqual(list(legend_of(looks(runs, *named(runs)))), ["mean (3 seeds)"])
        runs = self.variants(*jittered)
        self.assertEqual(len(legend_of(looks(runs, *named(runs)))), 3)
        self.assertEqual([legend_columns(["x" * n], 7.0) for n in (5, 30, 90)], [4, 2, 1])

    def test_a_sweep_over_two_fields_is_a_map(self):
        plotted(self.root / "sweep", "--metric", "speed_max_m_per_s")
        self.assert_shows(
            self.root / "sweep" / "plot.svg", "mass [kg]", "stiffness K [N/m]", "speed max [m/s]"
        )

    def test_failed_runs_of_a_sweep_have_no_value(self):
        folder = self.copy("sweep")
        table = (folder / "sweep.csv").read_text().splitlines()
        names = table[0].split(",")
        failed, empty, through = (line.split(",") for line in table[1:4])
        failed[names.index("outcome")], failed[names.index("speed_max_m_per_s")] = "diverges", "1e9"
        empty[names.index("speed_max_m_per_s")] = ""
        through[names.index("outcome")], through[names.index("expected")] = "went_through", "false"
        (folder / "sweep.csv").write_text(
            "\n".join([table[0], *map(",".join, (failed, empty, through)), *table[4:]]) + "\n"
        )
        plotted(folder, "--metric", "speed_max_m_per_s")
        self.assert_shows(
            folder / "plot.svg",
            "diverges",
            "passed through",
            "no value",
            *(CLASSES[name][1].lower() for name in ("went_through", "diverges")),
        )

    def test_what_matters_in_a_sample(self):
        """Of a spring's oscillation the first force goes with the start alone."""
        folder = made(
            "sampled",
            "sweep",
            "springs_limited_mean",
            "--vary",
            "rendering.mass_kg=0.1:0.2",
            "--vary",
            "rendering.stiffness_N_per_m=1e3:1e5:log",
            "--vary",
            "seed=1:9",
            "--sample",
            "lhs:40",
            *FEW_STEPS,
        )
        said = plotted(folder, "--metric", "force_max_N")
        found = {
            line.split()[0]: line.split()[1:]
            for line in said.splitlines()
            if line.startswith(("rendering.", "seed")) and len(line.split()) == 4
        }
        self.assertGreater(float(found["rendering.stiffness_N_per_m"][0]), 0.5)
        self.assertLess(abs(float(found["seed"][0])), 0.5)
        self.assert_shows(folder / "plot.svg", "seed", "stiffness K [N/m]", "S\u2081")
        some = plotted(folder, "--metric", "force_max_N", "--where", "rendering.mass_kg<0.15")
        self.assertIn(" over 20 runs", " ".join(some.split()))

    @mock.patch.dict(os.environ, {"HAPBENCH_PROGRAM": str(PROGRAM)})  # which evaluates them
    def test_conditions_are_those_of_sweep(self):
        """The same rows, and the same messages for what is no condition."""
        folder = made(
            "conditions",
            "sweep",
            "springs_limited_mean",
            "--vary",
            "rendering.mass_kg=0.1,0.2,0.4",
            "--vary",
            "rendering.algorithm=mean,summation",
            *FEW_STEPS,
        )
        table = folder / "sweep.csv"
        names, (first, *rows) = header(table), table.read_text().splitlines()
        cells = [row.split(",") for row in rows]
        cells[0][names.index("force_max_N")] = ""
        table.write_text("\n".join([first, *(",".join(row) for row in cells)]) + "\n")
        for condition, count in (
            ("rendering.mass_kg<=0.2", 4),
            ("rendering.mass_kg=2e-1", 2),
            ("rendering.mass_kg!=0.20", 4),
            ("rendering.algorithm=mean", 3),
            ("rendering.algorithm!=mean", 3),
            ("force_max_N>=0", 5),
            ("force_max_N!=-1", 5),
        ):
            kept = Sweep(folder, "force_max_N", [condition]).rows
            said = json.loads(hapbench("sweep", folder, "--where", condition, "--json"))
            self.assertEqual(len(kept), count, condition)
            self.assertEqual(
                [int(row["index"]) for row in kept], [row["index"] for row in said["rows"]]
            )
        both = ["rendering.mass_kg<0.3", "rendering.algorithm=mean"]
        self.assertEqual(len(Sweep(folder, None, both).rows), 2)
        for wrong in ("rendering.mass_kg==0.2", "rendering.mass<0.2", "outcome<a", "index=", "=1"):
            self.assertEqual(
                plotted(folder, "--where", wrong, expected=2),
                hapbench("sweep", folder, "--where", wrong, expected=2),
            )
        self.assertEqual(
            plotted(folder, "--where", "index>9", expected=2),
            f"hapbench: error: {table}: holds no row with index>9\n",
        )

    def test_first_order_indices_of_a_function_that_is_known(self):
        """Ishigami's, whose third variable acts together with the first alone; the last one's place
        is the logarithm's, and a list of texts adds to it. Analytic variances: Sobol and Levitan
        1999."""
        random, n, pi = np.random.default_rng(7), 1000, np.pi
        x = random.uniform(-pi, pi, (3, n))
        texts = [["low", "middle", "high"][i] for i in random.integers(0, 3, n)]
        y = (
            np.sin(x[0])
            + 7 * np.sin(x[1]) ** 2
            + 0.1 * x[2] ** 4 * np.sin(x[0])
            + np.array([{"low": -2, "middle": 0, "high": 2}[t] for t in texts])
        )
        own = [0.5 * (1 + 0.1 * pi**4 / 5) ** 2, 49 / 8, 0.0, 8 / 3]
        total = sum(own) + 0.01 * pi**8 * (1 / 18 - 1 / 50)
        columns = [
            (x[0], (x[0] + pi) / (2 * pi)),
            (x[1], (x[1] + pi) / (2 * pi)),
            (x[2], (x[2] + pi) / (2 * pi)),
            (texts, None),
        ]
        for (column, place), variance in zip(columns, own):
            found = sensitivity(column, place, y)
            # Six cosines leave 0.1 % of sin(x) out. Of independent points the jackknife's standard
            # error is about the true one.
            self.assertLess(abs(found.first_order - variance / total), 3 * found.error + 1e-3)
            self.assertLess(found.error, 0.035)
        self.assertIsNone(sensitivity(texts[:10], None, y[:10]))
        self.assertIsNone(sensitivity(x[0], columns[0][1], np.ones(n)))

    def test_axes_are_as_they_were_varied(self):
        for values, logarithmic, *sample in (
            ("1e3:1e5:5", False),
            ("1e3:4e3:5:log", True),
            ("1000,2000,3000", False),
            ("10,100,50000", True),
            ("1e3:1e5", False, "--sample", "random:9"),
        ):
            folder = made(
                "varied",
                "sweep",
                "springs_limited_mean",
                "--vary",
                f"rendering.stiffness_N_per_m={values}",
                *sample,
                *FEW_STEPS,
            )
            self.assertEqual(Sweep(folder, None).is_logarithmic(0), logarithmic, values)

    def test_maps_and_limits(self):
        over = made(
            "over", "limit", "stability_z_width", "--resolution", 0.5, "--algorithms", "mean,proxy"
        )
        self.assert_plot_shows(
            over,
            "theoretical limit",
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
        # Without a linear edge no closed form of it is drawn.
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
        for text in ("theoretical limit", "stable (Gil, Hulin)", "exact, undamped handle"):
            self.assertNotIn(text, (rubbed / "plot.svg").read_text())
        for words, said in (
            ((over, limit), "one such folder alone"),
            ((limit, "--y", "force"), "allowed for it: --out"),
        ):
            self.assertIn(said, plotted(*words, expected=2))
        (limit / "limit_runs.csv").write_text("algorithm,class\nmean,stable\n")
        self.assertIn("is not a table that hapbench wrote", plotted(limit, expected=2))

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
            "force max, order 1.0",
            "inside max, no order",
            "final position m.x, order 1.",
            "formal order 1",
            "time step [s]",
            "relative error",
            "processor time per run [s]",
        )
        made("converge", "converge", "springs_oscillation", "--metric", "inside_max_m")
        self.assertIn("nothing to draw: no level has an error above 0", plotted(folder, expected=2))

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
            "largest depth inside [mm]",
            "force above 30 Hz [N rms]",
            "recommended",
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

    def test_new_draws_a_preview(self):
        bur = self.root / "bur.json"
        hapbench(
            "new",
            "bur",
            "--from",
            SOURCE / "scenarios/library/examples/data/bumpy.obj",
            "--extent",
            "5mm",
            "--preview",
            "--out",
            bur,
            "--quiet",
        )
        self.assert_shows(bur.with_suffix(".svg"), "outlines: the tool at four times")

    def test_bad_input(self):
        mesh, sweep = self.root / "mesh", self.root / "sweep"
        for words, said in (
            ((mesh, "--y", "forse"), 'nearest valid name: "force"'),
            ((mesh, "--y", "qqq"), "or a column of trajectory.csv: step, time_s,"),
            ((mesh, "--y", "energy"), "run it with --set record.energy=true"),
            ((mesh, "--y", "torque"), "has no tx_Nm; run it with --set record.torque=true"),
            ((mesh, "--out", "x.gif"), "allowed: .svg, .png, .pdf"),
            ((self.root / "mseh",), 'nearest valid name: "mesh"'),
            ((sweep, "--metric", "speed_max"), 'nearest valid name: "speed_max_m_per_s"'),
            ((sweep, "--y", "force"), "allowed for it: --metric"),
            ((mesh, "--to", "x"), "a time in seconds"),
            (
                (mesh, "--from", "5"),
                "no row of trajectory.csv between 5 and inf s; allowed: a span with rows between 0 and",
            ),
            ((sweep, mesh), "is a sweep; allowed: one such folder alone"),
            ((mesh, "--metric", "x"), "is for a sweep"),
            (("report", sweep), "is a sweep"),
            (("report", mesh, "--out", "x.pdf"), "allowed: .html"),
        ):
            error = (
                drawn(*words, expected=2) if words[0] == "report" else plotted(*words, expected=2)
            )
            self.assertTrue(
                error.startswith("hapbench: error: ") and said in error and error.count("\n") == 1,
                error,
            )


class Page(Given):
    @staticmethod
    @functools.cache
    def page(*words):
        out = Given.root / "page.html"
        hapbench("report", *words, "--out", out)
        return out.read_text(encoding="utf-8")

    def sections(self, *words):
        return re.findall(r'<section id="(\w+)"', self.page(*words))

    def scenes(self, *words):
        return json.loads(
            re.search(
                r'<script type="application/json" id="replay-data">(.*?)</script>',
                self.page(*words),
                re.S,
            )[1]
        )

    def test_sections_are_there_when_they_have_content(self):
        self.assertEqual(self.sections(self.root / "mesh"), SECTIONS)
        self.assertEqual(
            self.sections(self.root / "mesh", self.root / "springs"),
            ["differences", "summary", "diagnosis", *SECTIONS[1:]],
        )
        self.assertIn("pareto", self.sections(self.root / "peg"))
        run = self.copy("mesh")
        (run / "trajectory.csv").unlink()
        summary = json.loads((run / "summary.json").read_text()) | {
            "warnings": ["one"],
            "diagnosis": [{"says": "this", "try": "that"}],
        }
        (run / "summary.json").write_text(json.dumps(summary))
        self.assertEqual(self.sections(run), ["summary", "warnings", "diagnosis", *SECTIONS[3:]])

    def test_refers_to_nothing_outside_itself(self):
        assert_whole(self, self.page(self.root / "mesh"))

    def test_a_comparison_over_seeds_says_what_lies_between_laws(self):
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
        said = re.findall(
            r"<code>force_max_N</code>: (\w+) is (\S+) ± (\S+) above (\w+) over 4 seeds: (\w+)",
            re.search(r'<section id="seeds".*?</section>', self.page(out), re.S)[0],
        )
        self.assertEqual(len(said), 2)
        value = lambda law: np.array(
            [
                json.loads((out / law / f"seed_{k}" / "summary.json").read_text())["metrics"][
                    "force_max_N"
                ]
                for k in range(4)
            ]
        )
        for law, mean, within, least, word in said:
            more = value(law) - value(least)
            low, high = stats.t.interval(0.95, 3, more.mean(), stats.sem(more))
            self.assertAlmostEqual(float(mean) / more.mean(), 1, delta=0.006)
            self.assertAlmostEqual(float(within) / (0.5 * (high - low)), 1, delta=0.06)
            self.assertEqual(word, "significant" if low > 0 else "not")

    def test_the_commands_repeat_the_run(self):
        command = re.search(
            r"hapbench (run [^\n<]*scenario.effective.json\S*) --out",
            self.page(self.root / "springs"),
        )[1]
        again = made("again", *shlex.split(html.unescape(command)))
        self.assertEqual(
            (again / "trajectory.csv").read_bytes(),
            (self.root / "springs" / "trajectory.csv").read_bytes(),
        )

    def test_the_replay_has_every_run_and_a_scene_for_each_surface(self):
        (scene,) = self.scenes(self.root / "peg")
        self.assertEqual(
            [r["label"] for r in scene["recordings"]],
            ["mean", "proxy", "shaped stiffness", "summation"],
        )
        self.assertTrue(scene["planar"] and scene["shell"] and scene["recordings"][0]["sound"])
        scenes = self.scenes(self.root / "mesh", self.root / "springs")
        self.assertEqual(
            [(scene["id"], bool(scene["tool"]), bool(scene["springs"])) for scene in scenes],
            [("mesh_molar", True, False), ("springs_limited_mean-2", False, True)],
        )


class Regression(Given):
    @staticmethod
    def told(a, b, tolerance="0", expected=0):
        return drawn("report", a, b, "--tolerance", tolerance, expected=expected)

    def repeated(self, name, *more):
        return made(
            name, "run", "peg_in_hole_2d_shaped_stiffness", "--set", "time.steps=300", *more
        )

    def test_what_differs_is_named_and_measured_as_numpy_does(self):
        a, b = self.repeated("once"), self.repeated(
            "nudged", "--set", f"rendering.stiffness_N_per_m={math.nextafter(20000, 30000)!r}"
        )
        self.assertIn("the results are equal\n", self.told(a, self.repeated("again")))
        found = differences(a, b)
        self.assertEqual([are_equal(found, tolerance) for tolerance in (0.0, 1e-9)], [False, True])
        x, y = (
            np.genfromtxt(folder / "trajectory.csv", delimiter=",", names=True) for folder in (a, b)
        )
        differs = {
            name: np.flatnonzero((x[name] != y[name]) & ~(np.isnan(x[name]) & np.isnan(y[name])))
            for name in x.dtype.names
        }
        expected = []
        for name, rows in differs.items():
            if rows.size:
                off = np.abs(x[name] - y[name])
                expected.append(
                    (
                        f"{name}, row {np.nanargmax(off)} (first {rows[0]})",
                        np.nanmax(off),
                        np.nanmax(off)
                        / max(np.nanmax(np.abs(x[name])), np.nanmax(np.abs(y[name]))),
                    )
                )
        self.assertEqual(
            [
                (name, size, relative)
                for name, _, _, size, relative in found["summary.json"]["trajectory.csv"]
            ],
            expected,
        )
        said = self.told(
            a, self.repeated("stiffer", "--set", "rendering.stiffness_N_per_m=20002"), expected=3
        )
        self.assertRegex(said, r"field +rendering.stiffness_N_per_m +20000 +20002")
        self.assertTrue("force_max_N" in said and "not equal" in said, said)

    def test_runs_and_sweeps_are_paired_by_their_paths(self):
        for out, law, start in (("a", "summation", "0.005"), ("b", "proxy", "0.006")):
            made(
                out,
                "compare",
                "peg_in_hole_2d_shaped_stiffness",
                "--algorithms",
                f"mean,{law}",
                "--set",
                "time.steps=50",
            )
            made(
                f"{out}/sweep",
                "sweep",
                "single_spring",
                "--vary",
                "rendering.stiffness_N_per_m=100,200",
                "--set",
                f"initial.position_m=[{start},0,0]",
            )
        found = differences(self.root / "a", self.root / "b")
        self.assertEqual(list(found), ["mean/summary.json", "sweep/sweep.csv", ""])
        self.assertEqual(
            [
                found["mean/summary.json"][kind]
                for kind in ("result", "state hash", "trajectory.csv")
            ],
            [[], [], []],
        )
        self.assertIn(
            "force_max_N, row", " ".join(name for name, *_ in found["sweep/sweep.csv"]["sweep.csv"])
        )
        self.assertEqual(
            [entry[:3] for entry in found[""]["in one of them alone"]],
            [("summation/summary.json", "there", "-"), ("proxy/summary.json", "-", "there")],
        )
        self.assertFalse(are_equal(found, 1e9))

    def test_what_is_no_result_is_refused(self):
        run = self.repeated("once")
        for other, tolerance in (
            (self.root / "none", "0"),
            (run / "summary.json", "0"),
            (run, "-1"),
            (run, "nan"),
        ):
            self.assertEqual(self.told(run, other, tolerance, 2).count("\n"), 1)
