"""Draws runs into the axes of matplotlib: quantities over time, and a cross-section of the scene with the path of the
tip and the tool. A run has the look of its algorithm. If runs share an algorithm, their line styles differ."""
from dataclasses import dataclass

import numpy as np
from matplotlib.patches import Polygon
from scipy.spatial import cKDTree

from hapbench_looks import Look, look, series
from hapbench_style import LINE, curve, equal_curves, note, reduced, striped

from .given import shown
from .quantities import settled_range

# Colours for a white and for a dark background, in this order: text, background, grid, solid, surface of the solid.
LIGHT = ("#1d2126", "#ffffff", "#e6e6e6", "#EFE8DC", "#8C7A58")
DARK = ("#e7e9ea", "#1c2024", "#383e44", "#4a4438", "#b5a27c")
THIN = 0.6  # line width of the single runs of a group of runs [points]
SPANS = 600  # number of time spans of a curve; a page hardly shows more
# The runs share a linear axis if the largest peak of a run is at most this factor times the smallest peak of a run.
LARGEST_RATIO = 30
# The peaks of the runs are sorted. If a peak exceeds THROWN_RATIO times the previous peak, and at least half of the
# peaks are smaller, the run with this peak and the runs with larger peaks do not influence the axis. A failed run does
# not influence the axis if its peak exceeds FAILED_RATIO times the largest peak of the runs that did not fail.
THROWN_RATIO, FAILED_RATIO = 100, 5
ROUNDING = (
    1e-9  # fraction of a value that an axis must span; a smaller span shows rounding errors only
)
MAX_THROWN = 3  # largest number of runs outside the axis whose largest value is printed in a panel
PANEL = 1.1  # usual height of a panel without its tick labels [inch]
GRID = 400  # number of grid cells along each side of a section, for the filled solid
PATH_COLUMNS, AXIS_COLUMNS = ("px_m", "py_m", "pz_m"), ("axis_x", "axis_y", "axis_z")
SNAPSHOTS = (0.35, 0.5, 0.7, 0.95)  # opacity of the tool at four equally spaced times
PATH_MARKS = "circle: start; square: end; triangle: first touch"
TOOL_OUTLINES = "outlines: the tool at four times"
# The axis of the tool is a unit vector. The tool is drawn only at times at which the component of this vector in the
# plane of the picture is at least MIN_IN_PLANE. The angle between axis and plane is then at most 32 degrees.
MIN_IN_PLANE = 0.85


@dataclass(frozen=True)
class RunLook(Look):
    marker: str = ""  # empty, because curves of runs have no markers
    width: float = 1.3
    group: str = ""  # common label of all runs that differ only in the seed


def looks(runs, labels, groups=()):
    """Returns the RunLook of each run. `groups`: a name for each run; runs that differ only in the seed have the same
    name. If `groups` is empty, the labels are used instead."""
    groups = groups or labels
    distinct = list(dict.fromkeys(zip(groups, (run.algorithm for run in runs))))
    algorithms = [algorithm for _, algorithm in distinct]
    nth = {group: algorithms[:i].count(algorithm) for i, (group, algorithm) in enumerate(distinct)}
    one_each, alike = len(set(algorithms)) == len(distinct), len(set(algorithms)) == 1
    width = RunLook.width if len(distinct) == len(runs) else THIN
    found, many = [], series(len(runs))
    for run, label, group in zip(runs, labels, groups):
        of_law, of_series = look(run.algorithm), many[nth[group]]
        colours = of_series if alike and not one_each else of_law
        found.append(
            RunLook(
                label,
                colours.colour,
                colours.dark,
                of_law.dash if one_each else of_series.dash,
                width=width,
                group=group,
            )
        )
    return found


def settings(paper):
    """Returns the colour settings of matplotlib for `paper`, which is LIGHT or DARK."""
    ink, ground, grid, *_ = paper
    return {
        "text.color": ink,
        "axes.labelcolor": ink,
        "xtick.color": ink,
        "ytick.color": ink,
        "axes.edgecolor": ink,
        "axes.facecolor": ground,
        "figure.facecolor": ground,
        "savefig.facecolor": ground,
        "grid.color": grid,
    }


