"""Shared by the tests of scripts: the tree, the built program (their first argument), and commands to run."""
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
PROGRAM = Path(sys.argv[1] if len(sys.argv) > 1 else "hapbench").resolve()
ENVIRONMENT = {**os.environ, "HAPBENCH_PYTHON": sys.executable, "PYTHONDONTWRITEBYTECODE": "1", "COLUMNS": "80", "HAPBENCH_LIVE": ""}
sys.dont_write_bytecode = True
sys.path.insert(0, str(SOURCE / "scripts" / "python"))


def ran(*words, cwd=None, env=ENVIRONMENT, **environment):
    """The finished process of a command, with its output, but for lines of progress, which come with time. `environment`: variables
    set besides those of `env`."""
    done = subprocess.run([*map(str, words)], cwd=cwd, env={**env, **environment}, capture_output=True, text=True, encoding="utf-8",
                          stdin=subprocess.DEVNULL)
    done.stderr = without_progress(done.stderr)
    return done


def without_progress(said):
    return re.sub(r"[^\n]*( \.\.\. \d+ s|: +\d+ %[^\n]*)\n", "", said)


def must(*words, statuses=(0,), **options):
    """Standard output of a command that ends with one of the statuses."""
    done = ran(*words, **options)
    assert done.returncode in statuses, f"{' '.join(map(str, words))}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout


def hapbench(*words, locale="C", expected=0):
    """Standard output of the program, or what it says on standard error if another status than 0 is expected."""
    done = ran(PROGRAM, *words, LC_ALL=locale)
    assert done.returncode == expected, (words, done.returncode, done.stderr)
    return done.stderr if expected else done.stdout


def scratch_folder(of):
    """A folder that goes with a test, a class of tests (`of` is the class) or a module (`of` is unittest)."""
    scratch = tempfile.TemporaryDirectory(prefix="hapbench-test-")
    add = {unittest: unittest.addModuleCleanup}.get(of) or (of.addClassCleanup if isinstance(of, type) else of.addCleanup)
    add(scratch.cleanup)
    return Path(scratch.name).resolve()


def main():
    unittest.main(argv=sys.argv[:1])
