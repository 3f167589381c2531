"""Picture of the results of `converge --over`: the error at each time step over the processor time, with a panel for
each problem and a curve for each integrator."""
import numpy as np
from matplotlib.lines import Line2D

from hapbench.columns import number_in, numbers
from hapbench.errors import InputError
from hapbench_looks import distinguish, law_name, series
from hapbench_style import GREY, PLATE, SHEET, legend_above, note, number_ticks
from hapbench_style import look as style_look

from .over_axes import Axis, over_axes

ERRORS, TIMES = "convergence.csv", "convergence_timing.csv"
FRONT = {
    "color": GREY,
    "lw": 0.9,
    "ls": "-",
    "zorder": 1,
}  # settings of which no other setting is better in both error and time
MAX_LABELS = 5  # largest number of labels of a panel
ROOM = np.array([0.2, 0.13])  # size of a label, as fractions of the panel's width and height
KNEE = {"marker": "o", "ms": 10, "mfc": "none", "mec": GREY, "ls": "none"}
REQUESTED = {"color": GREY, "lw": 0.8, "ls": ":"}
SPEED = {"color": GREY, "lw": 0.8, "ls": "--"}
# Processor time per simulated second at which the simulation runs in real time [ms].
REAL_TIME = 1000.0


# Smallest ratio of the largest to the smallest error for which the error axis is logarithmic.
LOGARITHMIC_FROM = 10.0
MODEL_ERRORS, MODEL_TIMES = "convergence_model.csv", "convergence_model_timing.csv"


def draw_model_errors(files, sheet=SHEET):
    """Draws the errors of laws against a reference over the computation time of a step. Panels show the error of the
    force's direction, the error of the force and, if a hand moves the tool, the error of the tip's position. A mark is
    at the median of the computation times; a line reaches from the mark to their 99.9th percentile. A grey line is the
    deadline of a step. A hollow mark is a law that has the same constraints as the reference. Marks are not joined,
    because laws have no order. Laws whose runs failed are omitted.
    """
    errors, times = files.records(MODEL_ERRORS), files.records(MODEL_TIMES)
    median, p99_9 = (1e6 * numbers(times, name) for name in ("step_median_s", "step_p99_9_s"))
    deadline = 1e6 * number_in(times[0], "deadline_s")
    shared = is_true(errors, "shares_reference")
    distinguish(row["problem"] for row in errors)
    quantities = (
        (
            "mean error of the direction [°]",
            np.degrees(numbers(errors, "force_direction_error_rad")),
        ),
        ("rms error of the force [N]", numbers(errors, "force_error_rms_N")),
        ("rms displacement of the tip [mm]", 1e3 * numbers(errors, "displacement_rms_m")),
    )
    quantities = [one for one in quantities if np.isfinite(one[1]).any()]
    if not quantities:
        raise InputError("nothing to draw: no law has an error against the reference force")
    # A law whose run failed has no error.
    drawn = np.flatnonzero(np.isfinite([values for _, values in quantities]).any(axis=0))
    rows, columns = sheet.grid(len(quantities))
    figure, axes = sheet.panels(rows, columns, 1.0 + sheet.panel(2.4) * rows)
    for ax, (label, values) in zip(axes.flat, quantities):
        for i in drawn:
            row = errors[i]
            look = style_look(row["problem"])
            ax.plot([median[i], p99_9[i]], [values[i]] * 2, color=look.colour, lw=0.8)
            ax.plot(
                median[i],
                values[i],
                ls="none",
                marker=look.marker,
                ms=5,
                color=look.colour,
                mfc="white" if shared[i] else look.colour,
                label=law_name(row["problem"]) + (" (shares the reference)" if shared[i] else ""),
            )
        ax.axvline(deadline, zorder=1, **SPEED)
        known = values[np.isfinite(values)]
        logarithmic = known.min() > 0 and known.max() > LOGARITHMIC_FROM * known.min()
        ax.set(xscale="log", xlabel="time of a step [µs]: median to 99.9 %", ylabel=label)
        ax.set_yscale("log" if logarithmic else "linear")
        for of in (ax.xaxis, ax.yaxis) if logarithmic else (ax.xaxis,):
            number_ticks(of)
    for ax in axes.flat[len(quantities) :]:
        ax.set_visible(False)
    handles, labels = axes.flat[0].get_legend_handles_labels()
    handles.append(Line2D([], [], **SPEED))
    labels.append(f"deadline, {1e-3 * deadline:g} ms")
    legend_above(figure, handles, labels, columns=None)
    return figure


