"""Pictures of bundled scenes, made by runs: the scene in section with the tool, and the rendered force over time."""
import json
import textwrap

import numpy as np
from matplotlib.patches import Polygon

import hapbench_style as style
from hapbench.columns import read_columns
from hapbench_command import write
from hapbench_looks import look
from hapbench_pictures.panels import outline, section
from hapbench_report.recording import tool_profile

from .manuals import ROOT

FOLDER, PAGE = ROOT / "results" / "reference" / "gallery", ROOT / "scenarios" / "GALLERY.md"
# Name, and half of the side of the picture [mm].
SCENES = (
    ("poke_plane", 2.2),
    ("recorded_stroke", 2.6),
    ("peg_in_hole_2d_original_averaging", 4.2),
    ("peg_in_hole_2d_shaped_stiffness", 4.2),
    ("task1_flat_signed_distance", 2.6),
    ("task2_rotate_signed_distance", 4.2),
    ("task3_spin_signed_distance", 4.2),
    ("press_into_hole", 4.2),
    ("corner_normal_projection", 3.2),
    ("turned_into_wall", 4.2),
    ("mesh_molar", 4.5),
    ("drag_molar", 5.5),
    ("bur_fissure", 4.5),
    ("pear_in_cavity", 2.6),
    ("cone_in_undercut", 2.4),
)
SNAPSHOTS = 4
SPANS = 250  # of a curve
INCHES = (6.2, 2.5)


def draw_all(program, scratch):
    """Every picture, and the page that shows them."""
    parts = [HEAD.format(provenance=program.provenance())]
    for name, half in SCENES:
        runs = scratch / "runs"
        program.run(["run", name, "--quiet", "--out", str(runs / name)], scratch)
        program.run(["shell", name, "--quiet", "--out", str(runs / f"{name}.csv")], scratch)
        scene = Scene(runs, name)
        write(FOLDER / f"{name}.svg", picture(scene, half))
        text = textwrap.fill(scene.scenario["description"], 110)
        parts.append(f"## {name}\n\n{text}\n\n![{name}](../results/reference/gallery/{name}.svg)\n\n"
                     f"    hapbench run {name}\n    hapbench plot results/out/{name}\n")
    write(PAGE, "\n".join(parts).encode())
    print(f"drew {len(SCENES)} scenes into {FOLDER.relative_to(ROOT)}")


HEAD = """# Gallery

Some of the bundled scenes; `hapbench list` shows all of them. On the left a section through the scene: points of
the shell near the plane of the section (petrol), the tool at four times (from grey to black) and the way of its tip
(coloured). On the right the size of the rendered force. `scripts/docs --gallery` draws these pictures from runs
and writes this page ({provenance}).
"""


class Scene:
    """A run, the points of its shell, and the plane that it is drawn in: x and y of a planar scene, else x and z."""

    def __init__(self, folder, name):
        self.name = name
        self.scenario = json.loads((folder / name / "scenario.effective.json").read_text(encoding="utf-8"))
        summary = json.loads((folder / name / "summary.json").read_text(encoding="utf-8"))
        self.profile = tool_profile(self.scenario, summary)
        names = [f"{n}{a}{u}" for n, u in (("p", "_m"), ("axis_", ""), ("f", "_N")) for a in "xyz"]
        rows = read_columns(folder / name / "trajectory.csv", ["time_s", *names])
        self.time = rows["time_s"]
        self.tip, self.axis, self.force = (np.column_stack([rows[n] for n in names[i:i + 3]]) for i in (0, 3, 6))
        shell = read_columns(folder / f"{name}.csv", ["x_m", "y_m", "z_m"])
        self.points = np.column_stack(list(shell.values()))
        planar = not np.ptp(self.points[:, 2]) and not np.ptp(self.tip[:, 2])
        self.across, self.up = 0, (1 if planar else 2)

    def plane(self, vectors):
        return vectors[:, [self.across, self.up]]

    def section(self):
        return section(self.points, (self.across, self.up), self.tip)

    def tool(self, row):
        return outline(self.profile, *(self.plane(vectors[row:row + 1])[0] for vectors in (self.tip, self.axis)))


def picture(scene, half):
    colour = look(scene.scenario["rendering"]["algorithm"]).colour
    with style.plt.rc_context(style.SETTINGS):
        figure, (left, right) = style.plt.subplots(1, 2, figsize=INCHES, width_ratios=[1, 1.7])
        draw_section(left, scene, half, colour)
        draw_force(right, scene, colour)
        drawn = style.picture(figure, "svg", salt=scene.name, dpi=110)
        style.plt.close(figure)
    return drawn


def draw_section(ax, scene, half, colour):
    # As an image: thousands of points would make the file large.
    ax.plot(*1e3 * scene.section().T, ".", color=style.PETROL, ms=1.5, rasterized=True)
    way = 1e3 * scene.plane(scene.tip)
    middle = (np.nanmin(way, 0) + np.nanmax(way, 0)) / 2
    near = np.flatnonzero((np.abs(way - middle) <= 1.5 * half).all(axis=1))
    rows = near[np.linspace(0, len(near) - 1, SNAPSHOTS).astype(int)]
    for row, grey in zip(rows, ("#BBBBBB", "#8E8E8E", style.GREY, style.BLACK)):
        ax.add_patch(Polygon(1e3 * scene.tool(row), closed=True, facecolor="none", edgecolor=grey, lw=0.9))
    shown = way[near[:: max(1, len(near) // 600)]]
    ax.plot(*shown.T, color=style.AMBER if colour == style.BLACK else colour, lw=1.2)
    ax.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half), aspect="equal",
           xlabel="x [mm]", ylabel="xyz"[scene.up] + " [mm]")
    ax.grid(False)


def draw_force(ax, scene, colour):
    size = np.linalg.norm(scene.force, axis=1)
    time, low, high = style.reduced(scene.time, size, size, SPANS)
    ax.fill_between(time, low, high, color=colour, lw=0.6)
    ax.set(xlabel="time [s]", ylabel="rendered force [N]", ylim=(0, None),
           title=look(scene.scenario["rendering"]["algorithm"]).label)
    ax.margins(x=0.01)
