"""Whether two programs differ in speed, from their times in rounds in which they took turns."""
import math
from dataclasses import dataclass

import numpy as np
from scipy import stats

# The chance that a comparison of two equal programs calls any of its benchmarks faster or slower.
ERROR = 0.05
# Less than this comes with where the linker happens to put the code, whatever has been changed.
SMALLEST = 0.02


@dataclass(frozen=True)
class Comparison:
    old_s: float
    new_s: float
    ratio: float  # new over old, geometric mean of the rounds
    low: float  # its 95 % interval
    high: float
    p: float  # that equal programs look as different, for as many benchmarks as are compared
    verdict: str


def compare(old, new, benchmarks):
    """Student's t test of the logarithms of the rounds' ratios being zero on average, times the number of benchmarks
    (Bonferroni). Both times of a round have the same minute's machine, so that their ratio is free of its drift. Why not a
    rank test (Wilcoxon, Mann-Whitney): after ten rounds none can fall below p = 0.002, which no correction for eighty
    benchmarks survives. Rounds in which something else took the core widen the interval: that makes the test cautious,
    not wrong."""
    logs = np.log(np.asarray(new) / np.asarray(old))
    mean, error = logs.mean(), stats.sem(logs)
    half = stats.t.ppf(0.975, len(logs) - 1) * error
    p = 1.0 if error == 0 and mean == 0 else 0.0 if error == 0 else min(1.0, benchmarks * stats.ttest_1samp(logs, 0.0).pvalue)
    ratio = math.exp(mean)
    differs = p < ERROR and abs(ratio - 1) >= SMALLEST
    verdict = ("faster" if ratio < 1 else "slower") if differs else "same"
    return Comparison(float(np.median(old)), float(np.median(new)), ratio, math.exp(mean - half), math.exp(mean + half),
                      float(p), verdict)
