"""Reads text files of numbers. Detects lines, separators, decimal commas and the names of columns. `import stroke` and
`import device` use this module."""
import codecs
import csv
import math
import re
from contextlib import suppress
from dataclasses import dataclass, field

from hapbench_command import fail, finite_number, quoted

from .header_units import (
    are_distinct,
    names_and_units,
    stated_units,
    units_of,
    with_commented_units,
    with_units,
)

MAX_COLUMNS = 1000
MAX_ABOVE = 40  # largest number of lines above the header of a file
MAX_LINES_OF_CELL = 50  # largest number of lines of a quoted cell
MAX_HEADERS = 8  # largest number of lines of a header
SAMPLED = 20  # number of lines in each sample from which the separator is determined
SEPARATORS = (b",", b";", b"\t", None)  # None stands for blanks
_BLANK = b" \t\r"
_COMMA_NUMBER = re.compile(rb"[+-]?(\d+,\d*|,\d+)([eE][+-]?\d+)?")
_THOUSANDS = re.compile(rb"[+-]?[1-9]\d{0,2}(,\d{3})+(\.\d*)?")
_WHOLE = re.compile(rb"[+-]?\d+([eE][+-]?\d+)?")
# Cell texts that stand for a missing value and are not names.
MISSING = {"", "-", "NA", "N/A", "#N/A", "na", "null", "NULL", "None"}
# First bytes of files that are not text, with the kind of the file.
PACKED = {
    b"\x1f\x8b": "compressed (gzip)",
    b"PK\x03\x04": "compressed (a zip file, or a workbook .xlsx)",
    b"BZh": "compressed (bzip2)",
    b"\xfd7zXZ\0": "compressed (xz)",
    b"\x28\xb5\x2f\xfd": "compressed (zstd)",
    b"\xd0\xcf\x11\xe0": "a workbook (.xls)",
    b"MATLAB 5.0 MAT-file": "a MAT-file",
    b"\x89HDF": "an HDF5 file (or a MAT-file of version 7.3)",
    b"#ROSBAG": "a ROS bag",
    b"\x89MCAP0": "an MCAP file",
    b"SQLite format 3": "a database (such as a ROS 2 bag)",
    b"PAR1": "a Parquet file",
}
UNPACKED = "a text, such as CSV (unpack or export the file)"
ENDINGS = {b"\0": "zero", b"\x1a": "Ctrl-Z, which ends a text on old systems"}
# Start and end of a quoted cell with line breaks.
_OPENING = re.compile(rb'(^|[,;\t ])\s*"[^"]*$')
_CLOSING = re.compile(rb'^[^"]*"\s*([,;\t ]|$)')
_OF_UNITS = re.compile(rb"^\s*[Uu]nits?\s*[:=]\s*")  # words in front of units in a comment
_QUOTED_OR_PLAIN = re.compile(rb'"([^"]*)"|(\S+)')
_NOT_A_NUMBER = re.compile(rb"[+-]?(nan|inf|infinity)", re.IGNORECASE)


@dataclass
class Table:
    names: list  # names as in the file, without quotes; "" for a column without a name
    rows: list  # lists of cells (bytes)
    lines: list  # line number of each row
    separator: bytes | None
    # Texts about skipped or repaired parts of the file; each kind is mentioned once.
    notes: list = field(default_factory=list)
    # Units in comments that do not state which columns have them: (line number, unit).
    stated_units: list = field(default_factory=list)
    # Comments that could also be the header: (line number, names).
    other_headers: list = field(default_factory=list)


def read_table(data, file, by_blanks=False, names_of=None):
    """Returns the Table of a text file: its rows and the names of its columns. The names come from a header. The header
    is the first line if none of its cells is a number, or the last comment line above the rows that has as many cells
    as the rows. `names_of`: function that makes the names from the words of the first line, which is then always the
    header; None if there is no such function."""
    notes = []
    lines, comments = _lines(_utf8(data, file, notes), notes)
    if not lines:
        fail("no samples; allowed: a line for each", file)
    separator = None if by_blanks else _separator([line for _, line in _sample(lines)])
    if names_of is None:
        lines = _from_header_on(lines, separator, notes)
    number, first = lines[0]
    words = split(first, separator)
    if len(words) > MAX_COLUMNS:
        fail(f"got {len(words)} columns; allowed: {MAX_COLUMNS}", f"{file}, line {number}")
    if names_of:
        names, lines = names_of(words), lines[1:]
    else:
        names, number, lines = _names_in_header(lines, separator, notes)
    first_row = lines[0][0] if lines else number + 1
    above = [one for one in comments if one[0] < first_row] if names_of is None else []
    used, headers = [], _commented_headers(above, len(words), separator)
    if not names or units_of(names):
        names, used = names_and_units(([(number, names)] if names else []) + headers, notes)
    else:
        names, used = with_commented_units(names, headers, notes)
    if (
        len(lines) > 1
        and names
        and _are_column_numbers([split(line, separator) for _, line in lines[:4]])
    ):
        notes.append(f"line {lines[0][0]} has the numbers of the columns and was skipped")
        lines = lines[1:]
    ignored = [at for at, _ in comments if at not in used]
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
        [one for one in stated_units(above) if one[0] not in used],
        [one for one in headers if one[0] not in used],
    )
    _drop_trailing_separators(table)
    _refuse_decimal_commas_between_commas(table, file)
    return table


