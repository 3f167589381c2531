"""Reads the log of any engine: times, positions and forces in SI units, and further quantities if the log has columns
for them."""
import re
from dataclasses import dataclass, field
from functools import cached_property
from types import SimpleNamespace

import numpy as np
from hapbench_command import Faults, fail, finite_number, quoted, require_name
from hapbench_import.clock import is_rounded, packet_rate, packet_text
from hapbench_import.columns import ABSENT, UNITS, Names, unit_in, without_unit
from hapbench_import.holds import Hold, hold_of
from hapbench_import.options import QUANTITIES, assignments, options_of
from hapbench_import.recording import open_recording
from hapbench_import.samples import MIN_JUMP, read_samples
from hapbench_import.stroke import resolution_of

from .tables import of_table, quantity_of, recording_of
from .tracking import without_glitches
from .usual_columns import extra_columns, with_usual_columns

FEWEST = 20  # smallest number of samples of a log
LONG_INTERVALS = 10.0  # number of mean intervals; a longer time step is a gap, which ends a contact
LATEST_START = (
    1e6  # if the first time of a log [s] is at least this large, times count from the first row
)
# Unit of a velocity at the end of a column name, as in "vx [mm/s]" and vx_mm_per_s. Group 1: the unit of length.
SPEED = re.compile(r"(?:^|[\s_\[({<,])([A-Za-zµμ]+)(?:/|_per_| per )s(?:ec)?[\])}>]?$")
FASTEST = 5.0  # largest plausible speed of a hand [m/s]
NEAR = 10  # number of rows over which the speed of the tool is computed
# Largest error of a time step [intervals] at which the number of missing rows in the step is unambiguous. At an error
# of 0.5, two numbers of missing rows fit equally well.
CLEAR = 0.25
SEVERAL = 20  # number of time steps over which the mean interval is measured
# Largest number of missing rows that are counted between two rows; equals the longest delay of a model [rows].
MAX_MISSING = 50
# If the position moves faster than FASTEST in a larger fraction of the log, its unit is probably wrong. In a smaller
# fraction, it jumps.
MAX_JUMPS = 0.01
# At each time stamp, of_mean_clock() shifts the mean clock towards the stamp by at least this fraction of the
# difference.
FOLLOWED = 0.05
COMPARED = 0.05  # duration over which displacement and logged velocity are compared [s]
# Largest ratio of a logged velocity to the change of the position per second; its inverse is the smallest ratio.
SIMILAR_SPEED = 2.0
TOUCH = "touch_N="  # prefix of the field touch_N in --set
# Quantities that `hapbench import` does not read, and what the audit does without each of them.
WITHOUT = {
    "velocity": "it computes velocities from differences of the positions",
    "measured": "it does not check whether the device renders the force",
    "contacts": "the force decides which rows are in contact (--set touch_N=... sets the threshold)",
}
EXTRA = tuple(WITHOUT)
ALL = [name for name in QUANTITIES] + list(EXTRA)


