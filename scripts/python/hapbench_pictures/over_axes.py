"""Plots results over the values of fields: curves of numbers over one field, and marks for the classes of runs over two
fields. limit_plot, tuning_plot, convergence_plot and sweep_plot use these functions."""
from dataclasses import dataclass

import numpy as np

from hapbench_looks import look, look_of_class
from hapbench_style import PETROL, equal_curves, number_ticks, striped

MAX_TICKS = 12


@dataclass
class Axis:
    """One axis of a plot. For numbers, `values` are the numbers and `names` is empty. For texts, `names` are the
    distinct texts and `values` are their positions on the axis."""

    title: str
    values: np.ndarray
    names: tuple = ()
    log: bool = False

    @property
    def label(self):
        """Returns the title with its unit; the unit of numbers without a unit is printed as 1."""
        return (
            f"{self.title} [1]"
            if self.title and not self.names and "[" not in self.title
            else self.title
        )

    @classmethod
    def of(cls, title, values, log=None):
        """Creates an axis for numbers (array) or texts (list). `log`: true for a logarithmic axis. If `log` is None,
        the axis is logarithmic if spread_logarithmically() returns True for the numbers."""
        if isinstance(values, list):
            names = tuple(dict.fromkeys(values))
            return cls(title, np.array([names.index(value) for value in values], float), names)
        return cls(title, values, (), spread_logarithmically(values) if log is None else log)


def spread_logarithmically(values):
    values = values[np.isfinite(values)]
    return bool(values.size) and values.min() > 0 and values.max() > 30 * values.min()


def over_axes(ax, x, y, series=(), runs=()):
    """Draws curves and the classes of runs. `series`: (label, x values, y values, look) of each curve; coinciding
    curves are drawn as stripes. `runs`: (class, x values, y values) of the runs of each class. `x`, `y`: the Axis of
    each direction."""
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
    """Sets ticks at the values if they are integers, few and not spread logarithmically."""
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
    """Returns (lower limit, upper limit) of a logarithmic axis around a range, with space for marks and names. `above`:
    additional factor of the upper limit."""
    room = max((high / low) ** 0.12, 1.3)
    return low / room, high * room * above


def pareto(points):
    """Returns the points of the Pareto front, sorted by the first coordinate. For a point of the front, no other point
    is smaller or equal in both coordinates. Of equal points, only one is returned."""
    points = points[np.all(np.isfinite(points), axis=1)]
    front, smallest = [], np.inf
    for point in points[np.lexsort((points[:, 1], points[:, 0]))]:
        if point[1] < smallest:
            front.append(point)
            smallest = point[1]
    return np.array(front).reshape(-1, 2)
