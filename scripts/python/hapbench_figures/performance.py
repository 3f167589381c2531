"""Run time against error, and the latency of a step."""
from dataclasses import dataclass

import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

import hapbench_style as style

from . import published
from .results import MissingResult

ACCURACY = "accuracy/accuracy.json"  # of hapbench_accuracy
# title, settings by the beginning of their names, error, its label and scale; time of a simulated second, or of a step or call
PANELS = (
    ("integrators and their step", ("integrators/",), "error_rms_m", "rms error [mm]", 1e3, "second"),
    ("algorithms, spacing of points", ("spacing/", "algorithms/"), "ideal_height_error_rms_m", "rms height error [mm]", 1e3, "step"),
    ("iterations of shaping", ("shaping/",), "tensor_error_rms", "rms error of S", 1, "call"),
    ("reduced and merged contacts", ("reduction/", "merging/merged_shaping 0.0001"), "force_error_relative", "relative force error", 1, "call"),
    ("late contacts", ("late_contacts/shaped_stiffness ",), "error_rms_m", "rms way apart [mm]", 1e3, "step"),
    ("bounces between samples", ("events/",), "created_by_sampling_J", "energy made [J]", 1, "second"),
)
KNEE = 2  # times the least error of a panel
LARGEST_ERROR_MM = 10  # the block is 15 mm wide: beyond, the drill has left it
LOOKS = (
    (style.PETROL, "o", "-"),
    (style.AMBER, "s", (0, (4, 1.2))),
    (style.BLACK, "^", ":"),
    (style.PLUM, "v", (0, (5, 1.5))),
    (style.GREY, "D", (0, (3, 1, 1, 1))),
    (style.RED, "x", "-."),
)
QUANTILES = (("p50_s", 0.5), ("p99_s", 0.01), ("p99_9_s", 0.001))  # and the share beyond them


@dataclass(frozen=True)
class Setting:
    series: str  # what several settings share, "" where a name is a word
    short: str
    time: float
    error: float

    @property
    def name(self):
        short = f"Δt = {1e3 * float(self.short[3:]):.3g} ms" if self.short.startswith("dt=") else self.short
        return f"{self.series} {short}".strip().replace("_", " ")


def settings_of(results, beginnings, column, scale, per):
    """The settings that a logarithmic plot can show: that completed, with an error, not a nonsensical one."""
    found = []
    for row in results.json(ACCURACY)["benchmarks"]:
        if not row["name"].startswith(beginnings) or " + " in row["name"]:  # an algorithm with an option: nearly the same place
            continue
        series, _, short = row["name"].removesuffix("/manual_time").partition("/")[2].rpartition(" ")
        time = 1e3 * row["seconds_per_step"] / row["step_s"] if per == "second" else 1e6 * row[f"seconds_per_{per}"]
        error = scale * abs(row.get(column, 0.0))
        largest = LARGEST_ERROR_MM if scale == 1e3 else np.inf
        if row["label"] == "completes" and 0 < error < largest:
            found.append(Setting(series, short, time, error))
    if not found:
        raise MissingResult(f"{ACCURACY} without {beginnings[0]}")
    return found


def knee(settings):
    """The cheapest setting whose error is at most KNEE times the least: what takes longer gains no more than that factor."""
    least = min(setting.error for setting in settings)
    return min((setting for setting in settings if setting.error <= KNEE * least), key=lambda setting: setting.time)


def number_ticks(ax):
    """Numbers at 1, 2 and 5 along logarithmic axes that show too few powers of ten."""
    for axis in (ax.xaxis, ax.yaxis):
        low, high = axis.get_view_interval()
        if high / low < 60:
            axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axis.set_minor_formatter(NullFormatter())


def with_room(low, high, above=1.0):
    """Limits around a range on a logarithmic axis, with room for marks and names."""
    room = max((high / low) ** 0.12, 1.3)
    return low / room, high * room * above


def draw_panel(ax, results, title, beginnings, column, label, scale, per):
    settings = settings_of(results, beginnings, column, scale, per)
    curves = iter(LOOKS)
    for name in dict.fromkeys(setting.series for setting in settings):
        own = [setting for setting in settings if setting.series == name]
        if name or beginnings == ("shaping/",):
            colour, marker, line = next(curves)
            ax.plot([s.time for s in own], [s.error for s in own], color=colour, marker=marker, ls=line, ms=3.5, label=name.replace("_", " "))
        else:
            for setting in own:
                look = style.look(setting.short)
                ax.plot(setting.time, setting.error, look.marker, color=look.colour, ms=5, label=look.label)
    found = knee(settings)
    ax.plot(found.time, found.error, "o", mfc="none", mec=style.RED, ms=10, mew=1.2)
    ax.set(xscale="log", yscale="log", title=f"{title}\nknee: {found.name}", ylabel=label,
           xlabel="time of a simulated second [ms]" if per == "second" else f"time of a {per} [µs]")
    ax.set(xlim=with_room(ax.dataLim.x0, ax.dataLim.x1), ylim=with_room(ax.dataLim.y0, ax.dataLim.y1, 4))
    number_ticks(ax)
    return found


def run_time_against_error(results):
    figure, axes = style.panels(3, 3, 6.4, gridspec_kw={"height_ratios": [1, 1, 0.4]})
    drawn = axes[:2].ravel()
    knees = [draw_panel(ax, results, *panel) for ax, panel in zip(drawn, PANELS)]
    style.letter(drawn)
    for ax in axes[2]:
        ax.axis("off")
    # The names of (b) below everything: they would cover its marks.
    for ax in drawn:
        handles, labels = ax.get_legend_handles_labels()
        if ax is drawn[1]:
            axes[2, 1].legend(handles, labels, loc="center", ncol=4, fontsize=7, handletextpad=0.2, title="(b)").set_in_layout(False)
        elif any(labels):
            ax.legend(fontsize=5.5, handlelength=1.8)
    said = "; ".join(f"({letter}) {found.name}" for letter, found in zip("abcdef", knees))
    time = {row["name"].split("/")[1]: row["seconds_per_step"] for row in results.json(ACCURACY)["benchmarks"] if row["name"].startswith("skips/")}
    skipped = f" Testing every point in every step takes {time['off'] / time['taken']:.0f} times as long, for the same contacts." if len(time) == 2 else ""
    return figure, ("What accuracy costs: error over run time on one core, a mark for each setting. Ringed: the knee, the cheapest "
                    f"setting whose error is at most {KNEE} times the least of its panel, so that whatever takes longer gains no more than "
                    f"this factor: {said}. (a) Time steps of 1 ms to 1 µs, against the exact damped oscillator; (b) force algorithms, and "
                    "spacings of the block's points under both densities, against the ideal trajectory of 3.6; (c) against the exact limit; "
                    "(d) thresholds of the reduction, and merged shaping, against the force of all contacts; (e) contacts found in every 2nd to "
                    f"32nd row and held or followed in between, against those of every row; (f) against a bounce whose events are found.{skipped} "
                    "Left out: settings that diverged, were off by more than 10 mm or have no error. Ours; run times are those of the "
                    "machine that measured them.")


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
