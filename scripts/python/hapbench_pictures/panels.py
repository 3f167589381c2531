"""How runs are drawn: as their algorithm is everywhere, with line styles where two runs share one; one quantity over time, and the
tip's way in space, of several runs, into matplotlib's axes."""
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.patches import Polygon

from hapbench_looks import Look, look
from hapbench_style import curve, reduced

from .quantities import range_of

DASHES = ((), (4, 1.5), (1, 1), (4, 1, 1, 1))
# Text, ground, grid and secondary text: of paper, and of the dark page.
LIGHT = ("#1d2126", "#ffffff", "#e6e6e6", "#5b636c")
DARK = ("#e7e9ea", "#1c2024", "#383e44", "#a3abb3")
# Colours of runs that share one algorithm, on paper and on the dark page, each with a contrast of at least 4.5.
SHARED = (("#000000", "#F2F2F2"), ("#C2500A", "#FFA366"), ("#0B6BC4", "#6CB4F5"), ("#9F0375", "#F07CC8"), ("#1D6A01", "#7EDB5A"),
          ("#775543", "#D3AE97"))
THIN = 0.6  # line width of the single runs of a group [points]
SPANS = 600  # of a curve: a page hardly shows more
# Runs whose peaks are further apart than this share no linear axis.
LARGEST_RATIO = 30
SECTION_M = 0.15e-3  # a point of the surface no further away belongs to its section
SURFACE = "#8A949C"  # on paper and in the dark
PATH_COLUMNS, AXIS_COLUMNS = ("px_m", "py_m", "pz_m"), ("axis_x", "axis_y", "axis_z")
SNAPSHOTS = (0.3, 0.45, 0.65, 0.9)  # opacity of the tool at so many places of its way
LEAST_IN_PLANE = 0.85  # of the tool's axis, for its outline to be drawn: no more than 30 degrees out of the plane


@dataclass(frozen=True)
class RunLook(Look):
    marker: str = ""  # curves of runs have none
    width: float = 1.3
    group: str = ""  # the label of all runs that differ in the seed only


def looks(runs, labels, groups=()):
    """`groups`: a name for each run, the same for those that differ in the seed only; by default the labels."""
    groups = groups or labels
    distinct = list(dict.fromkeys(zip(groups, (run.algorithm for run in runs))))
    algorithms = [algorithm for _, algorithm in distinct]
    nth = {group: algorithms[:i].count(algorithm) for i, (group, algorithm) in enumerate(distinct)}
    one_each, alike = len(set(algorithms)) == len(distinct), len(set(algorithms)) == 1
    width = RunLook.width if len(distinct) == len(runs) else THIN
    found = []
    for run, label, group in zip(runs, labels, groups):
        own, i = look(run.algorithm), nth[group]
        colours = SHARED[i % len(SHARED)] if alike and not one_each else (own.colour, own.dark)
        found.append(RunLook(label, *colours, own.dash if one_each else DASHES[i % len(DASHES)], width=width, group=group))
    return found


def on_dark(shown):
    return [replace(one, colour=one.dark) for one in shown]


def settings(paper):
    """matplotlib's colours for LIGHT or DARK."""
    ink, ground, grid, _ = paper
    return {"text.color": ink, "axes.labelcolor": ink, "xtick.color": ink, "ytick.color": ink, "axes.edgecolor": ink,
            "axes.facecolor": ground, "figure.facecolor": ground, "savefig.facecolor": ground, "grid.color": grid}


def draw_over_time(ax, quantity, samples, looks):
    drawn = [(s, one, s.of(quantity)) for s, one in zip(samples, looks)]
    drawn = [(s, one, of) for s, one, of in drawn if of is not None]
    if not share_an_axis(ax, [of[2] for _, _, of in drawn]):
        cut_off_peaks(ax, quantity, drawn)
    for s, one, (time, low, high) in drawn:
        if low is high:
            ax.plot(*curve(time, low, high, SPANS), color=one.colour, ls=one.line, lw=one.width, label=one.label)
        else:
            time, low, high = reduced(time, low, high, SPANS)
            ax.fill_between(time, low, high, color=one.colour, alpha=0.2, lw=0)
            for edge in (low, high):
                ax.plot(time, edge, color=one.colour, ls=one.line, lw=min(0.8, one.width), label=one.label if edge is low else None)
        mark_first_touch(ax, s, one)
    ax.set_ylabel(quantity.axis)
    ax.margins(x=0.01)


def share_an_axis(ax, heights):
    """A linear axis; where a run is thrown about, linear up to the calmest run's peak and logarithmic beyond.
    Whether it is the latter."""
    peaks = [peak for peak in (float(np.nanmax(np.abs(h), initial=0.0)) for h in heights) if peak > 0]
    if peaks and max(peaks) > LARGEST_RATIO * min(peaks):
        ax.set_yscale("symlog", linthresh=min(peaks))
        return True
    return False


def cut_off_peaks(ax, quantity, drawn):
    """The range of settled contact, where it is far below a peak; the largest one is written where it leaves the picture."""
    shown = range_of(quantity, [s for s, _, _ in drawn])
    if shown is None:
        return
    ax.set_ylim(*shown)
    at, value, colour = max(((time[row], edge[row], one.colour) for _, one, (time, *edges) in drawn for edge in edges
                             if np.isfinite(edge).any() for row in [np.nanargmax(np.abs(edge))]), key=lambda peak: abs(peak[1]))
    ends = [time[end] for _, _, (time, *_) in drawn for end in (0, -1)]
    left, above = at <= (min(ends) + max(ends)) / 2, value > 0
    ax.plot(at, float(above), marker="^" if above else "v", ms=4, color=colour, transform=ax.get_xaxis_transform(), clip_on=False)
    ax.annotate(f"peak {value:.3g} {quantity.unit}".strip(), (at, float(above)), xycoords=ax.get_xaxis_transform(), color=colour,
                xytext=(5 if left else -5, 1), textcoords="offset points", fontsize=7,
                ha="left" if left else "right", va="bottom")


