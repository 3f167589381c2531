"""The runs that RUN… on the command line mean: folders of `run`, folders of `compare`, or one folder of `sweep`."""
import csv
import os
from pathlib import Path

from hapbench_report.json_input import InputError
from hapbench_report.runs import load_run, load_runs

from .names import nearest

SUMMARY, SWEEP = "summary.json", "sweep.csv"


def given_sweep(words):
    """The folder of the sweep when one was given, else None. A sweep is drawn alone."""
    sweeps = [Path(word) for word in words if (Path(word) / SWEEP).is_file() and not (Path(word) / SUMMARY).is_file()]
    if sweeps and len(words) > 1:
        raise InputError(f"{sweeps[0]}: is a sweep; allowed: one sweep alone, or any number of runs")
    return sweeps[0] if sweeps else None


def given_runs(words):
    """The runs, in the order given, each folder once; of a comparison those that its table names."""
    found = {}
    for word in words:
        folder = Path(word)
        if not folder.is_dir():
            # Whoever types RUN/trajectory.csv means RUN.
            if folder.is_file() and (folder.parent / SUMMARY).is_file():
                folder = folder.parent
            else:
                raise InputError(f"{folder}: no such folder; allowed: a folder that \"hapbench run\", "
                                 f"\"compare\" or \"sweep\" wrote{similar(folder)}")
        runs = [load_run(folder, folder.name)] if (folder / SUMMARY).is_file() else compared(folder)
        if not runs:
            raise InputError(f"{folder}: holds neither {SUMMARY} nor folders with one nor {SWEEP}; allowed: a folder that "
                             "\"hapbench run\", \"compare\" or \"sweep\" wrote")
        for run in runs:
            found.setdefault(os.path.realpath(run.directory), run)
    return list(found.values())


def compared(folder):
    """The runs below a folder, without those that an earlier comparison left there."""
    table = folder / "comparison.csv"
    runs = load_runs(folder)
    if not table.is_file():
        return runs
    with table.open(newline="", encoding="utf-8") as text:
        named = [row.get("algorithm") for row in csv.DictReader(text)]
    order = {name: i for i, name in reversed(list(enumerate(named)))}
    return sorted((run for run in runs if run.algorithm in order), key=lambda run: order[run.algorithm])


def similar(folder):
    """A hint at a folder of nearly that name beside it."""
    try:
        names = [entry.name for entry in folder.parent.iterdir() if entry.is_dir()]
    except OSError:
        return ""
    return nearest(folder.name, names)


def labels(runs):
    """The shortest names that tell the runs apart."""
    def plain(text):
        return text.replace("_", " ")

    ways = ((lambda run: plain(run.algorithm)) if len(runs) > 1 else (lambda run: f"{run.name}, {plain(run.algorithm)}"),
            lambda run: run.name, lambda run: f"{run.name}, {plain(run.algorithm)}", lambda run: run.directory.name,
            # Seeds of a comparison.
            lambda run: f"{run.name}, {plain(run.algorithm)}, {run.directory.name}")
    for way in ways:
        names = [way(run) for run in runs]
        if all(names) and len(set(names)) == len(names):
            return names
    return [run.directory.as_posix() for run in runs]


def common_folder(words):
    """The folder that holds all of the runs: of a single one, its own."""
    return Path(os.path.commonpath([os.path.abspath(word) for word in words])) if len(words) > 1 else Path(words[0])
