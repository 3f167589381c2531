"""Picture of a comparison: each metric of each law, with the mean, the spread over seeds and every run."""
from collections import Counter
from pathlib import Path

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from hapbench.errors import InputError
from hapbench_command import nearest
from hapbench_looks import look, look_of_class
from hapbench_report.markup import column, rounded_up
from hapbench_style import (
    BLACK,
    LETTER,
    RED,
    SETTINGS,
    SHEET,
    legend_above,
    legend_height,
    number_ticks,
    plt,
)

from .over_axes import spread_logarithmically
from .ranking_values import RANKING, USUAL, has_repetitions, scenes_of

MEAN = {"marker": "o", "ms": 6, "ls": "none", "mew": 0.6, "zorder": 3}
SINGLE = {
    "marker": "o",
    "ms": 3,
    "ls": "none",
    "mew": 0,
    "alpha": 0.6,
}  # drawn below the mean, which would otherwise be hidden
HOLLOW = {"mfc": "none", "mew": 0.6}
# Height of the row of a law, height of a row with a second line of text, and smallest height of a row with one line
# [inch].
ROW, FAILED_ROW, MIN_ROW = 0.2, 0.3, 0.14
AROUND = 0.75  # height of a panel without its rows [inch]
MIN_AXIS = 0.9  # smallest width of the axis of a panel beside other panels [inch]
TOLERANCE = "#D9D9D9"
BOUND = {"marker": "<", "ms": 5, "mfc": "none", "mew": 1.1, "ls": "none", "zorder": 3}
BOUND_POSITION = 0.93  # position of a bound beyond the axis, as a fraction of the panel's width
FAILED = {"color": RED, "marker": "x", "ls": "none", "ms": 5, "mew": 1.4}


def is_ranking(folders):
    """Returns True if the arguments are one folder of a comparison with a ranking."""
    return len(folders) == 1 and (Path(folders[0]) / RANKING).is_file()


def metrics_of(names, scenes, words):
    """Returns the metrics `names`, or without names the metrics of the ranking. Raises InputError for a name that no
    run has. `words`: the given folders."""
    runs = [run for scene in scenes for law in scene.laws for run in law.runs.values()]
    known = list(
        dict.fromkeys(
            name if section == "metrics" else f"{section}.{name}"
            for run in runs
            for section, values in run.sections.items()
            for name, value in values.items()
            if isinstance(value, (int, float)) and not isinstance(value, bool)
        )
    )
    for name in names:
        if name not in known:
            hint = nearest(name, known) or f": {', '.join(known)}"
            raise InputError(f'--metric: got "{name}"; allowed: a metric of the runs{hint}')
    found = names or [name for name in dict.fromkeys(ranked_metrics(scenes)) if name in known]
    if not found:
        raise InputError(
            f"nothing to draw: no run has a metric; --metric names one: {', '.join(known)}"
        )
    return found


def ranked_metrics(scenes):
    return [*(name for scene in scenes for name in scene.better)] or USUAL


def draw_ranking(runs, names=(), words=(), sheet=SHEET):
    """Returns the figure of a comparison, with a panel for each combination of scene and metric."""
    scenes = scenes_of(runs, [Path(word) for word in words])
    metrics = metrics_of(list(names), scenes, words)
    with plt.rc_context(SETTINGS):
        return ranking_figure(scenes, metrics, sheet)


