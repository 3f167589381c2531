"""A log of one axis of a device: times, commanded forces and positions in SI units."""
import math
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
from hapbench_command import MAX_FAULTS, Faults, fail, finite_number, quoted, require_name
from hapbench_import.columns import NAMED_AS, Names, scale_of
from hapbench_import.holds import hold_of
from hapbench_import.options import assignments
from hapbench_import.recording import open_recording
from hapbench_import.split_times import fractions_of, remedy_of_repeated_times, repeats_most
from hapbench_import.stroke import resolution_of

NAMES = {
    "time": "time_s",
    "force": "force_N",
    "position": "position_m",
}  # names of the columns if --columns is not given
FEWEST = 50  # smallest number of samples
LONGEST_GAP = 0.1  # longest gap over which forces are interpolated [s]


@dataclass
class Log:
    time: np.ndarray  # times of all samples [s], increasing; includes the times of missing samples
    force: np.ndarray  # force commanded at this time and held until the next time [N]
    position: np.ndarray  # position at each time [m]; NaN for missing and for repeated samples
    step: float  # mean interval of the times, without gaps [s]
    encoder_step: float  # encoder step [m]; 0 if the positions are not multiples of any length
    encoder_interval: list  # smallest and largest encoder step that the written positions allow [m]
    warnings: list
    knows_forces: bool = True  # false if the forces of missing rows are interpolated
    is_even: bool = True  # false if the intervals of the times differ, apart from missing samples
    # Columns that were read: a dict from quantity to columns, in the format of Columns.used() of hapbench_import.
    columns: dict | None = None
    columns_not_read: list | None = None
    scales: dict | None = None  # dict from quantity to its factor to SI units


def read_log(options):
    """Returns the Log that the parsed command line `options` names."""
    columns, scale = dict.fromkeys(NAMES), {}
    for option, words, target in (
        ("columns", options.columns, columns),
        ("scale", options.scale, scale),
    ):
        for name, value in assignments(option, words):
            require_name(f"--{option}: got", name, list(NAMES))
            target[name] = value if option == "columns" else _factor(name, value)
    layout = SimpleNamespace(format="csv", floats=False, decimal=options.decimal or "auto")
    recording = open_recording(options.log, layout)
    names, notes = Names(recording), []
    found = {name: _index(names, name, word) for name, word in columns.items()}
    if len(set(found.values())) < len(found):
        fail(f"columns: got one column for two of {', '.join(NAMES)}", recording.file)
    for name, other in (("force", "position"), ("position", "force")):
        if NAMED_AS[other].fullmatch(names.bare[found[name]].lower()):
            notes.append(
                f"the column of {name} is {names.title(found[name])}, which is named as {other}"
            )
    scales = {
        name: scale_of(names, name, [column], scale.get(name), notes)
        for name, column in found.items()
    }
    force, position = (
        scales[name] * recording.column(found[name]) for name in ("force", "position")
    )
    fractions, unit = fractions_of(recording, found["time"]) or (None, 0.0)
    time = scales["time"] * recording.clock(found["time"], fractions, unit, scales["time"])[1]
    if repeated := repeats_most(time):
        fail(
            f"column {recording.title(found['time'])}: {repeated} of {len(time)} rows repeat the time of the row before"
            f"; allowed: increasing times; {remedy_of_repeated_times(recording, found['time'], found.values())}",
            recording.file,
        )
    clock = [found["time"]] if fractions is None else [found["time"], fractions]
    bad = _bad_rows(recording, found, time, force, position)
    faults = recording.faults(bad)
    if faults and not options.skip_bad_rows:
        location, problem = faults[-1]
        faults[-1] = (location, f"{problem}; --skip-bad-rows skips bad rows")
        raise Faults(faults[:MAX_FAULTS])
    kept = [row for row in range(len(time)) if row not in bad]
    if len(kept) < FEWEST:
        fail(
            f"{len(kept)} usable samples of {len(time)}; allowed: at least {FEWEST}", recording.file
        )
    for name, values in (("force", force[kept]), ("position", position[kept])):
        if np.ptp(values) == 0.0:
            fail(f"every {name} is {values[0]:g}: nothing to identify", recording.file)
    log = log_of(time[kept], force[kept], position[kept])
    if faults:
        log.warnings.insert(
            0, f"{len(bad)} bad rows were skipped, the first: {faults[0][0]}: {faults[0][1]}"
        )
    log.warnings[:0] = notes + recording.notes
    log.columns = {
        name: [
            {"component": name, "column": column + 1, "name": names.names[column]}
            for column in (clock if name == "time" else [found[name]])
        ]
        for name in found
    }
    log.columns_not_read, log.scales = names.others(log.columns), scales
    return log


