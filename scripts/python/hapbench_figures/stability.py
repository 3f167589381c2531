"""Stability: the root locus of A.3, and the largest stable stiffness over other fields (`limit --over`) and on each device (`limit --device`)."""
import json
from itertools import cycle
from pathlib import Path
from textwrap import wrap

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

import hapbench_style as style
from hapbench.columns import read_records
from hapbench_report.markup import column

from . import published
from .results import numbers

LIMIT, LIMIT_RUNS = "limit.csv", "limit_runs.csv"
# Of the picture of devices.
PANEL = 2.6  # [inch]
LEGEND = 0.3  # [inch]
STEP = 0.16  # of a row, between algorithms
SPRING = published.FILE.parents[2] / "scenarios" / "limits" / "single_spring.json"


def spaced(number):
    """A number with spaces between thousands, and with decimals if there are few digits before them."""
    return f"{number:,.{0 if number >= 1000 or number == round(number) else 3}f}".replace(",", " ")


def root_locus(results):
    scene = json.loads(SPRING.read_text(encoding="utf-8"))
    dt, M, zeta = scene["time"]["step_s"], scene["rendering"]["mass_kg"], scene["rendering"]["damping_ratio"]
    poles = lambda K, B: sorted(np.linalg.eigvals([[1 - K * dt * dt / M, dt - B * dt * dt / M], [-K * dt / M, 1 - B * dt / M]]),
                                key=lambda pole: (-pole.imag, -pole.real))
    undamped, damped = results.records("spring_stiffness/limit.csv")
    damper = results.records("spring_damping/limit.csv")[0]
    cases = (("A4.stiffness", "B = 0, K grows", "K", "N/m", undamped, lambda K: poles(K, 0)),
             ("A4.damping", "K = 0, B grows", "B", "N s/m", damper, lambda B: poles(0, B)),
             ("A4.stiffness.damped", f"ζ = {zeta:g}, K grows", "K", "N/m", damped, lambda K: poles(K, 2 * zeta * np.sqrt(K * M))))
    figure, axes = style.panels(1, 3, 2.7, sharey=True)
    turn = np.linspace(0, 2 * np.pi, 181)
    for ax, (id_, title, symbol, unit, ours, at) in zip(axes[0], cases):
        value = published.value(id_)
        ax.plot(np.cos(turn), np.sin(turn), color=style.BLACK, lw=0.8)
        for way, colour, line in zip(np.array([at(v) for v in np.linspace(0, 1.25 * value, 401)]).T, (style.PETROL, style.AMBER), ("-", (0, (4, 1.2)))):
            ax.plot(way.real, way.imag, color=colour, ls=line, lw=1.5)
        leaving = min(at(value), key=lambda pole: pole.real)  # at -1; the other one stays inside or at 1
        ax.plot(leaving.real, leaving.imag, marker="D", mfc="white", mec=style.RED, ms=5, zorder=5)
        style.note(ax, 0.5, 0.98, f"published {symbol} = {spaced(value)} {unit}", style.RED, ha="center")
        style.note(ax, 0.5, 0.02, f"ours {spaced(float(ours['limit']))} {unit}", ha="center", va="bottom")
        ax.set(title=title, xlabel="real part", xlim=(-1.75, 1.4), ylim=(-1.6, 1.6), aspect="equal")
    axes[0, 0].set_ylabel("imaginary part")
    style.letter(axes[0])
    return figure, ("Root locus of the integrator on one spring and damper: both eigenvalues (petrol, amber dashed) as "
                    "stiffness or damping grows, and the unit circle, outside of which it is unstable. Diamonds: the "
                    "eigenvalue that leaves it, at the published limit. Ours, below: the limit at which bisection over "
                    f"simulated runs finds divergence. M = {M:g} kg, time step {1e3 * dt:g} ms (A.3).")


# Class -> its name, colour and hatching; light to dark, so that they can be told apart in grey.
CLASSES = {
    "stable": ("stable", style.PALE, ""),
    "dying_out": ("dying out", "#E9F3FA", "/////"),
    "vibrating": ("vibrating", "#E0A030", ""),
    "thrown_out": ("thrown out", "#B05A1E", ""),
    "diverged": ("diverged", "#7A2E00", ""),
    # Classes of runs that tell nothing of stability, and outcomes of a sweep's runs.
    "went_through": ("went through", "#8E7CC3", "xxxxx"),
    "stuck": ("stuck", "#5B7F95", "....."),
    "lost_contact": ("lost contact", "#B05A1E", "\\\\\\\\\\"),
    "not_dragged": ("not dragged", "#C9B458", "-----"),
    "no_contact": ("no contact", "#E2E2E2", ""),
    "diverges": ("diverges", "#7A2E00", ""),
    "error": ("error", "#3A3A3A", "+++++"),
}


