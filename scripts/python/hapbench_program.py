"""The command hapbench of an environment into which pip installed it. This process is replaced by the program in the
package. The package itself is not imported, because its import takes longer than most commands."""
import os
import signal
import sys
from pathlib import Path

PROGRAM = Path(__file__).parent / "hapbench" / "bin" / "hapbench"


def main():
    # Python for plot, report, import and audit
    os.environ.setdefault("HAPBENCH_PYTHON", sys.executable)
    signal.signal(
        signal.SIGPIPE, signal.SIG_DFL
    )  # Python ignores SIGPIPE; the program needs its default action for a pipe into head
    os.execv(PROGRAM, [str(PROGRAM), *sys.argv[1:]])
