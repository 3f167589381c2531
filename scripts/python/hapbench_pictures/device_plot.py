"""The limits of `limit --device` as a picture: on each device, and of each device over another field. A device has
one colour, the linear and the simulated limit have marks of their own."""
import numpy as np
from matplotlib.lines import Line2D

from hapbench.columns import numbers
from hapbench_looks import SERIES, look
from hapbench_style import BLACK, GREY, PUBLISHED_LINE, legend_above, legend_height

from .given import axis
from .over_axes import Axis, over_axes

# The variants of a preset, such as "touch[soft]", have its colour and thinner lines.
LINEAR = {"marker": "s", "mfc": "white", "mew": 1.1, "ms": 4.2}
SIMULATED = {"marker": "o", "ms": 4.2}
# A simulated limit where the whole range to its end is stable: the limit is larger.
BEYOND = {"ms": 5.0}
BEYOND_MARKERS = {"x": ">", "y": "^"}  # by the axis of the limit
MARKS = (("linear limit", LINEAR), ("simulated limit", SIMULATED))
BEYOND_LABEL = "simulated: stable to the end of the range"
PUBLISHED_LABEL = "published, for a wall"
THIN = 0.7  # line width of variants [points]
VARIANT_LABEL = "thin: ends of unpublished parameters"


def device_of(row):
    """The device without the variant: "touch" of "touch[soft]"."""
    return row["device"].partition("[")[0].rstrip("*")


def looks_of(rows):
    """Device -> its look; the order is that of the table."""
    names = list(dict.fromkeys(map(device_of, rows)))
    return {name: SERIES[i % len(SERIES)] for i, name in enumerate(names)}


def linear(rows):
    """The linear limit of each row: that of the contact loop, or the theoretical limit of bilateral springs."""
    own, theory = numbers(rows, "linear_limit"), numbers(rows, "theoretical_limit")
    values = np.where(np.isfinite(own), own, theory)
    return np.where(np.isfinite(values) & (values > 0), values, np.nan)


def simulated(rows):
    """The simulated limits, and which of them are the end of the searched range, where no limit was found."""
    ends = np.array([row["side"] == "largest" and not row["first_unstable"] for row in rows], bool)
    values = np.where(ends, numbers(rows, "stable_high"), numbers(rows, "limit"))
    return values, ends & np.isfinite(values)


def published(rows):
    """Device -> its published limit."""
    return {
        device_of(row): float(row["published_N_per_m"])
        for row in rows
        if row.get("published_N_per_m")
    }


def legend_of_marks(rows, along):
    """Handles and labels of the marks that are drawn. `along`: the axis of the limit, "x" or "y"."""
    ends, beyond = simulated(rows)[1], {**BEYOND, "marker": BEYOND_MARKERS[along]}
    drawn = [
        *(MARKS[:1] if np.isfinite(linear(rows)).any() else ()),
        *(MARKS[1:] if np.isfinite(simulated(rows)[0][~ends]).any() else ()),
        *(((BEYOND_LABEL, beyond),) if ends.any() else ()),
    ]
    entries = [(Line2D([], [], color=BLACK, ls="none", **own), label) for label, own in drawn]
    if published(rows):
        line = Line2D([], [], color=BLACK, lw=1.2, ls=PUBLISHED_LINE["ls"])
        entries.append((line, PUBLISHED_LABEL))
    if along == "y" and any("[" in row["device"] for row in rows):
        entries.append((Line2D([], [], color=BLACK, lw=THIN), VARIANT_LABEL))
    return entries


def panels_of(rows):
    """Title -> its rows, for each scene and law."""
    found = {}
    for row in rows:
        title = f"{row['scenario'].replace('_', ' ')}, {look(row['algorithm']).label}"
        found.setdefault(title, []).append(row)
    return found


def title_of(found):
    """The title of the limits, such as "largest stable stiffness K [N/m]"."""
    return f"{found.rows[0]['side']} stable {axis(found.field)}"


