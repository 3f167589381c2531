"""What scenes share: filters and phases of a run, linear recurrences, and the classes of their motion."""
import math

import numpy as np
from scipy import linalg, signal

from answers import Within, norms

PLAIN = {"stiffness_N_per_m": 1000, "damping_ratio": 0, "mass_kg": 0.1, "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0}}
SUMMED = {**PLAIN, "algorithm": "summation"}
SPRING = {"type": "springs", "groups": [{"direction": [1, 0, 0], "count": 1}]}
BELOW = {"type": "springs", "groups": [{"direction": [0, 0, -1], "count": 1}]}
STEPPED = Within("velocities are differences of positions, known to 1e-17 m, over steps of 0.5 ms", relative=1e-11, absolute=1e-15)
FILTERED = Within("scipy's second-order sections are ours in another order: rounding times the filter's memory of some hundred rows",
                  relative=1e-9, absolute=1e-15)
BINNED = Within("a bin of the histogram of squares is a 32nd of a factor of two: half of sqrt(33/32) - 1", relative=0.0078)


def high_pass(x, dt):
    """Butterworth's of fourth order at 30 Hz, at rest at the first sample before it."""
    sections = signal.butter(4, 30.0, "high", fs=1 / dt, output="sos")
    return signal.sosfilt(sections, x, axis=0, zi=signal.sosfilt_zi(sections)[:, :, None] * x[0][None, None, :])[0]


class Phases:
    """Rows of landings and of settled contact, by their definition."""

    def __init__(self, contact, dt, settling=0.05):
        rows = round(settling / dt)
        away, end, self.landings = rows, 0, 0
        self.landing, self.settled = np.zeros(len(contact), bool), np.zeros(len(contact), bool)
        for k, touches in enumerate(contact):
            if touches and away >= rows:
                self.landings, end = self.landings + 1, k + rows
            away = 0 if touches else away + 1
            self.landing[k] = k < end
            self.settled[k] = touches and k >= end


def settled_high_pass(f, phases, dt):
    """The force behind the high-pass, which starts at rest in the first settled row after each landing."""
    found, k = np.zeros_like(f), 0
    while k < len(f):
        if not phases.settled[k]:
            k += 1
            continue
        end = next((j for j in range(k, len(f)) if phases.landing[j]), len(f))
        found[k:end] = high_pass(f[k:end], dt)
        k = end
    return found


def nearest_rank(values, share):
    return np.sort(values)[math.ceil(share * len(values)) - 1]


def step_matrix(K, B, M, dt):
    """x, v after a step of leapfrog."""
    return np.array([[1 - K * dt * dt / M, dt - B * dt * dt / M], [-K * dt / M, 1 - B * dt / M]])


def motion_class(v):
    """By `describe stability`: quarter by quarter, amplitude the largest speed; v one column a component."""
    n = len(v)
    size = norms(v)
    quarters = [range(math.ceil(i * n / 4), math.ceil((i + 1) * n / 4)) for i in range(4)]
    amplitude = [size[q].max() for q in map(list, quarters)]
    rest = size <= 1e-12 * np.maximum.accumulate(size)
    if any(rest[i:i + 200].all() for i in range(n - 199)):
        return "stable"
    turns = 0
    for component in v.T:
        moving = np.flatnonzero(component)
        changed = moving[1:][component[moving[1:]] * component[moving[:-1]] < 0]
        turns = max(turns, int(np.sum(changed >= quarters[3][0])))
    if turns < 2:
        return "stable"
    if all(b > 1.01 * a for a, b in zip(amplitude, amplitude[1:])):
        return "diverged"
    if amplitude[3] < 0.01 * amplitude[0]:
        return "stable"
    return "dying_out" if amplitude[2] < 0.9 * amplitude[1] and amplitude[3] < 0.9 * amplitude[2] else "vibrating"


def bisected(holds, low, high, width=0.0):
    """The edge between `low`, where it holds, and `high`, where it does not, to a relative width or to rounding."""
    while low < (middle := 0.5 * (low + high)) < high and high - low > width * high:
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


class HeldLoop:
    """The handle of an impedance device on a spring and damper that hold their force over each period: an exact linear map."""

    def __init__(self, m, b, T, K, B, delay=0, spring=0.0):
        whole = int(delay)
        part = delay - whole
        A, size = np.array([[0, 1.0], [-spring / m, -b / m]]), 3 + whole + (part > 0)
        # State: x, v, x of the last sample, forces under way (the newest first).
        E = lambda t: linalg.expm(np.block([[A, np.array([[0], [1 / m]])], [np.zeros((1, 3))]]) * t)
        force = np.zeros(size)
        force[0], force[2] = -K - B / T, B / T
        forces = [force] + [np.eye(size)[3 + i] for i in range(size - 3)]
        first, rest = forces[-1] if part else forces[whole], forces[whole]  # until the newer one arrives, and after it
        step = np.eye(size)
        for t, held in ((part * T, first), ((1 - part) * T, rest)):
            if t > 0:
                X, moved = E(t), np.zeros((size, size))
                moved[:2] = X[:2, :2] @ step[:2] + np.outer(X[:2, 2], held)
                step = np.vstack([moved[:2], step[2:]])
        step[2] = np.eye(size)[0]
        for i in range(3, size):
            step[i] = forces[i - 3]
        self.matrix = step

    def radius(self):
        return np.abs(np.linalg.eigvals(self.matrix)).max()


def motion_of(matrix, start, n=8000):
    """Speeds (state 1) of n rows of a linear recurrence, or None if it leaves the default bounds."""
    values, vectors = np.linalg.eig(matrix)
    parts = vectors * np.linalg.solve(vectors, start.astype(complex))
    with np.errstate(over="ignore", invalid="ignore"):
        powers = values[:, None] ** np.arange(n)
        x, v = (parts[:2] @ powers).real
    return None if not (np.abs(x).max() <= 1e3 and np.abs(v).max() <= 1e6) else v[:, None]


def class_of(matrix, start):
    v = motion_of(matrix, start)
    return "diverged" if v is None else motion_class(v)


def grows(matrix, n):
    """By describe stability: by more than a percent from each quarter to the next."""
    v = motion_of(matrix, np.eye(len(matrix))[0] * 1e-3 + np.eye(len(matrix))[2] * 1e-3, n)
    if v is None:
        return True
    quarters = [np.abs(q).max() for q in np.split(v[:, 0], 4)]
    return all(b > 1.01 * a for a, b in zip(quarters, quarters[1:]))
