"""Picture of the results of `converge`. `converge` runs a scenario several times and refines one field from run to run.
The picture shows the error of each metric over the value of this field, and over the processor time."""
import numpy as np
from hapbench_command import print_warning

from hapbench.columns import number_in, numbers
from hapbench.errors import InputError
from hapbench_looks import series as series_looks
from hapbench_report.markup import column
from hapbench_style import GREY, SHEET, legend_above

from .given import axis
from .over_axes import Axis, over_axes

ORDERS, LEVELS, TIMES = "converge.csv", "converge_levels.csv", "converge_levels_timing.csv"


def relative_errors(orders, levels):
    """Returns for each metric the error of each level, divided by the magnitude of the result of the finest level. The
    value is NaN if the level has no error above 0, or if the result is 0."""
    found = {}
    for metric in (verdict["metric"] for verdict in orders):
        rows = [row for row in levels if row["metric"] == metric]
        error, result = numbers(rows, "error_estimate"), abs(numbers(rows, "result")[-1])
        found[metric] = np.where(error > 0, error, np.nan) / (result if result > 0 else np.nan)
    return found


def curves(orders, levels, errors):
    """Returns (label, values of the field, relative errors, style) of the curve of each metric."""
    series = []
    for verdict, look in zip(orders, series_looks(len(orders))):
        metric, order = verdict["metric"], verdict["observed_order"]
        rows = [row for row in levels if row["metric"] == metric]
        known = f"order {number_in(verdict, 'observed_order'):.2f}" if order else "no order"
        style = {
            "color": look.colour,
            "marker": look.marker,
            "ls": look.line if order else "none",
            "mfc": look.colour if order else "white",
        }
        series.append(
            (f"{column(metric)[0]}, {known}", numbers(rows, "value"), errors[metric], style)
        )
    return series


def draw_converge(files, sheet=SHEET):
    """Draws the relative error of each metric in two panels: over the value of the refined field, and over the
    processor time per run. The first panel also has a line whose slope is the formal order. Metrics with an observed
    order have filled marks and a line; metrics without an observed order have hollow marks and no line. A metric
    without a relative error above 0 is not drawn, and a warning names it.
    """
    orders, levels, times = (
        files.records(ORDERS),
        files.records(LEVELS),
        numbers(files.records(TIMES), "seconds"),
    )
    shown, omitted, errors = [], [], relative_errors(orders, levels)
    for verdict in orders:
        known = np.isfinite(errors[verdict["metric"]]).any()
        (shown if known else omitted).append(verdict)
    if not shown:
        raise InputError(
            "nothing to draw: no level has an error above 0; column reason of converge.csv explains why"
        )
    if omitted:
        names = ", ".join(verdict["metric"] for verdict in omitted)
        print_warning(f"{levels[0].file}: {names}: no relative error above 0; not drawn")
    series = curves(shown, levels, errors)
    timed = [(None, times, error, style) for _, _, error, style in series]
    ordered = [
        (h, error) for (_, h, error, _), verdict in zip(series, shown) if verdict["observed_order"]
    ]
    if ordered:
        (h, error), formal = ordered[0], number_in(orders[0], "formal_order")
        at = np.nanargmax(error)
        series.append(
            (
                f"formal order {formal:g}",
                h,
                error[at] * (h / h[at]) ** formal,
                {"color": GREY, "lw": 0.8, "ls": ":", "zorder": 1},
            )
        )
    rows, columns = sheet.grid(2)
    figure, axes = sheet.panels(rows, columns, 0.4 + sheet.panel(2.7) * rows, sharey=True)
    left, right = axes.flat
    error = Axis("relative error", np.array([]), log=True)
    over_axes(
        right,
        Axis("processor time per run [s]", times, log=True),
        Axis("", np.array([]), log=True),
        timed,
    )
    over_axes(left, Axis(axis(orders[0]["field"]), series[0][1], log=True), error, series)
    legend_above(figure, *left.get_legend_handles_labels(), columns=None)
    return figure
