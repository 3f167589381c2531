"""Elements that several figures share: the numbers that the thesis publishes, and the planar peg-in-hole scene with its
contacts. Drawings are in millimetres."""
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.patches import Polygon

import hapbench_style as style

MM = 1e3
ROOT = Path(__file__).resolve().parents[3]
PUBLISHED = {
    entry["id"]: entry
    for entry in json.loads(
        (ROOT / "results/reference/published.json").read_text(encoding="utf-8")
    )["values"]
}
LEDGER = "claims.json"  # measured numbers of each claim, stored beside the results


def published(id_):
    """Returns the published number of an entry of PUBLISHED: its value, or else its mean."""
    return PUBLISHED[id_].get("value", PUBLISHED[id_].get("mean"))


def spread(id_):
    """Returns the published standard deviation of an entry of PUBLISHED, or else its standard error."""
    return PUBLISHED[id_].get("std", PUBLISHED[id_].get("standard_error"))


@dataclass(frozen=True)
class Contacts:
    """Contacts of one step. Coordinates are in the plane of the scene, in SI units."""

    point: np.ndarray
    normal: np.ndarray
    depth: np.ndarray
    gradient: np.ndarray
    weight: np.ndarray

    def flipped(self):
        """Returns for each contact True if its gradient points along the outward normal. Such a contact pulls the tool
        into the surface."""
        return np.einsum("ij,ij->i", self.gradient, self.normal) > 0


@dataclass(frozen=True)
class Peg:
    """Pose and size of a tool with a round tip, in the plane of the scene and in SI units. `axis` points out of the
    tip."""

    tip: np.ndarray
    axis: np.ndarray
    diameter: float
    length: float

    def outline(self):
        side = np.array([-self.axis[1], self.axis[0]])
        turn = np.linspace(-np.pi / 2, np.pi / 2, 25)[:, None]
        round_tip = np.cos(turn) * self.axis + np.sin(turn) * side
        r = self.diameter / 2
        back = self.tip - self.length * self.axis
        return np.vstack([self.tip + r * round_tip, back + r * side, back - r * side])

    def inside(self, points):
        s = (points - self.tip) @ self.axis
        radial = np.abs((points - self.tip) @ np.array([-self.axis[1], self.axis[0]]))
        distance = np.where(s > 0, np.hypot(s, radial), radial)
        return (distance <= self.diameter / 2) & (s >= -self.length)

    def exit_distance(self, points, directions):
        """Returns the distance [m] that each point moves along its direction until it leaves the tool. The tool is
        convex, so that bisection finds the distance."""
        low, high = np.zeros(len(points)), np.full(len(points), 2 * (self.length + self.diameter))
        for _ in range(40):
            middle = (low + high) / 2
            within = self.inside(points + middle[:, None] * directions)
            low, high = np.where(within, middle, low), np.where(within, high, middle)
        return low


def peg_of(tool, rows, step):
    """Returns the Peg with the pose in row `step` of a trajectory. `tool`: the tool of the scenario."""
    tip, axis = (
        np.array([rows[name][step] for name in names])
        for names in (("px_m", "py_m"), ("axis_x", "axis_y"))
    )
    return Peg(tip, axis, tool["diameter_m"], tool["length_m"])


class Sweep:
    """Results of a run whose contacts were recorded."""

    def __init__(self, results, name, group="thesis"):
        self.scenario = results.json(f"{group}/{name}/scenario.effective.json")
        self.rows = results.table(f"{group}/{name}/trajectory.csv")
        self.all = results.table(f"{group}/{name}/contacts.csv")
        self.tilt = np.arctan2(np.abs(self.rows["axis_x"]), -self.rows["axis_y"])

    def step_at(self, tilt):
        return int(np.argmin(np.abs(self.tilt - tilt)))

    def contacts(self, step):
        selected = self.all["step"] == self.rows["step"][step]
        pick = {name: column[selected] for name, column in self.all.items()}
        return Contacts(
            np.stack([pick["x_m"], pick["y_m"]], 1),
            np.stack([pick["nx"], pick["ny"]], 1),
            pick["depth_m"],
            np.stack([pick["gradient_x"], pick["gradient_y"]], 1),
            pick["weight"],
        )

    def peg(self, step):
        return peg_of(self.scenario["tool"], self.rows, step)

    def force(self, step, name="fspring_"):
        return np.array([self.rows[f"{name}x_N"][step], self.rows[f"{name}y_N"][step]])


