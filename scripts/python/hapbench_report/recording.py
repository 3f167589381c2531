"""A recorded run as the replay reads it: its tool, the rows that are shown, the moments to jump to,
and the rendered force above 30 Hz as a sound, what a hand feels as vibration."""
import base64
import math
import sys
from array import array

import numpy as np
from scipy import signal

from hapbench.columns import read_columns
from hapbench.results import at, number_or_none

TENSOR_COLUMNS = ("sxx", "sxy", "sxz", "syy", "syz", "szz")
# Per row: time, tip, axis, rendered force, ratio range, deepest point; with the tensor S where it was recorded.
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
ARC_POINTS = 48  # of a rounded tip: off the circle by 0.013 % of its radius
SPANS = 500  # of a run; each keeps up to five rows
SETTLING_S = 0.05
CUTOFF_HZ = 30.0
LONGEST = 1 << 18  # of a sound [rows]: two minutes at 2 kHz, half a megabyte in the page
LEAST_SETTLED_S = (
    1 / 30
)  # less tells nothing: the run hammers, and it has no metrics of settled contact


def tool_profile(scenario, summary):
    """The tool as a solid of revolution: pairs (s, r) in metres, at s along the axis, counted from the tip centre, the
    radius r; from the far end to the tip. A cylinder's follows from the scenario, that of any other
    tool is in the run's summary; of a mesh it is the silhouette. None if there is neither."""
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
    """The rendered force in every row [N], n × 3."""
    return np.column_stack([columns[f"f{axis}_N"] for axis in "xyz"])


def force_steps(columns):
    """Size of the change of the rendered force from the row before [N]; zero in the first."""
    return np.append(0.0, np.linalg.norm(np.diff(forces(columns), axis=0), axis=1))


def rows_to_show(columns):
    """All rows of a short run. Of a long one, in equal spans of rows, those of the least and the greatest force, of the
    greatest depth, and both ends of the largest step of the force: no peak is lost."""
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
    """Which rows are in contact and no landing, by the settings of the run's metrics: not within
    settling_s after a first touch, which is a contact at the start or after at least that time
    without one; from_s, if there is one, replaces that rule.
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
    """Where the settled force steps most (in a run that hardly settles: the force of all its rows),
    and where the tool is deepest: title, time, value, unit."""
    times, step, depth = columns["time_s"], force_steps(columns), columns["depth_max_m"]
    rows = np.flatnonzero(settled_rows(columns, scenario))
    is_settled = len(times) > 1 and len(rows) * (times[1] - times[0]) >= LEAST_SETTLED_S
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
    """One algorithm's run through a scene."""

    def __init__(self, run):
        self.run, self.tool = run, tool_profile(run.scenario, run.summary)
        # All rows, for the sound and the worst moments.
        self.columns = read_columns(
            run.folder / "trajectory.csv", ("step", *MEASURED_COLUMNS, "colliding")
        )
        self.shown = rows_to_show(self.columns)
        tensors = self.rows_of("stiffness_tensor", TENSOR_COLUMNS)
        self.tensors = (
            [of_row[0] for of_row in tensors] if all(tensors) else None
        )  # None if they were not recorded
        self.contacts = self.rows_of(
            "contacts", (*CONTACT_COLUMNS, *NORMAL_COLUMNS)
        )  # of every shown row, with their normals

    def rows_of(self, table, columns):
        """The rows of a table for every shown row, in the order of the file; none if it was not recorded."""
        steps = self.columns["step"][self.shown]
        rows = {step: [] for step in steps.tolist()}
        if table in self.run.tables:
            found = np.column_stack(
                list(
                    read_columns(
                        self.run.folder / f"{table}.csv", ("step", *columns), may_be_empty=True
                    ).values()
                )
            )
            for step, *numbers in found[np.isin(found[:, 0], steps)].tolist():
                rows[step].append(numbers)
        return list(rows.values())

    def rows(self):
        """The shown rows as they are packed."""
        measured = np.column_stack(
            [self.columns[name][self.shown] for name in MEASURED_COLUMNS]
        ).tolist()
        return (
            [row + tensor for row, tensor in zip(measured, self.tensors)]
            if self.tensors
            else measured
        )

    def tips(self, touching):
        """Places of the tip in the shown rows; with `touching`, of those in contact."""
        rows = self.shown[self.columns["colliding"][self.shown] > 0] if touching else self.shown
        return np.column_stack([self.columns[f"p{axis}_m"][rows] for axis in "xyz"]).tolist()


def base64_of(code, values):
    """Numbers as text for a page: little endian, base64. Raises OverflowError for one that the type
    of array cannot hold."""
    packed = array(code, values)
    if sys.byteorder == "big":
        packed.byteswap()
    return base64.b64encode(packed.tobytes()).decode()


def sound(columns):
    """Samples for the page, empty where too few rows a second were recorded. One direction is heard, that in which the
    force above 30 Hz is strongest: its size alone would hide a force that turns round."""
    times = columns["time_s"][:LONGEST]
    if len(times) < 3 or not times[-1] > times[0]:
        return None
    rate = (len(times) - 1) / (times[-1] - times[0])
    if rate < 4 * CUTOFF_HZ:
        return None
    filtered = np.array([high_passed(columns[f"f{axis}_N"][:LONGEST], rate) for axis in "xyz"])
    if not (np.abs(filtered) < 1e30).all():
        return None
    heard = strongest(filtered) @ filtered
    peak = np.abs(heard).max()
    if peak == 0:
        return None
    touching = heard[columns["colliding"][:LONGEST] > 0]
    return {
        "rate": rate,
        "scale": peak / 32767,
        "start": times[0],
        "rms": math.sqrt(np.mean(touching**2)) if touching.size else 0.0,
        "samples": base64_of("h", map(round, (heard / peak * 32767).tolist())),
    }


def high_passed(samples, rate):
    """Butterworth of fourth order, as in results/observe/contact_forces.hpp, at rest at the first sample."""
    sections = signal.butter(4, CUTOFF_HZ, "high", fs=rate, output="sos")
    return signal.sosfilt(sections, samples, zi=signal.sosfilt_zi(sections) * samples[0])[0]


def strongest(signals):
    """Unit vector along which the three signals have most power: the last eigenvector of their covariance."""
    return np.linalg.eigh(signals @ signals.T)[1][:, -1]
