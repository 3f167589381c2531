"""Fits the parameters of a handle to a log by least squares on the simulated position, with 95 % intervals."""
from dataclasses import dataclass, field, replace

import numpy as np
from hapbench_command import fail
from scipy.stats import norm, t

from .model import NAMES, Simulator

MASS, VISCOUS, DRY, DELAY, OFFSET, SPEED = range(len(NAMES))
TWO_SIDED = float(norm.ppf(0.975))
# SCORED: duration of the first part of the log, on which starting values are compared [s]. PIECE, SHORT_PIECE: lengths
# of the pieces of a Cost [s].
SCORED, PIECE, SHORT_PIECE = (
    20.0,
    0.5,
    0.2,
)
KEPT, DISTINCT, BLOCKS = 8, 3, 12
LONGEST = 20.0  # largest delay in the search [samples]
FEWEST_COUNTS = 10.0
MAX_TRAVEL = 0.8  # largest usual travel of a handle [m]
DELAYS = np.arange(0.0, 8.5, 0.5)  # delays of the starting values of the search [samples]
SMOOTHINGS = (0.02, 0.05, 0.1)  # full widths of the smoothing kernel [s]
GRID = [
    (m, c, d) for m in (0.05, 0.2, 0.8) for c in (0.02, 0.2, 0.5) for d in (1.0, 4.0)
]  # mass [kg], dry friction as a fraction of the peak force, delay [samples] of further starting values
# Window lengths over which the residual is averaged to find its slow part [s].
WINDOWS = (0.005, 0.02, 0.05, 0.2)
# Thresholds for the result of slow_part() [standard deviations]: above the first, the intervals are widened; above the
# second, they are not trusted.
WIDENED, DISTRUSTED = 1.5, 4.0
# A non-zero initial speed is fitted if it decreases the sum of squared residuals by more than this factor times the
# mean square residual.
FROM_REST = 12.0


@dataclass
class Fit:
    values: np.ndarray  # values of the parameters, in the order of NAMES
    intervals: np.ndarray  # 95 % intervals, one row [low, high] for each value
    # Measured minus simulated position of each sample [m]; NaN for missing samples.
    residual: np.ndarray
    rms: float  # root mean square of the residual [m]
    # Number of consecutive residuals that count as one independent sample, from memory_of().
    memory: float
    # True if the residual exceeds noise and encoder error: the device has effects that the model lacks.
    misfit: bool
    # True if noise and encoder error explain the residual and its slow part, so that the intervals are 95 % intervals.
    trusted: bool
    # For each parameter that the log does not determine: its name and the reason.
    undetermined: dict = field(default_factory=dict)


class Cost:
    """Residual of a simulation over the first `seconds` of a log. The log is divided into pieces of the length `piece`
    [s]. The mean residual of each piece is subtracted, so that the motion before a piece has no effect on the residuals
    in the piece."""

    def __init__(self, simulate, log, seconds=np.inf, piece=np.inf):
        self.rows = int(min(len(log.time), max(100.0, seconds / log.step)))
        known = np.flatnonzero(np.isfinite(log.position[: self.rows]))
        self.all_known = len(known) == self.rows
        self.known, self._simulate, self._last_parameters = known, simulate, None
        pieces = known // max(8.0, piece / log.step)
        self.starts = np.flatnonzero(np.diff(pieces, prepend=-1.0) > 0.0)
        self.counts = np.diff(self.starts, append=len(known))
        self.measured = self._centred(log.position[known])

    def _centred(self, values):
        if len(self.starts) == 1:
            return values - values.mean()
        return values - np.repeat(np.add.reduceat(values, self.starts) / self.counts, self.counts)

    def simulated(self, parameters):
        """Returns the simulated positions [m]. The latest result is cached, because the derivatives are needed at the
        same parameters as the residual."""
        if not np.array_equal(parameters, self._last_parameters):
            positions = self._simulate(parameters, self.rows)
            self._last_parameters, self._answer = (
                np.array(parameters),
                positions if self.all_known else positions[self.known],
            )
        return self._answer

    def __call__(self, parameters):
        return self.measured - self._centred(self.simulated(parameters))

    def sensitivities(self, x, scale, free, central=False):
        """Returns the derivatives of the simulated positions with respect to the free parameters at `x`, with a row for
        each free parameter and a column for each position. Each row is multiplied by the parameter's entry in `scale`,
        so that its unit is m. `free`: true for each parameter that is free. `central`: true for central differences,
        false for forward differences."""
        h = (1e-4 if central else 1e-6) * scale
        here = None if central else self.simulated(x)
        rows = []
        for i in np.flatnonzero(free):
            above, below = x.copy(), x.copy()
            above[i] += h[i]
            if central:
                below[i] = (
                    max(x[i] - h[i], 0.0) if i in (MASS, VISCOUS, DRY, DELAY) else x[i] - h[i]
                )
            before = self.simulated(below) if central else here
            rows.append(
                self._centred(self.simulated(above) - before) * (scale[i] / (above[i] - below[i]))
            )
        return np.array(rows)