def _bad_rows(recording, columns, time, force, position):
    """Returns a dict from the number of each bad row to the reason why the row is not a sample. `columns`: dict from
    quantity to its column."""
    bad, last = recording.problems(), -math.inf
    usual = not bad and np.isfinite((time, force, position)).all() and (np.diff(time) > 0.0).all()
    for row in () if usual else range(len(time)):
        values = {"time": time[row], "force": force[row], "position": position[row]}
        unread = [columns[name] for name in values if not np.isfinite(values[name])]
        if row not in bad and unread:
            bad[row] = (
                f"column {recording.title(unread[0])}: got {recording.shown(unread[0], row)}; allowed: a finite number"
                + recording.cause_of_point(unread[0], row)
            )
        elif row not in bad and not time[row] > last:
            bad[row] = f"got time {time[row]:.9g} s after {last:.9g} s; allowed: increasing times"
        if row not in bad:
            last = time[row]
    return bad


def log_of(time, force, position):
    """Returns the Log with the times of missing samples inserted. The forces of missing samples are interpolated
    linearly, which is accurate if the force changes little between samples. Their positions are NaN. If the log
    repeats a position in several rows, the position counts only in the first of these rows and is NaN in the other
    rows."""
    warnings, held = [], hold_of(position)
    if held is not None:
        rate = (len(time) - 1) / (time[-1] - time[0]) / held.rows
        warnings.append(
            f"each position is repeated in {held.rows:.4g} rows: positions were measured at {rate:.4g} Hz; the first "
            "row of each is used"
        )
        if not np.any((np.diff(force) != 0.0) & ~held.fresh[1:]):
            # The force changes only in rows with a new position. The repeated rows are therefore omitted.
            time, force, position, held = (
                time[held.fresh],
                force[held.fresh],
                position[held.fresh],
                None,
            )
    intervals = np.diff(time)
    missing = missing_samples(intervals)
    first, after = longest_part(intervals, missing)
    if after - first < len(time):
        at = int(np.argmax(intervals * (missing > 0)))
        warnings.append(
            f"a gap of {intervals[at]:.4g} s after {time[at]:.9g} s: the motion in it is unknown. Of {len(time)} "
            f"samples, only the {after - first} from {time[first]:.9g} to {time[after - 1]:.9g} s are used, the "
            f"longest part without a gap of more than {LONGEST_GAP:g} s"
        )
        part = slice(first, after)
        time, force, position, held = time[part], force[part], position[part], _part_of(held, part)
        intervals, missing = intervals[first : after - 1], missing[first : after - 1]
    even = missing == 0
    step = float(intervals[even].mean())
    if missing.any():
        first = int(np.argmax(missing > 0))
        warnings.append(
            f"{missing.sum()} samples are missing, at most {missing.max()} in a row, the first after "
            f"{time[first]:.9g} s: their forces were interpolated linearly"
        )
    is_even = bool(np.ptp(intervals[even]) <= 0.05 * step)
    if not is_even:
        warnings.append(
            f"the sampling is not uniform: intervals of {1e3 * intervals[even].min():.3g} ... "
            f"{1e3 * intervals[even].max():.3g} ms; the times are used as they are, with each force held until the "
            "next row"
        )
    all_times = np.concatenate(
        [np.linspace(a, b, n + 1, endpoint=False) for a, b, n in zip(time, time[1:], missing)]
        + [time[-1:]]
    )
    known = np.full(len(all_times), math.nan)
    known[np.searchsorted(all_times, time)] = (
        position if held is None else np.where(held.fresh, position, math.nan)
    )
    return Log(
        all_times,
        np.interp(all_times, time, force),
        known,
        step,
        *encoder_step_of(position),
        warnings,
        not missing.any(),
        is_even,
    )


