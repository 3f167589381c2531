"""One plot for what the program finds over fields: the limits of `limit`, alone, over another field
and on devices, the trials of `tune` and the levels of `converge`; sweep_plot draws sweeps by it."""
from dataclasses import dataclass
from itertools import cycle
from textwrap import wrap

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from hapbench.columns import numbers
from hapbench.errors import InputError
from hapbench_looks import SERIES, by_class, look, look_of_class
from hapbench_report.markup import column
from hapbench_style import (
    BLACK,
    GREY,
    PETROL,
    PLUM,
    PUBLISHED_LINE,
    equal_curves,
    legend_above,
    number_ticks,
    panels,
    plt,
    striped,
)

from .given import axis

MOST_TICKS = 12
LIMIT, LIMIT_RUNS = "limit.csv", "limit_runs.csv"
ORDERS, LEVELS, TIMES = "converge.csv", "converge_levels.csv", "converge_levels_timing.csv"
TRIALS, LAWS = "tune_trials.csv", "tune.csv"
# Closed forms and what is known besides, as columns of limit.csv. Where the loop has no linear
# edge, as with dry friction, those of stability say nothing of it.
KNOWN = {
    "worst_hand_limit": "linear limit, worst hand",
    "passive_colgate_schenkel": "passive (Colgate, Schenkel)",
    "passive_with_delay": "passive, with delay",
    "stable_gil_hulin": "stable (Gil, Hulin)",
    "passive_abbott_okamura": "passive (Abbott, Okamura)",
    "exact_undamped_handle": "exact, undamped handle",
}
OF_LINEAR_EDGE = ("stable_gil_hulin", "exact_undamped_handle")
KNOWN_LOOKS = tuple(
    {"color": colour, "lw": 1.4, "ls": line}
    for line in ("-", (0, (5, 2)), (0, (1, 1)))
    for colour in (PLUM, "#1F4E9E", "#2E6B34")
)
THEORY, FOUND = {"color": PETROL, "lw": 2.6}, {"color": BLACK, "lw": 1.1, "ls": (0, (2, 2))}


@dataclass
class Axis:
    """One direction of a plot: its numbers, or the places of texts."""

    title: str
    values: np.ndarray
    names: tuple = ()
    log: bool = False

    @classmethod
    def of(cls, title, values, log=None):
        """`log`: None decides by the span."""
        if isinstance(values, list):
            names = tuple(dict.fromkeys(values))
            return cls(title, np.array([names.index(value) for value in values], float), names)
        return cls(title, values, (), spread_logarithmically(values) if log is None else log)


def spread_logarithmically(values):
    values = values[np.isfinite(values)]
    return bool(values.size) and values.min() > 0 and values.max() > 30 * values.min()


def over_axes(ax, x, y, series=(), runs=()):
    """`series`: label, values along x and y, and look of each curve, of which equal ones show in
    stripes; `runs`: a class with the places of its runs each; `x`, `y`: the Axis of either
    direction."""
    size = 26 if sum(len(xs) for _, xs, _ in runs) < 100 else 9
    for name, xs, ys in runs:
        title, colour, hatch = look_of_class(name)
        ax.scatter(
            xs,
            ys,
            s=size,
            marker="s",
            color=colour,
            edgecolor=PETROL,
            lw=0.3,
            hatch=hatch,
            label=title,
        )
    for (label, xs, ys, own), (place, count) in zip(
        series, equal_curves([(xs, ys) for _, xs, ys, _ in series])
    ):
        if count > 1 and len(xs) > 1:
            own = {**own, "markevery": (place % len(xs), count)} | (
                {"ls": striped(own["ls"], place, count)} if own.get("ls", "none") != "none" else {}
            )
        ax.plot(xs, ys, label=label, **own)
    for along, of, set_scale in ((ax.xaxis, x, ax.set_xscale), (ax.yaxis, y, ax.set_yscale)):
        along.set_label_text(of.title)
        if of.names:
            along.set_ticks(range(len(of.names)), of.names)
        elif of.log:
            set_scale("log")
            number_ticks(along)
        else:
            integer_ticks(along, of.values)


