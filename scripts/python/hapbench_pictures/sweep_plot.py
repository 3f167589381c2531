"""Picture of a sweep: a metric over one varied field, or over two fields as curves or as a heat map. A sweep that
samples the ranges of several fields, or a sweep over more than two fields, is drawn as points over each field. For a
sampled sweep, the picture also states the influence of each field."""
import textwrap
from dataclasses import dataclass

import numpy as np
from matplotlib import colors
from matplotlib.patches import Patch, Rectangle
from scipy.stats import spearmanr

from hapbench.columns import is_number, number_in, read_records
from hapbench.errors import InputError
from hapbench.results import at, objects, read_object
from hapbench_command import nearest, output_of_program, table_text
from hapbench_looks import by_class, look_of_class
from hapbench_style import PETROL, SETTINGS, SHEET, legend_above, plt

from .given import axis
from .over_axes import Axis, look_of, over_axes, spread_logarithmically

USUAL = ("force_rms_above_30Hz_N", "force_max_N")
FAILURES = ("diverges", "error")
# Style of a cell of the heat map that has no value of the metric.
NO_VALUE = {"facecolor": "#F4F4F4", "edgecolor": "#C8C8C8", "lw": 0.5}
WIDTH = 100  # width of the printed table [characters]
MAX_COSINES, ROWS_PER_COSINE = 6, 10
# Smallest number of rows of a sampled sweep for which the influence of a field is computed.
MIN_ROWS = 20
# If the ratio of the largest to the smallest value of a positive metric exceeds this number, the Sobol index of the
# logarithm is also computed.
DECADE = 10.0


def runs_that_meet(folder, conditions):
    """Returns the numbers, as texts, of the runs of a sweep that meet all conditions. A condition such as
    "inside_max_m<3e-4" has the grammar of `hapbench sweep --where`. The program evaluates it."""
    output = output_of_program("evaluates --where", "plot", "--runs-where", folder, *conditions)
    return set(output.split())


