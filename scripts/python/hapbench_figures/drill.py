"""Figure of the drill that is turned in the hole, compared with the ideal trajectory (thesis Fig. 7)."""
import numpy as np
from matplotlib.patches import Polygon

import hapbench_style as style
from hapbench.results import MissingResult

from . import scene

RUN = "thesis/task2_pressed"  # the run that decides claim J1
# Largest number of marks for each range of hand force; more marks could not be distinguished.
MARKS = 120
SETTLED = 0.5  # start of the drawn time [s]; before it, the drill moves from above into the hole


def samples(results):
    """Returns the rows of the run in two groups: hand force below 2 N, and hand force of at least 2 N. Only rows after
    SETTLED and within the tilts that the thesis compares are included. Lengths are in millimetres.
    """
    rows = results.table(f"{RUN}/ideal_trajectory.csv")
    range_ = scene.PUBLISHED["J1.tilt"]
    selected = (
        (rows["time_s"] > SETTLED)
        & (rows["tilt_rad"] >= range_["at_least"])
        & (rows["tilt_rad"] <= range_["at_most"])
    )
    firm = rows["hand_force_N"] >= scene.published("J1.split")
    groups = [selected & ~firm, selected & firm]
    if not all(group.any() for group in groups):
        raise MissingResult(f"no row at the compared tilts in {RUN}")
    return [
        {
            key: column[group] * (1 if key in ("time_s", "tilt_rad", "hand_force_N") else 1e3)
            for key, column in rows.items()
        }
        for group in groups
    ]


def ideal(rows_list):
    """Returns (tilt [rad], lateral position [mm], height [mm]) of the ideal trajectory, sorted by the tilt."""
    tilt = np.concatenate([rows["tilt_rad"] for rows in rows_list])
    order = np.argsort(tilt)
    column = lambda key: np.concatenate([rows[key] for rows in rows_list])[order]  # noqa: E731
    return tilt[order], column("ideal_lateral_m"), column("ideal_height_m")


def draw_block(ax, environment):
    radius, depth = 500 * environment["hole_diameter_m"], 1e3 * environment["hole_depth_m"]
    wall = np.array(
        [
            [-2.2, 0],
            [-radius, 0],
            [-radius, -depth],
            [radius, -depth],
            [radius, 0],
            [2.2, 0],
            [2.2, -depth - 0.6],
            [-2.2, -depth - 0.6],
        ]
    )
    ax.add_patch(Polygon(wall, closed=True, facecolor=style.SAND, edgecolor=style.SOIL, lw=0.8))
    ax.set(
        xlim=(-1.65, 1.35),
        xticks=[-1, 0, 1],
        ylim=(-5.4, 0.8),
        aspect="equal",
        xlabel="x [mm]",
        ylabel="height over the mouth [mm]",
    )


def trajectory(results):
    figure, axes = style.panels(1, 3, 3.1, gridspec_kw={"width_ratios": [0.75, 1.2, 1.2]})
    section, height, distance = axes[0]
    environment = results.json(f"{RUN}/scenario.effective.json")["environment"]
    draw_block(section, environment)
    bottom = 1e3 * environment["hole_depth_m"]
    drawn, errors = samples(results), []
    for rows, name, series in zip(drawn, ("below 2 N", "from 2 N on"), style.SERIES):
        errors.append(
            f"{name}: {np.mean(rows['height_m'] - rows['ideal_height_m']):.2f} mm, "
            f"{np.abs(rows['lateral_m'] - rows['ideal_lateral_m']).max():.2f} mm and "
            f"{rows['interpenetration_m'].max():.2f} mm"
        )
        pick = slice(None, None, max(1, -(-len(rows["tilt_rad"]) // MARKS)))
        thin = {key: column[pick] for key, column in rows.items()}
        look = {
            "color": series.colour,
            "marker": series.marker,
            "ls": "none",
            "ms": 2.3,
            "mec": "none",
            "alpha": 0.7,
        }
        section.plot(thin["lateral_m"], thin["height_m"], **look)
        height.plot(thin["tilt_rad"], thin["height_m"] + bottom, label=name, **look)
        distance.plot(thin["tilt_rad"], np.abs(thin["lateral_m"]), **look)
    tilt, x, y = (column[:: max(1, len(column) // 300)] for column in ideal(drawn))
    section.plot(x, y, color=style.BLACK)
    height.plot(tilt, y + bottom, color=style.BLACK, label="ideal")
    distance.plot(tilt, np.abs(x), color=style.BLACK)
    inside = 1e3 * scene.published("J1.lateral")
    distance.fill_between(
        tilt, np.abs(x) - inside, np.abs(x) + inside, color=style.RED, alpha=0.13, lw=0
    )
    height.set(title="height over the bottom", xlabel="tilt α [rad]", ylabel="height [mm]")
    distance.set(
        title="distance to the axis of the hole", xlabel="tilt α [rad]", ylabel="distance [mm]"
    )
    section.set_title("section")
    for ax in (height, distance):
        ax.set_xlim(scene.PUBLISHED["J1.tilt"]["at_least"], scene.PUBLISHED["J1.tilt"]["at_most"])
    height.legend(loc="upper left", markerscale=1.8, fontsize=6.5)
    height.margins(y=0.12)
    style.note(distance, 0.03, 0.3, "shaded: published,\nerror up to about\n0.25 mm", style.RED)
    return style.lettered(figure, axes[0]), {"errors": "; ".join(errors)}
