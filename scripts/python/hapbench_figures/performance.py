"""Figures of run time against error."""
from dataclasses import dataclass

import numpy as np
from matplotlib.legend import Legend

import hapbench_style as style
from hapbench.results import MissingResult
from hapbench_command import output_of_program
from hapbench_pictures.over_axes import with_room

ACCURACY = "accuracy/accuracy.json"  # written by hapbench_accuracy
# Panels: title, prefixes of the names of the settings, name of the error, label and scale of the error, and the unit of
# work to which the run time refers ("second" of simulated time, "step" or "call").
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
        "multi-rate contacts",
        ("multi_rate_contacts/shaped_stiffness ",),
        "error_rms_m",
        "rms distance of paths [mm]",
        1e3,
        "step",
    ),
    (
        "bounces between samples",
        ("events/",),
        "created_by_sampling_J",
        "energy created [J]",
        1,
        "second",
    ),
)
# Prefixes of settings whose marks are not joined by a line, because their order is not the order of their run times.
UNORDERED = ("reduction/",)
# Largest drawn error [mm]. The block is 15 mm wide: a drill with a larger error has left it.
LARGEST_ERROR_MM = 10


@dataclass(frozen=True)
class Setting:
    series: str  # name without its last word, which the settings of a series share; "" if the name has one word
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
    """Returns the settings that a logarithmic plot can show: their runs completed, and their error is positive. An
    error in mm must also be below LARGEST_ERROR_MM."""
    found = []
    for row in results.json(ACCURACY)["benchmarks"]:
        if (
            not row["name"].startswith(beginnings) or " + " in row["name"]
        ):  # an algorithm with an option: its mark would nearly coincide with another mark
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
    """Returns the setting at the knee of the Pareto front of run time and error. The program finds the knee as
    `hapbench plot` does for a folder of `hapbench converge --over`. Returns None if the front is straight or has fewer
    than four settings."""
    points = [f"{setting.time!r}:{setting.error!r}" for setting in settings]
    found = output_of_program("finds the knee of a front", "plot", "--knee", *points).strip()
    return settings[int(found)] if found else None


def draw_panel(ax, results, title, beginnings, column, label, scale, per):
    settings = settings_of(results, beginnings, column, scale, per)
    curves = iter(style.SERIES)
    for name in dict.fromkeys(setting.series for setting in settings):
        members = [setting for setting in settings if setting.series == name]
        if name or beginnings == ("shaping/",):
            draw_series(ax, name, members, next(curves), joined=beginnings[0] not in UNORDERED)
        else:
            for setting in members:
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
    if found:
        ax.plot(found.time, found.error, "o", mfc="none", mec=style.RED, ms=10, mew=1.2)
    ax.set(
        xscale="log",
        yscale="log",
        title=f"{title}\nknee: {found.name}" if found else f"{title}\nno knee",
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


def draw_series(ax, name, settings, look, joined):
    """Draws a mark for each setting of a series. If `joined` is true, a line joins the marks, except the marks of
    settings whose names have no number, such as "exact"."""
    label = name.replace("_", " ")
    ordered = [s for s in settings if joined and any(map(str.isdigit, s.short))]
    alone = [s for s in settings if s not in ordered]
    marks = {"color": look.colour, "marker": look.marker, "ms": 3.5}
    if ordered:
        ax.plot(
            [s.time for s in ordered],
            [s.error for s in ordered],
            ls=look.line,
            label=label,
            **marks,
        )
    if alone:
        ax.plot(
            [s.time for s in alone],
            [s.error for s in alone],
            ls="none",
            label=None if ordered else label,
            **marks | ({"mfc": "white"} if ordered else {}),
        )


def legends_below(axes, drawn):
    """Draws the legends of all panels below the panels, where they cover no mark. Panels (a) and (f) share a legend,
    because they have the same curves."""
    add_legend(axes[0], "a, f", drawn[0], "upper left", 1)
    add_legend(axes[1], "b", drawn[1], "upper center", 3)
    add_legend(axes[2], "d", drawn[3], "upper right", 1)
    add_legend(axes[2], "e", drawn[4], "lower right", 1)


def add_legend(ax, letters, of, location, columns):
    handles, labels = of.get_legend_handles_labels()
    if not any(labels):
        return
    legend = Legend(
        ax,
        handles,
        labels,
        loc=location,
        ncol=columns,
        fontsize=6.5,
        handlelength=1.8,
        handletextpad=0.6,
        title=f"({letters})",
        title_fontsize=7,
        borderaxespad=0.0,
    )
    legend.set_in_layout(False)
    ax.add_artist(legend)


def run_time_against_error(results):
    figure, axes = style.panels(3, 3, 6.6, gridspec_kw={"height_ratios": [1, 1, 0.5]})
    drawn = axes[:2].ravel()
    knees = [draw_panel(ax, results, *panel) for ax, panel in zip(drawn, PANELS)]
    for ax in axes[2]:
        ax.axis("off")
    legends_below(axes[2], drawn)
    listed = "; ".join(
        f"({letter}) {found.name if found else 'none'}" for letter, found in zip("abcdef", knees)
    )
    time = {
        row["name"].split("/")[1]: row["seconds_per_step"]
        for row in results.json(ACCURACY)["benchmarks"]
        if row["name"].startswith("skips/")
    }
    skipped = (
        f" Not drawn: a contact search that tests every point in every step takes "
        f"{time['off'] / time['taken']:.0f} times as long as the search of hapbench, for the same contacts."
        if len(time) == 2
        else ""
    )
    return style.lettered(figure, drawn), {"knees": listed, "skipped": skipped}
