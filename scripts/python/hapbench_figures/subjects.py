"""Appendix D explained: success against what the task checks (ours)."""
import numpy as np

import hapbench_style as style
from hapbench.columns import numbers

from . import published

METHODS = (("original_averaging", "DP"), ("shaped_stiffness", "HS"))
TARGETS = (("vertical", 0, "D2", "centre"), ("vertical", 1, "D1", "0.52 mm aside"), ("rotational", 0, "D3", "3 mm high"),
           ("rotational", 1, "D4", "4 mm high"))
GRACES = ((0.0, "-", "o"), (0.001, (0, (6, 1)), "v"), (0.002, (0, (4, 1.2)), "s"), (0.005, (0, (2, 1)), "^"), (0.01, (0, (1, 1)), "D"),
          (0.1, (0, (1, 3)), "x"))
EVERY_SAMPLE = 2048.0  # where a threshold without a filter is drawn [Hz]


def threshold(results):
    """Success of both algorithms over the bandwidth of the force that is checked."""
    figure, axes = style.panels(1, 4, 2.7, sharey=True)
    range_, graced, table = {}, {}, results.records("checked_force/sweep.csv")
    for ax, (task, place, claim, title) in zip(axes[0], TARGETS):
        for method, short in METHODS:
            rows = [row for row in table if row["scenario"] == f"{task}_peg_in_hole_{method}"]
            cutoff = np.nan_to_num([float(r["hand.task.threshold.cutoff_Hz"].replace("null", "nan")) for r in rows],
                                   nan=EVERY_SAMPLE)
            grace = numbers(rows, "hand.task.threshold.grace_s")
            success = numbers(rows, f"targets.{place}.success_rate.mean")
            range_[claim, short] = success[(cutoff == EVERY_SAMPLE) & (grace == 0)][0], success[cutoff == 30].max()
            graced[claim, short] = success[(cutoff == EVERY_SAMPLE) & (grace == 0.01)][0]
            for value, line, marker in GRACES:
                own = np.flatnonzero(grace == value)[np.argsort(cutoff[grace == value])]
                ax.plot(cutoff[own], success[own], color=style.look(method).colour, ls=line, marker=marker, ms=3,
                        label=f"DP, grace {1e3 * value:g} ms" if short == "DP" else None if value else "HS, every grace")
            id_ = f"{claim}.success.{method}"
            ax.errorbar([4500 if short == "DP" else 6500], [published.value(id_)], yerr=[published.spread(id_)], **style.PUBLISHED)
        ax.set(xscale="log", title=title, xlabel="cut-off [Hz]", xlim=(22, 9000), ylim=(-0.05, 1.08))
        ax.set_xticks([30, 100, 300, 1000, EVERY_SAMPLE], ["30", "100", "300", "1000", "every\nsample"], rotation=60)
        ax.minorticks_off()
    axes[0, 0].set_ylabel("success rate")
    axes[0, 0].legend(loc="lower left", fontsize=5.5, ncol=1)
    style.letter(axes[0])
    said = ", ".join(f"{title} {range_[claim, 'DP'][0]:.2f}, {graced[claim, 'DP']:.2f} and {range_[claim, 'DP'][1]:.2f}"
                     for _, _, claim, title in TARGETS)
    return figure, {"success": said}