def draw_over_time(ax, quantity, samples, looks):
    """Draws a quantity over time for each run that has it. Coinciding curves are drawn as stripes."""
    drawn = [(s, one, s.of(quantity)) for s, one in zip(samples, looks)]
    drawn = [(s, one, of) for s, one, of in drawn if of is not None]
    within, thrown = without_thrown(drawn)
    if not share_an_axis(ax, [of[2] for _, _, of in within]):
        cut_off_peaks(ax, quantity, within, bool(thrown))
    mark_thrown(ax, quantity, thrown)
    for (s, one, (time, low, high)), equal in zip(drawn, equal_curves([of for _, _, of in drawn])):
        line = {"color": one.colour, "ls": striped(one.line, *equal)}
        # Also draws a solid thin line, because a peak may fall into a gap of the dashes.
        if one.dash and equal[1] == 1:
            ax.plot(*curve(time, low, high, SPANS), lw=0.4 * one.width, color=one.colour, alpha=0.7)
        if low is high:
            ax.plot(*curve(time, low, high, SPANS), lw=one.width, label=one.label, **line)
        else:
            time, low, high = reduced(time, low, high, SPANS)
            ax.fill_between(time, low, high, color=one.colour, alpha=0.2, lw=0)
            for bound in (low, high):
                ax.plot(
                    time,
                    bound,
                    lw=min(0.8, one.width),
                    label=one.label if bound is low else None,
                    **line,
                )
        mark_first_touch(ax, s, one)
    ax.set_ylabel(quantity.axis)
    ax.margins(x=0.01)
    leave_out_rounding(ax)


def leave_out_rounding(ax):
    """Widens an axis on which only rounding errors of its numbers would be visible, for example if a stiffness ratio is
    always 1."""
    low, high = ax.get_ylim()
    middle = (low + high) / 2
    if high - low < ROUNDING * abs(middle):
        ax.set_ylim(0.9 * middle, 1.1 * middle)


def without_thrown(drawn):
    """Returns two lists of curves: the curves that determine the axis, and the curves of runs whose peaks would flatten
    all other curves."""
    peaks = [peak_of(of[2]) for _, _, of in drawn]
    largest = largest_shown(peaks, [s.failed for s, _, _ in drawn])
    of = list(zip(peaks, drawn))
    return [one for peak, one in of if peak <= largest], [one for peak, one in of if peak > largest]


def largest_shown(peaks, failed):
    """Returns the limit of the peaks of the runs that determine the axis. If there is a gap of THROWN_RATIO between the
    sorted peaks and at least half of the peaks are below the gap, the limit is the largest peak below the gap. If a run
    failed, the limit is at most FAILED_RATIO times the largest peak of the runs that did not fail. Returns infinity if
    neither condition holds."""
    found = sorted(peak for peak in peaks if peak > 0)
    largest = next(
        (
            low
            for count, (low, high) in enumerate(zip(found, found[1:]), 1)
            if high > THROWN_RATIO * low and 2 * count >= len(found)
        ),
        np.inf,
    )
    succeeding = [peak for peak, fails in zip(peaks, failed) if not fails and 0 < peak <= largest]
    if succeeding and any(failed):
        largest = min(largest, FAILED_RATIO * max(succeeding))
    return largest


def peak_of(heights):
    """Returns the largest absolute value of a curve; infinity after an overflow."""
    return float(np.nanmax(np.abs(heights), initial=0.0))


def mark_thrown(ax, quantity, thrown):
    """Marks the point at which each run of `thrown` leaves the axis, and prints the largest values of the first
    MAX_THROWN runs."""
    bottom, top = ax.get_ylim()
    for line, (_, one, (time, low, high)) in enumerate(thrown):
        beyond = np.flatnonzero((high > top) | (low < bottom))
        if not beyond.size:
            continue
        at, above = time[beyond[0]], bool(high[beyond[0]] > top)
        mark = {"marker": "^" if above else "v", "ms": 4, "ls": "none", "clip_on": False}
        ax.plot(at, float(above), **mark, color=one.colour, transform=ax.get_xaxis_transform())
        if line >= MAX_THROWN:
            continue
        peak = max(high.max(), low.min(), key=abs) if len(high) else 0.0
        text = f"{one.label}: to {shown(float(f'{peak:.2g}'))} {quantity.unit}".strip()
        if line == MAX_THROWN - 1 and len(thrown) > MAX_THROWN:
            text += f", and {len(thrown) - MAX_THROWN} more"
        note(ax, 0.98, 0.96 - line * LINE / PANEL, text, one.colour, ha="right")


def share_an_axis(ax, heights):
    """Returns True and makes the axis partly logarithmic if the peaks of the runs differ by more than LARGEST_RATIO.
    The axis is then linear up to about the smallest peak and logarithmic beyond it. Returns False otherwise.
    """
    peaks = [peak for peak in map(peak_of, heights) if peak > 0]
    if peaks and max(peaks) > LARGEST_RATIO * min(peaks):
        # The linear range ends at a power of ten, which has a tick whose label does not overlap the label of 0.
        ax.set_yscale("symlog", linthresh=10.0 ** np.ceil(np.log10(min(peaks))))
        return True
    return False


