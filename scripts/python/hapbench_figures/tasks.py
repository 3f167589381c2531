"""Figures of the three evaluation tasks of thesis 3.2 (Fig. 4, 5, C.2, C.4 and E.1 to E.4), and a figure of this
project about the effect of the point density on task 2."""
import numpy as np

import hapbench_style as style

from . import scene

TASKS = (
    ("T1", "task1_flat", "task 1: poke and drag"),
    ("T2", "task2_rotate", "task 2: rotate in the hole"),
    ("T3", "task3_spin", "task 3: round the wall"),
)
DENSITIES = (("signed_distance", "signed distance"), ("binary", "binary"))
ITERATIONS = (1, 2, 3, 4, 5, 10, 20, 40, 80, 160)
BINS = 240  # number of bins of a time axis; more bins could not be distinguished at column width
FEW_BINS = 38  # number of bins of a time axis if thirty panels share a page


def trajectory(results, task, density="signed_distance"):
    return results.table(f"thesis/{task}_{density}/trajectory.csv")


def ratios(results, task, iteration, density="signed_distance"):
    """Returns the rows of ratios.csv with `iteration` iterations and at least one rendered contact. `density`: the
    depth model, "signed_distance" or "binary", which is the end of the run's name."""
    table = results.table(f"thesis/{task}_{density}/ratios.csv")
    selected = (table["iteration"] == iteration) & (table["rendered"] > 0)
    return {name: column[selected] for name, column in table.items()}


def cases(results, id_):
    """Returns the cases of a claim from the ledger. Each case has a name and numbers."""
    return next(
        claim["cases"] for claim in results.json(scene.LEDGER)["claims"] if claim["id"] == id_
    )


def thin(*columns, count=80):
    """Returns each column reduced to at most `count` evenly spaced rows."""
    pick = np.unique(np.linspace(0, len(columns[0]) - 1, count).astype(int))
    return [column[pick] for column in columns]


def published_count(ax, x, task, what):
    """Draws the published mean and standard deviation of a number of contact points at `x`, the right end of a time
    axis. `what`: "raw" or "reduced"."""
    id_ = f"{task}.{what}"
    ax.errorbar(
        [x],
        [scene.published(id_)],
        yerr=scene.PUBLISHED[id_].get("std"),
        **style.PUBLISHED,
        clip_on=False,
    )


def span(time, values, bins=BINS):
    """Returns (start, smallest value, largest value) of each of `bins` time intervals, by style.reduced()."""
    return style.reduced(time, values, values, bins)


PERIOD = 1 / 2048  # period of the trainer's loop [s]


def loop_load(ax, results, task, duration):
    """Draws the time of a step, in percent of the loop's period, over the time of the run, on a second y axis. Returns
    None if no step times were measured."""
    path = f"step_latency/{task}_signed_distance/timing.json"
    timing = results.json(path) if results.has(path) else {}
    medians = np.array((timing.get("step_latency") or {}).get("over_time_s", []))
    if not len(medians):
        return None
    load = ax.twinx()
    time = (np.arange(len(medians)) + 0.5) * duration / len(medians)
    load.plot(*thin(time[::3], 100 * medians[::3] / PERIOD), ".", color=style.BLACK, ms=1.8)
    # With these limits, the curve lies above the points of the first y axis.
    load.set(yscale="log", ylim=(1e-9, 400), yticks=[0.1, 1, 10, 100])
    load.set_yticklabels(["0.1", "1", "10", "100"])
    if task == "task3_spin" and results.has(scene.LEDGER):
        dense = cases(results, "T5")[0]["values"]
        for name in ("unreduced_3", "reduced_3"):
            load.axhline(100 * dense[name], color=style.BLACK, ls="--", lw=0.8)
    load.minorticks_off()
    load.grid(visible=False)
    load.spines["right"].set_visible(True)
    return load


