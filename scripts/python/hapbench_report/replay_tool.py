"""The tool as the replay draws it: a solid of revolution."""
import math

from .json_input import at, number_or_none

ARC_POINTS = 48  # of a rounded tip: off the circle by 0.013 % of its radius


def tool_profile(scenario):
    """Pairs (s, r) in metres: at s along the axis, counted from the tip centre, the radius r; from the far end to the tip.
    None when the scenario's tool has none. A tool of another shape is another list of pairs."""
    diameter, length = (number_or_none(at(scenario, f"/tool/{key}")) for key in ("diameter_m", "length_m"))
    if diameter is None or length is None:
        return None
    radius = diameter / 2
    body = [[-length, 0.0], [-length, radius], [0.0, radius]]
    if at(scenario, "/tool/tip") != "round":
        return [*body, [0.0, 0.0]]
    angles = [math.pi / 2 * i / ARC_POINTS for i in range(1, ARC_POINTS + 1)]
    return body + [[radius * math.sin(a), radius * math.cos(a)] for a in angles]
