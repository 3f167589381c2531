"""Stability: the root locus of A.3, and our maps of stable, dying, vibrating and diverged runs."""
import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap

from . import published, style
from .results import MissingResult, numbers

CASES = (
    ("stiffness_undamped", "A4.stiffness", "B = 0, K grows", "K", "N/m"),
    ("damping_alone", "A4.damping", "K = 0, B grows", "B", "N s/m"),
    ("stiffness_damped", "A4.stiffness.damped", "ζ = 0.7, K grows", "K", "N/m"),
)


def root_locus(results):
    locus = results.records("stability/root_locus.csv")
    limits = {row["case"]: row for row in results.records("stability/limits.csv")}
    figure, axes = style.panels(1, 3, 2.7, sharey=True)
    turn = np.linspace(0, 2 * np.pi, 181)
    for ax, (case, id_, title, symbol, unit) in zip(axes[0], CASES):
        rows = [row for row in locus if row["case"] == case]
        ax.plot(np.cos(turn), np.sin(turn), color=style.BLACK, lw=0.8)
        for which, colour, line in (("first", style.BLUE, "-"), ("second", style.ORANGE, (0, (4, 1.2)))):
            ax.plot(numbers(rows, f"{which}_real"), numbers(rows, f"{which}_imaginary"), color=colour, ls=line, lw=1.5)
        value = published.value(id_)
        nearest = rows[int(np.argmin(np.abs(numbers(rows, "value") - value)))]
        for which in ("first", "second"):
            ax.plot(
                float(nearest[f"{which}_real"]),
                float(nearest[f"{which}_imaginary"]),
                marker="D",
                mfc="white",
                mec=style.VERMILION,
                ms=5,
                zorder=5,
            )
        ours = float(limits[case]["simulation"])
        style.note(
            ax, 0.5, 0.98, f"published {symbol} = {value:,.0f} {unit}".replace(",", " "), style.VERMILION, ha="center"
        )
        style.note(ax, 0.5, 0.02, f"ours {ours:,.0f} {unit}".replace(",", " "), style.BLUE, ha="center", va="bottom")
        ax.set(title=title, xlabel="real part", xlim=(-1.75, 1.4), ylim=(-1.6, 1.6), aspect="equal")
    axes[0, 0].set_ylabel("imaginary part")
    style.letter(axes[0])
    return figure, (
        "Root locus of the integrator on one spring and damper: both eigenvalues (blue, orange dashed) as stiffness "
        "or damping grows, and the unit circle, outside of which it is unstable. Diamonds: the eigenvalues at the "
        "published limit. Ours, below: the limit at which bisection over simulated runs finds divergence. M = 0.1 "
        "kg, time step 0.5 ms (A.3)."
    )


# Light to dark, so that the classes can be told apart in grey. What is dying out comes to rest: stable, but hatched.
STABLE = "#CFE6F5"
CLASS_COLOURS = {"stable": STABLE, "dying_out": STABLE, "vibrating": style.ORANGE, "diverged": "#7A2E00"}
CLASSES = tuple(CLASS_COLOURS)
HATCH = {"hatch": "/////", "edgecolor": style.ORANGE, "lw": 0}


def axis_label(name):
    """ "time_step_s" -> "time step [s]"."""
    for ending, unit in (("_N_per_m", "N/m"), ("_rad", "rad"), ("_kg", "kg"), ("_s", "s")):
        if name.endswith(ending):
            return f"{name.removesuffix(ending).replace('_', ' ')} [{unit}]"
    return name.replace("_", " ")


def is_geometric(values):
    return values[0] > 0 and values[-1] / values[0] > 20


def edges(values):
    """Borders of the cells around the values of a grid."""
    if is_geometric(values):
        return np.exp(edges(np.log(values)))
    middle = (values[1:] + values[:-1]) / 2
    return np.concatenate([[2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]])


def hatch(ax, x, y, cells):
    """Hatches those cells between the edges x and y."""
    for line, column in np.argwhere(cells):
        corner = (x[column], y[line])
        size = (x[column + 1] - x[column], y[line + 1] - y[line])
        ax.add_patch(style.plt.Rectangle(corner, *size, fill=False, **HATCH))