# Known limits, in the order of their columns.
LIMIT_LOOKS = tuple({"color": colour, "lw": 1.4, "ls": line} for line in ("-", (0, (5, 2)), (0, (1, 1))) for colour in
                    (style.PLUM, "#1F4E9E", "#2E6B34"))
KNOWN = {
    "worst_hand": "limit, worst hand",
    "passive_colgate_schenkel": "passive (Colgate, Schenkel)",
    "passive_with_delay": "passive, with delay",
    "stable_gil_hulin": "stable (Gil, Hulin)",
    "passive_abbott_okamura": "passive (Abbott, Okamura)",
    "exact_undamped_handle": "exact, undamped handle",
}


def look_of_class(name):
    return CLASSES.get(name) or (name.replace("_", " "), "#C8C8C8", "xxx")


AXES = {"delay_samples": "delay [samples]", "damping_ratio": "damping ratio ζ [1]"}


def axis_label(name):
    """ "time.step_s" -> "step [s]"."""
    name = name.rpartition(".")[2]
    title, unit, _ = column(name)
    return f"{title} [{unit}]" if unit else AXES.get(name, title)


def is_geometric(values):
    return values[0] > 0 and values[-1] / values[0] > 20


def label_decades(axis):
    """Also 2 and 5 of each decade, where there is hardly more than one power of ten."""
    low, high = axis.get_view_interval()
    if axis.get_scale() != "log" or high / low > 50:
        return
    axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axis.set_minor_formatter(NullFormatter())


def edges(values):
    """Borders of the cells around the values of a grid."""
    if is_geometric(values):
        return np.exp(edges(np.log(values)))
    middle = (values[1:] + values[:-1]) / 2
    return np.concatenate([[2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]])


class OverFields:
    """limit.csv and limit_runs.csv of `limit --over`: K (the field) over another one."""

    def __init__(self, results, folder=""):
        self.limits, self.runs = (results.records(f"{folder}{name}") for name in (LIMIT, LIMIT_RUNS))
        self.field = self.limits[0]["field"]
        given = list(self.limits[0])
        self.over = given[: given.index("algorithm")]
        self.x_name = self.over[-1]
        self.algorithms = list(dict.fromkeys(row["algorithm"] for row in self.limits))

    @property
    def known(self):
        """Pairs of a column and the look of its line, of the known limits that apply somewhere."""
        looks = zip((name for name in KNOWN if name in self.limits[0]), cycle(LIMIT_LOOKS))
        return [(name, look) for name, look in looks if np.isfinite(numbers(self.limits, name)).any()]

    @property
    def has_theory(self):
        return np.isfinite(numbers(self.limits, "theory")).any()

    def groups(self):
        """The algorithms whose limits are the same, together; the largest group last."""
        groups = {}
        for algorithm in self.algorithms:
            groups.setdefault(tuple(row["limit"] for row in self.limits if row["algorithm"] == algorithm), []).append(algorithm)
        return sorted(groups.values(), key=len)

    def draw(self, ax, **subject):
        """A mark for each run of those rows whose columns have these values, in the colour of its class; lines: the limits."""
        of_subject = lambda rows: [row for row in rows if all(row[column] == value for column, value in subject.items())]
        runs, limits = of_subject(self.runs), of_subject(self.limits)
        for name in sorted({row["class"] for row in runs}):
            mine = [row for row in runs if row["class"] == name]
            ax.scatter(numbers(mine, self.x_name), numbers(mine, self.field), s=14, marker="s", color=look_of_class(name)[1], edgecolor=style.PETROL, lw=0.2)
        lines = (("theory", {"color": "white", "lw": 3.6}), ("theory", {"color": style.PETROL, "lw": 2.6}), *self.known,
                 ("limit", {"color": style.BLACK, "lw": 0.9, "ls": (0, (2, 2))}))
        x = numbers(limits, self.x_name)
        for column, look in lines:
            y = numbers(limits, column)
            ax.plot(x, np.where(np.isfinite(y) & (y > 0), y, np.nan), **look)
        edge = numbers(limits, "limit")
        edge = edge[np.isfinite(edge)]
        ax.set(xscale="log" if is_geometric(np.unique(x)) else "linear", yscale="log", ylim=(edge.min() / 20, edge.max() * 20))
        label_decades(ax.xaxis)


def class_legend(figure, found, **place):
    """The legend of marks and lines."""
    present = {row["class"] for row in found.runs}
    looks = [look_of_class(name) for name in sorted(present, key=lambda name: ([*CLASSES, name].index(name), name))]
    handles = [Patch(facecolor=colour, hatch=hatch, edgecolor=style.PETROL, lw=0) for _, colour, hatch in looks]
    names = [name for name, _, _ in looks]
    lines = [("theory", "limit, theory", {"color": style.PETROL, "lw": 2.6}), ("limit", "limit, bisection", {"color": style.BLACK, "lw": 1, "ls": (0, (2, 2))}),
             *((name, KNOWN[name], look) for name, look in found.known)]
    for column, label, look in lines:
        if np.isfinite(numbers(found.limits, column)).any():
            handles.append(Line2D([], [], **look))
            names.append(label)
    figure.legend(handles, names, ncol=4 if found.known else 6, handlelength=1.6, **place)


