"""The interactive replay: recorded runs, packed for the page (contacts quantised to 16 bits, rows in single precision, base64),
and its markup."""
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hapbench_looks import look

from .json_input import InputError, at
from .markup import ASSETS, command, embedded_json, fill, text
from .recording import CONTACT_COLUMNS, MEASURED_COLUMNS, NORMAL_COLUMNS, TENSOR_COLUMNS, Recording, numbers, worst_moments
from .sound import base64_of, sound

# The shell is shown this far around the contacts and the tool's way along them, in units of the tool's radius.
MARGIN = 1.8
SHELL_COLUMNS = ("x_m", "y_m", "z_m", *NORMAL_COLUMNS)


@dataclass(frozen=True)
class Scene:
    id: str
    title: str
    scenario: str
    algorithms: tuple  # the first two are shown side by side at first
    settings: tuple  # further overrides
    speed: float  # of the replay at first, in units of real time
    note: str


SCENES = (
    Scene("task2_rotate", "Task 2: the drill is rotated in the hole (3-D)", "task2_rotate_signed_distance",
          ("original_averaging", "shaped_stiffness"), ("time.duration_s=6",), 0.5,
          "One period of the tilt, the same hand pressing the drill into the hole."),
    Scene("peg_in_hole_2d", "The peg in a hole of its own width (2-D)", "peg_in_hole_2d_shaped_stiffness",
          ("original_averaging", "shaped_stiffness", "summation", "mean", "exact_shaping"), (), 0.05,
          "The scene of appendix A.1: the peg is tilted at constant speed and nobody holds it."),
)

# Beside the trajectory; every step, for the sound and the peaks.
RECORDED = ("record.contacts=true", "record.stiffness_tensor=true", "record.every=1")

# The bundled expectations are for the scenario's own algorithm; another one may miss them.
SUCCESS, UNEXPECTED_OUTCOME = 0, 3


def record_replays(program: Path, out: Path):
    for scene in SCENES:
        for algorithm in scene.algorithms:
            settings = (*RECORDED, "record.ratio_iterations=[]",
                        f"rendering.algorithm={algorithm}", *scene.settings)
            call(program, "run", scene.scenario, *overrides(settings), "--out", out / scene.id / algorithm)
        call(program, "validate", scene.scenario, "--quiet", "--points", out / scene.id / "shell.csv")


def overrides(settings):
    return [argument for setting in settings for argument in ("--set", setting)]


def rerun_commands(scene):
    """The commands that make one recording."""
    settings = " ".join(overrides((*RECORDED, *scene.settings)))
    return [f"hapbench run {scene.scenario} {settings} --set rendering.algorithm={scene.algorithms[0]} --out {scene.id}",
            f"hapbench validate {scene.scenario} --points shell.csv"]


def call(program, *arguments):
    line = [str(program), *map(str, arguments), "--quiet"]
    try:
        done = subprocess.run(line, capture_output=True, text=True, timeout=600, stdin=subprocess.DEVNULL)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise InputError(f"{program}: {error}") from error
    if done.returncode not in (SUCCESS, UNEXPECTED_OUTCOME):
        said = done.stderr.strip().splitlines() or ["no message"]
        raise InputError(f"{program} {arguments[0]} {arguments[1]}: exit status {done.returncode}: {said[-1]}")


def packed_recording(recording, label):
    flat = [contact for of_row in recording.contacts for contact in of_row]
    width = len(CONTACT_COLUMNS)
    scales = [max((abs(c[i]) for c in flat), default=0.0) / 32767 or 1.0 for i in range(width)]
    own = look(recording.algorithm)
    colliding = recording.columns["colliding"]
    return {
        "algorithm": recording.algorithm, "label": label, "colour": own.colour, "dark": own.dark, "dash": own.dash,
        "outcome": str(recording.summary.get("outcome", "")),
        "end_s": at(recording.summary, "/duration_s"),
        "rowColumns": MEASURED_COLUMNS + (TENSOR_COLUMNS if recording.tensors else ()),
        "rows": base64_of("f", (value for row in recording.rows() for value in row)),
        "counts": base64_of("H", (min(int(n), 65535) for row, of_row in zip(recording.shown, recording.contacts)
                                  for n in (len(of_row), colliding[row]))),
        "contactScales": scales,
        "contacts": base64_of("h", (round(value / scale) for c in flat for value, scale in zip(c, scales))),
        "worst": worst_moments(recording.columns, recording.scenario),
        "sound": sound(recording.columns),
    }


