"""A table of results, and the units of columns by their names."""
import textwrap
from collections.abc import Mapping

# Ending of a name -> unit; the longest that fits.
UNITS = {
    "N_per_m": "N/m",
    "N_s_per_m": "N s/m",
    "m_per_s": "m/s",
    "m_per_s2": "m/s²",
    "m2_per_s2": "m²/s²",
    "rad_per_s": "rad/s",
    "s_per_m": "s/m",
    "per_s": "1/s",
    "m": "m",
    "mm": "mm",
    "s": "s",
    "N": "N",
    "Nm": "N m",
    "J": "J",
    "W": "W",
    "kg": "kg",
    "rad": "rad",
    "Hz": "Hz",
    "bytes": "bytes",
}
MOST_NAMED = 16
MOST_PRINTED, WIDEST = 20, 100  # rows and characters of a printed table


def ending_of(name):
    """The end of a name that says its unit, "" where it has none."""
    return max((ending for ending in UNITS if name.endswith("_" + ending)), key=len, default="")


def unit_of(name):
    """The unit of a column, "" where its name says none."""
    return UNITS.get(ending_of(name), "")


class Table(Mapping):
    """Columns by name: numpy arrays of float64, NaN where a field is empty; in some tables of sweeps, of texts.

    `units` and `meanings` say of each column what they can. `table["time_s"]`, `table.time_s` and, for pandas,
    `pandas.DataFrame(dict(table))` all work."""

    def __init__(self, columns, units=None, meanings=None, name="table"):
        self._columns = dict(columns)
        self.units = {
            column: (units or {}).get(column, unit_of(column)) for column in self._columns
        }
        self.meanings = dict(meanings or {})
        self.name = name

    def __getitem__(self, column):
        try:
            return self._columns[column]
        except KeyError:
            raise KeyError(
                f"{self.name} has no column {column!r}; it has {', '.join(self._columns)}"
            ) from None

    def __getattr__(self, column):
        if column.startswith("_") or column not in self._columns:
            raise AttributeError(f"{self.__dict__.get('name', 'table')} has no column {column!r}")
        return self._columns[column]

    def __dir__(self):
        return [*super().__dir__(), *self._columns]

    def __iter__(self):
        return iter(self._columns)

    def __len__(self):
        """The number of columns, as of every mapping; `rows` is that of the rows."""
        return len(self._columns)

    @property
    def rows(self):
        return len(next(iter(self._columns.values()), ()))

    def where(self, **chosen):
        """The rows whose columns have these values: `table.where(algorithm="mean")`."""
        found = self
        for column, value in chosen.items():
            rows = found[column] == value
            found = Table(
                {name: values[rows] for name, values in found.items()},
                self.units,
                self.meanings,
                self.name,
            )
        return found

    def __repr__(self):
        names = list(self._columns)
        more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
        return f"<{self.name}: {self.rows} rows of {', '.join(names[:MOST_NAMED])}{more}>"

    def __str__(self):
        """The first rows, aligned, of as many columns as fit; below them what is left out."""
        shown, width = [], 0
        for name, values in self._columns.items():
            cells = [name, *map(_cell, values[:MOST_PRINTED])]
            wide = max(map(len, cells))
            width += wide + 2
            if width > WIDEST and shown:
                break
            shown.append([cell.rjust(wide) for cell in cells])
        lines = ["  ".join(row) for row in zip(*shown)]
        if self.rows > MOST_PRINTED:
            lines.append(f"and {self.rows - MOST_PRINTED} more rows")
        if left := list(self._columns)[len(shown) :]:
            lines += textwrap.wrap(f"and columns {', '.join(left)}", WIDEST)
        return "\n".join(lines)


def _cell(value):
    """A number in short, a count in full, nothing for NaN."""
    if isinstance(value, str):
        return value
    return (
        ""
        if value != value
        else f"{value:.0f}"
        if value % 1 == 0 and abs(value) < 1e9
        else f"{value:.5g}"
    )
