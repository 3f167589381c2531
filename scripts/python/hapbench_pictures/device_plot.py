"""Picture of the limits of `limit --device`. Without --over, each device has one limit. With --over, each device has a
curve of limits over the values of the last field of --over.
Each device has one colour; the linear limit and the simulated limit have different marks."""
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.transforms import ScaledTranslation

from hapbench.columns import number_in, numbers
from hapbench_looks import law_name, series
from hapbench_style import BLACK, GREY, PUBLISHED_LINE, legend_above, legend_height

from .given import axis
from .legibility import legend_of_names_above
from .over_axes import Axis, over_axes

# Plot styles of the limits. Variants of a preset, such as "touch[soft]", have the colour of the preset and thinner
# lines.
LINEAR = {"marker": "s", "mfc": "white", "mew": 1.1, "ms": 4.2}
SIMULATED = {"marker": "o", "ms": 4.2}
# Style of a simulated limit that does not separate stable from unstable runs: there are unstable runs on its stable
# side, or stable runs on its unstable side. No line joins this limit to other limits.
ALTERNATING = {"marker": "o", "mfc": "white", "mew": 1.1, "ms": 4.2, "ls": "none"}
# Style of a limit that is larger than the searched range, because all runs up to the end of the range are stable.
BEYOND = {"ms": 4.2, "mfc": "white", "mew": 0.9}
BEYOND_MARKERS = {"x": ">", "y": "^"}  # marker by the axis on which the limit is drawn
# Style of the ring around the limit to quote, and of a mark at the edge for a row without one.
QUOTED = {"marker": "o", "mfc": "none", "mew": 1.0, "ms": 9, "ls": "none"}
UNQUOTED = {"marker": "x", "mew": 1.2, "ms": 4.5, "ls": "none"}
QUOTED_LABEL, UNQUOTED_LABEL = "ring: limit to quote", "at the edge: no limit to quote"
BEYOND_ROW = 5.5  # distance between the marks of two devices at the end of the range [points]
NON_MONOTONIC = "non_monotonic_runs"
BEYOND_LABEL = "stable to the end of the range: a row for each device"
ALTERNATING_LABEL = "simulated: stable and unstable runs alternate"
PUBLISHED_LABEL = "published, for a wall"
THIN = 0.7  # line width of variants [points]
VARIANT_LABEL = "thin: ends of unpublished parameters"


def device_of(row):
    """Returns the device of a row without its variant: "touch" for "touch[soft]"."""
    return row["device"].partition("[")[0].rstrip("*")


def looks_of(rows):
    """Returns the look of each device by name, in the order of the table."""
    names = list(dict.fromkeys(map(device_of, rows)))
    return dict(zip(names, series(len(names))))


def linear(rows):
    """Returns the linear limit of each row. If the row has no linear limit, returns its theoretical limit, which holds
    for bilateral springs. The value is NaN if the row has neither limit, or if the limit is not positive.
    """
    linear_limit, theory = numbers(rows, "linear_limit"), numbers(rows, "theoretical_limit")
    values = np.where(np.isfinite(linear_limit), linear_limit, theory)
    return np.where(np.isfinite(values) & (values > 0), values, np.nan)


def simulated(rows):
    """Returns (simulated limit of each row, True for each limit at the end of the searched range). A limit at the end
    of the range means that no unstable run was found."""
    ends = np.array([row["side"] == "largest" and not row["first_unstable"] for row in rows], bool)
    values = np.where(ends, numbers(rows, "stable_high"), numbers(rows, "limit"))
    return values, ends & np.isfinite(values)


def alternate(rows):
    """Returns for each row True if its stable and unstable runs alternate, so that no single limit separates them."""
    return np.array([row.get(NON_MONOTONIC) not in (None, "", "0") for row in rows], bool)


def without_quote(rows):
    """Returns for each row True if it has no limit to quote although unstable runs were found."""
    return ~np.isfinite(numbers(rows, "quoted_limit")) & ~simulated(rows)[1]


def simulated_kinds(rows):
    """Returns three arrays with the simulated limits of the rows: limits that separate stable from unstable runs,
    limits of rows in which stable and unstable runs alternate, and limits at the end of the searched range. The limit
    of a row is in one of the arrays; the other two arrays have NaN for this row."""
    values, ends = simulated(rows)
    alternating = alternate(rows) & ~ends
    return [np.where(of, values, np.nan) for of in (~ends & ~alternating, alternating, ends)]


