"""Interactive replay of recorded runs: its data and its markup. The replay shows at most as many recorded rows and
surface points as a browser can draw in a frame. The data are encoded as base64: contacts as 16-bit integers, rows in
single precision."""
import json
import subprocess
import tempfile
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from hapbench.columns import read_columns
from hapbench.errors import InputError
from hapbench.results import at
from hapbench_command import the_program
from hapbench_looks import look

from .markup import ASSETS, embedded_json, fill
from .recording import (
    CONTACT_COLUMNS,
    LONGEST,
    MEASURED_COLUMNS,
    NORMAL_COLUMNS,
    TENSOR_COLUMNS,
    Recording,
    base64_of,
    sound,
    worst_moments,
)

# Largest distance of a shell point from the touched box (touched_box()) at which the point counts as near, in tool
# radii.
MARGIN = 1.8
SHELL_COLUMNS = ("x_m", "y_m", "z_m", *NORMAL_COLUMNS)
# Largest number of drawn shell points near the contacts, and of all drawn shell points.
NEAR, ALL = 5000, 8000
# Speeds of the replay relative to real time; the player's menu offers the same speeds.
SPEEDS = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 10)
WATCHED_S = 10.0  # the initial speed shows the longest recording in about this time [s]
PATIENCE_S = 120


@dataclass(frozen=True, eq=False)
class Surface:
    """Points of the surface that the tools touch."""

    points: np.ndarray  # rows of position [m] and outward normal
    is_solid: bool  # false for an open mesh, whose inside is not defined


def replays(runs, labels):
    """Returns one scene, encoded for the page, for each combination of environment and tool that occurs in the runs."""
    scenes = {}
    for run, label in zip(runs, labels):
        key = json.dumps(
            [run.scenario.get(part) for part in ("environment", "tool")], sort_keys=True
        )
        scenes.setdefault(key, []).append((run, label))
    return [scene(i, *zip(*members)) for i, members in enumerate(scenes.values())]


def scene(i, runs, labels):
    recordings = [Recording(run) for run in runs]
    shell, note = points_of(runs[0], recordings)
    longest = max(recording.columns["time_s"][-1] for recording in recordings)
    if any(len(recording.columns["time_s"]) > LONGEST for recording in recordings):
        note = f"{note} The sound plays the first {LONGEST} recorded steps of each run.".strip()
    subsampled = [
        recording
        for recording in recordings
        if len(recording.shown) < len(recording.columns["time_s"])
    ]
    if subsampled:
        drawn, every = (
            sum(map(len, of)) for of in zip(*((r.shown, r.columns["time_s"]) for r in subsampled))
        )
        note = f"{note} {drawn} of {every} recorded steps are drawn, including every peak.".strip()
    names = list(dict.fromkeys(run.name for run in runs))
    about = {
        "id": names[0] if i == 0 else f"{names[0]}-{i + 1}",
        "title": ", ".join(names),
        "scenario": names[0],
        "note": note,
        "speed": min(SPEEDS, key=lambda speed: abs(np.log(speed / max(longest / WATCHED_S, 1e-9)))),
    }
    try:
        return about | packed_scene(recordings, shell, labels)
    except (ValueError, OverflowError) as error:
        # The files contain values that hapbench never writes, such as empty cells or normals far from unit length.
        raise InputError(f"{runs[0].folder}: not what hapbench records: {error}") from error


def packed_scene(recordings, shell, labels):
    """Returns the scene with these recordings, encoded for the page. `shell`: surface points with their normals; all of
    these points are drawn. `labels`: name of each recording."""
    scale = float(np.abs(shell[:, :3]).max(initial=0.0)) / 32767 or 1.0
    scenario = recordings[0].run.scenario
    orientation = at(scenario, "/motion/orientation") or {}
    springs = at(scenario, "/environment/type") == "springs"
    return {
        "planar": not shell[:, 2].any()
        and not any(tip[2] for r in recordings for tip in r.tips(touching=False)),
        "up": orientation.get("up", [0, 0, 1]),
        "lean": orientation.get("lean", [1, 0, 0]),
        "tool": None if springs else recordings[0].tool,
        "silhouette": at(scenario, "/tool/type") == "mesh",
        "focus": touched_box(recordings),
        "springs": [
            [*group["direction"], group["count"]]
            for group in at(scenario, "/environment/groups") or ()
        ]
        if springs
        else [],
        "contactColumns": CONTACT_COLUMNS,
        "shellScale": scale,
        "shell": base64_of("h", np.rint(shell[:, :3] / scale).astype(int).ravel().tolist()),
        "normals": base64_of("b", np.rint(127 * shell[:, 3:]).astype(int).ravel().tolist()),
        "recordings": [packed_recording(r, label) for r, label in zip(recordings, labels)],
    }


