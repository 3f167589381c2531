"""Text files of numbers: lines, separators, decimal commas and names of columns. Used by `import stroke` and `import
device`."""
import csv
import math
import re
from contextlib import suppress
from dataclasses import dataclass, field

from hapbench_command import fail, finite_number

from .columns import UNITS

MOST_COLUMNS = 1000
SAMPLED = 20  # number of lines from which the separator is determined
SEPARATORS = (b",", b";", b"\t", None)  # None stands for blanks
_BLANK = b" \t\r"
_COMMA_NUMBER = re.compile(rb"[+-]?(\d+,\d*|,\d+)([eE][+-]?\d+)?")
_THOUSANDS = re.compile(rb"[+-]?[1-9]\d{0,2}(,\d{3})+(\.\d*)?")
_WHOLE = re.compile(rb"[+-]?\d+([eE][+-]?\d+)?")
_NOT_A_NUMBER = re.compile(rb"[+-]?(nan|inf|infinity)", re.IGNORECASE)


@dataclass
class Table:
    names: list  # names as in the file, without quotes; "" for a column without a name
    rows: list  # lists of cells (bytes)
    lines: list  # line number of each row
    separator: bytes | None
    notes: list = field(default_factory=list)  # skipped or repaired parts, each mentioned once


def read_table(data, file, by_blanks=False, names_of=None):
    """Returns the rows and the names of columns of a text file. The names come from a header: the first line if none of
    its cells is a number, or the last comment line before the rows with as many cells as the rows. `names_of`: function
    that makes names from the words of the first line in any case."""
    notes = []
    lines, comments = _lines(_utf8(data, file, notes))
    if not lines:
        fail("no samples; allowed: a line for each", file)
    separator = None if by_blanks else _separator([line for _, line in lines[:SAMPLED]])
    if names_of is None:
        lines = _from_header_on(lines, separator, notes)
    number, first = lines[0]
    words = split(first, separator)
    if len(words) > MOST_COLUMNS:
        fail(f"got {len(words)} columns; allowed: {MOST_COLUMNS}", f"{file}, line {number}")
    names = names_of(words) if names_of else _header(words)
    if names:
        lines = lines[1:]
        if names_of is None and lines and (units := _units_of(split(lines[0][1], separator))):
            notes.append(f"line {lines[0][0]} has the units of the columns")
            names = [f"{name} [{unit}]" if unit else name for name, unit in zip(names, units)]
            lines = lines[1:]
    header_line = number if names else None
    if not names:
        header_line, names = _commented_header(comments, number, len(words), separator)
    ignored = [at for at, _ in comments if at != header_line]
    if ignored:
        notes.append(
            f"{counted(len(ignored), 'comment line')} skipped, the first: line {ignored[0]}"
        )
    table = Table(
        names or [""] * len(words),
        [split(line, separator) for _, line in lines],
        [number for number, _ in lines],
        separator,
        notes,
    )
    _drop_trailing_separators(table)
    _refuse_decimal_commas_between_commas(table, file)
    return table


def counted(count, thing):
    return f"{count} {thing}" if count == 1 else f"{count} {thing}s"