def integer_ticks(along, values):
    """Ticks at the values of a field of whole numbers."""
    values = np.unique(values[np.isfinite(values)])
    if (
        1 < len(values) <= MOST_TICKS
        and (values == values.round()).all()
        and not spread_logarithmically(values)
    ):
        along.set_ticks(values, [f"{value:.0f}" for value in values])


def look_of(algorithm, **more):
    own = look(algorithm)
    return {"color": own.colour, "ls": own.line, "marker": own.marker, "lw": 1.0, "ms": 4.5, **more}


# ---- limit


class Limits:
    """limit.csv and limit_runs.csv: the limit of a field, over other ones where `limit --over` varied them."""

    def __init__(self, files, folder):
        self.rows, self.runs = (files.records(f"{folder}{name}") for name in (LIMIT, LIMIT_RUNS))
        self.field, given = self.rows[0]["field"], list(self.rows[0])
        self.over = [
            name for name in given[: given.index("algorithm")] if name not in ("scenario", "device")
        ]
        if len(self.over) > 1:  # a curve for each value of the others
            several = len({row["algorithm"] for row in self.rows}) > 1
            for row in (*self.rows, *self.runs):
                row["algorithm"] = ", ".join(
                    [
                        *(row[name] for name in self.over[:-1]),
                        *([row["algorithm"]] if several else []),
                    ]
                )
        self.algorithms = list(dict.fromkeys(row["algorithm"] for row in self.rows))

    def known(self, rows):
        """Label, values and look of each known limit that has a number in some row."""
        found, has_edge = [], np.isfinite(numbers(rows, "theoretical_limit"))
        for (name, label), own in zip(KNOWN.items(), KNOWN_LOOKS):
            values = numbers(rows, name) if name in rows[0] else np.array([])
            if name in OF_LINEAR_EDGE and values.size:
                values = np.where(has_edge, values, np.nan)
            if np.isfinite(values).any():
                found.append((label, values, own))
        return found

    def lines(self, rows):
        found = [
            ("theoretical limit", numbers(rows, "theoretical_limit"), THEORY),
            *self.known(rows),
            ("simulated limit", numbers(rows, "limit"), FOUND),
        ]
        return [
            (label, np.where(values > 0, values, np.nan), own)
            for label, values, own in found
            if np.isfinite(values).any()
        ]

    def groups(self):
        """The algorithms whose limits are the same, together; the largest group last."""
        groups = {}
        for algorithm in self.algorithms:
            groups.setdefault(
                tuple(row["limit"] for row in self.rows if row["algorithm"] == algorithm), []
            ).append(algorithm)
        return sorted(groups.values(), key=len)

    def draw_classes(self, ax, algorithm):
        """The class of every run of the search over the field and the one below it, and the limits as lines."""
        runs, rows = (
            [row for row in of if row["algorithm"] == algorithm] for of in (self.runs, self.rows)
        )
        x, y, edge = numbers(rows, self.over[-1]), numbers(runs, self.field), numbers(rows, "limit")
        marks = [
            (
                name,
                *(
                    numbers([row for row in runs if row["class"] == name], of)
                    for of in (self.over[-1], self.field)
                ),
            )
            for name in by_class(row["class"] for row in runs)
        ]
        lines = [(label, x, values, own) for label, values, own in self.lines(rows)]
        over_axes(
            ax, Axis.of(axis(self.over[-1]), x), Axis(axis(self.field), y, log=True), lines, marks
        )
        edge = edge[np.isfinite(edge)]
        if edge.size:
            ax.set_ylim(edge.min() / 20, edge.max() * 20)


def draw_limits(files, folder=""):
    """The picture of what `limit` wrote."""
    given = files.records(f"{folder}{LIMIT}")[0]
    if "device" in given:
        return draw_devices(files, folder)
    found = Limits(files, folder)
    return draw_over(found) if found.over else draw_strip(found)


