"""Whether the force of a contact grows linearly with the depth."""
import numpy as np

FEWEST = 10  # rows of each half


def median_linearity(contacts):
    """Median of linearity() over (Motion, Fit) of contacts, or None."""
    found = [one for one in (linearity(*contact) for contact in contacts) if one is not None]
    return float(np.median(found)) if found else None


def linearity(motion, fit):
    """Stiffness of the deeper half of the travel divided by the stiffness of the other half, or None; 1: linear."""
    keep = motion.known(fit.model.delay)
    before = motion.rows[keep] - fit.model.delay
    place = motion.place[before]
    force = motion.force[keep] + fit.damping * motion.speeds[fit.model.kind][before]
    middle = 0.5 * (place.min() + place.max())
    slopes = []
    for half in (place < middle, place >= middle):
        if half.sum() < FEWEST or np.ptp(place[half]) == 0.0:
            return None
        slopes.append(-np.polyfit(place[half] - middle, force[half], 1)[0])
    # The force points out of the surface, so deeper is the smaller position.
    deep, shallow = slopes
    return float(deep / shallow) if shallow > 0.0 else None
