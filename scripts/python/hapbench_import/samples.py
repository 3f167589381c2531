"""Samples of a recording in SI units and the scenario's frame, and what is wrong with its rows."""
import math
import re
from dataclasses import dataclass

import numpy as np
from hapbench_command import MOST_FAULTS, Faults, fail
from scipy.spatial.transform import Rotation

from .clock import require_likely_clock
from .columns import NAMED_AS, Names, scale_of
from .holds import hold_of
from .options import ORIENTATIONS

MOST_SAMPLES = 10_000_000
UNIT_TOLERANCE = 1e-3  # of norms: numbers further from 1 are not rounded but wrong
LEAST_JUMP = (
    1e-3  # [m]: below, a jump may be jitter of a clock that wrote two samples almost at once
)
# The components of a group as names of columns have them.
LETTERS = {
    ("px", "py", "pz"): ("x", "y", "z"),
    ("mfx", "mfy", "mfz"): ("x", "y", "z"),
    ("axis_x", "axis_y", "axis_z"): ("x", "y", "z"),
    ("axis_x", "axis_y", "axis_z", "angle"): ("x", "y", "z", "angle"),
    ("qw", "qx", "qy", "qz"): ("w", "x", "y", "z"),
    ("qx", "qy", "qz", "qw"): ("x", "y", "z", "w"),
}
PARTS = list(dict.fromkeys(sum(ORIENTATIONS.values(), ())))  # of orientations
_EXPONENT_OF_FORTRAN = re.compile(rb"[+-]?(\d+\.?\d*|\.\d+)[dD][+-]?\d+")
TIMES_OF_DAY = '"05:59:00.002" or "2026-11-28T05:59:00.002Z"'
LENGTHS = {1e-3: "millimetres", 1e-6: "micrometres"}
DEGREE = math.pi / 180.0
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
    rows_left_out: int  # of all faults
    origin: float  # added to times it gives those of the recording [s]
    columns: dict  # Columns.used()
    columns_not_read: list  # numbers and names of the others
    scales: dict  # by quantity: SI units in one of the file's
    held: object  # Hold, or None


def one_axis(group):
    """What a message says about a recording of one axis."""
    if group not in ("position", "force"):
        return ""
    return (
        " for x, y and z: a stroke has three components. Add columns of zeros to a recording of one axis "
        "(hapbench audit reads it as it is)"
    )


