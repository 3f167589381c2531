"""Detects recordings whose times are not in seconds."""
import math

import numpy as np
from hapbench_command import fail

# Upper limit of the times of a recording [s]; larger times are not in seconds.
LATEST = 1e11
SINCE_1970 = (9e8, 4e9)  # interval of the plausible times since 1970: the years 1998 to 2096 [s]
# The same years since the year 1601, as in Windows, and since the year 1, as in .NET and Unity [s]. Both count in TICK.
SINCE_1601, SINCE_1 = (1.25e10, 1.57e10), (6.3e10, 6.62e10)
TICK = 1e-7  # unit of the times of Windows, .NET and Unity [s]
USUAL_TICKS = (20.0, 5000.0)  # rates at which times in TICK are likely [Hz]
# Plausible numbers of days in the time column of a recording whose times are dates: the years 1982 to 2091 as
# days since 1900, and the same years as days since the year 0.
DAYS = ((3e4, 7e4), (7e5, 8e5))
# Smallest number of long time steps that show that an even clock was rounded. Fewer lost rows can be as evenly spaced
# by chance.
FEWEST_ROUNDED = 10
FEWEST_STEPS = 20  # smallest number of time steps that show packets
IN_PACKETS = 0.02  # smallest fraction of the time steps that are between packets
FASTEST_HZ = 1e5  # largest usual rate of a recording [Hz]


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
    unit = likely_unit(abs(median) / scale, speed * scale, latest / scale)
    rate = scale / (TICK * abs(median)) if median else 0.0
    of_ticks = (
        f"; for ticks of 100 ns, as of .NET and Unity: --scale time={TICK:g}, at {rate:.4g} Hz"
        if unit != TICK
        and USUAL_TICKS[0] <= rate <= USUAL_TICKS[1]
        and not is_since_1970(latest / scale * unit)
        else ""
    )
    # Times that increase by exactly 1 may be row numbers.
    counts = (
        ", or numbers of rows? (--set sample_rate_Hz=... instead of --columns time=...)"
        if np.all(np.abs(steps / scale - 1.0) < 1e-9)
        else ""
    )
    fail(f"got {got}; are times in other units? (--scale time={unit:g}){of_ticks}{counts}", file)


def are_days(rate, first_time):
    """Returns True if times are probably dates in days, as in spreadsheets and MATLAB, that are read as seconds.
    `rate`: the rate that follows [Hz]. `first_time`: first time of the recording."""
    return rate > FASTEST_HZ and any(low < first_time < high for low, high in DAYS)


def usual_interval(steps):
    """Returns the mean of the time steps that differ from their median by at most half of it. The median alone has the
    resolution of the clock, and a longer step may contain missing rows."""
    median = float(np.median(steps))
    return float(steps[np.abs(steps - median) <= 0.5 * median].mean())


def is_rounded(steps, tick):
    """Returns True if time steps of one and of two ticks are those of an even clock whose times are rounded to whole
    ticks. Rows that were lost at random are not as evenly spaced. `tick`: median of the steps [s].
    """
    ticks = np.rint(steps / tick)
    if np.sum(ticks == 2.0) < FEWEST_ROUNDED or ticks.max() > 2.0 or ticks.min() < 1.0:
        return False
    rows, time = np.arange(len(steps) + 1), np.append(0.0, np.cumsum(steps / tick))
    return bool(np.ptp(time - np.polyval(np.polyfit(rows, time, 1), rows)) <= 1.1)


def packet_rate(time, position):
    """Returns the mean rate of a recording [Hz] whose rows arrive in packets. The times within a packet are then close
    to each other, so that more rows than exist seem to be missing between packets. The times deviate from an even clock
    by at most two packets, and the position moves between packets about as far as within a packet. Returns None for
    other recordings, also if rows were lost at random or if the recording pauses. `time`: increasing times [s].
    """
    steps = np.diff(time)
    median = float(np.median(steps)) if len(steps) >= FEWEST_STEPS else 0.0
    is_long = steps > 2.0 * median
    if not median > 0.0 or steps.mean() <= 2.0 * median or is_long.mean() < IN_PACKETS:
        return None
    rows = np.arange(len(time))
    interval, start = np.polyfit(rows, time, 1)
    if np.ptp(time - start - interval * rows) > 2.0 * steps.max():
        return None
    moved = np.sum(np.diff(position, axis=0) ** 2, axis=1)
    longer = float(steps[is_long].mean() / steps[~is_long].mean())
    return (
        1.0 / float(interval) if moved[is_long].mean() < longer * moved[~is_long].mean() else None
    )


def packet_text(rate):
    return (
        f"the rows arrive in packets, with a mean rate of {rate:.4g} Hz: the times are those of the packets and not of "
        f"the rows; --set sample_rate_Hz={rate:.5g} instead of a column of times reads the rows at this rate"
    )


def is_since_1970(time):
    return SINCE_1970[0] < time < SINCE_1970[1]


def likely_unit(interval, speed, latest=0.0):
    """Returns the most likely unit of time [s]: 1e-3, 1e-6, 1e-9 or TICK. If one of them puts the latest time between
    the years 1998 and 2096, returns this unit. Otherwise returns 1e-3, 1e-6 or 1e-9: the unit for which the interval is
    closest to 2 ms and the speed is closest to 5 cm/s. Arguments: interval [s], speed [m/s] and latest time [s],
    computed as if the times were in seconds."""
    units = (1e-3, 1e-6, 1e-9)
    for unit in units:
        if is_since_1970(latest * unit):
            return unit
    if any(low < latest * TICK < high for low, high in (SINCE_1601, SINCE_1)):
        return TICK

    def unlikely(unit):
        of_speed = abs(math.log10(speed / unit / 0.05)) if speed > 0.0 else 0.0
        of_interval = abs(math.log10(interval * unit / 2e-3)) if interval > 0.0 else 0.0
        return of_interval + min(of_speed, 3.0)

    return min(units, key=unlikely)
