"""Models of the force in a contact, and their least-squares fits. By a model, the force in a row is the sum of a spring
force and a damping force, which depend on the position and on the velocity `delay` rows earlier. Models differ in the
delay, and in the assumed method by which the engine computes the velocity."""
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft
from scipy.signal import lfilter
from scipy.stats import t as student

from .log import MAX_MISSING

MAX_DELAY = MAX_MISSING  # longest delay of a model [rows]
FEWEST = 10  # smallest number of rows of a fit
# Largest jitter, as a fraction of the interval, for which logged times and a constant time step give nearly the same
# velocities.
JITTER = 1e-3
LONGEST_MEMORY = 1000  # largest lag of the autocorrelation of residuals [rows]
LOW_PASSES = (1, 2, 4, 8, 16)  # time constants of a filtered velocity [rows]
LOW_PASS = "low-pass "  # prefix of the kinds of filtered velocities
EVEN = "even "  # prefix of the kinds of velocities that assume a constant time step
# Prefix of the kinds of velocities that a control loop computes at a lower rate than the rate of the logged positions.
LOOP = "loop "
# Number of rows before the fitted rows that a Motion contains: the longest delay, plus the rows over which the initial
# state of a filter decays.
BEFORE = MAX_DELAY + 10 * max(LOW_PASSES)
BLOCKS = 10  # number of blocks of the jackknife
# Largest number of values of one array that are processed together, so that they fit in the processor's cache.
AT_ONCE = 20_000
# The columns of a fit's matrix count as collinear if the part of a column that is linearly independent of the other
# columns is smaller than this fraction of the column.
COLLINEAR = 1e-9


@dataclass(frozen=True, order=True)
class Model:
    delay: int  # delay of the force behind position and velocity [rows]
    kind: str  # how the velocity is computed; a key of speeds()


@dataclass
class Fit:
    model: Model
    # Coefficients of the columns: minus stiffness [N/m], minus damping [N s/m], and for dry friction the coefficient of
    # the sign of the velocity [N].
    values: np.ndarray
    halves: np.ndarray  # half-widths of the 95 % intervals of `values`
    squares: float  # sum of squared residuals [N^2]
    explained: float  # fraction of the variance of the force that the model explains
    rows: int  # number of rows of the fit
    independent: float  # number of independent rows: `rows` divided by memory() of the residuals
    # Root mean square of the part of the velocity that is not proportional to the position [m/s].
    speed: float

    @property
    def stiffness(self):
        return -float(self.values[0])

    @property
    def damping(self):
        return -float(self.values[1])


