"""Reads CSV files: columns of numbers with numpy, in chunks, so that a million rows take seconds; and rows of texts."""
import csv

import numpy as np

from .errors import ResultError

PIECE_BYTES = 1 << 25
# Columns that hold texts, although some of these texts look like numbers.
TEXTS = ("state_hash",)


def header(file):
    """The names in the first line."""
    try:
        with file.open(encoding="utf-8") as stream:
            return stream.readline().strip().split(",")
    except (OSError, UnicodeDecodeError) as error:
        raise ResultError(f"{file}: cannot be read: {error}") from error


def read_columns(file, names=None, may_be_empty=False):
    """Returns arrays by name, of all columns or of the columns `names`. An empty field becomes NaN, such as the ratio
    of a row without contact."""
    every = header(file)
    names = every if names is None else list(names)
    absent = [name for name in names if name not in every]
    if absent:
        raise ResultError(f"{file}: line 1: no column {absent[0]}")
    wanted, parts = [every.index(name) for name in names], []
    with file.open("rb") as stream:
        stream.readline()
        while piece := b"".join(stream.readlines(PIECE_BYTES)):
            try:
                parts.append(numbers_in(piece.replace(b"\r", b""), len(every), wanted))
            except ValueError:
                raise ResultError(fault_of(file, names)) from None
    if not parts and not may_be_empty:
        raise ResultError(f"{file}: holds no row")
    table = np.concatenate(parts) if parts else np.empty((0, len(names)))
    return {name: np.ascontiguousarray(values) for name, values in zip(names, table.T)}


def numbers_in(lines, columns, wanted):
    """Returns the `wanted` columns of complete lines, with one row for each line. Raises ValueError."""
    lines = lines.rstrip(b"\n")
    if lines.count(b",") != (lines.count(b"\n") + 1) * (columns - 1):
        raise ValueError
    fields = lines.replace(b"\n", b",").split(b",")
    return np.array(
        [
            [float(field) if field else np.nan for field in fields[column::columns]]
            for column in wanted
        ]
    ).T


def fault_of(file, names):
    """Returns the error message for a table whose columns `names` are not numbers."""
    every, rows = read_rows(file)
    for line, row in enumerate(rows, start=2):
        for name in names:
            text = row[every.index(name)]
            if text and not is_number(text):
                return f"{file}: line {line}: {name}: got {text[:40]}; allowed: a number"
    return f"{file}: holds an empty line; allowed: {len(every)} fields in every line"


def is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


def plain_text(text):
    """A cell's text without the apostrophe that hapbench writes before a text that resembles a formula."""
    return text[1:] if text[:1] == "'" and text.lstrip("'")[:1] in tuple("=+-@\t\r") else text


def read_rows(file):
    """The names in the first line, and the other rows as lists of texts."""
    try:
        with file.open(encoding="utf-8", newline="") as stream:
            rows = [[plain_text(text) for text in row] for row in csv.reader(stream) if row]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ResultError(f"{file}: cannot be read: {error}") from error
    if not rows:
        raise ResultError(f"{file}: empty; allowed: a header line and rows")
    for line, row in enumerate(rows[1:], start=2):
        if len(row) != len(rows[0]):
            raise ResultError(
                f"{file}: line {line}: got {len(row)} fields; allowed: {len(rows[0])}, as in the header"
            )
    return rows[0], rows[1:]


def read_records(file):
    """Rows as dictionaries of texts, for tables that hold names or gaps."""
    names, rows = read_rows(file)
    return [dict(zip(names, row)) for row in rows]


def read_mixed(file):
    """Returns all columns by name: as numbers if every field is a number or empty, else as texts."""
    try:
        return read_columns(file, may_be_empty=True)
    except ResultError:
        names, rows = read_rows(file)
        return {
            name: numbers_or_texts(name, [row[i] for row in rows]) for i, name in enumerate(names)
        }


def numbers_or_texts(name, texts):
    if name not in TEXTS and all(not text or is_number(text) for text in texts):
        return np.array([float(text) if text else np.nan for text in texts])
    return np.array(texts, dtype=object)


def numbers(records, name):
    """Returns a column of `records` as numbers; a missing value becomes NaN."""
    return np.array([float(row[name]) if row[name] else np.nan for row in records])
