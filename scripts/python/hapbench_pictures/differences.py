"""What differs between the results A and B of two runs, or of two folders with several: a regression test.

Results are the outcome, the metrics and warnings of summary.json, trajectory.csv and sweep.csv. Fields of the scenario are shown
but do not count; provenance, times and counted work are not looked at."""
import json
import math
import zlib

from hapbench.columns import read_rows
from hapbench_report.json_input import InputError, load_object

SUMMARY, SWEEP, TRAJECTORY = "summary.json", "sweep.csv", "trajectory.csv"
NO_RESULTS = ("name", "algorithm", "expected", "warnings", "diagnosis", "work", "provenance", "state_hash")
LONGEST = 24  # of a printed value
NO_NUMBER = math.inf  # the size of a difference of which not both are numbers


def differences(a, b):
    """A dictionary of all that differs; runs and sweeps are paired by their paths below the folders `a` and `b`."""
    in_a, in_b = results_below(a), results_below(b)
    pairs = [path for path in in_a if path in in_b]
    if not pairs:
        raise InputError(f"{a} has {in_a[0]} and {b} has {in_b[0]}, nothing by the same name; allowed: the folders of two runs, or of "
                         "several each")
    return {"runs": {path.parent.as_posix(): of_runs(a / path.parent, b / path.parent) for path in pairs if path.name == SUMMARY},
            "sweeps": {path.as_posix(): of_tables(a / path, b / path) for path in pairs if path.name == SWEEP},
            "only_in_a": [str(path) for path in in_a if path not in in_b], "only_in_b": [str(path) for path in in_b if path not in in_a]}


def results_below(folder):
    if not folder.is_dir():
        raise InputError(f"{folder}: is not a folder; allowed: that of a run, or of several")
    found = sorted(file.relative_to(folder) for name in (SUMMARY, SWEEP) for file in folder.rglob(name))
    if not found:
        raise InputError(f"{folder}: is not the folder of a run: it has no {SUMMARY}, nor has any below it")
    return found


def of_runs(a, b):
    told_a, told_b = read_object(a / SUMMARY), read_object(b / SUMMARY)
    results_a, results_b = results_of(told_a), results_of(told_b)
    tables = [(folder / TRAJECTORY).is_file() for folder in (a, b)]
    fields_a, fields_b = fields_of(a), fields_of(b)
    return {"fields": changed(fields_a, fields_b, {**fields_a, **fields_b}),
            "results": changed(results_a, results_b, [name for name in results_a if name in results_b]),
            "unshared": ["< " + name for name in results_a if name not in results_b] + ["> " + name for name in results_b if name not in results_a],
            "state_hash": [told_a.get("state_hash"), told_b.get("state_hash")],
            "trajectory": of_tables(a / TRAJECTORY, b / TRAJECTORY) if all(tables) else "in one of them alone" if any(tables) else None}


def read_object(file):
    """A JSON object with its numbers as they are written. Raises InputError."""
    return load_object(file, parse_float=str, parse_int=str)


def flat(value, path=""):
    """The leaves as texts, by their paths."""
    parts = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    if not parts:
        yield path, value if isinstance(value, str) else "" if value is None else json.dumps(value)
    for key, part in parts:
        yield from flat(part, f"{path}.{key}" if path else str(key))


def results_of(told):
    """Metrics have no section in front of their names, as in `expect`; warnings stand for themselves."""
    found = [pair for key, value in told.items() if key not in NO_RESULTS for pair in flat(value, "" if key == "metrics" else key)]
    return dict(found) | {f"warning: {text}": "" for text in told.get("warnings", ())}


def fields_of(run):
    """Files, which a scenario names from its own folder, by what they hold. Expectations do not change a run."""
    found = dict(flat({key: value for key, value in read_object(run / "scenario.effective.json").items() if key != "expect"}))
    files = {path: run / name for path, name in found.items() if path.endswith(".file") and (run / name).is_file()}
    return found | {path: f"{file.name}, {zlib.crc32(file.read_bytes()):08x}" for path, file in files.items()}


def changed(a, b, names):
    return {name: difference(a.get(name, ""), b.get(name, "")) for name in names if a.get(name) != b.get(name)}


def number(text):
    try:
        return float(text)
    except ValueError:
        return math.nan


def difference(a, b):
    """`largest` |a - b|, `relative` to the larger of the two."""
    x, y = number(a), number(b)
    size = abs(x - y) if math.isfinite(x) and math.isfinite(y) else NO_NUMBER
    return {"a": a, "b": b, "largest": size, "relative": size / max(abs(x), abs(y)) if 0 < size < NO_NUMBER else size}