def draw_strip(found):
    """A line of marks for each algorithm: the class of every run over the field; bars: the limit,
    and that of theory."""
    names = found.algorithms
    runs = [
        (
            name,
            *zip(
                *(
                    (float(row[found.field]), names.index(row["algorithm"]))
                    for row in found.runs
                    if row["class"] == name
                )
            ),
        )
        for name in by_class(row["class"] for row in found.runs)
    ]
    bars = [
        (
            label,
            numbers(found.rows, key),
            np.arange(len(names)),
            {"color": colour, "mew": wide, "marker": "|", "ms": 18, "ls": "none"},
        )
        for key, label, colour, wide in (
            ("theoretical_limit", "theoretical limit", PETROL, 3),
            ("limit", "simulated limit", BLACK, 1.4),
        )
        if np.isfinite(numbers(found.rows, key)).any()
    ]
    figure, ax = plt.subplots(figsize=(6.0, 1.4 + 0.3 * len(names)))
    over_axes(
        ax,
        Axis.of(axis(found.field), numbers(found.runs, found.field)),
        Axis.of("", [look(name).label for name in names]),
        bars,
        runs,
    )
    ax.set_ylim(len(names) - 0.4, -0.6)
    ax.grid(axis="y", visible=False)
    legend_above(figure, *ax.get_legend_handles_labels())
    return figure


