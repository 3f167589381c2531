"""The replay of a user's own runs: whatever scene they have, with as many points as a browser draws in a frame."""
import json
import os
import shutil
import subprocess
import tempfile
from functools import lru_cache
from pathlib import Path

import numpy as np

from hapbench.columns import read_columns
from hapbench_report.json_input import at
from hapbench_report.recording import Recording
from hapbench_report.replay import MARGIN, SHELL_COLUMNS, packed_scene, radius_of, touched_box, within
from hapbench_report.sound import LONGEST

# Points drawn: near the contacts, and with the rest.
NEAR, ALL = 5000, 8000
SPEEDS = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 10)  # as in the player's menu
WATCHED_S = 10.0  # how long a replay should take at first
PATIENCE_S = 120


def replays(runs, labels):
    """A packed scene for each environment and tool among the runs."""
    scenes = {}
    for run, label in zip(runs, labels):
        key = json.dumps([run.scenario.get(part) for part in ("environment", "tool")], sort_keys=True)
        scenes.setdefault(key, []).append((run, label))
    return [scene(i, members) for i, members in enumerate(scenes.values())]


def scene(i, members):
    runs, labels = zip(*members)
    recordings = [Recording(run.directory) for run in runs]
    shell, said = points_of(runs[0], recordings)
    longest = max(recording.columns["time_s"][-1] for recording in recordings)
    speed = min(SPEEDS, key=lambda speed: abs(np.log(speed / max(longest / WATCHED_S, 1e-9))))
    if any(len(recording.columns["time_s"]) > LONGEST for recording in recordings):
        said = f"{said} Sound: the first {LONGEST} recorded rows of each run.".strip()
    thinned_out = [recording for recording in recordings if len(recording.shown) < len(recording.columns["time_s"])]
    if thinned_out:
        drawn, every = (sum(map(len, of)) for of in zip(*((r.shown, r.columns["time_s"]) for r in thinned_out)))
        said = f"{said} {drawn} of {every} recorded rows are drawn, every peak among them.".strip()
    names = list(dict.fromkeys(run.name for run in runs))
    return packed_scene(recordings, shell, labels, id=names[0] if i == 0 else f"{names[0]}-{i + 1}",
                        title=", ".join(names), speed=speed, scenario=names[0], note=said)


def points_of(run, recordings):
    """The surface: from the program, or else the points that were in contact; and what to say about it."""
    every, failure = shell(run)
    if every is None:
        touched = {tuple(contact[:3]): contact[8:] for r in recordings for of_row in r.contacts for contact in of_row}
        every = np.array([[*place, *normal] for place, normal in touched.items()]).reshape(-1, 6)
    drawn = thinned(every, touched_box(recordings), MARGIN * radius_of(recordings[0].tool))
    count = f"{len(drawn)} of {len(every)} points of the surface are drawn, all around the contacts first."
    said = [failure] if failure else []
    if at(run.scenario, "/tool/type") == "mesh":
        said.append("Of the tool, a mesh, the silhouette is drawn, turned about its axis; points in the tool are marked "
                    "where contacts were recorded.")
    return drawn.tolist(), " ".join(said + ([count] if len(drawn) < len(every) else []))


def thinned(points, box, margin):
    near = within(points, box, margin)
    kept = some(points[near], NEAR)
    return np.concatenate([kept, some(points[~near], ALL - len(kept))])


def some(points, most):
    """At most so many, spread over all of them. Drawn by lot, as every nth of a grid's points makes stripes."""
    if len(points) <= most:
        return points
    return points[np.sort(np.random.default_rng(1).choice(len(points), most, replace=False))]


def surface_of(runs):
    """The points of the surface that all runs share; None where they do not, or there is none to be had."""
    environments = [run.scenario.get("environment") for run in runs]
    if any(environment != environments[0] for environment in environments) or not environments[0]:
        return None
    points, _ = shell(runs[0])
    return None if points is None else points[:, :3]


def shell(run):
    """Points and normals, None with the reason where there are none to be had."""
    if at(run.scenario, "/environment/type") == "springs":
        return None, ""
    return shell_of(run.directory / "scenario.effective.json")


@lru_cache(maxsize=1)  # curves and replay of a page ask for the same one
def shell_of(scenario):
    program = os.environ.get("HAPBENCH_PROGRAM") or shutil.which("hapbench")
    if not program:
        return None, "Without the program hapbench in the path only points that were in contact are drawn."
    with tempfile.TemporaryDirectory(prefix="hapbench-report-") as scratch:
        file = Path(scratch) / "shell.csv"
        # Whatever the algorithm: it may have come from a plugin that is not at hand.
        plain = ["--set", "rendering.algorithm=mean", "--set", "rendering.parameters={}"]
        line = [program, "validate", str(scenario), "--points", str(file), "--quiet", *plain]
        try:
            done = subprocess.run(line, capture_output=True, text=True, timeout=PATIENCE_S, stdin=subprocess.DEVNULL)
        except (OSError, subprocess.TimeoutExpired) as error:
            return None, f"The surface is not drawn: {error}."
        if done.returncode:
            said = (done.stderr.strip().splitlines() or ["no message"])[-1]
            return None, f"Only points that were in contact are drawn: {said}."
        columns = read_columns(file, SHELL_COLUMNS)
        return np.column_stack([columns[name] for name in SHELL_COLUMNS]), ""
