"""Stability: the root locus of A.3, our maps of stable, vibrating and diverged runs, and the largest stable stiffness of each
device (`limit --device`)."""
from itertools import cycle
from textwrap import wrap

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

import hapbench_style as style
from hapbench_report.markup import column

from . import published
from .results import MissingResult, numbers

# Of the picture of devices.
DEVICES = "limit.csv"
PANEL = 2.6  # [inch]
LEGEND = 0.3  # [inch]
STEP = 0.16  # of a row, between algorithms
CASES = (
    ("stiffness_undamped", "A4.stiffness", "B = 0, K grows", "K", "N/m"),
    ("damping_alone", "A4.damping", "K = 0, B grows", "B", "N s/m"),
    ("stiffness_damped", "A4.stiffness.damped", "ζ = 0.7, K grows", "K", "N/m"),
)


def spaced(number):
    """A number with spaces between thousands, and with decimals if there are few digits before them."""
    return f"{number:,.{0 if number >= 1000 or number == round(number) else 3}f}".replace(",", " ")


def root_locus(results):
    locus = results.records("stability/root_locus.csv")
    limits = {row["case"]: row for row in results.records("stability/limits.csv")}
    figure, axes = style.panels(1, 3, 2.7, sharey=True)
    turn = np.linspace(0, 2 * np.pi, 181)
    for ax, (case, id_, title, symbol, unit) in zip(axes[0], CASES):
        rows = [row for row in locus if row["case"] == case]
        ax.plot(np.cos(turn), np.sin(turn), color=style.BLACK, lw=0.8)
        for which, colour, line in (("first", style.PETROL, "-"), ("second", style.AMBER, (0, (4, 1.2)))):
            ax.plot(numbers(rows, f"{which}_real"), numbers(rows, f"{which}_imaginary"), color=colour, ls=line, lw=1.5)
        value = published.value(id_)
        nearest = rows[int(np.argmin(np.abs(numbers(rows, "value") - value)))]
        poles = [complex(float(nearest[f"{which}_real"]), float(nearest[f"{which}_imaginary"])) for which in ("first", "second")]
        leaving = min(poles, key=lambda pole: pole.real)  # at -1; the other one stays inside or at 1
        ax.plot(leaving.real, leaving.imag, marker="D", mfc="white", mec=style.RED, ms=5, zorder=5)
        ours = float(limits[case]["simulation"])
        style.note(ax, 0.5, 0.98, f"published {symbol} = {spaced(value)} {unit}", style.RED, ha="center")
        style.note(ax, 0.5, 0.02, f"ours {spaced(ours)} {unit}", ha="center", va="bottom")
        ax.set(title=title, xlabel="real part", xlim=(-1.75, 1.4), ylim=(-1.6, 1.6), aspect="equal")
    axes[0, 0].set_ylabel("imaginary part")
    style.letter(axes[0])
    return figure, ("Root locus of the integrator on one spring and damper: both eigenvalues (petrol, amber dashed) as "
                    "stiffness or damping grows, and the unit circle, outside of which it is unstable. Diamonds: the "
                    "eigenvalue that leaves it, at the published limit. Ours, below: the limit at which bisection over "
                    "simulated runs finds divergence. M = 0.1 kg, time step 0.5 ms (A.3).")


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
    # Classes of pairs of runs, one from near and one from far.
    "passive": ("comes to rest from near and far", style.PALE, ""),
    "locally_stable": ("from near only", "#E9F3FA", "/////"),
    "limit_cycles": ("limit cycles", "#E0A030", ""),
    "unstable": ("unstable", "#7A2E00", ""),
}


def class_of(row):
    """The class of a row's run or, where another one begins far from rest, what both of them make."""
    far = row.get("class_from_far")
    if not far:
        return row["class"]
    rests, far_rests = (name in ("stable", "dying_out") for name in (row["class"], far))
    if far == "diverged":
        return "locally_stable" if rests else "unstable"
    return "limit_cycles" if not rests else "passive" if far_rests else "vibrating"


# Known limits, in the order of their columns.
LIMIT_LOOKS = tuple({"color": colour, "lw": 1.4, "ls": line} for line in ("-", (0, (5, 2)), (0, (1, 1))) for colour in
                    (style.PLUM, "#1F4E9E", "#2E6B34"))