def of_tables(a, b):
    """Of each column that differs the largest difference, its row, and its size relative to the column's largest magnitude."""
    (names_a, rows_a), (names_b, rows_b) = read_rows(a), read_rows(b)
    shared = [name for name in names_a if name in names_b]
    columns, first = {}, None
    for name in shared:
        values = [[row[names.index(name)] for row in rows] for names, rows in ((names_a, rows_a), (names_b, rows_b))]
        sizes = [(difference(x, y)["largest"], -row) for row, (x, y) in enumerate(zip(*values)) if x != y]
        if not sizes:
            continue
        size, row = max(sizes)
        magnitude = max((abs(x) for x in map(number, values[0] + values[1]) if math.isfinite(x)), default=0.0)
        columns[name] = {"largest": size, "row": -row, "relative": size / magnitude if 0 < size < NO_NUMBER else size}
        start = max(row for _, row in sizes)
        if first is None or -start < first["row"]:
            first = {"row": -start, "column": name, "a": values[0][-start], "b": values[1][-start]}
    return {"rows": [len(rows_a), len(rows_b)], "first": first, "columns": columns, "only_in_a": [name for name in names_a if name not in shared],
            "only_in_b": [name for name in names_b if name not in shared], "reordered": shared != [name for name in names_b if name in shared]}


def are_equal(found, tolerance):
    """Whether nothing but numbers within a relative tolerance differs. What one of them alone has always counts; the state hash, which
    changes with any bit, at a tolerance of 0."""
    def close(table):
        if table is None:
            return True
        return table != "in one of them alone" and table["rows"][0] == table["rows"][1] and not (
            table["only_in_a"] or table["only_in_b"] or table["reordered"]) and within(
            {name: of for name, of in table["columns"].items() if tolerance == 0 or name != "state_hash"})

    def within(of):
        return all(tolerance > 0 and one["relative"] <= tolerance for one in of.values())

    return not found["only_in_a"] and not found["only_in_b"] and all(map(close, found["sweeps"].values())) and all(
        within(run["results"]) and not run["unshared"] and close(run["trajectory"]) and
        (tolerance > 0 or run["state_hash"][0] == run["state_hash"][1]) for run in found["runs"].values())


# ---- For people

def aligned(headings, rows):
    """Lines, the first column to the left; none without rows."""
    if not rows:
        return []
    table = [headings, *rows]
    widths = [max(len(row[i]) for row in table) for i in range(len(headings))]
    return ["  ".join([row[0].ljust(widths[0]), *(text.rjust(width) for text, width in zip(row[1:], widths[1:]))]).rstrip() for row in table] + [""]


def cut(text):
    return "-" if text == "" else text if len(text) <= LONGEST else text[:LONGEST - 3] + "..."


def size(value):
    return "no number" if value == NO_NUMBER else f"{value:.3g}"


def lines_of_table(name, table):
    if not isinstance(table, dict):
        return [f"{name}: {table}"] if table else []
    a, b = table["rows"]
    first = table["first"]
    lines = [f"{name}: {a if a == b else f'{a} and {b}'} rows, " + (
        f"first different in row {first['row']} (from 0), column {first['column']}: {cut(first['a'])} and {cut(first['b'])}"
        if first else "the same as far as both go")]
    for side in "ab":
        if alone := table[f"only_in_{side}"]:
            lines.append(f"  columns of {side.upper()} alone: {', '.join(alone)}")
    if table["reordered"]:
        lines.append("  the columns are in another order")
    return lines + aligned(("column", "largest difference", "in row", "of the column's largest"),
                           [(column, size(of["largest"]), str(of["row"]), size(of["relative"])) for column, of in table["columns"].items()])


def lines_of_run(run):
    lines = aligned(("field", "A", "B"), [(name, cut(of["a"]), cut(of["b"])) for name, of in run["fields"].items()])
    lines += aligned(("result", "A", "B", "relative"), [(name, cut(of["a"]), cut(of["b"]), size(of["relative"])) for name, of in run["results"].items()])
    if run["unshared"]:
        lines += ["in A (<) or B (>) alone:", *("  " + name for name in run["unshared"])]
    return lines + lines_of_table(TRAJECTORY, run["trajectory"])


def in_words(a, b, found, tolerance):
    lines = [f"A {a}", f"B {b}", ""]
    if len(found["runs"]) == 1:
        lines += lines_of_run(*found["runs"].values())
    else:
        largest = lambda run: max((of["relative"] for of in run["results"].values()), default=0.0)
        lines += aligned(("run", "is", "fields", "results", "largest relative"),
                         [(path, "equal" if are_equal({"runs": {path: run}, "sweeps": {}, "only_in_a": (), "only_in_b": ()}, tolerance) else "differs",
                           str(len(run["fields"])), str(len(run["results"])), size(largest(run))) for path, run in found["runs"].items()])
    for path, table in found["sweeps"].items():
        lines += lines_of_table(path, table)
    lines += [f"in {side.upper()} alone: {', '.join(found[f'only_in_{side}'])}" for side in "ab" if found[f"only_in_{side}"]]
    within = f" within a relative tolerance of {tolerance:g}" if tolerance else ""
    return "\n".join([*lines, f"the results are {'' if are_equal(found, tolerance) else 'not '}equal{within}"])
