"""One plot for what the program finds over fields: curves and classes of runs over two axes. limit_plot,
tuning_plot, convergence_plot and sweep_plot draw by it."""
from dataclasses import dataclass

import numpy as np

from hapbench_looks import look, look_of_class
from hapbench_style import PETROL, equal_curves, number_ticks, striped

MOST_TICKS = 12


@dataclass
class Axis:
    """One direction of a plot: its numbers, or the places of texts."""

    title: str
    values: np.ndarray
    names: tuple = ()
    log: bool = False

    @property
    def label(self):
        """The title with its unit: numbers without a unit have 1."""
        return (
            f"{self.title} [1]"
            if self.title and not self.names and "[" not in self.title
            else self.title
        )

    @classmethod
    def of(cls, title, values, log=None):
        """`log`: None decides by the span."""
        if isinstance(values, list):
            names = tuple(dict.fromkeys(values))
            return cls(title, np.array([names.index(value) for value in values], float), names)
        return cls(title, values, (), spread_logarithmically(values) if log is None else log)


def spread_logarithmically(values):
    values = values[np.isfinite(values)]
    return bool(values.size) and values.min() > 0 and values.max() > 30 * values.min()


def over_axes(ax, x, y, series=(), runs=()):
    """`series`: label, values along x and y, and look of each curve, of which equal ones show in
    stripes; `runs`: a class with the places of its runs each; `x`, `y`: the Axis of either
    direction."""
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
    for (label, xs, ys, own), (place, count) in zip(
        series, equal_curves([(xs, ys) for _, xs, ys, _ in series])
    ):
        if count > 1 and len(xs) > 1:
            own = {**own, "markevery": (place % len(xs), count)} | (
                {"ls": striped(own["ls"], place, count)} if own.get("ls", "none") != "none" else {}
            )
        ax.plot(xs, ys, label=label, **own)
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
    """Ticks at the values of a field of whole numbers."""
    values = np.unique(values[np.isfinite(values)])
    if (
        1 < len(values) <= MOST_TICKS
        and (values == values.round()).all()
        and not spread_logarithmically(values)
    ):
        along.set_ticks(values, [f"{value:.0f}" for value in values])


def look_of(algorithm, **more):
    own = look(algorithm)
    return {"color": own.colour, "ls": own.line, "marker": own.marker, "lw": 1.0, "ms": 4.5, **more}


def with_room(low, high, above=1.0):
    """Limits around a range on a logarithmic axis, with room for marks and names."""
    room = max((high / low) ** 0.12, 1.3)
    return low / room, high * room * above


def pareto(points):
    """Those that no other is below in both, by the first coordinate."""
    points = points[np.all(np.isfinite(points), axis=1)]
    front, least = [], np.inf
    for point in points[np.lexsort((points[:, 1], points[:, 0]))]:
        if point[1] < least:
            front.append(point)
            least = point[1]
    return np.array(front).reshape(-1, 2)
