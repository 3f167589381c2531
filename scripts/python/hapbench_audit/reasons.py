"""Texts that state why the log does not determine the stiffness of a contact."""
import numpy as np

EXTREMES = 10.0  # ratio of the range of a million normal errors to their standard deviation
MIN_CHANGE = 0.01  # smallest significant change of the force, as a fraction of the largest force


def no_travel_text(travel, resolution, force, noise):
    """Returns the reason why a contact, in which the tool does not move along the force, does not determine a
    stiffness. If the force changes, the text gives a lower bound of the stiffness. `travel`, `resolution`: travel and
    resolution of the position [m]. `noise`: standard deviation of the noise of the force [N]."""
    moves = f"moves by {travel:.3g} m only" if travel > 1e-12 else "does not move"
    if resolution:
        moves += f", {travel / resolution:.3g} steps of its resolution"
    text = f"the position along the force {moves}"
    size = np.linalg.norm(force, axis=1)
    change = float(np.ptp(size)) - EXTREMES * noise
    if change <= MIN_CHANGE * float(size.max()):
        return text
    text = f"{text}, and the force changes by {change:.3g} N"
    bound = change / max(travel + resolution, 1e-12)
    return f"{text}, as in a rigid contact (more than {bound:.2g} N/m)"


def why_unknown(best, stiffness, delays, interval):
    """Returns the reason why fits do not determine the stiffness. `best`: Fit of the best model. `stiffness`: Estimate
    of the stiffness, or None if a stiffness of zero is possible. `delays`: possible delays [rows]. `interval`: time
    between rows [s]."""
    if stiffness is None or stiffness.low <= 0.0:
        text = (
            "the log does not bound the stiffness (position and velocity explain "
            f"{100.0 * best.explained:.3g} % of the force's variance)"
        )
    else:
        text = f"stiffnesses of {stiffness.low:.3g} to {stiffness.high:.3g} N/m explain the force equally well"
    if len(delays) > 1:
        return (
            f"{text}, with delays of {1e3 * delays[0] * interval:.3g} to {1e3 * delays[-1] * interval:.3g} ms, as in a "
            "single oscillation or decay"
        )
    return text
