"""Picture of runs: cross-sections of the scenes, and quantities over time."""
import math
from collections import Counter
from functools import partial
from textwrap import fill

import numpy as np

from hapbench.results import at
from hapbench_report.recording import tool_profile
from hapbench_report.replay import surface_of
from hapbench_style import LETTER, LINE, SETTINGS, SHEET, legend_columns, plt

from .given import named
from .legibility import legend_of_names
from .panels import (
    AXIS_COLUMNS,
    PATH_COLUMNS,
    PATH_MARKS,
    TOOL_OUTLINES,
    draw_over_time,
    draw_section,
    framed,
    looks,
    surface_text,
    tip_of,
)
from .quantities import Samples

# Height of a scene and of the first quantity, and height of each further quantity [inch].
LARGE, SMALL = 2.6, 1.35
ROOM = 0.35  # height reserved for the title of the time axis [inch]
TITLE_LETTER = 0.085  # width of a letter of the title [inch]
LONGEST_NAME = 90  # largest number of letters of a run's name in the title


def draw_runs(runs, quantities, with_path, window, sheet=SHEET):
    """Returns the figure of runs: a title with their names, and the quantities over time. If `with_path` is true, the
    figure also contains a cross-section of each scene with the paths of the tips."""
    further = (*PATH_COLUMNS, *AXIS_COLUMNS) if with_path else ()
    samples = [Samples(run, quantities, further, window) for run in runs]
    shown = looks(runs, *named(runs))
    groups = scene_groups(runs, samples) if with_path else []
    surfaces = [surface_of([runs[i] for i in group]) for group in groups]
    with plt.rc_context(SETTINGS):
        return figure_of(runs, shown, quantities, samples, groups, surfaces, sheet)


def figure_of(runs, shown, quantities, samples, groups, surfaces, sheet=SHEET):
    """Returns the figure. `groups`: for each cross-section of a scene, the indices in `runs` of its runs. `surfaces`:
    for each cross-section, the surface that the tools touch, or None."""
    entries = legend_of(shown)
    columns = legend_columns(list(entries), sheet.width)
    head = 0.3 + (LINE * math.ceil(len(entries) / columns) if len(runs) > 1 else 0)
    beside = len(groups) == 1 and bool(quantities) and surfaces[0] is None and sheet.columns > 1
    rows = rows_of(len(groups), len(quantities), beside, sheet)
    body = sum(height for height, _, _ in rows) + ROOM
    if sheet.height:
        body = sheet.height - head
    figure = plt.figure(figsize=(sheet.width, head + body))
    top, bottom = figure.subfigures(2, 1, height_ratios=[head, body])
    write_title(top, head, runs, entries, columns, sheet)
    axes = axes_of(bottom, rows)
    scenes, over_time = axes[: len(groups)], axes[len(groups) :]
    draw_scenes(scenes, groups, runs, shown, samples, surfaces, width_of(rows, sheet))
    explain_scenes(bottom, scenes, texts_of(groups, runs, surfaces), sheet, rows)
    for ax, quantity in zip(over_time, quantities):
        draw_over_time(ax, quantity, samples, shown)
        ax.sharex(over_time[0])
    name_times(over_time, beside, sheet)
    if not sheet.height:
        bottom.align_ylabels()
    return figure


def rows_of(scenes, quantities, beside, sheet):
    """Returns (height [inch], number of columns, width ratios of the panels) for each row of panels. `beside`: true if
    the scene and the first quantity share a row."""
    if sheet.height:
        rows, columns = sheet.grid(scenes + quantities)
        counts = [min(columns, scenes + quantities - row * columns) for row in range(rows)]
        return [(1.0, columns, (1,) * count) for count in counts]
    large, small = sheet.panel(LARGE), sheet.panel(SMALL)
    if beside:
        return [(large, 2, (1, 1.5))] + [(small, 1, (1,))] * (quantities - 1)
    _, columns = sheet.grid(scenes) if scenes else (0, 1)
    sections = [min(columns, scenes - first) for first in range(0, scenes, columns)]
    first = [(large, 1, (1,))] if quantities else []
    return (
        [(large, columns, (1,) * count) for count in sections]
        + first
        + [(small, 1, (1,))] * (quantities - 1)
    )


def axes_of(figure, rows):
    """Creates and returns the axes of all panels, row by row. `rows`: result of rows_of()."""
    heights = [height for height, _, _ in rows]
    widths = {(columns, ratios) for _, columns, ratios in rows if len(ratios) == columns}
    if len(widths) == 1:  # a single grid, in which all columns are aligned
        ((columns, ratios),) = widths
        grid = figure.add_gridspec(len(rows), columns, height_ratios=heights, width_ratios=ratios)
        cells = [grid[i, j] for i, (_, _, of) in enumerate(rows) for j in range(len(of))]
    else:
        grid, cells = figure.add_gridspec(len(rows), 1, height_ratios=heights), []
        for i, (_, columns, of) in enumerate(rows):
            # A panel that fills its row is not in a grid of its own, so that such panels are aligned.
            if columns == 1:
                cells.append(grid[i])
                continue
            widths = (*of, *(1,) * (columns - len(of)))
            part = grid[i].subgridspec(1, columns, width_ratios=widths)
            cells += [part[0, j] for j in range(len(of))]
    return [figure.add_subplot(cell) for cell in cells]


