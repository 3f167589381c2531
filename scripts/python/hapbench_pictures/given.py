"""The runs that the arguments RUN… name: folders of `run`, folders of `compare`, or one folder of `sweep`. Also finds
the fields in which the runs differ, and formats the names of fields for legends and axes."""
import json
import os
import re
from collections import Counter
from pathlib import Path

from hapbench.columns import read_records
from hapbench.errors import InputError
from hapbench_command import nearest, print_warning
from hapbench_looks import distinguish, law_name
from hapbench_report.completeness import gaps_of
from hapbench_report.markup import column
from hapbench_report.runs import load_run, load_runs

SUMMARY, SWEEP, COMPARISON = "summary.json", "sweep.csv", "comparison.csv"
# Files that stand for the folder of their run, if they are given as an argument.
STAND_FOR_RUN = (SUMMARY, "trajectory.csv")
# Tables of folders of compare, sweep, limit, tune and converge.
TABLES_OF_FOLDERS = (
    *(SWEEP, COMPARISON, "ranking.csv"),
    *("limit.csv", "limit_runs.csv", "tune.csv", "tune_trials.csv"),
    *("converge.csv", "converge_levels.csv", "convergence.csv", "convergence_model.csv"),
)
LOG_HEADER = "# hapbench loop log:"  # begin of the first line of a log of a haptic loop
# Matches the name of a repetition's folder in a comparison with --seeds.
SEED_FOLDER = re.compile(r"seed_(\d+)")
# Titles of fields whose names are too short to be clear, and symbols of fields in formulas.
TITLES, SYMBOLS = {"time.step_s": "time step", "rendering.damping_ratio": "damping ratio ζ"}, {
    "rendering.stiffness_N_per_m": "K"
}
NO_INPUT = ("expect", "description", "name", "source")


def given_alone(words, files, what):
    """Returns the folder among the arguments `words` that contains one of `files` but is not the folder of a single
    run. Returns None if there is no such folder. If there is one and it is not the only argument, raises InputError
    with the text `what`."""
    found = [
        Path(word)
        for word in words
        if any((Path(word) / name).is_file() for name in files)
        and not (Path(word) / SUMMARY).is_file()
    ]
    if found and len(words) > 1:
        raise InputError(
            f"{found[0]}: {what}; allowed: one such folder alone, or any number of runs"
        )
    return found[0] if found else None


def given_sweep(words):
    return given_alone(words, [SWEEP], "is a sweep")


def given_runs(words, with_contacts=False):
    """Returns the runs in the order of the arguments, each folder once. A folder of a comparison stands for the runs
    that its table names. Prints a warning for each table that lacks rows, and keeps the warnings in Run.gaps.
    `with_contacts`: true to check contacts.csv as well."""
    found = {}
    for word in words:
        folder = Path(word)
        if folder.name in STAND_FOR_RUN and (folder.parent / SUMMARY).is_file():
            folder = folder.parent
        if not folder.is_dir():
            raise InputError(why_no_folder(folder))
        runs, lacks = (
            ([load_run(folder, folder.name)], [])
            if (folder / SUMMARY).is_file()
            else compared(folder)
        )
        if lacks and not runs:
            raise InputError(lacks[0])
        if not runs:
            raise InputError(
                f"{folder}: holds neither {SUMMARY} nor folders with one nor {SWEEP}; allowed: a folder that "
                '"hapbench run", "compare" or "sweep" wrote (the folder of a replay: only for "hapbench plot")'
            )
        runs[0].gaps = lacks
        for run in runs:
            found.setdefault(os.path.realpath(run.folder), run)
    for run in found.values():
        run.gaps = [*run.gaps, *gaps_of(run, with_contacts)]
        for text in run.gaps:
            print_warning(text)
    distinguish(run.algorithm for run in found.values())
    return list(found.values())


def why_no_folder(path):
    """Returns why a path, which is not a folder, is not drawn, and what is allowed."""
    written = 'a folder that "hapbench run", "compare" or "sweep" wrote'
    if not path.exists():
        close = nearest(path.name, [beside.name for beside in path.parent.glob("*/")])
        return f"{path}: no such folder; allowed: {written}{close}"
    if (path.parent / SUMMARY).is_file():
        return (
            f"{path}: is a file of a run, and is not drawn alone; allowed: {path.parent}, the folder of the run (for "
            '"hapbench plot", --y also takes columns of its tables)'
        )
    if path.name in TABLES_OF_FOLDERS:
        return f"{path}: is a table of the folder {path.parent}; allowed: {path.parent}"
    return (
        f'{path}: is a file, not a folder; allowed: {written}, or for "hapbench plot" a log of a loop, whose first '
        f'line begins with "{LOG_HEADER}" ("hapbench audit" draws other logs of time, position and force)'
    )


