"""One look for every figure: sizes, colours (those of algorithms are in hapbench_looks), and how figures become files."""
import io
import os
from pathlib import Path

import matplotlib

from hapbench_looks import ALGORITHMS, look  # noqa: F401  (style.look is how figures name it)
from hapbench_looks import PUBLISHED as PUBLISHED_COLOUR

matplotlib.use("agg")
from matplotlib import pyplot as plt  # noqa: E402  (the backend comes first)
from matplotlib.transforms import Bbox  # noqa: E402

WIDTH = 7.0  # of a page's text [inch]
FORMATS = ("svg", "pdf", "png")
PNG_DPI = 150

# Lines and texts have a contrast of at least 4.5 to white. What is no algorithm's: readings, forces, contacts. Amber beside
# petrol is told apart by every kind of colour vision; where there is more, line styles and markers help. Red is the thesis's.
BLACK, GREY, AMBER, PETROL, PLUM, RED = "#000000", "#5F5F5F", "#8A5600", "#00647D", "#8A3B75", PUBLISHED_COLOUR
# For areas only.
SAND, PALE = "#EFE8DC", "#CFE6F5"
SOIL = "#8C7A58"  # the sand's border

# Those that the thesis's scenes are run with.
OF_THE_THESIS = (
    "original_averaging",
    "summation",
    "mean",
    "virtual_coupling",
    "shaped_stiffness",
    "tandpasta",
    "normal_projection",
    "exact_shaping",
)

# Numbers of the thesis are hollow diamonds everywhere.
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

# Behind a label that may stand on a line.
PLATE = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.8}

SETTINGS = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 8,
    "axes.titlesize": 8.5,
    "axes.labelsize": 8,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "legend.fontsize": 7.5,
    "legend.frameon": False,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.7,
    "axes.grid": True,
    "grid.color": "#E6E6E6",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "lines.linewidth": 1.3,
    "lines.markersize": 3.5,
    "figure.facecolor": "white",
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
    "path.simplify": True,
    "path.simplify_threshold": 0.5,
    "figure.constrained_layout.use": True,
    "agg.path.chunksize": 10000,
}


def panels(rows, columns, height, **keywords):
    """Figure of the page's width with a grid of axes, always a 2-D array."""
    return plt.subplots(rows, columns, figsize=(WIDTH, height), squeeze=False, **keywords)


def letter(axes):
    """Puts (a), (b), … before the titles."""
    for i, ax in enumerate(axes):
        ax.set_title(f"({chr(ord('a') + i)}) {ax.get_title(loc='left')}", loc="left")


def note(ax, x, y, text, colour=BLACK, **keywords):
    """A label inside the axes, at fractions of their sides, legible over lines."""
    keywords.setdefault("ha", "left")
    keywords.setdefault("va", "top")
    return ax.text(x, y, text, transform=ax.transAxes, color=colour, fontsize=7, bbox=PLATE, **keywords)


def fix_layout(figure):
    """Finds the layout now and for good: matplotlib would find it again for every format. Its last digits differ from run
    to run, with what lies where in memory, and would show in the identifiers of an SVG."""
    engine = figure.get_layout_engine()
    if engine is None:
        return
    engine.execute(figure)
    for axes in figure.axes:
        axes.set_position(Bbox(axes.get_position(original=True).get_points().round(12)))
    # None at all: with any, matplotlib would go through the figure once more before it draws.
    with matplotlib.rc_context({"figure.constrained_layout.use": False}):
        figure.set_layout_engine(None)


def save(figure, stem, directory):
    """Writes the figure in every format, each file complete or not at all; returns the names. Same figure, same bytes:
    no dates, and identifiers in the SVG that follow from the figure's name."""
    fix_layout(figure)
    names = []
    with matplotlib.rc_context({"svg.hashsalt": stem}):
        for kind in FORMATS:
            metadata = {"svg": {"Date": None}, "pdf": {"CreationDate": None}, "png": {"Software": None}}[kind]
            bytes_ = io.BytesIO()
            figure.savefig(bytes_, format=kind, dpi=PNG_DPI, metadata=metadata)
            write(Path(directory) / f"{stem}.{kind}", bytes_.getvalue())
            names.append(f"{stem}.{kind}")
    plt.close(figure)
    return names


def write(path, data):
    """Replaces the file by one with the bytes."""
    temporary = path.with_name(f".{path.name}.tmp")
    temporary.write_bytes(data)
    os.replace(temporary, path)