def cut_off_peaks(ax, quantity, drawn, is_fixed=False):
    """If settled_range() returns a range, sets the axis to this range, and prints the largest peak where it leaves the
    picture. Otherwise, if `is_fixed` is true because curves that are not in `drawn` leave the axis, sets the axis to
    the range of the curves in `drawn`."""
    span = settled_range([(s.settled[quantity.file], low, high) for s, _, (_, low, high) in drawn])
    if span is None:
        if is_fixed:
            lowest = min(float(np.nanmin(low)) for _, _, (_, low, _) in drawn)
            highest = max(float(np.nanmax(high)) for _, _, (_, _, high) in drawn)
            room = 0.08 * (highest - lowest) or 1.0
            ax.set_ylim(lowest - room, highest + room)
        return
    ax.set_ylim(*span)
    at, value, colour = max(
        (
            (time[row], bound[row], one.colour)
            for _, one, (time, *bounds) in drawn
            for bound in bounds
            if np.isfinite(bound).any()
            for row in [np.nanargmax(np.abs(bound))]
        ),
        key=lambda peak: abs(peak[1]),
    )
    ends = [time[end] for _, _, (time, *_) in drawn for end in (0, -1)]
    left, above = at <= (min(ends) + max(ends)) / 2, value > 0
    ax.plot(
        at,
        float(above),
        marker="^" if above else "v",
        ms=4,
        color=colour,
        transform=ax.get_xaxis_transform(),
        clip_on=False,
    )
    ax.annotate(
        f"peak {value:.3g} {quantity.unit}".strip(),
        (at, float(above)),
        xycoords=ax.get_xaxis_transform(),
        color=colour,
        xytext=(5 if left else -5, 1),
        textcoords="offset points",
        fontsize=7,
        ha="left" if left else "right",
        va="bottom",
    )


def mark_first_touch(ax, samples, look):
    at = samples.first_touch_s
    if at is not None:
        ax.axvline(at, color=look.colour, ls=(0, (1, 2)), lw=0.8)
        ax.plot(
            at,
            0,
            marker="v",
            ms=5,
            color=look.colour,
            transform=ax.get_xaxis_transform(),
            clip_on=False,
        )


def tip_of(samples, which=PATH_COLUMNS):
    return np.column_stack([samples.trajectory[name] for name in which])


def framed(samples):
    """Returns the numbers of the rows that a picture of the scene must show: the first row and the rows in contact. If
    no row is in contact, returns the numbers of all rows."""
    touching = np.flatnonzero(samples.trajectory["colliding"] > 0)
    return (
        np.append(touching, 0) if touching.size else np.arange(len(samples.trajectory["colliding"]))
    )


def plane_of(samples):
    """Returns (axis to the right, axis up) of the cross-section, as column numbers of a position: x and y for a planar
    scene. Otherwise up is z, and right is the horizontal axis along which the paths are longer."""
    if all(np.all(s.trajectory["pz_m"] == 0) for s in samples):
        return (0, 1)
    tips = np.vstack([tip_of(s)[framed(s)] for s in samples])
    return (int(np.ptp(tips[:, 1]) > np.ptp(tips[:, 0])), 2)


def draw_section(ax, samples, looks, profile=None, surface=None, paper=LIGHT):
    """Draws a cross-section of the scene with equal scales on both axes, in the plane through the middle of the tips'
    paths: the filled solid, the paths, and the tool of the first run at four times. `profile`: result of tool_profile()
    [m]. `surface`: hapbench_report.replay.Surface."""
    plane, radius = plane_of(samples), max((radius for _, radius in profile or ()), default=0.0)
    tips = np.vstack([tip_of(s)[framed(s)][:, plane] for s in samples])
    low, high = tips.min(0) - 1.3 * radius, tips.max(0) + 0.7 * radius
    # A path shorter than 10 µm is numerical noise and must not fill the picture.
    middle, half = (low + high) / 2, np.maximum(0.53 * (high - low), 6e-6)
    paths = [1e3 * tip_of(s)[:, plane] for s in samples]
    if surface is not None:
        draw_surface(
            ax,
            plane,
            np.median(np.vstack([tip_of(s) for s in samples]), axis=0),
            surface,
            half.max(),
            paper,
        )
    if profile:
        draw_tool(ax, plane, samples[0], profile, looks[0].colour)
    for s, path, one, equal in zip(
        samples, paths, looks, equal_curves([(path,) for path in paths])
    ):
        rows = corners(s.trajectory)
        ax.plot(*path[rows].T, color=one.colour, ls=striped(one.line, *equal), lw=min(1, one.width))
        # White edges separate the marks from the path and the outlines of the tool.
        mark = {"ls": "none", "color": one.colour, "mec": paper[1], "mew": 0.8, "zorder": 3}
        ax.plot(*path[-1], **mark, marker="s", ms=6)
        touching = np.flatnonzero(s.trajectory["colliding"] > 0)
        if touching.size:
            ax.plot(*path[touching[0]], **mark, marker="v", ms=6.5)
        start = {**mark, "mfc": paper[1], "mec": one.colour, "mew": 1.8, "zorder": 4}
        ax.plot(*path[0], **start, marker="o", ms=7)
    low, high = 1e3 * (middle - half), 1e3 * (middle + half)
    # The equal aspect widens one of the two intervals. With fixed limits, matplotlib 3.10 would print a warning.
    ax.set_xlim(low[0], high[0], auto=True)
    ax.set_ylim(low[1], high[1], auto=True)
    ax.set(
        xlabel=f"tip {'xyz'[plane[0]]} [mm]",
        ylabel=f"tip {'xyz'[plane[1]]} [mm]",
    )
    ax.set_aspect("equal", adjustable="datalim")
    ax.grid(False)
    if any((np.abs(path - (low + high) / 2) > (high - low) / 2).any() for path in paths):
        ax.set_title("path continues outside", loc="right")


