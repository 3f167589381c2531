"""Reads recordings in the supported formats. Provides their columns as arrays, and the location of each row in the
file."""
import math
import re
from datetime import date
from functools import cached_property

import numpy as np
from hapbench_command import fail, finite_number, nearest, plain, quoted

from .text_table import first_decimal_comma, read_table, with_points

LARGEST_FILE = 4 << 30  # largest size of a file [bytes]
# Number of columns of each field of a HAPI log.
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
CHUNK = 1 << 24  # number of bytes read at once
DAY = 86_400_000_000_000  # [ns]
EXACT = 2.0**53  # integers up to this value are exact in a double


class Recording:
    """The rows of a recording's file. `names`: names of the columns; empty if the file has none. `rows`: lists of
    cells, or a numpy array with the columns `names`. `row_numbers`: location of each row in the file, counted in
    `row_word` (lines or samples). `notes`: texts about skipped or repaired parts; each kind is mentioned once.
    """

    def __init__(self, file, names, rows, row_numbers, row_word="line", notes=(), decimal="auto"):
        self.file, self.names, self.rows, self.row_numbers = file, names, rows, row_numbers
        self.row_word, self.notes, self._decimal = row_word, list(notes), decimal
        # Table.stated_units and Table.other_headers of a text
        self.stated_units, self.other_headers = [], []
        self.is_binary = isinstance(rows, np.ndarray)
        self.added = 0  # number of columns, at the end of each row, that the file does not have
        # True if no note about decimal commas is needed, because the user has chosen them or the note already exists.
        self._is_comma_noted = decimal == "comma"

    def location(self, row):
        return f"{self.file}, {self.row_word} {self.row_numbers[row]}"

    def problems(self):
        """Returns a dict from the index of each row that has the wrong number of values to the problem."""
        if self.is_binary:
            return {}
        return {
            i: f"got {len(row) - self.added} values; allowed: {len(self.names) - self.added}"
            for i, row in enumerate(self.rows)
            if len(row) != len(self.names)
        }

    def faults(self, problems):
        """Returns (location in the file, problem) for each kind of problem. A problem of several rows is reported at
        the first of these rows, with the number of rows."""
        kinds = {}
        for row in sorted(problems):
            kinds.setdefault(_kind_of(problems[row]), []).append(row)
        return [
            (
                self.location(rows[0]),
                problems[rows[0]]
                + (
                    f" ({len(rows)} rows, the last: {self.row_word} {self.row_numbers[rows[-1]]})"
                    if len(rows) > 1
                    else ""
                ),
            )
            for rows in kinds.values()
        ]

    def column(self, column):
        """Returns the numbers in a column; NaN for cells without a finite number."""
        if self.is_binary:
            values = self.rows[self.names[column]].astype(float)
            return np.where(np.isfinite(values), values, math.nan)
        cells = self._cells(column)
        text = b"\n".join(cells)
        # float() accepts some cells that are not numbers in this format. Cells with unusual characters are therefore
        # parsed one by one.
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

    def clock(self, column, fractions=None, unit=0.0, scale=1.0):
        """Returns (origin, numbers minus the origin) for a column of times. `fractions`: column of fractions of a
        second that are added to the times, in `unit` [s], or None. The origin is the first time if `fractions` is
        given, or if the times are integers that are too large for a double, such as nanoseconds since 1970. Otherwise
        the origin is 0. Times of day, with or without a date (ISO 8601), are converted to seconds since the first time
        of day. `scale`: seconds per unit of the times; must be 1 for times of day."""
        values = self.column(column)
        if fractions is not None:
            finite = values[np.isfinite(values)]
            first = float(finite[0]) if len(finite) else 0.0
            return first, (values - first) + unit / scale * self.column(fractions)
        if not self.is_binary and not np.isfinite(values).any():
            nanoseconds = [
                _nanoseconds(row[column]) if len(row) > column else None for row in self.rows
            ]
            known = [number for number in nanoseconds if number is not None]
            if known and scale != 1.0:
                fail(
                    f"column {self.title(column)}: the times are times of day, in seconds; allowed: no other unit in "
                    f"the name of the column or in --scale time, got {scale:g} s",
                    self.file,
                )
            if known:
                nanoseconds = self._past_midnight(nanoseconds)
                self._note_times_of_day(column, nanoseconds.index(known[0]))
                return 0, np.array(
                    [math.nan if n is None else 1e-9 * (n - known[0]) for n in nanoseconds]
                )
        if self.is_binary or not np.nanmax(np.abs(values), initial=0.0) > EXACT:
            return 0, values
        cells = self._cells(column)
        whole = [re.fullmatch(rb"[+-]?\d{1,30}", cell) is not None for cell in cells]
        if not any(whole) or any(np.isfinite(values) & ~np.array(whole)):
            return 0, values
        origin = int(cells[whole.index(True)])
        return origin, np.array(
            [float(int(cell) - origin) if ok else math.nan for cell, ok in zip(cells, whole)]
        )

    def _past_midnight(self, times):
        """Returns times of day [ns] that increase over midnight. A time without a date that is a day earlier than the
        time before it, except for at most an hour, is after midnight. `times`: None in a row without a time.
        """
        found, days, before = [], 0, None
        for row, time in enumerate(times):
            if time is not None and before is not None and 0 < time - before + DAY < DAY // 24:
                days += 1
                self.notes.append(
                    f"{self.row_word} {self.row_numbers[row]}: the clock passes midnight; the times after it are of "
                    "the next day"
                )
            if time is not None and abs(time) < 2 * DAY:  # times with a date are larger
                before = time
            found.append(None if time is None else time + days * DAY)
        return found

    def _cells(self, column):
        cells = [row[column] if len(row) > column else b"" for row in self.rows]
        if self._decimal == "point":
            return cells
        cells, first, unclear = with_points(cells, self._is_comma_decimal)
        if unclear is not None:
            fail(
                f"column {self.title(column)}: got {self.shown(column, unclear)}: is the comma a decimal comma? "
                "--decimal comma reads it as one; allowed otherwise: numbers without commas between thousands",
                self.location(unclear),
            )
        if first is not None and not self._is_comma_noted:
            self._is_comma_noted = True
            self.notes.append(
                f"{self.row_word} {self.row_numbers[first]}: got {self.shown(column, first)}: numbers have a decimal "
                "comma and are read as such (--decimal comma; --decimal point rejects them)"
            )
        return cells

    @cached_property
    def _first_decimal_comma(self):
        """(row, column) of the first cell with a decimal comma, or None."""
        return None if self.is_binary else first_decimal_comma(self.rows)

    @property
    def _is_comma_decimal(self):
        """True if the decimal sign of the file is a comma. A file has one decimal sign, and not one for each column."""
        if self._decimal == "auto":
            return self._first_decimal_comma is not None
        return self._decimal == "comma"

    def cause_of_point(self, column, row):
        """Returns the end of an error message for a cell that is not a number because the decimal sign of the file is a
        comma and the cell has a point. Returns an empty text for any other cell."""
        cell = b"" if self.is_binary else self.rows[row][column]
        number = cell.replace(b".", b"").replace(b",", b".", 1)
        if b"." not in cell or not self._is_comma_decimal or math.isnan(finite_number(number)):
            return ""
        allowed = [quoted(cell.replace(b".", b""))]
        if cell.count(b".") == 1 and b"," not in cell:
            allowed.append(quoted(cell.replace(b".", b",")))
        write = f"write {' or '.join(allowed)}"
        if self._decimal == "comma":
            return f"; with --decimal comma, the point may separate thousands: {write}, or omit --decimal comma"
        first, of = self._first_decimal_comma
        sign = f"{self.row_word} {self.row_numbers[first]} has the decimal comma {self.shown(of, first)}"
        text = f"; the point may separate thousands, because {sign}: {write}"
        if of == column or cell.count(b".") > 1:
            return text
        return f"{text} (--decimal point reads the point as decimal, if column {self.title(of)} is not needed)"

    def _note_times_of_day(self, column, row):
        note = (
            f"column {self.title(column)}: times of day such as {self.shown(column, row)} are read as seconds "
            "since the first"
        )
        if note not in self.notes:
            self.notes.append(note)

    def title(self, column):
        """Returns number and name of a column for a message."""
        return f"{column + 1} {self.names[column]}".rstrip()

    def shown(self, column, row):
        """Formats a value for a message."""
        return (
            plain(self.rows[self.names[column]][row])
            if self.is_binary
            else quoted(self.rows[row][column])
        )