def name_times(axes, beside, sheet):
    """Writes the title of the time axis below the panels that show it. The other panels have no tick labels on
    their time axis."""
    if not axes:
        return
    marks = "   (triangles and dotted lines: first touch)"
    for ax in axes:
        alone = ax is axes[-1] or beside and ax is axes[0] or bool(sheet.height)
        ax.tick_params(labelbottom=alone)
        if alone:
            ax.set_xlabel("time [s]")
    wide = sheet.width > len(marks) * LETTER + 1.5
    if wide and not sheet.height:
        axes[-1].set_xlabel(f"time [s]{marks}")


def width_of(rows, sheet):
    """Returns the width [inch] of a panel, without its tick labels, in the row with the most panels."""
    return sheet.width / max(columns for _, columns, _ in rows) - 0.6


def draw_scenes(axes, groups, runs, shown, samples, surfaces, width):
    """Draws one cross-section of the scene for each group of runs. `width`: width of a panel [inch]."""
    for ax, group, surface in zip(axes, groups, surfaces):
        of_samples, of_looks = ([entries[i] for i in group] for entries in (samples, shown))
        draw_section(ax, of_samples, of_looks, profile_of(runs[group[0]]), surface)
        if len(groups) > 1:
            name = runs[group[0]].name.replace("_", " ")
            ax.set_title(shortened(name, int(width / TITLE_LETTER)))


def texts_of(groups, runs, surfaces):
    """Returns, for each cross-section, a text that explains its marks."""
    texts = []
    for group, surface in zip(groups, surfaces):
        phrases = [PATH_MARKS, *surface_text(surface)]
        if profile_of(runs[group[0]]):
            phrases.append(TOOL_OUTLINES + (", first run" if len(group) > 1 else ""))
        texts.append("; ".join(phrases))
    return texts


def explain_scenes(figure, axes, texts, sheet, rows):
    """Writes the explanation of the marks below each cross-section. An explanation that equals the explanation of the
    first cross-section is not repeated. If the sheet has a fixed height, one explanation stands below all panels.
    """
    if sheet.height and texts:
        every = dict.fromkeys("; ".join(texts).split("; "))
        figure.supxlabel(fill("; ".join(every), int(sheet.width / LETTER)), fontsize=7)
        return
    letters = int(width_of(rows, sheet) / LETTER)
    for i, (ax, text) in enumerate(zip(axes, texts)):
        if i == 0 or text != texts[0]:
            ax.set_xlabel(f"{ax.get_xlabel()}\n{fill(text, letters)}", fontsize=7)


def scene_groups(runs, samples):
    """Returns the groups of runs that share a cross-section, as lists of indices in `runs`. A run joins a group of runs
    of the same scene if its bounding box is near the bounding box of the group, by are_near()."""
    groups = []
    for i, (run, of) in enumerate(zip(runs, samples)):
        box = box_of(of)
        for members, name, shared in groups:
            if name == run.name and are_near(box, shared):
                members.append(i)
                shared[:] = np.minimum(box[0], shared[0]), np.maximum(box[1], shared[1])
                break
        else:
            groups.append(([i], run.name, box))
    return [members for members, _, _ in groups]


def box_of(samples):
    """Returns the corners of the bounding box of the tip's positions in the rows that framed() returns. These rows
    exclude the path of a tool that is thrown away after a contact."""
    tips = tip_of(samples)[framed(samples)]
    return np.array([tips.min(axis=0), tips.max(axis=0)])


def are_near(box, other):
    """Returns True if the gap between two boxes is at most the sum of the longest edges of both boxes."""
    gap = np.maximum(box[0] - other[1], other[0] - box[1]).max()
    return gap <= (box[1] - box[0]).max() + (other[1] - other[0]).max()


def profile_of(run):
    """Returns the profile of the tool by tool_profile(); None for a scene of springs, which has no tool."""
    return (
        None
        if at(run.scenario, "/environment/type") == "springs"
        else tool_profile(run.scenario, run.summary)
    )


def legend_of(shown):
    """Returns the entries of the legend: a RunLook by label. Runs that differ only in the seed share one entry."""
    counts = Counter(one.group or one.label for one in shown)
    entries = {}
    for one in shown:
        name = one.group or one.label
        entries.setdefault(name if counts[name] == 1 else f"{name} ({counts[name]} seeds)", one)
    return (
        {shortened(name): one for name, one in entries.items()}
        if len(set(map(shortened, entries))) == len(entries)
        else entries
    )


def shortened(name, longest=LONGEST_NAME):
    return name if len(name) <= longest else f"{name[:longest // 2 - 1]}…{name[-(longest // 2):]}"


def write_title(top, head, runs, entries, columns, sheet):
    """Writes the names of the scenes as the title, and a legend if there are several runs."""
    scenes = ", ".join(dict.fromkeys(run.name for run in runs))
    name = next(iter(entries)) if len(runs) == 1 else scenes
    room = int(sheet.width / TITLE_LETTER)
    if len(name) > room:
        name = shortened(name, room) if len(runs) == 1 else f"{len(runs)} runs"
    top.text(0.01, 1 - 0.06 / head, name, ha="left", va="top", fontsize=9, weight="bold")
    if len(runs) > 1:
        handles = [plt.Line2D([], [], color=one.colour, ls=one.line) for one in entries.values()]
        legend = partial(top.legend, loc="lower left", ncol=columns)
        legend_of_names(legend, handles, list(entries))
