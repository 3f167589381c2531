"""Executes the manual of the Python package, checks its types, and tests the display of results in notebooks.
Arguments: the program, the folder of the built package."""
import os
import re
import shutil
import sys
import unittest
import warnings
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from fixture import ENVIRONMENT, PROGRAM, SOURCE, must, ran, scratch_folder

PACKAGES = Path(sys.argv[-1]).resolve()
sys.path.insert(0, str(PACKAGES))

import hapbench  # noqa: E402  (the path comes first)

MANUAL = SOURCE / "scripts/python/README.md"
SHELL = ("scripts/", "export ", "/usr/bin/python3 ")

TYPED = """
import hapbench
import numpy as np
import numpy.typing as npt


@hapbench.force_law("mine", parameters={"share": hapbench.Parameter(0.5, 0, 1)})
def mine(depths: npt.NDArray[np.float64], share: float) -> npt.NDArray[np.float64]:
    return share * np.ones(len(depths))


def largest(run: hapbench.Run) -> float:
    return float(run.metrics["force_max_N"])


run = hapbench.run("drag_molar", {"seed": 2}, record=["contacts"])
force: npt.NDArray[np.float64] = run.trajectory["fx_N"]
report = hapbench.compare(["drag_molar"], ["mean", "mine"], seeds=2, by=["force_max_N"])
means: npt.NDArray[np.float64] = report.ranking.where(metric="force_max_N").mean
names: list[str] = list(report.runs)
frame = report.ranking.to_pandas()
figure = report.plot(metric="force_max_N", width="single")
text: str = hapbench.describe("mean") + hapbench.__version__
found = hapbench.load("results")
if isinstance(found, hapbench.Run):
    largest(found)
renderer = hapbench.Renderer("drag_molar", max_force_N=3.0)
status: str = renderer.step(0, (0.0, 0.0, 0.0))["status"]
simulation = hapbench.Simulation("drag_molar")
while simulation.step():
    simulation.state["force_N"]
"""


def setUpModule():
    global REPORT, RUN
    warnings.simplefilter("ignore", hapbench.ScenarioWarning)
    here = os.getcwd()
    unittest.addModuleCleanup(os.chdir, here)
    os.chdir(scratch_folder(unittest))
    short = {"time.steps": 300, "expect": {}}
    scenes = ["peg_in_hole_2d_shaped_stiffness", "tap_wall"]
    REPORT = hapbench.compare(scenes, ["mean", "proxy"], short, seeds=2)
    RUN = hapbench.run("tap_wall", short)


def blocks_of(manual):
    """Returns the indented blocks of code in a manual, without their indentation."""
    return [
        re.sub(r"^    ", "", block, flags=re.M)
        for block in re.findall(
            r"(?:^    .*\n|^\n(?=    ))+", manual.read_text(encoding="utf-8"), re.M
        )
    ]


class Manual(unittest.TestCase):
    def test_examples_are_executed(self):
        """Executes all examples in one interpreter in their order, as a reader of the page would type them."""
        if not find_spec("pandas"):
            self.skipTest("no pandas (scripts/setup --tests installs it)")
        blocks = [b for b in blocks_of(MANUAL) if not b.lstrip().startswith(SHELL)]
        self.assertGreaterEqual(len(blocks), 6)
        script = (
            "\n".join(blocks)
            + "\nprint('means', *report.ranking.where(metric='inside_max_m').mean)\n"
        )
        Path("manual.py").write_text(script, encoding="utf-8")
        env = {**ENVIRONMENT, "PYTHONPATH": str(PACKAGES)}
        output = must(sys.executable, "manual.py", env=env)
        means = [float(word) for word in output.splitlines()[-1].split()[1:]]
        self.assertEqual(len(means), 2 * 2)
        self.assertTrue(np.isfinite(means).all())
        self.assertTrue(Path("laws.pdf").read_bytes().startswith(b"%PDF"))

    def test_an_example_passes_strict_mypy(self):
        mypy = shutil.which("mypy")
        if not mypy:
            self.skipTest("no mypy (scripts/setup --tests installs it)")
        Path("typed.py").write_text(TYPED, encoding="utf-8")
        env = {**ENVIRONMENT, "MYPYPATH": str(PACKAGES)}
        words = ("--strict", "--follow-imports=silent", "--python-executable", sys.executable)
        done = ran(mypy, *words, "typed.py", env=env)
        self.assertEqual(done.returncode, 0, done.stdout)
        # The type checker must report errors in a wrong script, because the package has types.
        Path("wrong.py").write_text(
            TYPED + "hapbench.runs('x')\nhapbench.run(3)\nlargest(report)\nrun.metrics.x\n",
            encoding="utf-8",
        )
        done = ran(mypy, *words, "wrong.py", env=env)
        self.assertEqual(done.stdout.count(": error: "), 4, done.stdout)

    def test_version_is_that_of_the_program(self):
        self.assertEqual(must(PROGRAM, "--version").split()[1], hapbench.__version__)


