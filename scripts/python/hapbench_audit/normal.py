"""Estimates the normal of the surface that a tool touches. In a contact with friction, the force is not along the
normal."""
import math

import numpy as np
from scipy.optimize import least_squares

from .models import Motion, residuals

# Smallest travel of the tool from which a direction of motion is computed, in steps of the position's resolution.
FEWEST_COUNTS = 10
# Largest unexplained fraction of the variance of the force at which the model counts as the exact law of the engine.
EXACTLY = 1e-9
TILTS = 8  # largest number of iterations of the search for the normal
MAX_ROWS = 500  # largest number of rows of the search
# Kinds of velocities (see models.py) that the search for the normal uses.
SEARCHED = ("logged", "backward", "central", "low-pass 4")
# Smallest number of usable rows from which a contact is analysed. In a usable row, the force is new, above 0 and below
# the largest force of the log.
FEWEST_NEW = 15
BLOCKS = 10  # number of residuals of normal_by_friction() that count as independent
# A second normal is better than a first normal if its unexplained fraction is less than this factor times the
# unexplained fraction of the first normal.
AS_GOOD = 0.5
# If the speed is below this fraction of the median speed, the direction of sliding is uncertain.
SLOW = 0.2
MAX_FRICTION = 1.0  # largest coefficient of friction
# Largest error of a normal that counts as known, as the tangent of an angle. Such an error changes a stiffness by
# 1 - cos = 0.1 %.
KNOWN_TILT = 0.05
# Largest fraction of the sum of squared tangential forces that friction may leave unexplained.
EXPLAINED_REST = 0.25
MAX_EVALUATIONS = 50  # largest number of evaluations in the search by friction


def main_direction(force):
    """Returns the unit vector along which the sum of squared forces is largest. The mean force has a positive component
    along this vector."""
    _, vectors = np.linalg.eigh(force.T @ force)
    direction = vectors[:, -1]
    return direction if (force @ direction).sum() >= 0.0 else -direction


def normal_of(log, rows, direction, motion):
    """Returns (normal, Motion along the normal, other Motion or None) of a surface over which the tool slides with
    friction. The other Motion is along another normal that explains the force about as well. `direction`: main
    direction of the force, which is the normal if there is no friction. `motion`: Motion along this direction.

    A force that depends on the depth has its gradient along the normal. The force along the normal contains no
    friction."""
    same = direction, motion, None
    known, best = residuals(motion)
    if best is None:
        return same
    first, normal, model = known[best], direction, None
    if first.mean_square <= EXACTLY * first.total:
        return same
    rubbed = normal_by_friction(log, rows, direction)
    if rubbed is not None:
        return rubbed, Motion(log, rows, rubbed), None
    space = [Motion(log, rows, axis) for axis in np.eye(3)]
    for _ in range(TILTS):
        gradient, model = gradient_of(log, rows, normal, space, model)
        if gradient is None:
            return same
        is_found = np.linalg.norm(np.cross(gradient, normal)) < 1e-7
        normal = gradient
        if is_found:
            break
    # If the angle between normal and force exceeded 45 degrees, friction would be larger than the normal force.
    if normal @ direction < math.sqrt(0.5):
        return same
    other = Motion(log, rows, normal)
    known, best = residuals(other)
    if best is None:
        return same
    ratio = known[best].mean_square * first.total / (first.mean_square * known[best].total)
    if ratio < AS_GOOD:
        return normal, other, None
    return direction, motion, other if ratio * AS_GOOD < 1.0 else None