def ranking_figure(scenes, metrics, sheet):
    panels = [(scene, metric) for scene in scenes for metric in metrics]
    columns = len(metrics) if len(metrics) <= sheet.columns else sheet.grid(len(panels))[1]
    of_labels = LETTER * longest_label(scenes, bool(sheet.height))
    while columns > 1 and sheet.width / columns - of_labels < MIN_AXIS:
        columns -= 1
    rows = -(-len(panels) // columns)
    laws = max(len(scene.laws) for scene in scenes)
    fails = any(law.failures for scene in scenes for law in scene.laws)
    wanted = AROUND + (FAILED_ROW if fails else ROW) * laws
    panel = max(sheet.panel(wanted), min(wanted, AROUND + MIN_ROW * laws))
    entries = legend_of(scenes, metrics)
    height = rows * panel + legend_height([label for _, label in entries], sheet.width)
    figure, axes = sheet.panels(rows, columns, height)
    is_compact = bool(sheet.height) or panel < wanted
    for ax, (scene, metric) in zip(axes.flat, panels):
        draw_panel(ax, scene, metric, is_compact)
        # In a row of panels of one scene, only the first panel has the name of the scene.
        if len(scenes) > 1 and (columns != len(metrics) or metric == metrics[0]):
            ax.set_title(scene.name.replace("_", " "))
    for ax in axes.flat[len(panels) :]:
        ax.set_visible(False)
    legend_above(figure, *zip(*entries), columns=None)
    return figure


def longest_label(scenes, is_compact):
    """Returns the number of letters of the longest line in the labels of the rows, which label_rows() writes."""
    laws = [law for scene in scenes for law in scene.laws]
    names = [len(f"1  {law.label}") for law in laws]
    return max(names + [len(failures_text(law)) for law in laws if law.failures and not is_compact])


def draw_panel(ax, scene, metric, is_compact=False):
    """Draws one metric of one scene, with a row for each law and the best law at the top. `is_compact`: true if a row
    has only one line of text."""
    entries, laws = scene.entries(metric), scene.sorted_laws(metric)
    # A law without any mean, because all its runs failed, and a law with only a bound must not determine the axis.
    known = [of for of in entries.values() if of.mean is not None and not of.is_unknown]
    values = [v for of in known or entries.values() for v in of.values.values()]
    title, unit, factor = column(metric, values)
    is_dark = ax.xaxis.label.get_color() == "#e7e9ea"
    for row, law in enumerate(laws):
        appearance, of = look(law.algorithm), entries[law.label]
        if of.mean is not None and not of.is_unknown:
            draw_law(
                ax,
                row,
                of,
                factor,
                appearance.dark if is_dark else appearance.colour,
                min(values) >= 0,
            )
        if law.failures:
            ax.plot(1, row, **FAILED, transform=ax.get_yaxis_transform(), clip_on=False, zorder=5)
    ax.use_sticky_edges = False  # without this setting, the grey bars would remove the margins
    ax.margins(x=0.07)
    if known and spread_logarithmically(factor * np.array(values)):
        ax.set_xscale("log")
        number_ticks(ax.xaxis)
    bounds = {
        row: (factor * entries[law.label].bound, look(law.algorithm))
        for row, law in enumerate(laws)
        if entries[law.label].is_unknown
    }
    draw_bounds(ax, bounds, bool(known), is_dark)
    label_rows(ax, scene, metric, is_compact)
    # Beside other panels, the label of the axis may be wider than its panel. It extends to the left, below the names of
    # the laws, where nothing is drawn.
    beside = ax.get_subplotspec().get_gridspec().ncols > 1
    ax.set_xlabel(f"{title} [{unit or 1}]", loc="right" if beside else "center")
    ax.grid(axis="y", visible=False)
    ax.tick_params(axis="y", length=0)


def draw_law(ax, row, of, factor, colour, is_positive):
    """Draws the mean of a law, its error, its standard deviation and its runs in a row."""
    mean = factor * of.mean
    in_mean = [factor * value for seed, value in of.values.items() if seed not in of.others]
    others = [factor * value for value in of.others.values()]
    low, high = (mean + sign * factor * of.error for sign in (-1, 1))
    low = max(low, 0.0) if is_positive else low
    ax.barh(row, high - low, 0.7, low, color=TOLERANCE, zorder=0.5)
    if of.spread is not None:
        ax.errorbar(mean, row, xerr=factor * of.spread, color=colour, lw=1.2, capsize=3)
    ax.plot(mean, row, **MEAN, color=colour, mec=ax.get_facecolor())
    ax.plot(in_mean, np.full(len(in_mean), row + 0.3), **SINGLE, color=colour)
    ax.plot(others, np.full(len(others), row + 0.3), **SINGLE | HOLLOW, color=colour)


def draw_bounds(ax, bounds, has_numbers, is_dark):
    """Draws a hollow mark at each bound, with its value. `bounds`: (bound, look) by row. Only the numbers of laws
    without a bound determine the axis; a bound beyond the axis is drawn at the edge of the panel.
    """
    if not bounds:
        return
    if not has_numbers:
        ax.set_xlim(0.0, 1.1 * max(bound for bound, _ in bounds.values()))
    ax.set_xlim(ax.get_xlim())
    for row, (bound, appearance) in bounds.items():
        colour = appearance.dark if is_dark else appearance.colour
        at = ax.transAxes.inverted().transform(ax.transData.transform((bound, row)))[0]
        at = min(at, BOUND_POSITION) if bound > 0 else 0.0
        ax.plot(at, row, **BOUND, color=colour, transform=ax.get_yaxis_transform())
        ax.annotate(
            f"\u2264 {rounded_up(bound):.1g}",
            (at, row),
            xycoords=ax.get_yaxis_transform(),
            xytext=(-7, 0) if at > 0.3 else (4, 0),
            textcoords="offset points",
            ha="right" if at > 0.3 else "left",
            va="center",
            fontsize=7,
            color=colour,
        )


def label_rows(ax, scene, metric, is_compact):
    """Writes the rank and the name of each law at its row. The label of a law with failed runs is red and contains the
    number of failed runs. If `is_compact` is false, the label also contains their outcomes."""
    laws, ranks, labels = scene.sorted_laws(metric), scene.ranks(metric), []
    for law in laws:
        rank = ranks[law.label]
        label = f"{'' if rank is None else f'{rank}  '}{law.label}"
        if law.failures and is_compact:
            label += f" \u2717{len(law.failures)}/{len(law.runs)}"
        elif law.failures:
            label += f"\n{failures_text(law)}"
        labels.append(label.replace("$", r"\$"))
    ax.set_yticks(range(len(laws)), labels)
    for tick, law in zip(ax.get_yticklabels(), laws):
        tick.set(fontsize=7, linespacing=1.15, **({"color": RED} if law.failures else {}))
    ax.set_ylim(len(laws) - 0.4, -0.6)


def failures_text(law):
    """Returns the number of failed runs of a law and their outcome: "1 of 5 passed through"."""
    how = Counter(law.failures.values())
    names = ", ".join(look_of_class(name)[0] for name in how)
    count = f"{len(law.failures)} of {len(law.runs)} " if len(law.runs) > 1 else ""
    return f"{count}{names}"


def legend_of(scenes, metrics):
    """Returns (handle, label) of each kind of mark in the picture."""
    of = [
        entry for scene in scenes for metric in metrics for entry in scene.entries(metric).values()
    ]
    drawn = [one for one in of if one.mean is not None and not one.is_unknown]
    laws = [law for scene in scenes for law in scene.laws]
    differ = any(scene.lacks_common_seeds for scene in scenes)
    mean = "mean over the law's runs that did not fail" if differ else "mean"
    of_mean = (Line2D([], [], color=BLACK, **MEAN), mean)
    entries = [of_mean] if drawn else []
    if any(one.is_unknown for one in of):
        entries.append((Line2D([], [], color=BLACK, **BOUND), "bound: not larger than its error"))
    if any(one.spread is not None for one in drawn):
        entries.append(
            (Line2D([], [], color=BLACK, lw=1.2, marker="|", ms=6), "standard deviation over seeds")
        )
    if drawn and has_repetitions(scenes):
        entries.append((Line2D([], [], color=BLACK, **SINGLE), "single run"))
    if any(one.others for one in drawn):
        marker = Line2D([], [], color=BLACK, **SINGLE | HOLLOW)
        entries.append((marker, "run not in the mean: another law failed"))
    if any(one.tolerance for one in drawn):
        entries.append((Patch(color=TOLERANCE), "tolerance of the mean"))
    if any(law.failures for law in laws):
        entries.append((Line2D([], [], **FAILED), "failed runs"))
    return entries or [of_mean]  # no entry: there is no mark, and a legend needs an entry
