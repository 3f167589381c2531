"""A sweep's table as a picture: a metric over one varied field, or over two as curves or a heat map."""
import numpy as np
from matplotlib import colors
from matplotlib.patches import Patch, Rectangle

from hapbench.columns import read_records
from hapbench_figures.stability import edges, is_geometric
from hapbench_command import nearest
from hapbench_looks import look
from hapbench_report.json_input import InputError, at, load_object
from hapbench_style import SETTINGS, plt

from .given import axis

USUAL = ("force_rms_above_30Hz_N", "force_max_N")
FAILURES = ("diverges", "error")
# Looks of runs that failed, and of places without a number.
FAILED = {"facecolor": "#E2E2E2", "edgecolor": "#8E8E8E", "hatch": "////", "lw": 0}
NO_VALUE = {"facecolor": "#F4F4F4", "edgecolor": "#C8C8C8", "lw": 0.5}
MOST_TICKS = 12
SHADES = {True: " ░▒▓█", False: " .:+#"}


class Sweep:
    def __init__(self, folder, metric):
        file = folder / "sweep.csv"
        self.rows = read_records(file)
        if not self.rows:
            raise InputError(f"{file}: holds no row")
        names = list(self.rows[0])
        plan = folder / "sweep.json"
        self.fields = [entry["path"] for entry in (at(load_object(plan), "/vary") or [])] if plan.is_file() else \
            names[1:names.index("outcome")]
        if not 1 <= len(self.fields) <= 2:
            raise InputError(f"{folder}: {len(self.fields)} fields are varied ({', '.join(self.fields)}); allowed: one or two")
        metrics = [name for name in names[names.index("outcome") + 1:] if any(is_number(row[name]) for row in self.rows)]
        self.metric = metric or next((name for name in USUAL if name in metrics), metrics[0])
        if self.metric not in metrics:
            raise InputError(f"--metric: got \"{self.metric}\"; allowed: {', '.join(metrics)}{nearest(self.metric, metrics)}")
        self.name = folder.name

    def column(self, field):
        """The numbers of a field, or its texts as they are."""
        texts = [row[field] for row in self.rows]
        return np.array([float(text) for text in texts]) if all(map(is_number, texts)) else texts

    @property
    def failed(self):
        """Runs whose metric says nothing: diverged, not computed, or ended not as expected."""
        return np.array([row["outcome"] in FAILURES or row.get("expected") == "false" for row in self.rows])

    @property
    def how_failed(self):
        return ", ".join(dict.fromkeys(row["outcome"].replace("_", " ") for row, failed in zip(self.rows, self.failed) if failed))

    @property
    def metric_values(self):
        """NaN where the run failed or has no such number."""
        return np.array([float(row[self.metric]) if is_number(row[self.metric]) and not failed else np.nan
                         for row, failed in zip(self.rows, self.failed)])

    def axis(self, i):
        return axis(self.fields[i], self.fields)


def is_number(text):
    try:
        return np.isfinite(float(text))
    except (TypeError, ValueError):
        return False


def spread_logarithmically(values):
    values = values[np.isfinite(values)]
    return bool(values.size) and values.min() > 0 and values.max() > 30 * values.min()


def draw_sweep(sweep):
    with plt.rc_context(SETTINGS):
        figure, ax = plt.subplots(figsize=(6.0, 3.8))
        ax.set_title(sweep.name)
        columns = [sweep.column(field) for field in sweep.fields]
        texts = [i for i, column in enumerate(columns) if isinstance(column, list)]
        if len(columns) == 2 and not texts:
            draw_map(figure, ax, sweep, columns)
        else:
            draw_curves(ax, sweep, columns, texts)
        return figure


def draw_curves(ax, sweep, columns, texts):
    """Over the field of numbers, a curve for each text of the other one; without numbers, over the texts."""
    over = next((i for i in range(len(columns)) if i not in texts), 0)
    others = [i for i in range(len(columns)) if i != over]
    names = columns[others[0]] if others else [""] * len(sweep.rows)
    for name in dict.fromkeys(names):
        rows = np.array([n == name for n in names])
        x = columns[over] if over in texts else columns[over][rows]
        x = [value for value, mine in zip(columns[over], rows) if mine] if over in texts else x
        order = np.arange(len(x)) if over in texts else np.argsort(x)
        label = str(name).replace("_", " ")
        ax.plot(np.array(x)[order], sweep.metric_values[rows][order], marker="o", label=label or None, color=look(str(name)).colour)
    failed = sweep.failed
    if failed.any():
        x = [value for value, yes in zip(columns[over], failed) if yes]
        ax.plot(x, np.zeros(len(x)), ls="", marker="x", color=FAILED["edgecolor"], transform=ax.get_xaxis_transform(), clip_on=False,
                label=sweep.how_failed)
    if others or failed.any():
        ax.legend()
    if over not in texts:
        integer_ticks(ax.xaxis, columns[over])
    if over not in texts and spread_logarithmically(columns[over]):
        ax.set_xscale("log")
    if spread_logarithmically(sweep.metric_values):
        ax.set_yscale("log")
    ax.set(xlabel=sweep.axis(over), ylabel=axis(sweep.metric))


