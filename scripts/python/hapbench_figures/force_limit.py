"""Displacement against measured force, with and without the limit of the input force (figure 6)."""
import numpy as np

import hapbench_style as style

from . import published
from .tasks import thin


def force_limit(results):
    figure, axes = style.panels(1, 1, 2.9)
    ax = axes[0, 0]
    stiffness = results.json("thesis/force_limit_on/scenario.effective.json")["rendering"]["stiffness_N_per_m"]
    offset, limit = published.value("L1.offset"), published.value("L1.threshold")
    ideal = np.array([offset, limit + offset, 5.8])
    ax.plot(ideal, 1e3 * (ideal - offset) / stiffness, color=style.BLACK, lw=0.9)
    ax.plot(ideal, 1e3 * np.minimum(ideal - offset, limit) / stiffness, color=style.BLACK, lw=0.9)
    for name, colour, marker in (("off", style.AMBER, "^"), ("on", style.PETROL, "o")):
        rows = results.table(f"thesis/force_limit_{name}/trajectory.csv")
        force = np.sqrt(sum(rows[f"fmeas_{axis}_N"] ** 2 for axis in "xyz"))
        x, y = thin(force, -1e3 * rows["pz_m"], count=110)
        ax.plot(x, y, marker, color=colour, ms=3.2, ls="none", alpha=0.8, mec="none")
    style.note(ax, 0.13, 0.42, "black: ideal, (force − 0.7 N) / K")
    threshold = published.value("L1.measured")
    ax.axvline(threshold, **style.PUBLISHED_LINE)
    ax.set(xlabel="measured force [N]", ylabel="displacement into the flat [mm]", xlim=(0.5, 5.8), ylim=(-0.01, 0.27))
    ax.text(4.0, 0.19, "without limit", color=style.AMBER, ha="right")
    ax.text(4.2, 0.113, "input force limited to 2 N", color=style.PETROL)
    ax.text(threshold + 0.05, 0.245, "published: 2.7 N measured = 2.0 N + 0.7 N weight", color=style.RED, fontsize=7)
    return figure, ("Displacement of the tip into a flat against the measured force, without (amber triangles) and with "
                    "(petrol circles) the limit of the input force; ours, a scripted hand that presses up to 5 N. Black: "
                    "the ideal, (force - 0.7 N)/K. Dotted: the published threshold of 2.7 N measured force, 2.0 N plus 0.7 "
                    "N of weight (3.5).")