class Sweep:
    def __init__(self, folder, metric, where=()):
        file = folder / "sweep.csv"
        self.name, rows = folder.name, read_records(file)
        plan_file = folder / "sweep.json"
        plan = read_object(plan_file) if plan_file.is_file() else {}
        self.gap = gap_of(file, rows, plan)
        kept = runs_that_meet(folder, where) if where else None
        self.rows = [row for row in rows if kept is None or row["index"] in kept]
        if not self.rows:
            raise InputError(
                f"{file}: holds no row{' with ' + ' and '.join(where) if rows else ''}"
            )
        names = list(self.rows[0])
        if "outcome" not in names:
            raise InputError(f"{file}: line 1: no column outcome; allowed: the table of a sweep")
        self.axes = objects(plan, "vary", plan_file) or [
            {"path": name} for name in names[1 : names.index("outcome")]
        ]
        for i, entry in enumerate(self.axes):
            if not isinstance(entry.get("path"), str):
                raise InputError(f"{plan_file}: /vary/{i}/path: missing; allowed: a field")
            if is_numeric(entry):
                for row in self.rows:
                    number_in(row, entry["path"], may_be_empty=False, is_finite=True)
        self.fields, self.sampled = [entry["path"] for entry in self.axes], "sample" in plan
        self.of_file = at(plan, "/sample/method") == "points"
        metrics = [
            name
            for name in names[names.index("outcome") + 1 :]
            if any(is_number(row[name]) for row in self.rows)
        ]
        if not metrics:
            raise InputError(f"{file}: no row has a metric with a number")
        self.metric = metric or next((name for name in USUAL if name in metrics), metrics[0])
        if self.metric not in metrics:
            raise InputError(
                f"--metric: got \"{self.metric}\"; allowed: {', '.join(metrics)}{nearest(self.metric, metrics)}"
            )
        outcomes = np.array([row["outcome"] for row in self.rows])
        failed = np.array(
            [row["outcome"] in FAILURES or row.get("expected") == "false" for row in self.rows]
        )
        # For each class of failed runs, True for the runs of this class. A run fails if it diverges, is not computed or
        # has an unexpected outcome. The metrics of failed runs have no meaning.
        self.classes = {name: failed & (outcomes == name) for name in by_class(outcomes[failed])}
        values = [number_in(row, self.metric, is_finite=True) for row in self.rows]
        self.values = np.array([np.nan if bad else value for value, bad in zip(values, failed)])

    def column(self, field):
        """Returns the values of a field as an array of numbers if all are numbers, otherwise as a list of texts."""
        texts = [row[field] for row in self.rows]
        return np.array([float(text) for text in texts]) if all(map(is_number, texts)) else texts

    def is_logarithmic(self, i):
        """Returns True if the axis of field i is logarithmic. If the sweep states the scale of the field, the scale
        decides. Otherwise, the axis is logarithmic for three or more numbers in equal ratios, and linear for texts and
        for three or more numbers in equal steps. For all other numbers, spread_logarithmically() decides.
        """
        if "scale" in self.axes[i]:
            return self.axes[i]["scale"] == "log"
        values = self.column(self.fields[i])
        if isinstance(values, list):
            return False
        values = np.unique(values)
        if len(values) < 3:
            return spread_logarithmically(values)
        even = [
            np.allclose(np.diff(of), of[-1] - of[-2], rtol=1e-6)
            for of in (values, np.log(values) if values[0] > 0 else values)
        ]
        return (
            even[1]
            if values[0] > 0 and even[0] != even[1]
            else not even[0] and spread_logarithmically(values)
        )

    def sensitivities(self):
        """Returns a list with the Sensitivity of each field over the runs that have the metric. An entry is None where
        sensitivity() returns None."""
        ok = np.isfinite(self.values)
        found = []
        for i, entry in enumerate(self.axes):
            column = self.column(self.fields[i])
            column = (
                [value for value, yes in zip(column, ok) if yes]
                if isinstance(column, list)
                else column[ok]
            )
            coordinate = None
            if ("range" in entry or self.of_file and isinstance(column, np.ndarray)) and len(
                column
            ):
                coordinate = np.log(column) if self.is_logarithmic(i) else column
                coordinate = (coordinate - coordinate.min()) / (np.ptp(coordinate) or 1.0)
            found.append(sensitivity(column, coordinate, self.values[ok]))
        return found

    @property
    def spans_decades(self):
        """Returns True if all values of the metric are positive and the largest is more than DECADE times the
        smallest."""
        return spans_decades(self.values[np.isfinite(self.values)])

    @property
    def is_cloud(self):
        """Returns True if the points form no grid that a picture can show."""
        return len(self.fields) > 2 or self.sampled and len(self.fields) > 1


def is_numeric(entry):
    """Returns True if all values of a field are numbers. `entry`: description of the field in sweep.json."""
    values = entry.get("values")
    if isinstance(values, list) and values:
        return all(is_number(str(value)) for value in values)
    return "range" in entry


def gap_of(file, rows, plan):
    """Returns a text that states which rows sweep.csv lacks. The text is empty if the table is complete, or if
    sweep.json does not state the number of runs. The program writes sweep.csv when all runs are finished. `rows`: rows
    of the table. `plan`: content of sweep.json."""
    runs = plan.get("runs")
    if isinstance(runs, bool) or not isinstance(runs, int) or runs <= 0:
        return ""
    for row in rows:
        if not row["index"].isdecimal():
            raise InputError(row.fault("index", "the number of a run"))
    found = {int(row["index"]) for row in rows}
    first = next((run for run in range(runs) if run not in found), None)
    if first is not None:
        return (
            f"{file}: {len(rows)} of {runs} rows; the first missing row is of run {first}; "
            "the file was cut or edited"
        )
    return (
        f"{file}: {len(rows)} rows, but sweep.json states {runs} runs; one of the files was edited"
        if len(rows) != runs
        else ""
    )