def draw_limits(axes, found):
    """A line for each algorithm: the limit found by bisection, and its ratio to the one in theory where there is one. Where
    lines coincide, marks at different places tell whose they are."""
    limit, *ratio, legend = axes
    for i, algorithm in enumerate(found.algorithms):
        rows = [row for row in found.limits if row["algorithm"] == algorithm]
        x, y, look = numbers(rows, found.x_name), numbers(rows, "limit"), style.look(algorithm)
        line = {"color": look.colour, "ls": look.line, "marker": look.marker, "lw": 0.9, "ms": 4.5, "markevery": (i % max(len(x), 1), len(found.algorithms))}
        limit.plot(x, y, **line)
        for ax in ratio:
            ax.plot(x, y / numbers(rows, "theory"), **line)
        legend.plot([], [], color=look.colour, ls=look.line, marker=look.marker, lw=0.9, ms=4.5, label=look.label)
    low, high = limit.dataLim.intervaly
    limit.set(title="limit, by bisection", ylabel=axis_label(found.field), yscale="log" if high > 3 * low else "linear")
    for ax in ratio:
        low, high = ax.dataLim.intervaly
        ax.set(title="its ratio to theory", ylabel="bisection / theory", ylim=(min(low, 0.998), max(high, 1.002)))
        ax.ticklabel_format(axis="y", useOffset=False)
    for ax in (limit, *ratio):
        ax.set(xlabel=axis_label(found.x_name), xscale="log" if is_geometric(np.unique(numbers(found.limits, found.x_name))) else "linear")
        label_decades(ax.xaxis)
    legend.axis("off")
    legend.legend(loc="center left", borderaxespad=0, handlelength=3.2, labelspacing=0.35)


def draw_groups(part, found, groups, lines, columns):
    axes = part.subplots(lines, columns, sharex=True, sharey=True, squeeze=False)
    for ax in axes.flat[len(groups):]:
        ax.set_visible(False)
    for i, (ax, group) in enumerate(zip(axes.flat, groups)):
        found.draw(ax, algorithm=group[0])
        names = ", ".join(style.look(name).label.removesuffix(" (ours)") for name in group)
        if i == len(groups) - 1 and len(group) > 3:
            names = f"{'all others' if i else 'all'} ({len(group)})"
        ax.set_title("\n".join(wrap(names, 30)), fontsize=6.5)
        ax.tick_params(labelbottom=i + columns >= len(groups), labelsize=7)
        if i + columns >= len(groups):
            ax.set_xlabel(axis_label(found.x_name))
    for ax in axes[:, 0]:
        ax.set_ylabel(axis_label(found.field))


