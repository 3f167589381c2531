"""The stiffness that ways of merging contacts give in every direction (figures 2 and C.3, and all algorithms)."""
from textwrap import wrap

import numpy as np
from matplotlib.patches import Circle, Polygon

from . import published, scene, style

SWEEP = "tilt_sweep_shaped_stiffness"
# That sweep, and the wedge, under every algorithm.
PEG, WEDGE = "stiffness/peg", "stiffness/wedge"
TITLES = {"summation": "sum", "mean": "mean", "virtual_coupling": "coupling", "shaped_stiffness": "shaping"}
DIRECTIONS = np.linspace(0, 2 * np.pi, 181)
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


def draw_field(ax, tensor, contacts, reach, ticks):
    """The field and the ratio along each contact, which it returns."""
    curve = field(tensor)
    limit = published.entries()["C4.ratio"]["at_most"]
    ax.fill(*curve.T, facecolor=style.SKY, alpha=0.55, edgecolor=style.BLUE, lw=1.1)
    ax.add_patch(Circle((0, 0), limit, fill=False, edgecolor=style.GREEN, lw=1.3, zorder=2))
    ax.add_patch(Circle((0, 0), 1, fill=False, edgecolor=style.BLACK, lw=0.8, ls=(0, (3, 2)), zorder=2))
    ratio = np.einsum("ij,jk,ik->i", contacts.gradient, tensor, contacts.gradient)
    ax.plot(*(-contacts.gradient * ratio[:, None]).T, ".", color=style.VERMILION, ms=3.5)
    ax.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal", xticks=ticks, yticks=ticks)
    return ratio


def draw_contacts(ax, sweep, step):
    contacts, peg = sweep.contacts(step), sweep.peg(step)
    scene.draw_hole(ax, sweep.scenario["environment"], points=True)
    scene.draw_peg(ax, peg)
    scene.draw_segments(ax, contacts, [style.VERMILION] * len(contacts.depth))
    scene.frame(ax, (-1.3, 1.3), (-4.2, 0.9))
    return contacts


def excessive_stiffness(results):
    sweep = scene.Sweep(results, SWEEP)
    step = sweep.step_at(0.12)
    figure, axes = style.panels(1, 5, 2.15, gridspec_kw={"width_ratios": [0.62, 1, 1, 1, 1]})
    contacts = draw_contacts(axes[0, 0], sweep, step)
    axes[0, 0].set_title("contacts")
    for ax, (name, tensor, _) in zip(axes[0, 1:], merged(results, step)):
        ratio = draw_field(ax, tensor, contacts, *scale(name))
        ax.set_title(TITLES[name])
        ax.set_xlabel("stiffness / K")
        text = f"{ratio.min():.2g} … {ratio.max():.3g}"
        style.note(ax, 0.5, 0.02, text, style.VERMILION, ha="center", va="bottom")
    style.note(axes[0, 1], 0.5, 0.985, "renderable: 4 K", "#00694D", ha="center")
    style.note(axes[0, 4], 0.5, 0.985, "K", ha="center")
    style.letter(axes[0])
    return figure, (
        "Excessive stiffness: (a) a tilted peg in a hole, its contacts (vermilion) and depths; (b-e) the stiffness "
        "in every direction, in units of K, that four ways of merging these contacts give. Green: the published "
        "largest renderable stiffness, 4 K = 80 000 N/m (4.3), outside the frames of (c-e); dashed: K. Vermilion "
        "dots and numbers: the ratios along the contacts. The scale of (b) is 28 times that of the others. Contacts "
        "and tensors are those that the runs recorded. Ours."
    )