def draw_sweep(sweep, sheet=SHEET):
    with plt.rc_context(SETTINGS):
        axes = [
            Axis.of(axis(field, sweep.fields), sweep.column(field), sweep.is_logarithmic(i))
            for i, field in enumerate(sweep.fields)
        ]
        of_numbers = len(axes) == 2 and not any(of.names for of in axes)
        if sweep.is_cloud or of_numbers and on_grid(axes, sweep.values) is None:
            return draw_cloud(sweep, axes, sheet)
        figure, ((ax,),) = sheet.panels(1, 1, 0.9 + 0.4 * sheet.width)
        ax.set_title(sweep.name)
        if of_numbers:
            draw_map(figure, ax, sweep, axes)
        else:
            draw_curves(ax, sweep, axes)
            legend_above(figure, *ax.get_legend_handles_labels(), columns=None)
        return figure


def draw_cloud(sweep, over, sheet):
    """Draws the metric as points over each field. `over`: the Axis of each field."""
    value = Axis.of(axis(sweep.metric), sweep.values)
    high, wide = sheet.grid(len(over))
    figure, axes = sheet.panels(high, wide, 0.5 + sheet.panel(2.4) * high)
    figure.suptitle(sweep.name, x=0.01, ha="left", fontsize=9, weight="bold")
    found = sweep.sensitivities() if sweep.sampled else [None] * len(over)
    for i, (ax, x) in enumerate(zip(axes.flat, over)):
        over_axes(
            ax,
            x,
            value,
            [
                (
                    None,
                    x.values,
                    value.values,
                    {"ls": "none", "marker": "o", "ms": 2.5, "alpha": 0.7, "color": PETROL},
                )
            ],
        )
        mark_classes(ax, sweep, x.values)
        if found[i]:
            ax.set_title(sensitivity_text(found[i]), fontsize=7.5)
        if i % wide:
            ax.set_ylabel("")
    if sweep.classes:
        figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="upper right", ncol=4)
    for ax in axes.flat[len(over) :]:
        ax.axis("off")
    return figure


def mark_classes(ax, sweep, x):
    """Draws a mark on the lower edge of the panel for each failed run, in the colour of its class."""
    for name, mine in sweep.classes.items():
        title, colour, _ = look_of_class(name)
        ax.plot(
            x[mine],
            np.zeros(mine.sum()),
            ls="",
            marker="x",
            color=colour,
            label=title,
            transform=ax.get_xaxis_transform(),
            clip_on=False,
        )


def sensitivity_text(found):
    rank = "" if found.rank is None else f"rank {found.rank:+.2f}, "
    text = f"{rank}S\u2081 {hundredths(found.first_order)} ± {hundredths(found.error)}"
    if found.of_logarithm is None:
        return text
    return f"{text}\nof the logarithm {hundredths(found.of_logarithm)} ± {hundredths(found.error_of_logarithm)}"


def hundredths(number):
    """Formats a number with two decimals, without "-0.00"."""
    return f"{round(number, 2) + 0.0:.2f}"


def draw_curves(ax, sweep, over):
    """Draws the metric over a numeric field, with one curve for each value of the other field. If both fields have
    texts, draws over the texts of the first field."""
    x = next((of for of in over if not of.names), over[0])
    other = next((of for of in over if of is not x), None)
    value, series = Axis.of(axis(sweep.metric), sweep.values), []
    for i, name in enumerate(other.names if other else ("",)):
        rows = np.flatnonzero(other.values == i) if other else np.arange(len(sweep.rows))
        rows = rows if x.names else rows[np.argsort(x.values[rows], kind="stable")]
        series.append(
            (
                name.replace("_", " ") or None,
                x.values[rows],
                value.values[rows],
                look_of(name) if name else {"color": PETROL, "marker": "o", "ls": "-"},
            )
        )
    over_axes(ax, x, value, series)
    mark_classes(ax, sweep, x.values)


