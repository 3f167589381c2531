"""The file of `hapbench plot`: quantities over time under each other, the tip's way beside them."""
import math
from collections import Counter

import matplotlib

from hapbench_figures.style import SETTINGS
from hapbench_report.json_input import at
from hapbench_report.replay_tool import tool_profile

from .panels import AXIS_COLUMNS, PATH_COLUMNS, draw_over_time, draw_path, draw_tool, projections
from .quantities import Samples

matplotlib.use("agg")
from matplotlib import pyplot as plt  # noqa: E402  (the backend comes first)

PANEL_HEIGHT, WIDTH, PATH_WIDTH = 1.35, 7.0, 2.6  # [inch]
LEGEND_COLUMNS = 4
LETTER = 0.068  # width of a letter of the legend [inch]
LONGEST_NAME = 90  # letters
SURFACE_SAID = ("dots: section of the surface through", "the middle of the way")
TOOL_SAID = "outlines: tool on its way"


def samples_of(runs, quantities, with_path, window):
    return [Samples(run, quantities, (*PATH_COLUMNS, *AXIS_COLUMNS) if with_path else (), window) for run in runs]


def draw(runs, shown, quantities, with_path, samples, surface=None):
    """The figure: a title with the runs' names, below it quantities on the left and ways on the right."""
    with matplotlib.rc_context(SETTINGS):
        ways, entries = projections(samples) if with_path else (), legend_of(shown)
        widths = [WIDTH, PATH_WIDTH] if quantities and ways else [WIDTH]
        body = PANEL_HEIGHT * max(len(quantities), len(ways) if quantities else 2 * len(ways))
        columns = legend_columns(entries, sum(widths))
        head = 0.3 + (0.19 * math.ceil(len(entries) / columns) if len(runs) > 1 else 0)
        figure = plt.figure(figsize=(sum(widths), head + body + 0.3))
        top, bottom = figure.subfigures(2, 1, height_ratios=[head, body + 0.3])
        parts = bottom.subfigures(1, len(widths), width_ratios=widths, squeeze=False)[0]
        write_title(top, head, runs, entries, columns)
        if quantities:
            axes = parts[0].subplots(len(quantities), 1, sharex=True, squeeze=False)[:, 0]
            for ax, quantity in zip(axes, quantities):
                draw_over_time(ax, quantity, samples, shown)
            axes[-1].set_xlabel("time [s]   (triangles and dotted lines: first touch)")
        if ways:
            axes, profile, outlined = parts[-1].subplots(len(ways), 1, squeeze=False)[:, 0], profile_of(runs[0]), False
            for ax, plane in zip(axes, ways):
                draw_path(ax, plane, samples, shown, surface)
                outlined |= profile is not None and draw_tool(ax, plane, samples[0], profile, shown[0].colour)
            said = [*(SURFACE_SAID if surface is not None else ()), *([TOOL_SAID + ", first run" * (len(runs) > 1)] if outlined else ())]
            axes[-1].set_xlabel("\n".join([axes[-1].get_xlabel(), *said]))
        return figure


def profile_of(run):
    """Of the tool; None for springs, which have none."""
    return None if at(run.scenario, "/environment/type") == "springs" else tool_profile(run.scenario, run.summary)


def legend_of(shown):
    """Label -> look: the first run of each group stands for all of it."""
    counts = Counter(one.group or one.label for one in shown)
    entries = {}
    for one in shown:
        name = one.group or one.label
        entries.setdefault(name if counts[name] == 1 else f"{name} ({counts[name]} seeds)", one)
    return {shortened(name): one for name, one in entries.items()} if len(set(map(shortened, entries))) == len(entries) else entries


def shortened(name):
    return name if len(name) <= LONGEST_NAME else f"{name[:LONGEST_NAME // 2 - 1]}…{name[-LONGEST_NAME // 2:]}"


def legend_columns(entries, width):
    """As many as fit beside each other in so many inches."""
    return max(1, min(LEGEND_COLUMNS, int((width - 0.2) / (0.55 + LETTER * max(map(len, entries))))))


def write_title(top, head, runs, entries, columns):
    scenes = ", ".join(dict.fromkeys(run.name for run in runs))
    name = next(iter(entries)) if len(runs) == 1 else scenes if len(scenes) <= LONGEST_NAME else f"{len(runs)} runs"
    top.text(0.01, 1 - 0.06 / head, name, ha="left", va="top", fontsize=9, weight="bold")
    if len(runs) > 1:
        handles = [plt.Line2D([], [], color=one.colour, ls=one.line) for one in entries.values()]
        top.legend(handles, list(entries), loc="lower left", ncol=columns)
