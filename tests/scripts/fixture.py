"""Shared by the tests of scripts: the source tree, the built program, and commands to run. As a script it runs the
tests of a file:

  python3 tests/scripts/fixture.py FILE_test.py PROGRAM [WORD...]     the words are arguments of the file
"""
import os
import re
import subprocess
import sys
import tempfile
import unittest
from contextlib import redirect_stderr, redirect_stdout
from importlib import import_module
from io import StringIO
from pathlib import Path
from unittest import mock

SOURCE = Path(__file__).resolve().parents[2]
PROGRAM = Path(sys.argv[1] if len(sys.argv) > 1 else "hapbench").resolve()
ENVIRONMENT = {
    **os.environ,
    "HAPBENCH_PYTHON": sys.executable,
    "PYTHONDONTWRITEBYTECODE": "1",
    "COLUMNS": "80",
    "HAPBENCH_LIVE": "",
}
sys.dont_write_bytecode = True
sys.path.insert(0, str(SOURCE / "scripts" / "python"))


def ran(*words, cwd=None, env=ENVIRONMENT, **environment):
    """Runs a command and returns the finished process. Progress lines, which depend on time, are removed from its
    standard error. `environment`: variables in addition to `env`."""
    done = subprocess.run(
        [*map(str, words)],
        cwd=cwd,
        env={**env, **environment},
        capture_output=True,
        text=True,
        encoding="utf-8",
        stdin=subprocess.DEVNULL,
    )
    done.stderr = without_progress(done.stderr)
    return done


def without_progress(text):
    return re.sub(r"[^\n]*( \.\.\. \d+ s|: +\d+ %[^\n]*)\n", "", text)


def must(*words, statuses=(0,), **options):
    """Runs a command and returns its standard output. Its exit status must be one of `statuses`."""
    done = ran(*words, **options)
    assert (
        done.returncode in statuses
    ), f"{' '.join(map(str, words))}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout


def hapbench(*words, expected=0):
    """Runs the program and returns its standard output. If the `expected` exit status is not 0, returns its standard
    error."""
    done = ran(PROGRAM, *words, LC_ALL="C")
    assert done.returncode == expected, (words, done.returncode, done.stderr)
    return done.stderr if expected else done.stdout


def in_process(command, *words, **environment):
    """Calls the main function of a command in this process, because starting a process takes longer. Returns status,
    standard output and standard error."""
    output, error = StringIO(), StringIO()
    with redirect_stdout(output), redirect_stderr(error), mock.patch.dict(os.environ, environment):
        try:
            status = command([*map(str, words)])
        except SystemExit as end:
            status = end.code
    return status, output.getvalue(), without_progress(error.getvalue())


def assert_whole(test, page):
    """Asserts that a page refers to no other file, and that each link within the page has exactly one target."""
    for reference in re.findall(r'(?:src|href)="([^"]*)"', page):
        test.assertRegex(reference, r"^(#|data:)")
    names = re.findall(r'\bid="([^"]+)"', page)
    test.assertEqual(len(names), len(set(names)))
    test.assertLessEqual(set(re.findall(r'href="#([^"]+)"', page)), set(names))


def scratch_folder(of):
    """Returns a new folder. It is deleted after a test (`of` is the test), after the tests of a class (`of` is the
    class), or after a module (`of` is unittest)."""
    scratch = tempfile.TemporaryDirectory(prefix="hapbench-test-")
    add = {unittest: unittest.addModuleCleanup}.get(of) or (
        of.addClassCleanup if isinstance(of, type) else of.addCleanup
    )
    add(scratch.cleanup)
    return Path(scratch.name).resolve()


if __name__ == "__main__":
    del sys.argv[0]
    file = Path(sys.argv[0]).resolve()
    sys.path.insert(0, str(file.parent))
    unittest.main(import_module(file.stem), argv=sys.argv[:1])
