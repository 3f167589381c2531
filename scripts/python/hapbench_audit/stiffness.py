"""Stiffness and damping that a contact rendered: regression of the force along its main direction on position, velocity
and the sign of the velocity, over delays of whole rows."""
from dataclasses import dataclass

import numpy as np

FEWEST = 20  # rows of a contact
MOST_DELAY = 50  # rows
LONGEST_MEMORY = 1000  # rows
FEWEST_COUNTS = 10  # travel in steps of the position's resolution
EXPLAINED = 0.5  # share of the variance that a spring must explain
NEARLY_BEST = 2.0  # times the smallest mean square: delays that explain the force as well
DRY_GAIN = 0.7  # the sign of the velocity must lower the sum of squares below this share
DRY_SHARE = 0.02  # and be at least this share of the mean force
NEGLIGIBLE = 1e-6  # share of the variance that may stay unexplained


@dataclass
class Fit:
    values: np.ndarray  # of the columns: position, velocity, (sign), 1
    errors: np.ndarray  # standard errors
    squares: float  # sum of squared residuals
    explained: float  # share of the variance
    delay: int  # rows
    rows: int
    speed: float  # root mean square of the velocity less its mean [m/s]


def main_direction(force):
    """Unit vector along which the forces are largest, pointing with them."""
    _, vectors = np.linalg.eigh(force.T @ force)
    direction = vectors[:, -1]
    return direction if (force @ direction).sum() >= 0.0 else -direction


def stiffness_of(log, rows):
    """Numbers of the contact in these rows (an array of row numbers, mostly consecutive). `why`: why there are none."""
    force = log.force[rows]
    if len(rows) < FEWEST:
        return {"why": f"{len(rows)} rows, {FEWEST} are needed"}
    direction = main_direction(force)
    place, along = log.position @ direction, force @ direction
    speed = speeds(log, place, direction)
    if log.held is not None:
        rows, along = rows[log.held.fresh[rows]], along[log.held.fresh[rows]]
    travel = float(np.ptp(place[rows])) if len(rows) else 0.0
    resolution = float(np.abs(direction) @ log.quantum_m)
    found = {
        "direction": direction.tolist(),
        "off_direction_share": float(
            np.linalg.norm(force - np.outer(force @ direction, direction)) / np.linalg.norm(force)
        ),
        "travel_m": travel,
        "resolution_m": resolution,
    }
    if len(rows) < FEWEST:
        return found | {"why": f"{len(rows)} fresh rows, {FEWEST} are needed"}
    if travel <= FEWEST_COUNTS * resolution or travel <= 1e-12:
        counts = f", {travel / resolution:.3g} steps of its resolution" if resolution else ""
        return found | {"why": f"the position along the force moves by {travel:.3g} m only{counts}"}
    if np.ptp(along) == 0.0:
        return found | {"why": "the force is constant"}
    fit, has_sign = best_fit(place, speed, along, rows)
    if fit is None or fit.explained < EXPLAINED:
        share = 0.0 if fit is None else fit.explained
        return found | {
            "why": f"a spring and a damper explain {100.0 * share:.0f} % of the force's variance, as in a rigid "
            "contact, or with friction along the force",
            "explained": share,
        }
    return found | numbers_of(fit, has_sign, log, resolution, place[rows], speed[rows], along)


def speeds(log, place, direction):
    """Velocity along the direction [m/s]: as logged, else the difference to the row before."""
    if log.velocity is not None:
        return log.velocity @ direction
    if log.held is None:
        return np.diff(place, prepend=place[0]) / np.diff(
            log.time, prepend=2.0 * log.time[0] - log.time[1]
        )
    fresh = np.flatnonzero(log.held.fresh)
    found = np.zeros(len(place))
    found[fresh[1:]] = np.diff(place[fresh]) / np.diff(log.time[fresh])
    return found


