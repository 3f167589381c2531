"""The stiffness that ways of merging contacts give in every direction (figures 2 and C.3, and all algorithms)."""
from textwrap import wrap

import numpy as np
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon

import hapbench_style as style

from . import published, scene

SWEEP = "tilt_sweep_shaped_stiffness"
# The same sweep and the wedge, under every algorithm.
PEG, WEDGE = "stiffness_peg", "stiffness_wedge"
TITLES = {"summation": "sum", "mean": "mean", "virtual_coupling": "coupling", "shaped_stiffness": "shaping"}
DIRECTIONS = np.linspace(0, 2 * np.pi, 73)
# Half of a panel's side and the marks on it, in units of K.
REACH, TICKS = 1.6, (-1, 0, 1)
SUMMATION_REACH, SUMMATION_TICKS = 45, (-40, 0, 40)


def merged(results, step):
    """Name, stiffness tensor in units of K and spring force [N] of four laws in the step of the sweep, as recorded."""
    for name in TITLES:
        yield name, rendered_tensor(results, f"{PEG}/{name}", step), scene.Sweep(results, name, PEG).force(step)


def rendered_tensor(results, directory, step):
    """S of one row in the plane, as the algorithm rendered it."""
    row = {name: column[step] for name, column in results.table(f"{directory}/stiffness_tensor.csv").items()}
    return np.array([[row["sxx"], row["sxy"]], [row["sxy"], row["syy"]]])


def field(tensor):
    """Ratio k(e) = e^T S e in each direction, as a curve."""
    e = np.stack([np.cos(DIRECTIONS), np.sin(DIRECTIONS)], 1)
    return e * np.einsum("ij,jk,ik->i", e, tensor, e)[:, None]


def scale(name):
    """The sum needs a scale of its own."""
    return (SUMMATION_REACH, SUMMATION_TICKS) if name == "summation" else (REACH, TICKS)


def draw_field(ax, name, tensor, contacts, reach, ticks):
    """The field in the algorithm's colour and the ratio along each contact, which it returns."""
    curve, colour = field(tensor), style.look(name).colour
    limit = published.entries()["C4.ratio"]["at_most"]
    ax.fill(*curve.T, facecolor=(*to_rgb(colour), 0.22), edgecolor=colour, lw=1.1)
    ax.add_patch(Circle((0, 0), limit, fill=False, edgecolor=style.RED, lw=1.1, ls=(0, (1, 1)), zorder=2))
    ax.add_patch(Circle((0, 0), 1, fill=False, edgecolor=style.BLACK, lw=0.8, ls=(0, (3, 2)), zorder=2))
    ratio = np.einsum("ij,jk,ik->i", contacts.gradient, tensor, contacts.gradient)
    ax.plot(*(-contacts.gradient * ratio[:, None]).T, ".", color=style.AMBER, ms=3.5)
    ax.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal", xticks=ticks, yticks=ticks)
    ax.grid(False)
    return ratio


def draw_contacts(ax, sweep, step):
    contacts, peg = sweep.contacts(step), sweep.peg(step)
    scene.draw_hole(ax, sweep.scenario["environment"], points=True)
    scene.draw_peg(ax, peg)
    scene.draw_segments(ax, contacts, [style.AMBER] * len(contacts.depth))
    scene.frame(ax, (-1.3, 1.3), (-4.2, 0.9))
    return contacts