LIMITS = {
    "worst_hand": "limit, worst hand",
    "passive_colgate_schenkel": "passive (Colgate, Schenkel)",
    "passive_with_delay": "passive, with delay",
    "stable_gil_hulin": "stable (Gil, Hulin)",
    "passive_abbott_okamura": "passive (Abbott, Okamura)",
    "exact_undamped_handle": "exact, undamped handle",
    "tangent": "limit, along the wall",
}


def look_of_class(name):
    return CLASSES.get(name) or (name.replace("_", " "), "#C8C8C8", "xxx")


AXES = {"contacts": "contacts [1]", "delay_samples": "delay [samples]", "damping_ratio": "damping ratio ζ [1]",
        "2b_over_KT": "2b / (KT) [1]", "2c_over_Kq": "2c / (Kq) [1]"}


def axis_label(name):
    """ "time_step_s" -> "time step [s]"."""
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


def draw_map(ax, rows, x_name, y_name):
    x, y = numbers(rows, x_name), numbers(rows, y_name)
    columns, lines = np.unique(x), np.unique(y)
    classes = np.full((len(lines), len(columns)), "", dtype=object)
    classes[np.searchsorted(lines, y), np.searchsorted(columns, x)] = [row["class"] for row in rows]
    for name in sorted(set(classes.ravel()) - {""}):
        _, colour, hatch = look_of_class(name)
        cells = np.ma.masked_where(classes != name, np.ones(classes.shape))
        ax.pcolormesh(edges(columns), edges(lines), cells, cmap=ListedColormap([colour]), rasterized=True)
        if hatch:  # a mesh has none
            ax.pcolor(edges(columns), edges(lines), cells, cmap=ListedColormap(["#FFFFFF00"]), hatch=hatch,
                      edgecolor=style.PETROL, lw=0)
    ax.grid(False)
    ax.set_xscale("log" if is_geometric(columns) else "linear")
    ax.set_yscale("log" if is_geometric(lines) else "linear")
    ax.set(xlim=edges(columns)[[0, -1]], ylim=edges(lines)[[0, -1]])
    label_decades(ax.xaxis)


def draw_boundary(ax, rows, x_name, y_name, limits=()):
    # Ever narrower, so that all show where they agree.
    for column, look in (
        (f"analytic_{y_name}", {"color": "white", "lw": 3.6}),
        (f"analytic_{y_name}", {"color": style.PETROL, "lw": 2.6}),
        *((column, {"color": "white", "lw": 2.2}) for column, _ in limits),
        *limits,
        (f"simulation_{y_name}", {"color": style.BLACK, "lw": 0.9, "ls": (0, (2, 2))}),
    ):
        if column in rows[0]:
            y = numbers(rows, column)
            ax.plot(numbers(rows, x_name), np.where(np.isfinite(y) & (y > 0), y, np.nan), **look)


class MapFile:
    """stability_map_NAME.csv and the boundary beside it."""

    def __init__(self, results, path):
        self.rows = [{**row, "class": class_of(row)} for row in results.records(path)]
        self.x_name, self.y_name = list(self.rows[0])[1:3]
        boundary = path.replace("stability_map_", "stability_boundary_")
        self.boundary = results.records(boundary) if results.has(boundary) else []

    @property
    def has_theory(self):
        return any(np.isfinite(numbers(self.boundary, f"analytic_{self.y_name}"))) if self.boundary else False

    @property
    def limits(self):
        """Pairs of a column and the look of its line, of the known limits that apply somewhere and lie on the map."""
        if not self.boundary:
            return []
        ends = f"_{self.y_name}"
        others = (self.x_name, f"analytic{ends}", f"simulation{ends}")
        names = [name for name in self.boundary[0] if name.endswith(ends) and name not in others]
        looks = zip(names, cycle(LIMIT_LOOKS))
        bottom = numbers(self.rows, self.y_name).min()
        return [(name, look) for name, look in looks if (np.nan_to_num(numbers(self.boundary, name)) > bottom).any()]

    @property
    def overrides(self):
        """Lines that say which fields of device and hand are not the map's own; none where all are."""
        text = self.rows[0].get("overrides") or ""
        return [line.replace("$", r"\$") for line in wrap(text.replace(",", ", "), 110, break_on_hyphens=False)]

    def limit_label(self, column):
        name = column.removesuffix(f"_{self.y_name}")
        return LIMITS.get(name, name.replace("_", " "))

    @property
    def integrators(self):
        return list(dict.fromkeys(row["integrator"] for row in self.rows))

    def draw(self, ax, **subject):
        """The map of those rows whose columns have these values."""

        def of_subject(rows):
            return [row for row in rows if all(row[column] == value for column, value in subject.items())]

        draw_map(ax, of_subject(self.rows), self.x_name, self.y_name)
        boundary = of_subject(self.boundary)
        if boundary:
            draw_boundary(ax, boundary, self.x_name, self.y_name, self.limits)


