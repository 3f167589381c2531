"""A comparison as a picture: each metric by law, with its mean, the spread over seeds and every run."""
from collections import Counter
from pathlib import Path

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from hapbench.errors import InputError
from hapbench_command import nearest
from hapbench_looks import look, look_of_class
from hapbench_report.markup import column
from hapbench_style import (
    BLACK,
    RED,
    SETTINGS,
    SHEET,
    legend_above,
    legend_height,
    number_ticks,
    plt,
)

from .over_axes import spread_logarithmically
from .standings import RANKING, USUAL, has_repetitions, scenes_of

MEAN = {"marker": "o", "ms": 6, "ls": "none", "mew": 0.6, "zorder": 3}
SINGLE = {
    "marker": "o",
    "ms": 3,
    "ls": "none",
    "mew": 0,
    "alpha": 0.6,
}  # below the mean, which would hide them
ROW, FAILED_ROW = 0.2, 0.27  # height of a law, and where one has a second line [inch]
TOLERANCE = "#D9D9D9"
FAILED = {"color": RED, "marker": "x", "ls": "none", "ms": 5, "mew": 1.4}


def is_ranking(folders):
    """True if the words are one folder of a comparison with a ranking."""
    return len(folders) == 1 and (Path(folders[0]) / RANKING).is_file()


def metrics_of(names, scenes, words):
    """The metrics of these names, or else those of the ranking. Raises InputError for a name that no run has."""
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
    """A panel for each scene and metric."""
    scenes = scenes_of(runs, [Path(word) for word in words])
    metrics = metrics_of(list(names), scenes, words)
    with plt.rc_context(SETTINGS):
        return ranking_figure(scenes, metrics, sheet)


def ranking_figure(scenes, metrics, sheet):
    panels = [(scene, metric) for scene in scenes for metric in metrics]
    columns = len(metrics) if len(metrics) <= sheet.columns else sheet.grid(len(panels))[1]
    rows = -(-len(panels) // columns)
    laws = max(len(scene.laws) for scene in scenes)
    row = FAILED_ROW if any(law.failures for scene in scenes for law in scene.laws) else ROW
    entries = legend_of(scenes, metrics)
    height = rows * (0.75 + row * laws) + legend_height(
        [label for _, label in entries], sheet.width
    )
    figure, axes = sheet.panels(rows, columns, height)
    for ax, (scene, metric) in zip(axes.flat, panels):
        draw_panel(ax, scene, metric, is_compact=bool(sheet.height))
        # In a row of one scene, the first panel names it for all.
        if len(scenes) > 1 and (columns != len(metrics) or metric == metrics[0]):
            ax.set_title(scene.name.replace("_", " "))
    for ax in axes.flat[len(panels) :]:
        ax.set_visible(False)
    legend_above(figure, *zip(*entries), columns=None)
    return figure


def draw_panel(ax, scene, metric, is_compact=False):
    """One metric of one scene: a row for each law, the best on top. `is_compact`: each row has one line of text."""
    standings, laws = scene.standings(metric), scene.sorted_laws(metric)
    values = [v for of in standings.values() for v in of.values.values()]
    title, unit, factor = column(metric, values)
    lowest = min(values, default=0.0)
    ink = ax.xaxis.label.get_color()
    for row, law in enumerate(laws):
        of, own = standings[law.label], look(law.algorithm)
        colour = own.colour if ink != "#e7e9ea" else own.dark
        each = factor * np.array(list(of.values.values()))
        if of.mean is not None:
            mean = factor * of.mean
            low, high = (mean + sign * factor * of.error for sign in (-1, 1))
            low = max(low, 0.0) if lowest >= 0 else low
            ax.barh(row, high - low, 0.7, low, color=TOLERANCE, zorder=0.5)
            if of.spread is not None:
                ax.errorbar(mean, row, xerr=factor * of.spread, color=colour, lw=1.2, capsize=3)
            ax.plot(mean, row, **MEAN, color=colour, mec=ax.get_facecolor())
            ax.plot(each, np.full(len(each), row + 0.3), **SINGLE, color=colour)
        if law.failures:
            ax.plot(1, row, **FAILED, transform=ax.get_yaxis_transform(), clip_on=False, zorder=5)
    ax.use_sticky_edges = False  # of the grey bars, which would leave no margin
    ax.margins(x=0.07)
    if values and spread_logarithmically(factor * np.array(values)):
        ax.set_xscale("log")
        number_ticks(ax.xaxis)
    label_rows(ax, scene, metric, is_compact)
    ax.set_xlabel(f"{title} [{unit or 1}]")
    ax.grid(axis="y", visible=False)
    ax.tick_params(axis="y", length=0)


def label_rows(ax, scene, metric, is_compact):
    """The rank and the name of each law; and in red how many of its runs failed, and how."""
    laws, ranks, labels = scene.sorted_laws(metric), scene.ranks(metric), []
    for law in laws:
        rank = ranks[law.label]
        label = f"{'' if rank is None else f'{rank}  '}{short(law)}"
        if law.failures and is_compact:
            label += f" \u2717{len(law.failures)}/{len(law.runs)}"
        elif law.failures:
            label += f"\n{failures_text(law)}"
        labels.append(label.replace("$", r"\$"))
    ax.set_yticks(range(len(laws)), labels)
    for tick, law in zip(ax.get_yticklabels(), laws):
        tick.set(fontsize=7, linespacing=0.95, **({"color": RED} if law.failures else {}))
    ax.set_ylim(len(laws) - 0.4, -0.6)


def failures_text(law):
    """How many of its runs failed, and how: "1 of 5 passed through"."""
    how = Counter(law.failures.values())
    names = ", ".join(look_of_class(name)[0] for name in how)
    count = f"{len(law.failures)} of {len(law.runs)} " if len(law.runs) > 1 else ""
    return f"{count}{names}"


def short(law):
    """The name of a law as in legends, with the fields that are its own."""
    own = look(law.algorithm).label.partition(" (")[0]
    return ", ".join([own, *law.label.split(", ")[1:]])


def legend_of(scenes, metrics):
    """Handles and labels of the marks that are drawn."""
    of = [
        standing
        for scene in scenes
        for metric in metrics
        for standing in scene.standings(metric).values()
    ]
    laws = [law for scene in scenes for law in scene.laws]
    entries = [(Line2D([], [], color=BLACK, **MEAN), "mean")]
    if any(one.spread is not None for one in of):
        entries.append(
            (Line2D([], [], color=BLACK, lw=1.2, marker="|", ms=6), "standard deviation over seeds")
        )
    if has_repetitions(scenes):
        entries.append((Line2D([], [], color=BLACK, **SINGLE), "single run"))
    if any(one.tolerance for one in of if one.mean is not None):
        entries.append((Patch(color=TOLERANCE), "error of the mean"))
    if any(law.failures for law in laws):
        entries.append((Line2D([], [], **FAILED), "failed runs"))
    return entries