def touched_box(recordings):
    """Corners of the box that the contacts and the tips of rows in contact span; of all tips where nothing touched."""
    places = [contact[:3] for r in recordings for of_row in r.contacts for contact in of_row]
    places += [tip for r in recordings for tip in r.tips(touching=True)]
    places = places or [tip for r in recordings for tip in r.tips(touching=False)]
    return [[bound(p[i] for p in places) for i in range(3)] for bound in (min, max)]


def within(points, box, margin):
    """Which points, with or without normals, are in the box or no further from it than the margin along any axis."""
    low, high = np.array(box)
    return ((points[:, :3] >= low - margin) & (points[:, :3] <= high + margin)).all(axis=1)


def radius_of(profile):
    return max((r for _, r in profile or ()), default=0.0)


def packed_scene(recordings, shell, labels=None, **about):
    """`shell`: points with their normals, all of which are drawn. `about`: id, title, speed, scenario and note."""
    places = [place for p in shell for place in p[:3]]
    scale = max(map(abs, places), default=0.0) / 32767 or 1.0
    scenario = recordings[0].scenario
    orientation = at(scenario, "/motion/orientation") or {}
    springs = at(scenario, "/environment/type") == "springs"
    return {
        **about,
        "planar": is_planar(recordings, shell),
        "up": orientation.get("up", [0, 0, 1]), "lean": orientation.get("lean", [1, 0, 0]),
        "tool": None if springs else recordings[0].tool, "silhouette": at(scenario, "/tool/type") == "mesh", "focus": touched_box(recordings),
        "springs": [[*group["direction"], group["count"]] for group in at(scenario, "/environment/groups") or ()] if springs else [],
        "contactColumns": CONTACT_COLUMNS,
        "shellScale": scale, "shell": base64_of("h", (round(x / scale) for x in places)),
        "normals": base64_of("b", (round(127 * x) for p in shell for x in p[3:])),
        "recordings": [packed_recording(r, label) for r, label in zip(recordings, labels or [None] * len(recordings))],
    }


def is_planar(recordings, shell):
    return all(p[2] == 0 for p in shell) and all(tip[2] == 0 for r in recordings for tip in r.tips(touching=False))


def recorded_scene(scene, directory: Path):
    """One of the thesis's."""
    recordings = [Recording(directory / name) for name in scene.algorithms if (directory / name).is_dir()]
    if not recordings:
        raise InputError(f"{directory}: holds no recording of {', '.join(scene.algorithms)}")
    for recording in recordings:
        if not recording.tool:
            raise InputError(f"{directory / recording.algorithm / 'scenario.effective.json'}: /tool/diameter_m: missing, or "
                             "length_m; allowed: numbers")
    box, margin = touched_box(recordings), MARGIN * radius_of(recordings[0].tool)
    shell = np.column_stack(list(numbers(directory / "shell.csv", SHELL_COLUMNS).values()))
    return packed_scene(recordings, shell[within(shell, box, margin)].tolist(), id=scene.id, title=scene.title,
                        speed=scene.speed, scenario=scene.scenario,
                        note=f"{scene.note} {'; '.join(recording.story() for recording in recordings)}.")


def packed_replays(directory: Path):
    return [checked_scene(scene, directory / scene.id) for scene in SCENES if (directory / scene.id).is_dir()]


def checked_scene(scene, directory: Path):
    try:
        return recorded_scene(scene, directory)
    except (ValueError, OverflowError) as error:
        # Numbers that no run writes: steps left empty, normals far from unit length.
        raise InputError(f"{directory}: not what hapbench records: {error}") from error


def replay_section(scenes):
    if not scenes:
        return '<p class="note">No recorded runs were given (<code>--program</code> or <code>--replay</code>).</p>'
    shown = {scene["id"] for scene in scenes}
    commands = "".join(f"<p>{text(scene.title)}:</p>" + command("\n".join(rerun_commands(scene)))
                       for scene in SCENES if scene.id in shown)
    return (f"<p>Recorded runs, several algorithms on one clock.</p>{player(scenes)}"
            f"<details><summary>How these were recorded</summary>{commands}</details>")


def player(scenes):
    """The replay's markup and data. A page holds one."""
    sides = "".join(fill(ASSETS / "replay_side.html", {"which": which}) for which in "ABCD")
    return (fill(ASSETS / "replay.html", {"sides": sides})
            + f'<script type="application/json" id="replay-data">{embedded_json(scenes)}</script>')