class Columns:
    """The columns that the options ask for: lists of indices in the order of the components, empty for none."""

    def __init__(self, recording, options):
        self._options, self.notes, self.scales = options, [], {}
        self.names = names = Names(recording)
        self.time = [] if options.sample_rate_Hz else self._group("time", ("time",))
        self.time += self.names.nanoseconds(self.time)
        self.position = self._group("position", ("px", "py", "pz"))
        if not self.position:
            names.fail("position", "is missing")
        if not options.sample_rate_Hz and not self.time:
            names.fail("time", "is missing (or give --set sample_rate_Hz=...)")
        self.kind = self._kind_of_orientation()
        self.orientation = self._group("orientation", ORIENTATIONS[self.kind])
        if not self.orientation and self.kind != "none" and "orientation" not in options.optional:
            names.fail("orientation", "is missing")
        self.force = self._group("force", ("mfx", "mfy", "mfz"))
        self._refuse_unused()
        self._refuse_shared()
        self._note_lone_order()
        self._note_other_quantity()

    def used(self):
        """By quantity: its components, and number, name and unit of the column of each."""
        return {
            quantity: [
                {
                    "component": component,
                    "column": column + 1,
                    "name": self.names.names[column],
                }
                for component, column in zip(components, columns)
            ]
            for quantity, components, columns in (
                ("time", ("s", "ns") if len(self.time) > 1 else ("time",), self.time),
                ("position", ("x", "y", "z"), self.position),
                ("orientation", ORIENTATIONS[self.kind], self.orientation),
                ("force", ("x", "y", "z"), self.force),
            )
        }

    def scale(self, quantity, columns):
        """The factor to SI units; `scales` keeps it."""
        if quantity not in self.scales:
            given = self._options.scale.get(quantity)
            self.scales[quantity] = scale_of(self.names, quantity, columns, given, self.notes)
        return self.scales[quantity]

    def _group(self, group, parts):
        """The columns of a group: by the name of its first component, by number, or each by itself."""
        wanted, named = self._options.columns, self._options.named
        alone = [part for part in parts if part != group and part in wanted]
        # What the command line says goes before what a preset says.
        if alone and not (group in named and not named & set(alone)):
            if group in named:
                self.names.fail(
                    group, f"is named as a whole and by {alone[0]}; allowed: one of them"
                )
            for part in parts:
                if part not in wanted:
                    self.names.fail(part, f"is missing beside others of {group}")
            return [self._column(part) for part in parts]
        if not parts or group not in wanted:
            return []
        if len(parts) == 1:
            column = self._column(group)
            return [] if column is None else [column]
        letters = LETTERS.get(parts, parts)
        first, by_number = self._first(group, letters)
        if first is None:
            if group not in self._options.optional:
                self.names.unknown(group, wanted[group])
            self.notes.append(f"no columns of {group} as the preset names them: left out")
            return []
        found = self.names.components(first, letters)
        if by_number:
            return self._consecutive(group, first, found, len(parts))
        if found is None:
            self._ask(group, first, parts)
        if letters[0] not in ("w", "x") or len(letters) != 4 or letters[3] == "angle":
            if found[0] != first:
                self.names.fail(
                    group,
                    f"column {self.names.title(first)} is not its first by name; allowed: "
                    f"{group}={self.names.names[found[0]]}",
                )
        elif found[0] != first:
            self.notes.append(self._other_order(first, found))
        return found

    def _first(self, group, letters):
        """The column of the group's first component, and whether a number says so. A name may lack the component."""
        endings = [f"{mark}{letters[0]}" for mark in ("_", ".", "")] + ["[0]", "_0", ".0", "0"]
        if letters[0] != "x":
            endings = ["_x", *endings]
        return self.names.find(group, self._options.columns[group], endings)

    def _consecutive(self, group, first, by_name, count):
        if first + count > len(self.names.names):
            self.names.fail(
                group, f"takes columns {first + 1} ... {first + count}{one_axis(group)}"
            )
        found = list(range(first, first + count))
        if by_name is not None and by_name != found:
            titles = ", ".join(map(self.names.title, found))
            self.notes.append(
                f"columns {titles} are read as {group} in this order, as their number says; by their names it "
                f"would be {', '.join(map(self.names.title, by_name))} "
                f"(--columns {group}={self.names.names[by_name[0]]})"
            )
        return found

    def _ask(self, group, first, parts):
        """Refuses a name that does not say where the other components are."""
        names, count = self.names, len(parts)
        alone = ",".join(f"{part}=..." for part in parts)
        consecutive = (
            f", or {group}={first + 1} for the columns "
            f"{', '.join(map(names.title, range(first, first + count)))}"
            if first + count <= len(names.names)
            else ""
        )
        names.fail(
            group,
            f'the names do not say which columns go with "{names.names[first]}"; allowed: {alone}{consecutive}'
            + ("" if consecutive else one_axis(group)),
        )

    def _other_order(self, first, found):
        shown = ", ".join(self.names.names[column] for column in sorted(found))
        return (
            f"--orientation {self.kind} says that the first component is "
            f"{self.names.names[found[0]]}, and --columns that "
            f"it is {self.names.names[first]}: the quaternion was read by the names of its columns ({shown})"
        )

    def _kind_of_orientation(self):
        """That of --orientation or of the preset; without, what the columns show by their names."""
        kind, wanted = self._options.orientation, self._options.columns
        parts = {part for part in PARTS if part in wanted}
        if kind is not None or ("orientation" not in wanted and not parts):
            return kind or "none"
        if "orientation" not in wanted:
            return next((kind for kind, of in ORIENTATIONS.items() if parts <= set(of)), "none")
        first, by_number = self.names.find(
            "orientation", wanted["orientation"], ("_x", ".x", "x", "_w", ".w", "w")
        )
        if first is None:
            self.names.unknown("orientation", wanted["orientation"])

        def shown(kind):
            letters = LETTERS.get(ORIENTATIONS[kind], ORIENTATIONS[kind])
            return None if by_number else self.names.components(first, letters, numbers=False)

        if quaternion := shown("quat_wxyz"):
            return "quat_wxyz" if quaternion[0] == first else "quat_xyzw"
        for kind in ("axis_angle", "matrix"):
            if shown(kind):
                return kind
        kinds = ", ".join(kind for kind in ORIENTATIONS if kind != "none")
        self.names.fail(
            "orientation",
            f"what begins at column {self.names.title(first)} is not known by its name; --orientation is missing; "
            f"allowed: {kinds} (of Euler angles, make one of these)",
        )

    def _refuse_unused(self):
        """A column that the command line names is used, or refused."""
        used = {"time": self.time, "position": self.position, "force": self.force}
        used["orientation"] = self.orientation
        parts = {"position": ("px", "py", "pz"), "force": ("mfx", "mfy", "mfz")}
        for quantity in self._options.named:
            group = next((g for g, members in parts.items() if quantity in members), None)
            if quantity in PARTS and quantity not in ORIENTATIONS[self.kind]:
                of_kind = ", ".join(ORIENTATIONS[self.kind]) or "no columns"
                self.names.fail(quantity, f"is not used: --orientation {self.kind} takes {of_kind}")
            if not used.get(group or quantity, True):
                self.names.fail(
                    quantity, f"is not used: --orientation {self.kind} takes no columns"
                )

    def _refuse_shared(self):
        """Two quantities cannot be one column."""
        owners = {}
        for quantity, parts in self.used().items():
            for part in parts:
                other = owners.setdefault(part["column"], quantity)
                if other != quantity:
                    self.names.fail(
                        quantity,
                        f"column {self.names.title(part['column'] - 1)} is also named for {other}",
                    )

    def _note_lone_order(self):
        """Components that are named one by one, against what the names of their columns say."""
        wanted = self._options.columns
        for group, parts, columns in (
            ("position", ("px", "py", "pz"), self.position),
            ("force", ("mfx", "mfy", "mfz"), self.force),
            ("orientation", ("qw", "qx", "qy", "qz"), self._quaternion()),
        ):
            if len(columns) != len(parts) or not set(parts) <= set(wanted):
                continue
            by_name = self.names.components(columns[0], LETTERS[parts])
            if by_name and sorted(by_name) == sorted(columns) and by_name != columns:
                self.notes.append(
                    f"the columns of {group} are read as {', '.join(parts)} from "
                    f"{', '.join(map(self.names.title, columns))}, as --columns says; their names say otherwise"
                )

    def _note_other_quantity(self):
        """Positions in columns that are named as forces, and the reverse."""
        for group, columns, other in (
            ("position", self.position, "force"),
            ("force", self.force, "position"),
        ):
            bare = [self.names.bare[column].lower() for column in columns]
            if bare and all(map(NAMED_AS[other].fullmatch, bare)):
                self.notes.append(
                    f"the columns of {group} are {', '.join(map(self.names.title, columns))}, which are named as {other}"
                )

    def _quaternion(self):
        """Columns of a quaternion, w first; of another orientation none."""
        if self.kind == "quat_xyzw":
            return self.orientation[3:] + self.orientation[:3]
        return self.orientation if self.kind == "quat_wxyz" else []

    def _column(self, quantity):
        column, _ = self.names.find(quantity, self._options.columns[quantity])
        if column is None and quantity not in self._options.optional:
            self.names.unknown(quantity, self._options.columns[quantity])
        return column


