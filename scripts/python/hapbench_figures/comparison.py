"""Every algorithm on the planar peg-in-hole, and the cases that the thesis discusses (4.1, 4.4, 4.6)."""
import numpy as np

from . import published, style

METRICS = (
    ("force_max_N", "greatest\nforce [N]", 1),
    ("velocity_total_variation_m_per_s", "total variation of\nvelocity [m/s]", 1),
    ("depth_max_m", "greatest\ndepth [mm]", 1e3),
    ("steps", "steps until\nit leaves", 1),
)


def algorithms(results):
    figure, axes = style.panels(1, 5, 2.7, sharey=True)
    names = list(style.ALGORITHMS)
    y = np.arange(len(names))[::-1]
    for i, name in zip(y, names):
        summary = results.json(f"thesis/peg_in_hole_2d_{name}/summary.json")
        metrics, look = {**summary["metrics"], "steps": summary["steps"]}, style.ALGORITHMS[name]
        for ax, (key, _, scale) in zip(axes[0], METRICS):
            ax.plot([scale * metrics[key]], [i], marker=look.marker, color=look.colour, ms=5.5)
        ax = axes[0, 4]
        ends = np.maximum([metrics["ratio_min"], metrics["ratio_max"]], 1e-4)
        ax.plot(ends, [i, i], color=look.colour, marker="|", ms=9, lw=2.4)
    for ax, (_, title, _) in zip(axes[0], METRICS):
        ax.set(xscale="log", xlabel=title)
    axes[0, 2].set(xscale="linear", xlim=(0, 3.3))
    axes[0, 4].set(xscale="log", xlabel="stiffness\nratio")
    axes[0, 4].axvline(1, color=style.BLACK, lw=0.7, ls="--")
    axes[0, 4].axvline(published.entries()["C4.ratio"]["at_most"], color=style.VERMILION, lw=1, ls=(0, (1, 1.5)))
    axes[0, 0].set_yticks(y, [style.ALGORITHMS[name].label for name in names])
    axes[0, 0].set_ylim(-0.6, len(names) - 0.4)
    style.letter(axes[0])
    return figure, (
        "Every algorithm on the planar peg-in-hole of A.1: (a) greatest force, (b) total variation of velocity, "
        "which vibration makes large, (c) greatest depth, (d) steps until the peg leaves the hole, few when it is "
        "thrown out, (e) range of the stiffness ratio; dotted: the published bound of 4 that the actuators set "
        "(4.3). Ours."
    )


def discussion(results):
    figure, axes = style.panels(1, 3, 2.6)
    draw_over_reduction(axes[0, 0], results)
    draw_pure_rotation(axes[0, 1], results)
    draw_parallel_faces(axes[0, 2], results)
    style.letter(axes[0])
    return figure, (
        "Cases that the thesis discusses without figures. (a) Over-reduction (4.1): of a groove's contacts at most "
        "one survives the reduction. (b) Pure rotation (4.4): the energy stored in the springs returns, and the "
        "damping takes nothing. (c) A drill turned between two parallel faces (4.6): the depth grows, the force on "
        "the drill stays at zero. Ours."
    )


def draw_over_reduction(ax, results):
    for name, colour, line, label in (
        ("unreduced", style.ORANGE, (0, (4, 1.2)), "all"),
        ("reduced", style.BLUE, "-", "reduced"),
    ):
        rows = results.table(f"thesis/over_reduction_{name}/trajectory.csv")
        ax.plot(
            -1e3 * rows["px_m"],
            np.where(rows["rendered"] > 0, rows["rendered"], np.nan),
            color=colour,
            ls=line,
            label=label,
        )
    ax.set(yscale="log", xlabel="way into the groove [mm]", ylabel="rendered contacts", title="over-reduction")
    ax.legend(loc="center right")


def draw_pure_rotation(ax, results):
    rows = results.table("thesis/pure_rotation/energy.csv")
    ax.plot(rows["time_s"], 1e3 * rows["stored_J"], color=style.BLACK, label="stored")
    ax.plot(
        rows["time_s"], 1e3 * np.abs(rows["damping_J"]), color=style.BLUE, ls=(0, (4, 1.2)), label="taken by damping"
    )
    ax.set(xlabel="time [s]", ylabel="energy [mJ]", title="pure rotation")
    ax.set_ylim(top=1.35 * 1e3 * rows["stored_J"].max())
    ax.legend(loc="upper left")


def draw_parallel_faces(ax, results):
    rows = results.table("thesis/parallel_faces/trajectory.csv")
    tilt = np.arctan2(np.abs(rows["axis_x"]), -rows["axis_z"])
    force = np.sqrt(sum(rows[f"f{axis}_N"] ** 2 for axis in "xyz"))
    ax.plot(tilt, 1e3 * rows["depth_max_m"], color=style.BLACK)
    ax.set(xlabel="tilt [rad]", ylabel="greatest depth [mm] (solid)", title="parallel faces", ylim=(0, 0.6))
    right = ax.twinx()
    right.plot(tilt, force, color=style.BLUE, ls=(0, (4, 1.2)))
    right.set_ylabel("force [N] (dashed)", color=style.BLUE)
    right.set_ylim(0, 0.6)
    right.spines["right"].set_visible(True)
    right.grid(False)
