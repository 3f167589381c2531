"""Plots results over fields: curves and classes of runs over two axes. Used by limit_plot, tuning_plot,
convergence_plot and sweep_plot."""
from dataclasses import dataclass

import numpy as np

from hapbench_looks import look, look_of_class
from hapbench_style import PETROL, equal_curves, number_ticks, striped

MAX_TICKS = 12


@dataclass
class Axis:
    """One axis of a plot: its numbers, or the positions of texts."""

    title: str
    values: np.ndarray
    names: tuple = ()
    log: bool = False

    @property
    def label(self):
        """Returns the title with its unit; the unit 1 marks numbers without a unit."""
        return (
            f"{self.title} [1]"
            if self.title and not self.names and "[" not in self.title
            else self.title
        )

    @classmethod
    def of(cls, title, values, log=None):
        """Creates an axis. `log`: None selects a logarithmic axis by the range of the values."""
        if isinstance(values, list):
            names = tuple(dict.fromkeys(values))
            return cls(title, np.array([names.index(value) for value in values], float), names)
        return cls(title, values, (), spread_logarithmically(values) if log is None else log)


def spread_logarithmically(values):
    values = values[np.isfinite(values)]
    return bool(values.size) and values.min() > 0 and values.max() > 30 * values.min()


def over_axes(ax, x, y, series=(), runs=()):
    """Draws curves and runs. `series`: label, x values, y values and look of each curve; coinciding curves are drawn as
    stripes. `runs`: for each class the positions of its runs. `x`, `y`: the Axis of either direction.
    """
    size = 26 if sum(len(xs) for _, xs, _ in runs) < 100 else 9
    for name, xs, ys in runs:
        title, colour, hatch = look_of_class(name)
        ax.scatter(
            xs,
            ys,
            s=size,
            marker="s",
            color=colour,
            edgecolor=PETROL,
            lw=0.3,
            hatch=hatch,
            label=title,
        )
    for (label, xs, ys, style), (index, count) in zip(
        series, equal_curves([(xs, ys) for _, xs, ys, _ in series])
    ):
        if count > 1 and len(xs) > 1:
            style = {**style, "markevery": (index % len(xs), count)} | (
                {"ls": striped(style["ls"], index, count)}
                if style.get("ls", "none") != "none"
                else {}
            )
        ax.plot(xs, ys, label=label, **style)
    for along, of, set_scale in ((ax.xaxis, x, ax.set_xscale), (ax.yaxis, y, ax.set_yscale)):
        along.set_label_text(of.label)
        if of.names:
            along.set_ticks(range(len(of.names)), of.names)
        elif of.log:
            set_scale("log")
            number_ticks(along)
        else:
            integer_ticks(along, of.values)


def integer_ticks(along, values):
    """Sets ticks at the values of an integer field."""
    values = np.unique(values[np.isfinite(values)])
    if (
        1 < len(values) <= MAX_TICKS
        and (values == values.round()).all()
        and not spread_logarithmically(values)
    ):
        along.set_ticks(values, [f"{value:.0f}" for value in values])


def look_of(algorithm, **more):
    appearance = look(algorithm)
    return {
        "color": appearance.colour,
        "ls": appearance.line,
        "marker": appearance.marker,
        "lw": 1.0,
        "ms": 4.5,
        **more,
    }


def with_room(low, high, above=1.0):
    """Returns limits around a range on a logarithmic axis, with room for marks and names."""
    room = max((high / low) ** 0.12, 1.3)
    return low / room, high * room * above


def pareto(points):
    """Returns the points that no other point dominates in both coordinates, sorted by the first coordinate."""
    points = points[np.all(np.isfinite(points), axis=1)]
    front, smallest = [], np.inf
    for point in points[np.lexsort((points[:, 1], points[:, 0]))]:
        if point[1] < smallest:
            front.append(point)
            smallest = point[1]
    return np.array(front).reshape(-1, 2)
