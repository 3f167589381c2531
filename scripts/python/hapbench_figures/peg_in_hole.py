"""The planar peg-in-hole simulations (figures A.1, A.2, F.5 and B.3.3)."""
import numpy as np

from . import published, scene, style


def simulation_view(results):
    sweep = scene.Sweep(results, "tilt_sweep_shaped_stiffness")
    step = sweep.step_at(0.18)
    contacts, peg, force = sweep.contacts(step), sweep.peg(step), sweep.force(step, "f")
    figure, axes = style.panels(1, 1, 4.2)
    ax = axes[0, 0]
    scene.draw_hole(ax, sweep.scenario["environment"], points=True)
    scene.draw_peg(ax, peg)
    scene.draw_segments(ax, contacts, [style.VERMILION] * len(contacts.depth))
    scene.draw_arrow(ax, scene.MM * peg.tip, 0.35 * force, style.SKY)
    scene.frame(ax, (-3.6, 3.6), (-5.5, 2.1))
    ax.text(-3.4, -0.25, "point shell", color=style.BLUE, va="top")
    ax.text(0.75, -1.1, "contacts and depths", color=style.VERMILION)
    head = scene.MM * peg.tip + 0.35 * force
    ax.annotate(
        f"rendered force, {np.linalg.norm(force):.1f} N",
        xy=head,
        xytext=(0.75, -1.9),
        color="#1B6E9C",
        arrowprops={"arrowstyle": "-", "color": style.SKY, "lw": 0.6},
    )
    ax.text(1.45, 1.35, "tool")
    return figure, (
        "The planar simulation: point shell (blue), tool (black), colliding points with their depths (vermilion) "
        f"and the rendered force (light blue) of stiffness shaping, peg tilted by {sweep.tilt[step]:.2f} rad. Ours; "
        "the pose is prescribed."
    )


def draw_run(ax, results, name, colour):
    scenario = results.json(f"thesis/{name}/scenario.effective.json")
    rows = results.table(f"thesis/{name}/trajectory.csv")
    scene.draw_hole(ax, scenario["environment"])
    tool = scenario["tool"]
    steps = np.unique(np.linspace(0, len(rows["px_m"]) - 1, 6).astype(int))
    for i, step in enumerate(steps):
        tip = np.array([rows["px_m"][step], rows["py_m"][step]])
        axis = np.array([rows["axis_x"][step], rows["axis_y"][step]])
        peg = scene.Peg(tip, axis, tool["diameter_m"], tool["length_m"])
        shade = 0.25 + 0.75 * i / max(len(steps) - 1, 1)
        scene.draw_peg(ax, peg, lw=0.8, alpha=shade)
    ax.plot(1e3 * rows["px_m"], 1e3 * rows["py_m"], color=colour, lw=1.5, zorder=6)
    return rows


def trajectories(results):
    figure, axes = style.panels(2, 2, 5.0, gridspec_kw={"height_ratios": [1.75, 1]})
    for j, (algorithm, title) in enumerate(
        (("original_averaging", "original algorithm"), ("shaped_stiffness", "stiffness shaping"))
    ):
        look = style.ALGORITHMS[algorithm]
        rows = draw_run(axes[0, j], results, f"peg_in_hole_2d_{algorithm}", style.GREEN)
        scene.frame(axes[0, j], (-3.6, 3.6), (-5.4, 3.4))
        axes[0, j].set_title(title)
        summary = results.json(f"thesis/peg_in_hole_2d_{algorithm}/summary.json")
        reversals = summary["metrics"]["force_reversals"]
        ax = axes[1, j]
        ax.plot(1e3 * rows["time_s"], rows["vx_m_per_s"], color=look.colour, lw=1)
        ax.plot(1e3 * rows["time_s"], rows["vy_m_per_s"], color=style.SKY, lw=1, ls=(0, (3, 1)))
        ax.set(
            xlabel="time [ms]", ylabel="velocity [m/s]", title="velocity of the tip", xlim=(0, 270), ylim=(-0.13, 0.27)
        )
        style.note(ax, 0.98, 0.96, f"{reversals} force reversals in {summary['steps']} steps", ha="right")
    style.note(axes[1, 1], 0.98, 0.72, "solid: x, dashed: y", ha="right", va="bottom")
    style.letter(axes.flat)
    return figure, (
        "A peg as wide as its hole is tilted at constant speed; outlines at six equally spaced times and the "
        "trajectory of the tip (green). (a) The original algorithm vibrates and throws the peg out, (b) stiffness "
        "shaping moves it out smoothly; (c, d) the velocity of the tip. Ours, parameters of Table A.1 and the friction of "
        'Table B.1; published: "an obvious vibration" and "a smooth motion" (Fig. A.2).'
    )


