"""Functions that the scenes share: filters and phases of a run, linear recurrences, and the classes of their motion."""
import math

import numpy as np
from scipy import linalg, signal

from answers import Within

PLAIN = {
    "stiffness_N_per_m": 1000,
    "damping_ratio": 0,
    "mass_kg": 0.1,
    "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0},
}
SUMMED = {**PLAIN, "algorithm": "summation"}
UP = {"type": "springs", "groups": [{"direction": [0, 1, 0], "count": 2}]}
SPRING = {"type": "springs", "groups": [{"direction": [1, 0, 0], "count": 1}]}
BELOW = {"type": "springs", "groups": [{"direction": [0, 0, -1], "count": 1}]}
STEPPED = Within(
    "velocities are differences of positions, known to 1e-17 m, over steps of 0.5 ms",
    relative=1e-11,
    absolute=1e-15,
)
FILTERED = Within(
    "scipy's second-order sections are ours in another order: rounding times the filter's memory "
    "of some hundred rows",
    relative=1e-9,
    absolute=1e-15,
)
BINNED = Within(
    "a bin of the histogram of squares is a 32nd of a factor of two: half of sqrt(33/32) - 1",
    relative=0.0078,
)


def high_pass(x, dt):
    """Returns the rows of x after a fourth-order Butterworth high-pass at 30 Hz. The filter starts in the steady state
    of the first row, so that its output starts at zero. `dt`: time step [s]."""
    sections = signal.butter(4, 30.0, "high", fs=1 / dt, output="sos")
    return signal.sosfilt(
        sections, x, axis=0, zi=signal.sosfilt_zi(sections)[:, :, None] * x[0][None, None, :]
    )[0]


class Phases:
    """Rows of landings and of settled contact, by their definitions. `contact`: for each row, true if it is in contact.
    `dt`: time step [s]."""

    def __init__(self, contact, dt):
        rows, touches = round(0.05 / dt), np.flatnonzero(contact)
        starts = touches[np.diff(touches, prepend=-rows - 1) > rows]
        self.landings, self.landing = len(starts), np.zeros(len(contact), bool)
        for start in starts:
            self.landing[start : start + rows] = True
        self.settled = contact & ~self.landing


def settled_high_pass(f, phases, dt):
    """Returns the high-passed force. The filter starts with zero output in the first settled row after each landing."""
    found = np.zeros_like(f)
    for rows in np.split(np.arange(len(f)), np.flatnonzero(np.diff(phases.landing)) + 1):
        rows = rows[np.cumsum(phases.settled[rows]) > 0]
        if rows.size:
            found[rows] = high_pass(f[rows], dt)
    return found


def nearest_rank(values, share):
    return np.sort(values)[math.ceil(share * len(values)) - 1]


def step_matrix(K, B, M, dt):
    """Returns the matrix of (x, v) for one step of leapfrog."""
    return np.array([[1 - K * dt * dt / M, dt - B * dt * dt / M], [-K * dt / M, 1 - B * dt / M]])


def bisected(holds, low, high, width=0.0):
    """Returns the boundary between `low`, where the condition `holds` is true, and `high`, where it is false. The
    bisection ends at the relative width `width`, or at the resolution of doubles."""
    while low < (middle := 0.5 * (low + high)) < high and high - low > width * high:
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def radius(matrix):
    """Returns the spectral radius of a matrix. The motion decays if the spectral radius is below 1."""
    return np.abs(np.linalg.eigvals(matrix)).max()


def limit_of(loop, low, high):
    """Returns the smallest value between `low` and `high` at which the motion no longer decays. `loop`: function from a
    value to the matrix of the motion."""
    return bisected(lambda value: radius(loop(value)) < 1, low, high)


def held_loop(m, b, T, K, B, delay=0, spring=0.0):
    """Returns the matrix of one sampling period T [s] for the handle of an impedance device at a wall of stiffness K
    [N/m] and damping B [N s/m]. The force of the wall is held over each period and delayed by `delay` periods. `m`,
    `b`: mass [kg] and viscous friction [N s/m] of the handle. `spring`: stiffness of a hand [N/m].
    """
    whole = int(delay)
    part = delay - whole
    state = np.eye(
        3 + whole + (part > 0)
    )  # state: x, v, x of the last sample, delayed forces (newest first)
    forces = np.vstack([(-K - B / T) * state[0] + B / T * state[2], state[3:]])
    A = np.array(
        [[0, 1, 0], [-spring / m, -b / m, 1 / m], [0, 0, 0]]
    )  # inputs: x, v and the held force
    moved = state[:2]
    for t, held in (
        (part * T, forces[-1]),
        ((1 - part) * T, forces[whole]),
    ):  # the older force until the newer force arrives, then the newer force
        moved = linalg.expm(A * t)[:2] @ np.vstack([moved, held])
    return np.vstack([moved, state[0], forces[:-1]])


def motion_of(matrix, x, n=8000):
    """Returns the velocities [m/s] of n rows of the motion that starts at rest at the position x [m]. `matrix`: result
    of step_matrix() or held_loop(). Returns None if the motion leaves the default bounds."""
    values, vectors = np.linalg.eig(matrix)
    start = np.zeros(len(matrix))
    start[:3:2] = x  # the previous sample has the same position
    parts = vectors * np.linalg.solve(vectors, start)
    with np.errstate(over="ignore", invalid="ignore"):
        powers = values[:, None] ** np.arange(n)
        x, v = (parts[:2] @ powers).real
    return v if np.abs(x).max() <= 1e3 and np.abs(v).max() <= 1e6 else None


def class_of(matrix, x, n=8000):
    """Returns the class of the motion by the rules of `describe stability`. The rules compare the amplitudes of the
    quarters of a run. The amplitude is the largest speed."""
    v = motion_of(matrix, x, n)
    if v is None:
        return "diverged"
    size = np.abs(v)
    amplitude = [quarter.max() for quarter in np.split(size, 4)]
    rest = size <= 1e-12 * np.maximum.accumulate(size)
    moving = np.flatnonzero(v)
    turns = moving[1:][v[moving[1:]] * v[moving[:-1]] < 0]
    if any(rest[i : i + 200].all() for i in range(n - 199)) or np.sum(turns >= 3 * n // 4) < 2:
        return "stable"
    if all(b > 1.01 * a for a, b in zip(amplitude, amplitude[1:])):
        return "diverged"
    if amplitude[3] < 0.01 * amplitude[0]:
        return "stable"
    return (
        "decaying"
        if amplitude[2] < 0.9 * amplitude[1] and amplitude[3] < 0.9 * amplitude[2]
        else "vibrating"
    )