def map_file(results, name, of_integrators):
    """The first map of this name that compares integrators, or that does not."""
    for path in results.glob(f"**/stability_map_{name}.csv"):
        found = MapFile(results, path)
        if (len(found.integrators) > 1) == of_integrators:
            return found
    raise MissingResult(f"no {'stability_integrators' if of_integrators else 'stability_maps'}/stability_map_{name}.csv")


def class_legend(figure, maps, **place):
    """The legend of the cells and lines of the maps."""
    present = {row["class"] for found in maps for row in found.rows}
    looks = [look_of_class(name) for name in sorted(present, key=lambda name: ([*CLASSES, name].index(name), name))]
    handles = [Patch(facecolor=colour, hatch=hatch, edgecolor=style.PETROL, lw=0) for _, colour, hatch in looks]
    names = [name for name, _, _ in looks]
    for column, label, look in (("analytic", "limit, theory", {"color": style.PETROL, "lw": 2.6}),
                                ("simulation", "limit, bisection", {"color": style.BLACK, "lw": 1, "ls": (0, (2, 2))})):
        if any(np.isfinite(numbers(found.boundary, f"{column}_{found.y_name}")).any() for found in maps if found.boundary):
            handles.append(Line2D([], [], **look))
            names.append(label)
    limits = {found.limit_label(column): look for found in maps for column, look in found.limits}
    handles += [Line2D([], [], **look) for look in limits.values()]
    figure.legend(handles, [*names, *limits], ncol=4 if limits else 6, handlelength=1.6, **place)


def alike(found, algorithms):
    """The algorithms whose maps are the same, cell by cell, together; the largest group last."""
    groups = {}
    for algorithm in algorithms:
        cells = tuple((row[found.x_name], row[found.y_name], row["class"]) for row in found.rows
                      if row["algorithm"] == algorithm)
        groups.setdefault(cells, []).append(algorithm)
    return sorted(groups.values(), key=len)


def draw_limits(axes, found, algorithms):
    """A line for each algorithm: the limit found by bisection, and its ratio to the analytic one where there is one. Where
    lines coincide, marks at different places tell whose they are."""
    limit, *ratio, legend = axes
    for i, algorithm in enumerate(algorithms):
        rows = [row for row in found.boundary if row["algorithm"] == algorithm]
        x, y = numbers(rows, found.x_name), numbers(rows, f"simulation_{found.y_name}")
        y = np.where(np.isfinite(y) & (y > 0), y, np.nan)
        theory, along = f"analytic_{found.y_name}", f"tangent_{found.y_name}"
        # Across the wall or, with dry friction, along it.
        theory = np.fmin(numbers(rows, theory), numbers(rows, along)) if along in rows[0] else numbers(rows, theory)
        look = style.look(algorithm)
        line = {"color": look.colour, "ls": look.line, "marker": look.marker, "lw": 0.9, "ms": 4.5,
                "markevery": (i % max(len(x), 1), len(algorithms))}
        limit.plot(x, y, **line)
        for ax in ratio:
            ax.plot(x, y / theory, **line)
        legend.plot([], [], color=look.colour, ls=look.line, marker=look.marker, lw=0.9, ms=4.5, label=look.label)
    low, high = limit.dataLim.intervaly
    limit.set(title="limit, by bisection", ylabel=axis_label(found.y_name), yscale="log" if high > 3 * low else "linear")
    for ax in ratio:
        low, high = ax.dataLim.intervaly
        ax.set(title="its ratio to theory", ylabel="bisection / theory", ylim=(min(low, 0.998), max(high, 1.002)))
        ax.ticklabel_format(axis="y", useOffset=False)
    for ax in (limit, *ratio):
        x = np.unique(numbers(found.rows, found.x_name))
        ax.set(xlabel=axis_label(found.x_name), xscale="log" if is_geometric(x) else "linear")
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
        ax.set_ylabel(axis_label(found.y_name))