def draw_hole(ax, environment, points=False):
    half, depth, mouth = environment["width_m"] / 2, environment["depth_m"], environment["mouth_m"]
    corners = np.array(
        [
            [-half - mouth, 0],
            [-half, 0],
            [-half, -depth],
            [half, -depth],
            [half, 0],
            [half + mouth, 0],
            [half + mouth, -depth - 0.5e-3],
            [-half - mouth, -depth - 0.5e-3],
        ]
    )
    ax.add_patch(
        Polygon(corners * MM, closed=True, facecolor=style.SAND, edgecolor="none", zorder=0)
    )
    ax.plot(*(corners[:6] * MM).T, color=style.SOIL, lw=0.9, zorder=1)
    if points:
        arc_length = np.append(0, np.cumsum(np.linalg.norm(np.diff(corners[:6], axis=0), axis=1)))
        stations = np.arange(0, arc_length[-1] + 1e-9, environment["spacing_m"])
        ax.plot(
            *(np.interp(stations, arc_length, corners[:6, i]) * MM for i in (0, 1)),
            ".",
            color=style.PETROL,
            ms=2.2,
            zorder=2,
        )
    ax.set_aspect("equal")
    ax.grid(False)


def draw_peg(ax, peg, median=False, **keywords):
    keywords = {"facecolor": "none", "edgecolor": style.BLACK, "lw": 1.2, "zorder": 3, **keywords}
    ax.add_patch(Polygon(peg.outline() * MM, closed=True, **keywords))
    if median:
        ends = np.stack([peg.tip, peg.tip - peg.length * peg.axis])
        ax.plot(*(ends * MM).T, color=style.GREY, lw=0.8, ls=(0, (6, 3)), zorder=3)


def draw_segments(ax, contacts, colours):
    """Draws a segment from each contact point along the gradient of the contact. The length of the segment is the depth
    of the contact: by the depth model, a point that moves along the segment leaves the tool at the end of the segment.
    """
    ends = contacts.point + contacts.depth[:, None] * contacts.gradient
    for colour in dict.fromkeys(colours):
        same_colour = [c == colour for c in colours]
        # All segments of a colour are one line with gaps, and all marks are one line, because single elements would
        # make the SVG much larger.
        lines = (
            np.stack(
                [
                    contacts.point[same_colour],
                    ends[same_colour],
                    np.full_like(ends[same_colour], np.nan),
                ],
                1,
            ).reshape(-1, 2)
            * MM
        )
        ax.plot(*lines.T, color=colour, lw=1.0, zorder=4)
        ax.plot(
            *(contacts.point[same_colour] * MM).T, "o", ms=2.65, color=colour, mec="none", zorder=5
        )


def draw_arrow(ax, start, vector, colour, label=None, at=(3, 3), **keywords):
    """Draws an arrow from `start` to `start + vector`, in the units of the axes, with the label at its head."""
    head = np.asarray(start) + vector
    style_ = {
        "arrowstyle": "-|>",
        "color": colour,
        "lw": 1.8,
        "shrinkA": 0,
        "shrinkB": 0,
        "mutation_scale": 9,
        **keywords,
    }
    ax.annotate("", xy=head, xytext=start, arrowprops=style_, zorder=6)
    if label:
        ax.annotate(
            label,
            xy=head,
            xytext=at,
            textcoords="offset points",
            color=colour,
            fontsize=7.5,
            bbox=style.PLATE,
            zorder=7,
        )


def frame(ax, x, y):
    """Sets the visible region of the scene [mm]."""
    ax.set(xlim=x, ylim=y, xlabel="x [mm]", ylabel="y [mm]")


def draw_contacts(ax, sweep, step, x, y, flips=False):
    """Draws hole, peg and contacts with their depths in the region `x`, `y` [mm], and returns the contacts. With
    `flips`, draws the median line of the peg instead of the points of the hole, and draws flipped gradients in petrol.
    """
    contacts = sweep.contacts(step)
    draw_hole(ax, sweep.scenario["environment"], points=not flips)
    draw_peg(ax, sweep.peg(step), median=flips)
    draw_segments(ax, contacts, np.where(contacts.flipped() & flips, style.PETROL, style.AMBER))
    frame(ax, x, y)
    return contacts
