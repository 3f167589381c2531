"""Figures of the planar peg-in-hole simulations (thesis Fig. A.1, A.2, F.5 and B.3.3)."""
import numpy as np

import hapbench_style as style

from . import scene


def simulation_view(results):
    sweep = scene.Sweep(results, "tilt_sweep_shaped_stiffness")
    step = sweep.step_at(0.18)
    tip, force = scene.MM * sweep.peg(step).tip, sweep.force(step, "f")
    figure, ((ax,),) = style.panels(1, 1, 4.2)
    scene.draw_contacts(ax, sweep, step, (-3.6, 3.6), (-5.5, 2.1))
    scene.draw_arrow(ax, tip, 0.35 * force, style.BLACK)
    ax.text(-3.4, -0.25, "point shell", color=style.PETROL, va="top")
    ax.text(0.75, -1.1, "contacts and depths", color=style.AMBER)
    ax.annotate(
        f"rendered force, {np.linalg.norm(force):.1f} N",
        xy=tip + 0.35 * force,
        xytext=(0.75, -1.9),
        arrowprops={"arrowstyle": "-", "color": style.BLACK, "lw": 0.6},
    )
    ax.text(1.45, 1.35, "tool")
    return figure, {"tilt": sweep.tilt[step]}


SNAPSHOTS = 4
RUNS = (("original_averaging", "original algorithm"), ("shaped_stiffness", "stiffness shaping"))


def draw_snapshots(axes, scenario, rows, colour):
    """Draws in each of `axes` the peg at one time, with the path of its tip up to this time. The times are equally
    spaced."""
    steps = np.linspace(0, len(rows["px_m"]) - 1, len(axes)).astype(int)
    for ax, step in zip(axes, steps):
        scene.draw_hole(ax, scenario["environment"])
        scene.draw_peg(ax, scene.peg_of(scenario["tool"], rows, step))
        ax.plot(
            1e3 * rows["px_m"][: step + 1],
            1e3 * rows["py_m"][: step + 1],
            color=colour,
            lw=1.3,
            zorder=6,
        )
        scene.frame(ax, (-1.7, 1.7), (-5.4, 3.4))
        ax.set_title(f"{1e3 * rows['time_s'][step]:.0f} ms", fontsize=7.5)
        ax.set_ylabel("")


def trajectories(results):
    figure, axes = style.panels(
        2, SNAPSHOTS + 1, 5.2, gridspec_kw={"width_ratios": [1] * SNAPSHOTS + [2.7]}
    )
    # Leaves room for the titles above the rows of panels.
    figure.get_layout_engine().set(rect=(0, 0, 1, 0.96), hspace=0.12)
    for line, (algorithm, title), letters in zip(axes, RUNS, ("ab", "cd")):
        look = style.look(algorithm)
        name = f"peg_in_hole_2d_frictionless_{algorithm}"
        rows = results.table(f"thesis/{name}/trajectory.csv")
        reversals, rubbed = (
            results.json(f"thesis/peg_in_hole_2d_{run}{algorithm}/summary.json")
            for run in ("frictionless_", "")
        )
        draw_snapshots(
            line[:-1], results.json(f"thesis/{name}/scenario.effective.json"), rows, look.colour
        )
        line[0].set_ylabel("y [mm]")
        line[0].annotate(
            f"({letters[0]}) {title}",
            (0, 1),
            (0, 18),
            xycoords="axes fraction",
            textcoords="offset points",
            fontsize=8.5,
        ).set_in_layout(False)
        for ax in line[1:-1]:
            ax.set_yticklabels([])
        with_friction = results.table(f"thesis/peg_in_hole_2d_{algorithm}/trajectory.csv")
        draw_velocity(line[-1], rows, with_friction, look.colour)
        line[-1].set_title(
            f"({letters[1]}) {reversals['metrics']['force_reversals']} force reversals, with friction "
            f"{rubbed['metrics']['force_reversals']}"
        )
    return figure, {}


def draw_velocity(ax, rows, with_friction, colour):
    ax.plot(
        1e3 * with_friction["time_s"],
        with_friction["vx_m_per_s"],
        color=style.AMBER,
        lw=2.4,
        alpha=0.5,
        zorder=1,
        label="vx, with friction",
    )
    for name, line in (("x", "-"), ("y", (0, (3, 1)))):
        ax.plot(
            1e3 * rows["time_s"],
            rows[f"v{name}_m_per_s"],
            color=colour if name == "x" else style.GREY,
            lw=1,
            ls=line,
            label=f"v{name}",
        )
    ax.set(xlabel="time [ms]", ylabel="velocity of the tip [m/s]")
    ax.legend(loc="upper right", ncol=3, handlelength=1.6, columnspacing=1, fontsize=7)
    ax.margins(y=0.18)


def draw_forces(ax, sweep, step, weight):
    contacts = sweep.contacts(step)
    scene.draw_hole(ax, sweep.scenario["environment"])
    scene.draw_peg(ax, sweep.peg(step), edgecolor=style.GREY)
    k = sweep.scenario["rendering"]["stiffness_N_per_m"]
    forces = -k * (weight * contacts.depth)[:, None] * contacts.gradient
    out = contacts.gradient[:, 1] < -0.1  # True for contacts whose force has an upward component
    for point, force, outward in zip(scene.MM * contacts.point, forces, out):
        scene.draw_arrow(
            ax,
            point,
            0.045 * force,
            style.AMBER if outward else style.GREY,
            lw=1.3 if outward else 0.7,
            mutation_scale=6,
        )
    scene.frame(ax, (-2.4, 2.4), (-4.3, 2.0))
    return forces, out


def redistribution(results):
    sweep = scene.Sweep(results, "tilt_sweep_tandpasta")
    step = sweep.step_at(0.16)
    contacts = sweep.contacts(step)
    figure, axes = style.panels(1, 2, 4.4, sharey=True)
    energies, outward = [], []
    for ax, weight, title in (
        (axes[0, 0], np.ones_like(contacts.weight), "before: all weights 1"),
        (axes[0, 1], contacts.weight, "after: tandpasta's weights"),
    ):
        forces, out = draw_forces(ax, sweep, step, weight)
        energies.append((weight * contacts.depth**2).sum())
        total = forces.sum(axis=0)
        outward.append(total[1])
        ax.set_title(title)
        style.note(
            ax,
            0.02,
            0.02,
            f"total force ({total[0]:.0f}, {total[1]:.0f}) N\nelastic energy ".replace("-", "−")
            + f"{energies[-1] / energies[0]:.2f} of before",
            va="bottom",
        )
    style.note(axes[0, 0], 0.02, 0.97, "pushing out", style.AMBER)
    style.note(axes[0, 0], 0.02, 0.91, "pushing sideways", style.GREY)
    axes[0, 1].set_ylabel("")
    return style.lettered(figure, axes[0]), {"growth": outward[1] / outward[0]}