def draw_map(figure, ax, sweep, over):
    values, classes, (y_axis, x_axis) = sweep.values, sweep.classes, over
    norm = colors.LogNorm() if spread_logarithmically(values) else None
    grid = on_grid(over, values)
    x, y = edges(grid[1]), edges(grid[0])
    shown = {name: on_grid(over, mine.astype(float))[2] == 1 for name, mine in classes.items()}
    shown[None] = ~np.isfinite(grid[2]) & ~sum(shown.values(), np.zeros(grid[2].shape, bool))
    drawn = ax.pcolormesh(x, y, np.ma.masked_invalid(grid[2]), norm=norm, cmap="viridis")
    for name, cells in shown.items():
        for line, column in np.argwhere(cells):
            ax.add_patch(
                Rectangle(
                    (x[column], y[line]),
                    x[column + 1] - x[column],
                    y[line + 1] - y[line],
                    **patch_of(name),
                )
            )
    ax.grid(False)
    over_axes(ax, x_axis, y_axis)
    entries = [
        Patch(label=look_of_class(name)[0] if name else "no value", **patch_of(name))
        for name, cells in shown.items()
        if cells.any()
    ]
    if entries:
        ax.legend(
            handles=entries, loc="lower right", bbox_to_anchor=(1, 1), ncol=2, borderaxespad=0.2
        )
    if np.isfinite(values).any():
        figure.colorbar(drawn, label=Axis(axis(sweep.metric), values).label)


def edges(values):
    """Returns the borders of the cells around the values of a grid, one more than values."""
    if spread_logarithmically(values):
        return np.exp(edges(np.log(values)))
    middle = (values[1:] + values[:-1]) / 2
    return np.concatenate([[2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]])


def patch_of(name):
    """Returns the style of a cell of the heat map without a number. `name`: the class of the cell's failed run, or None
    if the cell has no failed run."""
    if name is None:
        return NO_VALUE
    _, colour, hatch = look_of_class(name)
    return {"facecolor": colour, "edgecolor": PETROL, "hatch": hatch, "lw": 0}


def on_grid(over, values):
    """Returns (values of the first field, values of the second field, metric at each pair of values; NaN at a pair
    without a run). Returns None if the runs form no grid: a field has one value only, or there are more than four pairs
    for each run."""
    (rows, i), (cells, j) = (np.unique(of.values, return_inverse=True) for of in over)
    if len(rows) * len(cells) > 4 * len(values) or min(len(rows), len(cells)) < 2:
        return None
    grid = np.full((len(rows), len(cells)), np.nan)
    grid[i, j] = values
    return rows, cells, grid


def sensitivity_table(sweep):
    """Returns the lines of a printed table: the influence of each field of a sampled sweep, largest first, and the
    method. Returns an empty list for a sweep that is not sampled or is not drawn as points."""
    if not (sweep.sampled and sweep.is_cloud):
        return []
    found, runs = sweep.sensitivities(), np.isfinite(sweep.values).sum()
    without = "".join(
        f"; {mine.sum()} {name.replace('_', ' ')}" for name, mine in sweep.classes.items()
    )
    if not any(found):
        return [
            f"too few runs for a sensitivity analysis: {runs} runs have this metric{without}; "
            f"needed: {MIN_ROWS} runs with several values of the metric"
        ]
    logarithm = sweep.spans_decades
    heads = ["sensitivity to field", "rank correlation", "first order", "+-"]
    heads += ["of the logarithm", "+- "] if logarithm else []
    rows = [
        [field, *(numbers_of(of, logarithm) if of else ["-"] * (len(heads) - 1))]
        for field, of in sorted(zip(sweep.fields, found), key=lambda pair: -main_index(pair[1]))
    ]
    together = hundredths(sum(of.first_order for of in found if of))
    of_logarithm = ""
    if logarithm:
        together_of_logarithm = hundredths(sum(of.of_logarithm for of in found if of))
        of_logarithm = (
            f"Of the logarithm: the index of the logarithm of {sweep.metric}, whose values span more than a "
            f"decade, so that a few large values determine its variance; the sum is {together_of_logarithm}. "
        )
    return [
        table_text(heads, rows, wide=True, numbers=True),
        *textwrap.wrap(
            "rank correlation: Spearman's coefficient. First order: Sobol's index, the fraction of the "
            f"variance of {sweep.metric} that the field alone explains; the sum is {together}, and "
            f"the rest is due to interactions of fields or to no field. {of_logarithm}Estimated by regression on "
            f"at most {MAX_COSINES} cosines of the field's position in its range, or on the values "
            f"of a list, over {runs} runs{without}. +-: standard error, by jackknife",
            WIDTH,
        ),
    ]


