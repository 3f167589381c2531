"""Quantities over time. A quantity has a short name, or is a column of a run's tables. The axis shows the range of
settled contact, because the peak of a landing or a crash would flatten the other values."""
import json
import re
from dataclasses import dataclass

import numpy as np

from hapbench.columns import header, read_columns
from hapbench.errors import InputError
from hapbench_command import SCHEMA, nearest
from hapbench_report.completeness import absence_of, is_recorded
from hapbench_report.markup import column
from hapbench_report.recording import REQUIRED, settled_rows

from .ranking_values import failed

TRAJECTORY = "trajectory.csv"
REFERENCE = "force_reference.csv"
# Tables with a row for each recorded step. A quantity without a short name is searched for in their columns.
TABLES = (TRAJECTORY, "energy.csv", "ideal_trajectory.csv", "stiffness_tensor.csv", REFERENCE)
# A peak is cut off if it is larger than this factor times the largest settled value.
CUT_OFF = 3
# Largest fraction of the rows that may be outside the range of settled contact. If more rows are outside, for example
# because the tool bounces to the end, the axis shows all values.
LARGEST_LEFT_OUT = 0.1
BULK = (1, 99)  # percentiles of the settled rows that define the range


@dataclass(frozen=True)
class Quantity:
    name: str  # name that the user types
    title: str
    unit: str  # unit for the axis; empty for numbers without a unit
    factor: float
    file: str
    columns: tuple
    # "value" of a column, "norm" of a vector, or "band" between the first and the second column.
    kind: str = "value"

    @property
    def axis(self):
        title = f"|{self.title}|" if self.kind == "norm" else self.title
        return f"{title} [{self.unit or 1}]"

    def of(self, table):
        """Returns (lower bound, upper bound) of the quantity in every row. Both are the same array, except for
        a quantity of the kind "band"."""
        parts = [table[name] * self.factor for name in self.columns]
        if self.kind == "norm":
            parts = [np.sqrt(sum(part * part for part in parts))]
        return parts[0], parts[-1]


def vector(prefix, unit):
    return tuple(f"{prefix}{axis}_{unit}" for axis in "xyz")


SHORT = {
    q.name: q
    for q in (
        Quantity("force", "rendered force", "N", 1, TRAJECTORY, vector("f", "N"), "norm"),
        Quantity("spring", "spring force", "N", 1, TRAJECTORY, vector("fspring_", "N"), "norm"),
        Quantity("measured", "measured force", "N", 1, TRAJECTORY, vector("fmeas_", "N"), "norm"),
        Quantity("input", "input force", "N", 1, TRAJECTORY, vector("fin_", "N"), "norm"),
        Quantity("reference", "reference force", "N", 1, REFERENCE, vector("mf", "N"), "norm"),
        Quantity(
            "force_error", "force error", "N", 1, REFERENCE, vector("force_error_", "N"), "norm"
        ),
        Quantity("torque", "lost torque", "mN m", 1e3, TRAJECTORY, vector("t", "Nm"), "norm"),
        Quantity("depth", "largest depth", "mm", 1e3, TRAJECTORY, ("depth_max_m",)),
        Quantity("ratio", "stiffness ratio", "", 1, TRAJECTORY, ("ratio_min", "ratio_max"), "band"),
        Quantity("contacts", "colliding points", "", 1, TRAJECTORY, ("colliding",)),
        Quantity("rendered", "rendered points", "", 1, TRAJECTORY, ("rendered",)),
        Quantity(
            "speed", "velocity of the tip", "m/s", 1, TRAJECTORY, vector("v", "m_per_s"), "norm"
        ),
        Quantity("x", "tip x", "mm", 1e3, TRAJECTORY, ("px_m",)),
        Quantity("y", "tip y", "mm", 1e3, TRAJECTORY, ("py_m",)),
        Quantity("z", "tip z", "mm", 1e3, TRAJECTORY, ("pz_m",)),
        Quantity(
            "energy", "energy created by the rendering", "mJ", 1e3, "energy.csv", ("created_J",)
        ),
        Quantity(
            "input_energy", "energy put in by the hand", "mJ", 1e3, "energy.csv", ("input_J",)
        ),
    )
}
PATH = "path"  # name of the tip's path in space, which is drawn in a section and not over time
# Names of the quantities that are drawn by default, if a run recorded them.
USUAL = ("force", "reference", "force_error", "depth", "ratio", "contacts", "energy", PATH)


def chosen(names, runs):
    """Returns (quantities of these names, True if the path is among the names). Without names, returns the default
    quantities that some run has, and True."""
    if not names:
        usual = [SHORT[name] for name in USUAL if name != PATH]
        return [q for q in usual if any(has(run, q) for run in runs)], True
    return [quantity(name, runs) for name in names if name != PATH], PATH in names


def quantity(name, runs):
    known = {}
    for run in runs:
        for file in tables_of(run):
            for title in header(run.folder / file):
                known.setdefault(title, file)
    found = SHORT.get(name) or (
        Quantity(name, *column(name, (1e-3,)), known[name], (name,)) if name in known else None
    )
    if not found:
        hint = nearest(name, [*SHORT, PATH, *known]) or f": {', '.join(known)}"
        raise InputError(
            f"--y: got \"{name}\"; allowed: {', '.join([*SHORT, PATH])}, or a column of "
            f"{' or '.join(sorted(set(known.values())) or [TRAJECTORY])}{hint}"
        )
    if not any(has(run, found) for run in runs):
        if found.file not in tables_of(runs[0]):
            raise InputError(f"--y {name}: {without_table(runs[0], found.file)}")
        lacks = found.columns[0]
        raise InputError(
            f"--y {name}: {runs[0].folder}: has no {lacks}; run it with --set {switch_of(lacks)}=true"
        )
    return found


