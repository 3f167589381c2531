"""The command hapbench of a Python environment into which pip installed the package. It replaces this process by the
program in the package. It does not import the package, because that import takes longer than most commands."""
import os
import signal
import sys
from pathlib import Path

PROGRAM = Path(__file__).parent / "hapbench" / "bin" / "hapbench"


def main():
    # Python with which the program runs plot, report, import and audit.
    os.environ.setdefault("HAPBENCH_PYTHON", sys.executable)
    signal.signal(
        signal.SIGPIPE, signal.SIG_DFL
    )  # Python ignores SIGPIPE; the program needs its default action for a pipe into head
    os.execv(PROGRAM, [str(PROGRAM), *sys.argv[1:]])
