"""Models of a contact's force, and their least-squares fits. A model is a spring and a damper at the position `delay`
rows earlier. Models differ in the way in which the engine may compute the velocity."""
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter
from scipy.stats import t as student

MOST_DELAY = 50  # largest delay [rows]
FEWEST = 10  # smallest number of rows of a fit
JITTER = 1e-3  # jitter relative to the interval; below it, both clocks give the same velocities
LONGEST_MEMORY = 1000  # largest correlation length of a residual [rows]
LOW_PASSES = (1, 2, 4, 8, 16)  # time constants of a filtered velocity [rows]
LOW_PASS = "low-pass "  # prefix of the kinds of filtered velocity
EVEN = "even "  # prefix of the kinds that assume a clock without jitter
BEFORE = MOST_DELAY + 10 * max(LOW_PASSES)  # rows after which the start of a filter has no effect
BLOCKS = 10  # number of blocks of the jackknife
# Smallest fraction of a column's norm that the other columns must leave unexplained.
COLLINEAR = 1e-9


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
        self.place = log.position[part] @ direction
        self.speeds = speeds(log, part, self.place, direction)
        self.force = log.force[rows] @ direction
        self.rows = rows - self.first
        self.most = min(MOST_DELAY, max(int(self.rows[-1]) - FEWEST, 0))
        self.interval = log.interval * (1.0 if log.held is None else log.held.rows)
        self.resolution = float(np.abs(direction) @ log.quantum_m)
        within = slice(int(self.rows[0]), int(self.rows[-1]) + 1)
        self.sampling = {
            kind: self.sampling_of(kind.removeprefix(EVEN), within) for kind in self.speeds
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

    def rounding(self, model, stiffness, damping):
        """Returns the mean square of the force error that the resolution of the position causes in a model [N^2]."""
        of_speed = damping / self.interval
        kind = model.kind.removeprefix(EVEN)
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

    def models(self):
        """Returns all models. There is a forward difference only for an implicit step: with a delay, a forward
        difference would equal a backward difference with one row less delay."""
        return [
            Model(delay, kind)
            for kind in self.speeds
            for delay in range(1 if kind.endswith("forward") else self.most + 1)
        ]

    def usable(self):
        """Returns True for rows whose delayed row exists in every model. The first velocity has no row before it."""
        return self.rows > self.most

    def columns(self, model, with_sign=False):
        """Returns the centred columns and the force of the rows that every model explains."""
        keep = self.usable()
        before = self.rows[keep] - model.delay
        x, v, f = self.place[before], self.speeds[model.kind][before], self.force[keep]
        columns = [x - x.mean(), v - v.mean()]
        if with_sign:
            moving = np.sign(np.where(np.abs(v) > 1e-3 * np.abs(v).max(), v, 0.0))
            columns.append(moving - moving.mean())
        return np.column_stack(columns), f - f.mean()


def low_pass_of(kind):
    """Returns the time constant of a low-pass filtered backward difference [rows]; 0 if it is not filtered."""
    kind = kind.removeprefix(EVEN)
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
    even = np.diff(fresh) * log.interval
    if np.std(steps - even) > JITTER * log.interval:
        # The engine may assume a constant step, even if the clock of the log has jitter.
        found |= differences(np.diff(place[fresh]) / even, sample, EVEN)
    return found


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
    """Returns the models whose velocity differs by one approximation step. The engine's velocity may lie between
    `model` and these neighbours."""
    clock = EVEN if model.kind.startswith(EVEN) else ""
    kind = model.kind.removeprefix(EVEN)
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
    rounding: float  # mean square error that the resolution of the position may cause
    sampling: float  # mean square error that the sampling of the velocity may cause
    total: float  # variance of the force: mean square of the difference from its mean


def residual_of(motion, model):
    """Returns the Residual of a model; None if its columns are collinear."""
    keep = motion.usable()
    before, force = motion.rows[keep] - model.delay, motion.force[keep]
    if len(before) < FEWEST:
        return None
    rest = force - force.mean()
    total = rest @ rest
    basis_so_far, slopes, sizes, shared = [], [], [], 0.0
    for values in (motion.place, motion.speeds[model.kind]):
        column = values[before]
        column -= column.mean()
        size = np.sqrt(column @ column)
        for direction in basis_so_far:
            shared = column @ direction
            column -= shared * direction
        independent = np.sqrt(column @ column)
        if not independent > COLLINEAR * size:
            return None
        basis_so_far.append(column / independent)
        slopes.append(rest @ basis_so_far[-1])
        sizes.append(independent)
        rest -= slopes[-1] * basis_so_far[-1]
    damping = -slopes[1] / sizes[1]
    stiffness = (-slopes[0] - damping * shared) / sizes[0]
    rows = len(before)
    sampling = damping**2 * motion.sampling[model.kind]
    return Residual(
        float(rest @ rest) / rows,
        float(motion.rounding(model, stiffness, damping)),
        float(sampling),
        float(total) / rows,
    )


def factors(matrix):
    """Returns (q, r, sizes) with matrix = q r diag(sizes) and orthonormal q; None if a column is constant or a linear
    combination of the others."""
    sizes = np.linalg.norm(matrix, axis=0)
    if len(matrix) < FEWEST or not (sizes > 0.0).all():
        return None
    q, r = np.linalg.qr(matrix / sizes)
    return (q, r, sizes) if np.abs(np.diag(r)).min() > COLLINEAR else None


def fit_of(motion, model, with_sign=False):
    """Returns the Fit of a model; None if its columns are collinear.

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
    changes = []
    for block in np.array_split(np.arange(len(residual)), count):
        part = q[block]
        kept = np.eye(q.shape[1]) - part.T @ part
        changes.append(inverse @ np.linalg.lstsq(kept, part.T @ residual[block], rcond=1e-9)[0])
    changes = np.array(changes) - np.mean(changes, axis=0)
    return student.ppf(0.975, count - 1) * np.sqrt(
        (count - 1) / count * np.sum(changes**2, axis=0)
    )


def memory(residual):
    """Returns the number of rows for one independent residual: 1 + 2 times the sum of the autocorrelations up to the
    first below 0.05."""
    power, total = float(residual @ residual), 1.0
    if power == 0.0:
        return 1.0
    for lag in range(1, min(len(residual) // 4, LONGEST_MEMORY)):
        correlation = float(residual[lag:] @ residual[:-lag]) / power
        if correlation < 0.05:
            break
        total += 2.0 * correlation
    return total
