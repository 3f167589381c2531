"""The picture of `converge`: on logarithmic axes the error of each metric over the refined field, beside the line of the
formal order, and over the time of a run."""
import numpy as np

from hapbench_figures.performance import LOOKS, number_ticks, with_room
from hapbench_figures.results import numbers
from hapbench_report.json_input import InputError
from hapbench_report.markup import column
from hapbench_style import GREY, panels

from .given import axis

ORDERS, LEVELS, TIMES = "converge.csv", "converge_levels.csv", "converge_levels_timing.csv"


def draw_converge(results):
    """Relative errors: filled marks where an order is stated, hollow ones of what the levels show without."""
    orders, levels, times = results.records(ORDERS), results.records(LEVELS), numbers(results.records(TIMES), "seconds")
    figure, ((left, right),) = panels(1, 2, 3.1, sharey=True)
    field, shown = orders[0]["field"], []
    for i, verdict in enumerate(orders):
        rows = [row for row in levels if row["metric"] == verdict["metric"]]
        h, error = numbers(rows, "value"), numbers(rows, "error_estimate") / np.abs(numbers(rows, "result")[-1])
        error[~(np.isfinite(error) & (error > 0))] = np.nan
        colour, mark, line = LOOKS[i % len(LOOKS)]
        name = column(verdict["metric"])[0]
        name += f", order {float(verdict['observed_order']):.2f}" if verdict["observed_order"] else ", no order"
        look = {"color": colour, "marker": mark, "ls": line if verdict["observed_order"] else "none", "mfc": colour if verdict["observed_order"] else "white"}
        left.plot(h, error, label=name, **look)
        right.plot(times, error, **look)
        shown.append((h, error))
    if not any(np.isfinite(error).any() for _, error in shown):
        raise InputError("nothing to draw: no level has an error above 0; converge.csv says why")
    ordered = [pair for pair, verdict in zip(shown, orders) if verdict["observed_order"]]
    if ordered:
        (h, error), formal = ordered[0], float(orders[0]["formal_order"])
        at = np.nanargmax(error)
        left.plot(h, error[at] * (h / h[at]) ** formal, color=GREY, lw=0.8, ls=":", label=f"formal order {formal:g}", zorder=1)
    for ax, x in ((left, np.concatenate([h for h, _ in shown])), (right, times)):
        ax.set(xscale="log", yscale="log")
        if np.isfinite(x).any():
            ax.set_xlim(with_room(np.nanmin(x), np.nanmax(x)))
        number_ticks(ax)
    left.set(xlabel=axis(field), ylabel="relative error")
    right.set(xlabel="processor time of the run [s]")
    left.legend(loc="lower left", bbox_to_anchor=(0, 1))
    return figure
