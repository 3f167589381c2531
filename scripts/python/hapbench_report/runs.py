"""The runs in a results directory: every directory with a summary.json."""
from dataclasses import dataclass, field
from pathlib import Path

from .json_input import load_object, member, number_or_none

# Written for the replay, not as results of their own.
REPLAY_DIRECTORY = "replay"


@dataclass
class Run:
    path: str  # of its directory, relative to the results
    summary: dict
    scenario: dict = field(default_factory=dict)  # every field, defaults filled in; empty when not kept
    timing: dict = field(default_factory=dict)
    compared: bool = False  # one of several algorithms; the scenario's expectations are about its own one
    directory: Path = Path()

    @property
    def name(self):
        return str(self.summary.get("name", self.path))

    @property
    def algorithm(self):
        return str(self.summary.get("algorithm", ""))

    @property
    def group(self):
        return self.path.split("/")[0]

    @property
    def outcome(self):
        return str(self.summary.get("outcome", ""))

    @property
    def expected(self):
        """True unless the scenario said that the run must end otherwise."""
        return self.compared or self.summary.get("expected") is not False

    @property
    def anchor(self):
        return "run-" + "".join(c if c.isalnum() else "-" for c in self.path)

    @property
    def warnings(self):
        """What the program warned of when it ran this."""
        said = self.summary.get("warnings")
        return [str(warning) for warning in said] if isinstance(said, list) else []

    def metric(self, key):
        metrics = self.summary.get("metrics")
        return number_or_none(metrics.get(key)) if isinstance(metrics, dict) else None


def load_runs(results: Path):
    runs = []
    for file in sorted(results.rglob("summary.json")):
        path = file.parent.relative_to(results).as_posix()
        if path.split("/")[0] == REPLAY_DIRECTORY:
            continue
        runs.append(load_run(file.parent, path))
    return runs


def load_run(directory, path):
    """The run of one directory, which is known as `path`."""
    file = directory / "summary.json"
    summary = load_object(file)
    for key in ("metrics", "provenance", "targets"):
        member(summary, key, dict, file, "")
    return Run(path, summary, optional_object(file.with_name("scenario.effective.json")),
               optional_object(file.with_name("timing.json")), (directory.resolve().parent / "comparison.csv").exists(), directory)


def optional_object(file):
    return load_object(file) if file.is_file() else {}


def find_run(runs, name):
    """The first run of that name, the thesis's own before comparisons; None when there is none."""
    named = [run for run in runs if run.path.split("/")[-1] == name]
    return min(named, key=lambda run: (run.group != "thesis", run.path), default=None)
