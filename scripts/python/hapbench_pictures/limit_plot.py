"""Pictures of the limits that `limit` finds: one limit for each algorithm, limits over the fields of --over, and limits
of several devices."""
from textwrap import wrap

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from hapbench.columns import is_number, number_in, numbers
from hapbench.errors import InputError
from hapbench_looks import by_class, distinguish, law_name, look_of_class
from hapbench_style import BLACK, PAGE, PETROL, PLUM, SHEET, legend_above, legend_height

from .device_plot import (
    ALTERNATING_LABEL,
    UNQUOTED,
    UNQUOTED_LABEL,
    alternate,
    draw_devices,
    draw_devices_over,
    linear,
    without_quote,
)
from .given import axis
from .over_axes import Axis, look_of, over_axes, spread_logarithmically

LIMIT, LIMIT_RUNS = "limit.csv", "limit_runs.csv"
# Columns of limit.csv and their labels: the linear limit for the worst hand, and limits by closed formulas. If a row
# has no theoretical limit, for example because of dry friction, the limits of OF_THEORY are not drawn.
KNOWN = {
    "worst_hand_limit": "linear limit, worst hand",
    "passive_colgate_schenkel": "passive (Colgate, Schenkel)",
    "passive_with_delay": "passive, with delay",
    "stable_gil_hulin": "stable (Gil, Hulin)",
    "passive_abbott_okamura": "passive (Abbott, Okamura)",
    "exact_undamped_handle": "exact, undamped handle",
}
OF_THEORY = ("stable_gil_hulin", "exact_undamped_handle")
KNOWN_LOOKS = tuple(
    {"color": colour, "lw": 1.4, "ls": line}
    for line in ("-", (0, (5, 2)), (0, (1, 1)))
    for colour in (PLUM, "#1F4E9E", "#2E6B34")
)
THEORY, FOUND = {"color": PETROL, "lw": 2.6}, {"color": BLACK, "lw": 1.1, "ls": (0, (2, 2))}
HOLLOW = {"ls": "none", "mfc": "white"}
# Range of the panels of classes: factor between the limits and the ends of the panel, and factor between a run beyond
# this range that must be visible and the end of the panel.
AROUND_LIMITS, EDGE = 20, 1.5
QUOTED = {"color": BLACK, "ls": "none", "marker": "o", "ms": 4}


class Limits:
    """The tables limit.csv and limit_runs.csv: the limit of a field over the fields of `limit --over`."""

    def __init__(self, files, folder):
        self.rows, self.runs = (files.records(f"{folder}{name}") for name in (LIMIT, LIMIT_RUNS))
        self.field, given = self.rows[0]["field"], list(self.rows[0])
        for row in self.rows:
            if row["field"] not in self.runs[0]:
                raise InputError(
                    f"{self.runs[0].file}: line 1: no column {row['field']}, which line {row.line} of {LIMIT} names; "
                    "one of the files is not a table that hapbench wrote"
                )
        self.over = [
            name for name in given[: given.index("algorithm")] if name not in ("scenario", "device")
        ]
        if len(self.over) > 1:  # one curve for each value of the other fields
            several = len({row["algorithm"] for row in self.rows}) > 1
            for row in (*self.rows, *self.runs):
                row["algorithm"] = ", ".join(
                    [
                        *(row[name] for name in self.over[:-1]),
                        *([row["algorithm"]] if several else []),
                    ]
                )
        self.algorithms = list(dict.fromkeys(row["algorithm"] for row in self.rows))
        distinguish(self.algorithms)

    def along(self, rows):
        """Returns the values of the last field of --over in these rows. If the values are texts, returns instead
        the number of each text: texts are numbered from 0 in the order of their first row in the table.
        """
        field = self.over[-1]
        names = list(dict.fromkeys(row[field] for row in self.rows))
        if all(map(is_number, names)):
            return numbers(rows, field)
        return np.array([names.index(row[field]) for row in rows], float)

    def axis(self):
        """Returns the Axis on which the picture shows the last field of --over."""
        texts = [row[self.over[-1]] for row in self.rows]
        return Axis.of(
            axis(self.over[-1]), self.along(self.rows) if all(map(is_number, texts)) else texts
        )

    def known(self, rows):
        """Returns (label, values, plot style) of each limit of KNOWN that has a finite value in some row. Values of the
        limits OF_THEORY are used only in rows with a finite theoretical_limit, and are NaN in all other rows.
        """
        found, has_theory = [], np.isfinite(numbers(rows, "theoretical_limit"))
        for (name, label), style in zip(KNOWN.items(), KNOWN_LOOKS):
            values = numbers(rows, name) if name in rows[0] else np.array([])
            if name in OF_THEORY and values.size:
                values = np.where(has_theory, values, np.nan)
            if np.isfinite(values).any():
                found.append((label, values, style))
        return found

    def lines(self, rows):
        found = [
            ("linear limit", linear(rows), THEORY),
            *self.known(rows),
            ("simulated limit", separated(rows), FOUND),
        ]
        return [
            (label, np.where(values > 0, values, np.nan), style)
            for label, values, style in found
            if np.isfinite(values).any()
        ]

    def theories(self):
        """Returns the curves of the linear limit: (values of the last field of --over, limits). If several algorithms
        have the same limits, their curve is returned once."""
        found = {}
        for name in self.algorithms:
            rows = [row for row in self.rows if row["algorithm"] == name]
            limits = linear(rows)
            found.setdefault(limits.tobytes(), (self.along(rows), limits))
        return [(x, limits) for x, limits in found.values() if np.isfinite(limits).any()]

    def groups(self):
        """Returns lists of algorithms with identical simulated limits; the longest list is last."""
        groups = {}
        for algorithm in self.algorithms:
            groups.setdefault(
                tuple(row["limit"] for row in self.rows if row["algorithm"] == algorithm), []
            ).append(algorithm)
        return sorted(groups.values(), key=len)

    def draw_classes(self, ax, algorithm):
        """Draws a mark for each run of an algorithm, with the colour of the run's class. The x axis is the last field
        of --over, the y axis the searched field. Also draws the limits as lines, and the limits to quote as marks.
        """
        runs, rows = (
            [row for row in of if row["algorithm"] == algorithm] for of in (self.runs, self.rows)
        )
        x, y, quoted = self.along(rows), numbers(runs, self.field), numbers(rows, "quoted_limit")
        marks = [
            (
                name,
                self.along([row for row in runs if row["class"] == name]),
                numbers([row for row in runs if row["class"] == name], self.field),
            )
            for name in by_class(row["class"] for row in runs)
        ]
        lines = [(label, x, values, style) for label, values, style in self.lines(rows)]
        over_axes(ax, self.axis(), Axis(axis(self.field), y, log=True), lines, marks)
        ax.plot(x, quoted, **QUOTED)
        limits = numbers(rows, "limit")
        limits = limits[np.isfinite(limits)]
        if limits.size:
            low, high = limits.min() / AROUND_LIMITS, limits.max() * AROUND_LIMITS
            further = changes_beyond(low, high, self.along(runs), y, [row["class"] for row in runs])
            further += list(quoted[np.isfinite(quoted)])
            ax.set_ylim(
                min([low, *(value / EDGE for value in further)]),
                max([high, *(value * EDGE for value in further)]),
            )


