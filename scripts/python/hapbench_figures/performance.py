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
VARYING_STEP = ("integrators", "time_step")
LARGEST_ERROR_MM = 10  # the block is 15 mm wide: beyond, the drill has left it
LOOKS = (
    (style.BLUE, "o", "-"),
    (style.ORANGE, "s", (0, (4, 1.2))),
    (style.BLACK, "^", ":"),
    (style.GREEN, "v", (0, (5, 1.5))),
    (style.PURPLE, "D", (0, (3, 1, 1, 1))),
)


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


def finished(rows, error, largest=np.inf):
    """The settings that a logarithmic plot can show: those that completed with an error, not a nonsensical one."""
    return np.array([row["outcome"] == "completes" for row in rows]) & (error > 0) & (error < largest)


def draw_study(ax, results, study, column, label, scale, time_column, title):
    rows = with_times(results, study)
    if study == "algorithms":
        draw_algorithms(ax, rows, column, scale, time_column)
    else:
        draw_curves(ax, rows, study, column, scale, time_column)
    what = "step" if "step" in time_column else "call"
    time_label = "time per simulated second [ms]" if study in VARYING_STEP else f"time of a {what} [µs]"
    ax.set(xscale="log", yscale="log", title=title, ylabel=label, xlabel=time_label)
    if np.isfinite(ax.dataLim.get_points()).all():
        ax.set(xlim=decades(ax.dataLim.x0, ax.dataLim.x1), ylim=decades(ax.dataLim.y0, ax.dataLim.y1))
    if study == "integrators":  # room for the names
        ax.set_ylim(bottom=ax.get_ylim()[0] / 1e6)


def draw_curves(ax, rows, study, column, scale, time_column):
    split = series(rows)
    many = len(split) > 3
    for i, ((name, own), (colour, marker, line)) in enumerate(zip(split.items(), LOOKS)):
        error, time = scale * numbers(own, column), numbers(own, time_column)
        time = 1e3 * time / numbers(own, "step_s") if study in VARYING_STEP else 1e6 * time
        fine = finished(own, error)
        ax.plot(time[fine], error[fine], color=colour, marker=marker, ls=line, label=name.replace("_", " "))
        # Where the settings are the same, their names would cover one another.
        if not many and (i == 0 or study != "spacing"):
            name_ends(ax, study, [row for row, keep in zip(own, fine) if keep], time[fine], error[fine])
    if len(split) > 1:
        ax.legend(loc="lower left" if many else "upper right", handlelength=2.4, fontsize=6 if many else None)


def draw_algorithms(ax, rows, column, scale, time_column):
    error, time = scale * numbers(rows, column), 1e6 * numbers(rows, time_column)
    for i in np.flatnonzero(finished(rows, error, LARGEST_ERROR_MM)):
        if " + " in rows[i]["setting"]:  # an algorithm with an option: nearly the same place
            continue
        look = style.look(rows[i]["setting"])
        ax.plot(time[i], error[i], look.marker, color=look.colour, ms=5, label=look.label)


def decades(low, high):
    """Powers of ten around a range, with room for a label."""
    return 10 ** np.floor(np.log10(low)), 10 ** np.ceil(np.log10(1.5 * high))


def name_ends(ax, study, rows, x, y):
    """Names the first and the last setting of a curve."""
    for i in sorted({0, len(rows) - 1}) if rows else ():
        text = rows[i]["short"]
        if study == "spacing":
            text = f"{1e3 * float(text):g} mm"
        elif text.startswith("dt="):
            text = f"Δt = {1e3 * float(text.removeprefix('dt=')):.3g} ms"
        # The last one to the left, or it would reach into the next panel.
        place = {"xytext": (3, 3)} if i == 0 else {"xytext": (2, 5 if study == "spacing" else -9), "ha": "right"}
        label = ax.annotate(text, (x[i], y[i]), textcoords="offset points", fontsize=6, **place)
        label.set_in_layout(False)


def work_precision(results):
    figure, axes = style.panels(3, 3, 5.6, gridspec_kw={"height_ratios": [1, 1, 0.33]})
    studies, legend = axes[:2].ravel(), axes[2]
    for ax, study in zip(studies, STUDIES):
        draw_study(ax, results, *study)
    style.letter(studies)
    # The names of (f) below everything: they would cover its marks.
    for ax in legend:
        ax.axis("off")
    handles, labels = studies[-1].get_legend_handles_labels()
    names = legend[1].legend(handles, labels, loc="center", ncol=4, fontsize=6.5, handletextpad=0.2)
    names.set_in_layout(False)  # it is wider than the panel it stands in
    return figure, (
        "Work against precision in six studies: error over run time on one core, a mark for each setting, first and "
        "last named in (b) to (e). (a) Integrators and time steps of 1 ms to 1 µs, against the exact solution; (b) time "
        "step, against a 64 times finer one; (c) shaping iterations against exact shaping; (d) threshold of the reduction, against exact shaping "
        "of all points; (e) spacing of the block's points and (f) force algorithms, against the ideal trajectory of "
        "3.6. Left out: settings that diverged, were off by more than 10 mm or have no error. Ours; run times are "
        "those of the machine that measured them."
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
        np.maximum(count - 0.5, 0),
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
