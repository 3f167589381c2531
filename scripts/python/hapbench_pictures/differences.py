"""Compares the results A and B of two runs, or of two folders with several runs, as a regression test.

The compared results are the outcome, the metrics and the warnings of summary.json, and the tables trajectory.csv and
sweep.csv. Differences between the fields of the scenarios are printed but are not differences of the results.
Provenance, times and work counters are not compared.
"""
import json
import math
import zlib

from hapbench.columns import is_number, read_bytes, read_rows
from hapbench.errors import InputError
from hapbench.results import SCENARIO, SUMMARY, read_object
from hapbench_report.completeness import absence_of

SWEEP, TRAJECTORY = "sweep.csv", "trajectory.csv"
NO_RESULTS = (
    "name",
    "algorithm",
    "expected",
    "warnings",
    "diagnosis",
    "work",
    "provenance",
    "state_hash",
)
LONGEST = 24  # largest number of characters of a printed value
NO_NUMBER = math.inf  # size of a difference if one of the two values is not a finite number


def differences(a, b):
    """Returns a dict of dicts. The outer key is the path of a run or sweep below the folders `a` and `b`. The inner
    keys of a run are "field", "result", "state hash" and the names of tables; the inner key of a sweep is the name of
    its table. The values are lists of (name, value in A, value in B, difference, relative difference). The outer key ""
    has the runs and sweeps that only one of the two folders has."""
    in_a, in_b = results_below(a), results_below(b)
    pairs = [path for path in in_a if path in in_b]
    if not pairs:
        raise InputError(
            f"{a} has {in_a[0]} and {b} has {in_b[0]}, with no run of the same name; allowed: the "
            "folders of two runs, or of "
            "several each"
        )
    found = {}
    for path in pairs:
        found[str(path)] = (
            of_runs(a / path.parent, b / path.parent)
            if path.name == SUMMARY
            else {path.name: of_tables(a / path, b / path)}
        )
    alone = [(str(path), "there", "-", NO_NUMBER, NO_NUMBER) for path in in_a if path not in in_b]
    alone += [(str(path), "-", "there", NO_NUMBER, NO_NUMBER) for path in in_b if path not in in_a]
    return found | ({"": {"in one of them alone": alone}} if alone else {})


def results_below(folder):
    if not folder.is_dir():
        raise InputError(f"{folder}: is not a folder; allowed: that of a run, or of several")
    found = sorted(
        file.relative_to(folder) for name in (SUMMARY, SWEEP) for file in folder.rglob(name)
    )
    if not found:
        raise InputError(
            f"{folder}: is not the folder of a run: it has no {SUMMARY}, nor has any below it"
        )
    return found


def of_runs(a, b):
    summaries = [read_object(folder / SUMMARY, parse_float=str, parse_int=str) for folder in (a, b)]
    tables = [(folder / TRAJECTORY).is_file() for folder in (a, b)]
    return {
        "field": changed(*map(fields_of, (a, b))),
        "result": changed(*map(results_of, summaries)),
        "state hash": changed(*({"state_hash": of.get("state_hash", "")} for of in summaries)),
        TRAJECTORY: of_tables(a / TRAJECTORY, b / TRAJECTORY)
        if all(tables)
        else [(TRAJECTORY, *("there" if there else "-" for there in tables), NO_NUMBER, NO_NUMBER)]
        if any(tables)
        else [],
    }


def flat(value, path=""):
    """Yields (path, text) of each leaf of a JSON value."""
    parts = (
        value.items()
        if isinstance(value, dict)
        else enumerate(value)
        if isinstance(value, list)
        else ()
    )
    if not parts:
        yield path, value if isinstance(value, str) else "" if value is None else json.dumps(value)
    for key, part in parts:
        yield from flat(part, f"{path}.{key}" if path else str(key))


def results_of(summary):
    """Returns the results of a summary: a text for each name. The name of an entry of the section "metrics" does not
    contain the section, as in the field `expect`. Each warning is a separate result."""
    found = [
        pair
        for key, value in summary.items()
        if key not in NO_RESULTS
        for pair in flat(value, "" if key == "metrics" else key)
    ]
    return dict(found) | {f"warning: {text}": "there" for text in summary.get("warnings", ())}