def point_counts(results):
    figure, axes = style.panels(2, 3, 3.9, sharey=True, sharex="col")
    loads = []
    for row, (density, density_name) in zip(axes, DENSITIES):
        for ax, (id_, task, title) in zip(row, TASKS):
            rows = trajectory(results, task, density)
            time, raw, kept = thin(rows["time_s"], rows["colliding"], rows["rendered"])
            touching = raw > 0
            ax.plot(time[touching], raw[touching], ".", color=style.AMBER, ms=2.5)
            ax.plot(time[touching], kept[touching], "s", color=style.PETROL, ms=1.5)
            end = rows["time_s"][-1]
            published_count(ax, 1.045 * end, id_, "raw")
            published_count(ax, 1.045 * end, id_, "reduced")
            ax.set_xlim(0, 1.08 * end)
            ax.set(yscale="log", ylim=(0.7, 3000))
            if density == DENSITIES[0][0]:
                ax.set_title(title)
                loads.append(loop_load(ax, results, task, end))
        row[0].set_ylabel(f"{density_name}\npoints in contact")
    style.plt.setp(axes[1], xlabel="time [s]")
    for load in filter(None, loads[:-1]):
        load.set_yticklabels([])
    if loads[-1]:
        loads[-1].set_ylabel("loop load [%]")
    style.note(axes[1, 1], 0.03, 0.98, "before the reduction", style.AMBER)
    style.note(axes[1, 1], 0.03, 0.06, "after", style.PETROL, va="bottom")
    if any(loads):
        style.note(axes[0, 0], 0.03, 0.98, "loop load: black dots, right axis")
    style.note(axes[1, 0], 0.97, 0.98, "published mean ± SD ◇", style.RED, ha="right")
    return figure, {}


def count_distribution(results):
    figure, axes = style.panels(1, 2, 2.9, sharey=True)
    for ax, column, what, title in (
        (axes[0, 0], "colliding", "raw", "before the reduction"),
        (axes[0, 1], "rendered", "reduced", "after the reduction"),
    ):
        for index, (id_, task, _) in enumerate(TASKS):
            y = len(TASKS) - index
            for (density, name), above, marker in zip(DENSITIES, (0.2, 0.0), "os"):
                rows = trajectory(results, task, density)
                values = rows[column][rows["colliding"] > 0]
                draw_distribution(ax, y + above, values, marker, name if index == 0 else None)
            for k, suffix in enumerate(("", ".C3")):
                if f"{id_}.{what}{suffix}" in scene.PUBLISHED:
                    entry = scene.PUBLISHED[f"{id_}.{what}{suffix}"]
                    ax.errorbar(
                        [scene.published(entry["id"])],
                        [y - 0.2 - 0.13 * k],
                        xerr=[[entry.get("std", 0)]] * 2,
                        **style.PUBLISHED,
                    )
        ax.set(title=title, xlabel="points in contact", xscale="log")
        ax.set_xlim((1, 1000) if what == "raw" else (0.8, 100))
        ax.set_ylim(0.5, 3.5)
    axes[0, 0].set_yticks([3, 2, 1], [title.replace(": ", ":\n") for _, _, title in TASKS])
    axes[0, 1].legend(
        *axes[0, 0].get_legend_handles_labels(), loc="upper right", bbox_to_anchor=(1, 0.93)
    )
    style.note(axes[0, 1], 0.98, 0.68, "thick: ± SD\nthin: 5 to 95 %", style.PETROL, ha="right")
    style.note(
        axes[0, 1], 0.98, 0.44, "◇ published, 3.3 and C.3\n(mean ± SD)", style.RED, ha="right"
    )
    return style.lettered(figure, axes[0]), {}


def draw_distribution(ax, y, values, marker, label):
    mean, spread = values.mean(), values.std()
    ax.plot(np.percentile(values, [5, 95]), [y, y], color=style.PETROL, lw=0.8)
    ax.plot(
        [max(mean - spread, 0.1), mean + spread],
        [y, y],
        color=style.PETROL,
        lw=2.4,
        solid_capstyle="butt",
    )
    ax.plot(
        [mean], [y], marker, color=style.PETROL, mec="white", ms=5, mew=0.6, label=label, ls="none"
    )


def quantiles(results, column, tasks, density):
    """Returns the percentiles 0, 5, 50, 95 and 100 of a stiffness ratio over all rows of all tasks, with one row for
    each number of iterations."""
    values = (
        np.concatenate([ratios(results, task, iteration, density)[column] for _, task, _ in tasks])
        for iteration in ITERATIONS
    )
    return np.array([np.percentile(of_tasks, [0, 5, 50, 95, 100]) for of_tasks in values])


def draw_quantiles(ax, results, tasks, density="signed_distance"):
    """Draws the percentiles of the largest and of the smallest stiffness ratio over the number of iterations. The
    published range after one iteration is drawn at the left edge."""
    for column, colour, marker, extreme in (
        ("ratio_max", style.PETROL, "o", 4),
        ("ratio_min", style.AMBER, "s", 0),
    ):
        values = quantiles(results, column, tasks, density)
        ax.fill_between(ITERATIONS, values[:, 1], values[:, 3], color=colour, alpha=0.3, lw=0)
        ax.plot(ITERATIONS, values[:, 2], color=colour, marker=marker)
        ax.plot(ITERATIONS, values[:, extreme], color=colour, ls=":", lw=1.1)
    once = scene.PUBLISHED["R1.once"]
    ax.errorbar(
        [0.8],
        [1],
        yerr=[[1 - once["at_least"]], [once["at_most"] - 1]],
        **{**style.PUBLISHED, "marker": "none"},
    )
    ax.axhline(1, color=style.BLACK, ls="--", lw=0.8)