@dataclass
class Found:
    x: np.ndarray
    squares: float  # sum of squared residuals


def least_squares(cost, start, scale, steps, tolerance, held=()):
    """Minimises the sum of squares by the Levenberg-Marquardt method. The mass stays positive; friction and delay stay
    non-negative. SciPy's bounded solver decomposes the whole Jacobian. It finds the same minimum but takes 1.3 times as
    long for a log of 60 s at 4 kHz."""
    low = np.array([1e-6, 0.0, 0.0, 0.0, -np.inf, -np.inf])
    high = np.array([1e6, np.inf, np.inf, LONGEST * scale[DELAY], np.inf, np.inf])
    x = np.clip(start, low, high)
    residual = cost(x)
    squares, damping = residual @ residual, 1e-3
    for _ in range(steps):
        units = _units(scale, x)
        free = np.ones(len(x), bool)
        free[list(held)] = False
        J = cost.sensitivities(x, units, free)
        gradient = np.zeros(len(x))
        gradient[free] = J @ residual
        moves = ~(((x <= low) & (gradient < 0.0)) | ((x >= high) & (gradient > 0.0)))[free]
        J, free = J[moves], np.flatnonzero(free)[moves]
        H, g = J @ J.T, gradient[free]
        # The lower bound limits the steps of parameters with little effect, such as the initial speed of a handle that
        # does not move.
        weight = np.maximum(np.diag(H), 1e-9 * np.trace(H) + 1e-300)
        before = squares
        for _ in range(12):
            trial = x.copy()
            trial[free] += units[free] * np.clip(
                np.linalg.solve(H + damping * np.diag(weight), g), -1.0, 1.0
            )
            trial = np.clip(trial, low, high)
            trial[MASS] = max(trial[MASS], 0.2 * x[MASS])
            missed = cost(trial)
            if (there := missed @ missed) < squares:
                x, residual, squares, damping = trial, missed, there, max(0.1 * damping, 1e-12)
                break
            damping = max(8.0 * damping, 1e-6)
        if before - squares <= tolerance * before:
            break
    return Found(x, float(squares))


def fit(log):
    """Returns the Fit of the handle's parameters. With the fitted parameters, the simulated positions are closest to
    the logged positions, in the sense of least squares."""
    with Simulator(log.time, log.force) as simulate:
        return _fit(log, simulate)


