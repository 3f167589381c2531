"""Reads what a replay needs of a recorded run."""
import csv
import math
from pathlib import Path

from .json_input import InputError, at, load_object
from .markup import number
from .replay_rows import rows_to_show
from .replay_tool import tool_profile

TENSOR_COLUMNS = ("sxx", "sxy", "sxz", "syy", "syz", "szz")
# Per row: time, tip, axis, rendered force, ratio range, deepest point; with the tensor S where it was recorded.
MEASURED_COLUMNS = ("time_s", "px_m", "py_m", "pz_m", "axis_x", "axis_y", "axis_z", "fx_N", "fy_N", "fz_N",
                    "ratio_min", "ratio_max", "depth_max_m")
CONTACT_COLUMNS = ("x_m", "y_m", "z_m", "depth_m", "gradient_x", "gradient_y", "gradient_z", "weight")
NORMAL_COLUMNS = ("nx", "ny", "nz")


def numbers(file, columns, steps=None):
    """The named columns of a CSV file, each a list; with `steps`, of those rows whose step is among them."""
    try:
        with file.open(newline="", encoding="utf-8") as text:
            reader = csv.reader(text)
            header = next(reader, [])
            missing = [name for name in columns if name not in header]
            if missing:
                raise InputError(f"{file}: line 1: no column {missing[0]}")
            places = [header.index(name) for name in columns]
            step = header.index("step") if steps is not None else None
            rows = []
            for row in reader:
                if len(row) != len(header):
                    raise InputError(f"{file}: line {reader.line_num}: got {len(row)} fields; allowed: {len(header)}")
                if step is None or finite(row[step], file, reader.line_num, "step") in steps:
                    rows.append([finite(row[i], file, reader.line_num, header[i]) for i in places])
            return dict(zip(columns, zip(*rows))) if rows else {name: () for name in columns}
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{file}: cannot be read: {error}") from error


def finite(value, file, line, name):
    """The number; NaN for an empty field, which is how a row without contacts has no ratio."""
    if value == "":
        return math.nan
    try:
        parsed = float(value)
    except (TypeError, ValueError):
        parsed = math.nan
    # Beyond single precision nothing can be drawn either.
    if not abs(parsed) < 1e38:
        raise InputError(f"{file}: line {line}: {name}: got {str(value)[:40]}; allowed: a finite number")
    return parsed


class Recording:
    """One algorithm's run through a scene. `read` is `numbers` or a faster function that does the same."""

    def __init__(self, directory: Path, read=numbers):
        self.summary = load_object(directory / "summary.json")
        self.scenario = load_object(directory / "scenario.effective.json")
        self.tool = tool_profile(self.scenario, self.summary)
        self.algorithm = str(self.summary.get("algorithm", directory.name))
        # All rows, for the sound and the worst moments.
        self.columns = read(directory / "trajectory.csv", ("step", *MEASURED_COLUMNS, "colliding"))
        if not self.columns["step"]:
            raise InputError(f"{directory / 'trajectory.csv'}: holds no row")
        self.shown = rows_to_show(self.columns)
        self.steps = [int(self.columns["step"][row]) for row in self.shown]
        self.tensors = self.read_tensors(directory / "stiffness_tensor.csv", read)
        self.contacts = self.read_contacts(directory / "contacts.csv", read)

    def read_tensors(self, file, read):
        """Of every shown row; None when they were not recorded."""
        if not file.is_file():
            return None
        columns = read(file, ("step", *TENSOR_COLUMNS), set(self.steps))
        of_step = dict(zip(map(int, columns["step"]), zip(*(columns[name] for name in TENSOR_COLUMNS))))
        for step in self.steps:
            if step not in of_step:
                raise InputError(f"{file}: no row of step {step}")
        return [of_step[step] for step in self.steps]

    def read_contacts(self, file, read):
        """Of every shown row, in the order of the file, with their normals; none when they were not recorded."""
        rows = {step: [] for step in self.steps}
        if file.is_file():
            columns = read(file, ("step", *CONTACT_COLUMNS, *NORMAL_COLUMNS), set(self.steps))
            for step, *contact in zip(*columns.values()):
                rows[int(step)].append(contact)
        return [rows[step] for step in self.steps]

    def rows(self):
        """The shown rows as they are packed."""
        for i, row in enumerate(self.shown):
            yield [self.columns[name][row] for name in MEASURED_COLUMNS] + list(self.tensors[i] if self.tensors else ())

    def tips(self, touching):
        """Places of the tip in the shown rows; with `touching`, of those in contact."""
        return [[self.columns[f"p{axis}_m"][row] for axis in "xyz"] for row in self.shown
                if not touching or self.columns["colliding"][row] > 0]

    def story(self):
        """What became of it, in a few words."""
        times = self.columns["time_s"]
        last = max((t for t, colliding in zip(times, self.columns["colliding"]) if colliding > 0), default=None)
        contact = "never in contact" if last is None else f"in contact until {number(last, 3)} s of {number(times[-1], 3)} s"
        outcome = str(self.summary.get("outcome", "")).replace("_", " ")
        force = number(at(self.summary, "/metrics/force_max_N"), 3)
        return f"{self.algorithm.replace('_', ' ')}: {contact}, {outcome}, largest force {force} N"
