"""Normal projection at a corner of the hole (figure F.4)."""
import numpy as np

import hapbench_style as style

# Directory, algorithm, name of its depth; the wide line shows below the one that covers it.
STROKES = (("thesis/corner_normal_projection", "normal_projection", "normal projection", {"lw": 1.1}),
           ("thesis/corner_shaped_stiffness", "shaped_stiffness", "shortest distance", {"lw": 3.2, "alpha": 0.35}))
# Not of the thesis, so the figure is drawn without it too.
CONTINUOUS = (
    "beyond/corner_continuous_normal_projection", "continuous_normal_projection", "continuous (ours)", {"lw": 1.1})


def corner(results):
    figure, axes = style.panels(1, 3, 2.5)
    ours = results.has(f"{CONTINUOUS[0]}/trajectory.csv")
    for directory, algorithm, label, width in (*STROKES, CONTINUOUS) if ours else STROKES:
        rows = results.table(f"{directory}/trajectory.csv")
        line = {"color": style.look(algorithm).colour, **width}
        x = 1e3 * rows["px_m"]
        force = np.stack([rows[f"f{axis}_N"] for axis in "xyz"], 1)
        change = np.linalg.norm(np.diff(force, axis=0), axis=1)
        axes[0, 0].plot(x, np.linalg.norm(force, axis=1), **line)
        axes[0, 1].plot(x, 1e3 * rows["depth_max_m"], **line, label=label)
        axes[0, 2].plot(x[1:], change, **line)
    axes[0, 0].set(title="force", ylabel="model force [N]")
    axes[0, 1].set(title="greatest depth", ylabel="depth [mm]")
    axes[0, 2].set(title="change in one step", ylabel="|Δ model force| [N]")
    for ax in axes[0]:
        ax.set_xlabel("tip's way towards the wall [mm]")
    axes[0, 1].legend(loc="upper left", handlelength=1.5, fontsize=6.5, borderaxespad=0.1)
    style.letter(axes[0])
    return figure, (
        "An upright drill is moved steadily against the wall of the hole, near its mouth. With normal projection "
        "(grey) the depth of a point near the rim is at once as large as the way along its normal out of the "
        "drill, and the force jumps in a single step; with the shortest distance (wide) it grows from zero"
        + (", and so it does with continuous normal projection (brown), which nearly covers it" if ours else "")
        + ". (a) Force, (b) greatest depth, (c) change from step to step. Ours."
    )