def draw_over(found):
    """The limit of every algorithm and its ratio to theory; then the classes of the runs,
    algorithms with the same limits together."""
    groups, has_theory = found.groups(), np.isfinite(numbers(found.rows, "theoretical_limit")).any()
    cells = 1 + has_theory + len(groups)
    columns = cells if cells < 4 else 2 if cells == 4 else min((3, 4), key=lambda n: -cells % n)
    entries = class_legend(found)
    figure, axes = panels(
        -(-cells // columns),
        columns,
        2.5 * -(-cells // columns) + 0.3 + 0.17 * -(-len(entries) // 4),
    )
    limit, *others = axes.flat
    ratio, x = others.pop(0) if has_theory else None, Axis.of(
        axis(found.over[-1]), numbers(found.rows, found.over[-1])
    )
    curves = {
        name: [row for row in found.rows if row["algorithm"] == name] for name in found.algorithms
    }
    of = lambda name, column: (numbers(curves[name], found.over[-1]), column, look_of(name))
    limits = [
        (look(name).label, *of(name, numbers(rows, "limit"))) for name, rows in curves.items()
    ]
    over_axes(limit, x, Axis.of(axis(found.field), numbers(found.rows, "limit")), limits)
    limit.set_title("simulated limit")
    if ratio:
        finite = lambda theory: np.where(
            np.isfinite(theory), theory, np.nan
        )  # without an edge of theory there is no ratio
        ratios = [
            (None, *of(name, numbers(rows, "limit") / finite(numbers(rows, "theoretical_limit"))))
            for name, rows in curves.items()
        ]
        over_axes(ratio, x, Axis("simulated / theoretical limit", np.array([])), ratios)
        low, high = min(ratio.dataLim.y0, 0.998), max(ratio.dataLim.y1, 1.002)
        room = 0.05 * (high - low)
        ratio.set(title="ratio to the theoretical limit", ylim=(low - room, high + room))
        ratio.ticklabel_format(axis="y", useOffset=False)
    for ax, group in zip(others, groups):
        found.draw_classes(ax, group[0])
        names = ", ".join(look(name).label.removesuffix(" (ours)") for name in group)
        if group is groups[-1] and len(group) > 3:
            names = f"{'all others' if len(groups) > 1 else 'all'} ({len(group)})"
        ax.set_title("\n".join(wrap(f"class of the runs: {names}", 34)), fontsize=7.5)
    for ax in others[len(groups) :]:
        ax.set_visible(False)
    legend_above(figure, *zip(*entries))
    return figure


def class_legend(found):
    """Handles and labels of algorithms, lines and classes."""
    entries = [(Line2D([], [], **look_of(name)), look(name).label) for name in found.algorithms]
    entries += [(Line2D([], [], **own), label) for label, _, own in found.lines(found.rows)]
    for name in by_class(row["class"] for row in found.runs):
        title, colour, hatch = look_of_class(name)
        entries.append((Patch(facecolor=colour, hatch=hatch, edgecolor=PETROL, lw=0), title))
    return entries


def draw_devices(files, folder):
    """The limit on each device, a panel for each scene."""
    rows = files.records(f"{folder}{LIMIT}")
    devices, scenes, algorithms = (
        list(dict.fromkeys(row[name] for row in rows))
        for name in ("device", "scenario", "algorithm")
    )
    figure, axes = plt.subplots(
        1,
        len(scenes),
        sharex=True,
        sharey=True,
        squeeze=False,
        figsize=(1.0 + 2.6 * len(scenes), 1.2 + 0.24 * len(devices)),
    )
    for ax, scene in zip(axes[0], scenes):
        series = []
        for i, algorithm in enumerate(algorithms):
            mine = [
                row for row in rows if (row["scenario"], row["algorithm"]) == (scene, algorithm)
            ]
            places = np.array([devices.index(row["device"]) for row in mine]) + 0.16 * (
                i - (len(algorithms) - 1) / 2
            )
            series.append(
                (
                    look(algorithm).label,
                    numbers(mine, "limit"),
                    places,
                    look_of(algorithm, ls="none"),
                )
            )
        published = {
            devices.index(row["device"]): float(row["published_N_per_m"])
            for row in rows
            if row["published_N_per_m"]
        }
        over_axes(
            ax,
            Axis("largest stable stiffness K [N/m]", np.array([]), log=True),
            Axis.of("", devices),
            series,
        )
        if published:
            places = np.array(list(published))
            ax.vlines(
                list(published.values()),
                places - 0.4,
                places + 0.4,
                color=BLACK,
                lw=1.2,
                ls=PUBLISHED_LINE["ls"],
                label="published, for a wall",
            )
        ax.set(title=scene.replace("_", " "), ylim=(len(devices) - 0.4, -0.6))
    legend_above(figure, *axes[0, 0].get_legend_handles_labels())
    return figure


# ---- converge and tune


def with_room(low, high, above=1.0):
    """Limits around a range on a logarithmic axis, with room for marks and names."""
    room = max((high / low) ** 0.12, 1.3)
    return low / room, high * room * above


def draw_converge(files):
    """The relative error of each metric over the refined field, beside the line of the formal
    order, and over the time of a run: filled marks where an order is stated, hollow ones of what
    the levels show without."""
    orders, levels, times = (
        files.records(ORDERS),
        files.records(LEVELS),
        numbers(files.records(TIMES), "seconds"),
    )
    series = []
    for verdict, own in zip(orders, cycle(SERIES)):
        rows = [row for row in levels if row["metric"] == verdict["metric"]]
        error, order = (
            numbers(rows, "error_estimate") / np.abs(numbers(rows, "result")[-1]),
            verdict["observed_order"],
        )
        label = f"{column(verdict['metric'])[0]}, {f'order {float(order):.2f}' if order else 'no order'}"
        series.append(
            (
                label,
                numbers(rows, "value"),
                np.where(np.isfinite(error) & (error > 0), error, np.nan),
                {
                    "color": own.colour,
                    "marker": own.marker,
                    "ls": own.line if order else "none",
                    "mfc": own.colour if order else "white",
                },
            )
        )
    if not any(np.isfinite(error).any() for _, _, error, _ in series):
        raise InputError(
            "nothing to draw: no level has an error above 0; column reason of converge.csv explains why"
        )
    timed = [(None, times, error, own) for _, _, error, own in series]
    ordered = [
        (h, error) for (_, h, error, _), verdict in zip(series, orders) if verdict["observed_order"]
    ]
    if ordered:
        (h, error), formal = ordered[0], float(orders[0]["formal_order"])
        at = np.nanargmax(error)
        series.append(
            (
                f"formal order {formal:g}",
                h,
                error[at] * (h / h[at]) ** formal,
                {"color": GREY, "lw": 0.8, "ls": ":", "zorder": 1},
            )
        )
    figure, ((left, right),) = panels(1, 2, 3.1, sharey=True)
    error = Axis("relative error", np.array([]), log=True)
    over_axes(
        right,
        Axis("processor time per run [s]", times, log=True),
        Axis("", np.array([]), log=True),
        timed,
    )
    over_axes(left, Axis(axis(orders[0]["field"]), series[0][1], log=True), error, series)
    legend_above(figure, *left.get_legend_handles_labels(), columns=3)
    return figure


STIFFNESS, DEPTH, VIBRATION = "stiffness_N_per_m", "inside_max_m", "force_rms_above_30Hz_N"


def draw_tune(files):
    """Stiffness against depth and against vibration, and the two against each other with the Pareto
    front of what is feasible; the choice of each law is ringed. Filled marks are feasible, hollow
    ones settled but without the margin or beyond a limit.
    """
    trials, laws = files.records(TRIALS), files.records(LAWS)
    axes_of = (axis(STIFFNESS), "largest depth inside [mm]", "force above 30 Hz [N rms]")
    figure, ((left, middle, right),) = panels(1, 3, 3.2)
    shown, drawn = np.empty((0, 3)), []
    for law in laws:
        rows = [row for row in trials if row["algorithm"] == law["algorithm"] and row[VIBRATION]]
        values = np.column_stack(
            [numbers(rows, STIFFNESS), 1e3 * numbers(rows, DEPTH), numbers(rows, VIBRATION)]
        )
        feasible = np.array([row["feasible"] == "true" for row in rows], dtype=bool)
        chosen = np.isclose(values[:, 0], float(law[STIFFNESS] or "nan"), rtol=1e-12)
        shown = np.vstack([shown, values])
        drawn.append((law["algorithm"], values, feasible, chosen))
    if not shown.size:
        raise InputError(
            "nothing to draw: no trial is settled; column why of tune.csv explains why"
        )
    for ax, x, y in ((left, 0, 1), (middle, 0, 2), (right, 1, 2)):
        series = []
        for name, values, feasible, chosen in drawn:
            for which, more in (
                (~feasible, {"mfc": "white"}),
                (feasible, {"label": look(name).label}),
                (chosen, {"marker": "o", "ms": 10, "color": BLACK, "mfc": "none", "zorder": 4}),
            ):
                series.append(
                    (
                        more.pop("label", None),
                        values[which, x],
                        values[which, y],
                        look_of(name, ls="none", ms=3.5) | more,
                    )
                )
            if ax is right:
                front = pareto(values[feasible][:, 1:])
                series.append(
                    (
                        None,
                        front[:, 0],
                        front[:, 1],
                        {"color": look(name).colour, "lw": 1.0, "ls": "-", "zorder": 1},
                    )
                )
        over_axes(
            ax,
            Axis(axes_of[x], shown[:, x], log=True),
            Axis(axes_of[y], shown[:, y], log=True),
            series,
        )
        for i, limits in ((x, ax.set_xlim), (y, ax.set_ylim)):
            positive = shown[np.isfinite(shown[:, i]) & (shown[:, i] > 0), i]
            if positive.size:
                limits(with_room(positive.min(), positive.max()))
        number_ticks(ax.xaxis)
        number_ticks(ax.yaxis)
        ax.tick_params(axis="x", labelrotation=40)
    handles, labels = left.get_legend_handles_labels()
    choice = Line2D([], [], ls="none", marker="o", ms=8, color=BLACK, mfc="none")
    not_feasible = Line2D([], [], ls="none", marker="s", color=GREY, mfc="white")
    legend_above(figure, [*handles, choice, not_feasible], [*labels, "recommended", "not feasible"])
    return figure


def pareto(points):
    """Those that no other is below in both, by the first coordinate."""
    points = points[np.all(np.isfinite(points), axis=1)]
    front, least = [], np.inf
    for point in points[np.lexsort((points[:, 1], points[:, 0]))]:
        if point[1] < least:
            front.append(point)
            least = point[1]
    return np.array(front).reshape(-1, 2)


PICTURES = {
    TRIALS: draw_tune,
    LEVELS: draw_converge,
    LIMIT_RUNS: draw_limits,
}  # by the file that tells what a folder holds
