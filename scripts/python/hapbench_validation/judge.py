"""The validation metric of ASME V&V 20: the error of a prediction against its uncertainty, on logarithms."""
import math
from dataclasses import dataclass

import numpy as np

COVERAGE = 2.0  # of a standard uncertainty: 95 %
SHARE = 0.9     # of a curve's points that must be within


@dataclass
class Point:
    B: float
    measured: float
    predicted: float      # median of the samples
    low: float            # least and largest of the samples
    high: float
    error: float          # ln(predicted / measured)
    uncertainty: float    # standard, combined
    by_input: float       # its part that comes from what was not published

    @property
    def by_measuring(self):
        return math.sqrt(self.uncertainty**2 - self.by_input**2)

    @property
    def within(self):
        return abs(self.error) <= COVERAGE * self.uncertainty


def points_of(case, edges, resolution):
    """u_val^2 = u_D^2 + u_input^2 + u_num^2: scatter of sessions and rounding of readings, spread of the samples, bisection. No
    prediction counts as lower than half a reading, below which the measurement says 0."""
    points = []
    edges = np.maximum(np.array(edges), 0.5 * case.reading)
    for B, K, column in zip(case.B, case.K, edges.T):
        logs = np.log(column)
        by_input = float(logs.std(ddof=1))
        parts = (math.log(case.scatter), case.reading / K / math.sqrt(12.0), by_input, math.log1p(resolution) / math.sqrt(12.0))
        points.append(Point(B, K, float(np.exp(np.median(logs))), float(column.min()), float(column.max()),
                            float(np.median(logs) - math.log(K)), math.hypot(*parts), by_input))
    return points


def verdict(case, points, reached):
    """(word, sentence) by rule."""
    inside = sum(point.within for point in points)
    said = f"{inside} of {len(points)} points within their uncertainty"
    if case.role == "fitted":
        return ("fitted" if reached else "fit fails"), said + ("" if reached else "; too few samples are as close as two sessions are")
    if not reached:
        return "not judged", said + f"; the fit to {case.fit} failed"
    if inside < SHARE * len(points):
        return "fails", said
    factor = math.exp(COVERAGE * float(np.median([point.uncertainty for point in points])))
    # Where the inputs leave more open than measuring does, the comparison tests less than the measurement could.
    weak = np.median([point.by_input for point in points]) > np.median([point.by_measuring for point in points])
    return ("agrees, weakly" if weak else "agrees"), f"{said}, which lets pass an error of x{factor:.1f}"
