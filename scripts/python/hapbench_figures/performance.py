"""Work-precision plots, and the latency of a step."""
from textwrap import wrap

import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

import hapbench_style as style

from . import published
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
    (style.PETROL, "o", "-"),
    (style.AMBER, "s", (0, (4, 1.2))),
    (style.BLACK, "^", ":"),
    (style.PLUM, "v", (0, (5, 1.5))),
    (style.GREY, "D", (0, (3, 1, 1, 1))),
)
QUANTILES = (("p50_s", 0.5), ("p99_s", 0.01), ("p99_9_s", 0.001))  # and the share beyond them


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
    return [{**row, **times[row["setting"]]} for row in results.records(f"precision/precision_{study}.csv")
            if row["setting"] in times]


def finished(rows, error, largest=np.inf):
    """The settings that a logarithmic plot can show: those that completed with an error, not a nonsensical one."""
    return np.array([row["outcome"] == "completes" for row in rows]) & (error > 0) & (error < largest)


def draw_study(ax, results, study, column, label, scale, time_column, title):
    rows = with_times(results, study)
    draw = draw_algorithms if study == "algorithms" else draw_curves
    draw(ax, rows, study, column, scale, time_column)
    what = "step" if "step" in time_column else "call"
    time_label = "time per simulated second [ms]" if study in VARYING_STEP else f"time of a {what} [µs]"
    ax.set(xscale="log", yscale="log", title=title, ylabel=label, xlabel=time_label)
    if np.isfinite(ax.dataLim.get_points()).all():
        right = 300 if study == "integrators" else 1  # room for their names
        above = 2 if ax.get_legend() else 1
        ax.set(xlim=with_room(ax.dataLim.x0, right * ax.dataLim.x1), ylim=with_room(ax.dataLim.y0, above * ax.dataLim.y1))
    number_ticks(ax)


def number_ticks(ax):
    """Numbers at 1, 2 and 5 along logarithmic axes that show too few powers of ten."""
    for axis in (ax.xaxis, ax.yaxis):
        low, high = axis.get_view_interval()
        if high / low < 60:
            axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axis.set_minor_formatter(NullFormatter())


def times_of(rows, study, time_column):
    time = numbers(rows, time_column)
    return 1e3 * time / numbers(rows, "step_s") if study in VARYING_STEP else 1e6 * time


def draw_curves(ax, rows, study, column, scale, time_column):
    split = series(rows)
    for i, ((name, own), (colour, marker, line)) in enumerate(zip(split.items(), LOOKS)):
        if name in style.ALGORITHMS:
            look = style.look(name)
            colour, marker, line = look.colour, look.marker, "-"
        error, time = scale * numbers(own, column), times_of(own, study, time_column)
        fine = finished(own, error)
        ax.plot(time[fine], error[fine], color=colour, marker=marker, ls=line, label=name.replace("_", " "))
        if not fine.any():
            continue
        if study == "integrators":  # five curves, whose ends lie apart
            end = np.flatnonzero(fine)[np.argmax(time[fine])]
            ax.annotate(name.replace("_", " "), (time[end], error[end]), (4, 0), textcoords="offset points", color=colour,
                        fontsize=6.5, va="center").set_in_layout(False)
        # Names of settings that several curves share would cover one another.
        elif i == 0 or study != "spacing":
            name_ends(ax, study, [row for row, keep in zip(own, fine) if keep], time[fine], error[fine])
    if len(split) > 1 and study != "integrators":
        ax.legend(loc="upper right", handlelength=2.4)


def draw_algorithms(ax, rows, study, column, scale, time_column):
    error, time = scale * numbers(rows, column), times_of(rows, study, time_column)
    fine = finished(rows, error, LARGEST_ERROR_MM)
    missing = []
    for row, x, y, keep in zip(rows, time, error, fine):
        look = style.look(row["setting"])
        if " + " in row["setting"]:  # an algorithm with an option: nearly the same place
            continue
        if keep:
            ax.plot(x, y, look.marker, color=look.colour, ms=5, label=look.label)
        else:
            missing.append(look.label)
    if missing:
        text = "\n".join(wrap(f"left the block: {', '.join(missing)}", 22))
        style.note(ax, 0.03, 0.03, text, va="bottom")


def with_room(low, high):
    """Limits around a range on a logarithmic axis, with room for marks and names."""
    room = max((high / low) ** 0.12, 1.3)
    return low / room, high * room