def longest_part(intervals, missing):
    """Returns the first sample, and the sample after the last, of the longest part of a log without a gap of missing
    samples that is longer than LONGEST_GAP. `missing`: number of missing samples in each interval.
    """
    cuts = np.flatnonzero((missing > 0) & (intervals > LONGEST_GAP)) + 1
    ends = [0, *cuts.tolist(), len(intervals) + 1]
    return max(zip(ends, ends[1:]), key=lambda part: part[1] - part[0])


def _part_of(held, part):
    return None if held is None else replace(held, fresh=held.fresh[part])


def missing_samples(intervals):
    """Returns the number of missing samples in each interval; zero if jitter of the clock explains the long intervals.
    Missing samples cause intervals near integer multiples of the usual interval. They cause few intervals of about 1.5
    usual intervals."""
    ratios = intervals / np.median(intervals)
    long = ratios >= 1.5
    between, beyond = np.sum((ratios >= 1.4) & (ratios < 1.6)), np.sum(ratios >= 1.6)
    off = np.abs(ratios[long] - np.rint(ratios[long]))
    if not long.any() or between > 0.2 * beyond or off.mean() > 0.1 + 1.5 * np.std(ratios[~long]):
        return np.zeros(len(intervals), int)
    return np.maximum(np.rint(ratios).astype(int) - 1, 0)


def encoder_step_of(position):
    """Returns (encoder step [m], its smallest and largest possible value). The spacings between neighbouring position
    values are multiples of the encoder step, apart from the resolution of the log, to which the log rounds the
    positions. A spacing counts as a multiple if it differs from one by less than 2 % of the step, or by less than the
    resolution. If fewer than 98 % of the spacings are multiples, the step is 0, and its largest possible value follows
    from the smallest spacing. The interval of the step contains the rounding of the first and of the last position.
    """
    values = np.unique(position)
    resolution = resolution_of(values) or 0.0
    spacings = np.diff(values)
    spacings = spacings[
        spacings > max(1e-10, 1e-9 * np.abs(position).max())
    ]  # rounding of the written numbers
    if not len(spacings):
        return 0.0, [0.0, 0.0]
    # Count the steps of the short spacings first: the error of the step, times the number of steps, must stay small.
    step = smallest = float(spacings.min())
    for longest in (3.0, 30.0, math.inf):
        short = spacings[spacings <= longest * smallest]
        step = float(short.sum() / np.rint(short / step).sum())
    counts = np.rint(spacings / step)
    # If the step is only a few times the resolution, every length is near a multiple of it.
    rounding = resolution if step > 4.0 * resolution else 0.0
    fits = np.abs(spacings - counts * step) < max(0.02 * step, rounding)
    if np.mean(fits) < 0.98:
        return 0.0, [0.0, smallest + resolution]
    error = max(rounding / counts.sum(), 1e-9 * step)
    return step, [step - error, step + error]


def _factor(name, word):
    """Returns the scale factor in a word. Only the factors of force and position may be negative."""
    value = finite_number(word.encode("utf-8", "surrogateescape"))
    if not (value > 0.0 or (value < 0.0 and name != "time")):
        allowed = "> 0" if name == "time" else "a number, not 0"
        fail(f"--scale: {name}: got {quoted(word)}; allowed: {allowed}")
    return value


def _index(names, quantity, word):
    """Returns the column of a quantity. `word`: name or number of the column that the user gave. If `word` is None,
    searches for the name in NAMES, then for the name of the quantity with a unit, such as "force [N]".
    """
    requested = word if word is not None else NAMES[quantity]
    column, _ = names.find(quantity, [requested], ())
    if column is None and word is None:
        column = next(
            (
                i
                for i, (bare, unit) in enumerate(zip(names.bare, names.units))
                if bare.lower() == quantity and unit
            ),
            None,
        )
    if column is None:
        known = ", ".join(f"{i} {name}".rstrip() for i, name in enumerate(names.names[:20], 1))
        fail(
            f"columns: {quantity}: no {quoted(requested)}; the file has {known} (--columns {quantity}=NAME or number)",
            names.file,
        )
    return column