def convergence_by_task(results):
    figure, axes = style.panels(1, 3, 2.5, sharey=True)
    for ax, task in zip(axes[0], TASKS):
        draw_quantiles(ax, results, (task,))
        ax.axhline(scene.PUBLISHED["R1.bound"]["at_most"], **style.PUBLISHED_LINE)
        ax.set(xscale="log", title=task[2], xlabel="iterations", xlim=(0.7, 200), ylim=(0.4, 1.62))
        ax.set_xticks([1, 3, 10, 40, 160], ["1", "3", "10", "40", "160"])
        ax.minorticks_off()
    axes[0, 0].set_ylabel("stiffness ratio")
    style.note(
        axes[0, 0], 0.5, 0.36, "one contact: greatest and\nleast are 1 throughout", ha="center"
    )
    style.note(axes[0, 0], 0.97, 0.92, "published bound 1.5", style.RED, ha="right")
    style.note(axes[0, 1], 0.97, 0.86, "greatest", style.PETROL, ha="right")
    style.note(axes[0, 1], 0.97, 0.3, "least", style.AMBER, ha="right")
    return figure, {}


def convergence(results):
    figure, axes = style.panels(1, 2, 2.7, sharey=True)
    for ax, (density, name) in zip(axes[0], DENSITIES):
        draw_quantiles(ax, results, TASKS[1:], density)
        ax.set(
            xscale="log",
            yscale="log",
            title=f"density: {name}",
            xlabel="iterations",
            xlim=(0.75, 200),
            ylim=(0.42, 1.6),
        )
        ax.set_xticks(
            ITERATIONS,
            [str(i) if i in (1, 2, 3, 5, 10, 20, 40, 80, 160) else "" for i in ITERATIONS],
        )
        ticks = (0.5, 0.6, 0.7, 0.8, 0.9, 1, 1.2, 1.4, 1.6)
        ax.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
        ax.minorticks_off()
    axes[0, 0].set_ylabel("stiffness ratio")
    style.note(
        axes[0, 0],
        0.97,
        0.95,
        "greatest: stays above 1 where\na contact's weight vanishes",
        style.PETROL,
        ha="right",
    )
    style.note(axes[0, 0], 0.97, 0.06, "least: tends to 1", style.AMBER, ha="right", va="bottom")
    return style.lettered(figure, axes[0]), {}


def over_time(draw, label, height=2.6, rows=1):
    """Creates a grid of panels over time, with one column for each of the three tasks. Calls `draw(ax, row, task)` for
    each panel."""
    figure, axes = style.panels(rows, 3, height, sharey="row", sharex="col")
    for j, (_, task, title) in enumerate(TASKS):
        for i in range(rows):
            draw(axes[i, j], i, task)
        axes[0, j].set_title(title)
        axes[-1, j].set_xlabel("time [s]")
    for i, text in enumerate(label):
        axes[i, 0].set_ylabel(text)
    return figure, axes


def positions(results):
    coordinates = (
        ("px_m", "x", style.PETROL, "-"),
        ("py_m", "y", style.AMBER, (0, (4, 1.5))),
        ("pz_m", "z", style.BLACK, "-"),
    )

    def draw(ax, _, task):
        rows = trajectory(results, task)
        for column, name, colour, line in coordinates:
            time, low, high = span(rows["time_s"], 1e3 * rows[column], 2 * FEW_BINS)
            ax.plot(time, (low + high) / 2, color=colour, ls=line, lw=1.1, label=name)
            ax.fill_between(time, low, high, color=colour, alpha=0.3, lw=0)

    figure, axes = over_time(draw, ["position of the tip [mm]"])
    figure.get_layout_engine().set(rect=(0, 0, 1, 0.92))
    figure.legend(
        *axes[0, 0].get_legend_handles_labels(), loc="upper center", ncol=3, handlelength=2
    )
    return figure, {}