def _fit(log, simulate):
    log = without_unknown_start(log)
    known = np.isfinite(log.position)
    position = np.interp(np.arange(len(log.time)), np.flatnonzero(known), log.position[known])
    noise, travel = noise_of(log.position[known]), np.ptp(position)
    count = max(log.encoder_step, 1e-9 * travel)
    if travel < FEWEST_COUNTS * max(count, noise):
        if travel > MAX_TRAVEL:
            fail(
                f"the position has a range of {travel:.3g} m and {travel / count:.3g} steps of {count:.3g} m, which is "
                "no position of a handle. Are the columns of force and position exchanged (--columns "
                "force=NAME,position=NAME), or is the position in other units (--scale position=0.001 is for "
                "millimetres)?"
            )
        fail(
            f"the handle hardly moves: its range is {travel:.3g} m, {travel / count:.3g} encoder steps, with "
            f"noise of {noise:.3g} m, so that nothing can be identified. Use a larger force, or "
            "change it more slowly"
        )
    peak = float(np.abs(log.force).max())
    lag = max(1, round(0.01 / log.step))
    fast = max(float(np.abs(position[lag:] - position[:-lag]).max()) / (lag * log.step), 1e-9)
    scale = np.array([0.1, peak / fast, peak, log.step, peak, fast])
    whole = Cost(simulate, log)
    found = _search(Cost(simulate, log, SCORED, PIECE), whole, log, position, scale)
    samples = len(whole.known)
    resting = least_squares(
        whole,
        np.where(np.arange(len(NAMES)) == SPEED, 0.0, found.x),
        scale,
        60,
        1e-8,
        held=(SPEED,),
    )
    if resting.squares <= found.squares * (1.0 + FROM_REST / samples):
        found = resting
    misfit = found.squares / samples > 2.0 * (noise**2 + log.encoder_step**2 / 12.0)
    # The forces of missing rows are interpolated, and their errors persist in the simulated motion.
    by_pieces = misfit or not log.knows_forces
    if by_pieces:
        found, spread = _by_pieces(Cost(simulate, log, piece=SHORT_PIECE), found, scale)
    residual = whole(found.x)
    memory = memory_of(residual)
    slow = slow_part(log, whole, found.x, residual)
    intervals, undetermined, seen = _intervals(
        whole, log, found, scale, residual, memory, noise, spread if by_pieces else None
    )
    if slow > WIDENED and not by_pieces:
        wide = without_blocks(whole, found, scale)
        intervals[:, 0] = np.minimum(intervals[:, 0], found.x - wide)
        intervals[:, 1] = np.maximum(intervals[:, 1], found.x + wide)
    undetermined = _wide_intervals(intervals, found.x, log.step, peak, fast) | undetermined
    intervals[:OFFSET, 0] = np.maximum(intervals[:OFFSET, 0], 0.0)
    filled = np.full(len(log.time), np.nan)
    filled[whole.known] = residual
    return Fit(
        found.x,
        intervals,
        filled,
        float(np.sqrt(np.mean(residual**2))),
        memory,
        misfit,
        not misfit and slow <= DISTRUSTED,
        {NAMES[i]: f"{why} ({seen})" for i, why in sorted(undetermined.items()) if i != SPEED},
    )


def _wide_intervals(intervals, x, step, peak, fast):
    """Returns a dict with an entry for each parameter whose interval is too wide to report a value. Key: index of the
    parameter. Value: reason. `peak`: largest force [N]. `fast`: largest speed [m/s]."""
    half = 0.5 * np.diff(intervals)[:, 0]
    return {
        i: f"its interval is wider than +- {limit}"
        for i, largest, limit in (
            (MASS, 0.25 * x[MASS], "25 % of the value"),
            (DELAY, 2.0 * step, "2 samples"),
            (DRY, 0.1 * peak, "10 % of the largest force"),
            (VISCOUS, 0.1 * peak / fast, "10 % of the largest force at full speed"),
        )
        if not half[i] <= largest
    }


def _search(first, whole, log, position, scale):
    """Returns the result of least_squares() with the smallest sum of squares on the `whole` log. The `first` part of
    the log selects the starting values."""
    starts = starts_of(log, position[: first.rows], log.force[: first.rows])
    scores = [np.sum(first(start) ** 2) for start in starts]
    tried = [least_squares(first, starts[i], scale, 15, 1e-4) for i in np.argsort(scores)[:KEPT]]
    distinct = []
    for one in sorted(tried, key=lambda one: one.squares):
        if all(_differs(one.x, other.x, scale) for other in distinct):
            distinct.append(one)
    found = min(_refined(whole, distinct[:DISTINCT], scale), key=lambda one: one.squares)
    # Searches again from two more starts: the parameters of this minimum, but without offset and with half or twice the
    # dry friction. A result is refined on the whole log only if its sum of squares may be smaller.
    again = np.array([found.x, found.x])
    again[:, OFFSET], again[:, DRY] = 0.0, found.x[DRY] * np.array([0.5, 2.0])
    reached = np.sum(first(found.x) ** 2)
    others = [
        one
        for one in (least_squares(first, start, scale, 15, 1e-4) for start in again)
        if one.squares < 1.5 * reached and _differs(one.x, found.x, scale)
    ]
    return min([found, *_refined(whole, others, scale)], key=lambda one: one.squares)