def name_ends(ax, study, rows, x, y):
    """Names the first and the last setting of a curve, inside the frame."""
    for i in sorted({0, len(rows) - 1}) if rows else ():
        text = rows[i]["short"]
        if study == "spacing":
            text = f"{1e3 * float(text):g} mm"
        elif text.startswith("dt="):
            text = f"Δt = {1e3 * float(text.removeprefix('dt=')):.3g} ms"
        # Towards the middle of the panel.
        left = x[i] ** 2 <= ax.dataLim.x0 * ax.dataLim.x1
        place = {"xytext": (5, 2)} if left else {"xytext": (-5, -4), "ha": "right", "va": "top"}
        if study == "spacing" and i:  # the other curve is below
            place |= {"xytext": (6, 9), "va": "bottom"}
        elif left and i:
            place = {"xytext": (0, -10)}
        ax.annotate(text, (x[i], y[i]), textcoords="offset points", fontsize=6.5, **place).set_in_layout(False)


def work_precision(results):
    figure, axes = style.panels(3, 3, 6.0, gridspec_kw={"height_ratios": [1, 1, 0.34]})
    studies, legend = axes[:2].ravel(), axes[2]
    for ax, study in zip(studies, STUDIES):
        draw_study(ax, results, *study)
    style.letter(studies)
    # The names of (f) below everything: they would cover its marks.
    for ax in legend:
        ax.axis("off")
    handles, labels = studies[-1].get_legend_handles_labels()
    names = legend[1].legend(handles, labels, loc="center", ncol=4, fontsize=7, handletextpad=0.2, title="algorithms of (f)")
    names.set_in_layout(False)  # it is wider than the panel it stands in
    return figure, ("Work against precision in six studies: error over run time on one core, a mark for each setting, "
                    "first and last named in (b) to (e). (a) Integrators and time steps of 1 ms to 1 µs, against the exact "
                    "solution; (b) time step, against a 64 times finer one; (c) shaping iterations against exact shaping; "
                    "(d) threshold of the reduction, against exact shaping of all points; (e) spacing of the block's "
                    "points and (f) force algorithms, against the ideal trajectory of 3.6. Left out: settings that "
                    "diverged, were off by more than 10 mm or have no error. Ours; run times are those of the machine that "
                    "measured them.")


def query_time(results):
    """How long the search for contacts and their depths takes, over how deep the tool is."""
    figure, axes = style.panels(1, 2, 2.9)
    ways = {}
    for row in with_times(results, "query_time"):
        ways.setdefault(row["setting"].split()[0], []).append(row)
    if not ways:
        raise MissingResult("precision/precision_query_time.csv without rows")
    time, points = axes[0]
    for (way, rows), (colour, marker, line) in zip(ways.items(), LOOKS):
        depth = 1e3 * numbers(rows, "pushed_m")
        look = {"color": colour, "marker": marker, "ls": line}
        time.plot(depth, 1e6 * numbers(rows, "seconds_per_call"), label=way.replace("_", " "), **look)
        points.plot(depth, numbers(rows, "points_tested_mean"), label=f"tested, {way.replace('_', ' ')}", **look)
    points.plot(depth, numbers(rows, "contacts_mean"), color=style.BLACK, ls=":", marker="^", label="touched")
    time.set(xlabel="pushed in by [mm]", ylabel="time of a query [µs]", ylim=(0, None))
    points.set(xlabel="pushed in by [mm]", ylabel="points", yscale="log")
    time.legend()
    points.legend()
    style.letter(axes[0])
    return figure, ("Query time over penetration depth (after Weller, Sagardia et al. 2010): a round tip is pushed into a "
                    "plane in steps of less than a micrometre. (a) Time of the search for contacts and of their depths, on "
                    "one core; (b) points the tool touches and points compared with it. Both ways give the same contacts. "
                    "Ours; run times are those of the machine that measured them.")