def _utf8(data, file, notes):
    """Converts the bytes of a text to UTF-8 without a byte order mark."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        try:
            data = data.decode("utf-16").encode()
        except UnicodeDecodeError:
            fail("begins as UTF-16, and is none; allowed: UTF-8", file)
        notes.append("the text is UTF-16; it was read as such")
    return data.removeprefix(b"\xef\xbb\xbf")


def _lines(data):
    """Returns lines with their numbers, and separately the comments, which begin with # or %. Blank lines are skipped.
    A line ends with LF, CR LF or, as on old Macs, CR."""
    raw = data.split(b"\n")
    if any(b"\r" in line.rstrip(b"\r") for line in raw):
        raw = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n").split(b"\n")
    lines, comments = [], []
    for number, line in enumerate(raw, 1):
        # A tab at an end may separate an empty cell of a table with empty columns.
        bare = line.strip(_BLANK)
        if bare:
            kept = line.strip(b" \r") if b"\t" in line else bare
            (comments if bare[0] in b"#%" else lines).append((number, kept))
    return lines, comments


def split(line, separator):
    """Returns the cells of a line, without blanks and quotes."""
    if separator is None:
        return line.split()
    if b'"' in line:
        text = line.decode("utf-8", "surrogateescape")
        with suppress(csv.Error):
            cells = next(csv.reader([text], delimiter=separator.decode(), skipinitialspace=True))
            return [cell.encode("utf-8", "surrogateescape").strip(_BLANK) for cell in cells]
    cells = [cell.strip(_BLANK) for cell in line.split(separator)]
    if b"'" not in line:
        return cells
    return [
        cell[1:-1] if cell[:1] == cell[-1:] == b"'" and cell != b"'" else cell for cell in cells
    ]


def is_number(cell):
    """Returns True for a number and for "nan". A number may have a decimal comma if commas do not separate cells, or if
    the number is quoted."""
    return (
        not math.isnan(finite_number(cell))
        or _NOT_A_NUMBER.fullmatch(cell) is not None
        or _COMMA_NUMBER.fullmatch(cell) is not None
    )


def _separator(lines):
    """Returns the separator with the smallest fraction of cells that are not numbers; among equal fractions, the
    separator with the most cells."""
    sample = lines[1:] or lines  # the first line may have names

    def rank(separator):
        cells = [cell for line in sample for cell in split(line, separator)]
        words = sum(1 for cell in cells if cell and not is_number(cell))
        return words / max(1, len(cells)), -len(cells)

    return min(SEPARATORS, key=rank)


def _header(words):
    """Returns the words as names; empty if one of them is a number or all of them are "nan" or empty."""
    named = [word for word in words if word and not _NOT_A_NUMBER.fullmatch(word)]
    if not named or any(is_number(word) and not _NOT_A_NUMBER.fullmatch(word) for word in words):
        return []
    return [word.decode("utf-8", "surrogateescape") for word in words]


def _from_header_on(lines, separator, notes):
    """Removes the lines above a header that have another number of cells than the header and the rows."""
    rows = [split(line, separator) for _, line in lines[: 2 * SAMPLED]]
    counts = [len(row) - (not row[-1]) for row in rows]  # a separator may be at the end
    later = counts[len(counts) // 2 :]
    first = counts.index(max(set(later), key=later.count))
    if not first or not _header(rows[first]):
        return lines
    notes.append(
        f"{counted(first, 'line')} above the header skipped, the first: line {lines[0][0]}"
    )
    return lines[first:]


def _units_of(words):
    """Returns the units in a line below the header, "" for a column without a unit; empty if a word is not a unit."""
    words = [word.decode("utf-8", "replace").strip("[]()") for word in words]
    is_unit = [
        word in ("", "-") or any(word in known for known in UNITS.values()) for word in words
    ]
    if not all(is_unit) or not any(word not in ("", "-") for word in words):
        return []
    return ["" if word == "-" else word for word in words]


def _commented_header(comments, before, count, separator):
    """Returns line number and names of a header such as "% time,x,y,z" above the line `before`."""
    for number, comment in reversed(comments):
        text = comment.lstrip(b"#% \t")
        # A comment often has blanks between its names, even if the numbers have another separator.
        for words in (split(text, separator), split(text, None)):
            if number < before and len(words) == count and (names := _header(words)):
                return number, names
    return None, []


def _drop_trailing_separators(table):
    """Removes an empty cell at the end of rows that have one more cell than the header, and an empty name if the rows
    have one cell less."""
    width = len(table.names)
    longer = [i for i, row in enumerate(table.rows) if len(row) == width + 1 and not row[-1]]
    for i in longer:
        table.rows[i].pop()
    if longer:
        table.notes.append(
            f"a separator at the end of {counted(len(longer), 'line')} ignored, the first: "
            f"line {table.lines[longer[0]]}"
        )
    if width < 2 or table.names[-1] or not table.rows:
        return
    if any(table.names) and all(len(row) == width - 1 for row in table.rows):
        table.names.pop()
        table.notes.append("a separator at the end of the header ignored")
    elif all(len(row) == width and not row[-1] for row in table.rows):
        for cells in (table.names, *table.rows):
            cells.pop()
        table.notes.append("a separator at the end of every line ignored")


def _refuse_decimal_commas_between_commas(table, file):
    """Refuses rows such as "0,002,0,0008", in which two numbers with decimal commas look like four integers."""
    wrong = [i for i, row in enumerate(table.rows) if len(row) != len(table.names)]
    if table.separator != b"," or 2 * len(wrong) <= len(table.rows):
        return
    if all(_WHOLE.fullmatch(cell) for i in wrong[:SAMPLED] for cell in table.rows[i]):
        fail(
            f"got {len(table.rows[wrong[0]])} values; allowed: {len(table.names)}. Numbers with a decimal comma cannot "
            "be separated by commas: export the file with a decimal point, or with semicolons between the numbers",
            f"{file}, line {table.lines[wrong[0]]}",
        )


def has_decimal_commas(rows):
    """Returns True if the commas of some cell can only be decimal commas, as in "0,002" but not in "1,234"."""
    return any(
        _COMMA_NUMBER.fullmatch(cell) and not _THOUSANDS.fullmatch(cell)
        for row in rows
        for cell in row
        if b"," in cell
    )


def with_points(cells, is_comma_decimal):
    """Returns (cells of a column with a decimal point, index of the first cell with a decimal comma, index of the first
    cell with an ambiguous comma, such as "1,234"). An index is None if there is no such cell."""
    commas = [i for i, cell in enumerate(cells) if b"," in cell and _COMMA_NUMBER.fullmatch(cell)]
    if not is_comma_decimal:
        grouped = (i for i, cell in enumerate(cells) if _THOUSANDS.fullmatch(cell))
        return cells, None, next(grouped, None)
    if not commas:
        return cells, None, None
    # A column has one decimal sign: in a column with decimal commas, a cell with a point is not a number.
    cells = [cell.replace(b",", b".") if b"." not in cell else b"" for cell in cells]
    return cells, commas[0], None
