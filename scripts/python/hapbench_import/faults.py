"""Bad input, in the words of the program."""
import json
import math
import os
import re

from hapbench.errors import InputError
from hapbench_command import nearest

MOST_FAULTS = 20  # reported at once


class Faults(InputError):
    """A list of (place, problem)."""

    def __init__(self, faults):
        super().__init__(faults)
        self.list = faults

    @property
    def lines(self):
        lines = [f"{place}: {problem}" if place else problem for place, problem in self.list]
        return lines + ([f"no more than {MOST_FAULTS} are shown"] if len(lines) == MOST_FAULTS else [])


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


def refuse_source(out, source, what):
    """Refuses to write over the file that is read."""
    if os.path.exists(out) and os.path.exists(source) and os.path.samefile(out, source):
        fail(f"--out {out}: is the {what} itself; allowed: another file")
