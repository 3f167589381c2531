"""Settings shared by all pictures: sizes and colours (hapbench_looks has the palette). Also reduces curves that have
more rows than a picture can show, draws coinciding curves as stripes, and converts figures to files."""
import io
import re
import sys
from dataclasses import dataclass

import matplotlib
import numpy as np

from hapbench_looks import (
    ALGORITHMS,
    SERIES,
    look,
)  # noqa: F401  (style.look is how figures name it)
from hapbench_looks import PUBLISHED as PUBLISHED_COLOUR

if "matplotlib.pyplot" not in sys.modules:  # otherwise a notebook keeps its backend
    matplotlib.use("agg")
from matplotlib import pyplot as plt  # noqa: E402  (the backend comes first)
from matplotlib.text import Text  # noqa: E402
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter  # noqa: E402
from matplotlib.transforms import Bbox  # noqa: E402

WIDTH = 7.0  # text width of a page [inch]
# Resolution of a PNG, and of rasterised points in a PDF; journals require at least this value.
DPI = 300
SCREEN_DPI = 150  # resolution of a picture in a notebook, and of rasterised points in an SVG
MM = 1 / 25.4  # [inch]


@dataclass(frozen=True)
class Sheet:
    """Size of a printed picture. At this size, its texts have 7 to 9 pt."""

    width: float  # [inch]
    columns: int  # largest number of panels side by side
    height: float | None = None  # height of every picture [inch]; None: as high as its panels need
    tallest: float | None = None  # largest height of a panel [inch]

    def panel(self, height):
        """Returns the height of a row of panels [inch]: `height`, or `tallest` if that is smaller."""
        return min(height, self.tallest or height)

    def grid(self, count):
        """Returns (rows, columns) of a grid for `count` panels. Prefers few rows, then few empty cells."""
        columns = min(
            range(1, min(count, self.columns) + 1), key=lambda n: (-(-count // n), -count % n)
        )
        return -(-count // columns), columns

    def panels(self, rows, columns, height, **keywords):
        """Returns a figure and its axes, always a 2-D array. `height`: height of the figure [inch], unless the sheet
        sets it."""
        return plt.subplots(
            rows, columns, figsize=(self.width, self.height or height), squeeze=False, **keywords
        )


# Sheets: one and two columns of a journal, and a slide of 160 mm x 90 mm, the size of a 16:9 slide in LaTeX (beamer).
SHEETS = {
    "single": Sheet(89 * MM, 1, tallest=45 * MM),
    "double": Sheet(183 * MM, 3),
    "slide": Sheet(160 * MM, 3, 90 * MM),
}
SHEET, PAGE = SHEETS["double"], Sheet(WIDTH, 3)

# Colours of measured quantities, forces and contacts; algorithms have other colours. Each of these colours has a
# contrast of at least 4.5 to white. Two curves are amber and petrol, which can be distinguished with every type of
# colour vision. A third curve also has another line style or marker. Red is for the numbers of the thesis.
BLACK, GREY, AMBER, PETROL, PLUM, RED = (
    "#000000",
    "#5F5F5F",
    "#8A5600",
    "#00647D",
    "#8A3B75",
    PUBLISHED_COLOUR,
)
SAND, SOIL = "#EFE8DC", "#8C7A58"  # colour of an area, and of its border

# Style of the thesis's numbers in every figure: hollow diamonds.
PUBLISHED = {
    "marker": "D",
    "mfc": "white",
    "mec": RED,
    "ecolor": RED,
    "color": RED,
    "ms": 4.5,
    "mew": 1.2,
    "elinewidth": 1.2,
    "capsize": 2.5,
    "ls": "none",
    "zorder": 5,
}
PUBLISHED_LINE = {"color": RED, "lw": 1, "ls": (0, (1, 1.5))}

# Background of a label that may overlap a line.
PLATE = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.8}

# Settings of matplotlib (rcParams), by group.
SETTINGS = {
    f"{group}.{name}": value
    for group, settings in {
        "font": {"sans-serif": ["DejaVu Sans"], "size": 8},
        "axes": {
            "titlesize": 8.5,
            "titlelocation": "left",
            "labelsize": 8,
            "linewidth": 0.7,
            "spines.top": False,
            "spines.right": False,
            "grid": True,
            "axisbelow": True,
        },
        "xtick": {"labelsize": 7.5},
        "ytick": {"labelsize": 7.5},
        "legend": {"fontsize": 7.5, "frameon": False},
        "grid": {"color": "#E6E6E6", "linewidth": 0.6},
        "lines": {"linewidth": 1.3, "markersize": 3.5},
        "path": {"simplify_threshold": 0.5},
        "agg": {"path.chunksize": 10000},
        "figure": {"constrained_layout.use": True},
    }.items()
    for name, value in settings.items()
}


def panels(rows, columns, height, **keywords):
    """Returns a figure of the page's width and its axes, always a 2-D array. `height`: height of the figure [inch]."""
    return plt.subplots(rows, columns, figsize=(WIDTH, height), squeeze=False, **keywords)


def number_ticks(axis, subs=()):
    """Also labels ticks between the powers of ten on a logarithmic axis, if the ratio of its limits is below 60. If
    `subs` is not empty, labels instead the multiples `subs` of each power of ten, on a logarithmic axis of any range.
    """
    low, high = axis.get_view_interval()
    if axis.get_scale() == "log" and (subs or high / low < 60):
        axis.set_major_locator(LogLocator(subs=subs or ((1, 2, 5) if high / low < 20 else (1, 3))))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


LINE = 0.17  # height of one line of a legend [inch]


LETTER = 0.062  # mean width of a letter in a legend or a label [inch]


def legend_columns(labels, width, max_columns=4):
    """Returns the number of columns in which a legend with these labels fits into `width` [inch]."""
    return max(
        1,
        min(max_columns, len(labels), int((width - 0.1) / (0.6 + LETTER * max(map(len, labels))))),
    )


def legend_height(labels, width):
    """Returns the height [inch] of a legend above the panels that is as wide as the figure."""
    return 0.08 + LINE * -(-len(labels) // legend_columns(labels, width, 6))


def legend_above(figure, handles, labels, columns=4):
    """Adds a legend above all panels and reserves room for it. Does nothing without labels. `columns`: number of
    columns; None for as many columns as fit."""
    if not labels:
        return
    columns = columns or legend_columns(labels, figure.get_figwidth(), 6)
    lines = -(-len(labels) // columns)
    figure.get_layout_engine().set(
        rect=(0, 0, 1, 1 - (0.08 + LINE * lines) / figure.get_figheight())
    )
    figure.legend(handles, labels, loc="upper left", ncol=columns, handlelength=2.6)


def lettered(figure, axes):
    """Writes (a), (b), … before the titles of the axes and returns the figure."""
    for i, ax in enumerate(axes):
        ax.set_title(f"({chr(ord('a') + i)}) {ax.get_title(loc='left')}", loc="left")
    return figure


def note(ax, x, y, text, colour=BLACK, ha="left", va="top"):
    """Writes a label inside the axes, at fractions of their width and height, on a background that makes it legible
    over lines."""
    ax.text(x, y, text, transform=ax.transAxes, color=colour, fontsize=7, bbox=PLATE, ha=ha, va=va)


def fix_layout(figure):
    """Computes the layout of a figure once. Matplotlib would compute it again for each file format. The last digits of
    the layout depend on memory addresses, and would change the identifiers in an SVG between runs.
    """
    engine = figure.get_layout_engine()
    if engine is None:
        return
    engine.execute(figure)
    for axes in figure.axes:
        axes.set_position(Bbox(axes.get_position(original=True).get_points().round(12)))
    # Removes the layout engine. With an engine, matplotlib would traverse the figure again before drawing.
    with matplotlib.rc_context({"figure.constrained_layout.use": False}):
        figure.set_layout_engine(None)


def show_dollars(figure):
    """Draws texts that contain "$" literally instead of as formulas. Only tick labels of logarithmic axes remain
    formulas."""
    formulas = {
        label
        for axes in figure.axes
        for axis in (axes.xaxis, axes.yaxis)
        if axis.get_scale() != "linear"
        for label in axis.get_ticklabels(which="both")
    }
    for text in figure.findobj(Text):
        if text not in formulas:
            text.set_parse_math(False)


# Settings for files: texts in an SVG remain texts, and a PDF embeds TrueType fonts (Type 42). Journals reject fonts of
# Type 3.
FILES = {"svg.fonttype": "none", "pdf.fonttype": 42, "ps.fonttype": 42}


def picture(figure, kind, salt="hapbench", dpi=DPI):
    """Returns the bytes of the figure as "svg", "pdf" or "png". Equal figures give equal bytes, because the file
    contains no date and `salt` determines the identifiers in an SVG. `dpi`: pixels per inch of a PNG and of the
    rasterised parts of a PDF."""
    show_dollars(figure)
    fix_layout(figure)
    drawn = io.BytesIO()
    undated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}, "png": {"Software": None}}[
        kind
    ]
    with matplotlib.rc_context({"svg.hashsalt": salt, **FILES}):
        dpi = SCREEN_DPI if kind == "svg" else dpi
        figure.savefig(drawn, format=kind, dpi=dpi, metadata=undated)
    return compact(drawn.getvalue().decode()).encode() if kind == "svg" else drawn.getvalue()


COORDINATES = re.compile(r'( (?:d|x|y)=")([^"]*)')  # attributes of an SVG that contain coordinates
DISC = re.compile(r'<path id="(\w+)" d="M 0 ([\d.]+) \nC[^"]*z\n"')
# Matplotlib writes the style into the group of discs or, in newer versions, into each disc.
DISCS = re.compile(
    r'<g( clip-path="[^"]*")?(?: style="([^"]*)")?>\s*'
    r'((?:<use xlink:href="#(\w+)" x="[^"]*" y="[^"]*"(?: style="([^"]*)")?/>\s*)+)</g>'
)


def as_dots(svg):
    """Replaces consecutive discs of an SVG by one path, which is shorter. The path has a line of zero length with round
    ends at each disc, which looks like the disc."""
    radii = dict(DISC.findall(svg))

    def dots(group):
        clip, css, uses, name, style_of_disc = group.groups(default="")
        if len(set(re.findall(r"#\w+|style=[^/]*", uses))) > (2 if style_of_disc else 1) or not (
            css or style_of_disc
        ):
            return group[0]
        css = dict(item.split(": ") for item in (css or style_of_disc).rstrip("; ").split("; "))
        fill, stroke = css.pop("fill", "#000000"), css.pop("stroke", "none")
        if name not in radii or stroke not in ("none", fill):
            return group[0]
        width = 2 * float(radii[name]) + (
            float(css.pop("stroke-width", 1)) if stroke == fill else 0
        )
        opacity = css.get("fill-opacity", css.get("opacity", "1"))
        moves = "".join(f"M{x} {y}h0" for x, y in re.findall(r'x="([^"]*)" y="([^"]*)"', uses))
        return (
            f'<path d="{moves}"{clip} style="fill: none; stroke: {fill}; stroke-opacity: '
            f"{opacity}; stroke-linecap: round; "
            f'stroke-width: {width:.2f}"/>'
        )

    return DISCS.sub(dots, svg)


def compact(svg):
    """Returns the same drawing in half the bytes. Coordinates are rounded to a tenth of a point, repeated styles become
    classes, identifiers are short, and parts that are not drawn are removed."""
    svg = as_dots(re.sub(r"<!--.*?-->|<metadata>.*?</metadata>|<g[^>]*/>", "", svg, flags=re.S))
    svg = COORDINATES.sub(
        lambda found: found[1]
        + re.sub(r"-?\d+\.\d+", lambda n: f"{round(float(n[0]), 1):g}", found[2]),
        svg,
    )
    svg = re.sub(r' transform="rotate\(-0 [^)]*\)"', "", svg)
    names = set(re.findall(r'(?:href="#|url\(#)(\w+)', svg))
    short = {name: f"i{number:x}" for number, name in enumerate(sorted(names, key=svg.index))}
    svg = re.sub(r' id="(\w+)"', lambda i: f' id="{short[i[1]]}"' if i[1] in short else "", svg)
    svg = re.sub(r"(?<=#)\w+(?=[\")])", lambda i: short.get(i[0], i[0]), svg)
    styles = re.findall(r' style="([^"]*)"', svg)
    often = {
        style: f"s{number:x}"
        for number, style in enumerate(dict.fromkeys(s for s in styles if styles.count(s) > 1))
    }
    svg = re.sub(
        r' style="([^"]*)"', lambda s: f' class="{often[s[1]]}"' if s[1] in often else s[0], svg
    )
    rules = "".join(f".{name}{{{style}}}" for style, name in often.items())
    svg = re.sub(r"(<defs>\s*<style[^>]*>)", lambda d: d[1] + rules, svg, count=1)
    svg, inner = re.sub(r">\s+<", "><", svg), re.compile(r"<g>((?:<(?!/?g[ >])[^>]*>[^<]*)*)</g>")
    while inner.search(svg):  # removes groups that have no effect on their contents
        svg = inner.sub(r"\1", svg)
    svg = re.sub(
        r' d="([^"]*)"',
        lambda d: f' d="{re.sub(r"(?<=[LMCQ]) | (?=[LMCQz])|(?<=z) ", "", d[1]).strip()}"',
        re.sub(r"\s+", " ", svg),
    )
    svg = re.sub(
        r"(?<=\d)L(-?[\d.]+ -?[\d.]+)(?=[Lz\"])", r" \1", svg
    )  # the command after a coordinate is a line
    return re.sub(r"((?:[^>]*>){12,}?)(?=<(?:path|g|use|rect)[ >])", "\\1\n", svg).strip() + "\n"


def reduced(time, low, high, spans):
    """Divides the time into `spans` equal intervals. Returns (start, smallest of `low`, largest of `high`) of each
    interval that contains a row. Returns the rows unchanged if there are at most 2 `spans` rows. A value is NaN only if
    all values of its interval are NaN."""
    if len(time) <= 2 * spans:
        return time, low, high
    length = (time[-1] - time[0]) or 1.0
    span = np.minimum(((time - time[0]) / length * spans).astype(int), spans - 1)
    starts = np.flatnonzero(np.diff(span, prepend=-1))
    return time[starts], np.fmin.reduceat(low, starts), np.fmax.reduceat(high, starts)


def curve(time, low, high, spans):
    """Returns (times, values) of one line through the result of reduced(). Within each interval, the line connects the
    smallest and the largest value."""
    t, smallest, largest = reduced(time, low, high, spans)
    if len(t) == len(time):
        return time, low
    return np.repeat(t, 2), np.column_stack([smallest, largest]).ravel()


STRIPE = 6  # length of a stripe [points]


def equal_curves(curves):
    """Returns for each curve (a tuple of arrays) its index among the curves that equal it, and the number of curves
    that equal it. The curve itself counts."""
    keys = [b"".join(np.ascontiguousarray(part).tobytes() for part in curve) for curve in curves]
    return [(keys[:i].count(key), keys.count(key)) for i, key in enumerate(keys)]


def striped(ls, index, count):
    """Returns the line style of one of `count` coinciding curves: stripes that alternate, so that each curve is
    visible. A single curve keeps the given style."""
    return ls if count == 1 else (index * STRIPE, (STRIPE, STRIPE * (count - 1)))
