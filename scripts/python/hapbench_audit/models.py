"""Models of a contact's force, and their least-squares fits. A model is a spring and a damper at the position `delay`
rows earlier. Models differ in the way in which the engine may compute the velocity."""
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft
from scipy.signal import lfilter
from scipy.stats import t as student

from .log import MOST_MISSING

MOST_DELAY = MOST_MISSING  # rows
FEWEST = 10  # rows of a fit
JITTER = 1e-3  # of the interval: below, both clocks give the same velocities
LONGEST_MEMORY = 1000  # rows
LOW_PASSES = (1, 2, 4, 8, 16)  # time constants of a filtered velocity [rows]
LOW_PASS = "low-pass "  # begins their kinds
EVEN = "even "  # begins the kinds of a clock without jitter
LOOP = "loop "  # begins the kinds of a loop that is slower than the positions of the log
BEFORE = MOST_DELAY + 10 * max(LOW_PASSES)  # rows that a filter needs to forget how it started
BLOCKS = 10  # of the jackknife
AT_ONCE = (
    20_000  # numbers of a column that are computed together: they stay in the cache of a processor
)
COLLINEAR = 1e-9  # smallest share of a column that the other columns do not explain


@dataclass(frozen=True, order=True)
class Model:
    delay: int  # [rows]
    kind: str  # how the velocity is computed; a key of speeds()


@dataclass
class Fit:
    model: Model
    values: np.ndarray  # coefficients of the columns: position, velocity, (sign of the velocity)
    halves: np.ndarray  # half-widths of 95 % intervals
    squares: float  # sum of squared residuals
    explained: float  # explained fraction of the variance
    rows: int
    independent: float  # number of independent rows: rows divided by the memory of the residuals
    # Root mean square of the part of the velocity that is not proportional to the position [m/s].
    speed: float

    @property
    def stiffness(self):
        return -float(self.values[0])

    @property
    def damping(self):
        return -float(self.values[1])


class Motion:
    """Position and velocities along a direction around some rows of a log."""

    def __init__(self, log, rows, direction):
        self.first = max(int(rows[0]) - BEFORE, 0)
        part = slice(self.first, min(int(rows[-1]) + 2, len(log.time)))
        # Rows by the clock: a row that is missing keeps its number, so that a delay counts it.
        counted = log.counted[part] - log.counted[part.start]
        place, at = log.position[part] @ direction, np.arange(counted[-1] + 1)
        last = np.searchsorted(counted, at, side="right") - 1
        self.place = np.interp(at, counted, place)
        self.speeds = {
            kind: speed[last] for kind, speed in speeds(log, part, place, direction).items()
        }
        self.force = log.force[rows] @ direction
        self.rows = counted[rows - self.first]
        # Rows whose position or difference of positions would need a missing row.
        absent = counted[last] != at
        self.unknown = absent | np.append(False, absent[:-1]) | np.append(absent[1:], False)
        self.fits = {}  # by model and whether it has the sign of the velocity
        # A delay of more than half of a contact would make most of its force of positions before the contact.
        half = int(self.rows[-1] - self.rows[0] + 1) // 2
        self.most = min(MOST_DELAY, half, max(int(self.rows[-1]) - FEWEST, 0))
        self.interval = log.interval * (1.0 if log.held is None else log.held.rows)
        self.resolution = float(np.abs(direction) @ log.quantum_m)
        within = slice(int(self.rows[0]), int(self.rows[-1]) + 1)
        self.sampling = {
            kind: self.sampling_of(without_clock(kind)[1], within) for kind in self.speeds
        }

    def sampling_of(self, kind, within):
        """Returns the mean square error of a velocity that only approximates the engine's velocity [m^2/s^2]."""
        if kind == "logged":
            return 0.0
        backward = self.speeds["backward"][within]
        # At touch, the acceleration changes between two rows, which causes an error of half the difference of the
        # velocities.
        change = np.abs(self.speeds["central"][within] - backward).max()
        found = (0.5 * change) ** 2 / len(backward)
        constant = low_pass_of(kind)
        if constant:
            # The time constant differs by at most half the distance to the next time constant. Position and velocity
            # absorb most of the error.
            kinds = (f"{LOW_PASS}{constant // 2}" if constant > 1 else "backward", kind)
            near, own = (self.speeds[one][within] for one in kinds)
            place = self.place[within]
            columns = np.column_stack([np.ones(len(own)), place - place.mean(), own])
            columns /= np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
            error = 0.5 * (own - near)
            error -= columns @ np.linalg.lstsq(columns, error, rcond=1e-9)[0]
            found += np.mean(error**2)
        return float(found)

    def rounding(self, kind, stiffness, damping):
        """Mean square of the force that the resolution of the position causes in a model with this velocity [N^2]."""
        of_speed = damping / self.interval
        kind = without_clock(kind)[1]
        if kind == "logged":
            gain = stiffness**2
        elif kind == "central":
            gain = stiffness**2 + 0.5 * of_speed**2
        elif kind == "five-point":
            gain = stiffness**2 + 130.0 / 144.0 * of_speed**2
        elif kind == "forward":
            gain = (stiffness - of_speed) ** 2 + of_speed**2
        else:
            share = 1.0 / (1.0 + low_pass_of(kind))
            gain = (stiffness + share * of_speed) ** 2 + of_speed**2 * share**3 / (2.0 - share)
        return gain * self.resolution**2 / 12.0

    def delays_of(self, kind):
        """Delays of a velocity. A forward difference stands for an implicit step: with a delay it would equal a backward
        difference with one row less."""
        return np.arange(1 if kind.endswith("forward") else self.most + 1)

    def models(self):
        """All models."""
        return [
            Model(delay, kind) for kind in self.speeds for delay in self.delays_of(kind).tolist()
        ]

    def usable(self):
        """Returns True for rows whose delayed row exists in every model. The first velocity has no row before it."""
        return self.rows > self.most

    def known(self, delay):
        """True for usable rows whose delayed row is in the log."""
        return self.usable() & ~self.unknown[np.maximum(self.rows - delay, 0)]

    def columns(self, model, with_sign=False):
        """Centred columns and force of the known rows."""
        keep = self.known(model.delay)
        before = self.rows[keep] - model.delay
        x, v, f = self.place[before], self.speeds[model.kind][before], self.force[keep]
        columns = [x - x.mean(), v - v.mean()]
        if with_sign:
            moving = np.sign(np.where(np.abs(v) > 1e-3 * np.abs(v).max(), v, 0.0))
            columns.append(moving - moving.mean())
        return np.column_stack(columns), f - f.mean()


