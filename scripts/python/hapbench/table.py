"""A table of results. If the unit of a column is not given, it follows from the name of the column."""
import html
import textwrap
from collections.abc import ItemsView, Iterable, Iterator, KeysView, Mapping, ValuesView
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    import pandas

Column = npt.NDArray[Any]

# Unit by ending of a column name. If several endings match, the longest ending decides.
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
MAX_NAMED = 16
# Largest number of rows, and largest number of characters per line, of a printed table.
MAX_PRINTED, WIDEST = 20, 100


def ending_of(name: str) -> str:
    """Returns the ending of a name that states the unit of the column; "" if the name has no such ending."""
    return max((ending for ending in UNITS if name.endswith("_" + ending)), key=len, default="")


def unit_of(name: str) -> str:
    """Returns the unit of a column by its name; "" if the name states no unit."""
    return UNITS.get(ending_of(name), "")


class Table(Mapping[str, Column]):
    """A mapping from names to columns. A column is a numpy array of float64, in which NaN stands for an empty field.
    Tables of sweeps may also have columns that are arrays of texts.

    `units` has an entry for each column; the unit is "" if it is unknown. `meanings` has an entry for each column whose
    meaning is known. `table["time_s"]` and `table.time_s` are the same column. `len(table)` is the number of rows.
    `to_pandas()` returns a DataFrame. A notebook shows the first rows with units.
    """

    def __init__(
        self,
        columns: Mapping[str, Column] | Iterable[tuple[str, Column]],
        units: Mapping[str, str] | None = None,
        meanings: Mapping[str, str] | None = None,
        name: str = "table",
    ) -> None:
        self._columns: dict[str, Column] = dict(columns)
        self.units = {
            column: (units or {}).get(column, unit_of(column)) for column in self._columns
        }
        self.meanings = dict(meanings or {})
        self.name = name

    def __getitem__(self, column: str) -> Column:
        try:
            return self._columns[column]
        except KeyError:
            raise KeyError(
                f"{self.name} has no column {column!r}; it has {', '.join(self._columns)}"
            ) from None

    def __getattr__(self, column: str) -> Column:
        if column.startswith("_") or column not in self._columns:
            raise AttributeError(f"{self.__dict__.get('name', 'table')} has no column {column!r}")
        return self._columns[column]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._columns]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        """Returns the number of rows, like len() of a DataFrame. The number of columns is `len(table.keys())`."""
        return self.rows

    def keys(self) -> KeysView[str]:
        return self._columns.keys()

    def values(self) -> ValuesView[Column]:
        return self._columns.values()

    def items(self) -> ItemsView[str, Column]:
        return self._columns.items()

    @property
    def rows(self) -> int:
        return len(next(iter(self._columns.values()), ()))

    def to_pandas(self) -> "pandas.DataFrame":
        """Returns a DataFrame with the columns of this table. `frame.attrs["units"]` holds the units, and
        `frame.attrs["meanings"]` the meanings of the columns."""
        import pandas

        frame = pandas.DataFrame(dict(self._columns))
        frame.attrs.update(units=dict(self.units), meanings=dict(self.meanings))
        return frame

    def plot(self, *y: str, x: str | None = None, width: str = "double") -> Any:
        """Returns a matplotlib Figure of the columns `y` over the column `x`. The default of `x` is time_s, or
        the first column of numbers if there is no column time_s."""
        from .pictures import plot_table

        return plot_table(self, y, x, width)

    def where(self, **chosen: object) -> "Table":
        """Returns the rows that have the given value in each given column: `table.where(algorithm="mean")`."""
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

    def __repr__(self) -> str:
        names = list(self._columns)
        more = f" and {len(names) - MAX_NAMED} more" if len(names) > MAX_NAMED else ""
        return f"<{self.name}: {self.rows} rows of {', '.join(names[:MAX_NAMED])}{more}>"

    def __str__(self) -> str:
        """Returns the first rows as aligned text, with as many columns as fit, and a note on the omitted rows and
        columns."""
        shown, width = [], 0
        for name, values in self._columns.items():
            cells = [name, *map(_cell, values[:MAX_PRINTED])]
            wide = max(map(len, cells))
            width += wide + 2
            if width > WIDEST and shown:
                break
            shown.append([cell.rjust(wide) for cell in cells])
        lines = ["  ".join(row) for row in zip(*shown)]
        if self.rows > MAX_PRINTED:
            lines.append(f"and {self.rows - MAX_PRINTED} more rows")
        if left := list(self._columns)[len(shown) :]:
            lines += textwrap.wrap(f"and columns {', '.join(left)}", WIDEST)
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        """Returns the first rows as HTML for a notebook, with the units below the names of the columns."""
        heads = "".join(
            f"<th title=\"{html.escape(self.meanings.get(name, ''))}\">{html.escape(name)}"
            + (f"<br><small>{html.escape(unit)}</small>" if unit not in ("", "1") else "")
            + "</th>"
            for name, unit in self.units.items()
        )
        rows = "".join(
            "<tr>" + "".join(f"<td>{html.escape(_cell(v))}</td>" for v in row) + "</tr>"
            for row in zip(*(values[:MAX_PRINTED] for values in self._columns.values()))
        )
        more = f"<p>and {self.rows - MAX_PRINTED} more rows</p>" if self.rows > MAX_PRINTED else ""
        return f"<table><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>{more}"


def joined(tables: Mapping[str, Table], column: str, name: str) -> Table:
    """Concatenates the rows of several tables to a table with the name `name`. The result has an additional first
    column `column`: for each row, the key in `tables` of the table from which the row comes. If a table lacks a column
    of another table, its rows have NaN in this column."""
    names = list(dict.fromkeys(column_name for table in tables.values() for column_name in table))
    keys = [key for key, table in tables.items() for _ in range(len(table))]
    columns: dict[str, Column] = {column: np.array(keys, dtype=object)}
    for column_name in names:
        parts = [
            t[column_name] if column_name in t else np.full(len(t), np.nan) for t in tables.values()
        ]
        columns[column_name] = np.concatenate(parts)
    first = next(iter(tables.values()))
    return Table(columns, first.units, first.meanings, name)


def _cell(value: Any) -> str:
    """Formats a value for printing: an integer below 1e9 with all digits, another number with 5 significant digits, NaN
    as an empty text, and a text unchanged."""
    if isinstance(value, str):
        return value
    return (
        ""
        if value != value
        else f"{value:.0f}"
        if value % 1 == 0 and abs(value) < 1e9
        else f"{value:.5g}"
    )
