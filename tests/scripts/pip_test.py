"""Tests `pip install ./scripts/python` in a virtual environment. pip uses the build folder of the tested program.
Arguments: the program, the folder of the built package."""
import os
import shutil
import sys
import unittest

from fixture import ENVIRONMENT, PROGRAM, SOURCE, must, ran, scratch_folder

BUILD = PROGRAM.parents[1]


def everything_in(folder):
    return {str(file.relative_to(folder)) for file in folder.rglob("*")}


class Pip(unittest.TestCase):
    def test_installs_and_removes_everything(self):
        root = scratch_folder(self)
        venv = root / "env"
        if ran(sys.executable, "-m", "venv", "--system-site-packages", venv).returncode != 0:
            self.skipTest("no venv for Python (scripts/setup --tests installs python3-venv)")
        if ran(venv / "bin/python", "-c", "import setuptools, wheel").returncode != 0:
            self.skipTest("no setuptools or wheel (scripts/setup --tests installs them)")
        before, tree = everything_in(venv), must(
            "git", "-C", SOURCE, "status", "--porcelain", "--ignored", "scripts"
        )
        env = {**ENVIRONMENT, "HAPBENCH_BUILD_DIR": str(BUILD), "PIP_NO_INDEX": "1"}
        pip = (venv / "bin/pip", "--disable-pip-version-check")
        must(*pip, "install", "--no-build-isolation", SOURCE / "scripts/python", env=env, cwd=root)
        self.assertEqual(
            must("git", "-C", SOURCE, "status", "--porcelain", "--ignored", "scripts"),
            tree,
            "the tree stays clean",
        )
        # Environment in which program, package and files are found only in the installation.
        clean = {
            name: value
            for name, value in os.environ.items()
            if not name.startswith(("PYTHON", "HAPBENCH"))
        }
        script = (
            "import hapbench, pathlib\n"
            "print(hapbench.__file__, hapbench.__version__)\n"
            "r = hapbench.run('drag_molar', {'time.duration_s': 0.05, 'expect': {}})\n"
            "print(r.outcome, len(r.trajectory))\n"
            "r.plot().savefig('run.png')\n"
            "print(hapbench.describe('linear limit'))\n"
            "print(hapbench.command('describe', 'schema')['title'])\n"
            "hapbench.load('out').plot().savefig('out.png')\n"
        )
        hapbench = venv / "bin/hapbench"
        run = (
            "run",
            "drag_molar",
            "--set",
            "time.duration_s=0.05",
            "--set",
            "expect={}",
            "--out",
            "out",
        )
        must(hapbench, *run, cwd=root, env=clean)
        must(hapbench, "plot", "out", cwd=root, env=clean)
        output = must(venv / "bin/python", "-c", script, cwd=root, env=clean)
        self.assertIn(str(venv / "lib"), output)
        self.assertIn("completes", output)
        self.assertTrue((root / "run.png").stat().st_size > 1000)
        must(*pip, "uninstall", "--yes", "hapbench", env=env, cwd=root)
        after = everything_in(venv)
        self.assertEqual({file for file in after - before if "__pycache__" not in file}, set())
        self.assertFalse([file for file in after if "hapbench" in file])

    def test_prints_how_long_it_takes_before_it_compiles(self):
        """Checks that the build prints its expected duration before it calls cmake. A dummy cmake fails at once."""
        root = scratch_folder(self)
        (root / "bin").mkdir()
        (root / "bin/cmake").write_text("#!/bin/sh\necho cmake called >&2\nexit 1\n")
        (root / "bin/cmake").chmod(0o755)
        env = {
            **ENVIRONMENT,
            "HAPBENCH_BUILD_DIR": str(root / "build"),
            "PATH": f"{root}/bin:{os.environ['PATH']}",
        }
        done = ran(sys.executable, SOURCE / "scripts/python/setup.py", "build", env=env, cwd=root)
        self.assertNotEqual(done.returncode, 0)
        self.assertRegex(
            done.stderr,
            r"(?s)about \d+ min on \d+ processors.*cmake called.*hapbench: error: cmake --preset",
        )
        shutil.rmtree(root / "build")
