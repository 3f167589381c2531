"""The example of contacts by Python: the force of a ball on a sphere is K times its depth, along the line of their centres."""
import csv
import sys
import unittest

import numpy as np

from fixture import SOURCE, hapbench, main, must, scratch_folder

K = 20000


class SphereByPython(unittest.TestCase):
    def test_the_force_is_that_of_the_sphere(self):
        folder = scratch_folder(self)
        must(sys.executable, SOURCE / "algorithms" / "module" / "examples" / "sphere_trace.py", folder)
        hapbench("run", folder / "sphere.json", "--out", folder / "out", "--quiet")
        with open(folder / "out" / "trajectory.csv", encoding="utf-8", newline="") as lines:
            rows = list(csv.DictReader(lines))
        place, force = (np.array([[float(row[name.format(x)]) for x in "xyz"] for row in rows]) for name in ("p{}_m", "f{}_N"))
        distance = np.linalg.norm(place, axis=1, keepdims=True)
        known = K * np.maximum(0, 0.0025 - distance) * place / distance
        self.assertGreater(np.count_nonzero(known[:, 2]), 500)
        # A few roundings of 2.5 mm, times K.
        self.assertLess(np.abs(force - known).max(), 1e-13)


if __name__ == "__main__":
    main()
