"""Samples of a recording in SI units and the scenario's frame, and what is wrong with its rows."""
import math
from dataclasses import dataclass

import numpy as np
from hapbench_command import MOST_FAULTS, Faults, fail, nearest, quoted
from scipy.spatial.transform import Rotation

from .options import ORIENTATIONS

MOST_SAMPLES = 10_000_000
UNIT_TOLERANCE = 1e-3  # of norms: numbers further from 1 are not rounded but wrong
LEAST_JUMP = (
    1e-3  # [m]: below, a jump may be jitter of a clock that wrote two samples almost at once
)
DOWN = np.array([0.0, 0.0, -1.0])  # the tool's axis in its own frame


@dataclass
class Samples:
    time: np.ndarray  # [s], strictly increasing
    position: np.ndarray  # of the tip [m]
    turn: Rotation  # from the tool's frame to the world's
    force: np.ndarray | None  # on the tool [N]; None: not measured
    has_roll: bool  # False: only the axis is known, and `turn` has any roll


@dataclass
class Read:
    """A recording as it was read."""

    samples: Samples
    recording: object
    kept: np.ndarray  # rows of the samples
    left_out: list  # faults of rows that were left out: (place, problem)
    unit_deviation: float  # largest |norm - 1| of an orientation before it was normalised
    notes: list  # what a reader of the stroke must know
    coordinates: np.ndarray  # positions before they were turned and shifted [m]


class Columns:
    """Finds the columns that the options ask for; each is a list of indices, empty for none."""

    def __init__(self, recording, options):
        self._recording, self._options, self.notes = recording, options, []
        self.time = [] if options.sample_rate_Hz else self._group("time", ("time",))
        self.position = self._group("position", ("px", "py", "pz"))
        if not self.position:
            self._fail("position", "is missing")
        if not options.sample_rate_Hz and not self.time:
            self._fail("time", "is missing (or give --set sample_rate_Hz=...)")
        self.orientation = self._group("orientation", ORIENTATIONS[options.orientation])
        if (
            not self.orientation
            and options.orientation != "none"
            and "orientation" not in options.optional
        ):
            self._fail("orientation", "is missing")
        self.force = self._group("force", ("mfx", "mfy", "mfz"))

    def _fail(self, quantity, problem):
        names = self._recording.names
        known = ", ".join(f"{i} {name}".rstrip() for i, name in enumerate(names[:20], 1)) + (
            ", ..." if len(names) > 20 else ""
        )
        fail(f"columns: {quantity}: {problem}; the file has {known}", self._recording.file)

    def _group(self, group, parts):
        """The group's first column and those after it, or each by itself."""
        wanted = self._options.columns
        if any(part != group and part in wanted for part in parts):
            for part in parts:
                if part not in wanted:
                    self._fail(part, f"is missing beside others of {group}")
            return [self._column(part) for part in parts]
        if not parts or group not in wanted:
            return []
        first = self._column(group)
        if first is None:
            self.notes.append(f"no columns of {group} as the preset names them: left out")
            return []
        if first + len(parts) > len(self._recording.names):
            self._fail(group, f"takes columns {first + 1} ... {first + len(parts)}")
        return list(range(first, first + len(parts)))

    def _column(self, quantity):
        names, wanted = self._recording.names, self._options.columns[quantity]
        for word in wanted:
            for name in filter(None, (word, word + "_x")):
                if names.count(name) > 1:
                    self._fail(quantity, f"two columns are named {quoted(name)}: give its number")
                if name in names:
                    return names.index(name)
            if word.isascii() and word.isdigit() and 1 <= int(word) <= len(names):
                return int(word) - 1
        if quantity in self._options.optional:
            return None
        word = (wanted or [""])[0]
        self._fail(quantity, f"got {quoted(word)}{nearest(word, list(filter(None, names)))}")


