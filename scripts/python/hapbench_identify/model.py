"""The handle of an impedance device under held forces that come late: m x'' = u(t - delay) + offset - b x' - c sign(x'),
integrated exactly by the program, stops included."""
import os
import shutil
import subprocess

import numpy as np
from hapbench_import.faults import fail

NAMES = ("handle_mass_kg", "viscous_N_s_per_m", "coulomb_N", "delay_s", "offset_N", "start_m_per_s")


class Simulator:
    """A process of the program that simulates a log, in a `with`; a fit needs some thousand simulations."""

    def __init__(self, time, force):
        program = os.environ.get("HAPBENCH_PROGRAM") or shutil.which("hapbench")
        if not program:
            fail("the program hapbench, which simulates the handle, is not in the path")
        self._process = subprocess.Popen([program, "import", "device", "--simulate-log"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self._send(np.concatenate([[len(time)], time, force]))
        self.rows = len(time)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.stdin.close()
        self._process.stdout.close()
        self._process.wait()

    def _send(self, numbers):
        self._process.stdin.write(np.asarray(numbers, float).tobytes())
        self._process.stdin.flush()

    def __call__(self, parameters, rows=None):
        """The way from the first place to those at the first `rows` times of a handle with `parameters` (NAMES)."""
        rows = rows or self.rows
        self._send([rows, *parameters])
        answer = self._process.stdout.read(8 * rows)
        if len(answer) != 8 * rows:
            raise OSError(0, "the program ended", "the simulation of the log")
        return np.frombuffer(answer)


def positions(time, force, parameters):
    """One simulation."""
    with Simulator(time, force) as simulate:
        return simulate(parameters)
