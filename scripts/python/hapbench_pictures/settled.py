"""The range of an axis: that of settled contact, where the peak of a landing or a crash would squeeze it."""
import numpy as np

from hapbench_report.json_input import at, number_or_none
from hapbench_report.replay_rows import SETTLING_S

# A peak of more than so many times the settled values is cut off.
CUT_OFF = 3
# If settled contact tells little of a run, as of one that hammers to the end, no range leaves out more of its rows.
LARGEST_LEFT_OUT = 0.1
BULK = (1, 99)  # percentiles of the settled rows


def settled_rows(time, colliding, settling_s, from_s):
    """As hapbench_report.replay_rows.settled, for a million rows."""
    touching = np.flatnonzero(colliding > 0)
    found = np.zeros(len(time), bool)
    if from_s is not None:
        found[touching] = time[touching] >= from_s
        return found
    when = time[touching]
    first = np.diff(when, prepend=-np.inf) >= settling_s
    found[touching] = when - np.maximum.accumulate(np.where(first, when, -np.inf)) >= settling_s
    return found


def settled_of(run, trajectory):
    """These rows of a run, by the settings of its metrics."""
    settling_s = number_or_none(at(run.scenario, "/metrics/settling_s"))
    return settled_rows(trajectory["time_s"], trajectory["colliding"], SETTLING_S if settling_s is None else settling_s,
                        number_or_none(at(run.scenario, "/metrics/from_s")))


def settled_range(curves):
    """The least and the greatest value of the bulk of settled contact with some air; None when all is to be shown. Each
    curve: which rows are settled, and the lower and upper edge of every row."""
    ends = [(np.nanpercentile(low[calm], BULK[0]), np.nanpercentile(high[calm], BULK[1])) for calm, low, high in curves
            if np.isfinite(low[calm]).any() and np.isfinite(high[calm]).any()]
    if not ends:
        return None
    low, high = min(a for a, _ in ends), max(b for _, b in ends)
    size = max(abs(low), abs(high))
    peak = max(np.nanmax(np.abs(edge), initial=0.0) for _, *edges in curves for edge in edges)
    if not peak > CUT_OFF * size > 0:
        return None
    air = max(0.25 * (high - low), 0.05 * size)
    bottom, top = float(low - air), float(high + air)
    left_out = max(np.mean((lows < bottom) | (highs > top)) for _, lows, highs in curves if len(lows))
    return (bottom, top) if left_out <= LARGEST_LEFT_OUT else None