def switch_of(lacks):
    """Returns the field of the scenario that makes a run record the table or column `lacks`: the first field of
    `record` whose description names `lacks`."""
    record = json.loads(SCHEMA.read_text(encoding="utf-8"))["else"]["properties"]["record"][
        "properties"
    ]
    return next(
        f"record.{field}"
        for field, about in record.items()
        if re.search(rf"\b{re.escape(lacks)}\b", about["description"])
    )


def without_table(run, table):
    """Returns the text that a table of a run is not there, and what to do."""
    if is_recorded(run, table) and not run.trials:
        return f"{run.folder / table}: {absence_of(run.folder / table)}"
    return f"{run.folder}: has no {table}; run it with --set {switch_of(table)}=true"


def has(run, quantity):
    return quantity.file in tables_of(run) and set(quantity.columns) <= set(
        header(run.folder / quantity.file)
    )


def tables_of(run):
    return [file for file in TABLES if (run.folder / file).is_file()]


class Samples:
    """Columns of one run that a picture needs. Each table is read only once."""

    def __init__(self, run, quantities, further=(), window=(-np.inf, np.inf)):
        """Arguments: `further`: columns of trajectory.csv in addition to the columns of the quantities. `window`: first
        and last time to keep [s]."""
        wanted = {TRAJECTORY: {"time_s", "colliding", *further}}
        for q in (q for q in quantities if has(run, q)):
            wanted.setdefault(q.file, {"time_s"}).update(q.columns)
        present, self.failed = tables_of(run), failed(run)
        if TRAJECTORY not in present:
            raise InputError(without_table(run, TRAJECTORY))
        tables = {
            file: finite_columns(run.folder / file, sorted(columns))
            for file, columns in wanted.items()
            if file in present
        }
        time = tables[TRAJECTORY]["time_s"]
        touching = time[tables[TRAJECTORY]["colliding"] > 0]
        # Time of the first recorded row in contact [s]. None without contact, or if this time is outside of the window.
        self.first_touch_s = (
            float(touching[0]) if touching.size and window[0] <= touching[0] <= window[1] else None
        )
        settled = settled_rows(tables[TRAJECTORY], run.scenario)
        self.tables, self.settled = {}, {}
        for file, table in tables.items():
            rows = (table["time_s"] >= window[0]) & (table["time_s"] <= window[1])
            if not rows.any():
                raise InputError(
                    f"--from, --to: {run.folder}: no row of {file} between {window[0]:g} and {window[1]:g} s; "
                    f"allowed: a span with rows between {time[0]:.4g} and {time[-1]:.4g} s"
                )
            self.tables[file] = {name: values[rows] for name, values in table.items()}
            beside = np.minimum(np.searchsorted(time, table["time_s"][rows]), len(time) - 1)
            self.settled[file] = settled[beside]

    @property
    def trajectory(self):
        return self.tables[TRAJECTORY]

    def of(self, q):
        """Returns (times, lower bounds, upper bounds) of a quantity; None if this run did not record it."""
        table = self.tables.get(q.file, {})
        return (table["time_s"], *q.of(table)) if set(q.columns) <= set(table) else None


def finite_columns(file, names):
    """Returns the columns of a table. Infinite numbers become NaN, which is not drawn. Raises InputError if a number of
    the columns REQUIRED is missing or not finite."""
    columns = read_columns(
        file, names, required=REQUIRED if file.name == TRAJECTORY else ["time_s"]
    )
    return {name: np.where(np.isfinite(of), of, np.nan) for name, of in columns.items()}


def settled_range(curves):
    """Returns the range of settled contact with a margin, from the percentiles BULK. Returns None if all values must be
    shown: there is no settled contact, no peak exceeds CUT_OFF times the largest magnitude in the range, or more than
    the fraction LARGEST_LEFT_OUT of the rows of a run is outside of the range. `curves`: (True for each settled row,
    lower bounds, upper bounds) of each run."""
    ends = [
        (np.nanpercentile(low[settled], BULK[0]), np.nanpercentile(high[settled], BULK[1]))
        for settled, low, high in curves
        if np.isfinite(low[settled]).any() and np.isfinite(high[settled]).any()
    ]
    if not ends:
        return None
    low, high = min(a for a, _ in ends), max(b for _, b in ends)
    size = max(abs(low), abs(high))
    peak = max(np.nanmax(np.abs(bound), initial=0.0) for _, *bounds in curves for bound in bounds)
    if not peak > CUT_OFF * size > 0:
        return None
    air = max(0.25 * (high - low), 0.05 * size)
    bottom, top = float(low - air), float(high + air)
    left_out = max(
        np.mean((lows < bottom) | (highs > top)) for _, lows, highs in curves if len(lows)
    )
    return (bottom, top) if left_out <= LARGEST_LEFT_OUT else None
