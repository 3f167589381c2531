"""Statistics of the times of a log: rate, jitter and missing rows, and the number of successive rows in which a
position or a force stays the same."""
import numpy as np

from .log import LONG_INTERVALS

# Largest plausible rate of a haptic or contact loop [Hz]. Above this rate, the times of the log are probably not in
# seconds.
FASTEST_HZ = 1e5
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
        "gaps": int((steps > LONG_INTERVALS * interval).sum()),
        "rows_per_position": 1.0 if log.held is None else log.held.rows,
        "rows_per_force": 1.0 if log.held_force is None else log.held_force.rows,
        "position_resolution_m": float(log.quantum_m.max()),
        "force_resolution_N": float(log.quantum_N.max()),
    }


def clock_warnings(clock):
    found = []
    if clock["rate_Hz"] > FASTEST_HZ:
        found.append(
            f"the rate of {clock['rate_Hz']:.4g} Hz is unusually high for a haptic or contact loop: is the time in "
            "other units? (--scale time=SECONDS_PER_UNIT)"
        )
    if clock["jitter_s"] > JITTER * clock["interval_s"]:
        found.append(
            f"the intervals of the clock scatter by {1e3 * clock['jitter_s']:.3g} ms around "
            f"{1e3 * clock['interval_s']:.4g} ms: force, energy and stiffness use the times as they are; frequencies "
            "assume the mean rate"
        )
    if clock["rows_missing"]:
        found.append(
            f"{clock['rows_missing']} rows are missing, at most {clock['rows_missing_in_a_row']} in a row: force steps "
            "across them are not counted"
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
