"""Appendix D explained: success against what the task checks (ours)."""
import json

import hapbench_style as style

from . import published

TARGETS = (("vertical", 0, "D2", "centre"), ("vertical", 1, "D1", "0.52 mm aside"), ("rotational", 0, "D3", "3 mm high"),
           ("rotational", 1, "D4", "4 mm high"))
DP, HS = "original_averaging", "shaped_stiffness"


def recorded(results, task, place, method):
    """The success of all subjects as the scene checks the force: every sample of it."""
    rows = results.records(f"thesis/{task}_peg_in_hole_{method}/targets.csv")
    removed = [float(row["removed"]) for row in rows if float(row["place"]) == place]
    return sum(removed) / len(removed)


def checked(results, task, place):
    """(cut-off [Hz] or None, grace [s], success) of the original algorithm under other thresholds."""
    for row in results.records("checked_force/sweep.csv"):
        if row["scenario"] == f"{task}_peg_in_hole_{DP}":
            threshold = json.loads(row["hand.task.threshold"])
            yield threshold["cutoff_Hz"], threshold["grace_s"], float(row[f"targets.{place}.success_rate.mean"])


def threshold(results):
    """Success of the original algorithm over grace and bandwidth of the force that is checked, beside stiffness shaping."""
    figure, axes = style.panels(1, 4, 2.7, sharey=True)
    said = []
    for ax, (task, place, claim, title) in zip(axes[0], TARGETS):
        every = recorded(results, task, place, DP)
        others = list(checked(results, task, place))
        graces = [(0.0, every)] + sorted((1e3 * grace, success) for cutoff, grace, success in others if cutoff is None)
        slow = [(1e3 * grace, success) for cutoff, grace, success in others if cutoff is not None]
        look = style.look(DP)
        ax.plot(*zip(*graces), color=look.colour, marker="o", label="DP, every sample")
        ax.plot(*zip(*slow), color=look.colour, marker="s", mfc="white", ls="none", ms=5, label="DP, 30 Hz")
        ax.axhline(recorded(results, task, place, HS), color=style.look(HS).colour, label="HS, every sample")
        for at, method in ((12, DP), (18, HS)):
            id_ = f"{claim}.success.{method}"
            ax.errorbar([at], [published.value(id_)], yerr=[published.spread(id_)], **style.PUBLISHED)
        ax.set_xscale("symlog", linthresh=1, linscale=0.4)
        ax.set(title=title, xlabel="grace [ms]", xlim=(-0.3, 25), ylim=(-0.05, 1.08))
        ax.set_xticks([0, 1, 2, 5], ["0", "1", "2", "5"])
        ax.minorticks_off()
        said.append(f"{title} {every:.2f}, {graces[-1][1]:.2f} and {max(success for _, success in slow):.2f}")
    axes[0, 0].set_ylabel("success rate")
    axes[0, 3].legend(loc="lower right", fontsize=6)
    style.letter(axes[0])
    return figure, {"success": ", ".join(said)}
