"""Reads CSV files. Columns of numbers are read with numpy in chunks, so that a million rows take only seconds. Other
tables are read as rows of texts."""
import csv
import errno
import io
import math
import shlex
from contextlib import contextmanager

import numpy as np

from .errors import ResultError

# Encoding of files that a user may edit. A spreadsheet may write a byte order mark, which this encoding skips.
ENCODING = "utf-8-sig"
PIECE_BYTES = 1 << 25
# Names of columns that always hold texts, although some of their texts look like numbers.
TEXTS = ("state_hash",)


CUT_LINE = "the last line has no line break, so that its last field may be cut off; allowed: complete lines"


def text_of(data, file, line=1):
    """Returns the text of bytes that are encoded as UTF-8, with or without a byte order mark. `line`: number of the
    first line. Raises ResultError that names the line of a byte that is not UTF-8."""
    try:
        return data.decode(ENCODING)
    except UnicodeDecodeError as error:
        line += error.object[: error.start].count(b"\n")
        raise ResultError(f"{file}: line {line}: not UTF-8 text; allowed: UTF-8") from None


def read_text(file):
    """Returns the content of a text file that a user may have edited."""
    return text_of(read_bytes(file), file)


def read_bytes(file):
    with readable(file):
        return file.read_bytes()


@contextmanager
def readable(file):
    """Turns an OSError in the `with` statement, which reads `file`, into a ResultError with the cause and a fix."""
    try:
        yield
    except OSError as error:
        again = "allowed: a file that hapbench wrote; repeat the command that writes it"
        permission = f"no permission to read the file; chmod u+r {shlex.quote(str(file))} gives it"
        causes = {
            errno.ENOENT: f"no such file; {again}",
            errno.EISDIR: f"is a folder; {again}",
            errno.ENOTDIR: f"a part of the path is a file, not a folder; {again}",
            errno.ELOOP: f"is a link that leads in a circle; {again}",
            errno.EACCES: permission,
            errno.EPERM: permission,
        }
        cause = causes.get(error.errno, f"cannot be read: {error.strerror}; {again}")
        raise ResultError(f"{file}: {cause}") from error


def header(file):
    """Returns the names of the columns, from the first line of a table."""
    with readable(file), file.open("rb") as stream:
        first = stream.readline()
    return text_of(first, file).strip().split(",")


def read_columns(file, names=None, may_be_empty=False, required=()):
    """Returns arrays of numbers by column name: all columns, or the columns `names`. An empty field, such as the
    stiffness ratio of a row without contact, becomes NaN. `required`: columns in which every field must be a finite
    number."""
    every = header(file)
    if every == [""]:
        raise ResultError(f"{file}: line 1: empty; allowed: a header line and rows")
    names = every if names is None else list(names)
    absent = [name for name in names if name not in every]
    if absent:
        raise ResultError(f"{file}: line 1: no column {absent[0]}")
    wanted, parts, last = [every.index(name) for name in names], [], b""
    finite = [name in required for name in names]
    with readable(file), file.open("rb") as stream:
        stream.readline()
        while piece := b"".join(stream.readlines(PIECE_BYTES)):
            try:
                parts.append(numbers_in(piece.replace(b"\r", b""), len(every), wanted, finite))
            except ValueError:
                raise ResultError(fault_of(file, names, required)) from None
            last = piece
    if last and not last.endswith(b"\n"):
        rows = sum(map(len, parts))
        raise ResultError(f"{file}: line {rows + 1}: {CUT_LINE}")
    if not parts and not may_be_empty:
        raise ResultError(f"{file}: holds no row")
    table = np.concatenate(parts) if parts else np.empty((0, len(names)))
    return {name: np.ascontiguousarray(values) for name, values in zip(names, table.T)}


def numbers_in(lines, columns, wanted, finite=()):
    """Returns the numbers in the `wanted` columns, with one row for each line. `lines`: bytes of complete lines.
    `columns`: number of columns. `finite`: for each wanted column, true if its fields must be finite numbers. Raises
    ValueError if a line has another number of columns or a field is not such a number."""
    lines = lines.rstrip(b"\n")
    if lines.count(b",") != (lines.count(b"\n") + 1) * (columns - 1):
        raise ValueError
    fields = lines.replace(b"\n", b",").split(b",")
    table = np.array(
        [
            [float(field) if field else np.nan for field in fields[column::columns]]
            for column in wanted
        ]
    )
    for values, is_finite in zip(table, finite):
        if is_finite and not np.isfinite(values).all():
            raise ValueError
    return table.T


