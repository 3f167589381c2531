"""The law that is submitted: a name of the program's own, a plugin, or a script in Python."""
import cmath
import hashlib
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from hapbench.columns import read_columns

from .suite import SuiteError

PROGRAM = Path(os.environ.get("HAPBENCH_PROGRAM", "hapbench"))
FINE = (0, 3)  # done; a run ended otherwise than its scene expects
# Classes of `hapbench limit` below a stable range that is none: a tool too stiff for its loop comes to rest by chance.
UNSTABLE = ("vibrating", "diverged", "thrown_out")


def set_words(fields):
    """The words that set fields, each as path=value."""
    return [word for field_ in fields for word in ("--set", field_)]


def _short(override):
    """A field of rendering that is set, in a word: its name, the type of an object, the value of what is not a switch."""
    path, _, value = override.partition("=")
    name = path.rpartition(".")[2]
    if value.startswith("{"):
        try:
            return json.loads(value).get("type", name)
        except ValueError:
            return name  # which the program will refuse
    return name if value == "true" else f"{name}={value}"


@dataclass
class Law:
    """`kind`: built_in, plugin or python; `file`: of the latter two; `overrides`: of the open division, as in --set."""

    kind: str = "built_in"
    name: str = ""
    file: Path | None = None
    overrides: list = field(default_factory=list)

    def words(self):
        """The program that knows the law."""
        if self.kind == "plugin":
            return [PROGRAM, "--plugin", self.file]
        return [PROGRAM] if self.kind == "built_in" else [os.environ.get("HAPBENCH_PYTHON", sys.executable), self.file]

    def reply(self, *words):
        """What the program prints with --json."""
        environment = {**os.environ, "PYTHONPATH": str(PROGRAM.resolve().parents[1] / "lib" / "python3" / "dist-packages")}
        environment.pop("HAPBENCH_PLUGIN_PATH", None)
        line = [*map(str, self.words()), *map(str, words), "--json"]
        done = subprocess.run(line, capture_output=True, text=True, encoding="utf-8", env=environment, stdin=subprocess.DEVNULL)
        if done.returncode not in FINE:
            said = done.stderr.strip().splitlines() or [f"exit status {done.returncode}"]
            raise SuiteError(f"{' '.join(line)}: {said[-1].removeprefix('hapbench: error: ')}")
        try:
            return json.loads(done.stdout)
        except ValueError:
            raise SuiteError(f"{self.file}: printed no JSON; a law in Python ends with hapbench.main()") from None

    def find_name(self):
        """Fills in the name of the only law that the file brings; checks a name that is given."""
        names = [one["name"] for one in self.reply("list", "algorithms")]
        if not self.name:
            own = set(names) - {one["name"] for one in Law().reply("list", "algorithms")}
            if len(own) != 1:
                raise SuiteError(f"{self.file or 'no law given'}: brings {len(own)} laws; allowed: one, or --algorithm NAME")
            self.name = own.pop()
        elif self.name not in names:
            raise SuiteError(f'--algorithm {self.name}: unknown; allowed: {", ".join(names)}')
        return self

    def hash(self):
        return hashlib.sha256(self.file.read_bytes()).hexdigest() if self.file else None

    def label(self):
        """Its name with the fields that the open division sets, for pages and folders."""
        return " ".join([self.name, *map(_short, self.overrides)])

    def compare(self, file, seeds, jitter_m, jobs, seed=None):
        """The summaries of the runs of a scene, by seed."""
        with tempfile.TemporaryDirectory(prefix="hapbench-suite-") as scratch:
            given = ["--jitter", jitter_m] if jitter_m else []
            given += ["--set", f"seed={seed}"] if seed is not None else []
            self.reply("compare", file, "--algorithms", self.name, *set_words(self.overrides), "--seeds", seeds, *given, "--jobs", jobs, "--out", scratch)
            folders = [Path(scratch) / self.name / f"seed_{k}" for k in range(seeds)] if seeds > 1 else [Path(scratch) / self.name]
            return [json.loads((folder / "summary.json").read_text(encoding="utf-8")) for folder in folders]

    def replay(self, file, seed, jitter_m, page):
        """Writes the report of one run of a scene, which replays it. The seeds before it are run, too, as `compare` numbers them."""
        with tempfile.TemporaryDirectory(prefix="hapbench-suite-") as scratch:
            given = ["--jitter", jitter_m] if jitter_m else []
            self.reply("compare", file, "--algorithms", self.name, *set_words([*self.overrides, "record.trajectory=true", "record.every=8"]),
                       "--seeds", seed + 1, *given, "--out", scratch)
            run = Path(scratch) / self.name / (f"seed_{seed}" if seed else "")
            subprocess.run([PROGRAM, "report", run, "--out", page, "--quiet"], check=True, stdin=subprocess.DEVNULL)

    def limit(self, file, vary, between, resolution, settings):
        """The row of `hapbench limit`, and `felt_N_per_m`, what is rendered at half the limit, a gain margin of two: the mean force over how
        deep the tool is. A law that is softer than its K would else gain by it. None where nothing is stable there, or only a range above
        values that are not, which is no largest stable value."""
        with tempfile.TemporaryDirectory(prefix="hapbench-suite-") as scratch:
            settings = set_words([*self.overrides, *settings])
            row = self.reply("limit", file, "--vary", vary, "--between", between, "--resolution", resolution, "--algorithms", self.name,
                             *settings, "--out", scratch)["limits"][0]
            if row["limit"] is None or row["class_below"] in UNSTABLE:
                return row | {"felt_N_per_m": None}
            run = self.reply("run", file, *set_words([f"{vary}={row['limit'] / 2!r}", f"rendering.algorithm={self.name}"]), *settings, "--out", scratch)[0]
            force, inside = run["metrics"]["force_mean_in_contact_N"], run["metrics"]["inside_settled_m"]
            return row | {"felt_N_per_m": force / inside if run["expected"] and force and inside else None}

    def tremor(self, file, vary, frequencies):
        """The stiffness [N/m] that a tool feels which trembles at each frequency [Hz], by Fourier's sums of force and place over the last
        half of the run; None where a run fails. `vary` is the field of the period."""
        felt = {}
        for frequency in frequencies:
            with tempfile.TemporaryDirectory(prefix="hapbench-suite-") as scratch:
                fields = [f"{vary}={1 / frequency!r}", f"rendering.algorithm={self.name}", *self.overrides]
                run = self.reply("run", file, *set_words(fields), "--out", scratch)[0]
                rows = read_columns(Path(scratch) / "trajectory.csv", ["time_s", "pz_m", "fz_N"])
            half = rows["time_s"] >= rows["time_s"][-1] / 2
            turned = [cmath.exp(-2j * math.pi * frequency * t) for t in rows["time_s"][half]]
            force, place = (rows[name][half] @ turned for name in ("fz_N", "pz_m"))
            felt[str(frequency)] = abs(force / place) if run["expected"] else None
        return felt

    def keep(self, folder, sources):
        """Copies the law's file and sources into the submission; returns their hashes by name."""
        kept = {}
        for file in [*([self.file] if self.file else []), *sources]:
            folder.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, folder / file.name)
            kept[file.name] = hashlib.sha256(file.read_bytes()).hexdigest()
        return kept