_TIME_OF_DAY = re.compile(
    rb"(?:(\d{4}-\d\d-\d\d|\d{4}/\d\d/\d\d)[T ])?(\d\d?):(\d\d):(\d\d)(?:[.,](\d{1,9}))?\s*(Z|[+-]\d\d:?\d\d)?"
)


def _nanoseconds(cell):
    """Returns the time of day in a cell [ns], counted from midnight, or from a fixed day if the cell has a date. If the
    cell states an offset from UTC, the time is converted to UTC. Returns None if the cell is no time of day.
    """
    found = _TIME_OF_DAY.fullmatch(cell)
    if not found:
        return None
    day, hours, minutes, seconds, fraction, offset = found.groups()
    days = 0
    if day:
        try:
            days = date.fromisoformat(day.decode().replace("/", "-")).toordinal()
        except ValueError:
            return None
    total = ((24 * days + int(hours)) * 60 + int(minutes)) * 60 + int(seconds)
    if offset not in (None, b"Z"):
        sign = -1 if offset[:1] == b"-" else 1
        total -= sign * (int(offset[1:3]) * 60 + int(offset[-2:])) * 60
    return total * 1_000_000_000 + int((fraction or b"0").ljust(9, b"0"))


def _kind_of(problem):
    """Returns the kind of a problem: its text without the values, which differ between rows. The column and its name
    are kept."""
    where, got, rest = problem.partition("got ")
    return where, re.sub(r'"[^"]*"|-?\d[\d.e+-]*', "#", got + rest)