def normal_by_friction(log, rows, direction):
    """Returns the normal for which the tangential force is friction: the coefficient mu times the normal force, against
    the sliding direction. Returns None if the log does not determine this normal, for example if the tool does not
    slide or slides along a straight line. The method needs neither stiffness nor delay."""
    velocity = sliding_velocity(log, rows)
    if velocity is None:
        return None
    speed = np.linalg.norm(velocity, axis=1)
    chosen = np.flatnonzero(speed > np.median(speed) * SLOW)
    chosen = chosen[np.linspace(0, len(chosen) - 1, min(len(chosen), MAX_ROWS)).astype(int)]
    force, velocity = log.force[rows][chosen], velocity[chosen]
    force = force / math.sqrt(np.mean(np.sum(force**2, axis=1)))
    sides = np.linalg.svd(direction[None])[2][1:]

    def normal_at(tilts):
        normal = direction + tilts @ sides
        return normal / np.linalg.norm(normal)

    def rest(values):
        normal = normal_at(values[:2])
        along = force @ normal
        sliding = velocity - np.outer(velocity @ normal, normal)
        sliding /= np.maximum(np.linalg.norm(sliding, axis=1), 1e-300)[:, None]
        sideways = force - np.outer(along, normal)
        return (sideways + values[2] * along[:, None] * sliding).ravel()

    found = least_squares(rest, [0.0, 0.0, 0.1], max_nfev=MAX_EVALUATIONS)
    # Residuals of neighbouring rows are correlated, so that only BLOCKS residuals count as independent.
    variance = 2.0 * found.cost / max(BLOCKS - 3, 1)
    error = np.sqrt(variance * np.diag(np.linalg.pinv(found.jac.T @ found.jac)))[:2].max()
    before = np.sum((force - np.outer(force @ direction, direction)) ** 2)
    is_found = 0.0 <= found.x[2] <= MAX_FRICTION and error <= KNOWN_TILT
    is_friction = 2.0 * found.cost < EXPLAINED_REST * before
    return normal_at(found.x[:2]) if is_found and is_friction else None


def sliding_velocity(log, rows):
    """Returns the velocities of the rows [m/s]. If the log has no velocities, each velocity is a difference of two
    positions divided by the time between them; this time is so long that the position typically changes by more than
    FEWEST_COUNTS steps of its resolution. Returns None if the position changes too little.
    """
    if log.velocity is not None:
        return log.velocity[rows]
    position, longest = log.position, len(rows) // 8
    half = 1 if log.held is None else max(round(log.held.rows), 1)
    while True:
        first = np.maximum(rows - half, 0)
        last = np.minimum(rows + half, len(position) - 1)
        moved = position[last] - position[first]
        typical = float(np.median(np.linalg.norm(moved, axis=1)))
        if typical > FEWEST_COUNTS * float(log.quantum_m.max()) and typical > 0.0:
            return moved / (log.time[last] - log.time[first])[:, None]
        half *= 2
        if half > longest:
            return None


def gradient_of(log, rows, normal, space, model):
    """Returns (direction, Model). The direction is the unit vector along the gradient of the force component along
    `normal`. Its sign is such that its component along `normal` is positive. Returns (None, None) if there are fewer
    than FEWEST_NEW usable rows, if the tool hardly moves, or if the gradient is zero. `space`: three Motions, along the
    x, y and z axes. `model`: Model of the fit. If `model` is None, the Model with the smallest residual is used.
    """
    keep = space[0].usable()
    force = (log.force[rows] @ normal)[keep]
    some = np.linspace(0, keep.sum() - 1, min(keep.sum(), MAX_ROWS)).astype(int)
    force = force[some] - force[some].mean()
    moving = [
        i for i in range(3) if np.ptp(log.position[rows, i]) > FEWEST_COUNTS * log.quantum_m[i]
    ]
    if len(force) < FEWEST_NEW or not moving:
        return None, None
    best = (math.inf, None, None)
    tried = [one for one in space[0].models() if one.kind in SEARCHED] if model is None else [model]
    for one in tried:
        before = space[0].rows[keep][some] - one.delay
        parts = [part for i in moving for part in (space[i].position, space[i].speeds[one.kind])]
        columns = np.column_stack([part[before] - part[before].mean() for part in parts])
        sizes = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
        slopes = np.linalg.lstsq(columns / sizes, force, rcond=1e-6)[0]
        residual = force - columns / sizes @ slopes
        best = min(best, (float(residual @ residual), one, slopes / sizes), key=lambda it: it[0])
    _, model, slopes = best
    # Along an axis on which the tool hardly moves, the component of the gradient is unknown. The direction then has the
    # component of `normal`.
    gradient, size = normal.copy(), np.linalg.norm(slopes[::2])
    if not size > 0.0:
        return None, None
    gradient[moving] = -slopes[::2] / size * np.linalg.norm(normal[moving])
    gradient *= np.sign(gradient @ normal) or 1.0
    return gradient / np.linalg.norm(gradient), model
