"""Runs the program: the largest stable K of a sample at each B, and the period of what vibrates beyond it."""
import csv
import json
import math
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from pathlib import Path

import numpy as np

from .cases import FOLDER, LEAST, MOST, drawn, overrides, samples_of, units_of

RESOLUTION = 0.02
FEWEST = 8  # samples that a fit must leave
WAVES = 10  # of samples, each around the best of those before
ROUGH = 4   # points by which a wave is judged
WHOLE = 96  # samples that are predicted at all points
SEEDS = 3   # sessions of a judged case for each sample that the fit kept: the tremor's phases are never those of the fit


class Predictor:
    def __init__(self, program, jobs):
        self.program, self.pool = program, ThreadPoolExecutor(jobs)

    def run(self, case, sample, B, out, *words):
        sets = [f"--set={word}" for word in overrides(case, sample, B, scene_of(case))]
        done = subprocess.run([self.program, words[0], FOLDER / f"{case.scene}.json", *sets, *words[1:], "--json", "--out", out], capture_output=True, text=True,
                              stdin=subprocess.DEVNULL)
        if done.returncode not in (0, 3):  # 3: it left its bounds, which what is beyond an edge may
            raise RuntimeError(f"{case.name}: {done.stderr.strip()[-500:]}")
        return done.stdout

    def edge(self, case, sample, B):
        """The first edge of K from below, in the case's unit: LEAST where even that vibrates, MOST where nothing does. Of a period,
        that of the run just beyond the edge [s]."""
        with tempfile.TemporaryDirectory(prefix="hapbench-validation-") as out:
            told = json.loads(self.run(case, sample, B, out, "limit", "--vary", "rendering.stiffness_N_per_m", "--between",
                                       f"{LEAST * case.unit}:{MOST * case.unit}", "--resolution", str(RESOLUTION)))["limits"][0]
            if case.quantity == "period":
                beyond = LEAST * case.unit if told["limit"] is None else told["beyond"] or MOST * case.unit
                self.run(case, sample, B, out, "run", f"--set=rendering.stiffness_N_per_m={beyond}")
                return period(Path(out) / "trajectory.csv")
        return LEAST if told["limit"] is None else told["limit"] / case.unit

    def curves(self, case, samples, points=None):
        """A row of edges for each sample, at the points of these indices or all."""
        B = [case.B[i] for i in (points if points is not None else range(len(case.B)))]
        work = [(sample, b) for sample in samples for b in B]
        edges = list(self.pool.map(lambda one: self.edge(case, *one), work))
        return np.array(edges).reshape(len(samples), len(B))


def scene_of(case):
    return json.loads((FOLDER / f"{case.scene}.json").read_text(encoding="utf-8"))


def period(trajectory):
    """The mean time between upward passages of the handle through its mean in the second half of a run [s]."""
    with trajectory.open(encoding="utf-8", newline="") as file:
        rows = [(float(row["time_s"]), float(row["hx_m"])) for row in csv.DictReader(file)]
    times, x = np.array(rows[len(rows) // 2:]).T
    x = x - x.mean()
    up = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    at = times[up] - x[up] * (times[up + 1] - times[up]) / (x[up + 1] - x[up])
    return float(np.diff(at).mean()) if len(at) > 1 else float("nan")


def rms_error(edges, measured):
    return np.sqrt(np.mean(np.log(edges / measured)**2, axis=1))


def largest_error(scatter):
    """By how much the logarithms of two sessions of one setting differ, when each has this scatter (a factor) for itself: a
    prediction is a session too, with a tremor and a bisection of its own."""
    return math.sqrt(2.0) * math.log(scatter)


def fitted(predictor, case, space, samples, scatter):
    """Of many samples those whose whole curve is as close to the measured one as one session is to another. They are looked for
    in waves: the first over the whole ranges, each later one around the best of those before, judged by a few points. The
    best of all waves are then predicted at all points. Where too few are left, the best stay, and that is said."""
    rough = np.rint(np.linspace(0, len(case.B) - 1, ROUGH)).astype(int)
    measured, random = np.array(case.K), np.random.default_rng(1)
    units, errors = np.empty((0, len(space))), np.empty(0)
    for wave in range(WAVES):
        count = samples // WAVES
        if wave == 0:
            new = units_of(space, count)
        else:
            best = units[np.argsort(errors)[:2 * FEWEST]]
            new = best[random.integers(len(best), size=count)] + best.std(axis=0) * random.standard_normal((count, len(space)))
            new = np.abs(np.clip(new, -0.999, 1.999))
            new = np.where(new > 1.0, 2.0 - new, new)
        errors = np.append(errors, rms_error(predictor.curves(case, samples_of(space, new), rough), measured[rough]))
        units = np.vstack([units, new])
    near = np.argsort(errors)[:WHOLE]
    near_samples = samples_of(space, units[near])
    whole = predictor.curves(case, near_samples)
    errors = rms_error(whole, measured)
    order = np.argsort(errors)
    within = [i for i in order if errors[i] <= largest_error(scatter)]
    reached = len(within) >= FEWEST
    kept = within[:4 * FEWEST] if reached else list(order[:FEWEST])
    return {"samples": [near_samples[i] for i in kept], "edges": whole[kept].tolist(), "tried": len(units), "reached": bool(reached),
            "rms_factors": np.exp(errors[kept]).round(4).tolist()}


def predictions(predictor, data, cases, samples, say):
    """For each case the samples, their edges, and the edges of samples that were never fitted."""
    found = {}
    for case in sorted(cases.values(), key=lambda one: one.role != "fitted"):
        space = {name: given for name, given in data["devices"][case.device]["unpublished"].items()}
        if case.role == "fitted":
            say(f"{case.name}: fitting")
            found[case.name] = fitted(predictor, case, space, samples, data["scatter"])
        else:
            say(f"{case.name}: predicting")
            kept = found[case.fit]["samples"] * (SEEDS if "hand" in scene_of(case) else 1)
            fresh = {name: space[name] for name in ("seed",) if name in space} | case.more
            kept = [sample | more for sample, more in zip(kept, drawn(fresh, len(kept), 2))]
            found[case.name] = {"samples": kept, "edges": predictor.curves(case, kept).tolist()}
        never = drawn(space | case.more, FEWEST, 3)
        found[case.name]["unfitted_edges"] = predictor.curves(case, never).tolist()
    return found


def record(program, data, cases, found):
    version = subprocess.run([program, "--version"], capture_output=True, text=True).stdout.strip()
    return {"program": version.rsplit("\n", 1)[-1], "resolution": RESOLUTION, "cases": {
        name: {"B": asdict(cases[name])["B"]} | found[name] for name in cases}}
