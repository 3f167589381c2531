"""Packs recorded runs for the page: contacts quantised to 16 bits, rows in single precision, base64."""
from pathlib import Path

from hapbench_looks import look

from .binary import base64_of
from .json_input import InputError, at
from .replay_read import CONTACT_COLUMNS, MEASURED_COLUMNS, NORMAL_COLUMNS, TENSOR_COLUMNS, Recording, numbers
from .replay_record import SCENES
from .replay_rows import worst_moments
from .replay_sound import sound

# The shell is shown this far around the contacts and the tool's way along them, in units of the tool's radius.
MARGIN = 1.8
SHELL_COLUMNS = ("x_m", "y_m", "z_m", *NORMAL_COLUMNS)


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


def within(point, box, margin):
    return all(box[0][i] - margin <= point[i] <= box[1][i] + margin for i in range(3))


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
    shell = zip(*numbers(directory / "shell.csv", SHELL_COLUMNS).values())
    return packed_scene(recordings, [p for p in shell if within(p, box, margin)], id=scene.id, title=scene.title,
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
