"""The stiffness that the ways of merging contacts give in every direction (figures 2 and C.3)."""
import numpy as np

from . import published, scene, style

SWEEP = "tilt_sweep_shaped_stiffness"
TITLES = {"summation": "sum", "mean": "mean", "virtual_coupling": "coupling", "shaped_stiffness": "shaping"}
DIRECTIONS = np.linspace(0, 2 * np.pi, 361)


def merged(contacts):
    """Name, stiffness tensor in units of K and spring force per K [m] of four laws: closed forms, and for the shaping
    the weights that hapbench recorded."""
    n = len(contacts.depth)
    total, force = contacts.tensor(1.0), -contacts.depth @ contacts.gradient
    # A coupling of stiffness K in series with the contacts.
    series = np.linalg.inv(np.eye(2) + total)
    return (
        ("summation", total, force),
        ("mean", total / n, force / n),
        ("virtual_coupling", series @ total, series @ force),
        ("shaped_stiffness", contacts.tensor(), -(contacts.weight * contacts.depth) @ contacts.gradient),
    )


def field(tensor):
    """Ratio k(e) = e^T S e in each direction, as a curve."""
    e = np.stack([np.cos(DIRECTIONS), np.sin(DIRECTIONS)], 1)
    return e * np.einsum("ij,jk,ik->i", e, tensor, e)[:, None]


def draw_field(ax, name, tensor, contacts):
    """The field and the ratio along each contact, which it returns. The sum needs a scale of its own."""
    reach, ticks = (45, (-40, 0, 40)) if name == "summation" else (1.6, (-1, 0, 1))
    curve = field(tensor)
    limit = published.entries()["C4.ratio"]["at_most"]
    around = np.stack([np.cos(DIRECTIONS), np.sin(DIRECTIONS)], 1)
    ax.fill(*curve.T, facecolor=style.SKY, alpha=0.55, edgecolor=style.BLUE, lw=1.1)
    ax.plot(*(limit * around).T, color=style.GREEN, lw=1.3)
    ax.plot(*around.T, color=style.BLACK, lw=0.8, ls=(0, (3, 2)))
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
    for ax, (name, tensor, _) in zip(axes[0, 1:], merged(contacts)):
        ratio = draw_field(ax, name, tensor, contacts)
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
        "dots and numbers: the ratios along the contacts. The scale of (b) is 28 times that of the others. Ours: "
        "contacts and weights of (e) are hapbench's, (b-d) the laws' closed forms."
    )


def fields_over_tilt(results):
    sweep = scene.Sweep(results, SWEEP)
    tilts = (0.06, 0.2, 0.4)
    figure, axes = style.panels(len(tilts), 5, 5.2, gridspec_kw={"width_ratios": [0.62, 1, 1, 1, 1]})
    for row, tilt in zip(axes, tilts):
        step = sweep.step_at(tilt)
        contacts = draw_contacts(row[0], sweep, step)
        row[0].set_ylabel(f"tilt {sweep.tilt[step]:.2f} rad\ny [mm]")
        for ax, (name, tensor, force) in zip(row[1:], merged(contacts)):
            draw_field(ax, name, tensor, contacts)
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
        "and mean follow the number of points on the side walls, shaping does not. Ours: contacts and the weights "
        "of (e) are hapbench's, (b-d) the laws' closed forms."
    )