def numbers_of(found, logarithm):
    """Returns the cells of the printed line of a field. `logarithm`: true if the line has the index of the
    logarithm."""
    numbers = [found.rank, found.first_order, found.error]
    numbers += [found.of_logarithm, found.error_of_logarithm] if logarithm else []
    return ["-" if number is None else hundredths(number) for number in numbers]


def main_index(found):
    """Returns the Sobol index by which the printed fields are sorted: the index of the logarithm if there is one."""
    if found is None:
        return -1
    return found.first_order if found.of_logarithm is None else found.of_logarithm


def spans_decades(values):
    return len(values) > 0 and values.min() > 0 and values.max() > DECADE * values.min()


@dataclass(frozen=True)
class Sensitivity:
    """Influence of one field i of a sampled sweep on a metric y, computed from the sweep's rows: Spearman's rank
    correlation, and the first-order Sobol index S_i = Var(E[y | x_i]) / Var(y), the fraction of the metric's variance
    that field i explains alone.

    E[y | x_i] is a least-squares fit. For a field with a range, the fit has up to six cosines cos(pi k u) of the
    relative position u in the range (Plischke, "How to compute variance-based sensitivity indicators with your
    spreadsheet software", Environmental Modelling & Software 35, 2012). For listed values, the fit is the mean at each
    value. S_i is the R^2 of the fit, adjusted for the number of functions (Ezekiel), so that S_i has the mean 0 for a
    field without influence. The standard error of S_i comes from a jackknife over the rows; the error of a Latin
    hypercube or a Sobol sequence is smaller. If y varies faster than the sixth cosine, S_i is too small: if y jumps in
    the middle of the range, by a fifteenth.

    The largest values dominate a variance. For a positive metric that spans more than a decade, the index of the
    logarithm is also computed, so that three outliers do not hide a field that determines all other values.
    """

    rank: float | None  # None for texts, which have no order
    first_order: float
    error: float  # standard error of first_order
    of_logarithm: float | None = None  # first-order index of log(y); None unless spans_decades(y)
    error_of_logarithm: float | None = None


def sensitivity(column, coordinate, y):
    """Returns the Sensitivity of y to a field. `column`: values of the field. `coordinate`: relative positions of the
    values in the range of the field (0 ... 1); None for listed values. Returns None if there are fewer than MIN_ROWS
    rows, or if y or the field is constant."""
    if len(y) < MIN_ROWS or np.ptp(y) == 0 or len(set(column)) < 2:
        return None
    if coordinate is None:
        values = sorted(set(column))
        functions = np.array([[float(value == other) for other in values] for value in column])
    else:
        count = min(MAX_COSINES, len(y) // ROWS_PER_COSINE)
        functions = np.column_stack(
            [np.ones(len(y)), np.cos(np.pi * np.outer(coordinate, np.arange(1, count + 1)))]
        )
    rank = None if isinstance(column, list) else float(spearmanr(column, y).statistic)
    of_logarithm = adjusted_share(functions, np.log(y)) if spans_decades(y) else (None, None)
    return Sensitivity(rank, *adjusted_share(functions, y), *of_logarithm)


def adjusted_share(functions, y):
    """Returns (adjusted R^2 of the least-squares fit of y by `functions`, its standard error by the jackknife). The
    functions must span the constant. Without row i, the sum of the squared residuals e is smaller by e_i^2 / (1 - h_i),
    with the leverage h_i of the row, and the sum of the squares of y - mean is smaller by n / (n - 1) (y_i - mean)^2.
    """
    n, fitted = len(y), functions.shape[1]
    q, _ = np.linalg.qr(functions)
    residual, leverage, off = y - q @ (q.T @ y), (q**2).sum(axis=1), y - y.mean()

    def adjusted(residuals, total, rows):
        return 1 - residuals / total * (rows - 1) / (rows - fitted)

    alone = (
        leverage > 1 - 1e-9
    )  # a listed value that only one row has; the fit without this row is also defined
    without = np.where(alone, 0.0, residual**2 / np.where(alone, 1.0, 1 - leverage))
    each = adjusted(residual @ residual - without, off @ off - n / (n - 1) * off**2, n - 1)
    return adjusted(residual @ residual, off @ off, n), float(
        np.sqrt((n - 1) / n * ((each - each.mean()) ** 2).sum())
    )