def _intervals(cost, log, found, scale, residual, memory, noise, spread):
    """Returns (intervals, dict from the index of each undetermined parameter to the reason, text about the Strokes of
    the handle). `spread`: half-widths of the intervals if they are known, otherwise None."""
    units = _units(scale, found.x)
    positions = cost.simulated(found.x)
    J = np.vstack(
        [
            cost.sensitivities(found.x, units, np.ones(len(NAMES), bool), central=True),
            np.ones(len(residual)),
        ]
    )
    if found.x[SPEED] == 0.0:
        J[SPEED] = 0.0
    strokes = Strokes(positions, 3.0 * max(log.encoder_step, noise))
    undetermined = _degenerate(J, strokes)
    rms = np.sqrt(np.mean(residual**2))
    by_samples, by_dwells = (units * one for one in _spreads(J, positions, log.encoder_step, rms))
    errors = np.maximum(by_dwells, by_samples * np.sqrt(memory))
    profiled = (
        [i for i in (DRY, OFFSET) if strokes.unidirectional and i not in undetermined]
        if spread is None
        else []
    )
    spread = TWO_SIDED * errors if spread is None else spread
    intervals = found.x[:, None] + spread[:, None] * np.array([-1.0, 1.0])
    for i in profiled:
        intervals[i] = profile(
            cost, found, scale, i, errors[i], (rms * errors[i] / by_samples[i]) ** 2
        )
    return intervals, undetermined, strokes.text(log.encoder_step)


def _refined(cost, tried, scale):
    return [least_squares(cost, one.x, scale, 60, 1e-8) for one in tried]


def _differs(x, other, scale):
    return bool(np.any(np.abs(x - other)[:SPEED] > 0.01 * _units(scale, other)[:SPEED]))


def _units(scale, x):
    units = scale.copy()
    units[MASS] = x[MASS]
    return units


class Strokes:
    """Motions of the handle in one direction. If the handle moves in one direction only, dry friction cannot be
    distinguished from a constant force."""

    def __init__(self, positions, threshold):
        steps = np.diff(positions)
        moves = steps[steps != 0.0]
        turns = np.flatnonzero(np.diff(np.sign(moves)) != 0.0) + 1
        strokes = (
            np.add.reduceat(moves, np.concatenate([[0], turns])) if len(moves) else np.zeros(0)
        )
        self.rest = 1.0 - len(moves) / max(1, len(steps))
        self.up, self.down = int(np.sum(strokes > threshold)), int(np.sum(strokes < -threshold))
        self.travel = float(np.ptp(positions))
        self.unidirectional = not (self.up and self.down)

    def text(self, encoder_step):
        counts = (
            f"{self.travel / encoder_step:.0f} encoder steps"
            if encoder_step
            else f"{self.travel:.3g} m"
        )
        return (
            f"at rest for {100.0 * self.rest:.0f} % of the log, {self.up} strokes in one direction and "
            f"{self.down} in the other, travel {counts}"
        )


def _degenerate(J, strokes):
    """Returns a dict with an entry for each parameter that has no effect on the positions, and for each parameter whose
    change other parameters can compensate. Key: index of the parameter. Value: reason."""
    sizes = np.sqrt(np.mean(J**2, axis=1))
    felt = np.flatnonzero(sizes > 1e-12 * sizes.max())
    undetermined = {
        i: "it has no effect on the positions" for i in range(len(NAMES)) if i not in felt
    }
    unit = J[felt] / sizes[felt, None]
    values, vectors = np.linalg.eigh(unit @ unit.T / J.shape[1])
    for vector in vectors.T[values < 1e-8]:
        for i in felt[np.abs(vector) > 0.1]:
            undetermined[int(i)] = "other parameters have the same effect"
    if values[0] < 1e-5 and strokes.unidirectional:
        undetermined |= {
            DRY: "the handle moved in one direction only",
            OFFSET: "the handle moved in one direction only",
        }
    undetermined.pop(len(NAMES), None)  # the initial position is not a parameter of the result
    return undetermined