class Rows:
    """The rows of a recording as numbers; `problems` says, by row, why some are not samples."""

    def __init__(self, recording, columns, options):
        self.problems, self.unit_deviation, self._recording = recording.problems(), 0.0, recording
        scale = {
            quantity: options.scale.get(quantity, 1.0)
            for quantity in ("time", "position", "angle", "force")
        }
        frame = np.array(options.frame).T
        if columns.time:
            self.time = scale["time"] * self._numbers(columns.time)[:, 0]
        else:
            is_sample = [i not in self.problems for i in range(len(recording.rows))]
            self.time = (np.cumsum(is_sample) - 1) / options.sample_rate_Hz
        self.recorded = scale["position"] * self._numbers(columns.position)
        self.position = self.recorded @ frame + options.shift
        sign = -1.0 if options.force_by_tool else 1.0
        self.force = (
            sign * scale["force"] * (self._numbers(columns.force) @ frame)
            if columns.force
            else None
        )
        self.kind = options.orientation if columns.orientation else "none"
        if columns.orientation:
            self.orientation = self._numbers(columns.orientation)
            if self.kind == "axis_angle":
                self.orientation[:, 3] *= scale["angle"]
            self._check_orientation()
        forces = np.zeros(1) if self.force is None else np.linalg.norm(self.force, axis=1)
        fits = (
            (np.linalg.norm(self.position, axis=1) < 1e6)
            & (forces < 1e9)
            & (np.abs(self.time) < 1e12)
        )
        self._refuse(
            ~fits,
            lambda row: "too large a number; allowed: positions below 1e6 m, forces below 1e9 N, times below 1e12 s",
        )

    def turns(self, kept, options):
        """The orientations of the rows that were kept, from the tool's frame to the world's."""
        frame, tool = np.array(options.frame), _from_down_to(np.array([options.tip_axis]))
        if self.kind == "none":
            return _from_down_to(np.repeat([frame @ options.tip_axis], len(kept), axis=0))
        values = self.orientation[kept]
        if self.kind == "axis":
            return _from_down_to(values @ frame.T)
        if self.kind == "matrix":
            recorded = Rotation.from_matrix(values.reshape(-1, 3, 3))
        elif self.kind == "axis_angle":
            half, lengths = 0.5 * values[:, 3:], np.linalg.norm(
                values[:, :3], axis=1, keepdims=True
            )
            recorded = Rotation.from_quat(
                np.column_stack(
                    [
                        np.sin(half) / np.where(lengths > 0.0, lengths, 1.0) * values[:, :3],
                        np.cos(half),
                    ]
                )
            )
        else:
            recorded = Rotation.from_quat(
                np.roll(values, -1, axis=1) if self.kind == "quat_wxyz" else values
            )
        return Rotation.from_matrix(frame) * recorded * tool

    def _numbers(self, columns):
        values = np.column_stack([self._recording.column(column) for column in columns])
        for column, numbers in zip(columns, values.T):
            name = self._recording.names[column]
            self._refuse(
                np.isnan(numbers),
                lambda row: (
                    f"column {column + 1}{' ' if name else ''}{name}: got "
                    f"{self._recording.shown(column, row)}; allowed: a finite number"
                ),
            )
        return values

    def _refuse(self, wrong, problem):
        for row in np.flatnonzero(wrong).tolist():
            if row not in self.problems:
                self.problems[row] = problem(row)

    def _check_orientation(self):
        values = self.orientation
        lengths = np.linalg.norm(
            values[:, :3] if self.kind in ("axis", "axis_angle") else values, axis=1
        )
        if self.kind == "axis":
            self._refuse(
                ~((lengths > 1e-12) & (lengths < 1e12)),
                lambda row: f"got an axis of length {lengths[row]:g}; allowed: 1e-12 ... 1e12",
            )
            return
        if self.kind == "matrix":
            m = values.reshape(-1, 3, 3)
            deviation = np.abs(m.transpose(0, 2, 1) @ m - np.eye(3)).max(axis=(1, 2))
            right_handed = np.einsum("ij,ij->i", m[:, 0], np.cross(m[:, 1], m[:, 2])) > 0.0
            self._refuse(
                ~((deviation <= UNIT_TOLERANCE) & right_handed),
                lambda row: (
                    "got a matrix that is not a rotation; allowed: rows of length 1, "
                    f"perpendicular within {UNIT_TOLERANCE:g}, determinant 1"
                ),
            )
        else:
            # No turn needs no axis.
            no_turn = (self.kind == "axis_angle") & (lengths == 0.0) & (values[:, 3] == 0.0)
            deviation = np.where(no_turn, 0.0, np.abs(lengths - 1.0))
            what = "a turn's axis" if self.kind == "axis_angle" else "a quaternion"
            self._refuse(
                ~(deviation <= UNIT_TOLERANCE),
                lambda row: f"got {what} of norm {lengths[row]:.6g}; allowed: 1 within {UNIT_TOLERANCE:g}",
            )
        self.unit_deviation = float(np.delete(deviation, list(self.problems)).max(initial=0.0))


def _from_down_to(axes):
    """The shortest turns from DOWN to the axes."""
    unit = axes / np.linalg.norm(axes, axis=1, keepdims=True)
    turns = np.column_stack([np.cross(DOWN, unit), 1.0 + unit @ DOWN])
    # Half a turn may be about any axis that is perpendicular.
    return Rotation.from_quat(np.where(turns[:, 3:] < 1e-12, [1.0, 0.0, 0.0, 0.0], turns))


def read_samples(recording, options):
    """Reads a recording. Bad rows (too few values, no finite number, time that does not increase,
    an orientation that is none, a jump faster than max_speed) are refused all together, each with
    its place, or left out when the options say so.
    """
    columns = Columns(recording, options)
    with np.errstate(invalid="ignore", over="ignore"):
        rows = Rows(recording, columns, options)
    if len(recording.rows) - len(rows.problems) > MOST_SAMPLES:
        fail(f"more than {MOST_SAMPLES} samples", recording.file)
    kept = _in_sequence(rows, options.max_speed)
    faults = [(recording.place(row), rows.problems[row]) for row in sorted(rows.problems)]
    if faults and not options.skip_bad_rows:
        raise Faults(faults[:MOST_FAULTS])
    if len(kept) < 2:
        fail(
            f"{len(kept)} usable samples of {len(recording.rows)}; allowed: at least 2",
            recording.file,
        )
    samples = Samples(
        rows.time[kept],
        rows.position[kept],
        rows.turns(kept, options),
        None if rows.force is None else rows.force[kept],
        rows.kind not in ("none", "axis"),
    )
    notes = columns.notes + ([recording.remark] if recording.remark else [])
    return Read(samples, recording, kept, faults, rows.unit_deviation, notes, rows.recorded[kept])


def _in_sequence(rows, max_speed):
    """The rows that can follow each other; adds the problems of the others."""
    kept, time, position = [], rows.time.tolist(), rows.position.tolist()
    for row in range(len(time)):
        if row in rows.problems:
            continue
        if kept:
            step, way = time[row] - time[kept[-1]], math.dist(position[row], position[kept[-1]])
            if not step > 0.0:
                rows.problems[
                    row
                ] = f"got time {time[row]:.9g} s after {time[kept[-1]]:.9g} s; allowed: increasing times"
                continue
            if way > LEAST_JUMP and way > max_speed * step:
                rows.problems[row] = (
                    f"got a jump of {1e3 * way:.4g} mm in {1e3 * step:.4g} ms, {way / step:.3g} m/s; allowed: "
                    f"{max_speed:g} m/s (is the scale right?)"
                )
                continue
        kept.append(row)
    return np.array(kept, int)
