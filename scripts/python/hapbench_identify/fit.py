"""Least squares on the simulated position, with intervals of 95 %."""
from dataclasses import dataclass

import numpy as np
from hapbench_import.faults import fail
from scipy import signal
from scipy.optimize import least_squares, lsq_linear
from scipy.stats import norm

from .model import NAMES, positions

TWO_SIDED = float(norm.ppf(0.975))
DELAY, LONGEST = NAMES.index("delay_s"), 20.0  # the longest delay looked for [samples]


@dataclass
class Fit:
    values: np.ndarray     # of NAMES
    intervals: np.ndarray  # 95 %, a row [low, high] each
    residual: np.ndarray   # measured less simulated position of each sample [m]; NaN where it is missing
    memory: float          # how many samples of the residual count as one, from its autocorrelation

    @property
    def rms(self):
        return float(np.sqrt(np.nanmean(self.residual**2)))


def fit(log):
    """The parameters that bring the simulated position closest to the log's, from the best of several regressions on. The
    delay is a parameter like the others, because forces may arrive between samples."""
    known = np.isfinite(log.position)
    unit = max(log.encoder_step, 1e-9 * np.ptp(log.position[known]))

    def misses_until(end):
        seen = known[:end]
        return lambda parameters: (positions(log.time[:end], log.force[:end], parameters)[seen] - log.position[:end][seen]) / unit

    # A wrong parameter lets the simulated handle drift away, and over a long log the sum of squares has many minima: first the
    # part with a tenth of the way, then more.
    way = np.cumsum(np.abs(np.diff(log.position[known])))
    samples = np.flatnonzero(known)
    ends = [max(100, int(samples[np.searchsorted(way, share * way[-1])]) + 1) for share in (0.1, 0.3)] + [len(known)]
    starts = starts_of(log)
    if not starts:
        fail("the handle hardly moves: nothing to identify")
    least = np.array([1e-3, 1e-3, 1e-3, 0.1 * log.step, 1e-3, unit, unit / log.step])
    cost = misses_until(ends[0])
    tried = [solve(cost, values, np.maximum(np.abs(values), least), log.step, trials=10)
             for values in sorted(starts, key=lambda values: np.sum(cost(values)**2))[:4]]
    found = min(tried, key=lambda one: one.cost)
    for end in ends[1:]:
        misses, scale = misses_until(end), np.maximum(np.abs(found.x), least)
        found = solve(misses, found.x, scale, log.step)
    memory = memory_of(found.fun)
    # Steps of an encoder are no random noise: without any, half a step counts as a deviation, not 1 / sqrt(12) of one.
    steps = (0.25 - 1.0 / 12.0) * (log.encoder_step / unit)**2
    variance = memory * (2.0 * found.cost / max(1, len(found.fun) - len(NAMES)) + steps)
    # A parameter that moves nothing, such as viscous friction of a handle that sticks, has an infinite interval.
    sensitivity = found.jac * scale
    values, vectors = np.linalg.eigh(sensitivity.T @ sensitivity)
    with np.errstate(divide="ignore"):
        spread = scale * np.sqrt(variance * (vectors**2 @ (1.0 / np.maximum(values, 0.0))))
    intervals = found.x[:, None] + TWO_SIDED * spread[:, None] * np.array([-1.0, 1.0])
    intervals[DELAY] = profile(misses, found, scale, log.step, spread[DELAY], variance)
    intervals[:4, 0] = np.maximum(intervals[:4, 0], 0.0)
    residual = np.full(len(log.time), np.nan)
    residual[known] = -unit * found.fun
    return Fit(found.x, intervals, residual, memory)


def solve(misses, start, scale, step, fixed_delay=None, trials=25):
    """Least squares in units of `scale`; the delay may be held."""
    free = np.arange(len(start)) != (DELAY if fixed_delay is not None else -1)
    low = np.array([1e-6, 0.0, 0.0, 0.0, -np.inf, -np.inf, -np.inf])
    high = np.array([np.inf, np.inf, np.inf, LONGEST * step, np.inf, np.inf, np.inf])
    whole = np.clip(start, low, high)
    if fixed_delay is not None:
        whole[DELAY] = fixed_delay

    def with_free(x):
        values = whole.copy()
        values[free] = x * scale[free]
        return values

    limits = (low / scale)[free], (high / scale)[free]
    inside = np.clip((whole / scale)[free], limits[0] + 1e-9, limits[1])
    found = least_squares(lambda x: misses(with_free(x)), inside, bounds=limits, x_scale="jac", max_nfev=trials, xtol=1e-9,
                          ftol=1e-9, gtol=1e-9)
    found.x = with_free(found.x)
    found.jac = found.jac / scale[free]
    return found


def starts_of(log):
    """Parameters by linear regression of the force on acceleration, speed and direction of motion, all of them through the same
    smoothing, for several smoothings and delays. Unlike the simulated position it has a single minimum."""
    known = np.isfinite(log.position)
    time = np.arange(log.time[0], log.time[-1], log.step)  # smoothing wants an even clock
    place = np.interp(time, log.time[known], log.position[known])
    found = []
    for window in sorted({max(5, min(n, len(time) // 10) | 1) for n in (9, 21, 41, 81)}):
        acceleration, speed = (signal.savgol_filter(place, window, 2, deriv=n, delta=log.step) for n in (2, 1))
        slow = max(log.encoder_step / (window * log.step), 0.05 * np.abs(speed).max())
        moving = np.abs(speed) > slow  # where it may stick, friction has any direction
        if np.count_nonzero(moving) < 10:
            continue
        rows = np.column_stack([acceleration, speed, np.sign(speed), -np.ones_like(speed)])[moving]
        size = np.maximum(np.abs(rows).max(axis=0), 1e-300)
        for delay in (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0):
            which = np.searchsorted(log.time, time - delay * log.step, side="right") - 1
            held = np.where(which < 0, 0.0, log.force[which])
            pushes = signal.savgol_filter(held, window, 2)[moving]
            mass, viscous, dry, offset = lsq_linear(rows / size, pushes, ([1e-6, 0.0, 0.0, -np.inf], np.full(4, np.inf))).x / size
            found.append(np.array([mass, viscous, dry, delay * log.step, offset, place[0], 0.0]))
    return found


def memory_of(residual):
    """1 + 2 times the sum of the autocorrelations up to the first that is negative: as many samples count as one."""
    centred = residual - residual.mean()
    power = np.abs(np.fft.rfft(centred, 2 * len(centred)))**2
    correlation = np.fft.irfft(power)[:len(centred)]
    if correlation[0] <= 0.0:
        return 1.0
    negative = np.flatnonzero(correlation < 0.0)
    return float(1.0 + 2.0 * np.sum(correlation[1:negative[0] if len(negative) else None]) / correlation[0])


def profile(misses, found, scale, step, spread, variance):
    """Where the sum of squares, with the best other parameters for each delay, has grown by that of 95 %."""
    best, ends = found.x[DELAY], []
    for side in (-1.0, 1.0):
        at = best + side * TWO_SIDED * min(spread, LONGEST * step)
        for _ in range(2):
            at = min(max(at, 0.0), LONGEST * step)
            if at == best:
                break
            other = solve(misses, found.x, scale, step, at, trials=8)
            growth = np.sqrt(max(2.0 * (other.cost - found.cost) / variance, 1e-6))
            if (at == 0.0 or at == LONGEST * step) and growth <= TWO_SIDED:
                break  # the bound itself is not excluded
            at = best + (at - best) * min(TWO_SIDED / growth, 4.0)
        ends.append(min(max(at, 0.0), LONGEST * step))
    return ends