def fault_of(file, names, required=()):
    """Returns the error message for a table that numbers_in() rejects: it names the first field of the columns `names`
    that is not a number, or not a finite number in the columns `required`. If there is no such field, the message says
    that the table has an empty line."""
    for row in read_records(file, is_whole=False):
        for name in names:
            text = row[name]
            if name in required and not is_finite_number(text):
                return row.fault(name, "a finite number")
            if text and not is_number(text):
                return row.fault(name, "a number")
    return f"{file}: holds an empty line; allowed: {len(header(file))} fields in every line"


def is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


def is_finite_number(text):
    return is_number(text) and math.isfinite(float(text))


def plain_text(text):
    """Returns the text of a cell without the apostrophe that hapbench writes before a text that resembles a formula."""
    return text[1:] if text[:1] == "'" and text.lstrip("'")[:1] in tuple("=+-@\t\r") else text


class Row(dict):
    """A row of a table: texts by column name. `file` and `line` state where the row is, for messages."""

    def __init__(self, names, texts, file, line):
        super().__init__(zip(names, texts))
        self.file, self.line = file, line

    def __missing__(self, name):
        raise ResultError(
            f"{self.file}: line 1: no column {name}; the file is not a table that hapbench wrote"
        )

    def fault(self, name, allowed):
        """Returns the message that the field `name` has a value that is not allowed."""
        text = self[name]
        got = text if len(text) <= 40 else f"{text[:39]}…"
        return f"{self.file}: line {self.line}: {name}: got {got or 'an empty field'}; allowed: {allowed}"


def number_in(row, name, may_be_empty=True, is_finite=False):
    """Returns the number in the field `name` of a row. An empty field is NaN. Raises ResultError for any other text,
    for the text "nan", and with `is_finite` for an infinite number."""
    text = row[name]
    if not text and may_be_empty:
        return math.nan
    allows = math.isfinite if is_finite else lambda number: not math.isnan(number)
    if not is_number(text) or not allows(float(text)):
        located = row if isinstance(row, Row) else Row(row, row.values(), "table", 0)
        allowed = f"a {'finite ' if is_finite else ''}number{' or an empty field' if may_be_empty else ''}"
        raise ResultError(located.fault(name, allowed))
    return float(text)


def numbered_rows(file, is_whole=True):
    """Returns (names in the first line, list of pairs: number of a line, texts of its fields). `is_whole`: true if a
    last line without a line break is an error."""
    content = read_text(file)
    reader = csv.reader(io.StringIO(content, newline=""))
    try:
        lines = [(reader.line_num, [plain_text(text) for text in row]) for row in reader if row]
    except csv.Error as error:
        raise ResultError(f"{file}: line {reader.line_num}: cannot be read: {error}") from error
    if not lines:
        raise ResultError(f"{file}: line 1: empty; allowed: a header line and rows")
    (_, names), *rows = lines
    for line, row in rows:
        if len(row) != len(names):
            raise ResultError(
                f"{file}: line {line}: got {len(row)} fields; allowed: {len(names)}, as in the header"
            )
    if is_whole and not content.endswith("\n"):
        raise ResultError(f"{file}: line {lines[-1][0]}: {CUT_LINE}")
    return names, rows


def read_rows(file):
    """Returns (names in the first line, other rows as lists of texts)."""
    names, rows = numbered_rows(file)
    return names, [row for _, row in rows]


def read_records(file, is_whole=True):
    """Returns the rows as objects of the class Row, for tables that contain names or empty fields. `is_whole`: true if
    a last line without a line break is an error."""
    names, rows = numbered_rows(file, is_whole)
    return [Row(names, row, file, line) for line, row in rows]


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
    """Returns the column `name` of `records` as numbers. An empty field becomes NaN. Raises ResultError for a field
    that is not a number. An infinite number, such as the limit of a loop that is always stable, becomes NaN.
    """
    values = np.array([number_in(row, name) for row in records], float)
    return np.where(np.isfinite(values), values, np.nan)
