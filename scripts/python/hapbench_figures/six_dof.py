"""Figure of this project: the force that each law renders on a device without torque, compared with the force of a
device with torque."""
import json

import numpy as np

import hapbench_style as style
from hapbench.results import MissingResult

STUDY = "six_dof"
SCENES = {
    "six_dof_edge": "edge of\na plane",
    "six_dof_slot": "parallel\nslot",
    "six_dof_peg": "tight\npeg",
    "six_dof_task2": "drilled\nhole",
}
LAWS = ("original_averaging", "shaped_stiffness", "mean", "proxy", "matched_proxy")
REFERENCE = {"color": style.GREY, "lw": 2.2, "alpha": 0.6, "label": "with torque (6-DOF)"}
HAND, HAND_ROTATION, COUPLING, COUPLING_ROTATION = (
    500.0,
    0.2,
    20000.0,
    0.4,
)  # values of the hand and of six_dof in the scenes
SMALLEST = 1e-3  # smallest drawn force error [N]; smaller errors are drawn at this value
# Distance from the force point to the contact at the edge of the plane [m]. The edge is 4 mm above the tip.
LEVER = 0.026


def look(law):
    """Returns (plot style, label) of a law. Both proxies have the same colour. The proxy that is matched to the hand
    has hollow marks and a dotted line."""
    if law == "matched_proxy":
        appearance = style.look("proxy")
        return {
            "color": appearance.colour,
            "ls": (0, (1, 1.2)),
            "marker": "D",
            "mfc": "white",
        }, "matched proxy (ours)"
    appearance = style.look(law)
    return {
        "color": appearance.colour,
        "ls": appearance.line,
        "marker": appearance.marker,
    }, appearance.label


def rows_of(results):
    """Returns a dict for each run of the study, with the keys `scene`, `law` and `index` (number of the run), the
    fields of the object six_dof in the scenario, and the metrics without the prefix "six_dof."."""
    rows = []
    for index, record in enumerate(results.records(f"{STUDY}/sweep.csv")):
        fields = json.loads(record["six_dof"])
        metrics = {
            name.removeprefix("six_dof."): float(value) if value else np.nan
            for name, value in record.items()
            if name.startswith("six_dof.") and name != "six_dof.law"
        }
        rows.append(
            {
                "scene": record["scenario"],
                "law": record["six_dof.law"],
                "index": index,
                **fields,
                **metrics,
            }
        )
    return rows


def chosen(rows, **wanted):
    """Returns the rows with the values `wanted`. The rotational stiffness of the hand, the grip and the pivot must have
    their default values, unless they are in `wanted`. Raises MissingResult if there is no such row.
    """
    usual = ("hand_rotational_stiffness_N_m_per_rad", "grip_m", "pivot_m")
    found = [
        row
        for row in rows
        if all(row.get(key) == value for key, value in wanted.items())
        and all(key in wanted or key not in row for key in usual)
    ]
    if not found:
        raise MissingResult(f"no such run in {STUDY}/sweep.csv: {wanted}")
    return found


def ratio_of_closed_form(grip, matched):
    """Returns the force of the proxy divided by the force that a device with force and torque renders, for one contact.
    `grip`: distance of the grip from the force point [m]. `matched`: true for a proxy that is matched to a hand with
    its grip at the force point, false for a proxy that does not rotate."""
    series = 1 / COUPLING + 1 / HAND
    turning = 1 / COUPLING_ROTATION + 1 / HAND_ROTATION if matched else 0.0
    with_torque = series + (LEVER - grip) ** 2 / HAND_ROTATION + LEVER**2 / COUPLING_ROTATION
    return with_torque / (series - grip * (LEVER - grip) / HAND_ROTATION + LEVER**2 * turning)


def draw_cycle(ax, results, rows):
    """Draws the magnitude of the force over the cycle of motion in the slot, for each law."""
    shown = 0
    for row in chosen(rows, scene="six_dof_slot"):
        table = results.table(f"{STUDY}/runs/{row['index']:06d}/six_dof.csv")
        size = lambda name: np.sqrt(sum(table[f"{name}_{x}_N"] ** 2 for x in "xyz"))  # noqa: E731
        if not shown:
            ax.plot(table["time_s"], size("reference"), **REFERENCE)
        style_of, label = look(row["law"])
        ax.plot(
            table["time_s"],
            size("law"),
            label=label,
            markevery=(5 * shown, 25),
            ms=3,
            lw=1,
            **{key: value for key, value in style_of.items()},
        )
        shown += 1
    top = 1.2 * ax.get_ylim()[1]
    for at, text in enumerate(("press", "turn", "release", "turn\nback")):
        ax.text(0.25 + 0.5 * at, 0.98 * top, text, ha="center", va="top", fontsize=7)
        ax.axvline(0.5 * at, color="#E6E6E6", lw=0.6)
    ax.set(
        title="force in the slot",
        xlabel="time [s]",
        ylabel="force on the hand [N]",
        ylim=(0, top),
    )


def draw_by_scene(ax, rows, metric, scale, smallest=None):
    """Draws one mark for each scene and law. Values below `smallest` are drawn at `smallest`. `scale`: factor of the
    metric."""
    for i, law in enumerate(LAWS):
        at, values = [], []
        for k, scene in enumerate(SCENES):
            value = scale * chosen(rows, scene=scene, law=law)[0][metric]
            at.append(k + 0.13 * (i - 2))
            values.append(value if smallest is None else max(value, smallest))
        style_of, label = look(law)
        ax.plot(at, values, **{**style_of, "ls": "none"}, label=label, clip_on=False)
    ax.set_xticks(range(len(SCENES)), SCENES.values(), fontsize=7)
    ax.margins(x=0.06)


