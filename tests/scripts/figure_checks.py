"""Checks a figure by the contents of its axes and by its size on the sheet."""
import itertools

import numpy as np

from hapbench_style import fix_layout

SMALLEST, LARGEST = 7, 9  # smallest and largest allowed font size [points]
# Largest allowed overlap of two texts, and of a text with the border of the figure [pixels]. 100 pixels are an inch.
SLACK = 2.0


def texts_of(figure):
    """Returns the visible, non-empty texts of the figure and of its subfigures: titles, labels, and the tick labels
    within view."""
    found = []
    for part in (figure, *figure.subfigs):
        found += [*part.texts, *(text for legend in part.legends for text in legend.get_texts())]
    for ax in filter(lambda ax: ax.get_visible(), figure.axes):
        found += [
            *ax.texts,
            ax.xaxis.label,
            ax.yaxis.label,
            ax.title,
            ax._left_title,
            ax._right_title,
        ]
        found += ax.get_legend().get_texts() if ax.get_legend() else ()
        for along, limits in ((ax.xaxis, ax.get_xlim()), (ax.yaxis, ax.get_ylim())):
            found.append(along.offsetText)
            for minor in (False, True):
                for tick in along.get_minor_ticks() if minor else along.get_major_ticks():
                    if tick.label1.get_visible() and min(limits) <= tick.get_loc() <= max(limits):
                        found.append(tick.label1)
    return [text for text in found if text.get_visible() and text.get_text().strip()]


def legend_labels(figure):
    """Returns the labels in all legends of the figure, of its subfigures and of its axes."""
    parts = [figure, *figure.subfigs, *figure.axes]
    legends = [one for part in parts for one in getattr(part, "legends", [])]
    legends += [ax.get_legend() for ax in figure.axes if ax.get_legend()]
    return [text.get_text() for legend in legends for text in legend.get_texts()]


def curves_of(ax, marker):
    """Returns the points of each curve that is drawn with this marker."""
    return [line.get_xydata() for line in ax.lines if line.get_marker() == marker]


def assert_fits(test, figure, sheet):
    """Asserts that the figure has the size of the sheet and fonts of 7 to 9 pt. No text may leave the figure or overlap
    another text, no legend may overlap axes, and every numeric axis must have a unit."""
    fix_layout(figure)
    test.assertAlmostEqual(figure.get_figwidth(), sheet.width)
    if sheet.height:
        test.assertAlmostEqual(figure.get_figheight(), sheet.height)
    renderer = figure.canvas.get_renderer()
    figure.draw(renderer)
    boxes = []
    for text in texts_of(figure):
        test.assertTrue(
            SMALLEST <= text.get_fontsize() <= LARGEST, (text.get_text(), text.get_fontsize())
        )
        box = text.get_window_extent(renderer)
        low, high = box.min, box.max
        test.assertTrue(
            (low >= -SLACK).all() and (high <= figure.bbox.max + SLACK).all(),
            (text.get_text(), low, high, figure.bbox.max),
        )
        boxes.append((text, low, high))
    for (a, low, high), (b, bottom, top) in itertools.combinations(boxes, 2):
        overlap = np.minimum(high, top) - np.maximum(low, bottom)
        test.assertFalse((overlap > SLACK).all(), (a.get_text(), b.get_text(), overlap))
    shown = [ax for ax in figure.axes if ax.get_visible()]
    for part in (figure, *figure.subfigs):
        for legend in part.legends:
            box = legend.get_window_extent(renderer)
            test.assertFalse(any(box.overlaps(ax.get_window_extent(renderer)) for ax in shown))
    for ax in shown:
        for along in (ax.xaxis, ax.yaxis):
            title = along.get_label_text()
            test.assertTrue(not title or "[" in title or not has_numbers(along), title)


def has_numbers(along):
    """Returns True if the tick labels of an axis are numbers."""
    labels = [tick.get_text().strip() for tick in along.get_ticklabels()]
    return not any(
        any(letter.isalpha() for letter in label.replace("mathdefault", "")) for label in labels
    )
