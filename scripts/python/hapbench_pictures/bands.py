"""Draws a quantity over time for several runs of each law: a curve of the mean over the runs, and a band from the
smallest to the largest value of the runs."""
import numpy as np

from .panels import cut_off_peaks, share_an_axis

SPANS = 300  # number of time spans of a curve


def draw_bands(ax, quantity, laws, looks):
    """Draws the mean over the runs and the band for each law. `laws`: for each law, a list with an object Samples for
    each run. `looks`: look of each law."""
    drawn = [
        (s, one, s.of(quantity)) for runs, one in zip(laws, looks) for s in runs if s.of(quantity)
    ]
    if not drawn:
        return
    if not share_an_axis(ax, [high for _, _, (_, _, high) in drawn]):
        cut_off_peaks(ax, quantity, drawn)
    times = [time for _, _, (time, _, _) in drawn]
    edges = np.linspace(min(t[0] for t in times), max(t[-1] for t in times), SPANS + 1)
    for runs, one in zip(laws, looks):
        curves = [s.of(quantity) for s in runs if s.of(quantity)]
        if not curves:
            continue
        middle, low, high = band(curves, edges)
        at = (edges[1:] + edges[:-1]) / 2
        ax.fill_between(at, low, high, color=one.colour, alpha=0.15, lw=0)
        ax.plot(at, middle, lw=1.2, color=one.colour, ls=one.line, label=one.label)
    ax.set_ylabel(quantity.axis)
    ax.margins(x=0.01)


def band(curves, edges):
    """Returns (mean, smallest value, largest value) of several curves in each time interval between `edges`; NaN in
    intervals without a value. Each curve is (times, lower bounds, upper bounds)."""
    spans = len(edges) - 1
    total, count = np.zeros(spans), np.zeros(spans)
    smallest, largest = np.full(spans, np.inf), np.full(spans, -np.inf)
    for time, low, high in curves:
        ok = np.isfinite(low) & np.isfinite(high)
        at = np.clip(np.searchsorted(edges, time[ok], side="right") - 1, 0, spans - 1)
        total += np.bincount(at, (low[ok] + high[ok]) / 2, spans)
        count += np.bincount(at, minlength=spans)
        np.minimum.at(smallest, at, low[ok])
        np.maximum.at(largest, at, high[ok])
    empty = count == 0
    with np.errstate(invalid="ignore", divide="ignore"):
        return tuple(np.where(empty, np.nan, of) for of in (total / count, smallest, largest))
