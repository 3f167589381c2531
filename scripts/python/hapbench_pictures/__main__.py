"""python -m hapbench_pictures plot|report WORDS…; the program `hapbench` calls it."""
import sys

from hapbench_command import BAD_INPUT, INTERRUPTED, SUCCESS, Notice, say_error, unwritable
from hapbench_report.json_input import InputError


def main(words):
    command, *rest = words
    try:
        with Notice("drawing" if command == "plot" else "writing the report"):
            if command == "plot":
                from .plot import plot as run
            else:
                from .report import report as run
            status = run(rest)
        sys.stdout.flush()
        return status or SUCCESS
    except InputError as error:
        say_error(error)
        return BAD_INPUT
    except BrokenPipeError:
        # The reader of a pipe, such as `head`, has seen enough.
        sys.stderr.close()
        return SUCCESS
    except OSError as error:
        return unwritable(error)
    except KeyboardInterrupt:
        print(f"hapbench: {command} stopped; nothing was written", file=sys.stderr)
        return INTERRUPTED


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
