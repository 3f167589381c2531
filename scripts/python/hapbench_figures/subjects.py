"""Appendix D explained: success against what the task checks (ours)."""
import numpy as np

import hapbench_style as style
from hapbench.columns import numbers

from . import published

TARGETS = (("vertical", 0, "D2", "centre"), ("vertical", 1, "D1", "0.52 mm aside"), ("rotational", 0, "D3", "3 mm high"),
           ("rotational", 1, "D4", "4 mm high"))
GRACES = ((0.0, "-", "o"), (0.002, (0, (4, 1.2)), "s"), (0.005, (0, (1, 1)), "D"))
EVERY_SAMPLE = 2048.0  # where a threshold without a filter is drawn [Hz]


def threshold(results):
    """Success of the original algorithm over the bandwidth of the force that is checked, beside stiffness shaping under every sample."""
    figure, axes = style.panels(1, 4, 2.7, sharey=True)
    said, table = [], results.records("checked_force/sweep.csv")
    for ax, (task, place, claim, title) in zip(axes[0], TARGETS):
        rows = [row for row in table if row["scenario"] == f"{task}_peg_in_hole_original_averaging"]
        cutoff = np.nan_to_num([float(r["hand.task.threshold.cutoff_Hz"].replace("null", "nan")) for r in rows], nan=EVERY_SAMPLE)
        grace = numbers(rows, "hand.task.threshold.grace_s")
        success = numbers(rows, f"targets.{place}.success_rate.mean")
        for value, line, marker in GRACES:
            own = np.flatnonzero(grace == value)[np.argsort(cutoff[grace == value])]
            ax.plot(cutoff[own], success[own], color=style.look("original_averaging").colour, ls=line, marker=marker, ms=3,
                    label=f"DP, grace {1e3 * value:g} ms")
        targets = results.records(f"thesis/{task}_peg_in_hole_shaped_stiffness/targets.csv")
        shaped = np.mean([float(row["removed"]) for row in targets if float(row["place"]) == place])
        ax.axhline(shaped, color=style.look("shaped_stiffness").colour, label="HS, every sample")
        for at, method in ((4500, "original_averaging"), (6500, "shaped_stiffness")):
            id_ = f"{claim}.success.{method}"
            ax.errorbar([at], [published.value(id_)], yerr=[published.spread(id_)], **style.PUBLISHED)
        ax.set(xscale="log", title=title, xlabel="cut-off [Hz]", xlim=(22, 9000), ylim=(-0.05, 1.08))
        ax.set_xticks([30, 100, EVERY_SAMPLE], ["30", "100", "every\nsample"], rotation=60)
        ax.minorticks_off()
        every = cutoff == EVERY_SAMPLE
        said.append(f"{title} {success[every & (grace == 0)][0]:.2f}, {success[every & (grace == GRACES[-1][0])][0]:.2f} and "
                    f"{success[cutoff == 30].max():.2f}")
    axes[0, 0].set_ylabel("success rate")
    axes[0, 0].legend(loc="lower left", fontsize=5.5, ncol=1)
    style.letter(axes[0])
    return figure, {"success": ", ".join(said)}
