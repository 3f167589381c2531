"""Figures of the directional stiffness of several laws (thesis Fig. 2 and C.3), and a figure of all algorithms."""
from textwrap import wrap

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from matplotlib.patches import Circle

import hapbench_style as style

from . import scene

SWEEP = "tilt_sweep_shaped_stiffness"
PEG = "stiffness_peg"  # folder of the results of a sweep over the tilt with every algorithm
TITLES = {
    "summation": "sum",
    "mean": "mean",
    "virtual_coupling": "coupling",
    "shaped_stiffness": "shaping",
}
PEG_TILT = 0.12  # tilt of the peg in figure 2 and in the figure of all algorithms [rad]
DIRECTIONS = np.linspace(0, 2 * np.pi, 73)
FRAME = (-1.3, 1.3), (-4.2, 0.9)  # drawn region of the contacts: x and y from and to [mm]
# Half width of a panel with the curve k(e) of field(), and positions of its ticks, in units of the stiffness K.
REACH, TICKS = 1.6, (-1, 0, 1)
SUMMATION_REACH, SUMMATION_TICKS = 45, (-40, 0, 40)


def rendered_tensor(results, directory, step):
    """Returns the x and y part (2 × 2) of the stiffness tensor S that was rendered in one row."""
    row = {
        name: column[step]
        for name, column in results.table(f"{directory}/stiffness_tensor.csv").items()
    }
    return np.array([[row["sxx"], row["sxy"]], [row["sxy"], row["syy"]]])


def field(tensor):
    """Returns points of the curve k(e) e, with the stiffness ratio k(e) = e^T S e in each direction e."""
    e = np.stack([np.cos(DIRECTIONS), np.sin(DIRECTIONS)], 1)
    return e * np.einsum("ij,jk,ik->i", e, tensor, e)[:, None]


def draw_field(ax, name, tensor, contacts, reach, ticks):
    """Draws the curve k(e) of field() in the algorithm's colour, and a mark for the stiffness ratio along each contact.
    Returns the ratios along the contacts."""
    curve, colour = field(tensor), style.look(name).colour
    limit = scene.PUBLISHED["C4.ratio"]["at_most"]
    ax.fill(*curve.T, facecolor=(*to_rgb(colour), 0.22), edgecolor=colour, lw=1.1)
    ax.add_patch(
        Circle((0, 0), limit, fill=False, edgecolor=style.RED, lw=1.1, ls=(0, (1, 1)), zorder=2)
    )
    ax.add_patch(
        Circle((0, 0), 1, fill=False, edgecolor=style.BLACK, lw=0.8, ls=(0, (3, 2)), zorder=2)
    )
    ratio = np.einsum("ij,jk,ik->i", contacts.gradient, tensor, contacts.gradient)
    ax.plot(*(-contacts.gradient * ratio[:, None]).T, ".", color=style.AMBER, ms=3.5)
    ax.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal", xticks=ticks, yticks=ticks)
    ax.grid(False)
    return ratio


def of_four_laws(results, tilts, height):
    """Draws for each tilt a row of panels: the contacts, and k(e) of four laws. The law `summation` has its own scale.
    Returns the figure and the drawn elements of each law."""
    sweep, drawn = scene.Sweep(results, SWEEP), []
    figure, axes = style.panels(
        len(tilts), 5, height, gridspec_kw={"width_ratios": [0.62, 1, 1, 1, 1]}
    )
    for row, tilt in zip(axes, tilts):
        step = sweep.step_at(tilt)
        contacts = scene.draw_contacts(row[0], sweep, step, *FRAME)
        for ax, (name, title) in zip(row[1:], TITLES.items()):
            tensor = rendered_tensor(results, f"{PEG}/{name}", step)
            reach = (SUMMATION_REACH, SUMMATION_TICKS) if name == "summation" else (REACH, TICKS)
            drawn.append(
                (
                    ax,
                    draw_field(ax, name, tensor, contacts, *reach),
                    scene.Sweep(results, name, PEG).force(step),
                )
            )
            ax.set(
                title=title if row is axes[0] else "",
                xlabel="stiffness / K" if row is axes[-1] else "",
            )
        if row is not axes[-1]:
            row[0].set_xlabel("")
        if len(tilts) > 1:
            row[0].set_ylabel(f"tilt {sweep.tilt[step]:.2f} rad\ny [mm]")
    axes[0, 0].set_title("contacts")
    return style.lettered(figure, axes[0]), axes, drawn


def excessive_stiffness(results):
    figure, axes, drawn = of_four_laws(results, (PEG_TILT,), 2.15)
    for ax, ratio, _ in drawn:
        style.note(
            ax,
            0.5,
            0.02,
            f"{ratio.min():.2g} … {ratio.max():.3g}",
            style.AMBER,
            ha="center",
            va="bottom",
        )
    style.note(axes[0, 1], 0.5, 0.985, "published: 4 K", style.RED, ha="center")
    style.note(axes[0, 4], 0.5, 0.985, "K", ha="center")
    return figure, {}


def fields_over_tilt(results):
    figure, _, drawn = of_four_laws(results, (0.06, 0.2, 0.4), 5.2)
    for ax, _, force in drawn:
        scene.draw_arrow(
            ax, (0, 0), 0.75 * ax.get_xlim()[1] * force / np.linalg.norm(force), style.BLACK
        )
    return figure, {}


def own_scale(tensor):
    """Returns (half width of the panel, ticks): the common scale REACH and TICKS if the curve k(e) fits into it,
    otherwise a larger scale."""
    greatest = np.linalg.eigvalsh(tensor)[-1]
    if greatest < REACH:
        return REACH, TICKS
    tick = float(f"{0.8 * greatest:.0e}")
    return 1.25 * greatest, (-tick, 0, tick)


def of_all_algorithms(results):
    """Draws one panel of k(e) for each algorithm, with the ratios along the contacts as text below. The first panel
    shows the scene."""
    names = [row["algorithm"] for row in results.records(f"{PEG}/comparison.csv")]
    columns = 6
    lines = -(-(1 + len(names)) // columns)
    figure, axes = style.panels(lines, columns, 0.3 + 1.75 * lines)
    run = scene.Sweep(results, "shaped_stiffness", PEG)
    scene.draw_contacts(axes[0, 0], run, run.step_at(PEG_TILT), *FRAME)
    for ax, name in zip(axes.flat[1:], names):
        run = scene.Sweep(results, name, PEG)
        step = run.step_at(PEG_TILT)
        tensor = rendered_tensor(results, f"{PEG}/{name}", step)
        ratio = draw_field(ax, name, tensor, run.contacts(step), *own_scale(tensor))
        ax.set_title(
            "\n".join(wrap(name.replace("_", " "), 15)), fontsize=6.5, color=style.look(name).colour
        )
        ax.set_xlabel(f"{ratio.min():.2g} … {ratio.max():.3g}", fontsize=6.5)
    for ax in axes.flat:
        ax.tick_params(labelsize=6.5)
    for ax in axes.flat[len(names) + 1 :]:
        ax.axis("off")
    style.legend_above(
        figure,
        [
            Line2D([], [], color=style.BLACK, lw=0.8, ls=(0, (3, 2))),
            Line2D([], [], color=style.RED, lw=1.1, ls=(0, (1, 1))),
            Line2D([], [], color=style.AMBER, marker=".", ls="none"),
        ],
        ["K", "published: largest renderable, 4 K", "ratio along a contact"],
    )
    return figure, {}
