"""The picture of `compare --devices`: the largest stable stiffness of each device, a panel for each scene."""
import numpy as np
from hapbench_style import BLACK, PUBLISHED_LINE, look, plt

from .results import numbers

TABLE = "device_limits.csv"
PANEL = 2.6  # [inch]
LEGEND = 0.3  # [inch]
STEP = 0.16  # of a row, between algorithms


def draw_devices(results, table=TABLE):
    rows = results.records(table)
    devices, scenes, algorithms = (list(dict.fromkeys(row[name] for row in rows)) for name in ("device", "scenario", "algorithm"))
    figure, axes = plt.subplots(1, len(scenes), sharex=True, sharey=True, squeeze=False,
                                figsize=(1.0 + PANEL * len(scenes), 0.9 + LEGEND + 0.24 * len(devices)))
    for ax, scene in zip(axes[0], scenes):
        for i, algorithm in enumerate(algorithms):
            mine = [row for row in rows if (row["scenario"], row["algorithm"]) == (scene, algorithm)]
            at = np.array([devices.index(row["device"]) for row in mine]) + STEP * (i - (len(algorithms) - 1) / 2)
            ax.plot(numbers(mine, "limit_N_per_m"), at, ls="", marker=look(algorithm).marker, ms=5, color=look(algorithm).colour,
                    label=look(algorithm).label)
        published = {devices.index(row["device"]): float(row["published_N_per_m"]) for row in rows if row["published_N_per_m"]}
        if published:
            places = np.array(list(published))
            ax.vlines(list(published.values()), places - 0.4, places + 0.4, color=BLACK, lw=1.2,
                      ls=PUBLISHED_LINE["ls"], label="published, of a wall")
        ax.set(title=scene.replace("_", " "), xscale="log", xlabel="largest stable stiffness K [N/m]",
               yticks=range(len(devices)), yticklabels=[name.replace("$", r"\$") for name in devices],
               ylim=(len(devices) - 0.4, -0.6))
    # A legend of the figure takes no room by itself.
    figure.get_layout_engine().set(rect=(0, 0, 1, 1 - LEGEND / figure.get_figheight()))
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper left", ncol=4)
    return figure


def of_all_devices(results):
    return draw_devices(results, f"devices/{TABLE}"), (
        "The largest stiffness that each device renders stably and quietly while a hand taps with a flat probe on a wall, in a "
        "corner and in a hole a tenth wider than the probe, without damping. Short lines: the published largest stable "
        "stiffness of a wall. If shaping makes one K safe in every direction, its marks stand in one column in all panels, "
        "while those of the sum fall back by the number of contacts. Ours."
    )
