"""A sweep's table as a picture: a metric over one varied field, or over two as curves or a heat map."""
import csv

import matplotlib
import numpy as np

from hapbench_figures.style import SETTINGS
from hapbench_looks import look
from hapbench_report.json_input import InputError, at, load_object

from .names import nearest

matplotlib.use("agg")
from matplotlib import colors, pyplot as plt  # noqa: E402  (the backend comes first)

USUAL = ("force_rms_above_30Hz_N", "force_max_N")
SHADES = {True: " ░▒▓█", False: " .:+#"}


class Sweep:
    def __init__(self, folder, metric):
        file = folder / "sweep.csv"
        try:
            with file.open(newline="", encoding="utf-8") as text:
                self.rows = list(csv.DictReader(text))
        except (OSError, UnicodeDecodeError, csv.Error) as error:
            raise InputError(f"{file}: cannot be read: {error}") from error
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
    def metric_values(self):
        return np.array([float(row[self.metric]) if is_number(row[self.metric]) else np.nan for row in self.rows])


def is_number(text):
    try:
        return np.isfinite(float(text))
    except (TypeError, ValueError):
        return False


def spread_logarithmically(values):
    values = values[np.isfinite(values)]
    return bool(values.size) and values.min() > 0 and values.max() > 30 * values.min()


def draw_sweep(sweep):
    with matplotlib.rc_context(SETTINGS):
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
        ax.plot(np.array(x)[order], sweep.metric_values[rows][order], marker="o", label=label,
                color=look(str(name)).colour)
    if others:
        ax.legend()
    if over not in texts and spread_logarithmically(columns[over]):
        ax.set_xscale("log")
    if spread_logarithmically(sweep.metric_values):
        ax.set_yscale("log")
    ax.set(xlabel=sweep.fields[over], ylabel=sweep.metric)


def draw_map(figure, ax, sweep, columns):
    values = sweep.metric_values
    norm = colors.LogNorm() if spread_logarithmically(values) else None
    grid = on_grid(columns, values)
    if grid is None:
        drawn = ax.scatter(columns[1], columns[0], c=values, norm=norm, cmap="viridis")
    else:
        drawn = ax.pcolormesh(grid[1], grid[0], grid[2], norm=norm, cmap="viridis", shading="nearest")
        ax.grid(False)
    for set_scale, column in ((ax.set_xscale, columns[1]), (ax.set_yscale, columns[0])):
        if spread_logarithmically(column):
            set_scale("log")
    ax.set(xlabel=sweep.fields[1], ylabel=sweep.fields[0])
    figure.colorbar(drawn, label=sweep.metric)


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
            return shaded(sweep, grid, terminal)
    labels = [", ".join(row[field] for field in sweep.fields) for row in sweep.rows]
    wide = min(40, max(map(len, labels)))
    most = np.nanmax(np.abs(values), initial=0.0) or 1.0
    full, room = "█" if terminal.unicode else "#", terminal.width - wide - 14
    lines = [f"{', '.join(sweep.fields)}: {sweep.metric}"]
    for label, value, row in zip(labels, values, sweep.rows):
        bar = full * int(round(max(0.0, abs(value) / most) * room)) if np.isfinite(value) else row["outcome"]
        lines.append(f"{label[:wide]:<{wide}} {value:>11.4g} {bar}")
    return lines


def shaded(sweep, grid, terminal):
    rows, cells, values = grid
    shades = SHADES[terminal.unicode]
    bend = np.log if spread_logarithmically(values[np.isfinite(values)]) else (lambda x: x)
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    span = (bend(high) - bend(low)) or 1.0
    lines = [f"{sweep.metric}: {shades[0]!r} {low:.4g} ... {shades[-1]!r} {high:.4g}"]
    for i in reversed(range(len(rows))):
        def shade(value):
            if not np.isfinite(value):
                return "??"
            return 2 * shades[int((bend(value) - bend(low)) / span * (len(shades) - 1) + 0.5)]
        lines.append(f"{rows[i]:>12.4g} |" + "".join(shade(value) for value in values[i])[:terminal.width - 15])
    return [*lines, f"{'':>12} {cells[0]:.4g} ... {cells[-1]:.4g}  {sweep.fields[1]}; upwards {sweep.fields[0]}"]