class Motion:
    """Positions, velocities and forces of some rows of a log along a direction. The positions and velocities also cover
    the earlier rows that delays and filters need."""

    def __init__(self, log, rows, direction):
        self.first = max(int(rows[0]) - BEFORE, 0)
        part = slice(self.first, min(int(rows[-1]) + 2, len(log.time)))
        # Row numbers that also count missing rows, so that a delay of a number of rows is always the same time.
        counted = log.counted[part] - log.counted[part.start]
        position, at = log.position[part] @ direction, np.arange(counted[-1] + 1)
        last = np.searchsorted(counted, at, side="right") - 1
        self.position = np.interp(at, counted, position)
        self.speeds = {
            kind: speed[last] for kind, speed in speeds(log, part, position, direction).items()
        }
        self.force = log.force[rows] @ direction
        self.rows = counted[rows - self.first]
        # True for rows whose position, or difference to a neighbouring position, depends on a missing row.
        absent = counted[last] != at
        self.unknown = absent | np.append(False, absent[:-1]) | np.append(absent[1:], False)
        self.fits = {}  # cache of fit_of(): Fit by (Model, with_sign)
        # With a delay longer than half of the contact, most forces would depend on positions before the contact.
        half = int(self.rows[-1] - self.rows[0] + 1) // 2
        self.max_delay = min(MAX_DELAY, half, max(int(self.rows[-1]) - FEWEST, 0))
        self.interval = log.interval * (1.0 if log.held is None else log.held.rows)
        self.resolution = float(np.abs(direction) @ log.quantum_m)
        within = slice(int(self.rows[0]), int(self.rows[-1]) + 1)
        self.sampling = {
            kind: self.sampling_of(without_clock(kind)[1], within) for kind in self.speeds
        }

    def sampling_of(self, kind, within):
        """Returns the estimated mean square difference [m^2/s^2] between the velocity `kind` and the velocity that the
        engine uses, over the rows `within`. It is 0 for a logged velocity."""
        if kind == "logged":
            return 0.0
        backward = self.speeds["backward"][within]
        # At touch, the acceleration changes between two rows. The error of the velocity is then half the difference
        # between the central and the backward velocity.
        change = np.abs(self.speeds["central"][within] - backward).max()
        found = (0.5 * change) ** 2 / len(backward)
        constant = low_pass_of(kind)
        if constant:
            # The time constant of the engine differs from the modelled time constant by at most half the distance to
            # the next modelled time constant. The fit of position and velocity absorbs most of the resulting error of
            # the velocity; only the remaining error counts.
            kinds = (f"{LOW_PASS}{constant // 2}" if constant > 1 else "backward", kind)
            near, modelled = (self.speeds[one][within] for one in kinds)
            position = self.position[within]
            columns = np.column_stack(
                [np.ones(len(modelled)), position - position.mean(), modelled]
            )
            columns /= np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
            error = 0.5 * (modelled - near)
            error -= columns @ np.linalg.lstsq(columns, error, rcond=1e-9)[0]
            found += np.mean(error**2)
        return float(found)

    def rounding(self, kind, stiffness, damping):
        """Returns the mean square of the force error [N^2] that the resolution of the position causes in a model with
        the velocity `kind`."""
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
        """Returns the delays [rows] of the models with the velocity `kind`. A forward difference represents an implicit
        step and has the delay 0 only. The velocity of a forward difference with a delay of d rows would equal the
        velocity of a backward difference with a delay of d - 1 rows."""
        return np.arange(1 if kind.endswith("forward") else self.max_delay + 1)

    def models(self):
        """Returns all models: one for each kind of velocity and each of the delays_of() this kind."""
        return [
            Model(delay, kind) for kind in self.speeds for delay in self.delays_of(kind).tolist()
        ]

    def usable(self):
        """Returns for each fitted row True if the row d rows earlier exists for every delay d up to `max_delay`. Row 0
        does not count as such a row, because its velocity would need an earlier row."""
        return self.rows > self.max_delay

    def known(self, delay):
        """Returns for each fitted row True if it is usable() and the row `delay` rows earlier is not affected by
        missing rows."""
        return self.usable() & ~self.unknown[np.maximum(self.rows - delay, 0)]

    def columns(self, model, with_sign=False):
        """Returns (matrix, force) of the least-squares fit of a model to the rows known(). The columns of the matrix
        are the delayed position, the delayed velocity, and, if `with_sign` is true, the sign of the delayed velocity.
        The mean of each column and of the force is subtracted."""
        keep = self.known(model.delay)
        before = self.rows[keep] - model.delay
        x, v, f = self.position[before], self.speeds[model.kind][before], self.force[keep]
        columns = [x - x.mean(), v - v.mean()]
        if with_sign:
            moving = np.sign(np.where(np.abs(v) > 1e-3 * np.abs(v).max(), v, 0.0))
            columns.append(moving - moving.mean())
        return np.column_stack(columns), f - f.mean()


def without_clock(kind):
    """Splits the kind of a velocity into (prefix, rest). The prefix is EVEN, LOOP or an empty text."""
    clock = next((one for one in (EVEN, LOOP) if kind.startswith(one)), "")
    return clock, kind.removeprefix(clock)


