"""The runs in a results directory, which is every directory with a summary.json: their table, and what produced them."""
import json
from functools import cached_property
from pathlib import Path

from hapbench import results
from hapbench.results import at, member, number_or_none

from .markup import algorithm_name, cell, columns, filters, heading_cell, named, number_cell, table, text

# Written for the replay, not as results of their own.
REPLAY_DIRECTORY = "replay"
# Metrics of summary.json in the table of all runs.
METRICS = ("force_max_N", "velocity_total_variation_m_per_s", "force_reversals", "depth_max_m", "ratio_min", "ratio_max",
           "colliding_mean", "rendered_mean")


class Run(results.Run):
    """A run as pages know it: `path` is that of its folder, relative to the results."""

    path = ""

    @property
    def name(self):
        return super().name or self.path

    @property
    def expected(self):
        """True unless the scenario said that the run must end otherwise; what it says is not about other algorithms that it is compared by."""
        return self.summary.get("expected") is not False or (self.folder.resolve().parent / "comparison.csv").exists()

    @property
    def anchor(self):
        return "run-" + "".join(c if c.isalnum() else "-" for c in self.path)

    def metric(self, key):
        return number_or_none(self.metrics.get(key))

    def tolerance(self, section, key):
        """By how much a metric may be wrong; None where that is not known."""
        return number_or_none(self.summary.get("tolerances", {}).get(key if section == "metrics" else f"{section}.{key}"))

    @cached_property
    def sections(self):
        """The groups of metrics in summary.json, by their names: what columns.json documents."""
        file = self.folder / "columns.json"
        documented = {entry["name"] for entry in results.read_json(file).get("summary.json", ())} if file.is_file() else set()
        return {name: value for name, value in self.summary.items()
                if isinstance(value, dict) and (name == "metrics" or any(f"{name}.{key}" in documented for key in value))}


def load_runs(directory: Path, but=None):
    """Those below a directory, without its folder `but`."""
    paths = [file.parent.relative_to(directory).as_posix() for file in sorted(directory.rglob(results.SUMMARY))]
    return [load_run(directory / path, path) for path in paths if path.split("/")[0] != but]


def load_run(directory, path):
    """The run of one directory, which is known as `path`."""
    run = results.load_run(directory, Run)
    for key in ("metrics", "provenance", "targets", "tolerances"):
        member(run.summary, key, dict, directory / results.SUMMARY)
    run.path = path
    return run


def find_run(runs, name):
    """The first run of that name, the thesis's own before comparisons; None when there is none."""
    named = [run for run in runs if run.path.split("/")[-1] == name]
    return min(named, key=lambda run: (not run.path.startswith("thesis/"), run.path), default=None)


def runs_section(runs):
    numbers, cells = columns(METRICS, [[run.metric(name) for name in METRICS] for run in runs],
                             [[run.tolerance("metrics", name) for name in METRICS] for run in runs])
    rows = []
    for run, measured in zip(runs, cells):
        outcome = text(run.outcome.replace("_", " ")) + ("" if run.expected else ' <b class="bad">✗ unexpected</b>')
        rows.append([cell(f'<span id="{run.anchor}">{named(run.path.rpartition("/")[0] or run.path)}</span>'), cell(named(run.name), classes="name"),
                     cell(algorithm_name(run.algorithm), classes="name"), cell(outcome), number_cell(at(run.summary, "/steps")), *measured])
    headings = [*map(heading_cell, ("Part", "Scenario", "Algorithm", "Outcome")), heading_cell("Steps", True), *numbers]
    return ("<p>Click a heading to sort. The folder of a run, its part and its scenario here, holds the scenario with every default filled in, "
            "which gives the same bytes again; <code>hapbench report FOLDER</code> shows it.</p>"
            + filters("runs-table", [("Part", 0), ("Algorithm", 2), ("Outcome", 3)])
            + table(headings, rows, "<b>All runs</b> Ratio: combined stiffness along a contact in units of K; colliding, rendered: "
                    "mean numbers of points before and after the reduction", "sortable", "runs-table"))


def plugin_text(run):
    plugin = at(run.summary, "/provenance/plugin")
    return f", law from {text(plugin['file'])} with hash {text(plugin['hash'])}" if plugin else ""


def provenance_of(runs):
    """Distinct builds and machines, with the number of their runs."""
    found = {}
    for run in runs:
        # The scenario and a plugin's law do not make another build.
        build = {k: v for k, v in (run.summary.get("provenance") or {}).items() if k not in ("scenario_hash", "plugin")}
        key = json.dumps(build, sort_keys=True)
        found[key] = found.get(key, 0) + 1
    return [(json.loads(key), count) for key, count in sorted(found.items())]


def provenance_section(provenance):
    keys = sorted({key for build, _ in provenance for key in build})
    rows = [[*(cell(text(build.get(key, "–"))) for key in keys), cell(str(count), classes="number")]
            for build, count in provenance]
    headings = [*(heading_cell(text(key.replace("_", " "))) for key in keys), heading_cell("Runs", True)]
    mixed = ("<p><b class=bad>✗ These results come from more than one build or machine.</b></p>"
             if len(provenance) > 1 else "")
    dirty = any(str(build.get("commit", "")).endswith("-dirty") for build, _ in provenance)
    note = ("<p class=note>A commit that ends in -dirty had changes that were not committed.</p>" if dirty else "")
    return mixed + table(headings, rows, "<b>What produced the results</b>") + note
