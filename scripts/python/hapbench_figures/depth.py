"""Figures of depth models: gradients on both sides of the median line of the tool, depths that are too small (thesis
Fig. 8, B.3 and C.1), and normal projection at a corner of the hole (Fig. F.4)."""
import numpy as np
from matplotlib.colors import ListedColormap

import hapbench_style as style

from . import scene

SHORTEST, NORMAL = "tilt_sweep_original_averaging", "tilt_sweep_shaped_stiffness"
DEEP = 0.42  # tilt of the tool at which many contacts lie beyond the median line [rad]
SHALLOW = 0.12
FRAME = (-1.9, 1.9), (-4.3, 1.0)  # drawn region of the contacts [mm]
# The colour map without its yellow end, which is hardly visible on white paper.
TILT_COLOURS = ListedColormap(style.plt.get_cmap("viridis")(np.linspace(0, 0.75, 256)))
# (folder, algorithm, name of its depth model, line style) of each curve. A wide curve remains visible below a curve
# that covers it.
STROKES = (
    ("thesis/corner_normal_projection", "normal_projection", "normal projection", {"lw": 1.1}),
    (
        "thesis/corner_shaped_stiffness",
        "shaped_stiffness",
        "shortest distance",
        {"lw": 3.2, "alpha": 0.35},
    ),
)
# This depth model is not in the thesis. The figure is therefore drawn with this model and without this model.
CONTINUOUS = (
    "run_beyond/corner_continuous_normal_projection",
    "continuous_normal_projection",
    "continuous (ours)",
    {"lw": 1.1},
)


def shortest_distance_and_normal(results):
    figure, axes = style.panels(1, 2, 4.3)
    for ax, name, title in (
        (axes[0, 0], SHORTEST, "shortest distance"),
        (axes[0, 1], NORMAL, "surface normal"),
    ):
        sweep = scene.Sweep(results, name)
        scene.draw_contacts(ax, sweep, sweep.step_at(DEEP), *FRAME, flips=True)
        ax.set_title(title)
    style.note(axes[0, 0], 0.02, 0.98, "flipped gradients", style.PETROL)
    style.note(axes[0, 0], 0.98, 0.04, "dashed: median line", style.GREY, ha="right", va="bottom")
    style.note(
        axes[0, 1],
        0.98,
        0.14,
        "too short: the segments end\ninside the tool",
        style.AMBER,
        ha="right",
    )
    return style.lettered(figure, axes[0]), {"tilt": DEEP}


def gradient_flipping(results):
    figure, axes = style.panels(1, 3, 3.2, gridspec_kw={"width_ratios": [1, 1, 1.15]})
    sweep = scene.Sweep(results, SHORTEST)
    for ax, tilt, title in (
        (axes[0, 0], SHALLOW, "shallow"),
        (axes[0, 1], DEEP, "beyond the median line"),
    ):
        step = sweep.step_at(tilt)
        scene.draw_contacts(ax, sweep, step, *FRAME, flips=True)
        force = sweep.force(step)
        scene.draw_arrow(
            ax, scene.MM * sweep.peg(step).tip, 1.2 * force / np.linalg.norm(force), style.BLACK
        )
        style.note(ax, 0.03, 0.03, f"{np.linalg.norm(force):.1f} N", va="bottom")
        ax.set_title(title)
    axes[0, 1].set_ylabel("")
    draw_flip_count(axes[0, 2], sweep)
    axes[0, 2].set_title("over the tilt")
    return style.lettered(figure, axes[0]), {}


def draw_flip_count(ax, sweep):
    tilt, share, pull = [], [], []
    for step in range(1, len(sweep.tilt)):
        contacts = sweep.contacts(step)
        tilt.append(sweep.tilt[step])
        share.append(contacts.flipped().mean())
        # A gradient along the outward normal pulls the tool into the surface. The mean over the contacts is weighted by
        # depth.
        along = np.einsum("ij,ij->i", contacts.gradient, contacts.normal)
        pull.append(np.average(along, weights=np.maximum(contacts.depth, 1e-12)))
    ax.plot(tilt, share, color=style.PETROL, marker="s", markevery=8)
    ax.plot(tilt, pull, color=style.PLUM, marker="o", markevery=8, ls=(0, (4, 1.2)))
    ax.axhline(0, color=style.BLACK, lw=0.7)
    ax.set(xlabel="tilt [rad]", ylabel="share of contacts | mean pull [1]", ylim=(-1.08, 0.75))
    ax.text(
        tilt[-1], share[-1] + 0.05, "share flipped", color=style.PETROL, ha="right", va="bottom"
    )
    ax.text(0.36, -0.75, "mean pull", color=style.PLUM)
    ax.text(0.03, 0.62, "+1: all pull in", fontsize=7)
    ax.text(0.3, -1.0, "−1: all push off", fontsize=7)


def underestimation(results):
    figure, axes = style.panels(1, 3, 3.0, gridspec_kw={"width_ratios": [0.85, 0.85, 1.3]})
    for ax, name, title in (
        (axes[0, 0], SHORTEST, "shortest distance"),
        (axes[0, 1], NORMAL, "surface normal"),
    ):
        sweep = scene.Sweep(results, name)
        scene.draw_contacts(ax, sweep, sweep.step_at(0.3), *FRAME, flips=True)
        ax.set_title(title)
    axes[0, 1].set_ylabel("")
    draw_error(axes[0, 2], scene.Sweep(results, NORMAL))
    return style.lettered(figure, axes[0]), {}


def draw_error(ax, sweep):
    used, true, tilt = [], [], []
    for step in range(1, len(sweep.tilt), 3):
        contacts, peg = sweep.contacts(step), sweep.peg(step)
        exits = peg.exit_distance(contacts.point, contacts.gradient)
        near = exits < 2 * peg.diameter
        used.append(contacts.depth[near])
        true.append(exits[near])
        tilt.append(np.full(near.sum(), sweep.tilt[step]))
    used, true, tilt = (np.concatenate(part) for part in (used, true, tilt))
    marks = ax.scatter(
        1e3 * true,
        1e3 * (true - used),
        c=tilt,
        cmap=TILT_COLOURS,
        s=6,
        linewidths=0,
        rasterized=True,
    )
    ax.figure.colorbar(marks, ax=ax, label="tilt [rad]", shrink=0.9)
    ax.axvline(1e3 * scene.PUBLISHED["G1.negligible"]["at_most"], **style.PUBLISHED_LINE)
    style.note(ax, 0.22, 0.98, "published: negligible\nup to 0.25 mm", style.RED)
    ax.set(
        xlabel="distance along the normal [mm]",
        ylabel="depth too small by [mm]",
        title="underestimation",
        xlim=(0, 1.3),
        ylim=(-0.02, 0.85),
    )


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
    axes[0, 1].set(title="largest depth", ylabel="depth [mm]")
    axes[0, 2].set(title="change in one step", ylabel="|Δ model force| [N]")
    style.plt.setp(axes[0], xlabel="displacement of the tip\ntowards the wall [mm]")
    axes[0, 1].legend(loc="upper left", handlelength=1.5, fontsize=6.5, borderaxespad=0.1)
    remark = " and with continuous normal projection (brown curve, nearly on the wide curve)"
    return style.lettered(figure, axes[0]), {"continuous": remark if ours else ""}
