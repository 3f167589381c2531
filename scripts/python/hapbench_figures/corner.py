"""Normal projection at a corner of the hole (figure F.4)."""
import numpy as np

from . import style

STROKES = (
    ("thesis/corner_normal_projection", style.VERMILION, "-", "normal projection"),
    ("thesis/corner_shaped_stiffness", style.BLACK, (0, (4, 1.2)), "shortest distance"),
)
# Not of the thesis, so the figure is drawn without it too.
CONTINUOUS = ("beyond/corner_continuous_normal_projection", style.BLUE, (0, (1, 1)), "continuous (ours)")


def corner(results):
    figure, axes = style.panels(1, 3, 2.5)
    ours = results.has(f"{CONTINUOUS[0]}/trajectory.csv")
    for directory, colour, line, label in (*STROKES, CONTINUOUS) if ours else STROKES:
        rows = results.table(f"{directory}/trajectory.csv")
        x = 1e3 * rows["px_m"]
        force = np.stack([rows[f"f{axis}_N"] for axis in "xyz"], 1)
        change = np.linalg.norm(np.diff(force, axis=0), axis=1)
        axes[0, 0].plot(x, np.linalg.norm(force, axis=1), color=colour, ls=line)
        axes[0, 1].plot(x, 1e3 * rows["depth_max_m"], color=colour, ls=line, label=label)
        axes[0, 2].plot(x[1:], change, color=colour, ls=line, lw=0.9)
    axes[0, 0].set(title="force", ylabel="model force [N]")
    axes[0, 1].set(title="greatest depth", ylabel="depth [mm]")
    axes[0, 2].set(title="change in one step", ylabel="|Δ model force| [N]")
    for ax in axes[0]:
        ax.set_xlabel("tip's way towards the wall [mm]")
    axes[0, 1].legend(loc="upper left", handlelength=1.5, fontsize=6.5, borderaxespad=0.1)
    style.letter(axes[0])
    return figure, (
        "An upright drill is moved steadily against the wall of the hole, near its mouth. With normal projection "
        "(solid) the depth of a point near the rim is at once as large as the way along its normal out of the "
        "drill, and the force jumps in a single step; with the shortest distance (dashed) it grows from zero"
        + (", and so it does with continuous normal projection (dotted)" if ours else "")
        + ". (a) Force, (b) greatest depth, (c) change from step to step. Ours."
    )
