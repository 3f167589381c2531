"""Short runs, a comparison and a sweep for the tests of `hapbench plot` and `hapbench report`."""
import shutil
import tempfile
import unittest
from functools import partial
from pathlib import Path

from fixture import PROGRAM, hapbench, in_process, scratch_folder

from hapbench_pictures.__main__ import main as pictures


def drawn(command, *words, expected=0):
    """What `hapbench plot` or `report` prints, from this process, which has matplotlib loaded; on standard error if input is refused."""
    status, said, error = in_process(pictures, command, *words, HAPBENCH_PROGRAM=str(PROGRAM))
    assert status == expected, (words, status, error)
    return error if expected == 2 else said


plotted = partial(drawn, "plot")


def make_runs():
    """Once for a module, as its setUpModule."""
    Given.root = root = scratch_folder(unittest)
    hapbench("run", "mesh_molar", "--set", "time.duration_s=0.25", "--set", "record.contacts=true", "--set", "expect={}",
             "--out", root / "mesh", "--quiet")
    hapbench("run", "springs_limited_mean", "--set", "time.steps=300", "--set", "expect={}", "--out", root / "springs", "--quiet")
    hapbench("compare", "peg_in_hole_2d_shaped_stiffness", "--algorithms", "mean,proxy,shaped_stiffness,summation", "--out", root / "peg", "--quiet")
    hapbench("sweep", "springs_limited_mean", "--vary", "rendering.stiffness_N_per_m=1e3:1e4:4:log", "--vary",
             "rendering.mass_kg=0.1:0.2:3", "--set", "expect={}", "--out", root / "sweep", "--quiet")


class Given(unittest.TestCase):
    def assert_shows(self, picture, *texts):
        drawn = picture.read_text()
        for text in texts:
            self.assertIn(text, drawn)

    def copy(self, name):
        """A copy of a run to spoil."""
        directory = Path(tempfile.mkdtemp(dir=self.root)) / name
        shutil.copytree(self.root / name, directory)
        return directory
