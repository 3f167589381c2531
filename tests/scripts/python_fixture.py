"""The Python package with its compiled module, for its tests. Arguments: the program, the source tree, the folder of the built
package."""
import json
import sys
import unittest
import warnings
from functools import partial
from pathlib import Path

from fixture import ENVIRONMENT as OF_TESTS
from fixture import PROGRAM, SOURCE, hapbench as program, main, ran, scratch_folder  # noqa: F401  (for the tests)

PACKAGES = Path(sys.argv[-1]).resolve()
sys.path.insert(0, str(PACKAGES))

import hapbench  # noqa: E402  (the path comes first)

PEG = "peg_in_hole_2d_shaped_stiffness"
WEDGE = "wedge_stiffness"  # in which a hand is free, so that --jitter may shift it
# Short, and with contact from the first step on.
SHORT = {"time.steps": 300, "expect": "{}"}
EVERYTHING = {"record.contacts": True, "record.stiffness_tensor": True, "record.energy": True, "record.torque": True,
              "record.pose": True, "record.ratio_iterations": "[0,3]"}
ENVIRONMENT = {**OF_TESTS, "PYTHONPATH": str(PACKAGES)}
python = partial(ran, sys.executable, env=ENVIRONMENT)


def words_of(overrides):
    return [word for field, value in overrides.items() for word in ("--set", f"{field}={value if isinstance(value, str) else json.dumps(value)}")]


class Scratch(unittest.TestCase):
    def setUp(self):
        self.root = scratch_folder(self)
        warnings.simplefilter("ignore", hapbench.ScenarioWarning)
