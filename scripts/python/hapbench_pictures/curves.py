"""Curves for a page: one drawing for each quantity, on light and on dark ground."""
import base64
import html
import io

import matplotlib
import numpy as np

from hapbench_figures.style import SETTINGS, fix_layout

from .looks import DARK, LIGHT, looks, on_dark, settings
from .panels import PATH_COLUMNS, draw_over_time, draw_path, projections
from .quantities import SHORT, USUAL, Samples, tables_of
from .replay import surface_of

matplotlib.use("agg")
from matplotlib import pyplot as plt  # noqa: E402  (the backend comes first)

SIZE, PATH_SIZE = (4.0, 2.0), (4.0, 2.9)  # [inch]: on a phone as legible as the text around it


def curves_section(runs, labels):
    quantities = [SHORT[name] for name in USUAL if name in SHORT]
    quantities = [q for q in quantities if any(q.file in tables_of(run) for run in runs)]
    samples = [Samples(run, quantities, PATH_COLUMNS) for run in runs]
    light, surface = looks(runs, labels), surface_of(runs)
    figures = [drawing(SIZE, lambda ax, shown, q=q: draw_over_time(ax, q, samples, shown), light,
                       f"{q.axis} over time", spoken(q, samples, labels), xlabel="time [s]") for q in quantities]
    figures += [drawing(PATH_SIZE, lambda ax, shown, plane=plane: draw_path(ax, plane, samples, shown, surface), light,
                        f"Way of the tip, {plane[0]} and {plane[1]}", "Circles: start; dots: surface") for plane in projections(samples)]
    return f"<p>{key(light)} Triangles and dotted lines: first touch.{' Dots: section of the surface.' if surface is not None else ''}</p><div class=curves>{''.join(figures)}</div>"


def key(light):
    return " ".join(f'<b class=run-name style="--light:{one.colour};--dark:{one.dark}">{html.escape(one.label)}</b>'
                    for one in light)


def spoken(quantity, samples, labels):
    """The picture in words: the range of every run."""
    parts = []
    for s, label in zip(samples, labels):
        found = s.of(quantity)
        if found is not None and np.isfinite(found[2]).any():
            parts.append(f"{label} {np.nanmin(found[1]):.3g} to {np.nanmax(found[2]):.3g} {quantity.unit}".strip())
    return "; ".join(parts)


def drawing(size, draw, light, title, words, **labels):
    images = []
    for paper, shown, name in ((LIGHT, light, "only-light"), (DARK, on_dark(light), "only-dark")):
        with matplotlib.rc_context({**SETTINGS, **settings(paper), "svg.hashsalt": "hapbench"}):
            figure, ax = plt.subplots(figsize=size)
            draw(ax, shown)
            ax.set(**labels)
            picture = io.BytesIO()
            fix_layout(figure)
            figure.savefig(picture, format="svg", metadata={"Date": None})
            plt.close(figure)
        data = base64.b64encode(picture.getvalue()).decode()
        images.append(f'<img class="{name}" src="data:image/svg+xml;base64,{data}" alt="{html.escape(f"{title}: {words}")}">')
    return f"<figure><figcaption>{html.escape(title)}</figcaption>{''.join(images)}</figure>"
