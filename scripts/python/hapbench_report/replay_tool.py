"""The tool as the replay draws it: a solid of revolution."""
import math

from .json_input import at, number_or_none

def is_list_of_pairs(value):
    return isinstance(value, list) and all(isinstance(pair, list) and len(pair) == 2 for pair in value)


ARC_POINTS = 48  # of a rounded tip: off the circle by 0.013 % of its radius


def tool_profile(scenario, summary):
    """Pairs (s, r) in metres: at s along the axis, counted from the tip centre, the radius r; from the far end to the tip.
    A cylinder's follows from the scenario, that of any other tool is in the run's summary; of a mesh it is the
    silhouette. None when there is neither."""
    outline = at(summary, "/tool/outline_m")
    if outline is not None:
        pairs = [[number_or_none(x) for x in pair] for pair in outline] if is_list_of_pairs(outline) else []
        return pairs if len(pairs) > 1 and None not in sum(pairs, []) else None
    diameter, length = (number_or_none(at(scenario, f"/tool/{key}")) for key in ("diameter_m", "length_m"))
    if diameter is None or length is None:
        return None
    radius = diameter / 2
    body = [[-length, 0.0], [-length, radius], [0.0, radius]]
    if at(scenario, "/tool/tip") != "round":
        return [*body, [0.0, 0.0]]
    angles = [math.pi / 2 * i / ARC_POINTS for i in range(1, ARC_POINTS + 1)]
    return body + [[radius * math.sin(a), radius * math.cos(a)] for a in angles]
