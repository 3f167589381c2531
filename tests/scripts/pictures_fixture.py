"""Short runs, a comparison and a sweep for the tests of `hapbench plot` and `hapbench report`. Arguments of such a test: the
built program, the source tree."""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM, SOURCE = Path(sys.argv[1]), Path(sys.argv[2])
sys.dont_write_bytecode = True
sys.path.insert(0, str(SOURCE / "scripts" / "python"))
ENVIRONMENT = {**os.environ, "HAPBENCH_PYTHON": sys.executable, "COLUMNS": "80"}


def hapbench(*words, locale="C", expected=0):
    """Standard output, or the error where one is expected."""
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, encoding="utf-8",
                          env={**ENVIRONMENT, "LC_ALL": locale}, stdin=subprocess.DEVNULL)
    assert done.returncode == expected, (words, done.returncode, done.stderr)
    return done.stderr if expected else done.stdout


def make_runs():
    """Once for a module, as its setUpModule."""
    scratch = tempfile.TemporaryDirectory(prefix="hapbench-pictures-")
    unittest.addModuleCleanup(scratch.cleanup)
    Given.root = root = Path(scratch.name)
    hapbench("run", "mesh_molar", "--set", "time.duration_s=0.25", "--set", "record.contacts=true", "--set", "expect={}",
             "--out", root / "mesh", "--quiet")
    hapbench("run", "springs_limited_mean", "--set", "time.steps=300", "--set", "expect={}", "--out", root / "springs", "--quiet")
    hapbench("compare", "peg_in_hole_2d_shaped_stiffness", "--algorithms", "mean,proxy,summation", "--out", root / "peg", "--quiet")
    hapbench("sweep", "springs_limited_mean", "--vary", "rendering.stiffness_N_per_m=1e3:1e4:4:log", "--vary",
             "rendering.mass_kg=0.1:0.2:3", "--set", "expect={}", "--out", root / "sweep", "--quiet")


class Given(unittest.TestCase):
    def copy(self, name):
        """A copy of a run to spoil."""
        directory = Path(tempfile.mkdtemp(dir=self.root)) / name
        shutil.copytree(self.root / name, directory)
        return directory
