"""Work of the force on the tool, Σ f_k · (p_(k+1) − p_k), over the log and over each contact. Positive work is
energy that the rendering gives to the hand."""
import numpy as np


class Port:
    """Work at the port of a log. `held`: the force of a row acts until the next row, as a device holds it. `path`: the
    force changes linearly between rows (trapezoidal rule). `error`: largest effect of the resolution of the log.
    """

    def __init__(self, log, contacts):
        moved, f = np.diff(log.position, axis=0), log.force
        moved[contacts.gap] = 0.0
        self.held = work(f[:-1], moved)
        self.path = work(0.5 * (f[:-1] + f[1:]), moved)
        # The error of a position is at most half its resolution, and so is the error of a force.
        changes = np.abs(np.diff(f, axis=0, prepend=np.zeros((1, 3))))
        self._of_positions = np.append(changes @ (0.5 * log.quantum_m), 0.0)
        self._of_forces = np.append(np.abs(moved) @ (0.5 * log.quantum_N), 0.0)
        self._last = np.abs(f) @ (0.5 * log.quantum_m)

    def error(self, first, after):
        """Largest error of the work from row `first` to row `after` [J]."""
        last = min(after, len(self._last) - 1)
        return float(
            self._of_positions[first + 1 : after].sum()
            + self._last[first]
            + self._last[max(last - 1, 0)]
            + self._of_forces[first:last].sum()
        )


def work(force, way):
    return np.einsum("ij,ij->i", force, way)


def stored_at(log, contacts, row, spring):
    """Returns the energy stored in the spring at a row where the log, or the clock after a gap, begins in contact [J].
    Returns 0 for other rows, and None if the stiffness is unknown."""
    if not contacts.in_contact[row] or (row > 0 and not contacts.gap[row - 1]):
        return 0.0
    stiffness = (spring or {}).get("stiffness_N_per_m", 0.0)
    return float(log.force[row] @ log.force[row]) / (2.0 * stiffness) if stiffness > 0.0 else None


def created(given, stored):
    """Returns the energy given to the hand beyond the energy stored at the start; None if the stored energy is
    unknown."""
    return None if stored is None else float(max(given.max() - stored, 0.0))


def energy_of(log, port, stored):
    """Returns the numbers of the whole log. `stored`: stored_at() the first row."""
    held = np.concatenate([[0.0], np.cumsum(port.held)])
    path = np.concatenate([[0.0], np.cumsum(port.path)])
    worst = int(np.argmax(held))
    error = port.error(0, worst) if worst else 0.0
    work_end = float(held[-1])
    return {
        "net_created_J": created(held, stored),
        "net_created_error_J": error,
        "time_of_max_s": float(log.time[worst]),
        "work_J": work_end,
        "work_error_J": port.error(0, len(log.time) - 1),
        "net_created_path_J": created(path, stored),
        "stored_at_start_J": stored,
        "work_path_J": float(path[-1]),
    }


def contact_energy(port, first, after, stored):
    """Returns the numbers of one contact. If the work given to the hand exceeds the energy `stored` at the start at any
    time, the excess is created energy."""
    last = min(after, len(port.held))
    given = np.cumsum(port.held[first:last]) if last > first else np.zeros(1)
    # The path begins and ends outside of the contact, where the force is zero.
    path = np.cumsum(port.path[max(first - 1, 0) : last]) if last > first else np.zeros(1)
    return {
        "work_J": float(given[-1]),
        "created_J": created(given, stored),
        "created_path_J": created(path, stored),
        "error_J": port.error(first, last),
    }