def fields_of(run):
    """Returns the value of each field of a run's scenario as a text, by the path of the field. The text of a file is
    its name and a checksum of its contents. Expectations are excluded, because they do not change a run.
    """
    if not (run / SCENARIO).is_file():
        raise InputError(f"{run / SCENARIO}: {absence_of(run / SCENARIO)}")
    scenario = read_object(run / SCENARIO, parse_float=str, parse_int=str)
    found = dict(flat({key: value for key, value in scenario.items() if key != "expect"}))
    files = {
        path: run / name
        for path, name in found.items()
        if path.endswith(".file") and (run / name).is_file()
    }
    return found | {
        path: f"{file.name}, {zlib.crc32(read_bytes(file)):08x}" for path, file in files.items()
    }


def changed(a, b):
    """Compares two dicts of texts. Returns (name, text in `a`, text in `b`, difference, relative difference) of each
    name whose texts differ. If only one of the dicts has the name, the text of the other is "-"."""
    return [
        (name, a.get(name, "-"), b.get(name, "-"), *sizes(a.get(name, "-"), b.get(name, "-")))
        for name in {**a, **b}
        if a.get(name) != b.get(name)
    ]


def number(text):
    return float(text) if is_number(text) else math.nan


def sizes(a, b, largest=0.0):
    """Returns the absolute difference |a - b| and the relative difference |a - b| / max(`largest`, |a|, |b|). Both are
    NO_NUMBER if a or b is not a finite number, and 0 if a equals b."""
    x, y = number(a), number(b)
    size = abs(x - y) if math.isfinite(x) and math.isfinite(y) else NO_NUMBER
    return size, size / max(largest, abs(x), abs(y)) if 0 < size < NO_NUMBER else size


def of_tables(a, b):
    """Returns an entry for each column that differs: the row with the largest absolute difference, with both values.
    The relative difference is the difference divided by the largest magnitude in the column. If the tables
    have different numbers of rows, a further entry states both numbers. If they have different columns, a further entry
    states both lists of columns."""
    (names_a, rows_a), (names_b, rows_b) = read_rows(a), read_rows(b)
    found = [
        (what, one, other, NO_NUMBER, NO_NUMBER)
        for what, one, other in (
            ("rows", len(rows_a), len(rows_b)),
            ("columns", ", ".join(names_a), ", ".join(names_b)),
        )
        if one != other
    ]
    for name in (name for name in names_a if name in names_b):
        values = [
            [row[names.index(name)] for row in rows]
            for names, rows in ((names_a, rows_a), (names_b, rows_b))
        ]
        if values[0] == values[1]:
            continue
        largest = max(
            (abs(x) for x in map(number, values[0] + values[1]) if math.isfinite(x)), default=0.0
        )
        by_row = [
            (sizes(x, y, largest), -row, x, y) for row, (x, y) in enumerate(zip(*values)) if x != y
        ]
        if by_row:
            (size, relative), row, x, y = max(by_row)
            found.append(
                (
                    f"{name}, row {-row} (first {min(-entry[1] for entry in by_row)})",
                    x,
                    y,
                    size,
                    relative,
                )
            )
    return found


def are_equal(found, tolerance):
    """Returns True if all differences are numbers within a relative tolerance. An entry that only A or only B has is
    always a difference. The state hash, which changes with any bit, counts only if the tolerance is 0. Differences of
    the scenarios' fields do not count.
    """
    return all(
        relative <= tolerance and tolerance > 0 or (tolerance > 0 and name.startswith("state_hash"))
        for tables in found.values()
        for kind, entries in tables.items()
        if kind != "field"
        for name, _, _, _, relative in entries
    )


def cut(value):
    text = str(value)
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


def in_words(a, b, found, tolerance):
    """Returns the printed text about the differences."""
    lines = [f"A {a}", f"B {b}", ""]
    for path, tables in found.items():
        rows = [
            (kind, name, cut(one), cut(other), "" if relative == NO_NUMBER else f"{relative:.3g}")
            for kind, entries in tables.items()
            for name, one, other, _, relative in entries
        ]
        if len(found) > 1:
            lines += [f"{path or 'paths'}: {len(rows) or 'nothing'} different"]
        if rows:
            rows.insert(0, ("", "", "A", "B", "relative"))
            widths = [max(map(len, column)) for column in zip(*rows)]
            for kind, name, *numbers in rows:
                cells = [
                    kind.ljust(widths[0]),
                    name.ljust(widths[1]),
                    *(text.rjust(width) for text, width in zip(numbers, widths[2:])),
                ]
                lines.append("  ".join(cells).rstrip())
            lines.append("")
    within = f" within a relative tolerance of {tolerance:g}" if tolerance else ""
    return "\n".join(
        [*lines, f"the results are {'' if are_equal(found, tolerance) else 'not '}equal{within}"]
    )
