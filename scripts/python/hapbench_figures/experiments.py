"""Figures of the thesis's man-machine experiments: simulated subjects beside the published means (thesis Fig. D.7 and
D.8). A figure of this project shows how the success rate depends on the way in which the task checks the force."""
import json
import warnings

import numpy as np

import hapbench_style as style
from hapbench.columns import numbers

from . import scene

MEASURES = (
    ("success", "removed", "success rate", 1),
    ("time", "time_s", "completion time [s]", 1),
    ("force", "model_force_N", "model force [N]", 1),
    ("speed", "speed_m_per_s", "velocity [mm/s]", 1e3),
)
# The two targets of each task: (number of the position in the field `place` of targets.csv, claim, title of the panel).
TARGETS = {
    "vertical": ((1, "D1", "side target (0.52 mm)"), (0, "D2", "central target")),
    "rotational": ((0, "D3", "target at 3 mm"), (1, "D4", "target at 4 mm")),
}
DP, HS = "original_averaging", "shaped_stiffness"
METHODS = ((DP, "DP"), (HS, "HS"))


def subject_means(records, target, column):
    """Returns for each subject the mean of a column over the subject's targets at the position `target`; NaN if the
    subject has no value there."""
    selected = [row for row in records if row["place"] == str(target)]
    subjects = numbers(selected, "subject")
    values = numbers(selected, column)
    with warnings.catch_warnings():
        warnings.simplefilter(
            "ignore", RuntimeWarning
        )  # a subject that was never on the target has no mean
        return np.array([np.nanmean(values[subjects == s]) for s in np.unique(subjects)])


def significance(first, second):
    """Returns a text with the result of the paired t-test of two values of each subject. Subjects with a NaN in `first`
    or `second` are not used."""
    both = np.isfinite(first) & np.isfinite(second)
    difference = (first - second)[both]
    if len(difference) < 2 or np.ptp(difference) == 0:
        return (
            "equal in all subjects"
            if len(difference) and not difference.any()
            else "same difference in all"
        )
    # Imported here, because this import takes a quarter of the start time and few figures need it.
    from scipy.stats import (
        ttest_rel,
    )

    t, p = ttest_rel(first[both], second[both])
    return f"t = {signed(t)}, p {'< 0.001' if p < 0.001 else f'= {p:.3f}'}"


def signed(number):
    """Formats a number with at most three significant digits and a typographic minus sign."""
    return f"{number:.3g}".replace("-", "−")


def published_test(claim):
    entry = scene.PUBLISHED[f"{claim}.p"]
    sign, bound = ("<", entry["at_most"]) if "at_most" in entry else (">", entry["at_least"])
    return f"t = {signed(scene.published(f'{claim}.t'))}, p {sign} {bound:g}"


def questionnaires(results):
    """Returns the figure of the efforts that the thesis publishes (Fig. D.6). The ledger stores these efforts as claim
    D5."""
    results.json("claims.json")
    figure, axes = style.panels(1, 2, 2.2, gridspec_kw={"width_ratios": [2, 1]})
    effort, relative = axes[0]
    ticks = []
    for i, task in enumerate(TARGETS):
        for j, (method, name) in enumerate(METHODS):
            entry = scene.PUBLISHED[f"D5.effort.{task}.{method}"]
            x = 3 * i + j
            effort.errorbar([x], [entry["mean"]], yerr=[entry["standard_error"]], **style.PUBLISHED)
            ticks.append((x, f"{name}\n{task}"))
        entry = scene.PUBLISHED[f"D5.relative_effort.{task}"]
        relative.errorbar([i], [entry["mean"]], yerr=[entry["standard_error"]], **style.PUBLISHED)
    effort.set(title="NASA-TLX", ylim=(0, 100), xlim=(-0.7, 4.7), ylabel="effort, 0 to 100 [1]")
    effort.set_xticks([x for x, _ in ticks], [label for _, label in ticks])
    relative.set(title="HS beside DP", ylim=(0, 1), xlim=(-0.6, 1.6), ylabel="effort, 0 to 1 [1]")
    relative.set_xticks([0, 1], list(TARGETS))
    return style.lettered(figure, axes[0]), {}


def draw_measure(ax, tables, target, claim, measure):
    name, column, _, scale = measure
    both = []
    for x, (method, _) in enumerate(METHODS):
        values = subject_means(tables[method], target, column)
        both.append(values)
        finite = scale * values[np.isfinite(values)]
        look = style.look(method)
        ax.plot(
            x - 0.24 + np.linspace(-0.05, 0.05, len(finite)),
            finite,
            "o",
            color=style.GREY,
            ms=2.2,
            mec="none",
        )
        error = finite.std(ddof=1) / np.sqrt(len(finite)) if len(finite) > 1 else 0
        if len(finite):
            ax.errorbar(
                [x],
                [finite.mean()],
                yerr=[error],
                marker=look.marker,
                color=look.colour,
                ms=5,
                capsize=2.5,
                elinewidth=1.2,
            )
        id_ = f"{claim}.{name}.{method}"
        ax.errorbar(
            [x + 0.24],
            [scale * scene.published(id_)],
            yerr=[scale * scene.spread(id_)],
            **style.PUBLISHED,
        )
    ax.set_xlim(-0.5, 1.5)
    ax.set_xticks([0, 1], [short for _, short in METHODS])
    ax.grid(axis="x", visible=False)
    # The text stands above the frame, because marks inside the frame would cover it.
    test = {"transform": ax.transAxes, "fontsize": 7, "va": "bottom"}
    ax.text(0, 1.09, f"ours: {significance(*both)}", **test)
    ax.text(0, 1.01, f"publ.: {published_test(f'{claim}.{name}')}", color=style.RED, **test)