def draw_work_precision(files, sheet=SHEET):
    """Returns the figure. Filled marks are resolved errors. Hollow marks are bounds of errors that the reference
    solution does not resolve. A ring marks the knee of the Pareto front of error and processor time. Grey lines mark
    the requested error and real time.
    """
    errors, times = files.records(ERRORS), files.records(TIMES)
    cost = 1e3 * numbers(times, "seconds_per_simulated_second")
    error = error_or_bound(errors)
    if not (np.isfinite(error) & (error > 0)).any():
        raise InputError(
            'nothing to draw: no setting has an error; "hapbench converge" printed the reason for each problem'
        )
    problems = list(dict.fromkeys(row["problem"] for row in errors))
    integrators = list(dict.fromkeys(row["integrator"] for row in errors))
    looks = dict(zip(integrators, series(len(integrators))))
    is_knee = is_true(times, "knee")
    requested = 1e6 * number_in(errors[0], "asked_error_m")
    rows, columns = sheet.grid(len(problems))
    # Processor times of laws can differ by a factor of a thousand, so each panel has its own range of times.
    figure, axes = sheet.panels(rows, columns, 0.5 + (sheet.panel(2.4) + 0.2) * rows, sharey=True)
    for ax, problem in zip(axes.flat, problems):
        of_problem = np.array([row["problem"] == problem for row in errors])
        drawn = [
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
        across = Axis("processor time per\nsimulated second [ms]", cost, log=True)
        over_axes(ax, across, Axis("rms error of the\ntip's position [µm]", error, log=True), drawn)
        ax.axhline(requested, zorder=1, **REQUESTED)
        if cost[of_problem].max() > 0.1 * REAL_TIME:
            ax.axvline(REAL_TIME, zorder=1, **SPEED)
        for at in np.flatnonzero(of_problem & is_knee):
            ax.plot(cost[at], error[at], **KNEE)
        draw_front(ax, errors, cost, error, of_problem & is_true(times, "on_front"), is_knee)
        if not np.isfinite(error[of_problem]).any():
            note(ax, 0.5, 0.5, "no error: not predictable", ha="center")
        ax.set_title(problem.replace("_", " "))
        leave_room(ax)
    for ax in axes[:, 1:].flat:
        ax.set_ylabel("")
    for ax in list(axes.flat)[len(problems) :]:
        ax.set_visible(False)
    is_bound = np.isfinite(error) & (error > 0) & ~is_true(errors, "resolved")
    unresolved = [row["integrator"] for row, is_one in zip(errors, is_bound) if is_one]
    marks, names = legend_of(
        looks, requested, is_knee.any(), unresolved, cost.max() > 0.1 * REAL_TIME
    )
    legend_above(figure, marks, names, columns=None)
    return figure


def error_or_bound(rows):
    """Returns the position error of each setting [um]. If the error is not resolved, returns its bound: the difference
    from the reference solution plus the error of the reference solution."""
    difference, of_reference = (
        1e6 * numbers(rows, name) for name in ("position_error_m", "reference_position_error_m")
    )
    return np.where(is_true(rows, "resolved"), difference, difference + of_reference)


def leave_room(ax):
    """Extends the range of the panel by the room that the labels of the front need, below and on the left."""
    ax.margins(x=0.05, y=0.2)
    low, high = ax.get_xlim()
    ax.set_xlim(low * (low / high) ** ROOM[0], high)


def legend_of(looks, requested, has_knee, unresolved, has_real_time):
    """Returns (handles, labels) of the elements in the picture. `looks`: look of each integrator. `requested`:
    requested error [µm]. `unresolved`: integrators of the unresolved errors."""
    integrators = list(looks)
    marks = [
        Line2D([], [], marker=looks[name].marker, color=looks[name].colour, ls=looks[name].line)
        for name in integrators
    ]
    names = [name.replace("_", " ") for name in integrators]
    marks.append(Line2D([], [], **FRONT))
    names.append("front, with time steps [ms]")
    if has_knee:
        marks.append(Line2D([], [], **KNEE))
        names.append("knee")
    if unresolved:
        marker = looks[unresolved[0]].marker
        marks.append(Line2D([], [], marker=marker, color=GREY, mfc="white", ls="none"))
        names.append("bound, not resolved by the reference")
    marks.append(Line2D([], [], **REQUESTED))
    names.append(f"error that is asked for: {requested:g} µm")
    if has_real_time:
        marks.append(Line2D([], [], **SPEED))
        names.append("real time")
    return marks, names


def draw_front(ax, errors, cost, error, chosen, is_knee):
    """Draws a line through the settings (integrator and time step) on the Pareto front. Labels the time steps at the
    knee and at both ends of the front, and of settings between them if there is space. Labels stand below the front,
    where no setting can be.
    """
    rows = np.flatnonzero(chosen & np.isfinite(error) & (error > 0))
    rows = rows[np.argsort(cost[rows])]
    ax.plot(cost[rows], error[rows], **FRONT)
    shown = np.isfinite(error) & (error > 0)
    position = np.array(
        [np.log(of) / (np.ptp(np.log(of[shown])) or 1.0) for of in (cost, error)]
    )  # in units of the panel's width and height
    first = [row for row in rows if is_knee[row]] + list(rows[[0, -1]] if rows.size else ())
    labelled = []
    for row in dict.fromkeys([*first, *rows]):
        distances = [np.abs(position[:, row] - position[:, other]) / ROOM for other in labelled]
        if len(labelled) < MAX_LABELS and all(away.max() >= 1 for away in distances):
            labelled.append(row)
            ax.annotate(
                f"{1e3 * number_in(errors[row], 'step_s'):.3g}",
                (cost[row], error[row]),
                xytext=(-3.5, -3),
                textcoords="offset points",
                ha="right",
                va="top",
                fontsize=6.5,
                color=GREY,
                bbox=PLATE,
                zorder=1.5,
            )


def is_true(rows, column):
    return np.array([row[column] == "true" for row in rows])


def curves(name, of_curve, chosen, errors, cost, error):
    """Yields (label, processor times, errors, style) of the curve of an integrator, and of the bounds of its
    unresolved errors as hollow marks."""
    resolved = is_true(errors, "resolved")
    look = {"color": of_curve.colour, "marker": of_curve.marker}
    shown = chosen & np.isfinite(error) & (error > 0)
    yield name, cost[shown], np.where(resolved, error, np.nan)[shown], look | {"ls": of_curve.line}
    hollow = shown & ~resolved
    if hollow.any():
        yield None, cost[hollow], error[hollow], look | {"ls": "none", "mfc": "white"}
