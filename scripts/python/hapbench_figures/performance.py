"""What accuracy costs: work-precision plots and the latency of a step."""
import numpy as np

from . import published, style
from .results import MissingResult, numbers

# study, column of the error, its label and scale, column of the time and its label, title
STUDIES = (
    ("integrators", "error_rms_m", "rms error [mm]", 1e3, "seconds_per_step", "time step, springs"),
    ("time_step", "error_rms_m", "rms error [mm]", 1e3, "seconds_per_step", "time step, drill in hole"),
    ("shaping", "tensor_error_rms", "rms error of S", 1, "seconds_per_call", "shaping iterations"),
    ("reduction", "force_error_relative", "relative force error", 1, "seconds_per_call", "reduction threshold"),
    ("spacing", "ideal_height_error_rms_m", "rms height error [mm]", 1e3, "seconds_per_step", "point spacing"),
    ("algorithms", "ideal_height_error_rms_m", "rms height error [mm]", 1e3, "seconds_per_step", "force algorithms"),
)
LOOKS = ((style.BLUE, "o", "-"), (style.ORANGE, "s", (0, (4, 1.2))), (style.BLACK, "^", ":"))


def series(rows):
    """The settings of a study, split where the first word is a name that several settings share."""
    split = {}
    for row in rows:
        head, _, tail = row["setting"].partition(" ")
        split.setdefault(head if tail else "", []).append({**row, "short": tail or row["setting"]})
    return split


def with_times(results, study):
    """Rows of a study, each with the time of its setting."""
    times = {row["setting"]: row for row in results.records(f"precision/precision_{study}_timing.csv")}
    return [
        {**row, **times[row["setting"]]}
        for row in results.records(f"precision/precision_{study}.csv")
        if row["setting"] in times
    ]


def draw_study(ax, results, study, column, label, scale, time_column, title):
    varying_step = study in ("integrators", "time_step")
    for (name, rows), (colour, marker, line) in zip(series(with_times(results, study)).items(), LOOKS):
        error, time = scale * numbers(rows, column), numbers(rows, time_column)
        if varying_step:
            time = 1e3 * time / numbers(rows, "step_s")
        else:
            time = 1e6 * time
        fine = (
            np.array([row["outcome"] == "completes" for row in rows])
            & (error > 0)
            & (error < 10 if study == "algorithms" else True)
        )
        ax.plot(
            time[fine],
            error[fine],
            color=colour,
            marker=marker,
            ls="none" if study == "algorithms" else line,
            label=name.replace("_", " ") or None,
        )
        annotate(ax, study, [row for row, keep in zip(rows, fine) if keep], time[fine], error[fine])
    ax.set(
        xscale="log",
        yscale="log",
        title=title,
        ylabel=label,
        xlabel="time per simulated second [ms]"
        if varying_step
        else f"time of a {'step' if 'step' in time_column else 'call'} [µs]",
    )
    ax.set(xlim=decades(ax.dataLim.x0, ax.dataLim.x1), ylim=decades(ax.dataLim.y0, ax.dataLim.y1))
    if study in ("reduction", "spacing"):
        ax.legend(loc="upper right", handlelength=2.4)


def decades(low, high):
    """Powers of ten around a range, with room for a label."""
    return 10 ** np.floor(np.log10(low)), 10 ** np.ceil(np.log10(1.5 * high))


# Beside its mark, where the labels of the algorithms would hide each other.
PLACES = {
    "mean": (-4, 3, "right"),
    "stiffness shaping (HS)": (-4, 1, "right"),
    "normal projection": (-4, -3, "right"),
    "exact shaping (ours)": (0, -10, "right"),
    "virtual coupling": (-4, -3, "right"),
}


