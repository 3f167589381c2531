"""The pictures of `limit`, `tune` and `converge`: classes of runs as coloured marks, with the limits found; and which study a folder
holds."""
from pathlib import Path

import numpy as np

from hapbench_figures.results import MissingResult, Results, numbers
from hapbench_figures.stability import CLASSES, LIMIT, LIMIT_RUNS, OverFields, draw_devices, draw_over, is_geometric, look_of_class
from hapbench_looks import look
from hapbench_report.json_input import InputError
from hapbench_style import BLACK, PETROL, SETTINGS, plt

from .converge_plot import LEVELS, draw_converge
from .given import axis
from .tune_plot import TRIALS, draw_tune


def given_study(words):
    """The folder of limits, a tuning or a convergence among the words; None where none was given."""
    studies = [Path(word) for word in words if is_study(Path(word))]
    if studies and len(words) > 1:
        raise InputError(f"{studies[0]}: holds limits; allowed: one such folder alone, or any number of runs")
    return studies[0] if studies else None


def is_study(path):
    return any((path / name).is_file() for name in (LIMIT_RUNS, LEVELS, TRIALS))


def study_figures(path):
    """Pairs of a name, to tell the files apart, and a figure."""
    try:
        with plt.rc_context(SETTINGS):
            if (path / TRIALS).is_file():
                return [("", draw_tune(Results(path)))]
            if (path / LEVELS).is_file():
                return [("", draw_converge(Results(path)))]
            results = Results(path)
            given = list(results.records(LIMIT)[0])
            draw = draw_devices if "device" in given else draw_over_fields if given[0] not in ("algorithm", "scenario") else draw_limit
            return [("", draw(results))]
    except MissingResult as error:
        raise InputError(str(error)) from error
    except (KeyError, ValueError, IndexError) as error:
        raise InputError(f"{path}: is not a table that hapbench wrote: {error}") from error


def draw_over_fields(results):
    return draw_over(OverFields(results))


def draw_limit(results):
    """A line of marks for each algorithm: the class of every run over the field; bars: the limit, and that of theory."""
    runs, limits = results.records(LIMIT_RUNS), results.records(LIMIT)
    algorithms, field = [row["algorithm"] for row in limits], limits[0]["field"]
    figure, ax = plt.subplots(figsize=(6.0, 1.3 + 0.3 * len(algorithms)))
    for name in sorted({row["class"] for row in runs}, key=lambda name: ([*CLASSES, name].index(name), name)):
        mine = [row for row in runs if row["class"] == name]
        title, colour, hatch = look_of_class(name)
        ax.scatter(numbers(mine, field), [algorithms.index(row["algorithm"]) for row in mine], s=45, marker="s", color=colour,
                   edgecolor=PETROL, lw=0.4, hatch=hatch, label=title)
    for kind, title, style in (("theory", "limit, theory", {"color": PETROL, "lw": 2.6}), ("limit", "limit, bisection", {"color": BLACK, "lw": 1.2})):
        at = numbers(limits, kind)
        lines = np.flatnonzero(np.isfinite(at))
        if lines.size:
            ax.vlines(at[lines], lines - 0.4, lines + 0.4, label=title, zorder=3, **style)
    values = np.unique(numbers(runs, field))
    ax.set(xlabel=axis(field), xscale="log" if is_geometric(values) else "linear", yticks=range(len(algorithms)),
           yticklabels=[look(name).label for name in algorithms], ylim=(len(algorithms) - 0.4, -0.6))
    ax.grid(axis="y", visible=False)
    ax.legend(loc="lower left", bbox_to_anchor=(0, 1), ncol=4)
    return figure
