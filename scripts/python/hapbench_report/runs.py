"""The runs in a results directory (every directory with a summary.json), and their provenance."""
import json
from functools import cache, cached_property
from pathlib import Path

from hapbench import results
from hapbench.errors import ResultError
from hapbench.results import at, member, number_or_none, objects, read_object, shown
from hapbench_command import SCHEMA, require_name

from .markup import cell, heading_cell, table, text

# Folder with runs that were computed for the replay. They are not results.
REPLAY_DIRECTORY = "replay"


class Run(results.Run):
    """A run that a page shows. `path`: folder of the run, relative to the folder of the results. `gaps`: texts about
    rows and numbers that its tables lack."""

    path, gaps = "", ()

    @property
    def name(self):
        return super().name or self.path

    @property
    def expected(self):
        """False if the run did not end as its scenario expects. Always true for a run of a comparison, because the
        expectation applies only to the scenario's own algorithm."""
        return (
            self.summary.get("expected") is not False
            or (self.folder.resolve().parent / "comparison.csv").exists()
        )

    def metric(self, key):
        return number_or_none(self.metrics.get(key))

    def tolerance(self, section, key):
        """Returns the largest possible error of a metric, in the unit of the metric. Returns None if this error is not
        known."""
        return number_or_none(
            self.summary.get("tolerances", {}).get(
                key if section == "metrics" else f"{section}.{key}"
            )
        )

    @cached_property
    def sections(self):
        """Returns the sections of summary.json that contain metrics, as a dict: "metrics", and each section with an
        entry in columns.json."""
        file = self.folder / "columns.json"
        documented = (
            {entry.get("name") for entry in objects(read_object(file), results.SUMMARY, file)}
            if file.is_file()
            else set()
        )
        return {
            name: value
            for name, value in self.summary.items()
            if isinstance(value, dict)
            and (name == "metrics" or any(f"{name}.{key}" in documented for key in value))
        }


def load_runs(directory: Path, but=None):
    """Returns the runs below a directory, sorted by path. Runs in the subfolder `but` are skipped."""
    paths = [
        file.parent.relative_to(directory).as_posix()
        for file in sorted(directory.rglob(results.SUMMARY))
    ]
    return [load_run(directory / path, path) for path in paths if path.split("/")[0] != but]


def load_run(directory, path):
    """Returns the run in a directory. `path`: Run.path of the result."""
    run = results.load_run(directory, Run)
    file = directory / results.SUMMARY
    for key in ("metrics", "provenance", "targets", "tolerances"):
        member(run.summary, key, dict, file)
    for key in ("algorithm", "outcome"):
        if not isinstance(run.summary.get(key), str):
            raise ResultError(
                f"{file}: line 1: no field {key}; allowed: the summary of a run, which the program writes"
            )
    require_name(f"{file}: /outcome: got", run.outcome, outcomes())
    require_numbers({key: run.summary.get(key) for key in ("steps", "tolerances")}, file)
    require_numbers(run.sections, file)
    run.path = path
    return run


@cache
def outcomes():
    """Returns the names of the outcomes of a run, from the field `expect` of the schema of a scenario."""
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    return at(schema, "/else/properties/expect/properties/outcome/anyOf/0/enum")


def require_numbers(value, file, pointer=""):
    """Raises ResultError for a member of a JSON value that is neither a finite number nor null."""
    if isinstance(value, (dict, list)):
        for key, part in value.items() if isinstance(value, dict) else enumerate(value):
            require_numbers(part, file, f"{pointer}/{key}")
    elif value is not None and number_or_none(value) is None:
        raise ResultError(
            f"{file}: {pointer}: got {shown(value)}; allowed: a number or null; the file was edited: repeat the run"
        )


def plugin_text(run):
    plugin = at(run.summary, "/provenance/plugin")
    return f", law from {text(plugin['file'])} with hash {text(plugin['hash'])}" if plugin else ""


def provenance_of(runs):
    """Returns (provenance, number of runs) for each distinct combination of build and machine."""
    found = {}
    for run in runs:
        # The plugin and the hash of the scenario do not belong to the build.
        build = {
            k: v
            for k, v in (run.summary.get("provenance") or {}).items()
            if k not in ("scenario_hash", "plugin")
        }
        key = json.dumps(build, sort_keys=True)
        found[key] = found.get(key, 0) + 1
    return [(json.loads(key), count) for key, count in sorted(found.items())]


def provenance_section(provenance):
    keys = sorted({key for build, _ in provenance for key in build})
    rows = [
        [*(cell(text(build.get(key, "–"))) for key in keys), cell(str(count), classes="number")]
        for build, count in provenance
    ]
    headings = [
        *(heading_cell(text(key.replace("_", " "))) for key in keys),
        heading_cell("Runs", True),
    ]
    mixed = (
        "<p><b class=bad>✗ These results come from more than one build or machine.</b></p>"
        if len(provenance) > 1
        else ""
    )
    dirty = any(str(build.get("commit", "")).endswith("-dirty") for build, _ in provenance)
    note = (
        "<p class=note>A commit that ends in -dirty had changes that were not committed.</p>"
        if dirty
        else ""
    )
    return mixed + table(headings, rows, "<b>What produced the results</b>") + note
