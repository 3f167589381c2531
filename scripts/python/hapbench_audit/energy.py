"""Work of the force on the tool, Σ f_k · (p_(k+1) − p_k), over the log and over each contact. f_k and p_k are force [N]
and position [m] of row k. Positive work is energy that the rendering gives to the hand."""
import numpy as np


class Port:
    """Work of the force on the tool in each interval between two rows [J]; 0 in gaps. `held`: work if the force of a
    row acts until the next row, as on a device that holds the force. `path`: work if the force changes linearly between
    rows (trapezoidal rule).

    The force of a missing row and its position are taken to be between the values of the rows before and after it. With
    m missing rows, which the log does not show, the work `held` is then at most half the range from f_k Δp to f_k Δp +
    m / (m + 1) Δf Δp away from the middle of this range."""

    def __init__(self, log, contacts):
        moved, f = np.diff(log.position, axis=0), log.force
        moved[contacts.gap] = 0.0
        changed = np.diff(f, axis=0) * (0.5 * log.missing / (log.missing + 1.0))[:, None]
        self.held = work(f[:-1] + changed, moved)
        self.path = work(0.5 * (f[:-1] + f[1:]), moved)
        # The error of a position is at most half the resolution of positions, and the error of a force at most half the
        # resolution of forces.
        changes = np.abs(np.diff(f, axis=0, prepend=np.zeros((1, 3))))
        self._of_positions = np.append(changes @ (0.5 * log.quantum_m), 0.0)
        self._of_forces = np.append(np.abs(moved) @ (0.5 * log.quantum_N), 0.0)
        self._of_missing = np.append(np.abs(changed * moved).sum(axis=1), 0.0)
        self._last = np.abs(f) @ (0.5 * log.quantum_m)

    def errors(self):
        """Returns error() from row 0 to each later row, as an array with one entry per row; the first entry is 0."""
        sums = np.cumsum(self._of_forces + self._of_missing)[:-1]
        sums += np.cumsum(self._of_positions[: len(sums)]) - self._of_positions[0]
        return np.append(0.0, sums + self._last[0] + self._last[:-1])

    def error(self, first, after):
        """Returns the largest error [J] that the resolution of positions and forces and the missing rows of the log can
        cause in the sum of `held` over the rows from `first` to before `after`."""
        last = min(after, len(self._last) - 1)
        return float(
            self._of_positions[first + 1 : after].sum()
            + self._last[first]
            + self._last[max(last - 1, 0)]
            + self._of_forces[first:last].sum()
            + self._of_missing[first:last].sum()
        )


def work(force, displacement):
    return np.einsum("ij,ij->i", force, displacement)


def stored_at(log, contacts, row, spring):
    """Returns the energy [J] that is stored in the spring of a contact at `row`, which is the first row of the contact
    or of the log. If `row` is not in contact, or if the log contains the touch, the energy is 0. The log does not
    contain the touch if `row` is in contact and is the first row of the log or the first row after a gap
    (Contacts.gap). Returns None if the log does not contain the touch and the stiffness is unknown.
    """
    if not contacts.in_contact[row] or (row > 0 and not contacts.gap[row - 1]):
        return 0.0
    stiffness = (spring or {}).get("stiffness_N_per_m", 0.0)
    return float(log.force[row] @ log.force[row]) / (2.0 * stiffness) if stiffness > 0.0 else None


def created(given, stored):
    """Returns the created energy [J]: the largest value of `given` minus `stored`, but at least 0. Returns None if
    `stored` is None. `given`: work on the hand, accumulated from the start up to each row [J]. `stored`: energy in the
    spring at the start [J].
    """
    return None if stored is None else float(max(given.max() - stored, 0.0))


def energy_of(log, port, stored):
    """Returns the energies of the whole log for the JSON. `stored`: stored_at() of the first row [J]."""
    held = np.concatenate([[0.0], np.cumsum(port.held)])
    path = np.concatenate([[0.0], np.cumsum(port.path)])
    worst = int(np.argmax(held))
    errors = port.errors()
    # If no energy was created, the error is the largest energy that may have been created.
    error = float(errors[worst] if worst else (held + errors).max())
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
    """Returns the energies of the contact in the rows from `first` to before `after`, for the JSON. `stored`: energy in
    the contact's spring at the first row [J]. The created energy is the largest amount by which the accumulated work on
    the tool exceeds `stored`."""
    last = min(after, len(port.held))
    given = np.cumsum(port.held[first:last]) if last > first else np.zeros(1)
    # The trapezoidal rule also includes the interval before the first row and the interval after the last row of the
    # contact, in which the force rises and falls.
    path = np.cumsum(port.path[max(first - 1, 0) : last]) if last > first else np.zeros(1)
    return {
        "work_J": float(given[-1]),
        "created_J": created(given, stored),
        "created_path_J": created(path, stored),
        "error_J": port.error(first, last),
    }
