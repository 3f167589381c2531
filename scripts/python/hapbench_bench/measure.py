"""Measures everything that the table of targets and the figure of growth show, as one JSON value."""
import datetime
import os
import statistics
import subprocess
import tempfile
import time

from .program import BenchError, measured, say
from .targets import BYTES_PER_POINT, DEADLINE, GROUPS, LARGEST, LARGEST_SHELL, LATENCIES, SIZES_OF_MEMORY

REPETITIONS = 15
GROWTH_REPETITIONS = 3  # one, where one takes seconds
LARGE = 1_000_000
# Whole runs of the program, as a user waits for them.
ROUNDS = 5
UNRECORDED = ("record.trajectory=false", "record.ratio_iterations=[]", "record.ideal_trajectory=false")
TASKS = ("poke_on_flat", "rotate_in_hole", "round_the_wall")
TASKS_SIMULATE = 65.0  # [s]
TASK = "task2_rotate_signed_distance"
SMALL = {
    "single_spring": ("time.steps=2000",),
    "peg_in_hole_2d_shaped_stiffness": ("time.steps=2000", "time.stop_when=[]", "record.ratio_iterations=[]",
                                        "expect.outcome=completes"),
}


def rounded(value):
    """Four digits: more would be noise."""
    return float(f"{value:.4g}")


def ratio(what, over, at_most, pairs):
    """The median of the pairs' ratios and their quartiles; the time is that of one `what`."""
    values = [a / b for a, b in pairs]
    low, middle, high = statistics.quantiles(values, n=4, method="inclusive")
    return {"what": what, "over": over, "ratio": rounded(middle), "low": rounded(low), "high": rounded(high),
            "seconds": rounded(statistics.median(a for a, _ in pairs)), "at_most": at_most}


def limit(what, value, unit, at_most):
    return {"what": what, "value": rounded(value), "unit": unit, "at_most": at_most}


def ratios_of(program, rows):
    names = list(dict.fromkeys(name for row in rows for name in (row.what, row.over)))
    _, found = measured(program, names, repetitions=REPETITIONS)
    for row in rows:
        clock = "wall_s" if row.wall else "cpu_s"
        pairs = [(a[clock], row.times * b[clock]) for a, b in zip(found[row.what], found[row.over])]
        yield ratio(f"`{row.what}`", row.label, row.at_most, pairs)


def latencies(program):
    names = {f"latency/{name}": at_most for name, at_most in LATENCIES.items()}
    _, found = measured(program, list(names))
    for name, at_most in names.items():
        counters = found[name][0]
        yield limit(f"`{name}`, 99.9 % of the steps", counters["p99_9_s"], "s", at_most)
        yield limit(f"`{name}`, the longest step", counters["longest_s"], "s", DEADLINE)


def growth_of(program, names, options):
    """A point of the figure for each benchmark growth/PART/SIZE."""
    found = {}
    for large, repetitions in ((False, GROWTH_REPETITIONS), (True, 1)):
        some = [name for name in names if (int(name.rpartition("/")[2]) >= LARGE) == large]
        if some:
            found |= measured(program, some, *options, repetitions=repetitions, interleaved=False)[1]
    for name, entries in found.items():
        part, _, size = name.removeprefix("growth/").rpartition("/")
        clock = "wall_s" if part == "shell" else "cpu_s"
        point = {"part": part, "size": int(size), "seconds": rounded(statistics.median(e[clock] for e in entries))}
        for counter in ("points", "contacts", "bytes_per_point", "longest_s"):
            if counter in entries[0]:
                point[counter] = rounded(statistics.median(e[counter] for e in entries))
        yield point


def limits_of_growth(growth, shell_s):
    """Limits on the growth over shell points: memory, and at the largest shell its time and the longest step."""
    by_name = {f"growth/{point['part']}/{point['size']}": point for point in growth}
    few, many = (by_name[name] for name in SIZES_OF_MEMORY)
    bytes_ = [point["bytes_per_point"] * point["points"] for point in (few, many)]
    yield limit("memory to build a shell, for each further point", (bytes_[1] - bytes_[0]) / (many["points"] - few["points"]),
                "B", BYTES_PER_POINT)
    largest = by_name.get(f"growth/shell/{LARGEST}")
    if largest:
        yield limit(f"`growth/shell/{LARGEST}` over `shell/build`", largest["seconds"] / shell_s, "", LARGEST_SHELL)
        yield limit(f"`growth/list_rebuild/{LARGEST}`, the longest",
                    by_name[f"growth/list_rebuild/{LARGEST}"]["longest_s"], "s", DEADLINE)


def performance(bench, hapbench, growing, options):
    """`growing`: names of the benchmarks of growth; `options`: of the program, for them."""
    context, _ = measured(bench, ["step/free_air"])
    ratios, limits = [], []
    for rows in GROUPS:
        say(", ".join(row.what for row in rows))
        ratios += ratios_of(bench, rows)
    say("single steps")
    limits += latencies(bench)
    say("whole runs")
    ratios += [ratio(*row) for row in ratios_of_runs(hapbench)]
    limits += [limit(*row) for row in limits_of_runs(hapbench)]
    say("growth")
    growth = list(growth_of(bench, growing, options))
    shell_s = next(row["seconds"] for row in ratios if row["what"] == "`shell/build`")
    limits += limits_of_growth(growth, shell_s)
    return {
        "commit": context["commit"],
        "date": datetime.date.today().isoformat(),
        "machine": {"cpu": context["cpu"], "processors": context["num_cpus"], "instruction_set": context["instruction_set"],
                    "compiler": context["compiler"], "flags": context["flags"]},
        "repetitions": REPETITIONS,
        "ratios": ratios,
        "limits": limits,
        "growth": growth,
    }


def timed(hapbench, scenarios, overrides=()):
    """Wall and CPU time [s] and peak memory [bytes] of `hapbench run`."""
    with tempfile.TemporaryDirectory(prefix="hapbench-bench-") as out:
        words = [hapbench, "run", *scenarios, "--quiet", "--out", out, *(f"--set={text}" for text in overrides)]
        start = time.monotonic()
        process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        said = process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.monotonic() - start
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise BenchError(f"{' '.join(map(str, words))}: {said.strip() or process.returncode}")
    return wall, usage.ru_utime + usage.ru_stime, 1024 * usage.ru_maxrss


def ratios_of_runs(hapbench):
    """Pairs of CPU times, round by round: what, over what, at most, pairs."""
    recorded, tasks = [], []
    for _ in range(ROUNDS):
        recorded.append((timed(hapbench, [TASK])[1], timed(hapbench, [TASK], UNRECORDED)[1]))
        tasks.append((timed(hapbench, TASKS, UNRECORDED)[1], TASKS_SIMULATE))
    return [(f"`run {TASK}`", "unrecorded", 6.0, recorded),
            ("`run` of tasks 1 to 3, unrecorded", f"the {TASKS_SIMULATE:g} s they simulate", 1 / 60, tasks)]


def limits_of_runs(hapbench):
    """Rows of name, value, unit and limit."""
    found = []
    for name, overrides in SMALL.items():
        wall = statistics.median(timed(hapbench, [name], overrides)[0] for _ in range(ROUNDS))
        found.append((f"`run {name}`, 2000 steps", wall, "s", 0.030))
    memory = timed(hapbench, TASKS, UNRECORDED)[2]
    found.append(("memory of tasks 1 to 3", memory, "B", 150e6))
    return found
