"""Samples that were held: logged faster than they were measured, so that each is repeated in several rows."""
from dataclasses import dataclass

import numpy as np

FEWEST_CHANGES = 10
MOST_ROWS = 200  # that one sample may be repeated in
ALL, NEARLY_ALL = 0.98, 0.9  # shares of the changes that must keep to the rhythm


@dataclass
class Hold:
    rows: float  # rows that each sample is repeated in, in the mean
    fresh: np.ndarray  # True in the first row of each sample; in a longer rest, every `rows` rows


def hold_of(values):
    """The Hold of values, a row each, or None. Steps of an encoder are not held samples: a slow motion changes by one
    step at a time, and not in a rhythm of rows."""
    values = np.asarray(values).reshape(len(values), -1)
    steps = np.diff(values, axis=0)
    changed = np.flatnonzero(np.any(steps != 0.0, axis=1)) + 1
    if len(changed) < FEWEST_CHANGES or 2 * len(changed) > len(values):
        return None
    # In which column does not matter: the one that moves the most.
    moving = steps[changed - 1, np.argmax(np.abs(steps).sum(axis=0))]
    sizes = np.abs(moving[moving != 0.0])
    if len(np.unique(np.round(sizes / sizes.min(), 6))) < 3:
        return None
    rows = _rhythm(np.diff(changed))
    return None if rows is None else Hold(rows, _fresh(changed, rows, len(values)))


def _rhythm(runs):
    """Rows between changes: a whole number of which nearly all runs are multiples, or the mean of runs that
    differ by one row at most, as where the rates are not multiples, or by two, as where a clock has jitter.
    """
    largest = min(MOST_ROWS, int(np.median(runs)))
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
    """True in rows of a change; where nothing changes for longer, in those where a sample must have been, too."""
    fresh = np.zeros(count, bool)
    starts = np.concatenate([changed, [count]])
    # The rows before the first change keep its rhythm.
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
