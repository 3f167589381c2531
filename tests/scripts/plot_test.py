"""Tests `hapbench plot` of runs: quantities over time, and the cross-section of the scene."""
import json
import os
import shutil
import tempfile
import warnings
from pathlib import Path
from unittest import mock

import numpy as np

from figure_checks import assert_fits, legend_labels
from fixture import PROGRAM, SOURCE, hapbench, ran
from pictures_test import Given, drawn, made, make_runs, plotted

from hapbench.columns import header
from hapbench_pictures.given import given_runs, labels, named
from hapbench_pictures.panels import looks
from hapbench_pictures.quantities import SHORT
from hapbench_pictures.run_plot import draw_runs, legend_of
from hapbench_style import SHEETS, fix_layout, legend_columns, picture, plt

setUpModule = make_runs
ALWAYS = (-np.inf, np.inf)
LOG = SOURCE / "tests/data/loop.csv"


class Plot(Given):
    def test_a_picture(self):
        self.assertEqual(
            hapbench("plot", self.root / "mesh"), f"picture in {self.root / 'mesh' / 'plot.svg'}\n"
        )
        self.assert_shows(
            self.root / "mesh" / "plot.svg",
            "|rendered force| [N]",
            "largest depth [mm]",
            "stiffness ratio [1]",
            "colliding points [1]",
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

    def test_files_of_the_working_folder_are_not_executed(self):
        """Checks the commands in Python in a folder that has files with the names of modules."""
        folder = Path(tempfile.mkdtemp(dir=self.root))
        for name in ("signal", "random", "statistics", "numpy", "matplotlib", "hapbench"):
            (folder / f"{name}.py").write_text("open('executed', 'w').close()\n1 / 0\n")
        mesh = self.root / "mesh"
        for words in (
            ("plot", mesh, "--y", "force", "--out", "a.svg"),
            ("report", self.root / "springs", "--out", "a.html"),
            ("audit", mesh / "trajectory.csv"),
            ("import", "stroke", "--json"),
        ):
            done = ran(PROGRAM, *words, cwd=folder)
            self.assertNotIn("Traceback", done.stderr)
            self.assertNotIn("internal error", done.stderr)
            self.assertIn(done.returncode, (0, 3), done.stderr)
            self.assertFalse((folder / "executed").exists(), words)

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
        # The tick labels of the logarithmic axis are formulas. Their source text must not appear in the picture.
        self.assertNotIn("mathdefault", drawn_as)

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

    def test_labels_distinguish_runs(self):
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

    def variants(self, *changes, pattern="{}/springs"):
        """Returns the folders of copies of a run. Each element of `changes` modifies the scenario of one copy."""
        folder = Path(tempfile.mkdtemp(dir=self.root))
        for i, change in enumerate(changes):
            shutil.copytree(self.root / "springs", folder / pattern.format(i))
            file = folder / pattern.format(i) / "scenario.effective.json"
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
        runs = self.variants(*jittered, pattern="mean/seed_{}")
        self.assertEqual(list(legend_of(looks(runs, *named(runs)))), ["mean (3 seeds)"])
        runs = self.variants(*jittered)
        self.assertEqual(len(legend_of(looks(runs, *named(runs)))), 3)
        self.assertEqual([legend_columns(4 * ["x" * n], 7.0) for n in (5, 30, 90)], [4, 2, 1])

    def test_a_name_that_begins_with_an_underscore_is_in_the_legend(self):
        runs = self.variants({}, {}, {})
        for run, name in zip(runs, ("_old", "_new", "base")):
            run.summary["name"] = name
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            figure = draw_runs(runs, [SHORT["force"]], False, ALWAYS)
        self.assertEqual(legend_labels(figure), ["_old", "_new", "base"])
        plt.close(figure)

    def test_time_axes_below_each_other_are_aligned(self):
        """Checks pictures with one and with two cross-sections of scenes: panels below each other with a time axis have
        the same left and right end."""
        quantities = [SHORT[name] for name in ("force", "depth", "ratio", "contacts")]
        for names in (["mesh", "springs"], ["mesh"], ["springs"]):
            runs = given_runs([self.root / name for name in names])
            for end in (0.2, 0.25):
                figure = draw_runs(runs, quantities, True, (0, end))
                fix_layout(figure)
                axes = [ax for ax in figure.axes if "tip" not in ax.get_xlabel()]
                self.assertEqual(len(axes), 4)
                # In a picture of one run of springs, the first quantity is beside the scene.
                below = axes[1:] if names == ["springs"] else axes
                ends = np.array([ax.get_position().intervalx for ax in below])
                np.testing.assert_allclose(ends, ends[:1].repeat(len(ends), 0), atol=1e-9)
                plt.close(figure)

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
        mesh, sweep, table = (self.root / name for name in ("mesh", "sweep", "table.csv"))
        table.write_text("a,b\n1,2\n")
        trace = mesh / "contact_trace.csv"
        trace.write_text("time_s,x_m\n")
        self.addCleanup(trace.unlink)
        for words, message in (
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
            ((mesh, "--metric", "x"), "allowed: a metric of the runs"),
            ((mesh, "--metric", "force_max_N", "--y", "force"), "allowed without --y"),
            ((mesh, "--where", "seed=1"), "--where: is for a sweep's folder"),
            ((mesh, "--width", "singel"), 'nearest valid name: "single"'),
            (
                (sweep, "--metric", "force_max_N,speed_max_m_per_s"),
                "allowed for a sweep: one column",
            ),
            (("report", sweep), "is a sweep"),
            (("report", mesh, "--out", "x.pdf"), "allowed: .html"),
            ((table,), f'{table}: is a file, not a folder; allowed: a folder that "hapbench run"'),
            (("report", LOG), f'{LOG}: is a file, not a folder; allowed: a folder that "hapbench'),
            ((sweep / "sweep.csv",), f"is a table of the folder {sweep}; allowed: {sweep}"),
            ((trace,), f"{trace}: is a file of a run, and is not drawn alone; allowed: {mesh}, "),
            (("report", trace), f"{trace}: is a file of a run, and is not drawn alone; allowed: "),
        ):
            error = (
                drawn(*words, expected=2) if words[0] == "report" else plotted(*words, expected=2)
            )
            self.assertTrue(
                error.startswith("hapbench: error: ")
                and message in error
                and error.count("\n") == 1,
                error,
            )

    def test_start_and_end_of_a_path_are_marked(self):
        run = given_runs([self.root / "mesh"])
        figure = draw_runs(run, [], True, ALWAYS)
        (ax,) = figure.axes
        marks = {line.get_marker(): line for line in ax.lines if len(line.get_xdata()) == 1}
        path = max((line.get_xydata() for line in ax.lines if line.get_marker() == "None"), key=len)
        np.testing.assert_array_equal(marks["o"].get_xydata()[0], path[0])
        np.testing.assert_array_equal(marks["s"].get_xydata()[0], path[-1])
        self.assertGreaterEqual(min(marks[m].get_markersize() for m in "os"), 6)  # [points]
        plt.close(figure)

    def test_distinct_scenes_have_panels_of_their_own(self):
        """Checks that two scenes have separate panels. A copy of a scene that is moved far away has a separate panel,
        too; a copy that is moved a little does not."""
        runs = given_runs([self.root / "mesh", self.root / "springs"])
        figure = draw_runs(runs, [], True, ALWAYS)
        self.assertEqual(
            [ax.get_title(loc="left") for ax in figure.axes], ["mesh molar", "springs limited mean"]
        )
        plt.close(figure)
        for away, panels in ((1e-4, 1), (0.9, 2)):
            moved = self.copy("mesh")
            table = moved / "trajectory.csv"
            names, (first, *rows) = header(table), table.read_text().splitlines()
            x = names.index("px_m")
            cells = [row.split(",") for row in rows]
            for row in cells:
                row[x] = str(float(row[x]) + away)
            table.write_text("\n".join([first, *(",".join(row) for row in cells)]) + "\n")
            figure = draw_runs(given_runs([self.root / "mesh", moved]), [], True, ALWAYS)
            self.assertEqual(len(figure.axes), panels, away)
            plt.close(figure)

    # The program computes the surface for the picture.
    @mock.patch.dict(os.environ, {"HAPBENCH_PROGRAM": str(PROGRAM)})
    def test_an_open_scan_is_a_surface_and_no_solid(self):
        """Checks that a molar without one of its triangles is drawn as an open surface, and the complete molar as a
        solid."""
        closed = SOURCE / "scenarios/library/examples/data/molar.obj"
        lines = closed.read_text().splitlines(keepends=True)
        last = max(i for i, line in enumerate(lines) if line.startswith("f "))
        scan = self.root / "scan.obj"
        scan.write_text("".join(lines[:last] + lines[last + 1 :]))
        for mesh, filled in ((closed, True), (scan, False)):
            environment = json.dumps(
                json.loads((self.root / "mesh" / "scenario.effective.json").read_text())[
                    "environment"
                ]
                | {"file": str(mesh)}
            )
            run = made(
                f"of_{mesh.stem}",
                "run",
                "mesh_molar",
                "--set",
                f"environment={environment}",
                "--set",
                "time.steps=20",
                "--set",
                "expect={}",
            )
            figure = draw_runs(given_runs([run]), [], True, ALWAYS)
            (ax,) = figure.axes
            self.assertEqual(bool(ax.collections), filled, mesh)
            label = ax.get_xlabel().replace("\n", " ")
            self.assertEqual("section of the solid" in label, filled, label)
            self.assertEqual("an open scan" in label, not filled, label)
            plt.close(figure)

    @mock.patch.dict(os.environ, {"HAPBENCH_PROGRAM": str(PROGRAM)})
    def test_it_fits_every_sheet(self):
        runs = given_runs([self.root / "peg"])
        two = given_runs([self.root / "mesh", self.root / "springs"])
        force = [SHORT[name] for name in ("force", "depth", "ratio", "contacts")]
        for name, sheet in SHEETS.items():
            for of in (runs, two, two[:1]):
                with self.subTest(sheet=name, runs=len(of)):
                    assert_fits(self, draw_runs(of, force, True, ALWAYS, sheet), sheet)
                    plt.close()
        mesh = self.root / "mesh"
        plotted(mesh, "--width", "single", "--out", self.root / "single.svg")
        # 89 mm are 252.28 points.
        self.assertRegex((self.root / "single.svg").read_text(), r'width="252\.28\d*pt"')