def best_fit(place, speed, force, rows):
    """The fit with the shortest delay that explains the force nearly as well as the best and has no negative damping:
    a delay d of a stiffness K looks like a damping of −K d."""
    most = min(MOST_DELAY, len(rows) // 10)
    fits = [
        fit
        for delay in range(most + 1)
        if (fit := fit_at(place, speed, force, rows, delay, False, most)) is not None
    ]
    if not fits:
        return None, False
    chosen = fit_at(place, speed, force, rows, shortest(fits).delay, False)
    with_sign = fit_at(place, speed, force, rows, chosen.delay, True)
    is_dry = (
        with_sign is not None
        and chosen.explained < 1.0 - 1e-6
        and with_sign.squares / with_sign.rows < DRY_GAIN * chosen.squares / chosen.rows
        and abs(with_sign.values[2])
        > max(2.0 * with_sign.errors[2], DRY_SHARE * np.abs(force).mean())
    )
    return (with_sign, True) if is_dry else (chosen, False)


def shortest(fits):
    def mean_square(fit):
        return fit.squares / fit.rows

    scale = max(fit.squares / max(1.0 - fit.explained, 1e-30) / fit.rows for fit in fits)
    floor = NEGLIGIBLE * scale
    least = min(map(mean_square, fits))
    good = [fit for fit in fits if mean_square(fit) <= NEARLY_BEST * least + floor]
    # A force of the wrong sign is no delay, although half a period of a periodic motion explains it as well.
    if -good[0].values[0] < -2.0 * good[0].errors[0]:
        return good[0]
    calm = [
        fit
        for fit in good
        if -fit.values[1] >= -2.0 * fit.errors[1] - 1e-6 * abs(fit.values[1])
        or abs(fit.values[1]) * fit.speed <= 1e-6 * np.sqrt(scale)
    ]
    return calm[0] if calm else min(good, key=mean_square)


def fit_at(place, speed, force, rows, delay, with_sign, most=0):
    """Least squares of the force on position, velocity and 1 of `delay` rows before; None without variation. `most`:
    the first rows are left out, so that fits up to this delay share their forces."""
    before = rows - delay
    # A delayed row must belong to the contact, and the first speed has no row before it.
    usable = (before >= max(int(rows[0]), 1)) & (rows >= rows[0] + most)
    x, v, f = place[before[usable]], speed[before[usable]], force[usable]
    if len(x) < FEWEST // 2 or np.ptp(x) == 0.0:
        return None
    columns = [x - x.mean(), v - v.mean()]
    if with_sign:
        moving = np.sign(np.where(np.abs(v) > 1e-3 * np.abs(v).max(), v, 0.0))
        columns.append(moving - moving.mean())
    sizes = np.array([np.linalg.norm(column) for column in columns])
    if sizes[1] == 0.0 or (with_sign and sizes[2] == 0.0):
        return None
    matrix = np.column_stack(columns) / sizes
    target = f - f.mean()
    scaled, _, rank, _ = np.linalg.lstsq(matrix, target, rcond=1e-10)
    if rank < matrix.shape[1]:
        return None
    residual = target - matrix @ scaled
    squares, variance = float(residual @ residual), float(target @ target)
    inverse = np.linalg.inv(matrix.T @ matrix)
    spread = squares / max(len(f) - matrix.shape[1] - 1, 1) * memory(residual)
    return Fit(
        scaled / sizes,
        np.sqrt(np.diag(inverse) * spread) / sizes,
        squares,
        1.0 - squares / variance if variance > 0.0 else 0.0,
        delay,
        len(f),
        float(sizes[1] / np.sqrt(len(f))),
    )


def memory(residual):
    """Rows that one independent residual stands for: 1 + 2 times the sum of the autocorrelations above 0.05."""
    power, total = float(residual @ residual), 1.0
    if power == 0.0:
        return 1.0
    for lag in range(1, min(len(residual) // 4, LONGEST_MEMORY)):
        correlation = float(residual[lag:] @ residual[:-lag]) / power
        if correlation < 0.05:
            break
        total += 2.0 * correlation
    return total


def numbers_of(fit, has_sign, log, resolution, place, speed, along):
    """Values with 95 % intervals."""
    interval = log.interval
    # Rounding of the position makes a slope smaller, by its share of the variance.
    shrink = resolution**2 / 12.0 / max(float(np.var(place)), 1e-300)
    stiffness, damping = -fit.values[0], -fit.values[1]
    k_half = 1.96 * fit.errors[0] + (1e-6 + shrink) * abs(stiffness)
    found = {
        "stiffness_N_per_m": float(stiffness),
        "stiffness_interval": [float(stiffness - k_half), float(stiffness + k_half)],
        "delay_rows": fit.delay,
        "delay_s": fit.delay * interval,
        "explained": fit.explained,
        "dry_friction_N": float(-fit.values[2]) if has_sign else 0.0,
        "linearity": linearity(place, along + damping * speed, fit),
    }
    of_rounding = resolution / interval / np.sqrt(6.0) if log.velocity is None else 0.0
    if of_rounding > 0.3 * fit.speed and fit.explained < 0.9999:
        return found | {
            "damping_N_s_per_m": None,
            "damping_interval": None,
            "why_no_damping": "the resolution of the position hides the velocity",
        }
    b_half = 1.96 * fit.errors[1] + 1e-6 * abs(damping) + 1e-9 * abs(stiffness) * interval
    return found | {
        "damping_N_s_per_m": float(damping),
        "damping_interval": [float(damping - b_half), float(damping + b_half)],
    }


def linearity(place, along, fit):
    """Stiffness of the deeper half of the travel divided by the stiffness of the other half, or None; 1: linear.
    `along`: force without the damping."""
    middle = 0.5 * (place.min() + place.max())
    slopes = []
    for half in (place < middle, place >= middle):
        if half.sum() < FEWEST or np.ptp(place[half]) == 0.0:
            return None
        slopes.append(-np.polyfit(place[half] - middle, along[half], 1)[0])
    # The force points out of the surface, so deeper is the smaller position.
    deep, shallow = slopes
    return float(deep / shallow) if fit.delay == 0 and shallow > 0.0 else None
