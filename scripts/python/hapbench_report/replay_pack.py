"""Packs recorded runs for the page: contacts quantised to 16 bits, rows in single precision, base64."""
import base64
import csv
import math
import sys
from array import array
from pathlib import Path

from .json_input import InputError, at, load_object, number_or_none
from .markup import number
from .replay_record import SCENES

# The shell is shown this far around the contacts and the tool's way along them [m].
MARGIN_M = 0.9e-3
TENSOR_COLUMNS = ("sxx", "sxy", "sxz", "syy", "syz", "szz")
# Per row: time, tip, axis, rendered force, S (xx xy xz yy yz zz), ratio range, deepest point.
ROW_COLUMNS = ("time_s", "px_m", "py_m", "pz_m", "axis_x", "axis_y", "axis_z", "fx_N", "fy_N", "fz_N",
               *TENSOR_COLUMNS, "ratio_min", "ratio_max", "depth_max_m")
CONTACT_COLUMNS = ("x_m", "y_m", "z_m", "depth_m", "gradient_x", "gradient_y", "gradient_z", "weight")


def numbers(file, columns):
    """The named columns of a CSV file, row by row."""
    try:
        with file.open(newline="", encoding="utf-8") as text:
            reader = csv.DictReader(text)
            missing = [name for name in columns if name not in (reader.fieldnames or ())]
            if missing:
                raise InputError(f"{file}: line 1: no column {missing[0]}")
            return [[finite(row[name], file, reader.line_num, name) for name in columns] for row in reader]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{file}: cannot be read: {error}") from error


def finite(value, file, line, name):
    """The number; NaN for an empty field, which is how a row without contacts has no ratio."""
    if value == "":
        return math.nan
    try:
        parsed = float(value)
    except (TypeError, ValueError):
        parsed = math.nan
    # Beyond single precision nothing can be drawn either.
    if not abs(parsed) < 1e38:
        raise InputError(f"{file}: line {line}: {name}: got {str(value)[:40]}; allowed: a finite number")
    return parsed


def by_step(file):
    """contacts.csv by step, in the order of the file."""
    rows = {}
    for step, *contact in numbers(file, ("step", *CONTACT_COLUMNS)):
        rows.setdefault(int(step), []).append(contact)
    return rows


class Recording:
    """One algorithm's run through a scene."""

    def __init__(self, directory: Path):
        self.summary = load_object(directory / "summary.json")
        self.scenario = load_object(directory / "scenario.effective.json")
        self.algorithm = directory.name
        measured = [name for name in ROW_COLUMNS if name not in TENSOR_COLUMNS]
        columns = ("step", *measured, "colliding")
        for key in ("diameter_m", "length_m"):
            if number_or_none(at(self.scenario, f"/tool/{key}")) is None:
                raise InputError(f"{directory / 'scenario.effective.json'}: /tool/{key}: missing; allowed: a number")
        self.rows = [dict(zip(columns, row)) for row in numbers(directory / "trajectory.csv", columns)]
        if not self.rows:
            raise InputError(f"{directory / 'trajectory.csv'}: holds no row")
        contacts = by_step(directory / "contacts.csv")
        self.contacts = [contacts.get(int(row["step"]), []) for row in self.rows]
        tensors = directory / "stiffness_tensor.csv"
        of_step = {int(step): tensor for step, *tensor in numbers(tensors, ("step", *TENSOR_COLUMNS))}
        for row in self.rows:
            if int(row["step"]) not in of_step:
                raise InputError(f"{tensors}: no row of step {int(row['step'])}")
            row.update(zip(TENSOR_COLUMNS, of_step[int(row["step"])]))

    def story(self):
        """What became of it, in a few words."""
        force = at(self.summary, "/metrics/force_max_N")
        last = max((row["time_s"] for row in self.rows if row["colliding"] > 0), default=None)
        end = number(self.rows[-1]["time_s"], 3)
        contact = "never in contact" if last is None else f"in contact until {number(last, 3)} s of {end} s"
        outcome = str(self.summary.get("outcome", "")).replace("_", " ")
        return f"{self.algorithm.replace('_', ' ')}: {contact}, {outcome}, largest force {number(force, 3)} N"

    def packed(self):
        flat = [contact for of_row in self.contacts for contact in of_row]
        scales = [max((abs(c[i]) for c in flat), default=0.0) / 32767 or 1.0 for i in range(len(CONTACT_COLUMNS))]
        return {
            "algorithm": self.algorithm,
            "outcome": str(self.summary.get("outcome", "")),
            "end_s": at(self.summary, "/duration_s"),
            "rows": base64_of("f", (row[name] for row in self.rows for name in ROW_COLUMNS)),
            "counts": base64_of("H", (min(int(n), 65535) for row, of_row in zip(self.rows, self.contacts)
                                      for n in (len(of_row), row["colliding"]))),
            "contactScales": scales,
            "contacts": base64_of("h", (round(value / scale) for c in flat for value, scale in zip(c, scales))),
        }


def base64_of(code, values):
    packed = array(code, values)
    if sys.byteorder == "big":
        packed.byteswap()  # the page reads little endian
    return base64.b64encode(packed.tobytes()).decode()


def shell_near(recordings, shell):
    """The points of the shell within MARGIN_M of the box that the contacts and the tips of rows in contact span."""
    places = [contact[:3] for r in recordings for of_row in r.contacts for contact in of_row]
    places += [[row["px_m"], row["py_m"], row["pz_m"]] for r in recordings for row in r.rows if row["colliding"] > 0]
    if not places:
        return shell
    low, high = ([bound(p[i] for p in places) for i in range(3)] for bound in (min, max))
    return [p for p in shell if all(low[i] - MARGIN_M <= p[i] <= high[i] + MARGIN_M for i in range(3))]


def packed_scene(scene, directory: Path):
    recordings = [Recording(directory / name) for name in scene.algorithms if (directory / name).is_dir()]
    if not recordings:
        raise InputError(f"{directory}: holds no recording of {', '.join(scene.algorithms)}")
    shell = shell_near(recordings, numbers(directory / "shell.csv", ("x_m", "y_m", "z_m", "nx", "ny", "nz")))
    scale = max((abs(x) for p in shell for x in p[:3]), default=0.0) / 32767 or 1.0
    scenario = recordings[0].scenario
    orientation = at(scenario, "/motion/orientation") or {}
    return {
        "id": scene.id, "title": scene.title, "speed": scene.speed, "scenario": scene.scenario,
        "note": f"{scene.note} {'; '.join(recording.story() for recording in recordings)}.",
        "planar": all(p[2] == 0 for p in shell),
        "up": orientation.get("up", [0, 0, 1]), "lean": orientation.get("lean", [1, 0, 0]),
        "tool": at(scenario, "/tool"), "stiffness": at(scenario, "/rendering/stiffness_N_per_m"),
        "rowColumns": ROW_COLUMNS, "contactColumns": CONTACT_COLUMNS,
        "shellScale": scale, "shell": base64_of("h", (round(x / scale) for p in shell for x in p[:3])),
        "normals": base64_of("b", (round(127 * x) for p in shell for x in p[3:])),
        "recordings": [recording.packed() for recording in recordings],
    }


def packed_replays(directory: Path):
    return [checked_scene(scene, directory / scene.id) for scene in SCENES if (directory / scene.id).is_dir()]


def checked_scene(scene, directory: Path):
    try:
        return packed_scene(scene, directory)
    except (ValueError, OverflowError) as error:
        # Numbers that no run writes: steps left empty, normals far from unit length.
        raise InputError(f"{directory}: not what hapbench records: {error}") from error
