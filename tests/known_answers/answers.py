"""Known answers: each answer compares a printed number with a closed form, or with a computation that shares no code
with hapbench. Most answers also contain a naive value: the number that a plausible but wrong definition of the field
gives. The comparison must reject the naive value. Each scene gives many answers from few runs."""
import csv
import json
import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fixture import PROGRAM, SOURCE, must

SCENES = {}


@dataclass(frozen=True)
class Within:
    """A tolerance with its reason. The relative tolerance is a fraction of the largest known value in a series."""

    why: str
    relative: float = 0.0
    absolute: float = 0.0


EXACT = Within("the same number, text or count")
ROUNDING = Within(
    "sums of products of numbers known to 1e-15, cancelled by less than 1e3",
    relative=1e-12,
    absolute=1e-18,
)


@dataclass(frozen=True)
class Answer:
    scene: str
    field: str
    known_by: str
    within: Within
    known: object
    printed: object
    naive: tuple = None  # (description, value) of a wrong definition of the field

    def faults(self):
        if not same(self.printed, self.known, self.within):
            yield (
                f"{self.field} in {self.scene}: printed {shown(self.printed)}, known "
                f"{shown(self.known)} ({self.known_by})"
            )
        if self.naive and same(self.naive[1], self.known, self.within):
            yield (
                f"{self.field} in {self.scene}: does not tell the naive answer "
                f"({self.naive[0]}) from {shown(self.known)}"
            )


def shown(value):
    return (
        f"{len(value)} values {value[:3]} ..."
        if isinstance(value, (list, np.ndarray)) and len(value) > 6
        else repr(value)
    )


def same(value, known, within):
    if known is None or value is None or isinstance(known, (str, bool)):
        return value is None if known is None else type(value) is type(known) and value == known
    if isinstance(known, (list, tuple)) and len(value) != len(known):
        return False
    if isinstance(known, (list, tuple)) and any(isinstance(k, (str, type(None))) for k in known):
        return all(same(v, k, within) for v, k in zip(value, known))
    value, known = np.asarray(value, float), np.asarray(known, float)
    allowed = within.absolute + within.relative * np.fmax.reduce(
        np.abs(known), axis=None, initial=0.0
    )
    return value.shape == known.shape and np.allclose(
        value, known, rtol=0.0, atol=allowed, equal_nan=True
    )  # empty cells are NaN


class Table:
    """A CSV file. Columns are arrays of numbers (NaN for empty cells) or lists of texts."""

    def __init__(self, file):
        self.name = Path(file).name
        with open(file, encoding="utf-8", newline="") as lines:
            self.rows = list(csv.DictReader(lines))
        self.names = list(self.rows[0]) if self.rows else []

    def __getitem__(self, name):
        texts = [row[name] for row in self.rows]
        try:
            return np.array([float(text) if text else math.nan for text in texts])
        except ValueError:
            return texts

    def vectors(self, *names):
        return np.column_stack([self[name] for name in names])


class Run:
    def __init__(self, folder):
        self.folder = folder
        self.summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))

    def table(self, name="trajectory.csv"):
        return Table(self.folder / name)

    def metric(self, name):
        found = self.summary if name.split(".")[0] in self.summary else self.summary["metrics"]
        for part in name.split("."):
            found = found["xyz".index(part) if isinstance(found, list) else part]
        return found


