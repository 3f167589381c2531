"""How much each field of a sampled sweep matters for a metric, from the sweep's rows alone: Spearman's rank correlation, and the
first-order Sobol index S_i = Var(E[y | x_i]) / Var(y), the share of the metric's variance that the field explains by itself.

E[y | x_i] is a least-squares fit: up to six cosines of the field's place in its range, cos(pi k u) (Plischke, "How to compute
variance-based sensitivity indicators with your spreadsheet software", Environmental Modelling & Software 35, 2012), or for listed
values the mean of each. S_i is the fit's R^2, adjusted for the number of functions (Ezekiel), so that a field without influence
has 0 in the mean. Its standard error is the jackknife's over the rows; a Latin hypercube or a Sobol sequence errs less. What
changes faster than the sixth cosine, as the edge of a jump, is not seen: of a step in the middle a fifteenth."""
from dataclasses import dataclass
from typing import Optional

import numpy as np
from scipy.stats import spearmanr

MOST_COSINES, ROWS_PER_COSINE = 6, 10
LEAST_ROWS = 20


@dataclass(frozen=True)
class Sensitivity:
    rank: Optional[float]  # none for texts, which have no order
    first_order: float
    error: float  # standard error of first_order


def sensitivity(column, place, y):
    """Of y to a field: `column` its values, `place` where they are in the range (0 ... 1), None for listed values. None with too
    few rows, and where either is constant."""
    if len(y) < LEAST_ROWS or np.ptp(y) == 0 or len(set(column)) < 2:
        return None
    if place is None:
        values = sorted(set(column))
        functions = np.array([[float(value == other) for other in values] for value in column])
    else:
        count = min(MOST_COSINES, len(y) // ROWS_PER_COSINE)
        functions = np.column_stack([np.ones(len(y)), np.cos(np.pi * np.outer(place, np.arange(1, count + 1)))])
    share, error = adjusted_share(functions, y)
    return Sensitivity(None if isinstance(column, list) else float(spearmanr(column, y).statistic), share, error)


def adjusted_share(functions, y):
    """The adjusted R^2 of a fit by functions that span the constant, and the jackknife's standard error: without row i the squares
    of the residuals e sum up to less by e_i^2 / (1 - h_i), h_i the row's leverage, those of y - mean by n / (n - 1) (y_i - mean)^2."""
    n, fitted = len(y), functions.shape[1]
    q, _ = np.linalg.qr(functions)
    residual, leverage, off = y - q @ (q.T @ y), (q ** 2).sum(axis=1), y - y.mean()

    def adjusted(residuals, total, rows):
        return 1 - residuals / total * (rows - 1) / (rows - fitted)

    alone = leverage > 1 - 1e-9  # a listed value that one row has: it is fitted without the row, too
    without = np.where(alone, 0.0, residual ** 2 / np.where(alone, 1.0, 1 - leverage))
    each = adjusted(residual @ residual - without, off @ off - n / (n - 1) * off ** 2, n - 1)
    return adjusted(residual @ residual, off @ off, n), float(np.sqrt((n - 1) / n * ((each - each.mean()) ** 2).sum()))