def draw_over(found):
    """Above the limit of every algorithm; below the classes of the runs."""
    groups = found.groups()
    columns = min(4, max(2, len(groups)))
    lines = -(-len(groups) // columns)
    heights = (2.5, 0.6 if found.known else 0.25, 0.5 + 1.65 * lines + 0.6 * (columns == 2))
    figure = style.plt.figure(figsize=(style.WIDTH, sum(heights)))
    above, between, below = figure.subfigures(3, 1, height_ratios=heights)
    widths = [1, 1, 0.62] if found.has_theory else [2, 0.62]
    draw_limits(above.subplots(1, len(widths), gridspec_kw={"width_ratios": widths}), found)
    class_legend(between, found, loc="center")
    draw_groups(below, found, groups, lines, columns)
    return figure


def stability_over(study):
    """The function that draws what the study found."""

    def draw(results):
        found = OverFields(results, f"{study}/")
        return draw_over(found), (
            f"The largest {axis_label(found.field)} whose run stays bounded over {axis_label(found.x_name)}. Above: the limit of every algorithm, found "
            "by bisection over simulated runs, and its ratio to the limit from theory, where there is one. Below: every run of the search, by its "
            "class; algorithms with the same limits share a panel. "
            f"{'Thin lines: known limits, and the least over passive hands. ' if found.known else ''}Ours."
        )

    return draw


def integrators(results):
    """K over the time step under every integrator."""
    found = OverFields(results, "stability_integrators/")
    names = list(dict.fromkeys(row["integrator.type"] for row in found.limits))
    figure, axes = style.panels(1, len(names), 2.4, sharex="row", sharey="row")
    for ax, name in zip(axes[0], names):
        found.draw(ax, **{"integrator.type": name})
        ax.set_title(name.replace("_", " "))
        ax.tick_params(axis="x", labelrotation=30)
    axes[0, 0].set_ylabel(axis_label(found.field))
    axes[0, len(names) // 2].set_xlabel(axis_label(found.x_name))
    figure.get_layout_engine().set(rect=(0, 0, 1, 0.9))
    class_legend(figure, found, loc="upper center", bbox_to_anchor=(0.5, 1.0))
    return figure, ("Where a run stays bounded under each integrator: stiffness of one spring over the time step, every run of the search by its class. "
                    "Lines: the limit from theory, where there is one, and found by bisection over simulated runs. Ours.")


def draw_devices(results, table=LIMIT):
    rows = results.records(table)
    devices, scenes, algorithms = (list(dict.fromkeys(row[name] for row in rows)) for name in ("device", "scenario", "algorithm"))
    figure, axes = style.plt.subplots(1, len(scenes), sharex=True, sharey=True, squeeze=False,
                                figsize=(1.0 + PANEL * len(scenes), 0.9 + LEGEND + 0.24 * len(devices)))
    for ax, scene in zip(axes[0], scenes):
        for i, algorithm in enumerate(algorithms):
            mine = [row for row in rows if (row["scenario"], row["algorithm"]) == (scene, algorithm)]
            at = np.array([devices.index(row["device"]) for row in mine]) + STEP * (i - (len(algorithms) - 1) / 2)
            ax.plot(numbers(mine, "limit"), at, ls="", marker=style.look(algorithm).marker, ms=5, color=style.look(algorithm).colour,
                    label=style.look(algorithm).label)
        published = {devices.index(row["device"]): float(row["published_N_per_m"]) for row in rows if row["published_N_per_m"]}
        if published:
            places = np.array(list(published))
            ax.vlines(list(published.values()), places - 0.4, places + 0.4, color=style.BLACK, lw=1.2,
                      ls=style.PUBLISHED_LINE["ls"], label="published, of a wall")
        ax.set(title=scene.replace("_", " "), xscale="log", xlabel="largest stable stiffness K [N/m]",
               yticks=range(len(devices)), yticklabels=[name.replace("$", r"\$") for name in devices],
               ylim=(len(devices) - 0.4, -0.6))
    # A legend of the figure takes no room by itself.
    figure.get_layout_engine().set(rect=(0, 0, 1, 1 - LEGEND / figure.get_figheight()))
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper left", ncol=4)
    return figure


def of_all_devices(results):
    return draw_devices(results, f"device_limits/{LIMIT}"), (
        "The largest stiffness that each device renders stably and quietly while a hand taps with a flat probe on a wall, in a "
        "corner and in a hole a tenth wider than the probe, without damping. Short lines: the published largest stable "
        "stiffness of a wall. If shaping makes one K safe in every direction, its marks stand in one column in all panels, "
        "while those of the sum fall back by the number of contacts. Ours."
    )


MEASURED = Path(__file__).resolve().parents[3] / "scenarios" / "validation" / "measured.csv"
SCATTER = 1.3  # of sessions of measuring one setting, a factor


def hardware(results):
    """K over B of the EPFL paddle behind its three velocity filters: measured in sessions, and predicted."""
    predicted, (damping, stiffness) = results.records("hardware_paddle/limit.csv"), ("damping_N_s_per_m", "stiffness_N_per_m")
    filters = {"A": "10 Hz filter", "A'": "50 Hz filter", "A''": "1 kHz filter"}
    figure, axes = style.panels(1, len(filters), 2.7, sharey=True)
    for ax, (case, title) in zip(axes[0], filters.items()):
        measured = [row for row in read_records(MEASURED) if row["case"] == case]
        rows = [row for row in predicted if float(row["device.velocity_filter.cutoff_Hz"]) == float(measured[0]["velocity_filter_Hz"])]
        ax.plot(numbers(rows, f"rendering.{damping}"), numbers(rows, "limit"), color=style.PETROL, label="predicted")
        K = numbers(measured, stiffness)
        ax.errorbar(numbers(measured, damping), K, yerr=[K - K / SCATTER, K * SCATTER - K], fmt="o", color=style.AMBER, ms=3, lw=0.8,
                    label=f"measured, x{SCATTER:g}")
        ax.set(title=title, yscale="log", xlabel="damping B [N s/m]")
    axes[0, 0].set_ylabel("largest stable stiffness K [N/m]")
    axes[0, 0].legend()
    return figure, ("Stiffness at which a haptic paddle that a finger presses on a wall begins to vibrate, over the wall's damping, behind "
                    "three velocity filters: measured by others (scenarios/validation/measured.csv; bars: the scatter of sessions), and "
                    "predicted with one value of all that was not published, which nothing was fitted to. Where the line ends no K is stable. Ours.")
