"""A recorded run for the replay: the tool, the shown rows, and the times of extreme values. Also provides a sound:
the part of the rendered force above 30 Hz, which a hand feels as vibration."""
import base64
import math
import sys
from array import array

import numpy as np
from scipy import signal

from hapbench.columns import read_columns
from hapbench.results import at, number_or_none

TENSOR_COLUMNS = ("sxx", "sxy", "sxz", "syy", "syz", "szz")
# Columns of each shown row: time, tip position, tool axis, rendered force, smallest and largest stiffness ratio, and
# largest depth. The stiffness tensor S follows if it was recorded.
MEASURED_COLUMNS = (
    "time_s",
    "px_m",
    "py_m",
    "pz_m",
    "axis_x",
    "axis_y",
    "axis_z",
    "fx_N",
    "fy_N",
    "fz_N",
    "ratio_min",
    "ratio_max",
    "depth_max_m",
)
# Columns of trajectory.csv in which the program writes a finite number in every row: a run ends before these numbers
# exceed their bounds.
REQUIRED = ("step", *MEASURED_COLUMNS[:10], "depth_max_m", "colliding")
CONTACT_COLUMNS = (
    "x_m",
    "y_m",
    "z_m",
    "depth_m",
    "gradient_x",
    "gradient_y",
    "gradient_z",
    "weight",
)
NORMAL_COLUMNS = ("nx", "ny", "nz")
# Number of points of a rounded tip. The polygon deviates from the circle by 0.013 % of the radius.
ARC_POINTS = 48
# Number of equal parts into which the rows of a long run are divided; each part keeps up to five rows.
SPANS = 500
SETTLING_S = 0.05
CUTOFF_HZ = 30.0
# Largest number of recorded rows in a sound: two minutes at 2 kHz, which take half a megabyte in the page.
LONGEST = 1 << 18
MIN_SETTLED_S = (
    1 / 30
)  # with a shorter settled time [s], the run counts as bouncing and has no metrics of settled contact


def tool_profile(scenario, summary):
    """Returns the tool as a solid of revolution: pairs (s, r) [m] of the position s along the axis, relative to the tip
    centre, and the radius r there, from the far end to the tip. The profile of a cylinder follows from the scenario;
    the profile of another tool is in the run's summary. The profile of a mesh is its silhouette. Returns None if
    neither the summary nor the scenario determines the profile."""
    outline = at(summary, "/tool/outline_m")
    if outline is not None:
        pairs = (
            [[number_or_none(x) for x in pair] for pair in outline]
            if is_list_of_pairs(outline)
            else []
        )
        return pairs if len(pairs) > 1 and None not in sum(pairs, []) else None
    diameter, length = (
        number_or_none(at(scenario, f"/tool/{key}")) for key in ("diameter_m", "length_m")
    )
    if diameter is None or length is None:
        return None
    radius = diameter / 2
    body = [[-length, 0.0], [-length, radius], [0.0, radius]]
    if at(scenario, "/tool/tip") != "round":
        return [*body, [0.0, 0.0]]
    angles = [math.pi / 2 * i / ARC_POINTS for i in range(1, ARC_POINTS + 1)]
    return body + [[radius * math.sin(a), radius * math.cos(a)] for a in angles]


def is_list_of_pairs(value):
    return isinstance(value, list) and all(
        isinstance(pair, list) and len(pair) == 2 for pair in value
    )


def forces(columns):
    """Returns the rendered force in every row [N], n × 3."""
    return np.column_stack([columns[f"f{axis}_N"] for axis in "xyz"])


def force_steps(columns):
    """Returns the magnitude of the change of the rendered force from the previous row [N]; zero in the first row."""
    return np.append(0.0, np.linalg.norm(np.diff(forces(columns), axis=0), axis=1))


def rows_to_show(columns):
    """Returns the indices of the rows to show: all rows of a short run. For a long run, returns from each of SPANS
    equal parts the rows with the smallest force, the largest force and the largest depth, and the two rows of the
    largest force step. No peak is lost."""
    n = len(columns["time_s"])
    if n <= 4 * SPANS:
        return np.arange(n)
    size, step, depth = (
        np.linalg.norm(forces(columns), axis=1),
        force_steps(columns),
        columns["depth_max_m"],
    )
    kept = [0, n - 1]
    for rows in np.array_split(np.arange(n), SPANS):
        jump = rows[step[rows].argmax()]
        kept += [
            rows[size[rows].argmin()],
            rows[size[rows].argmax()],
            rows[depth[rows].argmax()],
            jump,
            max(0, jump - 1),
        ]
    return np.unique(kept)


def settled_rows(columns, scenario):
    """Returns for each row True if the row is settled: in contact and not part of a landing. A landing lasts settling_s
    from a first touch. A first touch is a contact at the start, or a contact after at least settling_s without contact.
    If from_s is set, the settled rows are instead all rows in contact from the time from_s on. settling_s and from_s
    are fields of `metrics` in the scenario.
    """
    settling_s, from_s = (
        number_or_none(at(scenario, f"/metrics/{key}")) for key in ("settling_s", "from_s")
    )
    settling_s = SETTLING_S if settling_s is None else settling_s
    time, touching = columns["time_s"], np.flatnonzero(columns["colliding"] > 0)
    found = np.zeros(len(time), bool)
    if from_s is not None:
        found[touching] = time[touching] >= from_s
        return found
    when = time[touching]
    first = np.diff(when, prepend=-np.inf) >= settling_s
    found[touching] = when - np.maximum.accumulate(np.where(first, when, -np.inf)) >= settling_s
    return found


