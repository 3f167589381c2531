"""Model of the handle of an impedance device: m x'' = u(t - delay) + offset - b x' - c sign(x'). The commanded force u
is held over each sample. The program integrates the motion exactly, including stops. This module also creates the force
signals for an identification."""
import subprocess

import numpy as np
from hapbench_command import Faults, fail, the_program

NAMES = ("handle_mass_kg", "viscous_N_s_per_m", "coulomb_N", "delay_s", "offset_N", "start_m_per_s")
KINDS = {
    "chirp": "a sine whose frequency rises",
    "steps": "alternating pushes, from short to long",
    "multisine": "sum of thirty sines",
}
# Largest dry friction that can be identified, as a fraction of the largest force. With more friction, the handle moves
# too little.
IDENTIFIABLE_FRICTION = 0.6
# Largest frequency of a force signal [Hz]; higher frequencies contain little information about mass and friction.
HIGHEST = 100.0
# Frictions of the simulations by which design() limits the travel. Key: viscous friction divided by mass [1/s]. Value:
# dry frictions as fractions of the largest force.
DRY_SHARES = {
    0.0: np.linspace(0.0, IDENTIFIABLE_FRICTION, 61),
    1.0: np.linspace(0.0, IDENTIFIABLE_FRICTION, 13),
    10.0: np.linspace(0.0, IDENTIFIABLE_FRICTION, 13),
}
TRAVEL_USED = (
    # Fraction of the allowed travel that the simulated handle may use. With a friction between the simulated frictions,
    # the travel can be up to 6 % longer.
    0.9
)


class Simulator(subprocess.Popen):
    """A process of the program that simulates the handle under the forces of a log. A fit needs some thousand
    simulations, which one process computes. A Simulator is used in a `with` statement, which ends the process.
    """

    def __init__(self, time, force):
        program = the_program()
        if not program:
            fail("the program hapbench, which simulates the handle, was not found in PATH")
        super().__init__(
            [program, "import", "device", "--simulate-log"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        self._send(np.concatenate([[len(time)], time, force]))
        self.rows = len(time)

    def _send(self, numbers):
        self.stdin.write(np.asarray(numbers, float).tobytes())
        self.stdin.flush()

    def __call__(self, parameters, rows=None):
        """Returns the displacements [m] from the first position at the first `rows` times (None: all). `parameters`:
        values of the handle in the order of NAMES."""
        rows = rows or self.rows
        self._send([rows, *parameters])
        answer = self.stdout.read(8 * rows)
        if len(answer) != 8 * rows:
            raise RuntimeError("the program, which simulates the log, ended")
        return np.frombuffer(answer)


def positions(time, force, parameters):
    """Runs one simulation and returns the displacements from the first position [m]."""
    with Simulator(time, force) as simulate:
        return simulate(parameters)


def design(kind, force, travel, rate, duration, mass):
    """Returns (times, forces) of a signal for an identification. The force is at most `force` [N]. Without friction,
    and with dry friction up to IDENTIFIABLE_FRICTION of the largest force, a handle of at least `mass` [kg] stays
    within `travel` [m]."""
    steps = int(round(duration * rate))
    if steps < 100:
        fail(
            f"--design: duration: got {duration:g} s, {steps} samples; allowed: at least 100 of them"
        )
    time = np.arange(steps) / rate
    # A handle at rest under the force F cos(w t) moves between 0 and 2 F / (m w^2), without drift.
    slowest = max(np.sqrt(2.0 * force / (mass * travel)) / (2.0 * np.pi), 2.0 / duration)
    fastest = min(0.1 * rate, HIGHEST)
    if slowest > 0.5 * fastest:
        fail(
            f"--design: travel: a handle of {mass:g} kg moves further than {travel:g} m at "
            f"{force:g} N below {slowest:.3g} Hz; allowed: less "
            "force, or more travel"
        )
    if kind == "chirp":
        growth = np.log(fastest / slowest) / duration
        values = np.cos(2.0 * np.pi * slowest * np.expm1(growth * time) / growth)
    elif kind == "multisine":
        lines = np.unique(np.rint(np.geomspace(slowest, fastest, 30) * duration)) / duration
        signs = np.where(np.random.default_rng(1).random(len(lines)) < 0.5, -1.0, 1.0)
        values = sum(sign * np.cos(2.0 * np.pi * f * time) for f, sign in zip(lines, signs))
    else:
        values = _steps(steps, rate, slowest, fastest)
    values *= force / np.abs(values).max()
    # The displacement is proportional to the force if dry friction is a fixed fraction of the force.
    return time, values * min(1.0, TRAVEL_USED * travel / np.ptp(range_of(time, values, mass)))


def _steps(steps, rate, slowest, fastest):
    """Returns sequences of pushes: + for n samples, - for 2 n, + for n, 0 for n, with growing n. Without friction, a
    sequence brings the handle back to rest at its start. With friction, the first push moves the handle farthest, so
    that the handle drifts. Each sequence is therefore followed by the sequence of opposite sign, which compensates the
    drift.
    """
    values = []
    lengths = np.geomspace(rate / (4.0 * fastest), rate / (4.0 * slowest), 8)
    while len(values) < steps:
        for length in np.maximum(1, np.rint(lengths)).astype(int):
            pushes = [1.0] * length + [-1.0] * (2 * length) + [1.0] * length + [0.0] * length
            values += pushes + [-push for push in pushes]
    return np.array(values[:steps])


def range_of(time, force, mass):
    """Returns the lowest and the highest position relative to the start [m], over all frictions in DRY_SHARES."""
    peak, ends = np.abs(force).max(), [0.0]
    with Simulator(time, force) as simulate:
        for rate, shares in DRY_SHARES.items():
            for share in shares:
                path = simulate((mass, rate * mass, share * peak, 0.0, 0.0, 0.0))
                ends += [path.min(), path.max()]
    return min(ends), max(ends)


def required_force(kind, numbers):
    """Returns the value of --force with which the signal reaches numbers["force"] [N], although the travel limits the
    signal. The value is rounded up to two digits. A larger --force makes the signal begin at a higher frequency.
    Returns None if no value suffices."""
    wanted = requested = numbers["force"]
    try:
        for _ in range(8):
            peak = np.abs(design(kind, **(numbers | {"force": requested}))[1]).max()
            if peak >= 0.99 * wanted:
                return requested
            digit = 10.0 ** (np.floor(np.log10(requested * wanted / peak)) - 1.0)
            requested = float(digit * np.ceil(1.001 * requested * wanted / peak / digit))
    except Faults:
        pass
    return None
