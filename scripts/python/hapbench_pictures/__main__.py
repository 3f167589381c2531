"""python -m hapbench_pictures plot|report WORDS…; the program `hapbench` calls it."""
import sys

from hapbench_notice import Notice
from hapbench_report.json_input import InputError

SUCCESS, BAD_INPUT, INTERRUPTED = 0, 2, 130


def main(words):
    command, *rest = words
    try:
        with Notice("drawing" if command == "plot" else "writing the report"):
            if command == "plot":
                from .plot_command import plot as run
            else:
                from .report_command import report as run
            run(rest)
        sys.stdout.flush()
    except InputError as error:
        print(f"hapbench: error: {error}", file=sys.stderr)
        return BAD_INPUT
    except BrokenPipeError:
        # The reader of a pipe, such as `head`, has seen enough.
        sys.stderr.close()
        return SUCCESS
    except KeyboardInterrupt:
        print(f"hapbench: {command} stopped; nothing was written", file=sys.stderr)
        return INTERRUPTED
    return SUCCESS


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