def _spreads(J, positions, encoder_step, rms):
    """Returns two arrays of standard errors, with an entry for each parameter. `J`: result of sensitivities(), and a
    last row of ones for the initial position, which has no entry in the arrays. Each entry is in units of the `scale`
    of its row. The first array treats all residuals as independent samples. The second array treats a residual as the
    sum of noise and encoder error. The noise is independent in each sample. The encoder error is constant while the
    handle stays within one encoder step, so that all samples of this time count as one sample."""
    H = J @ J.T
    inverse = np.linalg.pinv(H, rcond=1e-14, hermitian=True)
    of_encoder = 0.0
    if encoder_step:
        beyond, h = max(rms**2 - encoder_step**2 / 12.0, 0.0), np.arange(1, 30)
        waves = (
            encoder_step**2
            / (2.0 * np.pi**2 * h**2)
            * np.exp(-4.0 * np.pi**2 * h**2 * beyond / encoder_step**2)
        )
        of_encoder = min(rms**2, float(waves.sum()))
    middle = (rms**2 - of_encoder) * H
    if of_encoder:
        first, begins = np.inf, []
        for k, position in enumerate(positions.tolist()):
            if abs(position - first) > encoder_step:
                first = position
                begins.append(k)
        sums = np.add.reduceat(J, begins, axis=1)
        middle = middle + of_encoder * sums @ sums.T
    felt = np.any(J[:-1] != 0.0, axis=1)
    return [
        np.where(felt, np.sqrt(np.maximum(np.diag(one)[:-1], 0.0)), np.inf)
        for one in (rms**2 * inverse, inverse @ middle @ inverse)
    ]


def _by_pieces(cost, found, scale):
    """Returns (fit, half-widths of the intervals) for a log with a misfit or with interpolated forces. `cost`: Cost
    with short pieces."""
    found = least_squares(cost, found.x, scale, 60, 1e-8)
    return found, without_blocks(cost, found, scale)


def without_blocks(cost, found, scale):
    """Returns the half-widths of the 95 % intervals by a jackknife: each fit omits one of BLOCKS blocks of the log. The
    jackknife assumes only that the residuals of all blocks have the same statistics."""
    units = _units(scale, found.x)
    J, residual = cost.sensitivities(found.x, units, np.ones(len(NAMES), bool), central=True), cost(
        found.x
    )
    parts = np.array_split(np.arange(J.shape[1]), BLOCKS)
    H, g = J @ J.T, J @ residual
    without = np.array(
        [
            np.linalg.pinv(H - J[:, part] @ J[:, part].T, rcond=1e-14, hermitian=True)
            @ (g - J[:, part] @ residual[part])
            for part in parts
        ]
    )
    spread = units * np.sqrt((BLOCKS - 1.0) * np.var(without, axis=0))
    return float(t.ppf(0.975, BLOCKS - 1)) * spread


def slow_part(log, cost, x, residual):
    """Returns by how much the mean square of the slow part of the residual exceeds the mean square that noise and
    encoder alone would cause, in standard deviations of this mean square; at least 0. The slow part is the mean of the
    residual over windows. The result is the largest excess over the window lengths WINDOWS. Simulated logs with the
    measured noise give the expected mean square and its standard deviation."""
    positions = cost.simulated(x)
    positions = positions + np.mean(log.position[cost.known] - positions)
    random = np.random.default_rng(1)

    def measured(noise):
        noisy = positions + noise * random.standard_normal(len(positions))
        return np.round(noisy / log.encoder_step) * log.encoder_step if log.encoder_step else noisy

    sharp = noise_of(log.position[cost.known])
    noise = np.sqrt(max(sharp**2 - noise_of(measured(0.0)) ** 2, 0.0))
    alone = [measured(noise) - positions for _ in range(8)]
    threshold = 1e-4 * (sharp**2 + log.encoder_step**2)
    beyond = 0.0
    for window in WINDOWS:
        rows = max(2, round(window / log.step))
        starts = np.arange(0, len(positions) - rows + 1, rows)
        if len(starts) < 10:
            continue
        parts = [
            np.mean((np.add.reduceat(one - one.mean(), starts)[:-1] / rows) ** 2) + threshold
            for one in (residual, *alone)
        ]
        expected = np.mean(parts[1:])
        deviation = max(np.sqrt(2.0 / len(starts)), np.std(parts[1:]) / expected)
        beyond = max(beyond, (parts[0] / expected - 1.0) / deviation)
    return float(beyond)


