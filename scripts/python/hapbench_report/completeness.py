"""Finds what is missing in the recorded tables of a run, for example after an editor or a full disk has cut a file. The
number of rows follows from summary.json (steps) and from the scenario (record.every)."""
import re
from math import ceil

import numpy as np

from hapbench.columns import PIECE_BYTES, header, read_columns
from hapbench.results import SCENARIO, SUMMARY, at

from .recording import REQUIRED

TRAJECTORY, CONTACTS = "trajectory.csv", "contacts.csv"
# Tables with one row for each recorded step. Other tables have rows only for some of these steps.
OF_EVERY_STEP = (TRAJECTORY, "energy.csv", "stiffness_tensor.csv")
OF_SOME_STEPS = ("ideal_trajectory.csv", "force_reference.csv")
NOT_FINITE = re.compile(rb"(?im)(?:^|(?<=,))[-+]?(?:nan|inf(?:inity)?)(?=,|\r?$)")


def gaps_of(run, with_contacts=False):
    """Returns a text for each table of the run that lacks rows, has too many rows, or has fields that are not finite
    numbers. A run with several trials has no table of its own. `with_contacts`: true to check contacts.csv as well.
    """
    if run.trials:
        return []
    found, expected = [], expected_rows(run)
    if not run.scenario:
        found.append(f"{run.folder / SCENARIO}: missing or without a scenario")
    for name in OF_EVERY_STEP + OF_SOME_STEPS:
        file = run.folder / name
        if not file.is_file():
            if name == TRAJECTORY and at(run.scenario, "/record/trajectory") is True:
                found.append(
                    f"{file}: missing, although the scenario records it (record.trajectory)"
                )
            continue
        rows, not_finite = scanned(file)
        if name in OF_EVERY_STEP and expected is not None and 0 < rows != expected:
            found.append(gap_text(run, file, rows, expected))
        if not_finite:
            found.append(not_finite)
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
    """Returns (number of rows of a table, text about the first field that is not finite or an empty text). Columns of
    REQUIRED are excluded from the text, because their readers reject such a field."""
    names, line, first, count = header(file), 1, "", 0
    with file.open("rb") as stream:
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
        first and f"{first}; {fields} of the file without a finite number are not drawn",
    )


def gap_text(run, file, rows, expected):
    every = run.scenario["record"]["every"]
    steps = read_columns(file, ["step"], required=["step"])["step"]
    missing = np.setdiff1d(np.arange(expected) * every, steps)
    if not missing.size:
        return (
            f"{file}: {rows} rows, but the {run.summary['steps']} steps of {SUMMARY} are {expected} rows; "
            "one of the files was edited"
        )
    return (
        f"{file}: {rows} of {expected} rows; the first missing row is of step {missing[0]}; "
        "the file was cut or edited"
    )
