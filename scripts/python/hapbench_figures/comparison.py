"""Every algorithm on many springs (figures A.4 and A.5)."""
import numpy as np

import hapbench_style as style


def draw_path(ax, rows, look):
    x, y = 1e3 * rows["px_m"], 1e3 * rows["py_m"]
    ax.plot(x, y, color=look.colour, lw=1.2, clip_on=True)
    ax.plot(x[:1], y[:1], "o", color=look.colour, mfc="white", ms=4)
    ax.plot(0, 0, "+", color=style.BLACK, ms=7, mew=1)


def settling(rows):
    """Time after which the mass stays within 0.05 mm of the origin [ms], or None."""
    far = np.hypot(rows["px_m"], rows["py_m"]) > 5e-5
    if far[-1]:
        return None
    last = np.flatnonzero(far)
    return 1e3 * rows["time_s"][last[-1] + 1] if len(last) else 0.0


def paths(results, kind):
    """Damping and force "limited" or "unlimited"."""
    figure, axes = style.panels(2, 4, 4.3, sharex=True, sharey=True)
    proposed = results.table(f"thesis/springs_{kind}_shaped_stiffness/trajectory.csv")
    own = [name for name in style.ALGORITHMS if results.has(f"thesis/springs_{kind}_{name}/trajectory.csv")]
    for ax, name in zip(axes.flat, own):
        look = style.look(name)
        rows = results.table(f"thesis/springs_{kind}_{name}/trajectory.csv")
        outcome = results.json(f"thesis/springs_{kind}_{name}/summary.json")["outcome"]
        if name != "shaped_stiffness":
            ax.plot(1e3 * proposed["px_m"], 1e3 * proposed["py_m"], color="#8A8A8A", lw=0.9)
        draw_path(ax, rows, look)
        ax.set(xlim=(-6.5, 6.5), ylim=(-6.5, 6.5), aspect="equal", xticks=[-5, 0, 5], yticks=[-5, 0, 5])
        time = settling(rows)
        text = ("diverges" if outcome == "diverges" else f"settles in {time:.0f} ms" if time is not None else "has not settled")
        # Above the frame: some curves fill it.
        ax.set_title(look.label, color=look.colour, pad=14)
        ax.text(0, 1.03, text, transform=ax.transAxes, fontsize=7)
    for ax in axes[-1]:
        ax.set_xlabel("x [mm]")
    for ax in axes[:, 0]:
        ax.set_ylabel("y [mm]")
    return figure, {}
