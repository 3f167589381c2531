"""Scores: for each axis the geometric mean over its scenes, of each seed; their geometric mean over the seeds, with a 95 % interval."""
import math
from dataclasses import dataclass
from statistics import fmean, stdev

from scipy.stats import t as student


@dataclass(frozen=True)
class Score:
    axis: object
    value: float
    low: float  # 95 % interval of the mean over seeds; the value itself where no seed matters
    high: float
    worst: float  # of all seeds
    failed: int  # numbers that count as failed
    logs: tuple  # the logarithm of each seed's score

    @property
    def spread(self):
        return stdev(self.logs) if len(self.logs) > 1 else 0.0


def flat(summary):
    """The numbers of a summary.json by their dotted names."""
    found = {}

    def add(value, path):
        if isinstance(value, dict):
            for key, part in value.items():
                add(part, f"{path}.{key}" if path else key)
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            found[path] = value

    add(summary["metrics"], "")
    for section, value in summary.items():
        if isinstance(value, dict) and section not in ("metrics", "provenance", "tolerances", "divergence"):
            add(value, section)
    return found


def row_of(summary, seed):
    return {"seed": seed, "outcome": summary["outcome"], "failed": not summary["expected"], "state_hash": summary["state_hash"],
            "numbers": flat(summary)}


def numbers_of(axis, parts, seed):
    """The number of each of the axis's scenes and limits for a seed, None where it failed."""
    for place, metric in axis.values:
        part = parts[place]
        if metric is None:
            yield part["limit"]["felt_N_per_m"]
            continue
        row = part["rows"][min(seed, len(part["rows"]) - 1)]
        yield None if row["failed"] else row["numbers"].get(metric)


def score(axis, parts, seeds):
    logs, failed = [], 0
    for seed in range(seeds):
        numbers = list(numbers_of(axis, parts, seed))
        failed += sum(number is None for number in numbers)
        logs.append(fmean(math.log(axis.cut(number)) for number in numbers))
    mean = fmean(logs)
    half = student.ppf(0.975, seeds - 1) * stdev(logs) / math.sqrt(seeds) if seeds > 1 else 0.0
    worst = min(logs) if axis.more_is_better else max(logs)
    return Score(axis, math.exp(mean), math.exp(mean - half), math.exp(mean + half), math.exp(worst), failed, tuple(logs))


def tremor_bands(suite, felt):
    """The stiffness felt at rest and by a hand that trembles, below and above 30 Hz [N/m]; empty where a run failed. In a band the mean of
    the logarithms by d omega / omega^2, as in Bode's integral: of frequencies an octave apart, by 1 / omega."""
    if any(value is None for value in felt.values()):
        return {}

    def mean(frequencies):
        return math.exp(sum(math.log(felt[str(f)]) / f for f in frequencies) / sum(1 / f for f in frequencies))

    return {"rest": felt[str(suite.tremor["rest_Hz"])], "low": mean(suite.tremor["low_Hz"]), "high": mean(suite.tremor["high_Hz"])}


def pareto(rows):
    """Of lists of scores, each of the same axes: True where no other is as good in all axes and better in one."""
    def beats(a, b):
        return (not any(y.axis.better(y.value, x.value) for x, y in zip(a, b))
                and any(x.axis.better(x.value, y.value) for x, y in zip(a, b)))

    return [not any(beats(other, own) for other in rows if other is not own) for own in rows]


def leads(rows, own, i):
    """Whether no row of scores is better on axis i than this one."""
    return not any(other[i].axis.better(other[i].value, own[i].value) for other in rows)


def agrees(submitted, held_back):
    """Whether scores of other seeds are what the submitted ones let expect, to one in a thousand: Student's t of the difference of
    two means of one spread."""
    n, k = len(submitted.logs), len(held_back.logs)
    allowed = student.ppf(0.9995, max(1, n - 1)) * submitted.spread * math.sqrt(1 / n + 1 / k)
    return abs(fmean(submitted.logs) - fmean(held_back.logs)) <= allowed + 1e-9
