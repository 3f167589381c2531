"""Reads what a replay needs of a recorded run."""
from pathlib import Path

import numpy as np

from hapbench.columns import read_columns

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
    found = read_columns(file, [*columns, *({"step"} - set(columns) if steps is not None else ())], may_be_empty=True)
    # Beyond single precision nothing can be drawn.
    bad = next((name for name, values in found.items() if (np.abs(values) >= 1e38).any()), None)
    if bad:
        raise InputError(f"{file}: {bad}: holds numbers beyond 1e38; allowed: finite numbers")
    without = np.flatnonzero(np.isnan(found.get("step", ())))
    if without.size:
        raise InputError(f"{file}: line {2 + without[0]}: step: got nan; allowed: a finite number")
    kept = slice(None) if steps is None else np.isin(found["step"], np.fromiter(steps, float))
    return {name: found[name][kept].tolist() for name in columns}


class Recording:
    """One algorithm's run through a scene."""

    def __init__(self, directory: Path):
        self.summary = load_object(directory / "summary.json")
        self.scenario = load_object(directory / "scenario.effective.json")
        self.tool = tool_profile(self.scenario, self.summary)
        self.algorithm = str(self.summary.get("algorithm", directory.name))
        # All rows, for the sound and the worst moments.
        self.columns = numbers(directory / "trajectory.csv", ("step", *MEASURED_COLUMNS, "colliding"))
        if not self.columns["step"]:
            raise InputError(f"{directory / 'trajectory.csv'}: holds no row")
        self.shown = rows_to_show(self.columns)
        self.steps = [int(self.columns["step"][row]) for row in self.shown]
        self.tensors = self.read_tensors(directory / "stiffness_tensor.csv")
        self.contacts = self.read_contacts(directory / "contacts.csv")

    def read_tensors(self, file):
        """Of every shown row; None when they were not recorded."""
        if not file.is_file():
            return None
        columns = numbers(file, ("step", *TENSOR_COLUMNS), set(self.steps))
        of_step = dict(zip(map(int, columns["step"]), zip(*(columns[name] for name in TENSOR_COLUMNS))))
        for step in self.steps:
            if step not in of_step:
                raise InputError(f"{file}: no row of step {step}")
        return [of_step[step] for step in self.steps]

    def read_contacts(self, file):
        """Of every shown row, in the order of the file, with their normals; none when they were not recorded."""
        rows = {step: [] for step in self.steps}
        if file.is_file():
            columns = numbers(file, ("step", *CONTACT_COLUMNS, *NORMAL_COLUMNS), set(self.steps))
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