def without_clock(kind):
    """(EVEN, LOOP or nothing, the rest of the kind)."""
    clock = next((one for one in (EVEN, LOOP) if kind.startswith(one)), "")
    return clock, kind.removeprefix(clock)


def low_pass_of(kind):
    """Time constant of a backward difference [rows]; 0: not filtered."""
    kind = without_clock(kind)[1]
    return int(kind.removeprefix(LOW_PASS)) if kind.startswith(LOW_PASS) else 0


def speeds(log, part, place, direction):
    """Returns the velocities along the direction in these rows, keyed by the method by which an engine may compute
    them."""
    time = log.time[part]
    fresh = np.arange(len(place)) if log.held is None else np.flatnonzero(log.held.fresh[part])
    if len(fresh) < 3:
        return {}
    # Each new sample keeps its velocity until the next new sample.
    sample = np.maximum(np.searchsorted(fresh, np.arange(len(place)), side="right") - 1, 0)
    found = {} if log.velocity is None else {"logged": log.velocity[part] @ direction}
    steps = np.diff(time[fresh])
    found |= differences(np.diff(place[fresh]) / steps, sample, "")
    counted = np.append(0, np.cumsum(1 + log.missing))[part]
    even = np.diff(counted[fresh]) * log.interval
    if np.std(steps - even) > JITTER * log.interval:
        # The engine may assume a constant step, even if the clock of the log has jitter.
        found |= differences(np.diff(place[fresh]) / even, sample, EVEN)
    if log.held is None and log.held_force is not None:
        # The engine knows the positions of the rows with a new force only.
        found |= loop_speeds(log, part, place)
    return found


def loop_speeds(log, part, place):
    """Velocities by kind from the positions of the rows in which the force is new."""
    fresh = np.flatnonzero(log.held_force.fresh[part])
    if len(fresh) < 3:
        return {}
    sample = np.maximum(np.searchsorted(fresh, np.arange(len(place)), side="right") - 1, 0)
    return differences(np.diff(place[fresh]) / np.diff(log.time[part][fresh]), sample, LOOP)