def open_recording(file, options):
    """Reads the file of a recording once from start to end, so that it may be a pipe. Returns the Recording."""
    data = _content(file)
    if options.format == "hapi-binary":
        return _binary(data, file, options.floats)
    decimal = getattr(options, "decimal", "auto")
    table = (
        _hapi(data, file)
        if options.format == "hapi"
        else read_table(data, file, options.format == "traj")
    )
    found = Recording(file, table.names, table.rows, table.lines, "line", table.notes, decimal)
    found.stated_units, found.other_headers = table.stated_units, table.other_headers
    return found


def _content(file):
    parts, size = [], 0
    try:
        with open(file, "rb") as stream:
            while part := stream.read(CHUNK):
                size += len(part)
                if size > LARGEST_FILE:
                    fail(f"is larger than {LARGEST_FILE >> 20} MiB", file)
                parts.append(part)
    except IsADirectoryError:
        fail("is a directory, not a file", file)
    except OSError as error:
        fail(f"cannot be read: {error.strerror}", file)
    return b"".join(parts)


def _hapi(data, file):
    """Reads a text log of HAPI. Its first line has the names of fields; each field has one to four columns."""
    return read_table(data, file, True, lambda words: _hapi_columns(words, file))


def _hapi_columns(fields, file):
    """Returns names of columns such as POSITION_x, POSITION_y, POSITION_z; the last column of ORIENTATION is
    ORIENTATION_angle."""
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
    """Reads a binary log of HAPI: names that end with NUL, one more NUL, then samples without separators. Numbers are
    little-endian doubles or floats, and BUTTONS is an int32."""
    fields, at, longest, names = [], 0, 64, []
    while (end := data.find(b"\0", at)) != at:
        if end < 0 or end - at > longest:
            fail(
                f"no NUL within {longest} bytes after field name {len(names) + 1}; allowed: a "
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
            f"after sample {count} follow {rest} bytes, less than the {kind.itemsize} bytes of a sample: "
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
        [remark] if remark else [],
    )