@dataclass
class Log:
    file: str
    time: np.ndarray  # times of the rows [s], increasing
    position: np.ndarray  # position of the tool: x, y, z in each row [m]
    force: np.ndarray  # force on the tool: x, y, z in each row [N]
    turn: object = None  # orientation of the tool in each row, a Rotation, or None
    velocity: np.ndarray | None = None  # velocity of the tool: x, y, z in each row [m/s]
    measured: np.ndarray | None = None  # force of a sensor: x, y, z in each row [N]
    contacts: np.ndarray | None = None  # number of contacts in each row
    axes: int = 3  # number of axes: 1, 2 for a planar log, or 3
    # Columns that were read: a dict from quantity to columns, in the format of Columns.used() of hapbench_import.
    columns: dict = field(default_factory=dict)
    columns_not_read: list = field(default_factory=list)
    scales: dict = field(default_factory=dict)  # dict from quantity to its factor to SI units
    notes: list = field(default_factory=list)
    quantum_m: np.ndarray | None = (
        None  # resolution of each position component [m]; 0: full precision
    )
    quantum_N: np.ndarray | None = None  # resolution of each force component [N]; 0: full precision
    held: object = None  # Hold of the positions, or None if positions are not held
    held_force: object = None  # Hold of the forces, or None if forces are not held
    # Force above which a row is in contact [N]; None: rows_in_contact() determines it.
    touch: float | None = None

    @cached_property
    def interval(self):
        """Mean time between consecutive rows [s]. Steps over missing rows are not part of the mean."""
        steps = np.diff(self.time)
        mean = (self.time[-1] - self.time[0]) / len(steps)
        off = self.time - self.time[0] - np.arange(len(self.time)) * mean
        if np.abs(off).max() <= 1e-3 * mean:
            return float(mean)
        return float(steps[self.missing == 0].mean())

    def columns_text(self, quantity):
        """Returns numbers and names of the columns of a quantity for a message, such as "columns 2 fx, 3 fy"."""
        titles = [f"{part['column']} {part['name']}".rstrip() for part in self.columns[quantity]]
        return f"column{'s' if len(titles) > 1 else ''} {', '.join(titles)}"

    @cached_property
    def missing(self):
        """Number of missing rows between each row and the next row."""
        return missing_rows(np.diff(self.time))

    @cached_property
    def is_rounded(self):
        """True if the clock is even and its times are rounded to multiples of about one interval."""
        steps = np.diff(self.time)
        return not self.missing.any() and is_rounded(steps, float(np.median(steps)))

    @cached_property
    def jumps(self):
        """True for each interval between rows in which the position jumps: it moves by more than MIN_JUMP, and faster
        than FASTEST, unlike at least the fraction 1 - MAX_JUMPS of the log."""
        distances = np.linalg.norm(np.diff(self.position, axis=0), axis=1)
        is_fast = distances > FASTEST * np.diff(self.time)
        return is_fast & (distances > MIN_JUMP) & (np.mean(is_fast) <= MAX_JUMPS)

    @cached_property
    def pauses(self):
        """True for each interval between rows that is longer than LONG_INTERVALS mean intervals."""
        return np.diff(self.time) > LONG_INTERVALS * self.interval

    @cached_property
    def seconds(self):
        """Duration of each row [s]: half of the time step before the row plus half of the time step after it. At the
        ends of the log and at `pauses`, half a mean interval counts instead."""
        halves = 0.5 * np.where(self.pauses, self.interval, np.diff(self.time))
        return np.append(halves, 0.5 * self.interval) + np.append(0.5 * self.interval, halves)

    @cached_property
    def starts(self):
        """Time at which each row starts, as the sum of the `seconds` of the rows before it [s]."""
        return np.cumsum(self.seconds) - self.seconds

    @cached_property
    def counted(self):
        """Row numbers that also count missing rows, but at most MAX_MISSING missing rows in each gap."""
        return np.append(0, np.cumsum(1 + np.minimum(self.missing, MAX_MISSING)))

    @cached_property
    def interval_error(self):
        """Relative error of `interval`: three standard deviations of the jitter, divided by the duration of the log."""
        steps = np.diff(self.time)
        jitter = float(np.std(steps[self.missing == 0]))
        return 3.0 * jitter / float(self.time[-1] - self.time[0])


def read_log(options):
    """Returns the Log of the file that the user named. `options`: the parsed command line of __main__."""
    layout, wanted, touch = layout_of(options)
    log = log_of(open_recording(options.log, layout), layout, wanted)
    log.touch = touch
    return log


def layout_of(options):
    """Returns (Options of `import stroke` that read the log; dict from the quantities of EXTRA that the user specified
    to their columns; force above which a row is in contact [N], or None if the user did not specify this force).
    """
    touches = [word for word in options.set if word.startswith(TOUCH)]
    extra = [word for word in options.columns if word.partition("=")[0] in EXTRA]
    requested = SimpleNamespace(
        **{name: getattr(options, name) for name in ("preset", "scale", "decimal")},
        set=[word for word in options.set if word not in touches],
        columns=[word for word in options.columns if word not in extra],
        orientation=options.orientation,
        skip_bad_rows=options.skip_bad_rows,
        **dict.fromkeys(("format", "frame", "smooth", "rate")),
    )
    for word in options.columns:
        require_name("columns: got", word.partition("=")[0], ALL)
    wanted = dict(assignments("columns", extra))
    if len(touches) > 1:
        fail('--set: got "touch_N" twice; allowed: once')
    layout = options_of(requested)
    if not any(word.startswith("max_speed") for word in options.set):
        layout.max_speed = float("inf")
    given = [word.partition("=")[0] for word in options.set]
    if "held_rows" in given and layout.held_rows != "keep":
        fail("--set held_rows: has no effect, because the audit uses all rows; allowed: keep")
    if "tip_axis" in given:
        fail("--set tip_axis: has no effect on an audit; allowed: no tip_axis")
    layout.held_rows = "keep"
    touch = touch_of(touches[-1]) if touches else None
    return layout, wanted, touch


