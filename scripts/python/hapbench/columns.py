"""Reads CSV files. Columns of numbers are read with numpy in chunks, so that a million rows take only seconds. Other
tables are read as rows of texts."""
import csv

import numpy as np

from .errors import ResultError

PIECE_BYTES = 1 << 25
# Names of columns that always hold texts, although some of their texts look like numbers.
TEXTS = ("state_hash",)


def header(file):
    """Returns the names of the columns, from the first line of a table."""
    try:
        with file.open(encoding="utf-8") as stream:
            return stream.readline().strip().split(",")
    except (OSError, UnicodeDecodeError) as error:
        raise ResultError(f"{file}: cannot be read: {error}") from error


def read_columns(file, names=None, may_be_empty=False):
    """Returns arrays of numbers by column name: all columns, or the columns `names`. An empty field, such as the
    stiffness ratio of a row without contact, becomes NaN."""
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
    """Returns the numbers in the `wanted` columns, with one row for each line. `lines`: bytes of complete lines.
    `columns`: number of columns. Raises ValueError if a line has another number of columns or a field is not a number.
    """
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
    """Returns the error message for a table that numbers_in() rejects: it names the first field of the columns `names`
    that is not a number. If there is no such field, it says that the table has an empty line."""
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
    """Returns the text of a cell without the apostrophe that hapbench writes before a text that resembles a formula."""
    return text[1:] if text[:1] == "'" and text.lstrip("'")[:1] in tuple("=+-@\t\r") else text


def read_rows(file):
    """Returns (names in the first line, other rows as lists of texts)."""
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
    """Returns the rows as dictionaries of texts, for tables that contain names or empty fields."""
    names, rows = read_rows(file)
    return [dict(zip(names, row)) for row in rows]


def read_mixed(file):
    """Returns all columns by name. A column becomes an array of numbers if each of its fields is a number or empty.
    Other columns remain texts."""
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
    """Returns the column `name` of `records` as numbers. An empty field becomes NaN."""
    return np.array([float(row[name]) if row[name] else np.nan for row in records])
