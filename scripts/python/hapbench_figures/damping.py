"""Figures of the directions of damping forces with one contact and with many contacts (thesis Fig. B.4 and B.5), and of
the limit of the input force (Fig. 6)."""
import numpy as np

import hapbench_style as style

from . import scene
from .tasks import thin

DP, HS = "tilt_sweep_original_averaging", "tilt_sweep_shaped_stiffness"
VELOCITY = np.array([0.006, -0.012])  # velocity of the drawn motion, chosen by this project [m/s]
# Viscous friction mu_s [N s/m], and mu_f [s/m], by which the friction increases per newton of spring force (thesis
# Table B.1).
FRICTION = (5.0, 10.0)
TILT = 0.2
MM_PER_N = 0.9


def damping_coefficient(scenario):
    r = scenario["rendering"]
    return 2 * r["damping_ratio"] * np.sqrt(r["stiffness_N_per_m"] * r["mass_kg"])


def draw_forces(ax, at, direction, spring, damping, named_at):
    """Draws the implicit plane, its name, the velocity, and the damping forces at the tip. The damping forces are
    computed by the original algorithm (B.2), which has one direction for all contacts. Coordinates are in millimetres.
    """
    along = np.array([-direction[1], direction[0]])
    ends = np.stack([at - 2 * along, at + 2 * along])
    ax.plot(*ends.T, color=style.PLUM, lw=1.6, zorder=4)
    normal = (VELOCITY @ direction) * direction
    tangential = -(FRICTION[0] + FRICTION[1] * spring) * (VELOCITY - normal)
    scene.draw_arrow(ax, at, 90 * VELOCITY, style.AMBER, "velocity", at=(-14, -9))
    scene.draw_arrow(ax, at, MM_PER_N * (-damping * normal), style.BLACK, "normal")
    upright = abs(direction[0]) < 0.1
    scene.draw_arrow(
        ax,
        at,
        MM_PER_N * tangential,
        style.PETROL,
        "tangential",
        at=(-30, -18) if upright else (6, -10),
    )
    ax.text(*named_at, "implicit\nplane", color=style.PLUM, fontsize=7, va="bottom", zorder=7)


def draw_flat(ax, scenario):
    """Draws the peg that stands on a flat surface, with its damping forces. All gradients point down."""
    damping = damping_coefficient(scenario)
    tool = scenario["tool"]
    peg = scene.Peg(np.zeros(2), np.array([0, -1.0]), tool["diameter_m"], tool["length_m"])
    depth = 1e-4
    surface = -1e3 * (tool["diameter_m"] / 2 - depth)
    ax.axhspan(-4, surface, color=style.SAND, zorder=0)
    ax.axhline(surface, color=style.SOIL, lw=0.9)
    scene.draw_peg(ax, peg)
    ax.set_aspect("equal")
    ax.grid(False)
    draw_forces(
        ax,
        np.zeros(2),
        np.array([0, -1.0]),
        scenario["rendering"]["stiffness_N_per_m"] * depth,
        damping,
        (-1.6, 0.08),
    )
    scene.frame(ax, (-1.7, 1.7), (-1.9, 1.9))
    ax.set_title("one surface")


def draw_distributed(ax, sweep):
    step = sweep.step_at(TILT)
    peg, contacts, force = sweep.peg(step), sweep.contacts(step), sweep.force(step)
    scene.draw_hole(ax, sweep.scenario["environment"])
    scene.draw_peg(ax, peg)
    ax.plot(*(scene.MM * contacts.point).T, ".", color=style.GREY, ms=3)
    size = np.linalg.norm(force)
    draw_forces(
        ax,
        scene.MM * peg.tip,
        -force / size,
        size,
        damping_coefficient(sweep.scenario),
        (-1.9, -3.7),
    )
    scene.frame(ax, (-1.95, 1.45), (-4.6, -1.2 + 0.4))
    ax.set_title("peg in hole")


def wall_damping(ax, results):
    """Draws, over the tilt, the damping coefficient for a motion along the normal of the wall. The unit is B, the
    damping coefficient of the rendering."""
    dp, hs = scene.Sweep(results, DP), scene.Sweep(results, HS)
    pick = np.arange(1, len(dp.tilt))
    forces = np.stack([dp.rows["fspring_x_N"], dp.rows["fspring_y_N"]], 1)[pick]
    along = forces[:, 0] ** 2 / np.maximum(np.einsum("ij,ij->i", forces, forces), 1e-300)
    ax.plot(dp.tilt[pick], along, color=style.look("original_averaging").colour, lw=1.1)
    tensor = results.table("stiffness_peg/shaped_stiffness/stiffness_tensor.csv")
    ax.plot(hs.tilt[pick], tensor["sxx"][pick], color=style.look("shaped_stiffness").colour, lw=1.1)
    ax.text(0.6, 1.06, "stiffness shaping", ha="right")
    ax.text(0.05, 0.3, "original", color=style.look("original_averaging").colour)
    ax.set(
        xlabel="tilt [rad]",
        ylabel="damping across the walls / B",
        ylim=(-0.03, 1.25),
        title="damping across the walls",
    )


def implicit_plane(results):
    figure, axes = style.panels(1, 3, 2.9, gridspec_kw={"width_ratios": [0.8, 0.8, 1]})
    sweep = scene.Sweep(results, DP)
    draw_flat(axes[0, 0], sweep.scenario)
    draw_distributed(axes[0, 1], sweep)
    wall_damping(axes[0, 2], results)
    return style.lettered(figure, axes[0]), {}


def force_limit(results):
    figure, ((ax,),) = style.panels(1, 1, 2.9)
    stiffness = results.json("thesis/force_limit_on/scenario.effective.json")["rendering"][
        "stiffness_N_per_m"
    ]
    offset, limit = scene.published("L1.offset"), scene.published("L1.threshold")
    ideal = np.array([offset, limit + offset, 5.8])
    ax.plot(ideal, 1e3 * (ideal - offset) / stiffness, color=style.BLACK, lw=0.9)
    ax.plot(ideal, 1e3 * np.minimum(ideal - offset, limit) / stiffness, color=style.BLACK, lw=0.9)
    for name, colour, marker in (("off", style.AMBER, "^"), ("on", style.PETROL, "o")):
        rows = results.table(f"thesis/force_limit_{name}/trajectory.csv")
        force = np.sqrt(sum(rows[f"fmeas_{axis}_N"] ** 2 for axis in "xyz"))
        x, y = thin(force, -1e3 * rows["pz_m"], count=110)
        ax.plot(x, y, marker, color=colour, ms=3.2, ls="none", alpha=0.8, mec="none")
    style.note(ax, 0.13, 0.42, "black: ideal, (force − 0.7 N) / K")
    threshold = scene.published("L1.measured")
    ax.axvline(threshold, **style.PUBLISHED_LINE)
    ax.set(
        xlabel="measured force [N]",
        ylabel="displacement into the flat [mm]",
        xlim=(0.5, 5.8),
        ylim=(-0.01, 0.27),
    )
    ax.text(4.0, 0.19, "without limit", color=style.AMBER, ha="right")
    ax.text(4.2, 0.113, "input force limited to 2 N", color=style.PETROL)
    ax.text(
        threshold + 0.05,
        0.245,
        "published: 2.7 N measured = 2.0 N + 0.7 N weight",
        color=style.RED,
        fontsize=7,
    )
    return figure, {}
