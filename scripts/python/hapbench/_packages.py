"""Finds the program hapbench and the Python packages of its commands, which audit() and plot() need."""
import os
import sys
from pathlib import Path

_HERE = Path(__file__)
# Folder of this package. A package that pip installed contains the program and its files.
_PACKAGE = _HERE.absolute().parent
_PREFIX = _HERE.absolute().parents[4]  # prefix of a build or of cmake --install


def _program() -> Path:
    return next(
        (file for top in (_PACKAGE, _PREFIX) if (file := top / "bin" / "hapbench").is_file()),
        _PREFIX / "bin" / "hapbench",
    )


PROGRAM = _program()


def find_packages() -> None:
    """Makes the Python packages of the commands importable. Sets HAPBENCH_PROGRAM to the program that belongs to this
    package, unless the variable is already set."""
    installed = (top / "share" / "hapbench" / "scripts" / "python" for top in (_PACKAGE, _PREFIX))
    folders = (_HERE.resolve().parents[1], *installed)
    folder = next((one for one in folders if (one / "hapbench_audit").is_dir()), None)
    if folder is not None and str(folder) not in sys.path:
        sys.path.append(str(folder))
    if PROGRAM.is_file():
        os.environ.setdefault("HAPBENCH_PROGRAM", str(PROGRAM))
    use_this_python()


def use_this_python() -> None:
    """Makes the program run its Python commands, such as plot and report, with this Python, if pip installed the
    program with this package."""
    if PROGRAM.is_relative_to(_PACKAGE):
        os.environ.setdefault("HAPBENCH_PYTHON", sys.executable)
