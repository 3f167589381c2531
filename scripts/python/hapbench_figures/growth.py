"""How cost grows with contacts and with shell points, as scripts/bench has measured it."""
import numpy as np

import hapbench_style as style

FILE = "performance.json"
FITTED = 3  # the largest sizes, which a slope is fitted to
PARTS_OF_CONTACTS = (("step", "whole step", style.BLACK, "o"), ("reduction", "reduction", style.AMBER, "s"))
PARTS_OF_POINTS = (
    ("search/brute_force", "seconds", "brute force", style.GREY, "D"),
    ("list_rebuild", "longest_s", "longest new list", style.PLUM, "^"),
    ("search/grid", "seconds", "by grid", style.AMBER, "s"),
    ("search/neighbour_list", "seconds", "by list", style.PETROL, "o"),
)


def series(growth, part, size="size", value="seconds"):
    """Sizes and values of a part, by size; both empty when it is not there."""
    points = sorted((point[size], point[value]) for point in growth if point["part"] == part and value in point)
    return np.array(points).reshape(-1, 2).T


def slope(sizes, values):
    """The power of the size that the largest of them follow."""
    return np.polyfit(np.log(sizes[-FITTED:]), np.log(values[-FITTED:]), 1)[0]


def draw(ax, sizes, values, label, colour, marker):
    if len(sizes) >= 2:
        label = f"{label}, n^{slope(sizes, values):.2f}"
    ax.plot(sizes, values, color=colour, marker=marker, label=label)


def finish(ax, title, xlabel, ylabel, **legend):
    ax.set(xscale="log", yscale="log", title=title, xlabel=xlabel, ylabel=ylabel)
    ax.legend(**{"loc": "upper left", "fontsize": 6.5} | legend)


def growth(results):
    measured = results.json(FILE)
    points = measured["growth"]
    figure, axes = style.panels(2, 2, 6.6)
    laws, parts, search, shell = axes.ravel()
    names = sorted({point["part"].removeprefix("law/") for point in points if point["part"].startswith("law/")})
    # The most expensive first, as the lines stand above each other at their right ends.
    last = {name: series(points, f"law/{name}")[1][-1] for name in names}
    for name in sorted(names, key=last.get, reverse=True):
        look = style.look(name)
        sizes, seconds = series(points, f"law/{name}")
        draw(laws, sizes, 1e6 * seconds, look.label, look.colour, look.marker)
    finish(laws, "force laws", "contacts", "time of a call [µs]", fontsize=5.5, labelspacing=0.25, ncol=2, columnspacing=1)
    laws.set_ylim(top=300 * laws.get_ylim()[1])  # room for the names
    for part, label, colour, marker in PARTS_OF_CONTACTS:
        sizes, seconds = series(points, part)
        draw(parts, sizes, 1e6 * seconds, label, colour, marker)
    finish(parts, "step and reduction", "contacts", "time [µs]")
    for part, value, label, colour, marker in PARTS_OF_POINTS:
        sizes, seconds = series(points, part, "points", value)
        draw(search, sizes, 1e6 * seconds, label, colour, marker)
    deadline = 1e6 / 2048
    search.axhline(deadline, color=style.RED, lw=1)
    search.annotate(f"deadline {deadline:.0f} µs", (0.02, deadline), (0, 2), xycoords=("axes fraction", "data"),
                    textcoords="offset points", color=style.RED, fontsize=7)
    finish(search, "contact search", "points of the shell", "time of a search [µs]", loc="lower right")
    search.set_ylim(bottom=search.get_ylim()[0] / 5)  # room for the names
    sizes, seconds = series(points, "shell", "points")
    draw(shell, sizes, seconds, "time", style.PETROL, "o")
    sizes, bytes_ = series(points, "shell", "points", "bytes_per_point")
    draw(shell, sizes, 1e-9 * sizes * bytes_, "memory", style.AMBER, "s")
    finish(shell, "building the shell", "points of the shell", "time [s], memory [GB]")
    style.letter(axes.ravel())
    return figure, (
        f"How cost grows, both axes logarithmic, with the power of the size n that the {FITTED} largest follow. (a) Force laws "
        "over contacts, (b) a step of a drill that fills its hole, all contacts rendered by stiffness shaping, and the reduction. Over the points of the block's shell, whose "
        "grid gets finer: (c) mean searches along task 2, whose contacts grow with the points, and the longest search of all "
        f"tasks that makes a new neighbour list; (d) building the shell. Ours, measured by scripts/bench on {measured['date']} with one core of: "
        f"{measured['machine']['cpu']}, {measured['machine']['instruction_set']}; commit {measured['commit']}."
    )
