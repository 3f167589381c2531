"""A log of one axis of a device: times, commanded forces and positions, in SI units."""
import math
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
from hapbench_command import MOST_FAULTS, Faults, fail, finite_number, quoted, require_name
from hapbench_import.recording import open_recording

NAMES = {
    "time": "time_s",
    "force": "force_N",
    "position": "position_m",
}  # of the columns unless --columns says otherwise
FEWEST = 50  # samples


@dataclass
class Log:
    time: np.ndarray  # [s], increasing; those of samples that are missing included
    force: np.ndarray  # commanded at that time and held until the next [N]
    position: np.ndarray  # [m]; NaN where the sample is missing
    step: float  # mean interval without a gap [s]
    encoder_step: float  # 0: positions are not multiples of anything
    warnings: list


def read_log(options):
    """The log that the command line names (__main__)."""
    columns, scale = dict(NAMES), dict.fromkeys(NAMES, 1.0)
    for option, words, target in (
        ("columns", options.columns, columns),
        ("scale", options.scale, scale),
    ):
        for word in words:
            name, equals, value = word.partition("=")
            if not equals:
                fail(f"--{option}: got {quoted(word)}; allowed: NAME=VALUE")
            require_name(f"--{option}: got", name, list(NAMES))
            target[name] = value if option == "columns" else _factor(name, value)
    recording = open_recording(options.log, SimpleNamespace(format="csv", floats=False))
    time, force, position = (
        scale[name] * recording.column(_index(recording, name, column))
        for name, column in columns.items()
    )
    bad, last = recording.problems(), -math.inf
    usual = not bad and np.isfinite((time, force, position)).all() and (np.diff(time) > 0.0).all()
    for row in () if usual else range(len(time)):
        if row not in bad and not np.isfinite((time[row], force[row], position[row])).all():
            bad[row] = "got no number for time, force or position"
        elif row not in bad and not time[row] > last:
            bad[row] = f"got time {time[row]:.9g} s after {last:.9g} s; allowed: increasing times"
        if row not in bad:
            last = time[row]
    faults = [(recording.place(row), bad[row]) for row in sorted(bad)]
    if faults and not options.skip_bad_rows:
        raise Faults(faults[:MOST_FAULTS])
    kept = [row for row in range(len(time)) if row not in bad]
    if len(kept) < FEWEST:
        fail(
            f"{len(kept)} usable samples of {len(time)}; allowed: at least {FEWEST}", recording.file
        )
    log = log_of(time[kept], force[kept], position[kept])
    if faults:
        log.warnings.insert(
            0, f"{len(faults)} bad rows were left out, the first: {faults[0][0]}: {faults[0][1]}"
        )
    for name, values in (("force", force[kept]), ("position", position[kept])):
        if np.ptp(values) == 0.0:
            fail(f"every {name} is {values[0]:g}: nothing to identify", recording.file)
    return log


def log_of(time, force, position):
    """Puts the times of missing samples back, with forces on the line between their neighbours',
    which is right for signals that change little from sample to sample; positions stay unknown."""
    warnings, intervals = [], np.diff(time)
    missing = np.maximum(np.rint(intervals / np.median(intervals)).astype(int) - 1, 0)
    even = missing == 0
    step = float(intervals[even].mean())
    if missing.any():
        warnings.append(
            f"{missing.sum()} samples are missing, at most {missing.max()} in a row: their forces "
            "were interpolated linearly"
        )
    if np.ptp(intervals[even]) > 0.05 * step:
        warnings.append(
            f"the sampling is not uniform: intervals of {1e3 * intervals[even].min():.3g} ... "
            f"{1e3 * intervals[even].max():.3g} ms; "
            "a constant interval is assumed"
        )
    all_times = np.concatenate(
        [np.linspace(a, b, n + 1, endpoint=False) for a, b, n in zip(time, time[1:], missing)]
        + [time[-1:]]
    )
    known = np.full(len(all_times), math.nan)
    known[np.searchsorted(all_times, time)] = position
    return Log(
        all_times,
        np.interp(all_times, time, force),
        known,
        step,
        encoder_step_of(position),
        warnings,
    )


def encoder_step_of(position):
    """The least spacing of positions [m] if 98 % of their spacings are multiples of it, or else 0."""
    spacings = np.diff(np.unique(position))
    spacings = spacings[
        spacings > max(1e-10, 1e-9 * np.abs(position).max())
    ]  # the rounding of what is written
    if not len(spacings):
        return 0.0
    counts = np.rint(spacings / spacings.min())
    step = float(spacings.sum() / counts.sum())
    return step if np.mean(np.abs(spacings - counts * step) < 0.02 * step) >= 0.98 else 0.0


def _factor(name, word):
    value = finite_number(word.encode("utf-8", "surrogateescape"))
    if not value > 0.0:
        fail(f"--scale: {name}: got {quoted(word)}; allowed: > 0")
    return value


def _index(recording, quantity, word):
    if word in recording.names:
        return recording.names.index(word)
    if word.isascii() and word.isdigit() and 1 <= int(word) <= len(recording.names):
        return int(word) - 1
    known = ", ".join(f"{i} {name}".rstrip() for i, name in enumerate(recording.names[:20], 1))
    fail(
        f"columns: {quantity}: no {quoted(word)}; the file has {known} (--columns {quantity}=NAME or number)",
        recording.file,
    )
