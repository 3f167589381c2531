"""Compares the program with that of another commit, benchmark by benchmark."""
import contextlib
import os

from .program import BenchError, listed, measured, say
from .significance import ERROR, SMALLEST, compare
from .table import quantity

# Groups whose work is spread over the cores: neither pinned nor judged by the time of one of them.
PARALLEL = ("shell",)


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
