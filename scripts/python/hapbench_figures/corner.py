"""Normal projection at a corner of the hole (figure F.4)."""
import numpy as np

from . import style

STROKES = (
    ("corner_normal_projection", style.VERMILION, "-", "normal projection"),
    ("corner_shaped_stiffness", style.BLACK, (0, (4, 1.2)), "shortest distance"),
)


def corner(results):
    figure, axes = style.panels(1, 3, 2.5)
    for name, colour, line, label in STROKES:
        rows = results.table(f"thesis/{name}/trajectory.csv")
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
        "drill, and the force jumps in a single step; with the shortest distance (dashed) it grows from zero. (a) "
        "Force, (b) greatest depth, (c) change from step to step. Ours."
    )
