"""The runs in a results directory: every directory with a summary.json."""
from pathlib import Path

from hapbench import results

from .json_input import member, number_or_none

# Written for the replay, not as results of their own.
REPLAY_DIRECTORY = "replay"


class Run(results.Run):
    """A run as pages know it: `path` is that of its folder, relative to the results; one of several algorithms was
    `compared`, and the scenario's expectations are about its own one."""

    def __init__(self, path, found, compared=False):
        super().__init__(found.summary, found.scenario, found.tables, found.timing, found.trials, found.folder)
        self.path, self.compared = path, compared

    @property
    def name(self):
        return super().name or self.path

    @property
    def directory(self):
        return self.folder

    @property
    def group(self):
        return self.path.split("/")[0]

    @property
    def expected(self):
        """True unless the scenario said that the run must end otherwise."""
        return self.compared or self.summary.get("expected") is not False

    @property
    def anchor(self):
        return "run-" + "".join(c if c.isalnum() else "-" for c in self.path)

    def metric(self, key):
        metrics = self.summary.get("metrics")
        return number_or_none(metrics.get(key)) if isinstance(metrics, dict) else None


def load_runs(directory: Path):
    runs = []
    for file in sorted(directory.rglob(results.SUMMARY)):
        path = file.parent.relative_to(directory).as_posix()
        if path.split("/")[0] == REPLAY_DIRECTORY:
            continue
        runs.append(load_run(file.parent, path))
    return runs


def load_run(directory, path):
    """The run of one directory, which is known as `path`."""
    found = results.load_run(directory)
    for key in ("metrics", "provenance", "targets"):
        member(found.summary, key, dict, directory / results.SUMMARY, "")
    return Run(path, found, (directory.resolve().parent / "comparison.csv").exists())


def find_run(runs, name):
    """The first run of that name, the thesis's own before comparisons; None when there is none."""
    named = [run for run in runs if run.path.split("/")[-1] == name]
    return min(named, key=lambda run: (run.group != "thesis", run.path), default=None)