def fields_over_tilt(results):
    sweep = scene.Sweep(results, SWEEP)
    tilts = (0.06, 0.2, 0.4)
    figure, axes = style.panels(len(tilts), 5, 5.2, gridspec_kw={"width_ratios": [0.62, 1, 1, 1, 1]})
    for row, tilt in zip(axes, tilts):
        step = sweep.step_at(tilt)
        contacts = draw_contacts(row[0], sweep, step)
        row[0].set_ylabel(f"tilt {sweep.tilt[step]:.2f} rad\ny [mm]")
        for ax, (name, tensor, force) in zip(row[1:], merged(results, step)):
            draw_field(ax, tensor, contacts, *scale(name))
            length = 0.75 * ax.get_xlim()[1]
            scene.draw_arrow(ax, (0, 0), length * force / np.linalg.norm(force), style.BLACK)
            if tilt == tilts[0]:
                ax.set_title(TITLES[name])
            ax.set_xlabel("stiffness / K" if tilt == tilts[-1] else "")
    axes[0, 0].set_title("contacts")
    for ax in axes[:-1, 0]:
        ax.set_xlabel("")
    style.letter(axes[0])
    return figure, (
        "The stiffness field as the peg tilts (rows): contacts (a) and the stiffness in every direction, in units "
        "of K, of four ways of merging them (b-e). Black arrow: direction of the spring force. Green: published "
        "largest renderable stiffness, 4 K; dashed: K; the scale of (b) is 28 times that of the others. Summation "
        "and mean follow the number of points on the side walls, shaping does not. Contacts and tensors are those "
        "that the runs recorded. Ours."
    )


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
    """The faces, at right angles to their springs, and where the tool ends up: at the apex it touches both."""
    for group in run.scenario["environment"]["groups"]:
        x, y = np.array(group["direction"][:2])
        up = np.sign(x) * np.array([-y, x])
        corners = [(0, 0), 4 * up, (4 * x, 4 * up[1]), (4 * x, -4), (0, -4)]
        ax.add_patch(Polygon(corners, closed=True, facecolor="#EFE8DC", edgecolor="none", zorder=0))
        ax.plot(*np.outer((0, 4), up).T, color="#A08F70", lw=0.9)
    tip = scene.MM * run.peg(-1).tip
    ax.plot(*tip, "o", color=style.BLACK, ms=4)
    scene.draw_arrow(ax, tip + (0, 2), (0, -1.7), style.BLACK, "2 N", at=(5, 4))
    scene.frame(ax, (-2.5, 2.5), (-4, 4))
    ax.set_aspect("equal")
    ax.grid(False)


def draw_peg_row(axes, results, names):
    for ax, name in zip(axes[1:], names):
        run = scene.Sweep(results, name, PEG)
        step = run.step_at(PEG_TILT)
        tensor = rendered_tensor(results, f"{PEG}/{name}", step)
        ratio = draw_field(ax, tensor, run.contacts(step), *own_scale(tensor))
        style.note(ax, 0.5, 0.02, f"{ratio.min():.2g} … {ratio.max():.3g}", style.VERMILION, ha="center", va="bottom")
    run = scene.Sweep(results, SHAPING, PEG)
    draw_contacts(axes[0], run, run.step_at(PEG_TILT))


def draw_wedge_row(axes, results, names):
    for ax, name in zip(axes[1:], names):
        run = scene.Sweep(results, name, WEDGE)
        tensor = rendered_tensor(results, f"{WEDGE}/{name}", -1)
        draw_field(ax, tensor, run.contacts(-1), *own_scale(tensor))
        sunk = -scene.MM * run.rows["py_m"][-1]
        style.note(ax, 0.5, 0.02, f"{tensor[1, 1]:.2g} K: {sunk:.2g} mm", style.VERMILION, ha="center", va="bottom")
    draw_wedge(axes[0], scene.Sweep(results, SHAPING, WEDGE))


def of_all_algorithms(results):
    names = [row["algorithm"] for row in results.records(f"{PEG}/comparison.csv")]
    columns = 5
    lines = -(-(1 + len(names)) // columns)  # for each scene
    figure, axes = style.panels(2 * lines, columns, 3.2 * lines)
    for block, draw in ((axes[:lines].ravel(), draw_peg_row), (axes[lines:].ravel(), draw_wedge_row)):
        draw(block, results, names)
        block[0].set_title("contacts")
        for ax, name in zip(block[1:], names):
            ax.set_title("\n".join(wrap(name.replace("_", " "), 20)), fontsize=7)
        for ax in block[len(names) + 1 :]:
            ax.axis("off")
    for ax in axes[-1]:
        ax.set_xlabel("stiffness / K")
    return figure, (
        "Stiffness in every direction, in units of K, of every algorithm: in the tilted peg of Fig. 2 (above; "
        "vermilion: ratios along the contacts, least and greatest) and in a wedge whose faces stand 10 degrees from "
        "its middle plane (below; vermilion: stiffness along the way out and how far 2 N press the tool in within a "
        "second). Dashed: K, green: the published largest renderable stiffness, 4 K (4.3); where a field does not "
        "fit, its panel has a scale of its own. Stiffness shaping gives K along every contact and next to nothing "
        "along the way out, between them: 2 sin² w / (1 + cos² 2w) = 0.032 K. Tensors and contacts are those that "
        "the runs recorded. Ours."
    )