def excessive_stiffness(results):
    sweep = scene.Sweep(results, SWEEP)
    step = sweep.step_at(0.12)
    figure, axes = style.panels(1, 5, 2.15, gridspec_kw={"width_ratios": [0.62, 1, 1, 1, 1]})
    contacts = draw_contacts(axes[0, 0], sweep, step)
    axes[0, 0].set_title("contacts")
    for ax, (name, tensor, _) in zip(axes[0, 1:], merged(results, step)):
        ratio = draw_field(ax, name, tensor, contacts, *scale(name))
        ax.set_title(TITLES[name])
        ax.set_xlabel("stiffness / K")
        text = f"{ratio.min():.2g} … {ratio.max():.3g}"
        style.note(ax, 0.5, 0.02, text, style.AMBER, ha="center", va="bottom")
    style.note(axes[0, 1], 0.5, 0.985, "published: 4 K", style.RED, ha="center")
    style.note(axes[0, 4], 0.5, 0.985, "K", ha="center")
    style.letter(axes[0])
    return figure, ("Excessive stiffness: (a) a tilted peg in a hole, its contacts (amber) and depths; (b-e) the stiffness "
                    "in every direction, in units of K, that four ways of merging these contacts give. Red: the published "
                    "largest renderable stiffness, 4 K = 80 000 N/m (4.3), outside the frames of (c-e); dashed: K. Amber "
                    "dots and numbers: the ratios along the contacts. The scale of (b) is 28 times that of the others. "
                    "Contacts and tensors are those that the runs recorded. Ours.")


def fields_over_tilt(results):
    sweep = scene.Sweep(results, SWEEP)
    tilts = (0.06, 0.2, 0.4)
    figure, axes = style.panels(len(tilts), 5, 5.2, gridspec_kw={"width_ratios": [0.62, 1, 1, 1, 1]})
    for row, tilt in zip(axes, tilts):
        step = sweep.step_at(tilt)
        contacts = draw_contacts(row[0], sweep, step)
        row[0].set_ylabel(f"tilt {sweep.tilt[step]:.2f} rad\ny [mm]")
        for ax, (name, tensor, force) in zip(row[1:], merged(results, step)):
            draw_field(ax, name, tensor, contacts, *scale(name))
            length = 0.75 * ax.get_xlim()[1]
            scene.draw_arrow(ax, (0, 0), length * force / np.linalg.norm(force), style.BLACK)
            if tilt == tilts[0]:
                ax.set_title(TITLES[name])
            ax.set_xlabel("stiffness / K" if tilt == tilts[-1] else "")
    axes[0, 0].set_title("contacts")
    for ax in axes[:-1, 0]:
        ax.set_xlabel("")
    style.letter(axes[0])
    return figure, ("The stiffness field as the peg tilts (rows): contacts (a) and the stiffness in every direction, in "
                    "units of K, of four ways of merging them (b-e). Black arrow: direction of the spring force. Red: "
                    "published largest renderable stiffness, 4 K; dashed: K; the scale of (b) is 28 times that of the "
                    "others. Summation and mean follow the number of points on the side walls, shaping does not. Contacts "
                    "and tensors are those that the runs recorded. Ours.")


SHAPING = "shaped_stiffness"
PEG_TILT = 0.12  # that of figure 2 [rad]


def own_scale(tensor):
    """The common scale, unless the field does not fit into it."""
    greatest = np.linalg.eigvalsh(tensor)[-1]
    if greatest < REACH:
        return REACH, TICKS
    tick = float(f"{0.8 * greatest:.0e}")
    return 1.25 * greatest, (-tick, 0, tick)


def draw_wedge(ax, run):
    """The faces, at right angles to their springs, and the tool's tip where it ends up: at the apex it touches both."""
    for group in run.scenario["environment"]["groups"]:
        x, y = np.array(group["direction"][:2])
        up = np.sign(x) * np.array([-y, x])
        corners = [(0, 0), 4 * up, (4 * x, 4 * up[1]), (4 * x, -4), (0, -4)]
        ax.add_patch(Polygon(corners, closed=True, facecolor=style.SAND, edgecolor="none", zorder=0))
        ax.plot(*np.outer((0, 4), up).T, color=style.SOIL, lw=0.9)
    tip = scene.MM * run.peg(-1).tip
    ax.plot(*tip, "o", color=style.BLACK, ms=4)
    ax.annotate("tool", tip, (7, -3), textcoords="offset points", fontsize=6.5)
    scene.draw_arrow(ax, tip + (0, 2.2), (0, -1.9), style.BLACK)
    ax.annotate("2 N", tip + (0, 2.2), (0, 2), textcoords="offset points", ha="center", fontsize=6.5)
    scene.frame(ax, (-3.5, 3.5), (-4.2, 2.8))
    ax.set_aspect("equal")
    ax.grid(False)


