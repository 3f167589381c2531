"""The picture of `tune`: stiffness against depth and against vibration, and the two against each other with the Pareto front of what
is feasible; the choice of each law marked."""
import numpy as np

from hapbench_figures.performance import LOOKS, number_ticks, with_room
from hapbench_figures.results import numbers
from hapbench_looks import look
from hapbench_report.json_input import InputError
from hapbench_style import BLACK, GREY, panels

from .given import axis

TRIALS, LAWS = "tune_trials.csv", "tune.csv"
STIFFNESS, DEPTH, VIBRATION = "stiffness_N_per_m", "inside_max_m", "force_rms_above_30Hz_N"


def draw_tune(results):
    """Filled marks are feasible, hollow ones settled but without the margin or beyond a limit."""
    trials, laws = results.records(TRIALS), results.records(LAWS)
    figure, ((left, middle, right),) = panels(1, 3, 3.0)
    shown = np.empty((0, 3))
    for i, law in enumerate(laws):
        rows = [row for row in trials if row["algorithm"] == law["algorithm"] and row[VIBRATION]]
        values = np.column_stack([numbers(rows, name) * unit for name, unit in ((STIFFNESS, 1.0), (DEPTH, 1e3), (VIBRATION, 1.0))])
        feasible = np.array([row["feasible"] == "true" for row in rows], dtype=bool)
        shown = np.vstack([shown, values])
        colour, mark, _ = LOOKS[i % len(LOOKS)]
        chosen = np.isclose(values[:, 0], float(law[STIFFNESS] or "nan"), rtol=1e-12)
        for ax, x, y in ((left, 0, 1), (middle, 0, 2), (right, 1, 2)):
            for which, face in ((~feasible, "white"), (feasible, colour)):
                ax.plot(values[which, x], values[which, y], ls="none", marker=mark, ms=3.5, color=colour, mfc=face)
            ax.plot(values[chosen, x], values[chosen, y], ls="none", marker="o", ms=10, color=BLACK, mfc="none", zorder=4)
        left.plot([], [], ls="none", marker=mark, color=colour, label=look(law["algorithm"]).label)
        front = pareto(values[feasible][:, 1:])
        right.plot(front[:, 0], front[:, 1], color=colour, lw=1.0, zorder=1)
    if not shown.size:
        raise InputError("nothing to draw: no trial is settled; tune.csv says why")
    left.plot([], [], ls="none", marker="o", ms=10, color=BLACK, mfc="none", label="the choice")
    left.plot([], [], ls="none", marker="s", color=GREY, mfc="white", label="not feasible")
    names = (axis(STIFFNESS), "deepest inside [mm]", "force above 30 Hz [N rms]")
    for ax, x, y in ((left, 0, 1), (middle, 0, 2), (right, 1, 2)):
        ax.set(xscale="log", yscale="log", xlabel=names[x], ylabel=names[y])
        for i, limits in ((x, ax.set_xlim), (y, ax.set_ylim)):
            column = shown[np.isfinite(shown[:, i]) & (shown[:, i] > 0), i]
            if column.size:
                limits(with_room(column.min(), column.max()))
        number_ticks(ax)
    left.legend(loc="lower left", bbox_to_anchor=(0, 1), ncol=4).set_in_layout(False)  # it is wider than its panel
    middle.set_title(" \n" * ((len(laws) + 5) // 4))  # its room
    return figure


def pareto(points):
    """Those that no other is below in both, by the first coordinate."""
    points = points[np.all(np.isfinite(points), axis=1)]
    front, least = [], np.inf
    for point in points[np.lexsort((points[:, 1], points[:, 0]))]:
        if point[1] < least:
            front.append(point)
            least = point[1]
    return np.array(front).reshape(-1, 2)
