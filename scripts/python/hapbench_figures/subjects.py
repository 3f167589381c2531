"""Appendix D explained: success against what the task checks, and the subjects inferred from two of its tables (ours)."""
import numpy as np

import hapbench_style as style

from . import published
from .results import numbers

METHODS = (("original_averaging", "DP"), ("shaped_stiffness", "HS"))
TARGETS = (("vertical", 0, "D2", "centre"), ("vertical", 1, "D1", "0.52 mm aside"), ("rotational", 0, "D3", "3 mm high"),
           ("rotational", 1, "D4", "4 mm high"))
GRACES = ((0.0, "-", "o"), (0.001, (0, (6, 1)), "v"), (0.002, (0, (4, 1.2)), "s"), (0.005, (0, (2, 1)), "^"), (0.01, (0, (1, 1)), "D"),
          (0.1, (0, (1, 3)), "x"))
EVERY_SAMPLE = 2048.0  # where a threshold without a filter is drawn [Hz]
MEASURES = (("success", "success rate", 1), ("time", "completion time [s]", 1), ("force", "model force [N]", 1),
            ("speed", "velocity [mm/s]", 1e3))


def threshold(results):
    """Success of both algorithms over the bandwidth of the force that is checked."""
    figure, axes = style.panels(1, 4, 2.7, sharey=True)
    range_, graced = {}, {}
    for ax, (task, place, claim, title) in zip(axes[0], TARGETS):
        for method, short in METHODS:
            rows = results.records(f"threshold/{task}_{method}/sweep.csv")
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
    return figure, ("Success of six simulated subjects, one trial each, over the low-pass and the grace (line style) of the force "
                    "that the task checks against 1 N: the model reaction force along z, whose every sample counts when the "
                    "instruction is read literally. Diamonds: published, DP left, HS right. The original algorithm (DP) with "
                    f"every sample, with every sample and dips of 10 ms forgiven, and at best with 30 Hz: {said}. Its vibration "
                    "is what the subjects fail on: the failure is the threshold's. Ours.")


def posterior_panel(ax, unknowns, rows):
    """Where in its range each unknown lies: the posterior's samples, 5 to 95 % and median."""
    names = []
    for y, u in enumerate(reversed(unknowns)):
        scale = np.log if u["scale"] == "log" else np.asarray
        low, high = scale(u["range"])
        place = lambda v: (scale(v) - low) / (high - low)  # noqa: B023,E731  (used at once)
        ax.plot(place(numbers(rows, u["field"])), np.full(len(rows), y), "|", color=style.GREY, ms=4)
        ax.plot(place([u["q05"], u["q95"]]), [y, y], color=style.PETROL, lw=2)
        ax.plot(place([u["q50"]]), [y], "o", color=style.PETROL, mec="white", ms=5)
        names.append(f"{u['field'].rpartition('.')[2]}\n{u['range'][0]:g} … {u['range'][1]:g}")
    ax.set_yticks(range(len(names)), names, fontsize=5.5)
    ax.set(xlim=(-0.02, 1.02), xticks=[0, 1], title="posterior in the prior's range")
    ax.set_xticklabels(["least", "greatest"])


def beside_panel(ax, beside, name, scale):
    own = [b for b in beside if f".{name}." in b["id"]]
    order = [f"{d}.{name}.{m}" for d in ("D1", "D2", "D3", "D4") for m, _ in METHODS]
    for x, id_ in enumerate(order):
        b = next(b for b in own if b["id"] == id_)
        look = style.look(id_.rpartition(".")[2])
        if b["mean"] is not None:
            ax.errorbar([x - 0.15], [scale * b["mean"]], yerr=[scale * b["standard_error"]], marker=look.marker, ms=4, capsize=2,
                        color=look.colour, mfc=look.colour if b["fitted"] else "white")
        ax.errorbar([x + 0.2], [scale * b["published"]], yerr=[scale * b["published_standard_error"]], **style.PUBLISHED)
    ax.set_xticks(range(len(order)), [f"{i[:2]} {'DP' if 'original' in i else 'HS'}" for i in order], rotation=70, fontsize=6)


def trace_panel(ax, trace, target, limit):
    time = np.array(trace["time_s"])
    ax.fill_between(time, trace["least_N"], trace["greatest_N"], color=style.AMBER, alpha=0.5, lw=0)
    ax.axhline(limit, color=style.BLACK, ls="--", lw=0.8)
    ax.set(ylim=(-2, 6), xlabel="time [s]", ylabel="force along z [N]",
           title=f"{dict(METHODS)[trace['algorithm']]}: {'removed' if trace['removed'] else 'missed'}")
    right = ax.twinx()
    right.plot(time, 1e3 * (np.array(trace["z_m"]) - target), color=style.PETROL, lw=1)
    right.set(ylim=(-2, 2), ylabel="tip over target [mm]")
    right.grid(False)


def inferred(results):
    """The posterior of `hapbench reproduce --subjects`."""
    found = results.json("subjects/subjects.json")
    rows = [r for r in results.records("subjects/subjects.csv") if r["distance"]]
    distance = np.sort(numbers(rows, "distance"))
    kept = [r for r in rows if float(r["distance"]) <= found["largest_distance"]]
    figure, axes = style.panels(3, 3, 7.6)
    posterior_panel(axes[0, 0], found["unknowns"], kept)
    axes[0, 1].plot(np.arange(1, len(distance) + 1), distance, color=style.BLACK)
    axes[0, 1].axvspan(0.5, found["posterior"] + 0.5, color=style.PALE)
    axes[0, 1].set(xlabel="samples, nearest first", ylabel="distance", title="distance", ylim=(0, None))
    for ax, (name, label, scale) in zip((axes[0, 2], *axes[1]), MEASURES):
        beside_panel(ax, found["beside"], name, scale)
        ax.set(title=label, **({"yscale": "log"} if name == "speed" else {}))
    for ax, trace in zip(axes[2], found["traces"]):
        trace_panel(ax, trace, -0.002, 1.0)
    axes[2, 2].axis("off")
    out = [b["id"] for b in found["beside"] if not b["within_reach"]]
    verdicts = "\n".join(f"{v['id']}{' (fitted)' if v['fitted'] else ''}: {v['verdict']}" for v in found["verdicts"])
    reach = "\n".join(i.replace("original_averaging", "DP").replace("shaped_stiffness", "HS") for i in out) or "nothing"
    axes[2, 2].text(0, 1, f"verdicts on the nearest six\n{verdicts}\n\nout of reach, by 2 standard errors\n{reach}", fontsize=6.5,
                    va="top")
    style.letter([*axes.flat][:8])
    return figure, ("The subjects of appendix D as far as Tables A.1 and A.3 tell: approximate Bayesian computation over what the "
                    f"thesis does not say, {found['samples']} samples of which {found['given_up']} were given up early. (a) The "
                    f"{found['posterior']} nearest (ticks), 5 to 95 % (bar) and median, each in its range from the literature; "
                    "(b) their distance (shaded) among all that were run to the end; (c–f) the nearest six as subjects, filled "
                    "where the distance is about it, beside the published means (diamonds); (g, h) the nearest subject's first "
                    "try at the target at 3 mm: range of the rendered force in spans of 0.05 s (amber), the 1 N that it must "
                    "keep (dashed), height of the tip (petrol). Ours.")