def draw_in_peg(ax, results, name):
    run = scene.Sweep(results, name, PEG)
    step = run.step_at(PEG_TILT)
    tensor = rendered_tensor(results, f"{PEG}/{name}", step)
    ratio = draw_field(ax, name, tensor, run.contacts(step), *own_scale(tensor))
    return f"{ratio.min():.2g} … {ratio.max():.3g}"


def draw_in_wedge(ax, results, name):
    run = scene.Sweep(results, name, WEDGE)
    tensor = rendered_tensor(results, f"{WEDGE}/{name}", -1)
    draw_field(ax, name, tensor, run.contacts(-1), *own_scale(tensor))
    return f"{tensor[1, 1]:.2g} K\n{-scene.MM * run.rows['py_m'][-1]:.2g} mm"


def draw_scene_of(part, title, results, names, draw):
    """A panel for each algorithm, its numbers below; the first panel is left for the scene."""
    columns = 7
    axes = part.subplots(-(-(1 + len(names)) // columns), columns, squeeze=False)
    part.suptitle(title, fontsize=8.5, x=0.01, ha="left")
    for ax, name in zip(axes.flat[1:], names):
        text = draw(ax, results, name)
        ax.set_title("\n".join(wrap(name.replace("_", " "), 15)), fontsize=6.5, color=style.look(name).colour)
        ax.set_xlabel(text, fontsize=6.5)
        ax.tick_params(labelsize=6.5)
    for ax in axes.flat[len(names) + 1 :]:
        ax.axis("off")
    axes[0, 0].set_title("the scene", fontsize=6.5)
    axes[0, 0].tick_params(labelsize=6.5)
    return axes[0, 0]


def field_legend(figure):
    figure.legend(
        [Line2D([], [], color=style.BLACK, lw=0.8, ls=(0, (3, 2))), Line2D([], [], color=style.RED, lw=1.1, ls=(0, (1, 1))),
         Line2D([], [], color=style.AMBER, marker=".", ls="none")],
        ["K", "published: largest renderable, 4 K", "ratio along a contact"], loc="upper right", ncol=3, handlelength=2.2,
    )


def of_all_algorithms(results):
    names = [row["algorithm"] for row in results.records(f"{PEG}/comparison.csv")]
    lines = -(-(1 + len(names)) // 7)
    figure = style.plt.figure(figsize=(style.WIDTH, 0.3 + 3.2 * lines))
    above, below = figure.subfigures(2, 1)
    figure.get_layout_engine().set(rect=(0, 0, 1, 1 - 0.25 / figure.get_figheight()))
    first = draw_scene_of(above, "(a) in the tilted peg: stiffness / K, and the least and greatest ratio along a contact",
                          results, names, draw_in_peg)
    run = scene.Sweep(results, SHAPING, PEG)
    draw_contacts(first, run, run.step_at(PEG_TILT))
    first = draw_scene_of(below, "(b) in a wedge: stiffness / K; along the way out, and how deep 2 N press the tool in", results,
                          names, draw_in_wedge)
    draw_wedge(first, scene.Sweep(results, SHAPING, WEDGE))
    field_legend(figure)
    return figure, ("Stiffness in every direction, in units of K, of every algorithm: (a) in the tilted peg of Fig. 2, "
                    "below each panel the least and greatest ratio along the contacts (amber); (b) in a wedge whose faces "
                    "stand 10 degrees from its middle plane, below each panel the stiffness along the way out and how far "
                    "2 N press the tool in within a second. Dashed: K, red: the published largest renderable stiffness, 4 "
                    "K (4.3); where a field does not fit, its panel has a scale of its own. Stiffness shaping gives K "
                    "along every contact and next to nothing along the way out, between them: 2 sin² w / (1 + cos² 2w) = "
                    "0.032 K. Tensors and contacts are those that the runs recorded. Ours.")
