"""Bad input, in the words of the program."""
import json
import math
import os
import re
import sys

from hapbench_command import INTERRUPTED, SUCCESS, nearest

MOST_FAULTS = 20  # reported at once


class Faults(Exception):
    """A list of (place, problem)."""

    def __init__(self, faults):
        super().__init__(faults)
        self.list = faults


def fail(problem, place=""):
    raise Faults([(place, problem)])


def require_name(got, name, valid):
    if name not in valid:
        names = ", ".join(f'"{v}"' for v in valid)
        fail(f'{got} "{name}"; allowed: {names}{nearest(name, valid)}')


def finite_number(word):
    """The whole word (bytes) as a finite number, or NaN. Stricter than float(), which accepts "1_0", "+1" and " 1"."""
    value = float(word) if re.fullmatch(rb"-?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", word) else math.nan
    return value if math.isfinite(value) else math.nan


def shown(value):
    """A JSON value as a message shows it: on one line, cut when long."""
    text = json.dumps(value, separators=(",", ":")).replace("\x7f", "\\u007f")
    return text if len(text) <= 80 else text[:80] + "..."


def quoted(word):
    """A word (bytes or text) as a message shows it."""
    data = word if isinstance(word, bytes) else word.encode("utf-8", "surrogateescape")
    return shown(data[:60].decode("utf-8", "replace"))


def plain(number):
    return repr(float(number)).removesuffix(".0")


def run_asked(run):
    """Prints the reply of `run` to the words NAME=VALUE of the command line, lists of values by their names: JSON, with
    `faults` or `io_error` in its place. Returns the exit status."""
    given = {}
    for word in sys.argv[1:]:
        # Independent of the locale: arguments are bytes, and texts are UTF-8.
        name, _, value = os.fsencode(word).decode("utf-8", "surrogateescape").partition("=")
        given.setdefault(name, []).append(value)
    try:
        reply = run(given)
    except Faults as faults:
        reply = {"faults": faults.list}
    except OSError as error:
        reply = {"io_error": error.errno}
    except KeyboardInterrupt:
        return INTERRUPTED
    sys.stdout.buffer.write(json.dumps(reply, ensure_ascii=False).encode("utf-8", "replace"))
    return SUCCESS