def counted(count, thing):
    return f"{count} {thing}" if count == 1 else f"{count} {thing}s"


def _utf8(data, file, notes):
    """Returns the bytes of a text as UTF-8 without a byte order mark. Fails for a file that is not text."""
    for mark, kind in PACKED.items():
        if data.startswith(mark):
            fail(f"is {kind}, not a text; allowed: {UNPACKED}", file)
    encoding = _wide_encoding(data)
    if encoding:
        try:
            data = data.decode(encoding).encode()
        except UnicodeDecodeError:
            fail(
                f"begins like {encoding.upper()}, but is not valid {encoding.upper()}; allowed: UTF-8",
                file,
            )
        notes.append(f"the text is {encoding[:6].upper()}; it was read as such")
    data = data.removeprefix(codecs.BOM_UTF8)
    # Zero bytes at the end come from a file that was allocated before it was written.
    zero = data.rstrip(b"\0\r\n \x1a").find(b"\0")
    if zero >= 0:
        line = data.count(b"\n", 0, zero) + 1
        fail(
            "has a zero byte, so the file is not a text; allowed: a text in UTF-8",
            f"{file}, line {line}",
        )
    text = data.rstrip(b"\0\x1a")
    if len(text) < len(data):
        notes.append(
            f"{counted(len(data) - len(text), 'byte')} after the text ignored ({ENDINGS[data[-1:]]})"
        )
    if not text.isascii():
        try:
            text.decode()
        except UnicodeDecodeError:
            notes.append("the text is not UTF-8; it was read as Windows-1252")
            text = text.decode("cp1252", "replace").encode()
    return text


