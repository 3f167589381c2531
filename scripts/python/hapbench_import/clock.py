"""Detects recordings whose times are not in seconds."""
import math

import numpy as np
from hapbench_command import fail

# Upper limit of the times of a recording [s]; larger times are not in seconds.
LATEST = 1e11
SINCE_1970 = (9e8, 4e9)  # interval of the plausible times since 1970: the years 1998 to 2096 [s]


def require_likely_clock(rows, file, scale, longest):
    """Refuses a recording whose times are probably not in seconds: the median interval exceeds `longest` [s], or a time
    is at least LATEST. The message suggests a scale of time."""
    usable = np.isfinite(rows.time)
    usable[list(rows.clock_problems)] = False
    time, position = rows.time[usable], rows.recorded[usable]
    steps = np.diff(time)
    if not len(steps):
        return
    median = float(np.sort(steps)[len(steps) // 2])
    latest = rows.origin + float(time.max())
    if not median > longest and latest < LATEST:
        return
    with np.errstate(over="ignore", invalid="ignore"):
        distances = np.linalg.norm(np.diff(position, axis=0), axis=1)
    moved = distances[np.isfinite(distances) & (distances > 0.0)]
    speed = float(np.median(moved)) / median if len(moved) and median > 0.0 else 0.0
    got = (
        f"a median interval of {median:.4g} s; allowed: {longest:g} s (--set max_gap=...)"
        if median > longest
        else f"times of up to {latest:.4g} s; allowed: {LATEST:g} s"
    )
    unit = likely_unit(abs(median), speed, latest)
    # Times that increase by exactly 1 may be row numbers.
    counts = (
        ", or numbers of rows? (--set sample_rate_Hz=... instead of --columns time=...)"
        if np.all(np.abs(steps / scale - 1.0) < 1e-9)
        else ""
    )
    fail(f"got {got}; are times in other units? (--scale time={unit * scale:g}){counts}", file)


def likely_unit(interval, speed, latest=0.0):
    """Returns the most likely unit of time [s]: 1e-3, 1e-6 or 1e-9. If one of them puts the latest time between the
    years 1998 and 2096, returns this unit. Otherwise returns the unit for which the interval is closest to 2 ms and the
    speed is closest to 5 cm/s. Arguments: interval [s], speed [m/s] and latest time [s], computed as if the times were
    in seconds."""
    units = (1e-3, 1e-6, 1e-9)
    for unit in units:
        if SINCE_1970[0] < latest * unit < SINCE_1970[1]:
            return unit

    def unlikely(unit):
        of_speed = abs(math.log10(speed / unit / 0.05)) if speed > 0.0 else 0.0
        of_interval = abs(math.log10(interval * unit / 2e-3)) if interval > 0.0 else 0.0
        return of_interval + min(of_speed, 3.0)

    return min(units, key=unlikely)