def integer_ticks(of, values):
    """Ticks at the values of a field of whole numbers."""
    values = np.unique(values)
    if (values == values.round()).all() and len(values) <= MOST_TICKS and not spread_logarithmically(values):
        of.set_ticks(values, [f"{value:.0f}" for value in values])


def draw_map(figure, ax, sweep, columns):
    values, failed = sweep.metric_values, sweep.failed
    norm = colors.LogNorm() if spread_logarithmically(values) else None
    grid = on_grid(columns, values)
    if grid is None:
        ok = np.isfinite(values)
        drawn = ax.scatter(columns[1][ok], columns[0][ok], c=values[ok], norm=norm, cmap="viridis")
        ax.scatter(columns[1][failed], columns[0][failed], marker="x", color=FAILED["edgecolor"])
        without = np.zeros(0)
    else:
        x, y = edges(grid[1]), edges(grid[0])
        fallen = on_grid(columns, failed.astype(float))[2] == 1
        without = ~np.isfinite(grid[2]) & ~fallen
        drawn = ax.pcolormesh(x, y, np.ma.masked_invalid(grid[2]), norm=norm, cmap="viridis")
        for cells, look_of_them in ((without, NO_VALUE), (fallen, FAILED)):
            for line, column in np.argwhere(cells):
                ax.add_patch(Rectangle((x[column], y[line]), x[column + 1] - x[column], y[line + 1] - y[line], **look_of_them))
        ax.grid(False)
    entries = [Patch(label=words, **how) for words, how, any_ in
               ((sweep.how_failed, FAILED, failed.any()), ("no value", NO_VALUE, without.any())) if any_]
    if entries:
        ax.legend(handles=entries, loc="lower right", bbox_to_anchor=(1, 1), ncol=2, borderaxespad=0.2)
    for set_scale, of, column in ((ax.set_xscale, ax.xaxis, columns[1]), (ax.set_yscale, ax.yaxis, columns[0])):
        if is_geometric(np.unique(column)):
            set_scale("log")
        integer_ticks(of, column)
    ax.set(xlabel=sweep.axis(1), ylabel=sweep.axis(0))
    if np.isfinite(values).any():
        figure.colorbar(drawn, label=axis(sweep.metric))


def on_grid(columns, values):
    """The values of the first field, of the second, and the metric by both; None when these are points of a sample."""
    (rows, i), (cells, j) = (np.unique(column, return_inverse=True) for column in columns)
    if len(rows) * len(cells) > 4 * len(values) or min(len(rows), len(cells)) < 2:
        return None
    grid = np.full((len(rows), len(cells)), np.nan)
    grid[i, j] = values
    return rows, cells, grid


def sketch_sweep(sweep, terminal):
    """The lines to print: a bar for each value, or shades over two fields."""
    columns, values = [sweep.column(field) for field in sweep.fields], sweep.metric_values
    if len(columns) == 2 and not any(isinstance(column, list) for column in columns):
        grid = on_grid(columns, values)
        if grid is not None:
            return shaded(sweep, grid, on_grid(columns, sweep.failed.astype(float))[2] == 1, terminal)
    labels = [", ".join(row[field] for field in sweep.fields) for row in sweep.rows]
    wide = min(40, max(map(len, labels)))
    most = np.nanmax(np.abs(values), initial=0.0) or 1.0
    full, room = "█" if terminal.unicode else "#", terminal.width - wide - 14
    lines = [f"{', '.join(map(sweep.axis, range(len(sweep.fields))))}: {axis(sweep.metric)}"]
    for label, value, row in zip(labels, values, sweep.rows):
        bar = full * int(round(max(0.0, abs(value) / most) * room)) if np.isfinite(value) else row["outcome"]
        number = f"{value:.4g}" if np.isfinite(value) else "?"
        lines.append(f"{label[:wide]:<{wide}} {number:>11} {bar}")
    return lines


def shaded(sweep, grid, failed, terminal):
    rows, cells, values = grid
    shades = SHADES[terminal.unicode]
    finite = values[np.isfinite(values)]
    bend = np.log if spread_logarithmically(finite) else (lambda x: x)
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    span = (bend(high) - bend(low)) or 1.0
    key = [f"{axis(sweep.metric)}: {shades[0]!r} {low:.4g} ... {shades[-1]!r} {high:.4g}"]
    key += [f"x {sweep.how_failed}"] if failed.any() else []
    key += ["? no value"] if (~np.isfinite(values) & ~failed).any() else []
    lines = ["   ".join(key)]
    for i in reversed(range(len(rows))):
        def shade(value, fallen):
            if not np.isfinite(value):
                return "xx" if fallen else "??"
            return 2 * shades[int((bend(value) - bend(low)) / span * (len(shades) - 1) + 0.5)]
        lines.append(f"{rows[i]:>12.4g} |" + "".join(map(shade, values[i], failed[i]))[:terminal.width - 15])
    return [*lines, f"{'':>12} {cells[0]:.4g} ... {cells[-1]:.4g}  {sweep.axis(1)}; upwards {sweep.axis(0)}"]
