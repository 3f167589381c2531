"""Picture of the trials of `tune`."""
import json

import numpy as np
from matplotlib.lines import Line2D

from hapbench.columns import number_in, numbers
from hapbench.errors import InputError
from hapbench_looks import distinguish, law_name
from hapbench_style import BLACK, GREY, RED, SHEET, legend_above, number_ticks

from .given import axis
from .over_axes import Axis, look_of, over_axes, pareto, spread_logarithmically, with_room

TRIALS, LAWS = "tune_trials.csv", "tune.csv"
STIFFNESS, DEPTH, VIBRATION = "stiffness_N_per_m", "inside_max_m", "force_rms_above_30Hz_N"
SETTING = ("rendering.damping_ratio", "mass_kg", "velocity_filter")
CHOICE = {"ls": "none", "marker": "o", "ms": 10, "color": BLACK, "mfc": "none", "zorder": 4}
BOUND = {"color": RED, "lw": 1.0, "ls": (0, (4, 2)), "zorder": 0.5}
QUANTITIES = {
    STIFFNESS: (axis(STIFFNESS), 1.0),
    DEPTH: (axis(DEPTH), 1e3),
    VIBRATION: (axis(VIBRATION), 1.0),
}


class Trials:
    """Trials of one law for which the vibration was computed. `values`: the QUANTITIES of each trial, in the units of
    the plot. `feasible`: for each trial, True if the trial is feasible. `chosen`: for each trial, True if the trial is
    the recommended trial."""

    def __init__(self, law, trials):
        self.name = law["algorithm"]
        rows = [row for row in trials if row["algorithm"] == self.name and row[VIBRATION]]
        self.values = np.column_stack(
            [factor * numbers(rows, name) for name, (_, factor) in QUANTITIES.items()]
        )
        self.feasible = np.array([row["feasible"] == "true" for row in rows], dtype=bool)
        stiffness = number_in(law, STIFFNESS)
        self.chosen = np.array(
            [
                row["feasible"] == "true"
                and np.isclose(number_in(row, STIFFNESS), stiffness, rtol=1e-12)
                and all(row[name] == law[name] for name in SETTING if name in row)
                for row in rows
            ],
            dtype=bool,
        )


def draw_tune(files, sheet=SHEET):
    """Draws three panels: depth over stiffness, vibration over stiffness, and vibration over depth. The third panel
    also shows the Pareto front of the feasible trials. Filled marks are feasible trials, hollow marks are other trials.
    A ring marks the recommended trial of each law."""
    trials, laws = files.records(TRIALS), files.records(LAWS)
    drawn = [Trials(law, trials) for law in laws]
    distinguish(of.name for of in drawn)
    shown, bounds = np.vstack([of.values for of in drawn]), bounds_of(laws)
    if not shown.size:
        raise InputError(
            "nothing to draw: no trial is settled; column why of tune.csv explains why"
        )
    rows, columns = sheet.grid(3)
    figure, axes = sheet.panels(rows, columns, 0.5 + sheet.panel(2.6) * rows)
    for ax, x, y in zip(axes.flat, (0, 0, 1), (1, 2, 2)):
        draw_panel(ax, x, y, drawn, shown, bounds)
    legend_above(figure, *zip(*legend_of(drawn, bounds)), columns=None)
    return figure


def bounds_of(laws):
    """Returns for each of QUANTITIES the list of its bounds from --bound. All lists are empty if the table does not
    have the column `bounds`, which older versions did not write."""
    try:
        given = json.loads(laws[0].get("bounds") or "{}")
    except ValueError as error:
        raise InputError(laws[0].fault("bounds", f"a JSON object ({error})")) from error
    return [
        [factor * value for value in given.get(name, {}).values()]
        for name, (_, factor) in QUANTITIES.items()
    ]


def draw_panel(ax, x, y, drawn, shown, bounds):
    series = []
    for of in drawn:
        appearance = look_of(of.name, ls="none", ms=4)
        for which, more in (
            (~of.feasible, {"mfc": "white"}),
            (of.feasible, {}),
            (of.chosen, CHOICE),
        ):
            series.append((None, of.values[which, x], of.values[which, y], appearance | more))
        if (x, y) == (1, 2):
            front = pareto(of.values[of.feasible][:, 1:])
            look_of_front = {"color": appearance["color"], "lw": 1.0, "ls": "-", "zorder": 1}
            series.append((None, front[:, 0], front[:, 1], look_of_front))
    titles = [title for title, _ in QUANTITIES.values()]
    values = [np.append(shown[:, i], bounds[i]) for i in range(len(QUANTITIES))]
    over_axes(ax, axis_of(titles[x], values[x]), axis_of(titles[y], values[y]), series)
    for i, limits, along, line in (
        (x, ax.set_xlim, ax.xaxis, ax.axvline),
        (y, ax.set_ylim, ax.yaxis, ax.axhline),
    ):
        limits(*range_of(values[i]))
        number_ticks(along)
        for bound in bounds[i]:
            line(bound, **BOUND)
    if x == 0:
        ax.tick_params(axis="x", labelrotation=40)


def axis_of(title, values):
    """Returns an Axis without values. The axis is logarithmic if spread_logarithmically(values) is true. A value that a
    logarithmic axis cannot show, such as a vibration of 0, makes the axis linear."""
    return Axis(title, np.array([]), log=spread_logarithmically(values))


def range_of(values):
    values = values[np.isfinite(values)]
    if spread_logarithmically(values):
        return with_room(values.min(), values.max())
    room = 0.1 * np.ptp(values) or 0.1 * abs(values.max()) or 1.0
    return (
        min(values.min() - room, 0.0) if values.min() < room else values.min() - room,
        values.max() + room,
    )


def legend_of(drawn, bounds):
    """Returns (handle, label) of each element in the picture."""
    entries = [
        (Line2D([], [], **look_of(of.name, ls="none", ms=4)), law_name(of.name))
        for of in drawn
        if len(of.values)
    ]
    hollow = [of.name for of in drawn if not of.feasible.all()]
    if hollow:
        # The mark of the law if it is the only one, otherwise the mark of the first law in grey.
        more = {"color": GREY} if len(hollow) > 1 else {}
        style = look_of(hollow[0], ls="none", ms=4, mfc="white", **more)
        entries.append((Line2D([], [], **style), "not feasible"))
    if any(of.chosen.any() for of in drawn):
        entries.append((Line2D([], [], **{**CHOICE, "ms": 8}), "choice of each law"))
    if any(bounds):
        entries.append((Line2D([], [], **BOUND), "bound"))
    return entries