class Results(unittest.TestCase):
    def test_a_comparison_of_several_scenarios_has_one_table(self):
        table = REPORT.comparison
        self.assertEqual(len(table), 2 * 2 * 2)
        self.assertEqual(list(table)[0], "scenario")
        for scene in set(table.scenario):
            part, own = table.where(scenario=scene), REPORT.tables[f"{scene}/comparison"]
            np.testing.assert_array_equal(part.force_max_N, own.force_max_N)
            self.assertEqual(list(part.algorithm), list(own.algorithm))
        self.assertEqual(len(REPORT.ranking.where(metric="inside_max_m").mean), 4)

    def test_length_is_the_number_of_rows(self):
        for table in (REPORT.ranking, RUN.trajectory):
            self.assertEqual(len(table), table.rows)
            self.assertEqual(len(table), len(next(iter(table.values()))))
            self.assertEqual(len(table.keys()), len(list(table)))
            self.assertEqual(len(dict(table)), len(list(table)))

    def test_every_table_has_units(self):
        self.assertEqual(RUN.trajectory.units["fx_N"], "N")
        self.assertEqual(REPORT.ranking.units["mean"], "unit of the metric")
        self.assertEqual(REPORT.comparison.units["force_max_N"], "N")
        self.assertEqual(REPORT.comparison.units["force_reversals"], "1")
        limit = hapbench.limit("spring_stiffness").limit
        self.assertEqual(limit.units["quoted_limit"], "N/m")
        self.assertIn("limit to quote", limit.meanings["quoted_limit"])
        for table in (RUN.trajectory, REPORT.ranking, REPORT.comparison, limit):
            self.assertEqual(list(table.units), list(table))

    def test_pandas_has_the_same_columns(self):
        if not find_spec("pandas"):
            self.skipTest("no pandas (scripts/setup --tests installs it)")
        for table in (RUN.trajectory, REPORT.ranking):
            frame = table.to_pandas()
            self.assertEqual(list(frame.columns), list(table))
            self.assertEqual(len(frame), len(table))
            for name, values in table.items():
                np.testing.assert_array_equal(frame[name].to_numpy(), values)
            self.assertEqual(frame.attrs["units"], table.units)

    def test_notebooks_show_runs_tables_and_rankings(self):
        self.assertIn("tap_wall", RUN._repr_html_())
        self.assertIn("force_max_N", RUN._repr_html_())
        shown = RUN.trajectory._repr_html_()
        self.assertIn("fx_N<br><small>N</small>", shown)
        self.assertEqual(shown.count("<tr>"), 1 + 20)
        self.assertIn(f"and {len(RUN.trajectory) - 20} more rows", shown)
        self.assertIn("<th", REPORT._repr_html_())
        self.assertIn("inside_max_m", REPORT._repr_html_())
        nasty = hapbench.Table({"<b>": np.array(["&<i>"], dtype=object)}, {"<b>": "<u>"})
        self.assertNotRegex(nasty._repr_html_(), "<b>|<i>|<u>")

    def test_every_result_has_a_figure(self):
        folder = Path("sweep")
        sweep = hapbench.sweep(
            "tap_wall",
            {"rendering.stiffness_N_per_m": "1e4,2e4"},
            {"time.steps": 200, "expect": {}},
            out=folder,
        )
        figures = [
            RUN.plot(),
            RUN.plot(y="force,depth", width="single"),
            hapbench.load(REPORT.folder).plot(metric=["force_max_N"], width="single"),
            sweep.plot(metric="force_max_N"),
            RUN.trajectory.plot("fx_N", "fz_N"),
            REPORT.ranking.plot("mean", x="rank"),
        ]
        for figure in figures:
            self.assertTrue(figure._repr_png_().startswith(b"\x89PNG"))
        self.assertAlmostEqual(figures[2].get_size_inches()[0], 89 / 25.4)
        with self.assertRaisesRegex(ValueError, "allowed: single, double, slide"):
            RUN.plot(width="wide")

    def test_a_name_is_explained(self):
        text = hapbench.describe("inside_max_m")
        env = {name: value for name, value in os.environ.items() if name != "COLUMNS"}
        self.assertEqual(text, must(PROGRAM, "describe", "inside_max_m", env=env))
        self.assertEqual(repr(text), str(text))
        with self.assertRaises(hapbench.ScenarioError):
            hapbench.describe("no such name")
