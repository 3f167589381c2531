"""The command hapbench of an environment into which pip installed it: becomes the program in the package. It does without
the package itself, whose import takes longer than most commands."""
import os
import signal
import sys
from pathlib import Path

PROGRAM = Path(__file__).parent / "hapbench" / "bin" / "hapbench"


def main():
    os.environ.setdefault("HAPBENCH_PYTHON", sys.executable)  # of plot, report, import and audit
    signal.signal(
        signal.SIGPIPE, signal.SIG_DFL
    )  # which Python ignores, and a pipe into head needs
    os.execv(PROGRAM, [str(PROGRAM), *sys.argv[1:]])