def late_contacts(results):
    """The largest stable stiffness of every algorithm over the rate at which contacts are found."""
    figure, axes = style.panels(3, 2, 6.6, gridspec_kw={"height_ratios": [1, 1, 0.36]}, sharex="row", sharey="row")
    for column, (scene, folder) in enumerate((("dragged over the molar", "precision"), ("turned in the hole", "precision_hole"))):
        split = {}
        for row in results.records(f"{folder}/precision_late_contacts.csv"):
            law, between, _ = row["setting"].split()
            split.setdefault((between, law), []).append(row)
        for ax, between in zip(axes[:2, column], ("hold", "linear")):
            for (kind, law), rows in split.items():
                look = style.look(law)
                if kind == between:
                    ax.plot(numbers(rows, "rate_Hz"), 1e-3 * numbers(rows, "stiffness_max_N_per_m"), color=look.colour, ls=look.line,
                            marker=look.marker, ms=4, lw=1, label=look.label)
            held = split["hold", "shaped_stiffness"]
            if between == "hold":
                ax.plot(numbers(held, "rate_Hz"), 1e-3 * numbers(held, "theory_N_per_m"), color=style.AMBER, lw=3, alpha=0.6, zorder=0,
                        label="one held spring")
            ax.set(xscale="log", yscale="log", title=f"{scene}, {between}", ylim=(1, 3000))
            ax.set_xticks(numbers(held, "rate_Hz"), [f"{rate:.0f}" for rate in numbers(held, "rate_Hz")])
            ax.xaxis.set_minor_formatter(NullFormatter())
        axes[1, column].set_xlabel("contacts found at [Hz]")
        axes[2, column].axis("off")
    for row in axes[:2]:
        row[0].set_ylabel("largest stable K [kN/m]")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    axes[2, 0].legend(handles, labels, loc="center", bbox_to_anchor=(1.05, 0.4), ncol=4, fontsize=7).set_in_layout(False)
    style.letter(axes[:2].ravel())
    return figure, ("How stiff each algorithm may be whose contacts are found at 64 to 2048 Hz, beside a loop of 2048 Hz: the "
                    "largest K up to which the handle vibrates by at most 10 mm/s rms above 30 Hz; left out where even a "
                    "thousandth of 20 kN/m is too much. (a, b) Held contacts, with the edge by eigenvalues of one held spring under the "
                    "same damping ratio; (c, d) linear ones. Ours.")


def latency(results):
    runs = []
    for path in results.glob("**/timing.json"):
        timing = results.json(path)
        if timing.get("step_latency", {}).get("histogram"):
            runs.append((path.removesuffix("/timing.json").rpartition("/")[2], timing["step_latency"]))
    if not runs:
        raise MissingResult("no timing.json with a histogram of step times (record.timing)")
    runs = runs[: len(LOOKS)]
    figure, axes = style.panels(1, 1, 3.3)
    ax = axes[0, 0]
    for (name, steps), look in zip(runs, LOOKS):
        draw_latency(ax, name, steps, look)
    deadline = 1e6 / published.value("T4.rate")
    ax.axvline(deadline, color=style.RED, lw=1.4)
    ax.set(xscale="log", yscale="log", xlabel="time of a step [µs]", ylabel="share of the steps that take longer")
    end = max(2 * deadline, 1.5 * ax.dataLim.x1)
    ax.set(xlim=(ax.dataLim.x0 / 1.5, end), ylim=(None, 2))
    ax.axvspan(deadline, end, color=style.RED, alpha=0.08, lw=0)
    ax.text(deadline / 1.06, 1.2, f"deadline {deadline:.0f} µs", color=style.RED, ha="right", fontsize=7)
    ax.text(1.06 * deadline, 1.2, "late", color=style.RED, fontsize=7)
    ax.legend(loc="lower left")
    return figure, ("How long the steps of a run took: the share of its steps that took longer, both axes logarithmic; "
                    "filled marks: bounds of the histogram, hollow ones: median, 99 %, 99.9 % and the longest step, drawn "
                    "at one step of the run. Red: the deadline of a haptic loop at 2048 Hz, the published rate (3.1). "
                    "Steps beyond it were late, on a machine without a real-time system. Ours.")


def draw_latency(ax, name, latency_, look):
    """The histogram summed from its end: the share beyond each bound, down to one step of the run."""
    colour, marker, line = look
    bins, total = latency_["histogram"], latency_["steps"]
    bounds = 1e6 * np.array([b["to_s"] for b in bins])
    beyond = 1 - np.cumsum([b["steps"] for b in bins]) / total
    some = beyond > 0.5 / total
    ax.plot(bounds[some], beyond[some], color=colour, marker=marker, ls=line, label=f"{name}, {total} steps")
    known = [(1e6 * latency_[key], share) for key, share in QUANTILES if latency_.get(key)]
    known += [(1e6 * latency_["max_s"], 1 / total)] if latency_.get("max_s") else []
    if known:
        ax.plot(*zip(*known), marker, color=colour, mfc="white", ms=4.5)
