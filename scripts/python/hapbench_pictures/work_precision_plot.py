"""The settings of `converge --over` as a picture: the error of each time step over its processor time, a panel
for each problem and a curve for each integrator."""
from itertools import cycle

import numpy as np

from hapbench.columns import numbers
from hapbench.errors import InputError
from hapbench_looks import SERIES
from hapbench_style import GREY, SHEET, legend_above, note

from .over_axes import Axis, over_axes

ERRORS, TIMES = "convergence.csv", "convergence_timing.csv"
REAL_TIME = 1000.0  # processor time of a simulated second that passes in real time [ms]


def draw_work_precision(files, sheet=SHEET):
    """Filled marks: resolved errors; hollow marks: errors below ten times the error of the reference solution;
    a ring: the knee of the front. Grey lines: the error that was asked for, and real time."""
    errors, times = files.records(ERRORS), files.records(TIMES)
    cost, error = 1e3 * numbers(times, "seconds_per_simulated_second"), 1e6 * numbers(
        errors, "position_error_m"
    )
    if not (np.isfinite(error) & (error > 0)).any():
        raise InputError(
            'nothing to draw: no setting has an error; "hapbench converge" printed the reason for each problem'
        )
    problems = list(dict.fromkeys(row["problem"] for row in errors))
    integrators = list(dict.fromkeys(row["integrator"] for row in errors))
    looks = dict(zip(integrators, cycle(SERIES)))
    asked = 1e6 * float(errors[0]["asked_error_m"])
    rows, columns = sheet.grid(len(problems))
    figure, axes = sheet.panels(rows, columns, 0.5 + 2.4 * rows, sharex=True, sharey=True)
    for ax, problem in zip(axes.flat, problems):
        of_problem = np.array([row["problem"] == problem for row in errors])
        series = [
            curve
            for name in integrators
            for curve in curves(
                name,
                looks[name],
                [row["integrator"] == name for row in errors] & of_problem,
                errors,
                cost,
                error,
            )
        ]
        across = Axis("processor time per simulated second [ms]", cost, log=True)
        over_axes(ax, across, Axis("rms error of the tip's position [µm]", error, log=True), series)
        ax.axhline(asked, color=GREY, lw=0.8, ls=":", zorder=1)
        if cost.max() > 0.1 * REAL_TIME:
            ax.axvline(REAL_TIME, color=GREY, lw=0.8, ls="--", zorder=1)
        for at in np.flatnonzero(of_problem & np.array([row["knee"] == "true" for row in times])):
            ax.plot(cost[at], error[at], marker="o", ms=10, mfc="none", mec=GREY, lw=0)
        if not np.isfinite(error[of_problem]).any():
            note(ax, 0.5, 0.5, "no error: not predictable", ha="center")
        ax.set_title(problem)
        ax.label_outer()
    for ax in list(axes.flat)[len(problems) :]:
        ax.set_visible(False)
    legend_above(figure, *axes.flat[0].get_legend_handles_labels(), columns=None)
    return figure


def curves(name, own, chosen, errors, cost, error):
    """The curve of an integrator, and its unresolved errors as hollow marks."""
    resolved = np.array([row["resolved"] == "true" for row in errors])
    look = {"color": own.colour, "marker": own.marker}
    shown = chosen & np.isfinite(error) & (error > 0)
    yield name, cost[shown], np.where(resolved, error, np.nan)[shown], look | {"ls": own.line}
    hollow = shown & ~resolved
    if hollow.any():
        yield None, cost[hollow], error[hollow], look | {"ls": "none", "mfc": "white"}