def without_unknown_start(log):
    """If the handle moves at the start of the log and the log has at least 20 LONGEST samples, returns the log with NaN
    as its first LONGEST positions. Delayed forces from before the log, which are unknown, still act on the handle at
    these samples. The fitted initial speed accounts for these forces. Otherwise returns the log unchanged.
    """
    speed = first_speed(log.position[np.isfinite(log.position)][:200], log.step, log.encoder_step)
    if speed == 0.0 or len(log.time) < 20.0 * LONGEST:
        return log
    position = log.position.copy()
    position[: int(LONGEST)] = np.nan
    return replace(log, position=position)


def memory_of(residual):
    """Returns the number of consecutive residuals that count as one independent sample: 1 + 2 times the sum of the
    autocorrelations before the first autocorrelation below 0.05."""
    centred = residual - residual.mean()
    power = np.abs(np.fft.rfft(centred, 1 << (2 * len(centred) - 1).bit_length())) ** 2
    correlation = np.fft.irfft(power)[: len(centred)]
    if correlation[0] <= 0.0:
        return 1.0
    correlation /= correlation[0]
    return float(1.0 + 2.0 * np.sum(correlation[1 : max(1, int(np.argmax(correlation < 0.05)))]))


def profile(cost, found, scale, i, spread, variance):
    """Returns the two ends of the 95 % interval of the parameter `i`. At each end, the sum of squares, minimised over
    all other parameters, exceeds its minimum by the amount that corresponds to 95 %."""
    best, ends = found.x[i], []
    for side in (-1.0, 1.0):
        at = best + side * TWO_SIDED * min(spread, scale[i])
        for _ in range(4):
            at = max(at, 0.0) if i == DRY else at
            if at == best:
                break
            start = found.x.copy()
            start[i] = at
            growth = np.sqrt(
                max(
                    (least_squares(cost, start, scale, 8, 1e-6, held=(i,)).squares - found.squares)
                    / variance,
                    1e-6,
                )
            )
            if (at == 0.0 and i == DRY and growth <= TWO_SIDED) or abs(growth - TWO_SIDED) < 0.05:
                break
            at = best + (at - best) * min(TWO_SIDED / growth, 4.0)
        ends.append(at)
    return ends


# The following functions compute starting values. The sum of squares over a long log has many local minima, so that the
# search starts from several different values.


def noise_of(position):
    """Returns the standard deviation of the white noise in the position [m]. Third differences of white noise have 20
    times its variance."""
    return float(np.sqrt(np.mean(np.diff(position, 3) ** 2) / 20.0)) if len(position) > 3 else 0.0


def kernel(rows):
    """Returns a bell-shaped kernel of about `rows` rows: four boxes of a quarter of this width, convolved."""
    box = np.ones(max(1, round(rows / 4)))
    bell = np.convolve(np.convolve(box, box), np.convolve(box, box))
    return bell / bell.sum()