def packed_recording(recording, label):
    flat = [contact for of_row in recording.contacts for contact in of_row]
    width = len(CONTACT_COLUMNS)
    scales = [max((abs(c[i]) for c in flat), default=0.0) / 32767 or 1.0 for i in range(width)]
    appearance = look(recording.run.algorithm)
    colliding = recording.columns["colliding"]
    return {
        "algorithm": recording.run.algorithm,
        "label": label,
        "colour": appearance.colour,
        "dark": appearance.dark,
        "dash": appearance.dash,
        "outcome": recording.run.outcome,
        "end_s": at(recording.run.summary, "/duration_s"),
        "rowColumns": MEASURED_COLUMNS + (TENSOR_COLUMNS if recording.tensors else ()),
        "rows": base64_of("f", (value for row in recording.rows() for value in row)),
        "counts": base64_of(
            "H",
            (
                min(int(n), 65535)
                for row, of_row in zip(recording.shown, recording.contacts)
                for n in (len(of_row), colliding[row])
            ),
        ),
        "contactScales": scales,
        "contacts": base64_of(
            "h", (round(value / scale) for c in flat for value, scale in zip(c, scales))
        ),
        "worst": worst_moments(recording.columns, recording.run.scenario),
        "sound": sound(recording.columns),
    }


def points_of(run, recordings):
    """Returns (drawn points of the surface, note about the drawing). The points come from the program hapbench. If the
    program provides no points, the recorded contact points are used instead."""
    surface, failure = shell(run)
    every = surface and surface.points
    if every is None:
        touched = {
            tuple(contact[:3]): contact[8:]
            for r in recordings
            for of_row in r.contacts
            for contact in of_row
        }
        every = np.array([[*position, *normal] for position, normal in touched.items()]).reshape(
            -1, 6
        )
    radius = max((r for _, r in recordings[0].tool or ()), default=0.0)
    drawn = subset(every, touched_box(recordings), MARGIN * radius)
    count = f"{len(drawn)} of {len(every)} points of the surface are drawn, including all points near contacts."
    notes = [failure] if failure else []
    if at(run.scenario, "/tool/type") == "mesh":
        notes.append(
            "The tool is a mesh: its silhouette is drawn as a solid of revolution. Points inside the tool are marked "
            "if contacts were recorded."
        )
    return drawn, " ".join(notes + ([count] if len(drawn) < len(every) else []))


def touched_box(recordings):
    """Returns the corners of the bounding box of all contact points and of all tip positions in shown rows with
    contact. If no shown row has a contact, returns the corners of the bounding box of all shown tip positions.
    """
    positions = [contact[:3] for r in recordings for of_row in r.contacts for contact in of_row]
    positions += [tip for r in recordings for tip in r.tips(touching=True)]
    positions = positions or [tip for r in recordings for tip in r.tips(touching=False)]
    return [[bound(p[i] for p in positions) for i in range(3)] for bound in (min, max)]


def subset(points, box, margin):
    """Returns at most ALL of the points. Up to NEAR points near the box are selected first. `margin`: largest distance
    from the box, along each axis, of a point that counts as near [m]."""
    low, high = np.array(box)
    near = ((points[:, :3] >= low - margin) & (points[:, :3] <= high + margin)).all(axis=1)
    kept = some(points[near], NEAR)
    return np.concatenate([kept, some(points[~near], ALL - len(kept))])


def some(points, max_count):
    """Returns at most `max_count` points, chosen at random: every n-th point of a grid would form stripes."""
    if len(points) <= max_count:
        return points
    return points[np.sort(np.random.default_rng(1).choice(len(points), max_count, replace=False))]


def surface_of(runs):
    """Returns the Surface that all runs share. Returns None if their environments differ, or if the surface is not
    available."""
    environments = [run.scenario.get("environment") for run in runs]
    if any(environment != environments[0] for environment in environments) or not environments[0]:
        return None
    return shell(runs[0])[0]


def shell(run):
    """Returns (Surface, empty text), or (None, reason) if the surface is not available. A scene of springs has no
    surface and gives no reason."""
    if at(run.scenario, "/environment/type") == "springs":
        return None, ""
    return shell_of(run.folder / "scenario.effective.json")


@lru_cache(maxsize=4)  # cached, because the curves and the replay of a page use the same surfaces
def shell_of(scenario):
    program = the_program()
    if not program:
        return (
            None,
            "Only points that were in contact are drawn, because the program hapbench was not found in PATH.",
        )
    with tempfile.TemporaryDirectory(prefix="hapbench-report-") as scratch:
        file = Path(scratch) / "shell.csv"
        # Replaces the algorithm, because the algorithm may belong to a module that is not available. The surface does
        # not depend on the algorithm.
        plain = ["--set", "rendering.algorithm=mean", "--set", "rendering.parameters={}"]
        line = [program, "validate", str(scenario), "--points", str(file), "--json", *plain]
        try:
            done = subprocess.run(
                line, capture_output=True, text=True, timeout=PATIENCE_S, stdin=subprocess.DEVNULL
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            return None, f"The surface is not drawn: {error}."
        if done.returncode:
            message = (done.stderr.strip().splitlines() or ["no message"])[-1]
            return None, f"Only points that were in contact are drawn: {message}."
        columns = read_columns(file, SHELL_COLUMNS)
        points = np.column_stack([columns[name] for name in SHELL_COLUMNS])
        closed = at(json.loads(done.stdout), "/0/environment/closed")
        return Surface(points, closed is not False), ""


def player(scenes):
    """Returns the replay's markup and data as HTML. A page contains at most one replay."""
    sides = "".join(fill(ASSETS / "replay_side.html", {"which": which}) for which in "ABCD")
    return (
        fill(ASSETS / "replay.html", {"sides": sides})
        + f'<script type="application/json" id="replay-data">{embedded_json(scenes)}</script>'
    )
