"""Reads CSV files. Columns of numbers from a million rows in seconds: only those asked for, by numpy, piece by piece."""
import csv

import numpy as np

from .errors import ResultError

PIECE_BYTES = 1 << 25
# Columns of texts, some of which look like numbers.
TEXTS = ("state_hash",)
COMMA, NEWLINE = ord(","), ord("\n")


def header(file):
    """The names in the first line."""
    try:
        with file.open(encoding="utf-8") as stream:
            return stream.readline().strip().split(",")
    except (OSError, UnicodeDecodeError) as error:
        raise ResultError(f"{file}: cannot be read: {error}") from error


def read_columns(file, names=None, may_be_empty=False):
    """Arrays by name, of all columns or of those named; NaN for an empty field, which is how a row without contact has no
    ratio."""
    every = header(file)
    names = every if names is None else names
    absent = [name for name in names if name not in every]
    if absent:
        raise ResultError(f"{file}: line 1: no column {absent[0]}")
    parts, line = [], 2
    for piece in whole_lines(file):
        stops = ends_of_fields(piece, len(every), file, line)
        parts.append([values(piece, stops, every.index(name), file, line, name) for name in names])
        line += len(stops)
    if not parts:
        if may_be_empty:
            return {name: np.empty(0) for name in names}
        raise ResultError(f"{file}: holds no row")
    return {name: np.concatenate([part[i] for part in parts]) for i, name in enumerate(names)}


def whole_lines(file):
    """The bytes after the first line, in pieces that end with a line."""
    with file.open("rb") as stream:
        stream.readline()
        rest = b""
        while piece := stream.read(PIECE_BYTES):
            piece = rest + piece.replace(b"\r", b"")
            end = piece.rfind(b"\n") + 1
            rest = piece[end:]
            if end:
                yield np.frombuffer(piece, np.uint8, end)
        if rest:
            yield np.frombuffer(rest + b"\n", np.uint8)


def ends_of_fields(piece, columns, file, line):
    """Offsets of the ends of the fields: a row for each line."""
    stops = np.flatnonzero((piece == COMMA) | (piece == NEWLINE))
    last = np.flatnonzero(piece[stops] == NEWLINE)
    fields = np.diff(last, prepend=-1)
    wrong = np.flatnonzero(fields != columns)
    if wrong.size:
        raise ResultError(f"{file}: line {line + wrong[0]}: got {fields[wrong[0]]} fields; allowed: {columns}")
    return stops.reshape(-1, columns)


def values(piece, stops, column, file, line, name):
    """One column as numbers: its texts side by side in an array of fixed width, which numpy parses at once."""
    ends = stops[:, column]
    starts = 1 + (stops[:, column - 1] if column else np.concatenate([[-1], stops[:-1, -1]]))
    width = max(3, int((ends - starts).max()))  # 3: room for "nan"
    places = starts[:, None] + np.arange(width)
    texts = np.where(places < ends[:, None], piece[np.minimum(places, len(piece) - 1)], 0).astype(np.uint8)
    texts = np.ascontiguousarray(texts).view(f"S{width}").ravel()
    texts[starts == ends] = b"nan"
    try:
        return texts.astype(float)
    except ValueError:
        bad = next(i for i, text in enumerate(texts) if not is_number(text))
        raise ResultError(f"{file}: line {line + bad}: {name}: got {texts[bad][:40].decode(errors='replace')}; "
                         "allowed: a number") from None


def is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


def read_rows(file):
    """The names in the first line, and the other rows as lists of texts."""
    try:
        with file.open(encoding="utf-8", newline="") as stream:
            rows = [row for row in csv.reader(stream) if row]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ResultError(f"{file}: cannot be read: {error}") from error
    if not rows:
        raise ResultError(f"{file}: empty; allowed: a header line and rows")
    for line, row in enumerate(rows[1:], start=2):
        if len(row) != len(rows[0]):
            raise ResultError(f"{file}: line {line}: got {len(row)} fields; allowed: {len(rows[0])}, as in the header")
    return rows[0], rows[1:]


def read_records(file):
    """Rows as dictionaries of texts, for tables that hold names or gaps."""
    names, rows = read_rows(file)
    return [dict(zip(names, row)) for row in rows]


def read_mixed(file):
    """All columns by name: of numbers where every field is one or empty, else of texts."""
    try:
        return read_columns(file, may_be_empty=True)
    except ResultError:
        names, rows = read_rows(file)
        return {name: numbers_or_texts(name, [row[i] for row in rows]) for i, name in enumerate(names)}


def numbers_or_texts(name, texts):
    if name not in TEXTS:
        try:
            return np.array([float(text) if text else np.nan for text in texts])
        except ValueError:
            pass
    return np.array(texts, dtype=object)
