"""The Python package with its compiled module, for its tests. Arguments: the built program, the source tree, the folder of
the built package."""
import json
import os
import subprocess
import sys
import tempfile
import unittest
import warnings
from pathlib import Path

PROGRAM, SOURCE, PACKAGES = (Path(word).resolve() for word in sys.argv[1:4])
sys.dont_write_bytecode = True
sys.path.insert(0, str(PACKAGES))

import hapbench  # noqa: E402  (the path comes first)

PEG = "peg_in_hole_2d_shaped_stiffness"
# Short, and with contact from the first step on.
SHORT = {"time.steps": 300, "expect": "{}"}
EVERYTHING = {"record.contacts": True, "record.stiffness_tensor": True, "record.energy": True, "record.torque": True,
              "record.pose": True, "record.ratio_iterations": "[0,3]"}
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(PACKAGES), "PYTHONDONTWRITEBYTECODE": "1"}


def program(*words, expected=0):
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, stdin=subprocess.DEVNULL)
    assert done.returncode == expected, (words, done.returncode, done.stderr)
    return done


def python(*words, **options):
    return subprocess.run([sys.executable, *map(str, words)], capture_output=True, text=True, env=ENVIRONMENT,
                          stdin=subprocess.DEVNULL, **options)


def words_of(overrides):
    return [word for field, value in overrides.items() for word in ("--set", f"{field}={value if isinstance(value, str) else json.dumps(value)}")]


class Scratch(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="hapbench-python-")
        self.addCleanup(scratch.cleanup)
        self.root = Path(scratch.name)
        warnings.simplefilter("ignore", hapbench.ScenarioWarning)
