"""Compares the program with that of another commit, benchmark by benchmark."""
import contextlib
import math
import os
from dataclasses import dataclass

import numpy as np
from scipy import stats

from .program import BenchError, listed, measured, say
from .table import quantity

# Groups whose work is spread over the cores: neither pinned nor judged by the time of one of them.
PARALLEL = ("shell",)
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


@contextlib.contextmanager
def on_one_core():
    """Processes started in here stay on the last of our cores."""
    allowed = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(allowed)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, allowed)


def groups(old, new, chosen):
    """Benchmarks that both programs have, by the first part of their names, and those that only one has."""
    ours, theirs = ([name for name in listed(program) if chosen(name)] for program in (new, old))
    common = [name for name in ours if name in theirs]
    if not common:
        raise BenchError("no benchmark of that name in both programs; see hapbench_bench --benchmark_list_tests")
    by_group = {}
    for name in common:
        by_group.setdefault(name.split("/")[0], []).append(name)
    return by_group, [n for n in theirs if n not in common], [n for n in ours if n not in common]


def round_of(programs, names, parallel):
    """A time of each benchmark for each program [s], the programs one right after the other."""
    clock = "wall_s" if parallel else "cpu_s"
    with contextlib.nullcontext() if parallel else on_one_core():
        return [{name: entries[0][clock] for name, entries in measured(program, names)[1].items()} for program in programs]


def comparisons(old, new, by_group, rounds):
    """A Comparison for each benchmark."""
    times = {name: ([], []) for names in by_group.values() for name in names}
    for k in range(rounds):
        say(f"round {k + 1} of {rounds}")
        for group, names in by_group.items():
            # Who goes first changes from round to round, so that neither gains from a machine that slows down.
            order = (old, new) if k % 2 == 0 else (new, old)
            found = dict(zip(order, round_of(order, names, group in PARALLEL)))
            for name in names:
                for program, series in zip((old, new), times[name]):
                    series.append(found[program][name])
    return {name: compare(*series, len(times)) for name, series in times.items()}


def report(found, only_old, only_new, rounds):
    """The table as text."""
    width = max(map(len, found))
    lines = [f"{'benchmark':{width}}  {'before':>8}  {'now':>8}  now/before (95 %)       p        verdict"]
    for name, c in found.items():
        interval = f"{c.ratio:.3f} ({c.low:.3f}..{c.high:.3f})"
        lines.append(f"{name:{width}}  {quantity(c.old_s, 's'):>8}  {quantity(c.new_s, 's'):>8}  {interval:22}  {c.p:<7.1g}  {c.verdict}")
    counts = ", ".join(f"{sum(c.verdict == v for c in found.values())} {v}" for v in ("faster", "slower", "same"))
    lines += ["", f"{counts} in {rounds} rounds. Judged by a t test of the rounds' log ratios: p < {ERROR:g} of",
              f"any false verdict (Bonferroni); what differs by less than {SMALLEST:.0%} is the same."]
    for which, names in (("before", only_old), ("now", only_new)):
        if names:
            lines.append(f"only {which}: {', '.join(names)}")
    return "\n".join(lines)
