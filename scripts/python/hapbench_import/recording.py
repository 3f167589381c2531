"""Recordings in the formats that are read: their columns as arrays, and where in the file each row is."""
import math

import numpy as np
from hapbench_command import fail, finite_number, nearest, plain, quoted


MOST_COLUMNS = 1000
LARGEST_FILE = 4 << 30  # bytes
# The fields of a HAPI log and how many columns each takes.
HAPI_FIELDS = {
    "TIME": 1,
    "TIMESTAMP": 1,
    "POSITION": 3,
    "ORIENTATION": 4,
    "VELOCITY": 3,
    "FORCE": 3,
    "TORQUE": 3,
    "BUTTONS": 1,
    "RAW_POSITION": 3,
    "RAW_ORIENTATION": 4,
    "RAW_VELOCITY": 3,
    "RAW_FORCE": 3,
    "RAW_TORQUE": 3,
}
_NUMERIC = b"0123456789eE.+-\n"
_BLANK = b" \t\r"


class Recording:
    """The rows of a file. `names` of the columns are empty where the file gives none; `rows` are
    lists of cells, or an array with the names; `places` are those of the rows in the file, counted
    as `row_word` says."""

    def __init__(self, file, names, rows, places, row_word="line", remark=""):
        self.file, self.names, self.rows, self.places, self.row_word, self.remark = (
            file,
            names,
            rows,
            places,
            row_word,
            remark,
        )
        self.is_binary = isinstance(rows, np.ndarray)

    def place(self, row):
        return f"{self.file}, {self.row_word} {self.places[row]}"

    def problems(self):
        """By row: what is wrong with it as a whole."""
        if self.is_binary:
            return {}
        return {
            i: f"got {len(row)} values; allowed: {len(self.names)}"
            for i, row in enumerate(self.rows)
            if len(row) != len(self.names)
        }

    def column(self, column):
        """The numbers in a column, NaN where there is no finite one."""
        if self.is_binary:
            values = self.rows[self.names[column]].astype(float)
        else:
            cells = [row[column] if len(row) > column else b"" for row in self.rows]
            text = b"\n".join(cells)
            # Otherwise float() may accept what is not a number here, and cells are read one by one.
            usual = not text.translate(None, _NUMERIC) and text.count(b"+") == text.count(
                b"e+"
            ) + text.count(b"E+")
            try:
                values = np.array(
                    [float(cell) for cell in cells]
                    if usual
                    else [finite_number(cell) for cell in cells]
                )
            except ValueError:
                values = np.array([finite_number(cell) for cell in cells])
        return np.where(np.isfinite(values), values, math.nan)

    def shown(self, column, row):
        """A value as a message shows it."""
        return (
            plain(self.rows[self.names[column]][row])
            if self.is_binary
            else quoted(self.rows[row][column])
        )


def open_recording(file, options):
    try:
        with open(file, "rb") as stream:
            data = stream.read(LARGEST_FILE + 1)
    except IsADirectoryError:
        fail("is a directory, not a file", file)
    except OSError as error:
        fail(f"cannot be read: {error.strerror}", file)
    if len(data) > LARGEST_FILE:
        fail(f"is larger than {LARGEST_FILE >> 20} MiB", file)
    return (
        _binary(data, file, options.floats)
        if options.format == "hapi-binary"
        else _text(data, file, options.format)
    )


def _text(data, file, kind):
    """Blank lines and those that begin with # or % are skipped."""
    lines = [
        (number, line)
        for number, line in enumerate(
            map(lambda line: line.strip(_BLANK), data.removeprefix(b"\xef\xbb\xbf").split(b"\n")), 1
        )
        if line and line[0] not in b"#%"
    ]
    if not lines:
        fail("no samples; allowed: a line for each", file)
    number, first = lines[0]
    separator = (
        next((c for c in (b",", b";", b"\t") if c in first), None) if kind == "csv" else None
    )
    words = _cells(first, separator)
    names = (
        _hapi_columns(words, file)
        if kind == "hapi"
        else [word.decode("utf-8", "surrogateescape") for word in words]
    )
    if kind != "hapi":
        if len(words) > MOST_COLUMNS:
            fail(f"got {len(words)} columns; allowed: {MOST_COLUMNS}", f"{file}, line {number}")
        if not all(math.isnan(finite_number(word)) for word in words):
            names = [""] * len(words)
            lines.insert(0, lines[0])
    return Recording(
        file,
        names,
        [_cells(line, separator) for _, line in lines[1:]],
        [number for number, _ in lines[1:]],
    )


def _cells(line, separator):
    if separator is None:
        return line.split()
    cells = [cell.strip(_BLANK) for cell in line.split(separator)]
    return [
        cell[1:-1] if len(cell) > 1 and cell[:1] == cell[-1:] == b'"' else cell for cell in cells
    ]


def _hapi_columns(fields, file):
    """POSITION_x, POSITION_y, POSITION_z; ORIENTATION ends with _angle."""
    names = []
    for field in fields:
        name = field.decode("utf-8", "surrogateescape")
        if name not in HAPI_FIELDS:
            fail(
                f"unknown field {quoted(field)}; allowed: the names of a HAPI log{nearest(name, list(HAPI_FIELDS))}",
                f"{file}, line 1",
            )
        columns = (
            [name + end for end in ("_x", "_y", "_z", "_angle")[: HAPI_FIELDS[name]]]
            if HAPI_FIELDS[name] > 1
            else [name]
        )
        if columns[0] in names:
            fail(f"field {quoted(field)} twice; allowed: once", f"{file}, line 1")
        names += columns
    return names


def _binary(data, file, floats):
    """Names that end with NUL, one more NUL, then samples without separators: every number a double
    or a float, BUTTONS an int32, little-endian."""
    fields, at, longest, names = [], 0, 64, []
    while (end := data.find(b"\0", at)) != at:
        if end < 0 or end - at > longest:
            fail(
                f"no NUL within {longest} bytes behind field name {len(names) + 1}; allowed: a "
                "binary HAPI log (a text log has "
                "--format hapi)",
                file,
            )
        fields.append(data[at:end])
        names, at = _hapi_columns(fields, file), end + 1
    if not names:
        fail("no field names; allowed: those of a binary HAPI log, each ended by NUL", file)
    kind = np.dtype(
        [(name, "<i4" if name == "BUTTONS" else "<f4" if floats else "<f8") for name in names]
    )
    count, rest = divmod(len(data) - end - 1, kind.itemsize)
    remark = (
        (
            f"behind sample {count} are {rest} bytes, less than the {kind.itemsize} of a sample: "
            "the log was cut off, or its numbers "
            f"are {'doubles (--set floats=false)' if floats else 'floats (--set floats=true)'}"
        )
        if rest
        else ""
    )
    return Recording(
        file,
        names,
        np.frombuffer(data, kind, count, end + 1),
        range(1, count + 1),
        "sample",
        remark,
    )