def compared(folder):
    """Returns (runs below a folder of a comparison, texts about runs that are missing). Runs that the comparison's
    table does not name are skipped."""
    runs, tables = load_runs(folder), [folder / COMPARISON]
    if not tables[0].is_file():
        tables = sorted(folder.glob(f"*/{COMPARISON}"))
        texts = [text for table in tables for text in lacking(table, read_records(table), runs)]
        return runs, texts + unfinished(runs)
    rows = read_records(tables[0])
    if not rows:
        raise InputError(f"{tables[0]}: line 2: missing; allowed: a row for each run")
    named = list(dict.fromkeys(row["algorithm"] for row in rows))
    return (
        sorted(
            (run for run in runs if run.algorithm in named),
            key=lambda run: named.index(run.algorithm),
        ),
        lacking(tables[0], rows, runs),
    )


def lacking(table, rows, runs):
    """Returns a text for each law that has more runs in a comparison's table than in the folders beside it, or runs
    only in the folders. `rows`: rows of the table. `runs`: runs of the folders."""
    beside = Counter(run.algorithm for run in runs if table.parent in run.folder.parents)
    named = Counter(row["algorithm"] for row in rows)
    found = []
    for law in {**named, **beside}:
        if named[law] > beside[law]:
            runs_of = f"{named[law] - beside[law]} of {named[law]} runs of {law}"
            found.append(f"{table}: {runs_of} missing: no {SUMMARY} below {table.parent / law}")
        elif not named[law]:
            found.append(
                f"{table}: no row of {law}; the runs of {law} in this folder are not drawn"
            )
    return found


def unfinished(runs):
    """Returns a text for each comparison and each sweep that was stopped or still runs. In a comparison, the runs have
    the folders LAW or LAW/seed_N. A sweep with --keep-runs has them in the folder "runs"."""
    found = {}
    for run in runs:
        law = run.folder.parent if SEED_FOLDER.fullmatch(run.folder.name) else run.folder
        is_compared = law.name == run.algorithm and law.parent not in found
        if is_compared and not (law.parent / COMPARISON).is_file():
            empty = ", ".join(without_summary(law.parent))
            found[law.parent] = (
                f'{law.parent}: has no {COMPARISON}, which "hapbench compare" writes last; if compare wrote this '
                "folder, it was stopped or has not ended, and laws may be missing"
                + (f": no {SUMMARY} in {empty}" if empty else "")
            )
        part = run.folder.parent.parent / f"{SWEEP}.part"
        if run.folder.parent.name == "runs" and part.is_file():
            why = "the sweep was stopped or has not ended, and runs are missing"
            found[part] = f"{part}: {why}; --resume continues it"
    return list(found.values())


def without_summary(folder):
    """Returns the names of the folders of laws, and of their repetitions, that have no summary of a run."""
    laws = [path for path in sorted(folder.iterdir()) if path.is_dir()]
    seeds = [path for law in laws for path in sorted(law.glob("seed_*")) if path.is_dir()]
    return [str(path.relative_to(folder)) for path in laws + seeds if not any(path.rglob(SUMMARY))]


def labels(runs):
    """Returns a distinct name for each run. A name consists of the scene, the algorithm and fields of the scenario,
    each only if it differs between the runs. If some of these names are equal, all names also contain the seed. If some
    names are still equal, all names contain the folder instead of the seed.
    """
    return named(runs)[0]


def named(runs):
    """Returns (labels() of the runs, labels without the seed). Runs that differ only in the seed have equal labels
    without the seed. If the labels need the folders, both lists are equal."""
    parts = [
        part
        for part in ([run.name for run in runs], [plain(run) for run in runs])
        if len(runs) == 1 or len(set(part)) > 1
    ]
    groups = [
        ", ".join([*(part[i] for part in parts), *fields]) or plain(runs[i])
        for i, fields in enumerate(field_entries(runs))
    ]
    folders = relative_folders(runs)
    seeded = [f"{group}, seed {seed_of(run)}" for group, run in zip(groups, runs)]
    located = [f"{group}, {folder}" for group, folder in zip(groups, folders)]
    for names, shared in ((groups, groups), (seeded, groups), (located, located)):
        if len(set(names)) == len(names):
            return names, shared
    return folders, folders