def experiment(results, task):
    tables = {
        method: results.records(f"thesis/{task}_peg_in_hole_{method}/targets.csv")
        for method, _ in METHODS
    }
    figure, axes = style.panels(2, 4, 5.0, sharex=True, sharey="col")
    for row, (target, claim, title) in zip(axes, TARGETS[task]):
        for ax, measure in zip(row, MEASURES):
            draw_measure(ax, tables, target, claim, measure)
        row[0].set_ylabel(title)
    for ax, measure in zip(axes[0], MEASURES):
        ax.set_title(f"{measure[2]}\n \n ")  # two blank lines leave room for the test results
    for column in axes.T[:3]:
        top = 1.05 * max(ax.dataLim.y1 for ax in column)
        column[0].set_ylim(-0.03 * top, top)
    # One unstable subject is a hundred times as fast as all other subjects.
    axes[0, 3].set_yscale("log")
    style.number_ticks(axes[0, 3].yaxis, (1, 2, 5))
    return style.lettered(figure, axes[0]), {}


CHECKED = (
    ("vertical", 0, "D2", "centre"),
    ("vertical", 1, "D1", "0.52 mm aside"),
    ("rotational", 0, "D3", "3 mm high"),
    ("rotational", 1, "D4", "4 mm high"),
)


def recorded(results, task, target, method):
    """Returns the success rate at a target position in the recorded runs: the fraction of targets that were removed,
    over all subjects. In these runs, the task compares the force of every step with the threshold, without a low-pass
    filter and without a grace period."""
    rows = results.records(f"thesis/{task}_peg_in_hole_{method}/targets.csv")
    return numbers([row for row in rows if row["place"] == str(target)], "removed").mean()


def checked(results, task, target):
    """Yields (cutoff [Hz] or None, grace period [s], success rate) of the original algorithm for each setting of the
    low-pass filter and of the grace period in the sweep."""
    for row in results.records("checked_force/sweep.csv"):
        if row["scenario"] == f"{task}_peg_in_hole_{DP}":
            threshold = json.loads(row["hand.task.threshold"])
            yield threshold["cutoff_Hz"], threshold["grace_s"], float(
                row[f"targets.{target}.success_rate.mean"]
            )


def threshold(results):
    """Draws the success rate of the original algorithm over the grace period, with and without a low-pass filter of the
    checked force, beside the success rate of stiffness shaping."""
    figure, axes = style.panels(1, 4, 2.7, sharey=True)
    texts = []
    for ax, (task, target, claim, title) in zip(axes[0], CHECKED):
        every = recorded(results, task, target, DP)
        others = list(checked(results, task, target))
        graces = [(0.0, every)] + sorted(
            (1e3 * grace, success) for cutoff, grace, success in others if cutoff is None
        )
        slow = [(1e3 * grace, success) for cutoff, grace, success in others if cutoff is not None]
        look = style.look(DP)
        ax.plot(*zip(*graces), color=look.colour, marker="o", label="DP, every sample")
        ax.plot(
            *zip(*slow),
            color=look.colour,
            marker="s",
            mfc="white",
            ls="none",
            ms=5,
            label="DP, 30 Hz",
        )
        ax.axhline(
            recorded(results, task, target, HS),
            color=style.look(HS).colour,
            label="HS, every sample",
        )
        for at, method in ((12, DP), (18, HS)):
            id_ = f"{claim}.success.{method}"
            ax.errorbar([at], [scene.published(id_)], yerr=[scene.spread(id_)], **style.PUBLISHED)
        ax.set_xscale("symlog", linthresh=1, linscale=0.4)
        ax.set(title=title, xlabel="grace [ms]", xlim=(-0.3, 25), ylim=(-0.05, 1.08))
        ax.set_xticks([0, 1, 2, 5], ["0", "1", "2", "5"])
        ax.minorticks_off()
        texts.append(
            f"{title}: {every:.2f}, {graces[-1][1]:.2f} and {max(success for _, success in slow):.2f}"
        )
    axes[0, 0].set_ylabel("success rate")
    axes[0, 3].legend(loc="lower right", fontsize=6)
    return style.lettered(figure, axes[0]), {"success": "; ".join(texts)}