def differences(rates, sample, clock):
    """Returns velocities by kind, computed from the differences between samples [m/s]. `sample`: number of each row's
    sample."""
    backward = np.concatenate([rates[:1], rates])
    forward = np.concatenate([rates, rates[-1:]])
    found = {
        clock + "backward": backward[sample],
        clock + "central": (0.5 * (backward + forward))[sample],
        clock + "five-point": five_point(rates)[sample],
        clock + "forward": forward[sample],
    }
    for constant in LOW_PASSES:
        pole = constant / (constant + 1.0)
        filtered = lfilter([1.0 - pole], [1.0, -pole], backward, zi=[pole * backward[0]])[0]
        found[f"{clock}{LOW_PASS}{constant}"] = filtered[sample]
    return found


def five_point(rates):
    """Derivatives of fourth order from differences of consecutive samples: (8 (x1 - x-1) - (x2 - x-2)) / 12."""
    padded = np.concatenate([rates[:1], rates[:1], rates, rates[-1:], rates[-1:]])
    return (7.0 * (padded[1:-2] + padded[2:-1]) - padded[:-3] - padded[3:]) / 12.0


def neighbours_of(model, kinds):
    """Models whose velocity is one step of approximation away, between which the velocity of an engine may lie."""
    clock, kind = without_clock(model.kind)
    constant = low_pass_of(kind)
    if constant:
        near = [
            f"{LOW_PASS}{constant // 2}" if constant > 1 else "backward",
            f"{LOW_PASS}{2 * constant}",
        ]
    else:
        near = {"central": ["five-point"], "five-point": ["central"]}.get(kind, [])
    return [Model(model.delay, clock + one) for one in near if clock + one in kinds]


@dataclass
class Residual:
    """The part of the force that a model leaves unexplained. Mean squares are per row [N^2]."""

    mean_square: float
    rounding: float  # mean square that the resolution of the position may cause
    sampling: float  # mean square that the sampling of the velocity may cause
    total: float  # mean square of the force less its mean
    damping: float  # [N s/m]


