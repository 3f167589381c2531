"""Tests the output of `hapbench report --tolerance` for two results."""
import math

import numpy as np

from pictures_test import Given, drawn, made, make_root

from hapbench_pictures.differences import are_equal, differences

setUpModule = make_root


class Regression(Given):
    @staticmethod
    def compared(a, b, tolerance="0", expected=0):
        return drawn("report", a, b, "--tolerance", tolerance, expected=expected)

    def repeated(self, name, *more):
        return made(
            name, "run", "peg_in_hole_2d_shaped_stiffness", "--set", "time.steps=300", *more
        )

    def test_what_differs_is_named_and_measured_as_numpy_does(self):
        a, b = self.repeated("once"), self.repeated(
            "nudged", "--set", f"rendering.stiffness_N_per_m={math.nextafter(20000, 30000)!r}"
        )
        self.assertIn("the results are equal\n", self.compared(a, self.repeated("again")))
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
        output = self.compared(
            a, self.repeated("stiffer", "--set", "rendering.stiffness_N_per_m=20002"), expected=3
        )
        self.assertRegex(output, r"field +rendering.stiffness_N_per_m +20000 +20002")
        self.assertTrue("force_max_N" in output and "not equal" in output, output)

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
            self.assertEqual(self.compared(run, other, tolerance, 2).count("\n"), 1)