def _wide_encoding(data):
    """Returns the name of the encoding if the text is UTF-16 or UTF-32, otherwise None. The byte order mark decides;
    without it, the positions of the zero bytes in an ASCII text decide."""
    for mark, encoding in (
        (codecs.BOM_UTF32_LE, "utf-32"),
        (codecs.BOM_UTF32_BE, "utf-32"),
        (codecs.BOM_UTF16_LE, "utf-16"),
        (codecs.BOM_UTF16_BE, "utf-16"),
    ):
        if data.startswith(mark):
            return encoding
    start = data[: min(64, len(data) // 2 * 2)]
    for first, encoding in ((1, "utf-16-le"), (0, "utf-16-be")):
        zeros, letters = start[first::2], start[1 - first :: 2]
        if len(start) >= 8 and not any(zeros) and all(letters):
            return encoding
    return None


def _lines(data, notes):
    """Returns two lists of (number, line): the lines of data, and the comments, which begin with # or %. Blank lines
    are skipped. A line ends with LF, CR LF or CR. A line break in a quoted cell does not end a line. Adds a note if the
    last line has no line end, because a cell that is cut short may still be a number."""
    raw = data.split(b"\n")
    if any(b"\r" in line.rstrip(b"\r") for line in raw):
        raw = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n").split(b"\n")
    if len(raw) > 1 and raw[-1].strip(_BLANK) and not raw[-1].endswith(b"\r"):
        notes.append(f"line {len(raw)}, the last line, has no line end: is the file cut short?")
    numbered = enumerate(raw, 1)
    if b'"' in data:
        numbered = _with_whole_cells(list(numbered), notes)
    lines, comments = [], []
    for number, line in numbered:
        # A tab at the end of a line may separate an empty cell.
        bare = line.strip(_BLANK)
        if bare.strip(b',;\t "'):  # a line with only empty cells counts as blank
            kept = line.strip(b" \r") if b"\t" in line else bare
            (comments if bare[0] in b"#%" else lines).append((number, kept))
    return lines, comments


def _with_whole_cells(lines, notes):
    """Returns `lines`, a list of (number, line), in which the lines of a quoted cell with line breaks are joined by
    blanks. The joined line has the number of the first line."""
    found, at, joined = [], 0, []
    while at < len(lines):
        number, line = lines[at]
        last = at
        if line.count(b'"') % 2 and _OPENING.search(line):
            closing = (
                i
                for i in range(at + 1, min(at + MAX_LINES_OF_CELL, len(lines)))
                if b'"' in lines[i][1]
            )
            last = next(closing, at)
            is_end = lines[last][1].count(b'"') % 2 and _CLOSING.search(lines[last][1])
            if last > at and is_end:
                line = b" ".join(part.strip(b"\r") for _, part in lines[at : last + 1])
                joined.append(number)
            else:
                last = at
        found.append((number, line))
        at = last + 1
    if joined:
        notes.append(
            f"{counted(len(joined), 'quoted cell')} with a line break read as one cell, the first: line {joined[0]}"
        )
    return found


def split(line, separator):
    """Returns the cells of a line, without blanks and quotes."""
    if separator is None:
        if b'"' not in line:
            return line.split()
        return [
            found[1] if found[2] is None else found[2] for found in _QUOTED_OR_PLAIN.finditer(line)
        ]
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
    """Returns True for a number, "nan" and "inf". A number may have a decimal comma if commas do not separate cells, or
    if the number is quoted."""
    return (
        not math.isnan(finite_number(cell))
        or _NOT_A_NUMBER.fullmatch(cell) is not None
        or _COMMA_NUMBER.fullmatch(cell) is not None
    )


def _sample(lines):
    """Returns the first SAMPLED lines, and SAMPLED lines that lie more than MAX_ABOVE lines further below. A file may
    have up to MAX_ABOVE lines above its header, which say nothing about the separator."""
    return lines[:SAMPLED] + lines[SAMPLED + MAX_ABOVE :][:SAMPLED]


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
    """Returns the words of a line as names if the line can be a header. Returns an empty list if a word is a number, or
    if every word is empty, "nan" or "inf"."""
    named = [word for word in words if word and not _NOT_A_NUMBER.fullmatch(word)]
    if not named or any(is_number(word) and not _NOT_A_NUMBER.fullmatch(word) for word in words):
        return []
    return [word.decode("utf-8", "surrogateescape") for word in words]


def _from_header_on(lines, separator, notes):
    """Returns `lines` without the lines above the header. The header is one line or several lines directly above the
    first rows of numbers. Its lines have as many cells as these rows, or one cell more."""
    rows = [split(line, separator) for _, line in lines[: 2 * SAMPLED + MAX_ABOVE]]
    counts = [len(row) - (not row[-1]) for row in rows]  # a separator may be at the end
    numbers = [is_row(row) for row in rows]
    later = counts[len(counts) // 2 :]
    usual = max(set(later), key=later.count)
    first = next(
        (i for i in range(len(rows)) if counts[i] == usual and all(numbers[i : i + 2])), len(rows)
    )
    if first == len(rows):
        first = counts.index(usual)
    # The additional cell of a header is the name of a column without values.
    widths = (usual, usual + 1)
    while first and not numbers[first - 1] and _header(rows[first - 1]):
        above = rows[first - 1]
        if (counts[first - 1] if len(widths) > 1 else len(above)) not in widths:
            break
        first, widths = first - 1, (len(above),)
    if not first or not _header(rows[first]):
        return lines
    notes.append(
        f"{counted(first, 'line')} above the header skipped, the first: line {lines[0][0]}"
    )
    return lines[first:]


def is_row(words):
    """Returns True if more than half of the non-empty cells are numbers."""
    cells = [word for word in words if word]
    return 2 * sum(map(is_number, cells)) > len(cells)


def _names_in_header(lines, separator, notes):
    """Returns (names, line number of the header, lines below the header). The header may have several lines: groups of
    columns, names, and units. The names are taken from the last line that does not contain units. If these names are
    not distinct, the words of all lines above each column are joined."""
    block = []
    for _, line in lines[:MAX_HEADERS]:
        words = _header(split(line, separator))
        if not words or (block and (len(words) != len(block[0]) or MISSING.issuperset(words))):
            break
        block.append(words)
    if not block:
        return [], lines[0][0], lines
    # If no row of numbers follows the lines of `block`, only the first line of `block` is the header.
    if len(lines) <= len(block) or not is_row(split(lines[len(block)][1], separator)):
        block = block[:1]
    numbers, below = [number for number, _ in lines[: len(block)]], lines[len(block) :]
    units = units_of(block[-1])
    if len(block) > 1 and units:
        notes.append(f"line {numbers[len(block) - 1]} has the units of the columns")
        block.pop()
    elif len(block) == 2 and not are_distinct(block[1]) and are_distinct(block[0]):
        # The second line has repeated words and the first line has not. The second line therefore has units, even if a
        # unit is unknown. scale_of() reports an unknown unit when its column is read.
        units = block.pop()
        notes.append(f"line {numbers[1]} is read as the units of the columns")
    else:
        units = []
    names = block[-1]
    if len(block) > 1:
        if not are_distinct(names):
            names = [".".join(filter(None, parts)) for parts in zip(*block)]
        lines_of = f"lines {numbers[0]} ... {numbers[len(block) - 1]}"
        notes.append(
            f"{lines_of} are the header: the names of columns are those of line {numbers[len(block) - 1]}"
            if names is block[-1]
            else f"{lines_of} are the header: the names of columns join them, as in {quoted(names[-1])}"
        )
    return with_units(names, units), numbers[len(block) - 1], below


def _commented_headers(comments, count, separator):
    """Returns (line number, words) of each comment that can be a line of the header, such as "% time,x,y,z", the last
    comment first. The comment has `count` words. A word in front of units, as in "# units: s,mm", is not a cell.
    """
    found = []
    for number, comment in reversed(comments):
        text = _OF_UNITS.sub(b"", comment.lstrip(b"#% \t"))
        # A comment often has blanks between its names, even if the numbers have another separator.
        for words in (split(text, separator), split(text, None)):
            if len(words) == count and (names := _header(words)):
                found.append((number, names))
                break
    return found


def _are_column_numbers(rows):
    """Returns True if the first of `rows` has the numbers of the columns, counted from 0 or 1. The values of the next
    rows then have decimals."""
    first, *others = rows
    return (
        len(first) > 2
        and first in ([b"%d" % (i + start) for i in range(len(first))] for start in (0, 1))
        and all(any(b"." in cell or b"," in cell for cell in row) for row in others)
    )


def _drop_trailing_separators(table):
    """Removes an empty last cell from rows that have one cell more than the header. If the rows have one cell less than
    the header, removes an empty last name."""
    width = len(table.names)
    longer = [i for i, row in enumerate(table.rows) if len(row) == width + 1 and not row[-1]]
    for i in longer:
        table.rows[i].pop()
    if longer:
        table.notes.append(
            f"a separator at the end of {counted(len(longer), 'line')} ignored, the first: "
            f"line {table.lines[longer[0]]}"
        )
    _complete_last_column(table, width)
    if width < 2 or table.names[-1] or not table.rows:
        return
    if any(table.names) and all(len(row) == width - 1 for row in table.rows):
        table.names.pop()
        table.notes.append("a separator at the end of the header ignored")
    elif all(len(row) == width and not row[-1] for row in table.rows):
        for cells in (table.names, *table.rows):
            cells.pop()
        table.notes.append("a separator at the end of every line ignored")


def _complete_last_column(table, width):
    """Appends an empty last cell to the rows that lack it, if at least 90 % of the rows lack it. LabVIEW writes such
    files, with a last column for comments."""
    if width < 3 or not table.names[-1]:
        return
    shorter = [i for i, row in enumerate(table.rows) if len(row) == width - 1]
    if len(shorter) < 0.9 * len(table.rows) or not shorter:
        return
    for i in shorter:
        table.rows[i].append(b"")
    table.notes.append(
        f"column {width} {table.names[-1]} has no value in {counted(len(shorter), 'line')}, the first: "
        f"line {table.lines[shorter[0]]}"
    )


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


def first_decimal_comma(rows):
    """Returns (row, column) of the first cell with a comma that can only be a decimal comma, as in "0,002" but not in
    "1,234". Returns None if there is no such cell."""
    return next(
        (
            (number, column)
            for number, row in enumerate(rows)
            if b"," in b" ".join(row)
            for column, cell in enumerate(row)
            if _COMMA_NUMBER.fullmatch(cell) and not _THOUSANDS.fullmatch(cell)
        ),
        None,
    )


def with_points(cells, is_comma_decimal):
    """If `is_comma_decimal` is true, returns (cells of a column with decimal commas replaced by points, index of the
    first cell with a decimal comma or None, None). Otherwise returns (unchanged cells, None, index of the first cell
    with an ambiguous comma, such as "1,234", or None)."""
    if not is_comma_decimal:
        grouped = (i for i, cell in enumerate(cells) if _THOUSANDS.fullmatch(cell))
        return cells, None, next(grouped, None)
    commas = (i for i, cell in enumerate(cells) if b"," in cell and _COMMA_NUMBER.fullmatch(cell))
    # A file has one decimal sign. If the sign is a comma, a cell with a point is not a number: in "1.234", the point
    # may separate thousands.
    pointed = [b"" if b"." in cell else cell.replace(b",", b".") for cell in cells]
    return pointed, next(commas, None), None