class Rows:
    """The rows of a recording as numbers; `problems` says, by row, why some are not samples."""

    def __init__(self, recording, columns, options):
        self.problems, self.unit_deviation, self._recording = recording.problems(), 0.0, recording
        self.jumps = {}  # by row: speed [m/s]
        self.notes, self.origin, self._time = columns.notes, 0.0, columns.time[:1]
        frame = np.array(options.frame).T
        if columns.time:
            scale = columns.scale("time", columns.time)
            origin, values = recording.clock(*columns.time, scale=scale)
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
        self.clock_problems = set(self.problems)  # rows without a time or a place
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
        self._refuse_columns(columns, values)
        return values

    def _refuse_columns(self, columns, values):
        """Adds the problems of rows without a number in a column."""
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
        """The likely cause of a cell that is no number, with the correction, or nothing."""
        cell = b"" if self._recording.is_binary else self._recording.rows[row][column]
        if _EXPONENT_OF_FORTRAN.fullmatch(cell):
            return "; write an exponent as in 1e-3"
        return (
            f" or a time of day, such as {TIMES_OF_DAY}"
            if b":" in cell and [column] == self._time
            else ""
        )

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
    an orientation that is none, a jump faster than max_speed) are refused all together, each kind with
    its first place, or left out when the options say so. Rows that repeat a held sample are left out.
    """
    columns = Columns(recording, options)
    with np.errstate(invalid="ignore", over="ignore"):
        rows = Rows(recording, columns, options)
    if len(recording.rows) - len(rows.problems) > MOST_SAMPLES:
        fail(f"more than {MOST_SAMPLES} samples", recording.file)
    if columns.time:
        require_likely_clock(
            rows, recording.file, columns.scale("time", columns.time), options.max_gap
        )
    held = _held_rows(rows, options, columns.notes)
    kept = _in_sequence(rows, options.max_speed, held)
    problems = _with_hints(rows, len(recording.rows))
    faults = recording.faults(problems)
    if faults and not options.skip_bad_rows:
        place, problem = faults[-1]
        faults[-1] = (place, f"{problem}; --skip-bad-rows leaves bad rows out")
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


def _held_rows(rows, options, notes):
    """The Hold of the rows without problems, or None; its `fresh` counts all rows."""
    usable = np.array([row not in rows.problems for row in range(len(rows.time))], bool)
    values = [rows.recorded] + ([rows.orientation] if rows.kind != "none" else [])
    held = hold_of(np.column_stack(values)[usable]) if usable.any() else None
    if held is None:
        return None
    said = f"each pose is repeated in {held.rows:.4g} rows"
    interval = float(np.median(np.diff(rows.time[usable][held.fresh])))
    if interval > 0.0:
        said += f": poses were measured at {1.0 / interval:.4g} Hz"
    if options.held_rows == "keep":
        notes.append(f"{said}, and steps between poses are not motion (--set held_rows=thin)")
        return None
    forces = rows.force is not None and not _is_held(rows.force[usable], held.fresh)
    notes.append(
        f"{said}; the first row of each is used"
        + (", and the forces of the other rows are left out" if forces else "")
        + " (--set held_rows=keep uses all rows)"
    )
    fresh = np.zeros(len(rows.time), bool)
    fresh[np.flatnonzero(usable)] = held.fresh
    held.fresh = fresh
    return held


def _is_held(values, fresh):
    """True if values change only in fresh rows."""
    return not np.any((np.diff(values, axis=0) != 0.0).any(axis=1) & ~fresh[1:])


def _with_hints(rows, count):
    """The problems of rows; if most rows are jumps, with the scale that makes them a motion."""
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
    """The rows that can follow each other; adds the problems of the others. Rows of a held sample but its first are
    passed over."""
    kept, time, position = [], rows.time.tolist(), rows.position.tolist()
    for row in range(len(time)):
        if row in rows.problems or (held is not None and not held.fresh[row]):
            continue
        if kept:
            step, way = time[row] - time[kept[-1]], math.dist(position[row], position[kept[-1]])
            if not step > 0.0:
                rows.problems[row] = (
                    f"got time {rows.origin + time[row]:.12g} s after {rows.origin + time[kept[-1]]:.12g} s; "
                    "allowed: increasing times"
                )
                continue
            if way > LEAST_JUMP and way > max_speed * step:
                rows.jumps[row] = way / step
                rows.problems[row] = (
                    f"got a jump of {1e3 * way:.4g} mm in {1e3 * step:.4g} ms, {way / step:.3g} m/s; allowed: "
                    f"{max_speed:g} m/s (is the scale right?)"
                )
                continue
        kept.append(row)
    return np.array(kept, int)