def published(rows):
    """Returns the published limit [N/m] by device. Devices without a published limit are left out."""
    return {
        device_of(row): number_in(row, "published_N_per_m")
        for row in rows
        if row.get("published_N_per_m")
    }


def legend_of_marks(rows, along):
    """Returns (handle, label) of each kind of mark that the picture has. `along`: the axis on which limits are drawn,
    "x" or "y"."""
    separated, alternating, ends = simulated_kinds(rows)
    marks = (
        ("linear limit", linear(rows), LINEAR),
        ("simulated limit", separated, SIMULATED),
        (ALTERNATING_LABEL, alternating, ALTERNATING),
        (BEYOND_LABEL, ends, {**BEYOND, "marker": BEYOND_MARKERS[along]}),
        (QUOTED_LABEL, numbers(rows, "quoted_limit"), QUOTED),
        (UNQUOTED_LABEL, np.where(without_quote(rows), 0.0, np.nan), UNQUOTED),
    )
    entries = [
        (Line2D([], [], color=BLACK, **{"ls": "none", **style}), label)
        for label, values, style in marks
        if np.isfinite(values).any()
    ]
    if published(rows):
        line = Line2D([], [], color=BLACK, lw=1.2, ls=PUBLISHED_LINE["ls"])
        entries.append((line, PUBLISHED_LABEL))
    if along == "y" and any("[" in row["device"] for row in rows):
        entries.append((Line2D([], [], color=BLACK, lw=THIN), VARIANT_LABEL))
    return entries


def panels_of(rows):
    """Returns the rows of each panel, keyed by the title of the panel. Each combination of scene and law has a
    panel."""
    found = {}
    for row in rows:
        title = f"{row['scenario'].replace('_', ' ')}, {law_name(row['algorithm'])}"
        found.setdefault(title, []).append(row)
    return found


def title_of(found):
    """Returns the title of the axis on which limits are drawn, such as "largest stable stiffness K [N/m]"."""
    return f"{found.rows[0]['side']} stable {axis(found.field)}"


def draw_devices_over(found, sheet):
    """Draws the linear and the simulated limit over the last field of --over, with a colour for each device."""
    panels, looks = panels_of(found.rows), looks_of(found.rows)
    marks = legend_of_marks(found.rows, "y")
    entries = [
        (Line2D([], [], color=one.colour, lw=2), name) for name, one in looks.items()
    ] + marks
    rows, columns = sheet.grid(len(panels))
    height = (
        0.3 + sheet.panel(2.6) * rows + legend_height([label for _, label in entries], sheet.width)
    )
    figure, axes = sheet.panels(rows, columns, height, sharex=True, sharey=True)
    for ax, (title, of_panel) in zip(axes.flat, panels.items()):
        series = []
        for name in dict.fromkeys(row["device"] for row in of_panel):
            mine = [row for row in of_panel if row["device"] == name]
            series += curves_of(found, mine, looks[device_of(mine[0])].colour, "[" in name)
        # The marks at the end of the range also belong to the axis: a linear axis would press the curves together.
        y = [values for _, _, values, _ in series] + [simulated_kinds(of_panel)[2]]
        over_axes(
            ax,
            found.axis(),
            Axis.of(title_of(found).replace("stable ", "stable\n"), np.concatenate(y)),
            series,
        )
        mark_ends(ax, found, of_panel, looks)
        mark_quotes(ax, found, of_panel, looks)
        for name, value in published(of_panel).items():
            ax.axhline(value, color=looks[name].colour, lw=1.2, ls=PUBLISHED_LINE["ls"])
        ax.set_title(title)
    for ax in axes.flat[len(panels) :]:
        ax.set_visible(False)
    for ax in axes[:, 1:].flat:
        ax.set_ylabel("")
    legend_of_names_above(figure, *zip(*entries))
    return figure


def curves_of(found, rows, colour, is_variant):
    """Returns curves of the linear and the simulated limits of one device: (label, x values, y values, plot style) of
    each curve."""
    x, (separated, alternating, _) = found.along(rows), simulated_kinds(rows)
    shown = {"color": colour, "mec": colour, "lw": THIN if is_variant else 1.3}
    return [
        (None, x, linear(rows), {**shown, **LINEAR, "ls": "-"}),
        (None, x, separated, {**shown, **SIMULATED, "ls": (0, (3, 1.5))}),
        (None, x, alternating, {**shown, **ALTERNATING}),
    ]


