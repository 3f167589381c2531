"""Measures whether the force of a contact grows linearly with the depth."""
import numpy as np

FEWEST = 10  # smallest number of rows in each half of the travel


def median_linearity(contacts):
    """Returns the median of linearity() over the contacts, each a pair (Motion, Fit), or None if no contact has a
    value."""
    found = [one for one in (linearity(*contact) for contact in contacts) if one is not None]
    return float(np.median(found)) if found else None


def linearity(motion, fit):
    """Returns the stiffness in the deeper half of the travel divided by the stiffness in the shallower half: 1 for a
    linear spring. Returns None if a half has too few rows or no travel, or if the shallower half has no positive
    stiffness."""
    keep = motion.known(fit.model.delay)
    before = motion.rows[keep] - fit.model.delay
    position = motion.position[before]
    force = motion.force[keep] + fit.damping * motion.speeds[fit.model.kind][before]
    middle = 0.5 * (position.min() + position.max())
    slopes = []
    for half in (position < middle, position >= middle):
        if half.sum() < FEWEST or np.ptp(position[half]) == 0.0:
            return None
        slopes.append(-np.polyfit(position[half] - middle, force[half], 1)[0])
    # The force points out of the surface, so that the deeper half has the smaller positions.
    deep, shallow = slopes
    return float(deep / shallow) if shallow > 0.0 else None