def draw_stability_map(found):
    """Above the limit of every algorithm, where there is one; below the classes of the runs. `found`: of one integrator."""
    present = list(dict.fromkeys(row["algorithm"] for row in found.rows))
    groups = alike(found, present)
    columns = min(4, max(2, len(groups)))
    lines = -(-len(groups) // columns)
    heights = (2.5 + 0.14 * len(found.overrides), 0.6 if found.limits else 0.25, 0.5 + 1.65 * lines + 0.6 * (columns == 2))
    figure = style.plt.figure(figsize=(style.WIDTH, sum(heights)))
    above, between, below = figure.subfigures(3, 1, height_ratios=heights)
    widths = [1, 1, 0.62] if found.has_theory else [2, 0.62]
    if found.overrides:
        above.suptitle("\n".join(["with " + found.overrides[0], *found.overrides[1:]]), fontsize=7)
    draw_limits(above.subplots(1, len(widths), gridspec_kw={"width_ratios": widths}), found, present)
    class_legend(between, [found], loc="center")
    draw_groups(below, found, groups, lines, columns)
    return figure


def stability_map(name):
    """The function that draws stability_map_NAME.csv."""

    def draw(results):
        found = map_file(results, name, of_integrators=False)
        figure = draw_stability_map(found)
        present = list(dict.fromkeys(row["algorithm"] for row in found.rows))
        x_label, y_label = axis_label(found.x_name), axis_label(found.y_name)
        return figure, (
            f"Where a run is stable, vibrates or diverges: {y_label} over {x_label}. Above: the limit of every algorithm, found "
            "by bisection over simulated runs, and its ratio to the limit from theory, where there is one. Below: the class of "
            f"single runs; algorithms whose {len(found.rows) // len(present)} runs fall into the same classes share a panel. "
            f"{'Thin lines: known limits, and the least over passive hands. ' if found.limits else ''}"
            "Single cells beyond the limit are runs that are not stable, but stay within the bounds, or leave them, by chance. Ours."
        )

    return draw


def integrators(results):
    """The maps of one algorithm under every integrator."""
    maps = [map_file(results, name, of_integrators=True) for name in ("time_step", "damping_ratio", "device")]
    names = maps[0].integrators
    algorithm = maps[0].rows[0]["algorithm"]
    figure, axes = style.panels(len(maps), len(names), 2.0 * len(maps), sharex="row", sharey="row")
    for line, found in zip(axes, maps):
        for ax, name in zip(line, names):
            found.draw(ax, algorithm=algorithm, integrator=name)
            ax.tick_params(axis="x", labelrotation=30)
        line[0].set_ylabel(axis_label(found.y_name))
        line[len(names) // 2].set_xlabel(axis_label(found.x_name))
    for ax, name in zip(axes[0], names):
        ax.set_title(name.replace("_", " "))
    figure.get_layout_engine().set(rect=(0, 0, 1, 0.95))
    class_legend(figure, maps, loc="upper center", bbox_to_anchor=(0.5, 1.0))
    return figure, ("Where a run is stable, still dies out, vibrates or diverges under each integrator, "
                    f"{style.look(algorithm).label}: stiffness of one spring over the time step and over zeta, stiffness of "
                    "the hand over the delay of the device's servo. Lines: the limit from theory, where there is one, and "
                    "found by bisection over simulated runs. Ours.")


def draw_devices(results, table=DEVICES):
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
    return draw_devices(results, f"devices/{DEVICES}"), (
        "The largest stiffness that each device renders stably and quietly while a hand taps with a flat probe on a wall, in a "
        "corner and in a hole a tenth wider than the probe, without damping. Short lines: the published largest stable "
        "stiffness of a wall. If shaping makes one K safe in every direction, its marks stand in one column in all panels, "
        "while those of the sum fall back by the number of contacts. Ours."
    )
