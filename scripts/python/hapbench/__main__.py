"""python3 -m hapbench: the program, with the same arguments and exit status."""
import signal
import sys

from .engine import main


def stop(number, _):
    sys.exit(128 + number)


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, stop)
    sys.exit(main())
