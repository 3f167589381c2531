"""Finds what is missing in the recorded tables of a run, for example after an editor or a full disk has cut a file. The
number of rows follows from summary.json (steps) and from the scenario (record.every)."""
import os
import re
from math import ceil

import numpy as np

from hapbench.columns import PIECE_BYTES, header, read_columns, readable
from hapbench.errors import ResultError
from hapbench.results import SCENARIO, SUMMARY, at
from hapbench_command import plain

from .recording import REQUIRED

TRAJECTORY, CONTACTS = "trajectory.csv", "contacts.csv"
# Tables with one row for each recorded step. Other tables have rows only for some of these steps.
OF_EVERY_STEP = (TRAJECTORY, "energy.csv", "stiffness_tensor.csv")
OF_SOME_STEPS = ("ideal_trajectory.csv", "force_reference.csv")
ORDERED = ("step", "time_s")  # columns that increase over the rows
COMPRESSED = (".gz", ".xz", ".bz2", ".zst", ".zip", ".7z")  # endings of compressed files
NOT_FINITE = re.compile(rb"(?im)(?:^|(?<=,))[-+]?(?:nan|inf(?:inity)?)(?=,|\r?$)")


def gaps_of(run, with_contacts=False):
    """Returns a text for each table of the run that is missing, lacks rows, has too many rows, or has fields that are
    not finite numbers. A run with several trials has no table of its own. `with_contacts`: true to check contacts.csv
    as well. Raises ResultError for a table whose rows are not in the order of time."""
    if run.trials:
        return []
    found, expected = [], expected_rows(run)
    if not run.scenario:
        found.append(without_scenario(run.folder / SCENARIO))
    for name in OF_EVERY_STEP + OF_SOME_STEPS + (CONTACTS,) * with_contacts:
        file = run.folder / name
        if not file.is_file():
            if is_recorded(run, name):
                found.append(f"{file}: {absence_of(file)}")
            continue
        steps = steps_in_order(file)
        if name in OF_EVERY_STEP and expected is not None and steps.size:
            found += gap_texts(run, file, steps, expected)
        if name != CONTACTS:
            found += scanned(file)[1]
    if with_contacts and all((run.folder / name).is_file() for name in (TRAJECTORY, CONTACTS)):
        rows = scanned(run.folder / CONTACTS)[0]
        contacts = read_columns(run.folder / TRAJECTORY, ["rendered"])["rendered"].sum()
        if rows != contacts:
            found.append(
                f"{run.folder / CONTACTS}: {rows} rows, but {TRAJECTORY} has {contacts:g} contacts (column rendered); "
                "one of the files was cut or edited"
            )
    return found


def expected_rows(run):
    """Returns the number of recorded steps of a run with one trial. It counts the steps before a run ended early.
    Returns None if the summary or the scenario does not state it."""
    steps, every = at(run.summary, "/steps"), at(run.scenario, "/record/every")
    numbers = [
        n for n in (steps, every) if isinstance(n, int) and not isinstance(n, bool) and n > 0
    ]
    return ceil(steps / every) if len(numbers) == 2 else None


def scanned(file):
    """Returns (number of rows of a table, list with a text about the first field that is not finite). Columns of
    REQUIRED are excluded from the text, because their readers reject such a field."""
    names, line, first, count = header(file), 1, "", 0
    with readable(file), file.open("rb") as stream:
        stream.readline()
        while piece := b"".join(stream.readlines(PIECE_BYTES)):
            for match in NOT_FINITE.finditer(piece):
                start = piece.rfind(b"\n", 0, match.start()) + 1
                column = piece.count(b",", start, match.start())
                name = names[column] if column < len(names) else "?"
                if name in REQUIRED:
                    continue
                count += 1
                at_line = line + 1 + piece.count(b"\n", 0, match.start())
                first = first or f"{file}: line {at_line}: {name}: got {match[0].decode()}"
            line += piece.count(b"\n") + (not piece.endswith(b"\n"))
    fields = f"{count} fields" if count > 1 else "one field"
    return (
        line - 1,
        [f"{first}; {fields} of the file without a finite number are not drawn"] * bool(first),
    )


def gap_texts(run, file, steps, expected):
    """Returns a list with a text about the rows that a table with one row for each recorded step lacks or repeats.
    `steps`: steps of its rows. `expected`: expected number of rows."""
    every = run.scenario["record"]["every"]
    different = np.unique(steps)
    missing = np.setdiff1d(np.arange(expected) * every, different)
    if missing.size:
        return [
            f"{file}: {len(different)} of {expected} rows; the first missing row is of step {missing[0]}; "
            "the file was cut or edited"
        ]
    if len(steps) == expected:
        return []
    return [
        f"{file}: {len(steps)} rows, but the {run.summary['steps']} steps of {SUMMARY} are {expected} rows; "
        "one of the files was edited"
    ]


def steps_in_order(file):
    """Returns the steps of the rows of a table. Raises ResultError for the first row whose step or time is smaller than
    in the row before, because a picture of such a table would go back in time."""
    columns = read_columns(file, ORDERED, may_be_empty=True, required=ORDERED)
    for name, values in columns.items():
        back = np.flatnonzero(np.diff(values) < 0.0)
        if back.size:
            row = int(back[0]) + 1  # the header is line 1, and row 0 is line 2
            raise ResultError(
                f"{file}: line {row + 2}: {name}: got {plain(values[row])} after {plain(values[row - 1])}; allowed: "
                "rows in the order of time; the file was edited: sort its rows by step, or repeat the run"
            )
    return columns["step"]


def is_recorded(run, table):
    """Returns True if the scenario of a run records a table such as energy.csv."""
    return at(run.scenario, f"/record/{table.removesuffix('.csv')}") is True


def without_scenario(file):
    if file.is_file():
        return f"{file}: holds no field; allowed: the scenario of the run; repeat the run"
    return f"{file}: {absence_of(file)}"


def absence_of(file):
    """Returns why a file of a run, which the run has written, is not there, and what to do. `file` is not the path of
    an existing file."""
    if file.is_dir():
        return "is a folder, not a file: remove the folder and repeat the run"
    if file.is_symlink():
        target = os.readlink(file)
        is_cycle = os.path.islink(os.path.realpath(file))
        why = "leads in a circle" if is_cycle else "does not exist"
        return f"is a link to {target}, which {why}: remove the link and repeat the run"
    if os.path.lexists(file):
        return "is a pipe or a device, not a file: remove it and repeat the run"
    for ending in COMPRESSED:
        packed = file.with_name(file.name + ending)
        if packed.exists():
            return f"is missing, but {packed.name} is there: decompress {packed.name}"
    return "is missing, although the run has written it: repeat the run"
