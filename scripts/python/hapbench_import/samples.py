"""Converts the rows of a recording to samples in SI units and in the scenario's frame. Collects the problems of bad
rows."""
import math
import re
from dataclasses import dataclass

import numpy as np
from hapbench_command import MAX_FAULTS, Faults, fail
from scipy.spatial.transform import Rotation

from .clock import require_likely_clock, usual_interval
from .component_columns import Columns
from .holds import hold_of
from .options import Options
from .split_times import remedy_of_repeated_times, repeats_most

MAX_SAMPLES = 10_000_000
UNIT_TOLERANCE = 1e-3  # largest deviation of a norm from 1 that counts as rounding
MIN_JUMP = (
    # Distance between samples [m] up to which a jump is accepted at any speed, because a clock with jitter may have
    # written both samples almost at once.
    1e-3
)
_EXPONENT_OF_FORTRAN = re.compile(rb"[+-]?(\d+\.?\d*|\.\d+)[dD][+-]?\d+")
TIMES_OF_DAY = '"05:59:00.002" or "2026-11-28T05:59:00.002Z"'
LENGTHS = {1e-3: "millimetres", 1e-6: "micrometres"}  # names of units of length; key: the unit [m]
DEGREE = math.pi / 180.0
DOWN = np.array([0.0, 0.0, -1.0])  # axis that points out of the tip, in the tool frame


@dataclass
class Samples:
    time: np.ndarray  # times [s], strictly increasing
    position: np.ndarray  # position of the tip [m]
    turn: Rotation  # rotation from the tool frame to the world frame
    force: np.ndarray | None  # force on the tool [N]; None if not measured
    has_roll: bool  # false if only the axis is known; `turn` then has an arbitrary roll


@dataclass
class Read:
    """Result of read_samples(): the samples of a recording, and properties of the recording."""

    samples: Samples
    recording: object
    kept: np.ndarray  # for each sample, the index of its row in `recording`
    # (location in the file, problem) for the bad rows that were omitted, once for each kind of problem.
    left_out: list
    # Largest deviation of a recorded orientation from a rotation: |norm - 1| of a quaternion or of a rotation axis, or
    # the largest element of |M^T M - 1| of a matrix M.
    unit_deviation: float
    notes: list  # notes for the user of the stroke
    coordinates: np.ndarray  # positions before rotation and shift [m]
    rows_left_out: int  # number of omitted rows, over all kinds of problems
    origin: float  # time of the recording minus time in `samples` [s]
    columns: dict  # Columns.used()
    columns_not_read: list  # numbers and names of the columns that were not read
    scales: dict  # dict from quantity to its factor to SI units
    held: object  # Hold of the samples; None if no sample is repeated in several rows


