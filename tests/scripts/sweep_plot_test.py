"""Tests `hapbench plot` of sweeps."""
import json
import os
from unittest import mock

import numpy as np

from figure_checks import assert_fits
from fixture import PROGRAM, hapbench
from pictures_test import Given, made, make_runs, plotted

from hapbench.columns import header
from hapbench_looks import CLASSES
from hapbench_pictures.sweep_plot import Sweep, draw_sweep, sensitivity
from hapbench_style import SHEETS, plt

setUpModule = make_runs
FEW_STEPS = ("--set", "time.steps=20", "--set", "expect={}")


class Sweeps(Given):
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
        """Checks the influence of fields on the largest force of an oscillating spring. This is the force at the start,
        which the seed does not change."""
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
        output = plotted(folder, "--metric", "force_max_N")
        found = {
            line.split()[0]: line.split()[1:]
            for line in output.splitlines()
            if line.startswith(("rendering.", "seed")) and len(line.split()) >= 4
        }
        self.assertGreater(float(found["rendering.stiffness_N_per_m"][0]), 0.5)
        self.assertLess(abs(float(found["seed"][0])), 0.5)
        self.assert_shows(folder / "plot.svg", "seed", "stiffness K [N/m]", "S\u2081")
        some = plotted(folder, "--metric", "force_max_N", "--where", "rendering.mass_kg<0.15")
        self.assertIn(" over 20 runs", " ".join(some.split()))

    # The program evaluates the conditions of --where.
    @mock.patch.dict(os.environ, {"HAPBENCH_PROGRAM": str(PROGRAM)})
    def test_conditions_are_those_of_sweep(self):
        """Checks that --where selects the same rows as in `sweep`, with the same error messages."""
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
            output = json.loads(hapbench("sweep", folder, "--where", condition, "--json"))
            self.assertEqual(len(kept), count, condition)
            self.assertEqual(
                [int(row["index"]) for row in kept], [row["index"] for row in output["rows"]]
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
        first_metric = names.index("outcome") + 1
        empty = [[*row[:first_metric], *[""] * (len(row) - first_metric)] for row in cells]
        table.write_text("\n".join([first, *(",".join(row) for row in empty)]) + "\n")
        self.assertEqual(
            plotted(folder, expected=2),
            f"hapbench: error: {table}: no row has a metric with a number\n",
        )

    def test_first_order_indices_of_a_function_that_is_known(self):
        """Compares Sobol indices with the analytic values for Ishigami's function (Sobol and Levitan 1999) plus a term
        that depends on a field of texts. The third variable of Ishigami's function has an effect only together with
        the first variable."""
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
        for (column, coordinate), variance in zip(columns, own):
            found = sensitivity(column, coordinate, y)
            # Six cosines represent sin(x) only approximately, which lowers the index by about 1e-3. For independent
            # points, the standard error from the jackknife is close to the true error.
            self.assertLess(abs(found.first_order - variance / total), 3 * found.error + 1e-3)
            self.assertLess(found.error, 0.035)
        self.assertIsNone(sensitivity(texts[:10], None, y[:10]))
        self.assertIsNone(sensitivity(x[0], columns[0][1], np.ones(n)))

    def test_outliers_do_not_hide_a_field(self):
        """Checks the indices of a metric that falls as 1 / K over three decades, while another field has no influence.
        The values of three runs are a million times too large."""
        random, n = np.random.default_rng(11), 200
        field, idle = random.uniform(0, 1, n), random.uniform(0, 1, n)
        y = 10 ** (-3 * field) * random.lognormal(0, 0.2, n)
        y[:3] *= 1e6
        decides, other = sensitivity(field, field, y), sensitivity(idle, idle, y)
        self.assertLess(decides.rank, -0.93)
        self.assertLess(decides.first_order, 0.2)
        # Variance of the logarithm: (3 ln 10)^2 / 12 = 3.98 by the field, 0.04 by noise, and 3/200 (6 ln 10)^2 = 2.86
        # by the outliers. Without outliers, the index of the field would be 0.99.
        self.assertGreater(
            decides.of_logarithm, 3.98 / (3.98 + 0.04 + 2.86) - 2 * decides.error_of_logarithm
        )
        self.assertGreater(decides.of_logarithm, other.of_logarithm + 3 * other.error_of_logarithm)

    def test_the_logarithm_has_an_index_if_values_span_a_decade(self):
        coordinate = np.linspace(0, 1, 100)
        for y, exists in (
            (1 + 9.1 * coordinate, True),
            (1 + 8.9 * coordinate, False),
            (coordinate, False),  # zero has no logarithm
            (-1 - 20 * coordinate, False),
        ):
            found = sensitivity(coordinate, coordinate, y)
            self.assertEqual(found.of_logarithm is not None, exists, y[-1])
        # y is an exponential function of the field, so that its logarithm is linear in the field.
        found = sensitivity(coordinate, coordinate, np.exp(12 * coordinate))
        self.assertGreater(found.of_logarithm, 0.998)
        self.assertLess(found.first_order, found.of_logarithm - 0.05)

    def test_both_indices_are_shown(self):
        folder = made(
            "decades",
            "sweep",
            "springs_limited_mean",
            "--vary",
            "rendering.mass_kg=0.1:0.2",
            "--vary",
            "rendering.stiffness_N_per_m=1e3:1e5:log",
            "--sample",
            "lhs:40",
            *FEW_STEPS,
        )
        output = plotted(folder, "--metric", "force_step_max_N")
        self.assertIn("of the logarithm", output.splitlines()[0])
        lines = {
            line.split()[0]: line.split()[1:]
            for line in output.splitlines()
            if line.startswith("rendering.")
        }
        self.assertEqual({len(cells) for cells in lines.values()}, {5})
        self.assertEqual(list(lines)[0], "rendering.stiffness_N_per_m")
        self.assertIn(
            "Of the logarithm: the index of the logarithm of force_step_max_N",
            " ".join(output.split()),
        )
        self.assert_shows(folder / "plot.svg", "of the logarithm")

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

    def test_it_fits_every_sheet(self):
        for sheet in SHEETS.values():
            assert_fits(self, draw_sweep(Sweep(self.root / "sweep", None), sheet), sheet)
            plt.close()
