"""Drawings in a page of `hapbench report`. A page contains each drawing for a light and for a dark background."""
import base64
from dataclasses import replace

import numpy as np

from hapbench_looks import law_name, look
from hapbench_report.markup import text
from hapbench_style import SETTINGS, picture, plt

from .given import axis
from .legibility import with_legible_ticks
from .over_axes import Axis, look_of, over_axes, pareto
from .panels import DARK, LIGHT, RunLook, settings

# Size of a drawing of a quantity, and of a scene [inch]. On a phone, the text in a drawing is then as legible as the
# text around it.
SIZE, SCENE_SIZE = (4.0, 2.0), (4.0, 2.9)


def drawing(size, draw, light, title, words, **labels):
    """Returns a drawing with one pair of axes as HTML, for both backgrounds. `draw(ax, looks, paper)` draws the curves;
    `paper` is LIGHT or DARK. `light`: looks of the curves on a light background. `words`: description for screen
    readers. `labels`: arguments of ax.set()."""

    def of(paper, shown):
        figure, ax = plt.subplots(figsize=size)
        draw(ax, shown, paper)
        ax.set(**labels)
        return figure

    return on_both_grounds(
        of, light, [replace(one, colour=one.dark) for one in light], title, words
    )


def on_both_grounds(draw, light, dark, title, words):
    """Returns HTML with a drawing for each background. `draw(paper, looks)` returns a figure; `paper` is LIGHT or DARK.
    `light`, `dark`: the looks for each background. `words`: description of the drawing for screen readers.
    """
    images = []
    for paper, shown, name in ((LIGHT, light, "only-light"), (DARK, dark, "only-dark")):
        with plt.rc_context({**SETTINGS, **settings(paper)}):
            figure = with_legible_ticks(draw(paper, shown))
            data = base64.b64encode(picture(figure, "svg")).decode()
            plt.close(figure)
        images.append(
            f'<img class="{name}" src="data:image/svg+xml;base64,{data}" alt="{text(f"{title}: {words}")}">'
        )
    return f"<figure><figcaption>{text(title)}</figcaption>{''.join(images)}</figure>"


MAX_LAWS = 2  # largest number of laws for which a page has only the table and no Pareto picture
DEEPER, SHAKIER = "inside_max_m", "force_rms_above_30Hz_N"


def pareto_section(runs):
    """Returns the Pareto section of a comparison: the mean vibration over the mean depth of the tool, with a mark for
    each law. Means are over all scenes and seeds. The section is empty for at most MAX_LAWS laws.
    """
    found = {}
    for run in runs:
        values = (run.metric(DEEPER), run.metric(SHAKIER))
        if None not in values:
            found.setdefault(run.algorithm, []).append(values)
    if len(found) <= MAX_LAWS:
        return ""
    means = {name: np.mean(values, axis=0) * (1e3, 1.0) for name, values in found.items()}
    front = pareto(np.array(list(means.values())))

    def draw(ax, shown, paper):
        ax.plot(*front.T, color=ax.xaxis.label.get_color(), lw=0.8, ls=":", zorder=1)
        series = [
            (
                law_name(one.label),
                mean[:1],
                mean[1:],
                look_of(one.label, color=one.colour, ls="none"),
            )
            for one, mean in zip(shown, means.values())
        ]
        every = np.array(list(means.values()))
        over_axes(
            ax,
            Axis.of(axis(DEEPER), every[:, 0]),
            Axis.of(axis(SHAKIER), every[:, 1]),
            series,
        )
        ax.legend(loc="upper left", bbox_to_anchor=(1, 1.05), fontsize=7, handletextpad=0.1)
        ax.margins(0.08)

    light = [RunLook(name, look(name).colour, look(name).dark, ()) for name in means]
    words = "; ".join(
        f"{law_name(name)} {mean[0]:.3g} mm, {mean[1]:.3g} N" for name, mean in means.items()
    )
    return (
        "<p>Mean over all runs of an algorithm. Dotted line: algorithms that no "
        "other algorithm beats in both depth and vibration.</p><div class=curves>"
        + drawing(SCENE_SIZE, draw, light, "Depth and vibration", words)
        + "</div>"
    )
