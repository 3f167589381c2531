"""Fewer rows for a drawing that cannot show them all, without losing a peak."""
import numpy as np


def reduced(time, low, high, spans):
    """The least of `low` and the greatest of `high` in each of so many equal spans of time that hold a row, and where
    the span begins; the rows themselves when they are no more. NaN only where a span has nothing else."""
    if len(time) <= 2 * spans:
        return time, low, high
    length = (time[-1] - time[0]) or 1.0
    span = np.minimum(((time - time[0]) / length * spans).astype(int), spans - 1)
    starts = np.flatnonzero(np.diff(span, prepend=-1))
    return time[starts], np.fmin.reduceat(low, starts), np.fmax.reduceat(high, starts)


def curve(time, low, high, spans):
    """The same as one line: down and up within each span."""
    t, least, most = reduced(time, low, high, spans)
    if len(t) == len(time):
        return time, low
    return np.repeat(t, 2), np.column_stack([least, most]).ravel()