def draw_devices_over(found, sheet):
    """Both limits over the last field of --over, a colour for each device."""
    panels, own = panels_of(found.rows), looks_of(found.rows)
    marks = legend_of_marks(found.rows, "y")
    entries = [(Line2D([], [], color=one.colour, lw=2), name) for name, one in own.items()] + marks
    rows, columns = sheet.grid(len(panels))
    height = 0.3 + 2.6 * rows + legend_height([label for _, label in entries], sheet.width)
    figure, axes = sheet.panels(rows, columns, height, sharex=True, sharey=True)
    for ax, (title, of_panel) in zip(axes.flat, panels.items()):
        series = []
        for name in dict.fromkeys(row["device"] for row in of_panel):
            mine = [row for row in of_panel if row["device"] == name]
            series += curves_of(found, mine, own[device_of(mine[0])].colour, "[" in name)
        y = [values for _, _, values, _ in series]
        over_axes(
            ax,
            found.axis(),
            Axis.of(title_of(found).replace("stable ", "stable\n"), np.concatenate(y)),
            series,
        )
        for name, value in published(of_panel).items():
            ax.axhline(value, color=own[name].colour, lw=1.2, ls=PUBLISHED_LINE["ls"])
        ax.set_title(title)
    for ax in axes.flat[len(panels) :]:
        ax.set_visible(False)
    for ax in axes[:, 1:].flat:
        ax.set_ylabel("")
    legend_above(figure, *zip(*entries), columns=None)
    return figure


def curves_of(found, rows, colour, is_variant):
    """Both limits of one device as series of over_axes()."""
    x, (values, ends) = found.along(rows), simulated(rows)
    shown = {"color": colour, "mec": colour, "lw": THIN if is_variant else 1.3}
    beyond = {**shown, **BEYOND, "marker": BEYOND_MARKERS["y"], "ls": "none"}
    return [
        (None, x, linear(rows), {**shown, **LINEAR, "ls": "-"}),
        (None, x, np.where(ends, np.nan, values), {**shown, **SIMULATED, "ls": (0, (3, 1.5))}),
        (None, x[ends], values[ends], beyond),
    ]


def draw_devices(found, sheet):
    """Both limits on each device, a panel for each scene and law."""
    panels, own = panels_of(found.rows), looks_of(found.rows)
    devices = list(dict.fromkeys(row["device"] for row in found.rows))
    marks = legend_of_marks(found.rows, "x")
    rows, columns = sheet.grid(len(panels))
    height = rows * (0.65 + 0.24 * len(devices)) + 0.4
    figure, axes = sheet.panels(rows, columns, height, sharex=True, sharey=True)
    for ax, (title, of_panel) in zip(axes.flat, panels.items()):
        places = np.array([devices.index(row["device"]) for row in of_panel], float)
        values, ends = simulated(of_panel)
        beyond = {**BEYOND, "marker": BEYOND_MARKERS["x"]}
        series = []
        for name, one in own.items():
            mine = np.array([device_of(row) == name for row in of_panel])
            shown = {"color": one.colour, "mec": one.colour, "ls": "none"}
            series += [
                (None, linear(of_panel)[mine], places[mine], {**shown, **LINEAR}),
                (None, values[mine & ~ends], places[mine & ~ends], {**shown, **SIMULATED}),
                (None, values[mine & ends], places[mine & ends], {**shown, **beyond}),
            ]
        limits = Axis(title_of(found), np.array([]), log=True)
        over_axes(ax, limits, Axis.of("", devices), series)
        for place, row in zip(places, of_panel):
            span = sorted(v for v in (linear([row])[0], simulated([row])[0][0]) if np.isfinite(v))
            ax.plot(span, [place] * len(span), color=GREY, lw=0.7, zorder=1)
            value = published([row]).get(device_of(row))
            if value:
                ax.vlines(
                    value,
                    place - 0.4,
                    place + 0.4,
                    color=own[device_of(row)].colour,
                    lw=1.4,
                    ls=PUBLISHED_LINE["ls"],
                )
        ax.set(title=title, ylim=(len(devices) - 0.4, -0.6))
    for ax in axes.flat[len(panels) :]:
        ax.set_visible(False)
    legend_above(figure, *zip(*marks), columns=None)
    return figure