def mark_ends(ax, found, rows, looks):
    """Draws marks at the end of the range for devices that are stable up to this end. Each device has its own row of
    marks, which includes the variants of the device; the rows lie below each other."""
    of_device = {}
    for row, x, y in zip(rows, found.along(rows), simulated_kinds(rows)[2]):
        if np.isfinite(y):
            of_device.setdefault(device_of(row), {})[x, y] = None
    if not of_device:
        return
    inches = ax.get_figure().dpi_scale_trans
    for line, (name, ends) in enumerate(of_device.items()):
        shown = {**BEYOND, "marker": BEYOND_MARKERS["y"], "ls": "none", "color": looks[name].colour}
        lower = ScaledTranslation(0.0, -line * BEYOND_ROW / 72, inches)
        ax.plot(*zip(*ends), **shown, transform=ax.transData + lower)
        ax.update_datalim(list(ends))
    ax.autoscale_view()


def mark_quotes(ax, found, rows, looks):
    """Draws a ring around each limit to quote, and a mark at the lower edge for each row without one. Each device has
    its own row of marks; the rows lie above each other."""
    inches = ax.get_figure().dpi_scale_trans
    names = list(dict.fromkeys(map(device_of, rows)))
    for line, name in enumerate(names):
        mine = [row for row in rows if device_of(row) == name]
        x, none, colour = found.along(mine), without_quote(mine), looks[name].colour
        ax.plot(x, numbers(mine, "quoted_limit"), color=colour, **QUOTED)
        higher = ScaledTranslation(0.0, (line + 0.7) * BEYOND_ROW / 72, inches)
        edge = ax.get_xaxis_transform() + higher
        ax.plot(x[none], np.zeros(none.sum()), color=colour, transform=edge, **UNQUOTED)
    ax.update_datalim([(x, 0.0) for x in found.along(rows)], updatey=False)
    ax.autoscale_view(scaley=False)


def draw_devices(found, sheet):
    """Draws the linear and the simulated limit of each device, with a panel for each combination of scene and law."""
    panels, looks = panels_of(found.rows), looks_of(found.rows)
    devices = list(dict.fromkeys(row["device"] for row in found.rows))
    marks = legend_of_marks(found.rows, "x")
    rows, columns = sheet.grid(len(panels))
    labels = [label for _, label in marks]
    height = rows * (0.65 + 0.24 * len(devices)) + legend_height(labels, sheet.width)
    figure, axes = sheet.panels(rows, columns, height, sharex=True, sharey=True)
    for ax, (title, of_panel) in zip(axes.flat, panels.items()):
        heights = np.array([devices.index(row["device"]) for row in of_panel], float)
        separated, alternating, ends = simulated_kinds(of_panel)
        beyond = {**BEYOND, "marker": BEYOND_MARKERS["x"]}
        series = []
        for name, one in looks.items():
            mine = np.array([device_of(row) == name for row in of_panel])
            shown = {"color": one.colour, "mec": one.colour, "ls": "none"}
            series += [
                (None, linear(of_panel)[mine], heights[mine], {**shown, **LINEAR}),
                (None, separated[mine], heights[mine], {**shown, **SIMULATED}),
                (None, alternating[mine], heights[mine], {**shown, **ALTERNATING}),
                (None, ends[mine], heights[mine], {**shown, **beyond}),
            ]
        limits = Axis(title_of(found), np.array([]), log=True)
        over_axes(ax, limits, Axis.of("", devices), series)
        for y, row in zip(heights, of_panel):
            span = sorted(v for v in (linear([row])[0], simulated([row])[0][0]) if np.isfinite(v))
            ax.plot(span, [y] * len(span), color=GREY, lw=0.7, zorder=1)
            value = published([row]).get(device_of(row))
            if value:
                ax.vlines(
                    value,
                    y - 0.4,
                    y + 0.4,
                    color=looks[device_of(row)].colour,
                    lw=1.4,
                    ls=PUBLISHED_LINE["ls"],
                )
        inside = ax.get_yaxis_transform() + ScaledTranslation(4 / 72, 0.0, figure.dpi_scale_trans)
        for y, row, none in zip(heights, of_panel, without_quote(of_panel)):
            colour = looks[device_of(row)].colour
            ax.plot(*numbers([row], "quoted_limit"), y, color=colour, **QUOTED)
            if none:
                ax.plot(0.0, y, color=colour, transform=inside, **UNQUOTED)
        ax.set(title=title, ylim=(len(devices) - 0.4, -0.6))
    for ax in axes.flat[len(panels) :]:
        ax.set_visible(False)
    legend_above(figure, *zip(*marks), columns=None)
    return figure
