"""The file of `hapbench plot`: quantities over time under each other, the tip's way beside them."""
import math

import matplotlib

from hapbench_figures.style import SETTINGS

from .looks import looks
from .panels import PATH_COLUMNS, draw_over_time, draw_path, projections
from .quantities import Samples

matplotlib.use("agg")
from matplotlib import pyplot as plt  # noqa: E402  (the backend comes first)

PANEL_HEIGHT, WIDTH, PATH_WIDTH = 1.35, 7.0, 2.6  # [inch]
LEGEND_COLUMNS = 4


def samples_of(runs, quantities, with_path):
    return [Samples(run, quantities, PATH_COLUMNS if with_path else ()) for run in runs]


def draw(runs, labels, quantities, with_path, samples):
    """The figure: a title with the runs' names, below it quantities on the left and ways on the right."""
    with matplotlib.rc_context(SETTINGS):
        ways, shown = projections(samples) if with_path else (), looks(runs, labels)
        widths = [WIDTH, PATH_WIDTH] if quantities and ways else [WIDTH]
        body = PANEL_HEIGHT * max(len(quantities), len(ways) if quantities else 2 * len(ways))
        head = 0.3 + (0.19 * math.ceil(len(runs) / LEGEND_COLUMNS) if len(runs) > 1 else 0)
        figure = plt.figure(figsize=(sum(widths), head + body + 0.3))
        top, bottom = figure.subfigures(2, 1, height_ratios=[head, body + 0.3])
        parts = bottom.subfigures(1, len(widths), width_ratios=widths, squeeze=False)[0]
        write_title(top, runs, shown)
        if quantities:
            axes = parts[0].subplots(len(quantities), 1, sharex=True, squeeze=False)[:, 0]
            for ax, quantity in zip(axes, quantities):
                draw_over_time(ax, quantity, samples, shown)
            axes[-1].set_xlabel("time [s]   (triangles and dotted lines: first touch)")
        if ways:
            axes = parts[-1].subplots(len(ways), 1, squeeze=False)[:, 0]
            for ax, plane in zip(axes, ways):
                draw_path(ax, plane, samples, shown)
        return figure


def write_title(top, runs, shown):
    names = {run.name for run in runs}
    name = shown[0].label if len(runs) == 1 else names.pop() if len(names) == 1 else f"{len(runs)} runs"
    top.text(0.01, 0.98, name, ha="left", va="top", fontsize=9, weight="bold")
    if len(runs) > 1:
        handles = [plt.Line2D([], [], color=one.colour, ls=one.line) for one in shown]
        top.legend(handles, [one.label for one in shown], loc="lower left", ncol=LEGEND_COLUMNS)
