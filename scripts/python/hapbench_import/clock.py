"""Clocks of recordings in other units than seconds."""
import math

import numpy as np
from hapbench_command import fail

LATEST = 1e11  # [s]; later times are in other units
SINCE_1970 = (9e8, 4e9)  # 1998 to 2096 [s]


def require_likely_clock(rows, file, scale, longest):
    """Refuses a clock in other units than seconds: intervals that are too long in the median, or times long after
    those since 1970. Names the scale of time that makes them likely."""
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
    # Whole numbers without a gap may count rows.
    counts = (
        ", or numbers of rows? (--set sample_rate_Hz=... instead of --columns time=...)"
        if np.all(np.abs(steps / scale - 1.0) < 1e-9)
        else ""
    )
    fail(f"got {got}; are times in other units? (--scale time={unit * scale:g}){counts}", file)


def likely_unit(interval, speed, latest=0.0):
    """1e-3, 1e-6 or 1e-9: what makes the latest time one of our days since 1970, or else an interval [s] the nearest
    to 2 ms and a speed [m/s] the nearest to 5 cm/s."""
    units = (1e-3, 1e-6, 1e-9)
    for unit in units:
        if SINCE_1970[0] < latest * unit < SINCE_1970[1]:
            return unit

    def unlikely(unit):
        of_speed = abs(math.log10(speed / unit / 0.05)) if speed > 0.0 else 0.0
        of_interval = abs(math.log10(interval * unit / 2e-3)) if interval > 0.0 else 0.0
        return of_interval + min(of_speed, 3.0)

    return min(units, key=unlikely)
