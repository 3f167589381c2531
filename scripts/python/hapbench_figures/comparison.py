"""Every algorithm on the planar peg-in-hole and on many springs (figures A.4 and A.5), and the cases that the thesis
discusses (4.1, 4.4, 4.6)."""
import numpy as np
from matplotlib.ticker import LogLocator

import hapbench_style as style

from . import published

METRICS = (
    ("force_max_N", "force", "greatest [N]", 1),
    ("velocity_total_variation_m_per_s", "roughness", "total variation\nof velocity [m/s]", 1),
    ("depth_max_m", "depth", "greatest [mm]", 1e3),
    ("steps", "way out", "steps until\nit leaves", 1),
)
COMPARED = "laws_in_hole/comparison.csv"
LEAST_RATIO = 1e-4  # drawn: the original algorithm's may be zero


def algorithms(results):
    rows = results.records(COMPARED)
    figure, axes = style.panels(1, 5, 0.9 + 0.2 * len(rows), sharey=True)
    for y, row in enumerate(reversed(rows)):
        look = style.look(row["algorithm"])
        for ax, (key, _, _, scale) in zip(axes[0], METRICS):
            ax.plot([scale * float(row[key])], [y], marker=look.marker, color=look.colour, ms=5.5)
        ends = np.maximum([float(row["ratio_min"]), float(row["ratio_max"])], LEAST_RATIO)
        axes[0, 4].plot(ends, [y, y], color=look.colour, marker="|", ms=8, lw=2.4)
    for ax, (_, title, label, _) in zip(axes[0], METRICS):
        ax.set(xscale="log", title=title, xlabel=label)
        ax.margins(x=0.12)
        ax.xaxis.set_major_locator(LogLocator(numticks=4))
    axes[0, 2].set(xscale="linear", xlim=(0, 3.4))
    draw_ratio_axis(axes[0, 4], len(rows))
    axes[0, 0].set_yticks(range(len(rows)), [style.look(row["algorithm"]).label for row in reversed(rows)])
    for tick, row in zip(axes[0, 0].get_yticklabels(), reversed(rows)):
        tick.set_color(style.look(row["algorithm"]).colour)
    axes[0, 0].set_ylim(-0.6, len(rows) + 0.6)
    style.letter(axes[0])
    return figure, ("Every algorithm on the planar peg-in-hole of A.1: (a) greatest force, (b) total variation of "
                    "velocity, which vibration makes large, (c) greatest depth, (d) steps until the peg leaves the hole, "
                    "few when it is thrown out, (e) range of the stiffness ratio; dashed: K, dotted: the published bound "
                    "of 4 K that the actuators set (4.3). Ours.")


def draw_ratio_axis(ax, lines):
    """K and the published bound, named above the rows."""
    ax.set(xscale="log", title="stiffness", xlabel="ratio, in units of K")
    bound = published.entries()["C4.ratio"]["at_most"]
    ax.axvline(1, color=style.BLACK, lw=0.7, ls="--")
    ax.axvline(bound, **style.PUBLISHED_LINE)
    ax.text(0.7, -0.5, "K", ha="right", fontsize=7)
    ax.text(0.8 * bound, lines - 0.35, f"publ. {bound:g} K", color=style.RED, fontsize=7, ha="right")
    ax.margins(x=0.12)
    ax.xaxis.set_major_locator(LogLocator(numticks=4))


def discussion(results):
    figure, axes = style.panels(1, 3, 2.6)
    draw_over_reduction(axes[0, 0], results)
    draw_pure_rotation(axes[0, 1], results)
    draw_parallel_faces(axes[0, 2], results)
    style.letter(axes[0])
    return figure, ("Cases that the thesis discusses without figures. (a) Over-reduction (4.1): of a groove's contacts at "
                    "most one survives the reduction. (b) Pure rotation (4.4): the energy stored in the springs returns, "
                    "and the damping takes nothing. (c) A drill turned between two parallel faces (4.6): the depth grows, "
                    "the force on the drill stays at zero. Ours.")


def draw_over_reduction(ax, results):
    for name, colour, line, label in (("unreduced", style.AMBER, (0, (4, 1.2)), "all"),
                                      ("reduced", style.PETROL, "-", "reduced")):
        rows = results.table(f"thesis/over_reduction_{name}/trajectory.csv")
        ax.plot(-1e3 * rows["px_m"], np.where(rows["rendered"] > 0, rows["rendered"], np.nan), color=colour, ls=line,
                label=label)
    ax.set(yscale="log", xlabel="way into the groove [mm]", ylabel="rendered contacts", title="over-reduction")
    ax.legend(loc="center right")


def draw_pure_rotation(ax, results):
    rows = results.table("thesis/pure_rotation/energy.csv")
    ax.plot(rows["time_s"], 1e3 * rows["stored_J"], color=style.BLACK, label="stored")
    ax.plot(rows["time_s"], 1e3 * np.abs(rows["damping_J"]), color=style.PETROL, ls=(0, (4, 1.2)), label="taken by damping")
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
    right.plot(tilt, force, color=style.PETROL, ls=(0, (4, 1.2)))
    right.set_ylabel("force [N] (dashed)", color=style.PETROL)
    right.set_ylim(0, 0.6)
    right.spines["right"].set_visible(True)
    right.grid(False)


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


def paths(results, kind, published):
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
    return figure, ("Trajectory of a mass on 100 pairs of opposite springs and 10 upward ones, released at (-5, -5) mm, "
                    f"damping and force {published} Grey: stiffness shaping, for comparison. Settled means to stay within "
                    "0.05 mm of the origin (+). Ours, parameters of Table A.3; depths are signed, so that a spring pulls as well "
                    "as it pushes, one of two readings of 2.3 (choice springs.signed).")


def unlimited(results):
    return paths(results, "unlimited", "not limited. Published: every algorithm reaches the origin; ours: what the panels say.")


def limited(results):
    return paths(results, "limited",
                 "limited to 100 N s/m and 30 N. Published: the proposed algorithm keeps its performance, others "
                 "become under-damped.")
