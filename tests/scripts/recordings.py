"""Recordings for the tests of `import stroke`, and functions that import them with the Python package of the
command."""
import json
import struct
import unittest
from functools import partial

import numpy as np
from fixture import PROGRAM, SOURCE, hapbench, ran, scratch_folder

from hapbench.columns import header
from hapbench_import.__main__ import command_line
from hapbench_command import Faults
from hapbench_import.options import options_of
from hapbench_import.recording import open_recording
from hapbench_import.stroke import import_stroke


DATA = SOURCE / "scenarios" / "library" / "examples" / "data"
PRESETS = SOURCE / "scenarios" / "library" / "presets"
LOG = DATA / "wipe.hapi.txt"
# Rotation of a recording with y up: its x, -z and y are the scenario's x, y and z.
Y_UP = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float)
run = partial(ran, PROGRAM)
STRAIGHT = "0,0,0,0\n0.01,0.001,0,0\n0.02,0.002,0,0\n0.03,0.003,0,0\n"


def binary_log(names, samples, number="d"):
    return (
        b"".join(name.encode() + b"\0" for name in names)
        + b"\0"
        + b"".join(struct.pack(f"<{len(s)}{number}", *s) for s in samples)
    )


class Given(unittest.TestCase):
    def setUp(self):
        self.root = scratch_folder(self)

    def write(self, data, name="rec.csv"):
        (self.root / name).write_bytes(data if isinstance(data, bytes) else data.encode())
        return str(self.root / name)

    def report(self, data, columns="time=1,position=2", **options):
        """Imports a recording with the contents `data`, with the Python package of the command. Returns (stroke,
        report)."""
        words = [self.write(data)] + (["--columns", columns] if columns else [])
        for name, value in options.items():
            if name in ("floats", "force_by_tool", "max_gap", "max_speed", "shift", "tip_axis"):
                words += ["--set", f"{name}={str(value).lower()}"]
            else:
                words += [f"--{name.replace('_', '-')}"] + ([] if value is True else [str(value)])
        given = command_line().parse(words)
        chosen = options_of(given)
        return import_stroke(open_recording(given.file, chosen), chosen)

    def stroke(self, data, columns="time=1,position=2", **options):
        return self.report(data, columns, **options)[0]

    def refusal(self, data, columns="time=1,position=2", **options):
        """Returns the error message for a recording, without the folder; empty if the recording is accepted."""
        try:
            self.report(data, columns, **options)
            return ""
        except Faults as faults:
            return "\n".join(faults.lines).replace(f"{self.root}/", "")

    def imported(self, *words):
        """Runs the command on the example log. Returns report, columns and rows of the stroke."""
        file = self.root / "stroke.csv"
        report = json.loads(
            hapbench("import", "stroke", LOG, "--preset", "hapi", "--out", file, "--json", *words)
        )
        return report, header(file), np.genfromtxt(file, delimiter=",", skip_header=1)


def moved(time):
    """Returns positions of a moving tip [m] at the times [s]."""
    angle = 6.0 * time
    return np.column_stack(
        [0.004 * np.sin(angle), 0.0025 * (1 - np.cos(angle)), 0.0008 - 0.0002 * np.sin(angle)]
    )


def table(names, *columns, separator=",", end="\n", number="%.9g"):
    rows = [separator.join(number % value for value in row) for row in np.column_stack(columns)]
    return end.join([names] * bool(names) + rows) + end
