"""Compares the force of a sensor with the force that the engine commanded."""
import numpy as np

MAX_LAG = 200  # longest delay of a measured force that is searched [rows]
# Smallest correlation of measured and commanded force that determines a delay.
MIN_CORRELATION = 0.5
# Correlations that differ by less than SAME_CORRELATION are equally large. Between two delays with equally large
# correlations, the correlation is smaller by at least SMALLER_CORRELATION.
SAME_CORRELATION, SMALLER_CORRELATION = 0.01, 0.1


def measured_lag(log, contacts):
    """Compares the measured force with the commanded force. Returns the delay [s] at which their correlation is largest
    in magnitude, and the gain and the correlation at this delay. If no delay is certain, delay and gain are None, and
    `why` is the reason. Returns None without a measured force or without contact."""
    if log.measured is None or not contacts.in_contact.any():
        return None
    rows = np.arange(log.counted[-1] + 1)
    a, b = (
        np.column_stack([np.interp(rows, log.counted, column) for column in values.T])
        for values in (log.force, log.measured)
    )
    pairs = [correlated(a[: len(a) - lag], b[lag:]) for lag in range(min(MAX_LAG, len(a) // 4) + 1)]
    sizes = np.abs([correlation for correlation, _ in pairs])
    # A periodic force correlates at several delays, with both signs. The shortest of them is the most likely one. In
    # between, the correlation is clearly smaller.
    first = int(np.argmax(sizes >= sizes.max() - SAME_CORRELATION))
    smaller = np.flatnonzero(sizes[first:] < sizes.max() - SMALLER_CORRELATION)
    lag = first + int(np.argmax(sizes[first : first + smaller[0] if len(smaller) else None]))
    correlation, gain = pairs[lag]
    found = {"delay_s": lag * log.interval, "gain": gain, "correlation": correlation}
    unknown = {"delay_s": None, "gain": None, "correlation": correlation}
    if not np.ptp(log.measured, axis=0).any():
        return unknown | {"why": "the measured force is constant"}
    if sizes[lag] < MIN_CORRELATION:
        largest = f"by at most {sizes.max():.2g}"
        return unknown | {
            "why": f"the measured force correlates {largest} with the commanded force"
        }
    if lag == len(pairs) - 1:
        longest = 1e3 * (len(pairs) - 1) * log.interval
        return unknown | {
            "why": f"the delay is above {longest:.3g} ms, the longest that is searched"
        }
    return found


def correlated(a, b):
    """Returns (correlation of two series of vectors, factor of `a` that fits `b` best)."""
    a, b = a - a.mean(axis=0), b - b.mean(axis=0)
    size, length, both = float(np.sum(a**2)), float(np.sum(b**2)), float(np.sum(a * b))
    return both / max(np.sqrt(size * length), 1e-300), both / max(size, 1e-300)
