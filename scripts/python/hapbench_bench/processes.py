"""Whole runs of the program, as a user waits for them."""
import os
import statistics
import subprocess
import tempfile
import time

from .program import BenchError

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


def run(hapbench, scenarios, overrides=()):
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


def ratios(hapbench):
    """Pairs of CPU times, round by round: what, over what, at most, pairs."""
    recorded, tasks = [], []
    for _ in range(ROUNDS):
        recorded.append((run(hapbench, [TASK])[1], run(hapbench, [TASK], UNRECORDED)[1]))
        tasks.append((run(hapbench, TASKS, UNRECORDED)[1], TASKS_SIMULATE))
    return [(f"`run {TASK}`", "unrecorded", 6.0, recorded),
            ("`run` of tasks 1 to 3, unrecorded", f"the {TASKS_SIMULATE:g} s they simulate", 1 / 60, tasks)]


def limits(hapbench):
    """Rows of name, value, unit and limit."""
    found = []
    for name, overrides in SMALL.items():
        wall = statistics.median(run(hapbench, [name], overrides)[0] for _ in range(ROUNDS))
        found.append((f"`run {name}`, 2000 steps", wall, "s", 0.030))
    memory = run(hapbench, TASKS, UNRECORDED)[2]
    found.append(("memory of tasks 1 to 3", memory, "B", 150e6))
    return found