def low_pass_of(kind):
    """Returns the time constant of a filtered backward difference [rows]; 0 if the velocity is not filtered."""
    kind = without_clock(kind)[1]
    return int(kind.removeprefix(LOW_PASS)) if kind.startswith(LOW_PASS) else 0


def speeds(log, part, position, direction):
    """Returns a dict from kind to the velocities [m/s] along the direction in the rows `part`. A kind is a method by
    which an engine may compute velocities. `position`: positions of these rows along the direction [m].
    """
    time = log.time[part]
    fresh = np.arange(len(position)) if log.held is None else np.flatnonzero(log.held.fresh[part])
    if len(fresh) < 3:
        return {}
    # Number of the latest new position in each row. Rows that repeat a position also repeat its velocity.
    sample = np.maximum(np.searchsorted(fresh, np.arange(len(position)), side="right") - 1, 0)
    found = {} if log.velocity is None else {"logged": log.velocity[part] @ direction}
    steps = np.diff(time[fresh])
    found |= differences(np.diff(position[fresh]) / steps, sample, "")
    counted = np.append(0, np.cumsum(1 + log.missing))[part]
    even = np.diff(counted[fresh]) * log.interval
    if np.std(steps - even) > JITTER * log.interval:
        # The engine may assume a constant step, even if the clock of the log has jitter.
        found |= differences(np.diff(position[fresh]) / even, sample, EVEN)
    if log.held is None and log.held_force is not None:
        # The engine reads positions only in the rows with a new force.
        found |= loop_speeds(log, part, position)
    return found


def loop_speeds(log, part, position):
    """Returns velocities [m/s] by kind, computed from the positions of the rows in which the force is new."""
    fresh = np.flatnonzero(log.held_force.fresh[part])
    if len(fresh) < 3:
        return {}
    sample = np.maximum(np.searchsorted(fresh, np.arange(len(position)), side="right") - 1, 0)
    return differences(np.diff(position[fresh]) / np.diff(log.time[part][fresh]), sample, LOOP)


def differences(rates, sample, clock):
    """Returns velocities [m/s] by kind. `rates`: differences between consecutive samples divided by the time between
    them [m/s]. `sample`: number of the current sample in each row. `clock`: prefix of the kinds."""
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
    """Returns the derivative at each sample k by the difference formula of fourth order. With the sampling period T,
    the formula is (8 (x_(k+1) - x_(k-1)) - (x_(k+2) - x_(k-2))) / (12 T). `rates`: (x_(k+1) - x_k) / T.
    """
    padded = np.concatenate([rates[:1], rates[:1], rates, rates[-1:], rates[-1:]])
    return (7.0 * (padded[1:-2] + padded[2:-1]) - padded[:-3] - padded[3:]) / 12.0


def neighbours_of(model, kinds):
    """Returns the models that have the same delay as `model` and a neighbouring kind of velocity. The velocity that the
    engine computes may lie between the velocities of two neighbours. The neighbours of a filtered velocity are the
    velocities with half and with twice its time constant; for the smallest time constant, the backward difference
    replaces the velocity with half the time constant. The central and the five-point difference are neighbours of each
    other. `kinds`: all kinds of velocities of the log."""
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

    mean_square: float  # mean square of the residuals
    rounding: float  # mean square that the resolution of the position may cause
    sampling: float  # mean square that the sampling of the velocity may cause
    total: float  # mean square of the force minus its mean
    damping: float  # damping of the least-squares fit [N s/m]


