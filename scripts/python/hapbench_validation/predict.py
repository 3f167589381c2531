"""Runs the program: the largest stable K of a sample at each B."""
import json
import math
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict

import numpy as np

from .cases import FOLDER, LEAST, MOST, drawn, overrides, samples_of, units_of

RESOLUTION = 0.02
FEWEST = 8  # samples that a fit must leave
WAVES = 4   # of samples, each around the best of those before
ROUGH = 4   # points by which a wave is judged
WHOLE = 96  # samples that are predicted at all points


class Predictor:
    def __init__(self, program, jobs):
        self.program, self.pool, self.runs = program, ThreadPoolExecutor(jobs), 0

    def edge(self, case, sample, B):
        """The first edge of K from below, in the case's unit: LEAST where even that vibrates, MOST where nothing does."""
        scene = FOLDER / f"{case.scene}.json"
        words = [f"--set={word}" for word in overrides(case, sample, B, json.loads(scene.read_text(encoding="utf-8")))]
        with tempfile.TemporaryDirectory(prefix="hapbench-validation-") as out:
            done = subprocess.run(
                [self.program, "limit", scene, "--vary", "rendering.stiffness_N_per_m", "--between", f"{LEAST * case.unit}:{MOST * case.unit}",
                 "--resolution", str(RESOLUTION), "--json", "--out", out, *words], capture_output=True, text=True, stdin=subprocess.DEVNULL)
        if done.returncode != 0:
            raise RuntimeError(f"{case.name}: {done.stderr.strip()[-500:]}")
        self.runs += 1
        edge = json.loads(done.stdout)["limits"][0]["limit"]
        return LEAST if edge is None else edge / case.unit

    def curves(self, case, samples, points=None):
        """A row of edges for each sample, at the points of these indices or all."""
        B = [case.B[i] for i in (points if points is not None else range(len(case.B)))]
        work = [(sample, b) for sample in samples for b in B]
        edges = list(self.pool.map(lambda one: self.edge(case, *one), work))
        return np.array(edges).reshape(len(samples), len(B))


def rms_error(edges, measured):
    return np.sqrt(np.mean(np.log(edges / measured)**2, axis=1))


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
    within = [i for i in order if errors[i] <= math.log(scatter)]
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
            kept = found[case.fit]["samples"]
            kept = [sample | more for sample, more in zip(kept, drawn(case.more, len(kept), 2) if case.more else [{}] * len(kept))]
            found[case.name] = {"samples": kept, "edges": predictor.curves(case, kept).tolist()}
        never = drawn(space | case.more, FEWEST, 3)
        found[case.name]["unfitted_edges"] = predictor.curves(case, never).tolist()
    return found


def record(program, data, cases, found):
    version = subprocess.run([program, "--version"], capture_output=True, text=True).stdout.strip()
    return {"program": version.rsplit("\n", 1)[-1], "resolution": RESOLUTION, "cases": {
        name: {"B": asdict(cases[name])["B"]} | found[name] for name in cases}}