def model_force(results):
    def draw(ax, _, task):
        rows = trajectory(results, task)
        size = np.sqrt(sum(rows[f"f{axis}_N"] ** 2 for axis in "xyz"))
        time, low, high = span(rows["time_s"], size)
        ax.fill_between(time, low, high, color=style.PETROL, alpha=0.45, lw=0)
        ax.plot(time, (low + high) / 2, color=style.PETROL, lw=0.9)
        ax.axhline(scene.published("L1.threshold"), color=style.RED, ls="--", lw=0.9)

    figure, axes = over_time(draw, ["model force [N]"])
    # The forces of the taps in task 2 are ten times as large as all other forces.
    axes[0, 0].set_yscale("symlog", linthresh=0.5, linscale=1.2)
    axes[0, 0].set_ylim(0, 1.15 * max(ax.dataLim.y1 for ax in axes[0]))
    axes[0, 0].set_yticks(
        (0, 0.1, 0.2, 0.3, 0.4, 0.5, 1, 2), ("0", "0.1", "0.2", "0.3", "0.4", "0.5", "1", "2")
    )
    axes[0, 0].axhline(0.5, color=style.GREY, lw=0.5)
    axes[0, 0].minorticks_off()
    style.note(axes[0, 0], 0.98, 0.8, "logarithmic above 0.5 N", style.GREY, ha="right")
    limit = scene.published("L1.threshold")
    axes[0, 0].text(
        0, 0.95 * limit, "published limit of the input force", color=style.RED, fontsize=7, va="top"
    )
    return figure, {"spans": BINS}


def ratio_over_time(results, extreme):
    """Draws the largest ("greatest") or smallest ("least") stiffness ratio over the contacts of each step, after each
    number of iterations."""
    above = extreme == "greatest"
    column, colour, published_end = (
        ("ratio_max", style.PETROL, "at_most") if above else ("ratio_min", style.AMBER, "at_least")
    )

    def draw(ax, i, task):
        rows = ratios(results, task, ITERATIONS[i])
        time, low, high = span(rows["time_s"], rows[column], FEW_BINS)
        ax.fill_between(time, low, high, color=colour, alpha=0.75, lw=0.4, edgecolor=colour)
        ax.axhline(1, color=style.BLACK, lw=0.7, ls="--")
        # The extreme value is also printed, because the curve may coincide with the dashed line.
        bound = f"≤ {rows[column].max():.4g}" if above else f"≥ {rows[column].min():.4g}"
        style.note(ax, 0.5, 0.8 if above else 0.15, bound, colour, ha="center", va="center")
        if ITERATIONS[i] == 1:
            ax.axhline(scene.PUBLISHED["R1.once"][published_end], **style.PUBLISHED_LINE)

    labels = [f"{n}" for n in ITERATIONS]
    figure, axes = over_time(draw, labels, height=7.6, rows=len(ITERATIONS))
    figure.supylabel("stiffness ratio after so many iterations", fontsize=8)
    for ax in axes.flat:
        ax.set_ylim((0.95, 1.4) if above else (0.4, 1.05))
        ax.locator_params(nbins=3)
        ax.grid(False)
    style.note(
        axes[0, 0],
        0.98,
        0.3 if above else 0.1,
        f"published: {'1.3' if above else '0.8'}",
        style.RED,
        ha="right",
        va="bottom",
    )
    return figure, {"first": ", ".join(labels[:-1]), "last": labels[-1], "spans": FEW_BINS}


TIMES = (40, 10, 4)  # factors by which the number of points is increased, one curve for each


def decoupling(results):
    """Draws the change of the force that is caused by more points, over the number of weight updates of stiffness
    shaping (claim P1; a figure of this project). The smaller the change, the less the force depends on the density of
    points."""
    shaped = [
        case["values"]
        for case in cases(results, "P1")
        if case["name"].startswith(("m = ", "shaped_stiffness"))
    ]
    shaped.sort(key=lambda values: values["updates"])
    figure, ((ax,),) = style.panels(1, 1, 2.6)
    figure.set_size_inches(3.8, 2.6)
    for times, look in zip(TIMES, style.SERIES):
        ax.plot(
            [values["updates"] for values in shaped],
            [100 * values[f"x{times}"] for values in shaped],
            color=look.colour,
            marker=look.marker,
            label=f"{times} times the points",
        )
    ax.set(
        xscale="log",
        yscale="log",
        xlabel="updates of the weights",
        ylabel="change of the force, rms [%]",
    )
    ax.axhline(5, color=style.GREY, ls="--", lw=0.9)
    ax.axvline(3, color=style.RED, ls=(0, (1, 1.5)), lw=1)
    ax.legend(loc="lower left", fontsize=6.5)
    style.note(ax, 0.4, 0.97, "red: the thesis's three updates", style.RED)
    return figure, {}