def starts_of(log, position, force):
    """Returns starting values (in the order of NAMES) from a grid, and from regressions of the force on acceleration,
    speed and direction of motion. A kernel filters all these quantities. `position`: positions at all times, without
    NaN. `force`: forces at the same times."""
    step, peak, noise = log.step, float(np.abs(force).max()), noise_of(position)
    speed = first_speed(position, step, log.encoder_step)
    found = []
    for smoothing in SMOOTHINGS:
        bell = kernel(smoothing / step)
        if len(bell) + 30 > len(position):
            continue
        for mass, viscous, dry, delay, offset in _regressions(bell, position, force, step, noise):
            found += [(mass, viscous, share * dry, delay, offset) for share in (1.0, 0.5, 2.0)]
    found += [(m, 0.3, c * peak, d, 0.0) for m, c, d in GRID]
    starts = np.zeros((len(found), len(NAMES)))
    starts[:, :5], starts[:, 5] = found, speed
    starts[:, 2] = np.clip(starts[:, 2], 0.01 * peak, 0.95 * peak)
    starts[:, 3] *= step
    return starts


def _regressions(bell, position, force, step, noise):
    """Returns a list of (mass, viscous friction, dry friction, delay [samples], offset) for the two best delays, which
    differ by at least one sample. `bell`: kernel of the filter."""
    middle = slice(1, -1)
    slope = (position[2:] - position[:-2]) / (2.0 * step)
    speed = np.convolve(slope, bell, "valid")
    acceleration = np.convolve(np.diff(position, 2) / step**2, bell, "valid")
    held = np.concatenate(
        [[0.0], 0.5 * (force[1:] + force[:-1])]
    )  # mean force of two samples, which determines the second difference of the positions
    # Assumes that the force is zero before the log.
    push = np.concatenate([np.zeros(9), held[middle]])
    push = np.convolve(push, bell, "valid")  # push[k + 9] belongs to speed[k]
    threshold = 4.0 * noise * np.sqrt(np.sum(np.convolve(bell, [0.5, 0.0, -0.5]) ** 2)) / step
    direction = np.where(np.abs(speed) > threshold, np.sign(speed), 0.0)
    # If the handle moves in one direction over the whole kernel, the smoothed dry friction equals the dry friction.
    half = len(bell) // 2
    sums = np.cumsum(np.concatenate([np.zeros(half + 1), direction, np.zeros(half)]))
    unidirectional = np.abs(sums[2 * half + 1 :] - sums[: -2 * half - 1]) == 2 * half + 1
    rows = np.flatnonzero(unidirectional)
    if len(rows) < 40:
        rows = np.flatnonzero(direction)
    if len(rows) < 10:
        return []
    known = np.column_stack([acceleration, speed, direction, -np.ones_like(direction)])[rows]
    delayed = np.stack(
        [
            np.where(
                d % 1.0 == 0.0,
                push[rows + 9 - int(d)],
                0.5 * (push[rows + 9 - int(d)] + push[rows + 8 - int(d)]),
            )
            for d in DELAYS
        ],
        axis=1,
    )
    size = np.maximum(np.abs(known).max(axis=0), 1e-300)
    terms = np.linalg.lstsq(known / size, delayed, rcond=1e-10)[0]
    wrong = terms[1] < 0.0
    without = [0, 2, 3]
    terms[:, wrong] = 0.0
    terms[np.ix_(without, wrong)] = np.linalg.lstsq(
        (known / size)[:, without], delayed[:, wrong], rcond=1e-10
    )[0]
    misses = np.sum((delayed - known / size @ terms) ** 2, axis=0)
    terms /= size[:, None]
    order = [i for i in np.argsort(misses) if terms[0, i] > 0.0]
    best = order[:1] + [i for i in order if abs(DELAYS[i] - DELAYS[order[0]]) >= 1.0][:1]
    return [(terms[0, i], terms[1, i], max(terms[2, i], 0.0), DELAYS[i], terms[3, i]) for i in best]


def first_speed(position, step, encoder_step):
    """Returns the speed at the first sample [m/s], from a parabola through the first 0.01 s; 0 if the speed is not
    significant."""
    rows = min(len(position), max(8, round(0.01 / step)))
    powers = np.vander(step * np.arange(rows), 3, increasing=True)
    terms, *_ = np.linalg.lstsq(powers, position[:rows], rcond=None)
    spread = np.std(position[:rows] - powers @ terms) + encoder_step / np.sqrt(12.0)
    return (
        float(terms[1])
        if abs(terms[1]) > 4.0 * spread * np.sqrt(np.linalg.inv(powers.T @ powers)[1, 1])
        else 0.0
    )