def worst_moments(columns, scenario):
    """Returns (title, time, value, unit) for the largest force step and for the largest depth. Only settled rows count
    for the force step. If the settled time is shorter than MIN_SETTLED_S, all rows count."""
    times, step, depth = columns["time_s"], force_steps(columns), columns["depth_max_m"]
    rows = np.flatnonzero(settled_rows(columns, scenario))
    is_settled = len(times) > 1 and len(rows) * (times[1] - times[0]) >= MIN_SETTLED_S
    rows = rows if is_settled else np.arange(len(times))
    jump, deepest = rows[step[rows].argmax()], depth.argmax()
    return [
        {
            "title": "settled force step" if is_settled else "force step",
            "time": times[jump],
            "value": step[jump],
            "unit": "N",
        },
        {"title": "depth", "time": times[deepest], "value": depth[deepest] * 1e3, "unit": "mm"},
    ]


class Recording:
    """Recorded data of one run for the replay."""

    def __init__(self, run):
        self.run, self.tool = run, tool_profile(run.scenario, run.summary)
        # All recorded rows. The sound and the times of extreme values need them.
        self.columns = read_columns(
            run.folder / "trajectory.csv",
            ("step", *MEASURED_COLUMNS, "colliding"),
            required=REQUIRED,
        )
        self.shown = rows_to_show(self.columns)
        tensors = self.rows_of("stiffness_tensor", TENSOR_COLUMNS)
        self.tensors = (
            [of_row[0] for of_row in tensors] if all(tensors) else None
        )  # None if the stiffness tensors were not recorded
        contact = (*CONTACT_COLUMNS, *NORMAL_COLUMNS)
        self.contacts = self.rows_of(
            "contacts", contact, contact
        )  # contacts of every shown row, with their normals

    def rows_of(self, table, columns, required=()):
        """Returns for each shown row the list of the rows of `table` with the same step, in the order of the file. All
        lists are empty if the table was not recorded. `required`: columns in which every field must be a finite number.
        """
        steps = self.columns["step"][self.shown]
        rows = {step: [] for step in steps.tolist()}
        if table in self.run.tables:
            found = np.column_stack(
                list(
                    read_columns(
                        self.run.folder / f"{table}.csv",
                        ("step", *columns),
                        may_be_empty=True,
                        required=("step", *required),
                    ).values()
                )
            )
            for step, *numbers in found[np.isin(found[:, 0], steps)].tolist():
                rows[step].append(numbers)
        return list(rows.values())

    def rows(self):
        """Returns the shown rows as lists of numbers for the page, with the tensor appended if it was recorded."""
        measured = np.column_stack(
            [self.columns[name][self.shown] for name in MEASURED_COLUMNS]
        ).tolist()
        return (
            [row + tensor for row, tensor in zip(measured, self.tensors)]
            if self.tensors
            else measured
        )

    def tips(self, touching):
        """Returns the positions of the tip in the shown rows; with `touching`, only in rows in contact."""
        rows = self.shown[self.columns["colliding"][self.shown] > 0] if touching else self.shown
        return np.column_stack([self.columns[f"p{axis}_m"][rows] for axis in "xyz"]).tolist()


def base64_of(code, values):
    """Encodes numbers as base64 text, little-endian. `code`: type of the numbers, as for Python's array. Raises
    OverflowError for a number outside of the range of this type."""
    packed = array(code, values)
    if sys.byteorder == "big":
        packed.byteswap()
    return base64.b64encode(packed.tobytes()).decode()


def sound(columns):
    """Returns the sound of a run for the page. The samples of the sound are the rendered force above 30 Hz, projected
    on the direction in which this filtered force is strongest. The projection keeps changes of sign, which the
    magnitude of the force would hide. Returns None if there are fewer than three rows, if their times do not increase,
    if their rate is below 120 Hz, or if the filtered force is zero or too large."""
    times = columns["time_s"][:LONGEST]
    if len(times) < 3 or not times[-1] > times[0]:
        return None
    rate = (len(times) - 1) / (times[-1] - times[0])
    if rate < 4 * CUTOFF_HZ:
        return None
    filtered = np.array([high_passed(columns[f"f{axis}_N"][:LONGEST], rate) for axis in "xyz"])
    if not (np.abs(filtered) < 1e30).all():
        return None
    sound = strongest(filtered) @ filtered
    peak = np.abs(sound).max()
    if peak == 0:
        return None
    touching = sound[columns["colliding"][:LONGEST] > 0]
    return {
        "rate": rate,
        "scale": peak / 32767,
        "start": times[0],
        "rms": math.sqrt(np.mean(touching**2)) if touching.size else 0.0,
        "samples": base64_of("h", map(round, (sound / peak * 32767).tolist())),
    }


def high_passed(samples, rate):
    """Applies the fourth-order Butterworth high-pass of results/observe/contact_forces.hpp. The output is zero at the
    first sample."""
    sections = signal.butter(4, CUTOFF_HZ, "high", fs=rate, output="sos")
    return signal.sosfilt(sections, samples, zi=signal.sosfilt_zi(sections) * samples[0])[0]


def strongest(signals):
    """Returns the unit vector along which the three signals have the largest power: the eigenvector of `signals` times
    its transpose with the largest eigenvalue."""
    return np.linalg.eigh(signals @ signals.T)[1][:, -1]
