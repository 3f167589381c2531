"""One look for every figure: sizes, colours that colour-blind readers tell apart, and how figures become files."""
import io
import os
from dataclasses import dataclass
from pathlib import Path

import matplotlib

matplotlib.use("agg")
from matplotlib import pyplot as plt  # noqa: E402  (the backend comes first)

WIDTH = 7.0  # of a page's text [inch]
FORMATS = ("svg", "pdf", "png")
PNG_DPI = 150

# Okabe and Ito's palette. Where its luminances would not tell curves apart in grey, line styles and markers do.
BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
YELLOW, BLUE, VERMILION, PURPLE = "#F0E442", "#0072B2", "#D55E00", "#CC79A7"
GREY, LIGHT = "#6E6E6E", "#D9D9D9"


@dataclass(frozen=True)
class Look:
    """How one series is drawn wherever it appears."""

    label: str
    colour: str
    line: object = "-"
    marker: str = "o"


ALGORITHMS = {
    "original_averaging": Look("original averaging (DP)", VERMILION, "-", "s"),
    "summation": Look("summation", ORANGE, (0, (5, 1.5)), "^"),
    "mean": Look("mean", SKY, (0, (3, 1, 1, 1)), "v"),
    "virtual_coupling": Look("virtual coupling", PURPLE, (0, (1, 1)), "D"),
    "shaped_stiffness": Look("stiffness shaping (HS)", BLACK, "-", "o"),
    "tandpasta": Look("tandpasta", GREEN, (0, (7, 2, 1, 2)), "P"),
    "normal_projection": Look("normal projection", GREY, (0, (2, 1)), "X"),
    "exact_shaping": Look("exact shaping (ours)", BLUE, (0, (4, 1, 1, 1, 1, 1)), "h"),
}

# Those that the thesis's scenes are not run with, only the studies of every algorithm.
BEYOND = {
    "continuous_normal_projection": Look("contin. projection (ours)", GREY, (0, (3, 1)), "*"),
    "least_squares": Look("least squares (ours)", GREEN, (0, (1, 1.5)), "d"),
    "highest_depth": Look("highest depth", SKY, (0, (6, 2)), "<"),
    "merged_shaping": Look("merged shaping (ours)", PURPLE, (0, (4, 1, 1, 1)), "p"),
    "proxy": Look("proxy (ours)", VERMILION, "-", ">"),
}
EVERY_ALGORITHM = {**ALGORITHMS, **BEYOND}


def look(algorithm):
    """Of any algorithm; those that have none of their own share one."""
    return EVERY_ALGORITHM.get(algorithm) or Look(algorithm.replace("_", " "), GREY, "-", "*")


# Numbers of the thesis are hollow diamonds everywhere.
PUBLISHED = {
    "marker": "D",
    "mfc": "white",
    "mec": VERMILION,
    "ecolor": VERMILION,
    "color": VERMILION,
    "ms": 4.5,
    "mew": 1.2,
    "elinewidth": 1.2,
    "capsize": 2.5,
    "ls": "none",
    "zorder": 5,
}

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
    box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.8}
    return ax.text(x, y, text, transform=ax.transAxes, color=colour, fontsize=7, bbox=box, **keywords)


def save(figure, stem, directory):
    """Writes the figure in every format, each file complete or not at all; returns the names. Same figure, same bytes:
    no dates, and identifiers in the SVG that follow from the figure's name."""
    # Once for all formats: finding the layout takes longer than drawing.
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    names = []
    for kind in FORMATS:
        metadata = {"svg": {"Date": None}, "pdf": {"CreationDate": None}, "png": {"Software": None}}[kind]
        bytes_ = io.BytesIO()
        with matplotlib.rc_context({"svg.hashsalt": stem}):
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
