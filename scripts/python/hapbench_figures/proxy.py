"""The drill turned in the hole under a steady push: the proxy beside stiffness shaping."""
import numpy as np

import hapbench_style as style

from .ideal_trajectory import draw_block

ALGORITHMS = ("shaped_stiffness", "exact_shaping", "proxy")
EVERY = 320  # rows: a drawn mark of every row could not be told from its neighbours
SETTLED = 0.5  # seconds: the drill starts above its place


def rows_of(results, name):
    rows = results.table(f"proxy/{name}/ideal_trajectory.csv")
    kept = rows["time_s"] > SETTLED
    return {key: column[kept][::EVERY] for key, column in rows.items()}


def rotated(results):
    figure, axes = style.panels(1, 3, 3.1, gridspec_kw={"width_ratios": [0.75, 1.2, 1.2]})
    section, height, depth = axes[0]
    scenario = results.json("proxy/proxy/scenario.effective.json")
    draw_block(section, scenario["environment"])
    spring = 1e3 * abs(scenario["hand"]["z_N"]) / scenario["rendering"]["stiffness_N_per_m"]
    errors = {}
    for name in ALGORITHMS:
        rows, look = rows_of(results, name), style.look(name)
        error = 1e3 * (rows["height_m"] - rows["ideal_height_m"])
        errors[name] = np.sqrt(np.mean(error**2))
        mark = {"color": look.colour, "marker": look.marker, "ls": "none", "ms": 2, "mec": "none", "alpha": 0.7}
        section.plot(1e3 * rows["lateral_m"], 1e3 * rows["height_m"], **mark)
        height.plot(rows["tilt_rad"], error, label=look.label, **mark)
        depth.plot(rows["tilt_rad"], 1e3 * rows["interpenetration_m"], **mark)
    rows = rows_of(results, "proxy")
    order = np.argsort(rows["tilt_rad"])
    section.plot(1e3 * rows["ideal_lateral_m"][order], 1e3 * rows["ideal_height_m"][order], color=style.BLACK, lw=0.9)
    height.axhline(-spring, color=style.BLACK, lw=0.7, ls="--", label=f"{spring:.2g} mm: the spring itself")
    height.set_ylim(top=0)
    height.set(title="height error of the tip", xlabel="tilt α [rad]", ylabel="error [mm]")
    depth.set(title="interpenetration", xlabel="tilt α [rad]", ylabel="depth in the exact hole [mm]")
    depth.set_ylim(bottom=0)
    section.set_title("section")
    height.legend(loc="lower right", markerscale=1.8, fontsize=6.5, handlelength=1.2)
    style.letter(axes[0])
    rms = ", ".join(f"{style.look(name).label} {error:.2f} mm" for name, error in errors.items())
    return figure, ("The drill turned to and fro in the hole while 2 N push straight down (task 2), with two ways of "
                    "shaping and with a proxy. (a) Section with the ideal trajectory of 3.6 (black), (b) height of the tip "
                    f"over it, (c) how deep the drill is in the exact hole. Root mean square of the height error: {rms}. "
                    "Ours.")
