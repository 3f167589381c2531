"""A suite: a folder of scenes that never change, held by their hashes, and suite.json, which says what is measured in them."""
import hashlib
import json
import math
from dataclasses import dataclass
from pathlib import Path

from hapbench_command import nearest, write

SUITES = Path(__file__).resolve().parents[3] / "scenarios" / "suites"
FILE = "suite.json"


class SuiteError(Exception):
    """A suite, a law or a submission that is not as it should be."""


@dataclass(frozen=True)
class Axis:
    """What laws are judged by: a number of each of its scenes or limits, in natural units.

    A number is cut to between `best`, the finest difference that means anything, and `failed`, what a run counts as that failed
    or does not have the number."""

    name: str
    title: str
    unit: str
    best: float
    failed: float
    values: tuple  # of (scene, metric), or of (limit, None)

    @property
    def more_is_better(self):
        return self.best > self.failed

    def cut(self, value):
        low, high = sorted((self.best, self.failed))
        return self.failed if value is None or not math.isfinite(value) else min(max(value, low), high)

    def better(self, a, b):
        return a > b if self.more_is_better else a < b


class Suite:
    def __init__(self, word):
        self.folder = SUITES / word if (SUITES / word / FILE).is_file() else Path(word)
        if not (self.folder / FILE).is_file():
            names = sorted(f.parent.name for f in SUITES.glob(f"*/{FILE}"))
            raise SuiteError(f"{word}: no suite and no folder with {FILE}; allowed: {', '.join(names)}{nearest(word, names)}")
        self.given = json.loads((self.folder / FILE).read_text(encoding="utf-8"))
        self.name, self.seeds, self.jitter_m = self.given["suite"], self.given["seeds"], self.given["jitter_m"]
        self.scenes, self.limits, self.cost = self.given["scenes"], self.given["limits"], self.given["cost"]
        self.tremor = self.given.get("tremor")  # None: nothing trembles
        self.axes = [Axis(axis["axis"], axis["title"], axis["unit"], axis["best"], axis["failed"], tuple(self._values(axis)))
                     for axis in self.given["axes"]]
        self.hash = hashlib.sha256((self.folder / FILE).read_bytes()).hexdigest()

    @staticmethod
    def _values(axis):
        for limit in axis.get("limits", ()):
            yield limit, None
        for scene in axis.get("scenes", ()):
            yield scene, axis["metric"]
        for scene, metric in axis.get("further", {}).items():
            yield scene, metric

    def file(self, scene):
        return self.folder / f"{scene}.json"

    def scenes_run(self):
        """Those that are not there for limits or the tremor only."""
        return [name for name, scene in self.scenes.items() if not scene.get("limit_only")]

    def seeds_of(self, scene):
        """How many runs: one where nothing hangs on the seed."""
        return 1 if self.scenes[scene].get("prescribed") else self.seeds

    def jitter_of(self, scene):
        """By how much a seed shifts the start [m]."""
        return 0.0 if self.scenes[scene].get("prescribed") else self.jitter_m

    def hashes(self):
        """Of each scene: its file and those that it names."""
        return {scene: _hash_of(self.file(scene)) for scene in self.scenes}

    def check(self):
        """Raises SuiteError for a scene that is not what was frozen."""
        for scene, found in self.hashes().items():
            if found != self.scenes[scene]["sha256"]:
                raise SuiteError(f"{self.file(scene)}: is not the scene that was frozen (or a file that it names is not); allowed: one with "
                                 f"sha256 {self.scenes[scene]['sha256']}, this has {found}")

    def freeze(self):
        """Writes the hashes of the scenes as they are."""
        for scene, found in self.hashes().items():
            self.scenes[scene]["sha256"] = found
        write(self.folder / FILE, json.dumps(self.given, indent=1) + "\n")


def _hash_of(file):
    try:
        data = file.read_bytes()
        digest = hashlib.sha256(data)
        for named in _named_files(json.loads(data)):
            digest.update((file.parent / named).read_bytes())
    except OSError as error:
        raise SuiteError(f"{error.filename}: {error.strerror}") from None
    return digest.hexdigest()


def _named_files(value):
    if isinstance(value, dict):
        for key, part in value.items():
            if key == "file" and isinstance(part, str):
                yield part
            else:
                yield from _named_files(part)
    elif isinstance(value, list):
        for part in value:
            yield from _named_files(part)