def changes_beyond(low, high, x, y, classes):
    """Returns the values of the searched field at which, for a value of --over, the class of the runs changes below
    `low` or above `high`: the value of the nearest run there whose class differs from the class of the outermost run
    between `low` and `high`. `x`, `y`, `classes`: value of --over, value of the searched field, and class of each run.
    """
    found = []
    for at in np.unique(x):
        runs = sorted((value, name) for value, name, of in zip(y, classes, x) if of == at)
        inside = [name for value, name in runs if low <= value <= high]
        if inside:
            found += [value for value, name in runs if value < low and name != inside[0]][-1:]
            found += [value for value, name in runs if value > high and name != inside[-1]][:1]
    return found


def separated(rows):
    """Returns the simulated limits of the rows; NaN where stable and unstable runs alternate."""
    return np.where(alternate(rows), np.nan, numbers(rows, "limit"))


def quoted_kinds(rows):
    """Returns two arrays with the limits to quote: those that are reliable, and simulated limits near which stable and
    unstable runs alternate. The limit of a row is in one of the arrays; the other has NaN for this row.
    """
    quoted = numbers(rows, "quoted_limit")
    unreliable = alternate(rows) & (quoted == numbers(rows, "limit"))
    return [np.where(of, quoted, np.nan) for of in (~unreliable, unreliable)]


def draw_limits(files, sheet=SHEET, folder=""):
    """Returns the picture of the results of `limit`."""
    found = Limits(files, folder)
    if "device" in found.rows[0]:
        return draw_devices_over(found, sheet) if found.over else draw_devices(found, sheet)
    return draw_over(found, sheet) if found.over else draw_strip(found, sheet)


