"""Detects held samples. If a log has a higher rate than the measurement, each sample is repeated in several rows."""
from dataclasses import dataclass

import numpy as np

FEWEST_CHANGES = 10
MAX_ROWS = 200  # largest number of rows that repeat one sample
# Samples count as held if the numbers of rows between successive changes of the value are regular: at least the
# fraction ALL of these numbers are multiples of the same number, or at least the fraction NEARLY_ALL of these numbers
# differ from their median by at most 1.
ALL, NEARLY_ALL = 0.98, 0.9


@dataclass
class Hold:
    rows: float  # mean number of rows of each sample
    # True in the first row of each sample. While the value is constant for longer than one sample, true in every
    # `rows`-th row.
    fresh: np.ndarray


def hold_of(values):
    """Returns the Hold of `values`, or None if samples are not held. `values`: one number or vector for each row. A
    slow motion measured by an encoder is not held: its values change by one encoder step, at irregular numbers of rows.
    """
    values = np.asarray(values).reshape(len(values), -1)
    steps = np.diff(values, axis=0)
    changed = np.flatnonzero(np.any(steps != 0.0, axis=1)) + 1
    if len(changed) < FEWEST_CHANGES or 2 * len(changed) > len(values):
        return None
    # Uses the column with the largest motion. All columns change in the same rows.
    moving = steps[changed - 1, np.argmax(np.abs(steps).sum(axis=0))]
    sizes = np.abs(moving[moving != 0.0])
    if len(np.unique(np.round(sizes / sizes.min(), 6))) < 3:
        return None
    rows = _rhythm(np.diff(changed))
    return None if rows is None else Hold(rows, _fresh(changed, rows, len(values)))


def _rhythm(runs):
    """Returns the number of rows of each sample. `runs`: numbers of rows between changes. The result is an integer if
    nearly all runs are multiples of it. Otherwise the result is the mean of the runs if nearly all runs differ from
    each other by at most one row (the rates are not multiples of each other) or by at most two rows (the clock has
    jitter). Otherwise returns None."""
    largest = min(MAX_ROWS, int(np.median(runs)))
    for n in range(largest, 1, -1):
        if np.mean(runs % n == 0) >= ALL:
            return float(n)
    usual = int(np.median(runs))
    for low, high in ((usual - 1, usual), (usual, usual + 1), (usual - 1, usual + 1)):
        near = (low <= runs) & (runs <= high)
        if low >= 2 and np.mean(near) >= NEARLY_ALL:
            return float(runs[near].mean())
    return None


def _fresh(changed, rows, count):
    """Returns for each row True if a new sample begins in it: in rows with a change, and in rows in which a sample is
    expected while the value is constant."""
    fresh = np.zeros(count, bool)
    starts = np.concatenate([changed, [count]])
    # The rows before the first change have the same rhythm.
    before = changed[0] - np.arange(1, int(changed[0] / rows) + 1) * rows
    fresh[np.rint(before).astype(int)] = True
    for start, end in zip(starts, starts[1:]):
        fresh[start] = True
        samples = int((end - start) / rows + 0.5)
        if samples > 1:
            fresh[
                np.rint(
                    start + np.arange(1, samples) * (end - start) / samples
                    if end < count
                    else start + np.arange(1, samples) * rows
                ).astype(int)
            ] = True
    return fresh