def draw_map(ax, rows, x_name, y_name):
    x, y = numbers(rows, x_name), numbers(rows, y_name)
    columns, lines = np.unique(x), np.unique(y)
    grid = np.full((len(lines), len(columns)), np.nan)
    grid[np.searchsorted(lines, y), np.searchsorted(columns, x)] = [CLASSES.index(row["class"]) for row in rows]
    ax.pcolormesh(
        edges(columns),
        edges(lines),
        grid,
        cmap=ListedColormap(list(CLASS_COLOURS.values())),
        norm=BoundaryNorm(np.arange(len(CLASSES) + 1) - 0.5, len(CLASSES)),
        rasterized=True,
    )
    hatch(ax, edges(columns), edges(lines), grid == CLASSES.index("dying_out"))
    ax.grid(False)
    ax.set_xscale("log" if is_geometric(columns) else "linear")
    ax.set_yscale("log" if is_geometric(lines) else "linear")
    ax.set(xlim=edges(columns)[[0, -1]], ylim=edges(lines)[[0, -1]])


def draw_boundary(ax, rows, x_name, y_name):
    for kind, look in (
        ("analytic", {"color": "white", "lw": 2.4}),
        ("analytic", {"color": style.BLUE, "lw": 1.3}),
        ("simulation", {"color": style.BLACK, "lw": 1.0, "ls": (0, (2, 2))}),
    ):
        column = f"{kind}_{y_name}"
        if column in rows[0]:
            y = numbers(rows, column)
            ax.plot(numbers(rows, x_name), np.where(np.isfinite(y), y, np.nan), **look)


class MapFile:
    """stability_map_NAME.csv and the boundary beside it."""

    def __init__(self, results, path):
        self.rows = results.records(path)
        self.x_name, self.y_name = list(self.rows[0])[1:3]
        boundary = path.replace("stability_map_", "stability_boundary_")
        self.boundary = results.records(boundary) if results.has(boundary) else []

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
            draw_boundary(ax, boundary, self.x_name, self.y_name)


def map_file(results, name, of_integrators):
    """The first map of this name that compares integrators, or that does not."""
    for path in results.glob(f"**/stability_map_{name}.csv"):
        found = MapFile(results, path)
        if (len(found.integrators) > 1) == of_integrators:
            return found
    raise MissingResult(f"no stability_map_{name}.csv{' of several integrators' if of_integrators else ''}")


def legend_above(figure):
    handles = [
        style.plt.Rectangle((0, 0), 1, 1, facecolor=colour, **(HATCH if name == "dying_out" else {}))
        for name, colour in CLASS_COLOURS.items()
    ]
    handles += [
        style.plt.Line2D([], [], color=style.BLUE, lw=1.3),
        style.plt.Line2D([], [], color="black", lw=1, ls=(0, (2, 2))),
    ]
    figure.get_layout_engine().set(rect=(0, 0, 1, 0.93))
    names = [name.replace("_", " ") for name in CLASSES]
    figure.legend(handles, [*names, "limit, theory", "limit, bisection"], loc="upper center", ncol=6)


def stability_map(name):
    """The function that draws stability_map_NAME.csv."""

    def draw(results):
        found = map_file(results, name, of_integrators=False)
        present = [a for a in style.EVERY_ALGORITHM if any(row["algorithm"] == a for row in found.rows)]
        lines = max(2, -(-len(present) // 4))
        figure, axes = style.panels(lines, 4, 1.85 * lines, sharex=True, sharey=True)
        for ax in axes.flat:
            ax.set_visible(False)
        for ax, algorithm in zip(axes.flat, present):
            ax.set_visible(True)
            found.draw(ax, algorithm=algorithm)
            ax.set_title(style.EVERY_ALGORITHM[algorithm].label)
        x_label, y_label = axis_label(found.x_name), axis_label(found.y_name)
        figure.supxlabel(x_label, fontsize=8)
        figure.supylabel(y_label, fontsize=8)
        legend_above(figure)
        return figure, (
            f"Where a run is stable, still dies out, vibrates or diverges: {y_label} over {x_label}, every "
            "algorithm. Lines: the limit from theory (blue), where there is one, and found by bisection over "
            "simulated runs (dashed). Ours."
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
    legend_above(figure)
    return figure, (
        f"Where a run is stable, still dies out, vibrates or diverges under each integrator, {style.look(algorithm).label}: stiffness "
        "of one spring over the time step and over zeta, stiffness of the hand over the delay of the device's servo. "
        "Lines: the limit from theory (blue), where there is one, and found by bisection over simulated runs "
        "(dashed). Ours."
    )