def draw_strip(found, sheet):
    """Draws one line of marks for each algorithm: the class of every run over the searched field. Bars mark the
    linear limit, the simulated limit, and the limit that the program recommends to quote (column quoted_limit).
    """
    names = found.algorithms
    runs = [
        (
            name,
            *zip(
                *(
                    (number_in(row, found.field), names.index(row["algorithm"]))
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
            values,
            np.arange(len(names)),
            {"color": colour, "mew": wide, "marker": "|", "ms": 18, "ls": "none"},
        )
        for values, label, colour, wide in (
            (linear(found.rows), "linear limit", PETROL, 3),
            (numbers(found.rows, "limit"), "simulated limit", BLACK, 1.4),
            (numbers(found.rows, "quoted_limit"), "limit to quote", PLUM, 2.4),
        )
        if np.isfinite(values).any()
    ]
    figure, ((ax,),) = sheet.panels(1, 1, 1.6 + 0.3 * len(names))
    over_axes(
        ax,
        Axis.of(axis(found.field), numbers(found.runs, found.field)),
        Axis.of("", list(map(law_name, names))),
        bars,
        runs,
    )
    ax.set_ylim(len(names) - 0.4, -0.6)
    ax.grid(axis="y", visible=False)
    legend_above(figure, *ax.get_legend_handles_labels(), columns=None)
    return figure


def draw_over(found, sheet=PAGE):
    """Draws the limit to quote of every algorithm, the simulated limit divided by the linear limit, and the classes of
    the runs. Algorithms with the same limits share a panel of classes."""
    groups, has_linear = found.groups(), np.isfinite(linear(found.rows)).any()
    rows, columns = sheet.grid(1 + has_linear + len(groups))
    labels = [label for _, label in class_legend(found)]
    height = sheet.panel(2.5) * rows + 0.3 + legend_height(labels, sheet.width)
    figure, axes = sheet.panels(rows, columns, height)
    limit, *others = axes.flat
    draw_quoted(limit, found)
    if has_linear:
        draw_ratio(others.pop(0), found)
    for ax, group in zip(others, groups):
        found.draw_classes(ax, group[0])
        names = ", ".join(law_name(name) for name in group)
        if group is groups[-1] and len(group) > 3:
            names = f"{'all others' if len(groups) > 1 else 'all'} ({len(group)})"
        ax.set_title("\n".join(wrap(f"class of the runs: {names}", 34)), fontsize=7.5)
    for ax in others[len(groups) :]:
        ax.set_visible(False)
    classes = {look_of_class(row["class"])[0] for row in found.runs}
    hidden = classes - shown_classes(others[: len(groups)])
    entries = [entry for entry in class_legend(found) if entry[1] not in hidden]
    legend_above(figure, *zip(*entries), columns=None)
    return figure


def shown_classes(panels):
    """Returns the titles of the classes of runs that have a mark within the limits of one of these panels."""
    return {
        marks.get_label()
        for ax in panels
        for marks in ax.collections
        if any(ax.get_ylim()[0] <= y <= ax.get_ylim()[1] for _, y in marks.get_offsets())
    }


def curves(found):
    """Returns the rows of each algorithm by its name."""
    return {
        name: [row for row in found.rows if row["algorithm"] == name] for name in found.algorithms
    }


def draw_quoted(ax, found):
    """Draws the limits to quote as curves with marks, the simulated limits as thin dashed curves, and the linear
    limits."""
    series = []
    for name, rows in curves(found).items():
        x, (reliable, unreliable) = found.along(rows), quoted_kinds(rows)
        series.append((law_name(name), x, reliable, look_of(name)))
        if np.isfinite(unreliable).any():
            series.append((None, x, unreliable, {**look_of(name), **HOLLOW}))
        thin = {**look_of(name), "marker": "none", "lw": FOUND["lw"], "ls": FOUND["ls"]}
        series.append((None, x, separated(rows), thin))
    y = np.concatenate([values for _, _, values, _ in series])
    over_axes(ax, found.axis(), Axis.of(axis(found.field), y), series)
    ax.set_title("limit to quote (marks)")
    for theory in found.theories():
        ax.plot(*theory, **THEORY, zorder=1)
    for name, rows in curves(found).items():
        none = without_quote(rows)
        if none.any():
            ax.plot(
                found.along(rows)[none],
                np.full(none.sum(), 0.03),
                color=look_of(name)["color"],
                transform=ax.get_xaxis_transform(),
                **UNQUOTED,
            )


def draw_ratio(ax, found):
    """Draws the simulated limits divided by the linear limits."""
    ratios = [
        (None, found.along(rows), separated(rows) / linear(rows), look_of(name))
        for name, rows in curves(found).items()
    ]
    y = np.concatenate([values for _, _, values, _ in ratios])
    over_axes(ax, found.axis(), Axis.of("simulated /\nlinear limit", y), ratios)
    ax.set_title("simulated / linear limit")
    if not spread_logarithmically(y):
        low, high = min(ax.dataLim.y0, 0.998), max(ax.dataLim.y1, 1.002)
        room = 0.05 * (high - low)
        ax.set_ylim(low - room, high + room)
        ax.ticklabel_format(axis="y", useOffset=False)


def class_legend(found):
    """Returns (handle, label) of each algorithm, line and class in the picture."""
    entries = [(Line2D([], [], **look_of(name)), law_name(name)) for name in found.algorithms]
    entries += [(Line2D([], [], **style), label) for label, _, style in found.lines(found.rows)]
    if np.isfinite(quoted_kinds(found.rows)[1]).any():
        hollow = Line2D([], [], color=BLACK, marker="o", ms=4.5, **HOLLOW)
        entries.append((hollow, ALTERNATING_LABEL))
    if without_quote(found.rows).any():
        entries.append((Line2D([], [], color=BLACK, **UNQUOTED), UNQUOTED_LABEL))
    if np.isfinite(numbers(found.rows, "quoted_limit")).any():
        entries.append((Line2D([], [], **QUOTED), "limit to quote"))
    for name in by_class(row["class"] for row in found.runs):
        title, colour, hatch = look_of_class(name)
        entries.append((Patch(facecolor=colour, hatch=hatch, edgecolor=PETROL, lw=0), title))
    return entries
