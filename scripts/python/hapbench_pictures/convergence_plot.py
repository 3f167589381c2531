"""Picture of the results of `converge`. `converge` runs a scenario several times and refines one field from run to run.
The picture shows the error of each metric over the value of this field, and over the processor time."""
from itertools import cycle

import numpy as np

from hapbench.columns import number_in, numbers
from hapbench.errors import InputError
from hapbench_looks import SERIES
from hapbench_report.markup import column
from hapbench_style import GREY, SHEET, legend_above

from .given import axis
from .over_axes import Axis, over_axes

ORDERS, LEVELS, TIMES = "converge.csv", "converge_levels.csv", "converge_levels_timing.csv"


def draw_converge(files, sheet=SHEET):
    """Draws the relative error of each metric in two panels: over the value of the refined field, and over the
    processor time per run. The first panel also has a line whose slope is the formal order. Metrics with an observed
    order have filled marks and a line; metrics without an observed order have hollow marks and no line.
    """
    orders, levels, times = (
        files.records(ORDERS),
        files.records(LEVELS),
        numbers(files.records(TIMES), "seconds"),
    )
    series = []
    for verdict, series_look in zip(orders, cycle(SERIES)):
        rows = [row for row in levels if row["metric"] == verdict["metric"]]
        error, order = (
            numbers(rows, "error_estimate") / np.abs(numbers(rows, "result")[-1]),
            verdict["observed_order"],
        )
        known = f"order {number_in(verdict, 'observed_order'):.2f}" if order else "no order"
        label = f"{column(verdict['metric'])[0]}, {known}"
        series.append(
            (
                label,
                numbers(rows, "value"),
                np.where(np.isfinite(error) & (error > 0), error, np.nan),
                {
                    "color": series_look.colour,
                    "marker": series_look.marker,
                    "ls": series_look.line if order else "none",
                    "mfc": series_look.colour if order else "white",
                },
            )
        )
    if not any(np.isfinite(error).any() for _, _, error, _ in series):
        raise InputError(
            "nothing to draw: no level has an error above 0; column reason of converge.csv explains why"
        )
    timed = [(None, times, error, shown) for _, _, error, shown in series]
    ordered = [
        (h, error) for (_, h, error, _), verdict in zip(series, orders) if verdict["observed_order"]
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