def draw_error(ax, rows):
    """Draws the force error of each law in each scene, and as a grey line the error of a zero force."""
    draw_by_scene(ax, rows, "force_error_rms_N", 1.0, SMALLEST)
    for k, scene in enumerate(SCENES):
        value = chosen(rows, scene=scene, law=LAWS[0])[0]["reference_force_rms_N"]
        ax.plot([k - 0.4, k + 0.4], [value, value], color=style.GREY, lw=1.2)
    ax.set(title="force error", ylabel="rms [N]", yscale="log", ylim=(SMALLEST, 10))


def draw_grip(ax, rows):
    """Draws the relative force error of the proxies over the distance of the grip from the force point, in the scene
    with the edge of a plane. Marks are measured errors; lines are errors by the closed form for one contact.
    """
    grips = np.linspace(-0.012, 0.012, 49)
    for law in ("proxy", "matched_proxy"):
        style_of, label = look(law)
        ratio = ratio_of_closed_form(grips, law == "matched_proxy")
        ax.plot(1e3 * grips, 100 * (ratio - 1), color=style_of["color"], ls=style_of["ls"], lw=1)
        found = [
            (grip, row["force_error_rms_N"] / row["reference_force_rms_N"])
            for grip in (-0.01, None, 0.01)
            for row in chosen(
                rows, scene="six_dof_edge", law=law, **({} if grip is None else {"grip_m": grip})
            )
        ]
        for grip, error in found:
            sign = np.sign(ratio_of_closed_form(grip or 0.0, law == "matched_proxy") - 1) or 1.0
            ax.plot(1e3 * (grip or 0.0), 100 * sign * error, **{**style_of, "ls": "none"})
    ax.axhline(0, color=style.GREY, lw=0.8)
    ax.set(
        title="edge: other grips",
        xlabel="grip towards the tip [mm]",
        ylabel="force too large by [%]",
    )


def draw_pivot(ax, rows):
    """Draws the lost torque (left axis) and the unresisted rotation (right axis, dashed) over the position of the
    pivot, with one line for each scene."""
    other = ax.twinx()
    for i, (scene, title) in enumerate(SCENES.items()):
        of_pivot = [
            chosen(
                rows,
                scene=scene,
                law="shaped_stiffness",
                **({} if pivot is None else {"pivot_m": pivot}),
            )[0]
            for pivot in (None, 0.03)
        ]
        series = style.SERIES[i]
        at = 1e3 * np.array([row.get("pivot_m", 0.0) for row in of_pivot])
        ax.plot(
            at,
            [1e3 * row["lost_torque_rms_Nm"] for row in of_pivot],
            color=series.colour,
            marker=series.marker,
            label=title.replace("\n", " "),
        )
        other.plot(
            at,
            [np.degrees(row["unresisted_turn_max_rad"]) for row in of_pivot],
            color=series.colour,
            marker=series.marker,
            mfc="white",
            ls=(0, (3, 1.5)),
            lw=0.9,
        )
    ax.set(
        title="what is not rendered",
        xlabel="pivot behind the tip [mm]",
        ylabel="lost torque, rms [mN m]",
        xlim=(-4, 34),
        ylim=(0, 14),
    )
    other.set(ylabel="unresisted turn [deg], dashed", ylim=(0, 7))
    other.grid(False)
    other.spines["right"].set_visible(True)


def comparison(results):
    """Draws the five panels and returns the numbers of the caption."""
    rows = rows_of(results)
    figure, axes = style.panels(2, 3, 5.0)
    cycle, error, energy = axes[0]
    grip, pivot, legend = axes[1]
    draw_cycle(cycle, results, rows)
    draw_error(error, rows)
    draw_by_scene(energy, rows, "work_J", 1e3)
    energy.set_yscale("symlog", linthresh=0.1)
    energy.axhline(0, color=style.GREY, lw=0.8)
    energy.set(title="energy created", ylabel="work in the cycle [mJ]", ylim=(-10, 10))
    draw_grip(grip, rows)
    draw_pivot(pivot, rows)
    legend.axis("off")
    of_laws = {"loc": "upper center", "bbox_to_anchor": (0.5, 1.08), "title": "(a) to (d)"}
    legend.add_artist(legend.legend(*cycle.get_legend_handles_labels(), **of_laws))
    of_scenes = {"loc": "lower center", "bbox_to_anchor": (0.5, -0.1), "title": "(e)"}
    legend.legend(*pivot.get_legend_handles_labels(), **of_scenes)
    unbalanced = {}  # by scene
    for row in chosen_everywhere(rows):
        if row["law_unbalanced_steps"] > 0:
            scene_name = row["scene"].removeprefix("six_dof_")
            steps = f'"{look(row["law"])[1]}" {row["law_unbalanced_steps"]:.0f}'
            unbalanced.setdefault(scene_name, []).append(steps)
    values = {
        "matched": 1e6
        * max(
            row["force_error_max_N"]
            for row in chosen_everywhere(rows, "matched_proxy")
            if row["reference_jumps"] == 0
        ),
        "unbalanced": "; ".join(
            f"{scene_name}: {', '.join(steps)}" for scene_name, steps in unbalanced.items()
        )
        or "none",
        "jumps": sum(row["reference_jumps"] for row in chosen_everywhere(rows, LAWS[0])),
    }
    return style.lettered(figure, [cycle, error, energy, grip, pivot]), values


def chosen_everywhere(rows, law=None):
    """Returns the runs with the default hand in all scenes, of one law or of all laws."""
    return [
        row
        for scene in SCENES
        for row in chosen(rows, scene=scene, **({"law": law} if law else {}))
    ]
