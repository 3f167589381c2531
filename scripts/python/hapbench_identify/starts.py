"""Parameters to start least squares from. Over a long log the sum of squares has many minima, which only starts that differ leave."""
import numpy as np

from .model import NAMES

DELAYS = np.arange(0.0, 8.5, 0.5)       # [samples]
SMOOTHINGS = (0.02, 0.05, 0.1)          # whole width of a kernel [s]
GRID = [(m, c, d) for m in (0.05, 0.2, 0.8) for c in (0.02, 0.2, 0.5) for d in (1.0, 4.0)]  # kg, of the peak, samples


def noise_of(place):
    """Standard deviation of what changes from sample to sample [m]: third differences of white noise have 20 times its variance."""
    return float(np.sqrt(np.mean(np.diff(place, 3)**2) / 20.0)) if len(place) > 3 else 0.0


def kernel(rows):
    """A box of a quarter of `rows`, folded with itself to a bell of about `rows`."""
    box = np.ones(max(1, round(rows / 4)))
    bell = np.convolve(np.convolve(box, box), np.convolve(box, box))
    return bell / bell.sum()


def starts_of(log, place, force):
    """Parameters (NAMES) by regression of the force on acceleration, speed and direction, all of them through the same kernel, and
    from a grid. `place`: the positions of rows without a gap, `force`: theirs."""
    step, peak, noise = log.step, float(np.abs(force).max()), noise_of(place)
    speed = first_speed(place, step, log.encoder_step)
    found = []
    for smoothing in SMOOTHINGS:
        bell = kernel(smoothing / step)
        if len(bell) + 30 > len(place):
            continue
        for mass, viscous, dry, delay, offset in _regressions(bell, place, force, step, noise):
            found += [(mass, viscous, share * dry, delay, offset) for share in (1.0, 0.5, 2.0)]
    found += [(m, 0.3, c * peak, d, 0.0) for m, c, d in GRID]
    starts = np.zeros((len(found), len(NAMES)))
    starts[:, :5], starts[:, 5] = found, speed
    starts[:, 2] = np.clip(starts[:, 2], 0.01 * peak, 0.95 * peak)
    starts[:, 3] *= step
    return starts


def _regressions(bell, place, force, step, noise):
    """The two best delays, at least a sample apart: mass, viscous and dry friction, delay [samples], offset."""
    middle = slice(1, -1)
    slope = (place[2:] - place[:-2]) / (2.0 * step)
    speed = np.convolve(slope, bell, "valid")
    acceleration = np.convolve(np.diff(place, 2) / step**2, bell, "valid")
    held = np.concatenate([[0.0], 0.5 * (force[1:] + force[:-1])])  # what a second difference of positions sees
    push = np.concatenate([np.zeros(9), held[middle]])              # no force before the log
    push = np.convolve(push, bell, "valid")                         # push[k + 9] belongs to speed[k]
    least = 4.0 * noise * np.sqrt(np.sum(np.convolve(bell, [0.5, 0.0, -0.5])**2)) / step
    way = np.where(np.abs(speed) > least, np.sign(speed), 0.0)
    # Where the whole kernel sees one direction, the smoothed friction is all of it.
    half = len(bell) // 2
    sums = np.cumsum(np.concatenate([np.zeros(half + 1), way, np.zeros(half)]))
    one_way = np.abs(sums[2 * half + 1:] - sums[:-2 * half - 1]) == 2 * half + 1
    rows = np.flatnonzero(one_way)
    if len(rows) < 40:
        rows = np.flatnonzero(way)
    if len(rows) < 10:
        return []
    known = np.column_stack([acceleration, speed, way, -np.ones_like(way)])[rows]
    late = np.stack([np.where(d % 1.0 == 0.0, push[rows + 9 - int(d)], 0.5 * (push[rows + 9 - int(d)] + push[rows + 8 - int(d)]))
                     for d in DELAYS], axis=1)
    size = np.maximum(np.abs(known).max(axis=0), 1e-300)
    terms = np.linalg.lstsq(known / size, late, rcond=1e-10)[0]
    wrong = terms[1] < 0.0
    without = [0, 2, 3]
    terms[:, wrong] = 0.0
    terms[np.ix_(without, wrong)] = np.linalg.lstsq((known / size)[:, without], late[:, wrong], rcond=1e-10)[0]
    misses = np.sum((late - known / size @ terms)**2, axis=0)
    terms /= size[:, None]
    order = [i for i in np.argsort(misses) if terms[0, i] > 0.0]
    best = order[:1] + [i for i in order if abs(DELAYS[i] - DELAYS[order[0]]) >= 1.0][:1]
    return [(terms[0, i], terms[1, i], max(terms[2, i], 0.0), DELAYS[i], terms[3, i]) for i in best]


def first_speed(place, step, encoder_step):
    """Speed at the first sample [m/s] by a parabola through the first hundredth of a second, 0 where it is not sure."""
    rows = min(len(place), max(8, round(0.01 / step)))
    powers = np.vander(step * np.arange(rows), 3, increasing=True)
    terms, *_ = np.linalg.lstsq(powers, place[:rows], rcond=None)
    spread = np.std(place[:rows] - powers @ terms) + encoder_step / np.sqrt(12.0)
    return float(terms[1]) if abs(terms[1]) > 4.0 * spread * np.sqrt(np.linalg.inv(powers.T @ powers)[1, 1]) else 0.0
