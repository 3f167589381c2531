"""Finds out whether a tool touches a curved surface. The direction of the force then depends on the position along the
surface, and no single normal fits a contact."""
import numpy as np

from .normal import main_direction, sliding_velocity

# Rows whose force is below this fraction of the largest force have an uncertain direction.
LARGE = 0.2
FEWEST = 20  # smallest number of rows from which a curvature is computed
# Smallest fraction of the variance of the force's direction that position and friction must explain together, and that
# the position must explain alone.
EXPLAINED, BY_POSITION = 0.9, 0.5
# Smallest tilt [rad] and smallest height of the arc, as a fraction of the travel along the normal, that matter.
TILT, HEIGHT = 0.02, 0.02


def radius_of(log, contacts):
    """Returns the smallest radius of curvature of the surface [m], or None if the surface is flat or if its curvature
    hardly changes the depth during a contact."""
    size = np.linalg.norm(log.force, axis=1)
    rows = np.flatnonzero(contacts.in_contact & (size > LARGE * size.max()))
    if log.axes == 1 or len(rows) < FEWEST:
        return None
    normal = main_direction(log.force[rows])
    sides = np.linalg.svd(normal[None])[2][1:]
    tilt = (log.force[rows] / size[rows][:, None]) @ sides.T
    along = log.position[rows] @ sides.T
    tilt, along = tilt - tilt.mean(axis=0), along - along.mean(axis=0)
    causes, total = along, float(np.sum(tilt**2))
    velocity = sliding_velocity(log, rows)
    if velocity is not None:  # friction is against the direction of sliding
        sliding = velocity @ sides.T
        sliding /= np.maximum(np.linalg.norm(sliding, axis=1), 1e-300)[:, None]
        causes = np.column_stack([along, sliding - sliding.mean(axis=0)])
    slopes = np.linalg.lstsq(causes, tilt, rcond=1e-9)[0]
    left, slopes = float(np.sum((tilt - causes @ slopes) ** 2)), slopes[:2]
    by_position = float(np.sum((along @ slopes) ** 2))
    if (
        total < len(rows) * TILT**2
        or left > (1.0 - EXPLAINED) * total
        or by_position < BY_POSITION * total
    ):
        return None
    # On a convex surface, the force tilts towards the displacement. Dry friction that holds the tool tilts it the other
    # way, as a concave surface does, so that this log does not decide between the two.
    if np.trace(slopes) <= 0.0:
        return None
    curvature = float(np.linalg.norm(slopes, 2))
    heights = []
    for first, after in contacts.runs.tolist():
        part = log.position[first:after]
        travel = float(np.ptp(part @ normal))
        width = float(np.linalg.norm(np.ptp(part @ sides.T, axis=0)))
        heights.append(curvature * width**2 / 8.0 / max(travel, 1e-300))
    return 1.0 / curvature if float(np.median(heights)) > HEIGHT else None
