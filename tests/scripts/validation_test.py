"""The page of scenarios/validation: its rules and its links. Arguments: the built program, the source tree."""
import math
import re
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(sys.argv[2]).resolve()
sys.path.insert(0, str(SOURCE / "scripts" / "python"))
sys.dont_write_bytecode = True
import numpy as np  # noqa: E402
from hapbench_validation.cases import FOLDER, drawn, read_cases  # noqa: E402
from hapbench_validation.judge import points_of, verdict  # noqa: E402
from hapbench_validation.predict import period  # noqa: E402

DATA, CASES = read_cases()


class Validation(unittest.TestCase):
    def test_every_link_of_the_page_leads_somewhere(self):
        for link in re.findall(r"\]\(([^)#]+)", (FOLDER / "README.md").read_text(encoding="utf-8")):
            self.assertTrue(link.startswith("https:") or (FOLDER / link).exists(), link)

    def test_the_uncertainty_and_the_verdict_follow_the_rules(self):
        case = CASES["A"]
        exact = [case.K] * 5
        for factor, word in ((1.0, "fitted"), (10.0, "fitted")):
            self.assertEqual(verdict(case, points_of(case, np.array(exact) * factor, 0.02), True)[0], word)
        case = CASES["A'"]
        for factor, word in ((1.0, "agrees"), (1.5, "agrees"), (2.0, "fails"), (0.5, "fails")):
            edges = np.array([case.K] * 5) * factor
            self.assertEqual(verdict(case, points_of(case, edges, 0.02), True)[0], word, factor)
        self.assertEqual(verdict(case, points_of(case, exact_of(case), 0.02), False)[0], "not judged")
        wide = np.array([case.K]) * np.array([[0.2], [0.4], [1.0], [2.5], [5.0]])
        self.assertEqual(verdict(case, points_of(case, wide, 0.02), True)[0], "agrees, weakly")
        point = points_of(case, exact_of(case), 0.0)[0]
        self.assertAlmostEqual(point.uncertainty, math.hypot(math.log(1.3), 0.1 / 1.8 / math.sqrt(12.0)))

    def test_the_period_is_that_of_the_swinging_handle(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "trajectory.csv"
            rows = [f"{0.00035 * k},{0.003 + 0.001 * math.sin(2 * math.pi * 0.00035 * k / 0.0231)}" for k in range(4000)]
            file.write_text("\n".join(["time_s,hx_m", *rows]), encoding="utf-8")
            # Lines between samples a 66th of a period apart leave a curve by (2 pi / 66)^3 / 60 of it.
            self.assertAlmostEqual(period(file) / 0.0231, 1.0, delta=2e-5)

    def test_samples_fill_their_ranges(self):
        for device in DATA["devices"].values():
            samples = drawn(device["unpublished"], 64)
            for name, (low, high, kind, _) in device["unpublished"].items():
                values = sorted(sample[name] for sample in samples)
                self.assertTrue(low <= values[0] and values[-1] <= high, name)
                middle = math.sqrt(low * high) if kind == "log" else 0.5 * (low + high)
                self.assertTrue(kind != "whole" or all(isinstance(value, int) for value in values), name)
                self.assertEqual(sum(value < middle for value in values), 32, name)


def exact_of(case):
    return np.array([case.K] * 3)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