def residuals_of(motion):
    """Residual by Model, without models whose columns are collinear. Computes several delays at once."""
    keep = motion.usable()
    rows, force = motion.rows[keep], motion.force[keep]
    if len(rows) < FEWEST:
        return {}
    found = {}
    at_once = max(AT_ONCE // len(rows), 1)
    for first in range(0, motion.most + 1, at_once):
        delays = np.arange(first, min(first + at_once, motion.most + 1))
        before = rows - delays[:, None]
        known = ~motion.unknown[before]
        place = centred(motion.place[before], known)
        pushed = centred(np.broadcast_to(force, before.shape), known)
        for kind, speed in motion.speeds.items():
            some = slice(np.isin(delays, motion.delays_of(kind)).sum())
            if delays[some].size:
                across = centred(speed[before[some]], known[some])
                found |= residuals_of_kind(
                    motion, kind, delays[some], place[some], across, pushed[some], known[some]
                )
    return found


def residuals(motion):
    """(Residual by Model, Model with the smallest residual or None)."""
    found = residuals_of(motion)
    return found, min(found, key=lambda model: found[model].mean_square, default=None)


def centred(values, known):
    """The values less their means over the known values of each row; 0 where they are unknown."""
    count = np.maximum(known.sum(axis=1, keepdims=True), 1)
    return (values - (values * known).sum(axis=1, keepdims=True) / count) * known


def residuals_of_kind(motion, kind, delays, place, speed, force, known):
    """Residual by Model of some delays, by Gram and Schmidt. `place`, `speed`, `force`: centred columns, a row per
    delay; 0 where they are not `known`."""

    def dot(a, b):
        return np.einsum("ij,ij->i", a, b)

    def by(size):
        return np.where(size > 0.0, size, 1.0)

    count, total = known.sum(axis=1), dot(force, force)
    size, length = np.sqrt(dot(place, place)), np.sqrt(dot(speed, speed))
    along = place / by(size)[:, None]
    shared = dot(speed, along)
    across = speed - shared[:, None] * along
    independent = np.sqrt(dot(across, across))
    across /= by(independent)[:, None]
    slope = dot(force, along)
    rest = force - slope[:, None] * along
    other = dot(rest, across)
    rest -= other[:, None] * across
    is_usable = (count >= FEWEST) & (size > 0.0) & (independent > COLLINEAR * length)
    count = np.maximum(count, 1)
    damping = -other / by(independent)
    stiffness = (-slope - damping * shared) / by(size)
    columns = (
        delays,
        dot(rest, rest) / count,
        motion.rounding(kind, stiffness, damping),
        damping**2 * motion.sampling[kind],
        total / count,
        damping,
    )
    return {
        Model(delay, kind): Residual(*numbers)
        for delay, *numbers in zip(*(column[is_usable].tolist() for column in columns))
    }


def factors(matrix):
    """Returns (q, r, sizes) with matrix = q r diag(sizes) and orthonormal q; None if a column is constant or a linear
    combination of the others."""
    sizes = np.linalg.norm(matrix, axis=0)
    if len(matrix) < FEWEST or not (sizes > 0.0).all():
        return None
    q, r = np.linalg.qr(matrix / sizes)
    return (q, r, sizes) if np.abs(np.diag(r)).min() > COLLINEAR else None


def fit_of(motion, model, with_sign=False):
    """The Fit of a model; None where its columns are collinear. The motion keeps the fits that were made."""
    key = model, with_sign
    if key not in motion.fits:
        motion.fits[key] = new_fit(motion, model, with_sign)
    return motion.fits[key]


def new_fit(motion, model, with_sign):
    """The Fit of fit_of().

    Each interval is the larger of two: the least-squares interval with the memory of the residuals, and the interval of
    a jackknife over consecutive blocks, which also covers residuals that are correlated with the motion.
    """
    matrix, target = motion.columns(model, with_sign)
    found = factors(matrix)
    if found is None:
        return None
    q, r, sizes = found
    inverse = np.linalg.inv(r)
    residual = target - q @ (q.T @ target)
    values = inverse @ (q.T @ target) / sizes
    rows, squares, variance = (len(target), float(residual @ residual), float(target @ target))
    remembered = memory(residual)
    spread = squares / max(rows - matrix.shape[1] - 1, 1) * remembered
    errors = 1.96 * np.sqrt(spread * np.sum(inverse**2, axis=1)) / sizes
    speed = sizes[1] * np.sqrt(
        max(1.0 - (matrix[:, 0] @ matrix[:, 1] / sizes[:2].prod()) ** 2, 0.0)
    )
    return Fit(
        model,
        values,
        np.maximum(errors, jackknife(q, inverse, residual) / sizes),
        squares,
        1.0 - squares / variance if variance > 0.0 else 0.0,
        rows,
        rows / remembered,
        float(speed / np.sqrt(rows)),
    )


def jackknife(q, inverse, residual):
    """Returns half-widths of 95 % intervals from fits that each omit one of BLOCKS consecutive blocks."""
    count = min(BLOCKS, len(residual) // 4)
    sizes = np.full(count, len(residual) // count)
    sizes[: len(residual) % count] += 1
    starts = np.concatenate([[0], np.cumsum(sizes)[:-1]])
    parts = np.add.reduceat(q[:, :, None] * q[:, None, :], starts)
    products = np.add.reduceat(q * residual[:, None], starts)
    kept = np.linalg.pinv(np.eye(q.shape[1]) - parts, rcond=1e-9, hermitian=True)
    changes = (kept @ products[:, :, None])[:, :, 0] @ inverse.T
    changes -= changes.mean(axis=0)
    return quantile_95(count - 1) * np.sqrt((count - 1) / count * np.sum(changes**2, axis=0))


@lru_cache
def quantile_95(freedom):
    """Half-width of the 95 % interval of Student's distribution."""
    return float(student.ppf(0.975, freedom))


def memory(residual):
    """Rows that one independent residual stands for: 1 + 2 times the sum of the autocorrelations above 0.05."""
    power = float(residual @ residual)
    lags = min(len(residual) // 4, LONGEST_MEMORY)
    if power == 0.0 or lags < 2:
        return 1.0
    # Autocorrelations by the spectrum; zeros keep the ends from overlapping.
    size = next_fast_len(len(residual) + lags, real=True)
    spectrum = np.abs(rfft(residual / np.sqrt(power), size)) ** 2
    correlations = irfft(spectrum, size)[1:lags]
    known = np.append(correlations < 0.05, True).argmax()
    return 1.0 + 2.0 * float(correlations[:known].sum())