def seed_of(run):
    """Returns the number of the repetition from the name of the run's folder in a comparison with --seeds. For any
    other run, returns the seed of its scenario."""
    found = SEED_FOLDER.fullmatch(run.folder.name)
    return int(found[1]) if found else run.scenario.get("seed")


def plain(run):
    return law_name(run.algorithm)


def by_seed(run):
    """Returns the paths of the fields that differ between repetitions: the seed, and in a comparison with --seeds also
    the initial position, which --jitter changes."""
    return ("seed", "initial.position_m") if SEED_FOLDER.fullmatch(run.folder.name) else ("seed",)


def field_entries(runs):
    """Returns for each run a list of "field = value" texts, for the fields in which it differs from other runs of the
    same scene and algorithm. Fields of by_seed() are excluded."""
    fields = [
        {path: value for path, value in fields_of(run).items() if path not in by_seed(run)}
        for run in runs
    ]
    scenes = [(run.name, run.algorithm) for run in runs]
    paths = {
        path: None
        for scene in dict.fromkeys(scenes)
        for path in differing([of for of, name in zip(fields, scenes) if name == scene and of])
    }
    return [[entry(path, of[path], paths) for path in paths if path in of] for of in fields]


def relative_folders(runs):
    """Returns the folder of each run, relative to the deepest folder that contains all of them."""
    paths = [os.path.abspath(run.folder) for run in runs]
    common = os.path.commonpath([os.path.dirname(path) for path in paths])
    return [os.path.relpath(path, common) for path in paths]


def common_folder(words):
    """Returns the deepest folder that contains all runs or logs. For a single run, returns the folder of the run. If
    the argument is neither a file nor a folder, such as a pipe, returns the working directory."""
    path = (
        Path(os.path.commonpath([os.path.abspath(word) for word in words]))
        if len(words) > 1
        else Path(words[0])
    )
    if path.is_file():
        return path.parent
    return path if path.is_dir() or not path.exists() else Path()


def fields_of(run):
    """Returns the fields of the run's scenario by path. A file's path, which is relative to the scenario's folder, is
    converted to a path relative to the working directory."""
    return {
        path: os.path.relpath(run.folder / value)
        if path.rpartition(".")[2] == "file" and isinstance(value, str)
        else value
        for path, value in leaves(run.scenario)
    }


def differing(flat):
    """Returns a dict: for the path of each field that differs between the runs, the list of its values in all runs.
    Names, descriptions, sources and expectations are excluded. `flat`: for each run, the values of its fields by path.
    """
    values = {
        path: [fields.get(path) for fields in flat]
        for path in dict.fromkeys(p for fields in flat for p in fields)
    }
    return {
        path: of
        for path, of in values.items()
        if len({json.dumps(value, sort_keys=True) for value in of}) > 1
        and not path.startswith(NO_INPUT)
    }


def leaves(value, path=""):
    if not isinstance(value, dict):
        yield path, value
        return
    for key, part in value.items():
        yield from leaves(part, f"{path}.{key}" if path else key)


def title_and_unit(path):
    """Returns (title, unit) of a field or column: "rendering.mass_kg" gives "mass", "kg". The unit is empty if the name
    states none."""
    title, unit, _ = column(path.rpartition(".")[2])
    return TITLES.get(path, title), unit


def is_ambiguous(path, among):
    return any(
        other != path and title_and_unit(other)[0] == title_and_unit(path)[0] for other in among
    )


def axis(path, among=()):
    """Returns the title of a field or column with its unit. If another field of `among` has the same title, returns the
    whole path instead."""
    title, unit = title_and_unit(path)
    if is_ambiguous(path, among):
        return path
    title = " ".join([title, SYMBOLS[path]]) if path in SYMBOLS else title
    return f"{title} [{unit}]" if unit else title


def entry(path, value, among):
    """Returns a text with a field and its value for a legend, such as "K = 40 000 N/m". If another field of the legend
    has the same title, returns "PATH=VALUE" instead. `among`: all fields in the legend."""
    title, unit = title_and_unit(path)
    if is_ambiguous(path, among):
        return f"{path}={shown(value)}"
    return f"{SYMBOLS.get(path, title)} = {shown(value)}{' ' if unit else ''}{unit}"


def shown(value):
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return value if isinstance(value, str) else json.dumps(value)
    if 1e4 <= abs(value) < 1e7 and value == int(value):
        return f"{int(value):,}".replace(",", " ")
    return f"{value:.6g}"