def touch_of(word):
    """Returns the force [N] in a word such as "touch_N=0.1". Fails if the force is not a number >= 0."""
    force = finite_number(word.removeprefix(TOUCH).encode("utf-8", "surrogateescape"))
    if not force >= 0.0:
        fail(f"--set: got {quoted(word)}; allowed: touch_N=FORCE, a number >= 0")
    return force


def log_of_table(table, columns, scale, force_by_tool, touch):
    """Returns the Log of a mapping from column names to arrays, such as a Table or a pandas.DataFrame. `columns`: dict
    from quantity to column. `scale`: dict from quantity to its factor to SI units. Both dicts have the meaning of the
    option of the same name. `force_by_tool`: true if the forces act on the object. `touch`: Log.touch [N].
    """
    requested = SimpleNamespace(
        log=None,
        columns=[f"{quantity}={column}" for quantity, column in columns.items()],
        scale=[f"{quantity}={factor!r}" for quantity, factor in scale.items()],
        set=["force_by_tool=true"] if force_by_tool else [],
        skip_bad_rows=False,
        **dict.fromkeys(("preset", "decimal", "orientation")),
    )
    layout, wanted, _ = layout_of(requested)
    recording, unread = recording_of(table)
    # Columns that cannot be read, but have the name of a quantity.
    named = {name: quantity_of(name, columns) for name in unread}
    why = {name: f"column {name}: {unread[name]}" for name in unread if named[name]}
    try:
        log = log_of(recording, layout, wanted)
    except Faults as faults:
        raise Faults([(place, of_table(problem, why)) for place, problem in faults.list]) from None
    log.notes += [f"{why[name]}; it is not read" for name in why if named[name] not in log.columns]
    log.columns_not_read += list(unread)
    log.touch = touch
    return log


def log_of(recording, options, wanted):
    """Returns the Log of a recording. `options`: Options of `import stroke`. `wanted`: dict from the quantities of
    EXTRA that the user specified to their columns."""
    recording, axes = with_usual_columns(recording, options)
    read = without_glitches(read_samples(recording, options))
    samples, kept = read.samples, read.kept
    if len(kept) < FEWEST:
        fail(f"{len(kept)} usable samples; allowed: at least {FEWEST}", recording.file)
    if samples.force is None:
        fail("columns: force: is missing (--columns force=NAME)", recording.file)
    names = Names(recording)
    extra, used = {}, {name: parts for name, parts in read.columns.items() if parts}
    for quantity in EXTRA:
        found = extra_columns(names, quantity, wanted.get(quantity), axes)
        if not found:
            continue
        owners = {part["column"] - 1: other for other, parts in used.items() for part in parts}
        shared = [column for column in found if column in owners]
        if shared and quantity in wanted:
            column = shared[0]
            names.fail(quantity, f"column {names.title(column)} is also named for {owners[column]}")
        if shared:
            continue
        scales = [scale_of(quantity, recording, column, read) for column in found]
        values = np.column_stack(
            [scale * recording.column(column)[kept] for scale, column in zip(scales, found)]
        )
        if not np.isfinite(values).all():
            read.notes.append(unused_text(quantity, recording, found, kept, values))
            continue
        extra[quantity] = values if quantity == "contacts" else on_axes(values, axes)
        used[quantity] = [
            {"component": part, "column": column + 1, "name": names.names[column]}
            for part, column in zip(axes if len(found) > 1 else [quantity], found)
        ]
    used = {
        quantity: [part for part in parts if not part["name"].startswith(ABSENT)]
        for quantity, parts in used.items()
    }
    frame = np.array(options.frame).T
    sign = -1.0 if options.force_by_tool else 1.0
    log = Log(
        recording.file,
        times_of(read),
        samples.position,
        samples.force,
        samples.turn if samples.has_roll else None,
        None if "velocity" not in extra else extra["velocity"] @ frame,
        None if "measured" not in extra else sign * extra["measured"] @ frame,
        extra["contacts"][:, 0] if "contacts" in extra else None,
        len(axes),
        used,
        names.others(used),
        read.scales,
        [note for note in read.notes if not note.startswith("each pose is repeated")],
    )
    if read.rows_left_out:
        log.notes.append(
            f"{read.rows_left_out} bad rows were skipped, the first: "
            f"{read.left_out[0][0]}: {read.left_out[0][1]}"
        )
    log.quantum_m, log.quantum_N = quanta(log.position), quanta_of_force(log.force)
    refuse_packets(log, "time" in options.named)
    leave_out_false_velocity(log)
    log.held, log.held_force = held_of(log, log.position), held_of(log, log.force)
    return log


