"""Makes the texts of a picture legible: tick labels fit side by side, a power of ten stands in the title of its axis,
and a legend shows every name."""
import re

from matplotlib.ticker import (
    AutoLocator,
    FixedLocator,
    FuncFormatter,
    Locator,
    LogLocator,
    MaxNLocator,
    ScalarFormatter,
)

from hapbench.columns import is_number
from hapbench_report.markup import SUPERSCRIPT
from hapbench_style import SETTINGS, legend_above

# Width of a digit of a tick label, and distance between two tick labels [inch].
DIGIT, GAP = 0.64 * SETTINGS["xtick.labelsize"] / 72, 0.06
POWERS = (-3, 6)  # from these powers of ten on, tick labels are numbers times a power of ten
STEPS = (1, 2, 2.5, 5, 10)  # distances of ticks that AutoLocator uses


class SpacedLocator(Locator):
    """Ticks of the first of several locators whose tick labels fit side by side. If none fit, the first and the last
    tick of the locator with the most ticks."""

    def __init__(self, *locators):
        self.locators = locators

    def set_axis(self, axis):
        super().set_axis(axis)
        for locator in self.locators:
            locator.set_axis(axis)

    def nonsingular(self, low, high):
        return self.locators[0].nonsingular(low, high)

    def view_limits(self, low, high):
        return self.locators[0].view_limits(low, high)

    def __call__(self):
        low, high = sorted(self.axis.get_view_interval())
        found = []
        for locator in self.locators:
            found.append([tick for tick in locator() if low <= tick <= high])
            if len(found[-1]) > 1 and self.fit(found[-1]):
                return found[-1]
        most = max(found, key=len)
        return most if len(most) < 2 else [most[0], most[-1]]

    def tick_values(self, low, high):
        return self.locators[0].tick_values(low, high)

    def fit(self, ticks):
        """Returns True if the labels of these ticks fit side by side."""
        axes = self.axis.axes
        widths = [DIGIT * len(label) for label in self.axis.major.formatter.format_ticks(ticks)]
        at = axes.transData.transform([(tick, axes.get_ylim()[0]) for tick in ticks])[:, 0]
        at = at / axes.figure.dpi
        return all(
            abs(right - left) >= (width + next_width) / 2 + GAP
            for left, right, width, next_width in zip(at, at[1:], widths, widths[1:])
        )


def with_legible_ticks(figure):
    """Spaces the tick labels of each horizontal axis, and writes their power of ten into the title of the axis. Returns
    the figure."""
    for axes in figure.axes:
        along = axes.xaxis
        space_ticks(along)
        if isinstance(along.get_major_formatter(), ScalarFormatter):
            name_power(along)
    return figure


def space_ticks(along):
    locator, formatter = along.get_major_locator(), along.get_major_formatter()
    if isinstance(locator, AutoLocator) and isinstance(formatter, ScalarFormatter):
        fewer = [MaxNLocator(count, steps=STEPS) for count in range(9, 0, -1)]
    elif isinstance(locator, LogLocator) and isinstance(formatter, FuncFormatter):
        fewer = [LogLocator(subs=subs) for subs in ((1, 3), (1,))]
    elif isinstance(locator, FixedLocator) and all(map(is_number, labels_of(locator, formatter))):
        fewer = [FixedLocator(locator.locs[::nth]) for nth in range(2, len(locator.locs))]
    else:
        return
    along.set_major_locator(SpacedLocator(locator, *fewer))


def labels_of(locator, formatter):
    return formatter.format_ticks(locator.locs)


def name_power(along):
    """Writes the power of ten of the tick labels into the title of the axis: "[N]" becomes "[10⁻⁹ N]". Matplotlib would
    write the power beside the axis, where it may overlap the title."""
    formatter, title = along.get_major_formatter(), along.get_label_text()
    formatter.set_useOffset(False)
    formatter.set_powerlimits(POWERS)
    formatter.set_locs(along.get_major_locator()())
    power = formatter.orderOfMagnitude
    if not power:
        formatter.set_scientific(False)
        return
    formatter.set_powerlimits((power, power))
    if not title or "[" in title:
        along.offsetText.set_visible(False)
        factor = "10" + str(power).translate(SUPERSCRIPT)
        along.set_label_text(
            title.replace("[", f"[{factor} ", 1).replace(f"{factor} 1]", f"{factor}]")
        )


def legend_of_names(legend, handles, labels):
    """Calls legend(handles, labels), which returns a legend. Matplotlib leaves out a label that begins with "_", such
    as the name "_old" of a run. The labels are therefore set afterwards."""
    created = legend(handles, [re.sub("^_", "-", label) for label in labels])
    for text, label in zip(created.get_texts(), labels):
        text.set_text(label)


def legend_of_names_above(figure, handles, labels):
    """Adds a legend above all panels, also for names that begin with "_"."""

    def legend(handles, labels):
        legend_above(figure, handles, labels, columns=None)
        return figure.legends[-1]

    legend_of_names(legend, handles, labels)