def mark_first_touch(ax, samples, look):
    at = samples.first_touch_s
    if at is not None:
        ax.axvline(at, color=look.colour, ls=(0, (1, 2)), lw=0.8)
        ax.plot(at, 0, marker="v", ms=5, color=look.colour, transform=ax.get_xaxis_transform(), clip_on=False)


def projections(samples):
    """Pairs of axes to look along: one for a planar scene, else two sides and the top."""
    planar = all(np.all(s.trajectory["pz_m"] == 0) for s in samples)
    return (("x", "y"),) if planar else (("x", "z"), ("y", "z"), ("x", "y"))


def section(points, plane, tip):
    """Points no further than 0.15 mm from the plane through the middle of the tip's way, along two of the axes 0 to 2."""
    aside = 3 - sum(plane)
    distance = np.abs(points[:, aside] - np.median(tip[:, aside]))
    return points[distance <= max(SECTION_M, 1.01 * distance.min())][:, list(plane)]


def draw_surface(ax, plane, samples, points):
    """The section of the surface, as far as the axes reach."""
    tip = np.vstack([np.column_stack([s.trajectory[name] for name in PATH_COLUMNS]) for s in samples])
    dots = 1e3 * section(points, ["xyz".index(axis) for axis in plane], tip)
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    inside = (dots[:, 0] >= left) & (dots[:, 0] <= right) & (dots[:, 1] >= bottom) & (dots[:, 1] <= top)
    # Rasterised, because thousands of points would make the file large.
    ax.plot(*dots[inside].T, ".", color=SURFACE, ms=1.5, zorder=0, rasterized=True)
    ax.grid(False)


def outline(profile, tip, axis):
    """Outline of the tool [m] at a tip with an axis, both projected into a plane; right where the axis lies in the plane, and near it
    elsewhere. `profile`: hapbench_report.replay_tool.tool_profile."""
    axis = axis / np.linalg.norm(axis)
    s, radius = np.array(profile).T[:, :, None]
    half, across = tip + s * axis, radius * np.array([-axis[1], axis[0]])
    return np.vstack([half + across, (half - across)[::-1]])


def draw_tool(ax, plane, samples, profile, colour):
    """Its outline at a few places of a run's way, as far as the axes reach; whether there is one. Of a way that is shorter
    than the tool is wide, it would be lines across the picture."""
    tip, axis = (np.column_stack([samples.trajectory[columns["xyz".index(one)]] for one in plane])
                 for columns in (PATH_COLUMNS, AXIS_COLUMNS))
    low, high = 1e-3 * np.array([ax.get_xlim(), ax.get_ylim()]).T
    if high[0] - low[0] < 2 * max(radius for _, radius in profile):
        return False
    seen = np.flatnonzero(((tip >= low) & (tip <= high)).all(axis=1) & (np.linalg.norm(axis, axis=1) >= LEAST_IN_PLANE))
    if not seen.size:
        return False
    for row, alpha in zip(seen[np.linspace(0, len(seen) - 1, len(SNAPSHOTS)).astype(int)], SNAPSHOTS):
        ax.add_patch(Polygon(1e3 * outline(profile, tip[row], axis[row]), facecolor="none", edgecolor=colour, lw=0.8, alpha=alpha))
    return True


def draw_path(ax, plane, samples, looks, surface=None):
    """The tip's way, framed by where it starts and is in contact, so that a tool thrown away leaves the picture. `surface`:
    its points [m]."""
    names = [f"p{axis}_m" for axis in plane]
    lowest, highest, left = np.full(2, np.inf), np.full(2, -np.inf), False
    for s, one in zip(samples, looks):
        rows = corners(s.trajectory)
        way = np.column_stack([s.trajectory[name] for name in names]) * 1e3
        ax.plot(*way[rows].T, color=one.colour, ls=one.line, lw=min(1, one.width))
        ax.plot(*way[0], marker="o", ms=3.5, mfc="none", color=one.colour)
        touching = np.flatnonzero(s.trajectory["colliding"] > 0)
        if touching.size:
            ax.plot(*way[touching[0]], marker="v", ms=5, color=one.colour)
        framed = way[np.append(touching, 0)] if touching.size else way
        lowest, highest = np.fmin(lowest, framed.min(0)), np.fmax(highest, framed.max(0))
    # A way shorter than 10 µm is numerical noise; it should not fill the picture.
    half = 0.6 * max(float((highest - lowest).max()), 0.01)
    middle = (lowest + highest) / 2
    ax.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half), aspect="equal",
           xlabel=f"tip {plane[0]} [mm]", ylabel=f"tip {plane[1]} [mm]")
    for s in samples:
        way = np.column_stack([s.trajectory[name] for name in names]) * 1e3
        left = left or bool((np.abs(way - middle) > half).any())
    if left:
        ax.set_title("goes on outside", loc="right")
    if surface is not None:
        draw_surface(ax, plane, samples, surface)


def corners(trajectory, spans=300):
    """Rows that keep the shape of a way: the extremes along each axis in so many equal spans of rows."""
    n = len(trajectory["px_m"])
    if n <= 6 * spans:
        return np.arange(n)
    kept = [np.array([0, n - 1])]
    for rows in np.array_split(np.arange(n), spans):
        for name in PATH_COLUMNS:
            part = trajectory[name][rows]
            kept.append(rows[[part.argmin(), part.argmax()]])
    return np.unique(np.concatenate(kept))