def refuse_packets(log, is_named):
    """Fails if the rows arrive in packets, because their times then give a false rate, missing rows and false
    velocities. Adds a note instead if `is_named` is true: the user has named the column of times.
    """
    rate = packet_rate(log.time, log.position)
    if rate is None:
        return
    text = packet_text(rate)
    if is_named:
        log.notes.append(f"{text}. Rate, missing rows, contacts and stiffness are otherwise false")
        return
    column = log.columns["time"][0]["name"] or log.columns["time"][0]["column"]
    fail(f"{text} (--columns time={column} uses the times nevertheless)", log.file)


def leave_out_false_velocity(log):
    """Leaves out logged velocities that contradict the positions, and adds a note about them. Compares the displacement
    in COMPARED seconds with the integral of the velocity."""
    if log.velocity is None:
        return
    rows = min(max(round(COMPARED / log.interval), 1), len(log.time) // 4)
    steps = 0.5 * (log.velocity[1:] + log.velocity[:-1]) * np.diff(log.time)[:, None]
    is_cut = np.append(0, np.cumsum(log.pauses | log.jumps))
    whole = is_cut[rows:] == is_cut[:-rows]
    travelled = np.append(np.zeros((1, 3)), np.cumsum(steps, axis=0), axis=0)
    moved, integral = (
        (values[rows:] - values[:-rows])[whole] for values in (log.position, travelled)
    )
    size, length = float(np.sum(moved**2)), float(np.sum(integral**2))
    if size <= len(moved) * (3.0 * np.linalg.norm(log.quantum_m)) ** 2 or length == 0.0:
        return
    both = float(np.sum(moved * integral))
    factor, correlation = both / size, both / np.sqrt(size * length)
    if correlation >= 0.5 and 1.0 / SIMILAR_SPEED <= factor <= SIMILAR_SPEED:
        return
    fault = (
        f"is {factor:.4g} times the change of the position per second"
        if abs(correlation) >= 0.5
        else f"does not follow the changes of the position (correlation {correlation:.2g})"
    )
    log.notes.append(
        f"velocity: {log.columns_text('velocity')} {fault}; the audit does not use this quantity: "
        f"{WITHOUT['velocity']}; allowed: the velocity of the position, in m/s or with a unit in the name of the "
        'column, as in "vx [mm/s]"'
    )
    log.columns_not_read += [f"{part['column']} {part['name']}" for part in log.columns["velocity"]]
    del log.columns["velocity"]
    log.velocity = None


def scale_of(quantity, recording, column, read):
    """Returns the factor from the unit of a column to m/s (velocity) or N (measured). The unit follows the name of the
    column, such as "vx [mm/s]" or vx_mm_per_s. A measured force without a unit has the unit of the force. Adds a
    note to `read` about a unit that is not known."""
    if quantity == "contacts":
        return 1.0
    name = recording.names[column]
    stated = without_unit(name)[1]
    if quantity == "measured":
        unit, known, factor = (
            stated and unit_in("force", stated.text),
            UNITS["force"],
            read.scales.get("force", 1.0),
        )
    else:
        speed = SPEED.search(name)
        unit, known, factor = speed and unit_in("position", speed[1]), UNITS["position"], 1.0
    if unit:
        return known[unit]
    if stated and (stated.is_sure or quantity == "velocity"):
        si = "N" if quantity == "measured" else "m/s"
        read.notes.append(
            f"{quantity}: the unit {quoted(stated.text)} of column {recording.title(column)} is not known; its numbers "
            f"are read in {si}"
        )
    return factor


def unused_text(quantity, recording, columns, kept, values):
    """Returns the warning that a quantity of EXTRA is not used, because some of its values are not finite numbers. It
    names the first of these values. `columns`: columns of the quantity. `kept`: indices of the rows of the log in
    `recording`. `values`: numbers in these rows and columns."""
    unknown = ~np.isfinite(values)
    rows = np.flatnonzero(unknown.any(axis=1))
    row, column = kept[rows[0]], columns[unknown[rows[0]].argmax()]
    return (
        f"{quantity}: {recording.row_word} {recording.row_numbers[row]}: got {recording.shown(column, row)} in column "
        f"{recording.title(column)}; rows without a finite number: {len(rows)} of {len(kept)}; the audit does not use "
        f"this quantity: {WITHOUT[quantity]}; allowed: a number in every row{recording.cause_of_point(column, row)}"
    )


def missing_rows(steps):
    """Returns the number of missing rows in each time step of a clock. Without jitter, each step is a whole number of
    intervals. If the times are those of an even clock, rounded to multiples of the smallest step, no row is missing.

    There are two models of jitter. In the first model, each interval has an independent error. In the second model,
    each time stamp of a regular clock has an independent error. The errors of the second model do not add up over the
    steps; each step is therefore measured from the mean clock, a regular clock that follows the earlier time stamps.
    The function uses the model with the smaller mean square error."""
    interval = float(np.median(steps))
    found = np.maximum(np.rint(steps / interval).astype(int) - 1, 0)
    errors = steps / interval - found - 1.0
    if np.abs(errors).max() <= CLEAR:
        return np.zeros(len(steps), int) if is_rounded(steps, interval) else found
    # Errors of time stamps affect the mean of several steps less than a single step. The median ignores the few groups
    # of steps that contain missing rows.
    several = min(SEVERAL, len(steps))
    time = np.append(0.0, np.cumsum(steps))
    interval = float(np.median(time[several:] - time[:-several])) / several
    for _ in range(2):  # the second iteration uses the mean interval of the first
        found = np.maximum(np.rint(steps / interval).astype(int) - 1, 0)
        by_step = steps / interval - found - 1.0
        followed, by_clock = of_mean_clock((steps / interval).tolist())
        error = min(np.mean(by_clock**2), np.mean(by_step**2))
        if np.mean(by_clock**2) == error:
            found = followed
        interval = float(time[-1]) / (len(steps) + int(found.sum()))
    # If the errors are as large as the errors of random times, jitter explains all steps up to two intervals. Only
    # longer steps then contain missing rows.
    longest = 2.0 * float(time[-1]) / len(steps)
    return np.where(steps > longest, found, 0) if error > CLEAR**2 else found


def of_mean_clock(steps):
    """Returns (number of missing rows, error [intervals]) of each step. Each step is measured from the mean clock, a
    regular clock that follows the earlier time stamps. `steps`: time steps in intervals."""
    # `lag`: last time stamp minus the mean clock, in intervals.
    found, errors, lag = [], [], 0.0
    for row, step in enumerate(steps):
        rows = max(round(step + lag), 1)
        error = step + lag - rows
        gain = max(1.0 / (row + 2.0), FOLLOWED)
        found.append(rows - 1)
        errors.append(error)
        lag = (1.0 - gain) * error
    return np.array(found), np.array(errors)


def held_of(log, values):
    """Returns the Hold of `values`, or None if the log does not repeat values over several rows. Missing rows count as
    rows."""
    rows = log.counted
    whole = np.arange(rows[-1] + 1)
    found = hold_of(values[np.searchsorted(rows, whole, side="right") - 1])
    return None if found is None else Hold(found.rows, found.fresh[rows])


def times_of(read):
    """Returns the times of the rows [s]. If the first time is LATEST_START or later, as in times since 1970, the times
    are relative to the first row."""
    start = read.origin + read.samples.time[0]
    if start < LATEST_START:
        return read.origin + read.samples.time
    read.notes.append(f"times count from the first row, at {start:.9g} s")
    return read.samples.time - read.samples.time[0]


def on_axes(values, axes):
    """Returns rows of three components. Components of axes that the log lacks are 0. `values`: one column for each of
    `axes`, such as "xz"."""
    found = np.zeros((len(values), 3))
    found[:, ["xyz".index(axis) for axis in axes]] = values
    return found


def quanta_of_force(force):
    """Returns the resolution of each force component, as quanta() does. A force of zero, as without contact, does not
    show the distance to the other forces."""
    return np.array(
        [resolution_of(column[column != 0.0]) or 0.0 if column.any() else 0.0 for column in force.T]
    )


def quanta(values):
    """Returns the resolution of each column; 0 if its numbers have full precision or do not change."""
    return np.array([resolution_of(column) or 0.0 for column in values.T])
