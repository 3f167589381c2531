"""Statistics of the times of a log: rate, jitter and missing rows, and the number of successive rows in which a
position or a force stays the same."""
import numpy as np
from hapbench_import.clock import FASTEST_HZ, are_days
from hapbench_import.text_table import counted

from .log import LONG_INTERVALS

# If the standard deviation of the time steps exceeds this fraction of the mean interval, the audit prints a warning.
JITTER = 0.05


def clock_of(log):
    """Returns the statistics of the clock for the JSON. Names of quantities with a unit end in the unit."""
    steps, interval, missing = np.diff(log.time), log.interval, log.missing
    usual = steps[missing == 0]
    return {
        "rows": len(log.time),
        "duration_s": float(log.time[-1] - log.time[0]),
        "rate_Hz": 1.0 / interval,
        "interval_s": interval,
        "interval_min_s": float(steps.min()),
        "interval_max_s": float(steps.max()),
        "jitter_s": float(np.std(usual)) if len(usual) else 0.0,
        "rows_missing": int(missing.sum()),
        "rows_missing_in_a_row": int(missing.max()),
        "gaps": int(log.pauses.sum()),
        "rows_per_position": 1.0 if log.held is None else log.held.rows,
        "rows_per_force": 1.0 if log.held_force is None else log.held_force.rows,
        "position_resolution_m": float(log.quantum_m.max()),
        "force_resolution_N": float(log.quantum_N.max()),
    }


def clock_warnings(log, clock):
    found = []
    if clock["rate_Hz"] > FASTEST_HZ:
        found.append(
            f"the rate of {clock['rate_Hz']:.4g} Hz is unusually high for a haptic or contact loop: "
            + unit_text(log, clock["rate_Hz"])
        )
    if log.is_rounded:
        tick = float(np.median(np.diff(log.time)))
        found.append(
            f"the times are multiples of {1e3 * tick:.4g} ms, and fit an even clock of {clock['rate_Hz']:.4g} Hz whose "
            f"times are rounded: no row counts as missing. If a loop of {1.0 / tick:.4g} Hz lost these rows at regular "
            "times, rate, damping and delay are wrong; times with more digits show the difference"
        )
    if clock["jitter_s"] > JITTER * clock["interval_s"]:
        found.append(
            f"the intervals of the clock scatter by {1e3 * clock['jitter_s']:.3g} ms around "
            f"{1e3 * clock['interval_s']:.4g} ms: force, energy and stiffness use the times as they are; frequencies "
            "assume the mean rate"
        )
    if clock["rows_missing"]:
        lost = clock["rows_missing"]
        found.append(
            f"{counted(lost, 'row')} {'is' if lost == 1 else 'are'} missing, at most {clock['rows_missing_in_a_row']} "
            "in a row: force steps across them are not counted; work across them is interpolated, and its largest "
            "error is part of +-"
        )
    if clock["gaps"]:
        found.append(
            f"the clock has {clock['gaps']} gaps of more than {LONG_INTERVALS:g} intervals: they end a contact, and "
            "energy is not counted across them"
        )
    for what in ("position", "force"):
        rows = clock[f"rows_per_{what}"]
        if rows > 1.0:
            found.append(
                f"each {what} is repeated in {rows:.4g} rows: it changes at {clock['rate_Hz'] / rows:.4g} Hz, not at "
                "the rate of the log"
            )
    return found


def unit_text(log, rate):
    """Returns the question whether the times are in other units, with the option that would correct a `rate` [Hz] that
    is too high."""
    if are_days(rate, float(log.time[0])):
        return (
            "are the times in days, as in spreadsheets and MATLAB? (with --scale time=86400 the rate is "
            f"{rate / 86400.0:.4g} Hz)"
        )
    factor = 1e3 if rate < 1e7 else 1e6
    scale = factor * log.scales.get("time", 1.0)
    return (
        f"is the time in other units? (--scale time=SECONDS_PER_UNIT; with --scale time={scale:g} the rate is "
        f"{rate / factor:.4g} Hz)"
    )