def draw_forces(ax, sweep, step, weight):
    contacts = sweep.contacts(step)
    scene.draw_hole(ax, sweep.scenario["environment"])
    scene.draw_peg(ax, sweep.peg(step), edgecolor=style.GREY)
    k = sweep.scenario["rendering"]["stiffness_N_per_m"]
    forces = -k * (weight * contacts.depth)[:, None] * contacts.gradient
    out = contacts.gradient[:, 1] < -0.1  # with an upward component of the force
    for point, force, outward in zip(scene.MM * contacts.point, forces, out):
        scene.draw_arrow(
            ax,
            point,
            0.045 * force,
            style.VERMILION if outward else style.GREY,
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
            f"total force ({total[0]:.0f}, {total[1]:.0f}) N\nelastic energy "
            f"{energies[-1] / energies[0]:.2f} of before",
            va="bottom",
        )
    style.note(axes[0, 0], 0.02, 0.97, "pushing out", style.VERMILION)
    style.note(axes[0, 0], 0.02, 0.91, "pushing sideways", style.GREY)
    axes[0, 1].set_ylabel("")
    style.letter(axes[0])
    return figure, (
        "Spring forces of the contacts (a) before and (b) after tandpasta redistributes the elastic energy: forces "
        "that fight each other (grey) lose weight, those that push the peg out (vermilion) gain it, the energy "
        f"stays the same, and the outward force grows {outward[1] / outward[0]:.1f}-fold. Arrows to one scale. Ours; the "
        "pose is prescribed."
    )


def turned_direction(results):
    rows = results.table("thesis/gradient_flip/trajectory.csv")
    figure, axes = style.panels(1, 2, 2.3)
    time = 1e3 * rows["time_s"]
    stiffness = results.json("thesis/gradient_flip/scenario.effective.json")["rendering"]["stiffness_N_per_m"]
    unit = rows["depth_max_m"][0]
    axes[0, 0].plot(time, rows["colliding"], drawstyle="steps-post", color=style.BLACK)
    axes[0, 0].set(ylabel="contacts", xlabel="time [ms]", title="two more of 21 contacts", ylim=(0, 26))
    axes[0, 1].plot(time, -rows["fspring_x_N"] / (stiffness * unit), drawstyle="steps-post", color=style.VERMILION)
    axes[0, 1].axhline(0, color=style.BLACK, lw=0.6)
    # The thesis tells the sizes, 2n + 1 and 2n + 3, and that the direction turns round.
    size = np.array([published.value("B3.depth.before"), published.value("B3.depth.after")])
    sign = np.sign(-rows["fspring_x_N"][[0, -1]])
    axes[0, 1].plot(
        time[[0, -1]],
        sign * size,
        **{k: v for k, v in style.PUBLISHED.items() if k in ("marker", "mfc", "mec", "ms", "mew", "ls")},
    )
    axes[0, 1].set(ylabel="signed depth / depth of a point", xlabel="time [ms]", title="rendered depth", ylim=(-30, 30))
    style.note(
        axes[0, 0],
        0.98,
        0.08,
        "◇ in (b), published: 2n + 1 = 21, then\n2n + 3 = 23, turned by 180°",
        style.VERMILION,
        ha="right",
        va="bottom",
    )
    style.letter(axes[0])
    return figure, (
        "The original algorithm with ten contacts one way and eleven the other, then two more on the first side "
        "(B.3.3): the rendered depth goes from 21 to 23 times that of a point, and its direction turns round. Ours, "
        "a run of 40 steps; diamonds: the published sizes."
    )