class Rows:
    """Numbers in the rows of a recording. `problems`: for each bad row, the reason why it is not a sample."""

    def __init__(self, recording, columns, options):
        self.problems, self.unit_deviation, self._recording = recording.problems(), 0.0, recording
        self.jumps = {}  # speed [m/s] of each row that is rejected as a jump
        self.notes, self.origin, self._time = columns.notes, 0.0, columns.time[:1]
        frame = np.array(options.frame).T
        if columns.time:
            scale = columns.scale("time", columns.time)
            origin, values = recording.clock(
                *columns.time, unit=columns.unit_of_fractions, scale=scale
            )
            self._refuse_columns(columns.time[:1], values[:, np.newaxis])
            self.origin, self.time = scale * origin, scale * values
        else:
            is_sample = [i not in self.problems for i in range(len(recording.rows))]
            self.time = (np.cumsum(is_sample) - 1) / options.sample_rate_Hz
        self.recorded = columns.scale("position", columns.position) * self._numbers(
            columns.position
        )
        self.position = self.recorded @ frame + options.shift
        sign = -1.0 if options.force_by_tool else 1.0
        self.force = (
            sign * columns.scale("force", columns.force) * (self._numbers(columns.force) @ frame)
            if columns.force
            else None
        )
        self.kind = columns.kind if columns.orientation else "none"
        if columns.orientation:
            self.orientation = self._numbers(columns.orientation)
            if self.kind == "axis_angle":
                scale = columns.scale("angle", columns.orientation[3:])
                self._note_unlikely_angles(scale)
                self.orientation[:, 3] *= scale
            self._check_orientation()
        forces = np.zeros(1) if self.force is None else np.linalg.norm(self.force, axis=1)
        # Rows that require_likely_clock() ignores: rows with a problem other than too large a number.
        self.clock_problems = set(self.problems)
        fits = (
            (np.linalg.norm(self.position, axis=1) < 1e6)
            & (forces < 1e9)
            & (np.abs(self.time) < 1e12)
        )
        self._refuse(
            ~fits,
            lambda row: "too large a number; allowed: positions below 1e6 m, forces below 1e9 N, times below 1e12 s",
        )

    def _note_unlikely_angles(self, scale):
        largest = np.nanmax(np.abs(self.orientation[:, 3]), initial=0.0)
        if scale == 1.0 and largest > 2.0 * math.pi + 0.1:
            self.notes.append(
                f"angles of up to {largest:.4g} rad look like degrees (--scale angle={DEGREE:.10g} is for degrees)"
            )
        if abs(scale / DEGREE - 1.0) < 1e-3 and 0.3 < largest < 2.0 * math.pi + 0.1:
            self.notes.append(
                f"angles of up to {largest:.4g} degrees look like radians (--scale angle=1 is for radians)"
            )

    def turns(self, kept, options):
        """Returns the rotation from the tool frame to the world frame for each kept row."""
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
        self._refuse_columns(columns, values)
        return values

    def _refuse_columns(self, columns, values):
        """Adds a problem for each row that has no number in one of the columns."""
        for column, numbers in zip(columns, values.T):
            name = self._recording.names[column]
            self._refuse(
                np.isnan(numbers),
                lambda row: (
                    f"column {column + 1}{' ' if name else ''}{name}: got "
                    f"{self._recording.shown(column, row)}; allowed: a finite number{self._cause(column, row)}"
                ),
            )

    def _cause(self, column, row):
        """Returns a text for the error message: the likely cause of a cell that is not a number, and the correction.
        Returns an empty text if no cause is known."""
        cell = b"" if self._recording.is_binary else self._recording.rows[row][column]
        if _EXPONENT_OF_FORTRAN.fullmatch(cell):
            return "; write an exponent as in 1e-3"
        if b":" in cell and [column] == self._time:
            return f" or a time of day, such as {TIMES_OF_DAY}"
        return self._recording.cause_of_point(column, row)

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
            usable = np.delete(lengths, list(self.problems))
            if np.abs(usable - 1.0).max(initial=0.0) > UNIT_TOLERANCE:
                self.notes.append(
                    f"the axes have lengths of {usable.min():.4g} ... {usable.max():.4g}, and only their directions "
                    "are used: are they rotation vectors or Euler angles, which are not read?"
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
            # The identity rotation needs no axis.
            no_turn = (self.kind == "axis_angle") & (lengths == 0.0) & (values[:, 3] == 0.0)
            deviation = np.where(no_turn, 0.0, np.abs(lengths - 1.0))
            what = "a rotation axis" if self.kind == "axis_angle" else "a quaternion"
            self._refuse(
                ~(deviation <= UNIT_TOLERANCE),
                lambda row: f"got {what} of norm {lengths[row]:.6g}; allowed: 1 within {UNIT_TOLERANCE:g}",
            )
        self.unit_deviation = float(np.delete(deviation, list(self.problems)).max(initial=0.0))


def _from_down_to(axes):
    """Returns the smallest rotations from DOWN to the axes."""
    unit = axes / np.linalg.norm(axes, axis=1, keepdims=True)
    turns = np.column_stack([np.cross(DOWN, unit), 1.0 + unit @ DOWN])
    # A half turn can be about any axis perpendicular to DOWN; x is chosen.
    return Rotation.from_quat(np.where(turns[:, 3:] < 1e-12, [1.0, 0.0, 0.0, 0.0], turns))


def read_samples(recording, options):
    """Returns the Read of a recording. Bad rows have a wrong number of values, a value that is not a finite number or
    is too large, a time that does not increase, an invalid orientation, or a jump faster than max_speed. By default, a
    recording with bad rows is refused with one message, which has the first row of each kind of problem. With the
    option skip_bad_rows, bad rows are omitted. Rows that repeat a held sample are also omitted, except with the
    option held_rows = "keep"."""
    columns = Columns(recording, options)
    with np.errstate(invalid="ignore", over="ignore"):
        rows = Rows(recording, columns, options)
    if len(recording.rows) - len(rows.problems) > MAX_SAMPLES:
        fail(f"more than {MAX_SAMPLES} samples", recording.file)
    if columns.time:
        require_likely_clock(
            rows, recording.file, columns.scale("time", columns.time), options.max_gap
        )
    _note_without_effect(options, columns, rows)
    held = _held_rows(rows, options, columns.notes)
    kept = _in_sequence(rows, options.max_speed, held)
    problems = _with_hints(rows, len(recording.rows))
    faults = recording.faults(problems)
    _refuse_repeated_times(recording, columns, rows)
    if faults and not options.skip_bad_rows:
        location, problem = faults[-1]
        faults[-1] = (location, f"{problem}; --skip-bad-rows skips bad rows")
        raise Faults(faults[:MAX_FAULTS])
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
    return Read(
        samples,
        recording,
        kept,
        faults,
        rows.unit_deviation,
        list(dict.fromkeys(columns.notes + recording.notes)),
        rows.recorded[kept],
        len(problems),
        rows.origin,
        columns.used(),
        columns.names.others(columns.used()),
        columns.scales,
        held,
    )


def _refuse_repeated_times(recording, columns, rows):
    """Refuses a recording in which most rows repeat the time, also with the option skip_bad_rows, which would omit most
    rows."""
    repeated = repeats_most(rows.time) if columns.time else 0
    if repeated:
        used = {part["column"] - 1 for parts in columns.used().values() for part in parts}
        fail(
            f"column {recording.title(columns.time[0])}: {repeated} of {len(rows.time)} rows repeat the time of the "
            f"row before; allowed: increasing times; "
            f"{remedy_of_repeated_times(recording, columns.time[0], used)} (for rows at a known rate: --set "
            "sample_rate_Hz=... instead of --columns time=...)",
            recording.file,
        )


def _note_without_effect(options, columns, rows):
    """Adds a note for each option about a quantity that is not read. A preset may describe optional columns."""
    absent = options.optional - {quantity for quantity, parts in columns.used().items() if parts}
    unread = {"force": "force", "angle": "orientation"}
    for quantity, factor in options.scale.items():
        if quantity not in columns.scales and unread.get(quantity) not in absent:
            columns.notes.append(
                f"the scale {quantity}={factor:g} has no effect: no column of {quantity} is read"
            )
    if options.force_by_tool and rows.force is None and "force" not in absent:
        columns.notes.append(
            "force_by_tool=true has no effect: no column of force is read (--columns force=...)"
        )
    if rows.kind == "axis" and options.tip_axis != Options.tip_axis:
        columns.notes.append(
            "tip_axis has no effect: the columns of the axis state the direction out of the tip"
        )


def _held_rows(rows, options, notes):
    """Returns the Hold of the rows without problems. Its array `fresh` has an entry for every row; the entry is false
    for rows with problems. Returns None if samples are not held, or if the option held_rows is "keep".
    """
    usable = np.array([row not in rows.problems for row in range(len(rows.time))], bool)
    values = [rows.recorded] + ([rows.orientation] if rows.kind != "none" else [])
    held = hold_of(np.column_stack(values)[usable]) if usable.any() else None
    if held is None:
        return None
    text = f"each pose is repeated in {held.rows:.4g} rows"
    steps = np.diff(rows.time[usable][held.fresh])
    if float(np.median(steps)) > 0.0:
        text += f": poses were measured at {1.0 / usual_interval(steps):.4g} Hz"
    if options.held_rows == "keep":
        notes.append(f"{text}, and steps between poses are not motion (--set held_rows=thin)")
        return None
    forces = rows.force is not None and not _is_held(rows.force[usable], held.fresh)
    notes.append(
        f"{text}; the first row of each is used"
        + (", and the forces of the other rows are omitted" if forces else "")
        + " (--set held_rows=keep uses all rows)"
    )
    fresh = np.zeros(len(rows.time), bool)
    fresh[np.flatnonzero(usable)] = held.fresh
    held.fresh = fresh
    return held


def _is_held(values, fresh):
    """Returns True if the values change only in rows for which `fresh` is true."""
    return not np.any((np.diff(values, axis=0) != 0.0).any(axis=1) & ~fresh[1:])


def _with_hints(rows, count):
    """Returns the problems of the rows. If at least three rows and more than a third of all rows are jumps, adds to
    their problems the scale of length that would make their speed plausible. `count`: number of all rows.
    """
    jumps = [row for row, speed in rows.jumps.items() if row in rows.problems]
    if len(jumps) < 3 or 3 * len(jumps) <= count:
        return rows.problems
    speed = float(np.median([rows.jumps[row] for row in jumps]))
    unit = next((one for one in LENGTHS if speed * one < 5.0), None)
    hint = (
        f"(is the scale right? --scale position={unit:g} is for {LENGTHS[unit]}, --scale time=... for another clock)"
        if unit
        else "(is the scale right? --scale time=... or position=...)"
    )
    return {
        row: problem.replace("(is the scale right?)", hint)
        for row, problem in rows.problems.items()
    }


def _in_sequence(rows, max_speed, held):
    """Returns the rows that become samples. From each returned row to the next returned row, the time increases, and
    the position moves by at most MIN_JUMP or with at most `max_speed` [m/s]. Adds to rows.problems why other rows are
    rejected. Skips rows that repeat a held sample."""
    kept, time, position = [], rows.time.tolist(), rows.position.tolist()
    for row in range(len(time)):
        if row in rows.problems or (held is not None and not held.fresh[row]):
            continue
        if kept:
            step, distance = time[row] - time[kept[-1]], math.dist(
                position[row], position[kept[-1]]
            )
            if not step > 0.0:
                rows.problems[row] = (
                    f"got time {rows.origin + time[row]:.12g} s after {rows.origin + time[kept[-1]]:.12g} s; "
                    "allowed: increasing times"
                )
                continue
            if distance > MIN_JUMP and distance > max_speed * step:
                rows.jumps[row] = distance / step
                rows.problems[row] = (
                    f"got a jump of {1e3 * distance:.4g} mm in {1e3 * step:.4g} ms, {distance / step:.3g} m/s; "
                    f"allowed: {max_speed:g} m/s (is the scale right?)"
                )
                continue
        kept.append(row)
    return np.array(kept, int)
