"""Run time against error."""
from dataclasses import dataclass

import numpy as np

import hapbench_style as style
from hapbench.results import MissingResult
from hapbench_pictures.over_axes import with_room

ACCURACY = "accuracy/accuracy.json"  # of hapbench_accuracy
# title, settings by the beginning of their names, error, its label and scale; time of a simulated
# second, or of a step or call
PANELS = (
    (
        "integrators and their step",
        ("integrators/",),
        "error_rms_m",
        "rms error [mm]",
        1e3,
        "second",
    ),
    (
        "algorithms, spacing of points",
        ("spacing/", "algorithms/"),
        "ideal_height_error_rms_m",
        "rms height error [mm]",
        1e3,
        "step",
    ),
    ("iterations of shaping", ("shaping/",), "tensor_error_rms", "rms error of S", 1, "call"),
    (
        "reduced and merged contacts",
        ("reduction/", "merging/merged_shaping 0.0001"),
        "force_error_relative",
        "relative force error",
        1,
        "call",
    ),
    (
        "late contacts",
        ("multi_rate_contacts/shaped_stiffness ",),
        "error_rms_m",
        "rms way apart [mm]",
        1e3,
        "step",
    ),
    (
        "bounces between samples",
        ("events/",),
        "created_by_sampling_J",
        "energy made [J]",
        1,
        "second",
    ),
)
KNEE = 2  # times the least error of a panel
LARGEST_ERROR_MM = 10  # the block is 15 mm wide: beyond, the drill has left it


@dataclass(frozen=True)
class Setting:
    series: str  # what several settings share, "" where a name is a word
    short: str
    time: float
    error: float

    @property
    def name(self):
        short = (
            f"Δt = {1e3 * float(self.short[3:]):.3g} ms"
            if self.short.startswith("dt=")
            else self.short
        )
        return f"{self.series} {short}".strip().replace("_", " ")


def settings_of(results, beginnings, column, scale, per):
    """The settings that a logarithmic plot can show: that completed, with an error, not a nonsensical one."""
    found = []
    for row in results.json(ACCURACY)["benchmarks"]:
        if (
            not row["name"].startswith(beginnings) or " + " in row["name"]
        ):  # an algorithm with an option: nearly the same place
            continue
        series, _, short = (
            row["name"].removesuffix("/manual_time").partition("/")[2].rpartition(" ")
        )
        time = (
            1e3 * row["seconds_per_step"] / row["step_s"]
            if per == "second"
            else 1e6 * row[f"seconds_per_{per}"]
        )
        error = scale * abs(row.get(column, 0.0))
        largest = LARGEST_ERROR_MM if scale == 1e3 else np.inf
        if row["label"] == "completes" and 0 < error < largest:
            found.append(Setting(series, short, time, error))
    if not found:
        raise MissingResult(f"{ACCURACY} without {beginnings[0]}")
    return found


def knee(settings):
    """The cheapest setting whose error is at most KNEE times the least: what takes longer gains no
    more than that factor."""
    least = min(setting.error for setting in settings)
    return min(
        (setting for setting in settings if setting.error <= KNEE * least),
        key=lambda setting: setting.time,
    )


def draw_panel(ax, results, title, beginnings, column, label, scale, per):
    settings = settings_of(results, beginnings, column, scale, per)
    curves = iter(style.SERIES)
    for name in dict.fromkeys(setting.series for setting in settings):
        own = [setting for setting in settings if setting.series == name]
        if name or beginnings == ("shaping/",):
            look = next(curves)
            ax.plot(
                [s.time for s in own],
                [s.error for s in own],
                color=look.colour,
                marker=look.marker,
                ls=look.line,
                ms=3.5,
                label=name.replace("_", " "),
            )
        else:
            for setting in own:
                look = style.look(setting.short)
                ax.plot(
                    setting.time,
                    setting.error,
                    look.marker,
                    color=look.colour,
                    ms=5,
                    label=look.label,
                )
    found = knee(settings)
    ax.plot(found.time, found.error, "o", mfc="none", mec=style.RED, ms=10, mew=1.2)
    ax.set(
        xscale="log",
        yscale="log",
        title=f"{title}\nknee: {found.name}",
        ylabel=label,
        xlabel="time per simulated s [ms]" if per == "second" else f"time of a {per} [µs]",
    )
    ax.set(
        xlim=with_room(ax.dataLim.x0, ax.dataLim.x1),
        ylim=with_room(ax.dataLim.y0, ax.dataLim.y1, 4),
    )
    style.number_ticks(ax.xaxis)
    style.number_ticks(ax.yaxis)
    return found


def run_time_against_error(results):
    figure, axes = style.panels(3, 3, 6.4, gridspec_kw={"height_ratios": [1, 1, 0.4]})
    drawn = axes[:2].ravel()
    knees = [draw_panel(ax, results, *panel) for ax, panel in zip(drawn, PANELS)]
    for ax in axes[2]:
        ax.axis("off")
    # The names of (b) below everything: they would cover its marks.
    for ax in drawn:
        handles, labels = ax.get_legend_handles_labels()
        if ax is drawn[1]:
            axes[2, 1].legend(
                handles,
                labels,
                loc="center",
                ncol=4,
                fontsize=7,
                handlelength=1.6,
                handletextpad=0.6,
                title="(b)",
            ).set_in_layout(False)
        elif any(labels) and ax is not drawn[5]:  # whose curves have the looks of (a)
            ax.legend(fontsize=5.5, handlelength=1.8)
    said = "; ".join(f"({letter}) {found.name}" for letter, found in zip("abcdef", knees))
    time = {
        row["name"].split("/")[1]: row["seconds_per_step"]
        for row in results.json(ACCURACY)["benchmarks"]
        if row["name"].startswith("skips/")
    }
    skipped = (
        f" Testing every point in every step takes {time['off'] / time['taken']:.0f} times as "
        "long, for the same contacts."
        if len(time) == 2
        else ""
    )
    return style.lettered(figure, drawn), {"factor": KNEE, "knees": said, "skipped": skipped}