class Bench:
    """Runs the program for a scene, in the folder of the scene. Collects the answers of the scene and the JSON that the
    program printed."""

    def __init__(self, scene, folder):
        self.scene, self.folder, self.answers, self.printed = scene, folder, [], []
        folder.mkdir(parents=True, exist_ok=True)

    def scenario(self, name, **fields):
        file = self.folder / f"{name}.json"
        file.write_text(json.dumps({"name": name, **fields}), encoding="utf-8")
        return file

    def write(self, name, header, rows):
        np.savetxt(self.folder / name, rows, "%.17g", ",", header=header, comments="")
        return name

    def hapbench(self, *words, statuses=(0,)):
        return must(PROGRAM, *words, statuses=statuses, cwd=self.folder)

    def json(self, *words, statuses=(0,)):
        found = json.loads(self.hapbench(*words, "--json", statuses=statuses))
        of_runs = words[0] == "compare" and (isinstance(found, list) or "runs" in found)
        self.printed.append(
            (
                words[0],
                {key: found[key] for key in found if key != "runs"}
                if of_runs and isinstance(found, dict)
                else []
                if of_runs
                else found,
            )
        )
        return found

    def run(self, scenario, *words, out=None, statuses=(0,)):
        out = self.folder / (out or f"out_{Path(scenario).stem}")
        self.hapbench("run", scenario, "--out", out, "--quiet", *words, statuses=statuses)
        run = Run(out)
        self.printed.append(("run", run.summary))
        return run

    def add(self, field, printed, known, known_by, within=ROUNDING, naive=None):
        plain = {np.float64: float, np.int64: int, np.bool_: bool}
        known, printed = (plain.get(type(v), lambda x: x)(v) for v in (known, printed))
        self.answers.append(Answer(self.scene, field, known_by, within, known, printed, naive))

    def proven(self, field, file, test, accepted, rejected):
        """Adds an answer that a test in C++ proves. The source of this test must contain two texts: the known answer
        `accepted` and the rejected answer `rejected`."""
        suite, name = test.split(".")
        body = re.search(
            rf"TEST(_F)?\({suite}, {name}\) {{(.*?)\n}}",
            (SOURCE / file).read_text(encoding="utf-8"),
            re.S,
        )
        found = body[2] if body else ""
        self.add(
            field,
            accepted in found and rejected in found,
            True,
            f"the test {test}",
            EXACT,
            ("another case of the same test", False),
        )

    def metrics(self, run, table):
        """Adds an answer for each row of `table`: (metric, known value, source of the known value, tolerance, naive
        definition, naive value). The last two may be missing."""
        for name, known, known_by, within, *naive in table:
            self.add(
                re.sub(r"^targets\.\d+", "targets.PLACE", name),
                run.metric(name),
                known,
                known_by,
                within,
                tuple(naive) or None,
            )

    def tolerance(self, run, metric, known, known_by, within, naive, exact):
        """Adds the answer for the tolerance of a metric. Also adds an answer which states that the metric differs from
        the `exact` value by at most this tolerance."""
        printed = run.summary["tolerances"][metric]
        self.add(f"run --json: tolerances.{metric}", printed, known, known_by, within, naive)
        self.add(
            f"run --json: tolerances.{metric}",
            abs(run.metric(metric) - exact) <= printed,
            True,
            "the metric differs by less",
            EXACT,
        )

    def columns(self, table, rows):
        """Adds answers like metrics(), for columns of a table. A known value is a series, or one value for all rows."""
        for name, known, known_by, within, *naive in rows:
            known = (
                np.broadcast_to(known, len(table.rows))
                if np.ndim(known) == 0 and not isinstance(known, str)
                else known
            )
            known = [known] * len(table.rows) if isinstance(known, str) else known
            self.add(
                f"{table.name}:{name}", table[name], known, known_by, within, tuple(naive) or None
            )


def scene(function):
    """Registers a function that adds the answers of a scene to a Bench. Its docstring describes the source of the known
    values."""
    SCENES[function.__name__] = function
    return function


def profile(given, t):
    """Returns the values of a profile of a scenario at the times t [s], computed from the definition of profiles."""
    if not isinstance(given, dict):
        return np.full_like(t, float(given))
    if given["type"] == "ramp":
        return given["start"] + given["rate_per_s"] * t
    if given["type"] == "sine":
        return given.get("mean", 0) + given["amplitude"] * np.sin(
            2 * np.pi * t / given["period_s"] + given.get("phase_rad", 0)
        )
    times, values = np.transpose(given["points"])
    if given.get("interpolation", "linear") == "linear":
        return np.interp(t, times, values)
    piece = np.clip(np.searchsorted(times, t, side="right") - 1, 0, len(times) - 2)
    part = np.clip((t - times[piece]) / (times[piece + 1] - times[piece]), 0, 1)
    return values[piece] + (values[piece + 1] - values[piece]) * (1 - np.cos(np.pi * part)) / 2


def norms(vectors):
    return np.linalg.norm(vectors, axis=-1)


def rms(vectors):
    return math.sqrt(np.sum(np.square(vectors)) / len(vectors))