def residuals_of(motion):
    """Returns a dict from Model to Residual, without the models whose columns are collinear. Several delays are
    computed together, because this is faster."""
    keep = motion.usable()
    rows, force = motion.rows[keep], motion.force[keep]
    if len(rows) < FEWEST:
        return {}
    found = {}
    at_once = max(AT_ONCE // len(rows), 1)
    for first in range(0, motion.max_delay + 1, at_once):
        delays = np.arange(first, min(first + at_once, motion.max_delay + 1))
        before = rows - delays[:, None]
        known = ~motion.unknown[before]
        position = centred(motion.position[before], known)
        pushed = centred(np.broadcast_to(force, before.shape), known)
        for kind, speed in motion.speeds.items():
            some = slice(np.isin(delays, motion.delays_of(kind)).sum())
            if delays[some].size:
                across = centred(speed[before[some]], known[some])
                found |= residuals_of_kind(
                    motion, kind, delays[some], position[some], across, pushed[some], known[some]
                )
    return found


def residuals(motion):
    """Returns (Residual by Model, Model with the smallest mean square or None)."""
    found = residuals_of(motion)
    return found, min(found, key=lambda model: found[model].mean_square, default=None)


def centred(values, known):
    """Returns the values minus the mean of the known values of the same array row; 0 for unknown values."""
    count = np.maximum(known.sum(axis=1, keepdims=True), 1)
    return (values - (values * known).sum(axis=1, keepdims=True) / count) * known


def residuals_of_kind(motion, kind, delays, position, speed, force, known):
    """Returns a dict from Model to Residual: one Model with the velocity `kind` for each of `delays`. The fits use
    Gram-Schmidt orthogonalization. `position`, `speed`, `force`: centred values, with one array row per delay; 0 where
    `known` is false."""

    def dot(a, b):
        return np.einsum("ij,ij->i", a, b)

    def by(size):
        return np.where(size > 0.0, size, 1.0)

    count, total = known.sum(axis=1), dot(force, force)
    size, length = np.sqrt(dot(position, position)), np.sqrt(dot(speed, speed))
    along = position / by(size)[:, None]
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
    """Returns (q, r, sizes) with matrix = q r diag(sizes) and orthonormal q. Returns None if a column is zero or a
    linear combination of the other columns, or if the matrix has fewer than FEWEST rows."""
    sizes = np.linalg.norm(matrix, axis=0)
    if len(matrix) < FEWEST or not (sizes > 0.0).all():
        return None
    q, r = np.linalg.qr(matrix / sizes)
    return (q, r, sizes) if np.abs(np.diag(r)).min() > COLLINEAR else None


def fit_of(motion, model, with_sign=False):
    """Returns the Fit of a model, or None if factors() of its columns returns None. The motion caches the fits.
    `with_sign`: see Motion.columns()."""
    key = model, with_sign
    if key not in motion.fits:
        motion.fits[key] = new_fit(motion, model, with_sign)
    return motion.fits[key]


def new_fit(motion, model, with_sign):
    """Computes the Fit that fit_of() returns.

    The interval of each coefficient is the larger of two intervals: the least-squares interval with the memory() of the
    residuals, and the interval of a jackknife over consecutive blocks. The jackknife also covers residuals that are
    correlated with the motion."""
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
    """Returns the half-widths of 95 % intervals by the jackknife: each fit omits one of BLOCKS blocks of consecutive
    rows. `q`: orthonormal columns of factors(). `inverse`: inverse of the triangular matrix r of factors().
    """
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
    """Returns the half-width of the 95 % interval of Student's t distribution. `freedom`: degrees of freedom."""
    return float(student.ppf(0.975, freedom))


def memory(residual):
    """Returns the number of rows per independent residual: 1 + 2 times the sum of the autocorrelations, up to the first
    autocorrelation below 0.05."""
    power = float(residual @ residual)
    lags = min(len(residual) // 4, LONGEST_MEMORY)
    if power == 0.0 or lags < 2:
        return 1.0
    # The autocorrelations are the inverse transform of the power spectrum. Padding with zeros prevents the products of
    # the last residuals with the first residuals, which a circular correlation would contain.
    size = next_fast_len(len(residual) + lags, real=True)
    spectrum = np.abs(rfft(residual / np.sqrt(power), size)) ** 2
    correlations = irfft(spectrum, size)[1:lags]
    known = np.append(correlations < 0.05, True).argmax()
    return 1.0 + 2.0 * float(correlations[:known].sum())