def surface_text(surface):
    """Returns a list of phrases about the surface in the picture."""
    if surface is None:
        return []
    if surface.is_solid:
        return ["filled: section of the solid through the middle of the path"]
    return ["dots: section of the surface, an open scan, through the middle of the path"]


def draw_surface(ax, plane, middle, surface, reach, paper):
    """Draws the points of the surface near the plane of the section. For a solid, also fills its inside: the positions
    at which the outward normal of the nearest surface point points away from the position. An open surface has no
    inside."""
    points = surface.points
    aside, up = ({0, 1, 2} - set(plane)).pop(), list(plane)
    away, spacing = np.abs(points[:, aside] - middle[aside]), spacing_of(points[:, :3])
    beside = np.abs(points[:, up] - middle[up]).max(axis=1) < 4 * reach
    near = points[(away <= max(1.5 * spacing, 1.01 * away.min())) & beside]
    if not len(near):
        return
    at, outward = near[:, up], near[:, [3 + axis for axis in plane]]
    if surface.is_solid:
        x, y = (
            np.linspace(middle[axis] - 4 * reach, middle[axis] + 4 * reach, GRID) for axis in plane
        )
        cells = np.stack(np.meshgrid(x, y), -1)
        nearest = cKDTree(at).query(cells)[1]
        height = ((cells - at[nearest]) * outward[nearest]).sum(-1)
        ax.contourf(1e3 * x, 1e3 * y, height, levels=(-np.inf, 0), colors=[paper[3]], zorder=0)
    # Rasterised, because thousands of points would make the file large.
    ax.plot(*(1e3 * at).T, ".", color=paper[4], ms=1.8, zorder=0.5, rasterized=True)


def spacing_of(points):
    """Returns the median distance of a point to the nearest point at another position, from a sample of at most 60
    points."""
    squares = [
        ((points - one) ** 2).sum(axis=1)
        for one in points[np.linspace(0, len(points) - 1, min(len(points), 60)).astype(int)]
    ]
    return float(np.sqrt(np.median([square[square > 0].min(initial=np.inf) for square in squares])))


def outline(profile, tip, axis):
    """Returns the outline of the tool [m] in a plane. `tip`, `axis`: position of the tip and axis of the tool,
    projected into the plane. The outline is exact if the axis lies in the plane, otherwise approximate. `profile`:
    result of hapbench_report.recording.tool_profile()."""
    axis = axis / np.linalg.norm(axis)
    s, radius = np.array(profile).T[:, :, None]
    half, across = tip + s * axis, radius * np.array([-axis[1], axis[0]])
    return np.vstack([half + across, (half - across)[::-1]])


def draw_tool(ax, plane, samples, profile, colour):
    """Draws the outline of the tool at four times. Later outlines are more opaque."""
    tip, axis = (tip_of(samples, columns)[:, plane] for columns in (PATH_COLUMNS, AXIS_COLUMNS))
    rows = np.sort(framed(samples))
    rows = rows[np.linalg.norm(axis[rows], axis=1) >= MIN_IN_PLANE]
    if not rows.size:
        return
    for row, alpha in zip(
        rows[np.linspace(0, len(rows) - 1, len(SNAPSHOTS)).astype(int)], SNAPSHOTS
    ):
        ax.add_patch(
            Polygon(
                1e3 * outline(profile, tip[row], axis[row]),
                facecolor="none",
                edgecolor=colour,
                lw=0.9,
                alpha=alpha,
                zorder=1,
            )
        )


def corners(trajectory, spans=300):
    """Returns the numbers of rows that preserve the shape of a path: the extremes along each axis in each of `spans`
    equal parts of the rows."""
    n = len(trajectory["px_m"])
    if n <= 6 * spans:
        return np.arange(n)
    kept = [np.array([0, n - 1])]
    for rows in np.array_split(np.arange(n), spans):
        for name in PATH_COLUMNS:
            part = trajectory[name][rows]
            kept.append(rows[[part.argmin(), part.argmax()]])
    return np.unique(np.concatenate(kept))