def annotate(ax, study, rows, x, y):
    """The first and the last setting of a curve; every algorithm."""
    pick = range(len(rows)) if study == "algorithms" else sorted({0, len(rows) - 1})
    for i in pick:
        if i >= len(rows):
            continue
        text = rows[i]["short"]
        if study == "algorithms" and text in style.ALGORITHMS:
            text = style.ALGORITHMS[text].label
        elif study == "spacing":
            text = f"{1e3 * float(text):g} mm"
        elif text.startswith("dt="):
            text = f"Δt = {1e3 * float(text.removeprefix('dt=')):.3g} ms"
        dx, dy, side = PLACES.get(text, (3, 3, "left"))
        label = ax.annotate(text, (x[i], y[i]), xytext=(dx, dy), textcoords="offset points", fontsize=6, ha=side)
        label.set_in_layout(False)


def work_precision(results):
    figure, axes = style.panels(2, 3, 4.6)
    for ax, study in zip(axes.flat, STUDIES):
        draw_study(ax, results, *study)
    style.letter(axes.flat)
    return figure, (
        "Work against precision in six studies: error over run time on one core, a mark for each setting, first and "
        "last named. (a, b) time step, error against the finest one; (c) shaping iterations against exact shaping; "
        "(d) threshold of the reduction against all points and exact shaping; (e) spacing of the block's points and "
        "(f) force algorithms against the ideal trajectory of 3.6. Left out: settings that diverged, were off by "
        "more than 10 mm or have no error. Ours; run times are this machine's."
    )


def latency(results):
    runs = []
    for path in results.glob("**/timing.json"):
        timing = results.json(path)
        if timing.get("step_latency", {}).get("histogram"):
            runs.append((path.removesuffix("/timing.json").rpartition("/")[2], timing))
    if not runs:
        raise MissingResult("no timing.json with a histogram of step times (record.timing)")
    runs = runs[:6]
    figure, axes = style.panels(len(runs), 1, 0.9 + 1.25 * len(runs), sharex=True)
    for ax, (name, timing) in zip(axes[:, 0], runs):
        draw_latency(ax, name, timing["step_latency"])
    axes[-1, 0].set_xlabel("time of a step [µs]")
    return figure, (
        "How long the steps of a run took: histogram of wall times, both axes logarithmic, with median and 99.9th "
        "percentile (dotted). Vermilion: the deadline of a haptic loop at 2048 Hz, the published rate (3.1). Steps "
        "beyond it were late, on a machine without a real-time system. Ours."
    )


def draw_latency(ax, name, latency_):
    bins = latency_["histogram"]
    low = np.array([b["from_s"] for b in bins]) * 1e6
    high = np.array([b["to_s"] for b in bins]) * 1e6
    count = np.array([b["steps"] for b in bins])
    low = np.maximum(low, high / 2)  # the first bin may begin at zero, which has no place on this axis
    deadline = 1e6 / published.value("T4.rate")
    late = low >= deadline
    ax.bar(
        low,
        np.maximum(count, 0),
        width=high - low,
        align="edge",
        color=np.where(late, style.ORANGE, style.SKY),
        edgecolor="white",
        lw=0.5,
        bottom=0.5,
    )
    ax.axvline(deadline, color=style.VERMILION, lw=1.4)
    for key, text in (("p50_s", "median"), ("p99_9_s", "99.9 %")):
        if latency_.get(key):
            ax.axvline(1e6 * latency_[key], color=style.BLACK, lw=0.9, ls=":")
            time = 1e6 * latency_[key]
            ax.annotate(
                f"{text}\n{time:.{0 if time > 100 else 1}f} µs",
                (1e6 * latency_[key], 0.97),
                xycoords=("data", "axes fraction"),
                xytext=(-3 if time > deadline else 3, 0),
                textcoords="offset points",
                fontsize=6.5,
                va="top",
                ha="right" if time > deadline else "left",
            )
    ax.set(
        xscale="log",
        yscale="log",
        ylabel="steps",
        title=f"{name}: {latency_['steps']} steps",
        ylim=(0.5, 20 * count.max()),
    )
    ax.annotate(
        f"deadline {deadline:.0f} µs",
        (deadline, 0.5),
        xycoords=("data", "axes fraction"),
        xytext=(-3, 0),
        textcoords="offset points",
        color=style.VERMILION,
        fontsize=7,
        ha="right",
    )
