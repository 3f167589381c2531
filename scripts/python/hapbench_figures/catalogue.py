"""Every figure: its id, which figure of the thesis it redraws, and the function that draws it."""
from dataclasses import dataclass
from typing import Callable, Optional

from . import comparison, damping, depth, drill, experiments, peg_in_hole, performance, stability, stiffness_fields, tasks


@dataclass(frozen=True)
class Figure:
    """`draw(results)` returns the drawing and its caption; it raises MissingResult when its data is not there."""

    id: str
    thesis: Optional[str]
    title: str
    draw: Callable

    @property
    def stem(self):
        return "figure_" + self.id.replace("-", "_").replace("/", "_")


STABILITY_MAPS = ("time_step", "mass", "damping_ratio", "contacts", "wedge", "device", "z_width", "delay", "velocity_filter",
                  "hand", "encoder_step", "friction_quantisation")

FIGURES = (
    Figure("2", "2", "Excessive stiffness and ways to merge contacts", stiffness_fields.excessive_stiffness),
    Figure("4", "4", "Contacts before and after the reduction", tasks.point_counts),
    Figure("5", "5", "Stiffness ratio over the iterations, by task", tasks.convergence_by_task),
    Figure("6", "6", "Displacement with and without the limit of the input force", damping.force_limit),
    Figure("7", "7a-c", "Trajectory of the tip against the ideal one", drill.trajectory),
    Figure("8", "8", "Shortest distance and surface normal", depth.shortest_distance_and_normal),
    Figure("A.1", "A.1", "The planar simulation", peg_in_hole.simulation_view),
    Figure("A.2", "A.2a-b", "Peg-in-hole, original algorithm and stiffness shaping", peg_in_hole.trajectories),
    Figure("A.4-springs", "A.4 (springs)", "Springs, damping and force not limited", comparison.unlimited),
    Figure("A.5", "A.5", "Springs, damping and force limited", comparison.limited),
    Figure("A.4-root-locus", "A.4 (root locus)", "Root locus of the integrator", stability.root_locus),
    Figure("B.3", "B.3", "Gradient flipping", depth.gradient_flipping),
    Figure("B.4", "B.4, B.5", "Damping against an implicit plane", damping.implicit_plane),
    Figure("B.3.3", None, "A few contacts turn the original algorithm round", peg_in_hole.turned_direction),
    Figure("C.1", "C.1", "Underestimated depth", depth.underestimation),
    Figure("C.2", "C.2", "Distribution of the number of contacts", tasks.count_distribution),
    Figure("C.3", "C.3", "Stiffness fields as the peg tilts", stiffness_fields.fields_over_tilt),
    Figure("C.4", "C.4", "Convergence of the stiffness ratio", tasks.convergence),
    Figure("D.6", "D.6", "Effort the subjects felt", experiments.questionnaires),
    Figure("D.7", "D.7", "Vertical peg-in-hole task", experiments.vertical),
    Figure("D.8", "D.8", "Rotational peg-in-hole task", experiments.rotational),
    Figure("E.1", "E.1", "Position of the tip over time", tasks.positions),
    Figure("E.2", "E.2", "Model force over time", tasks.model_force),
    Figure("E.3", "E.3", "Greatest stiffness ratio over time", tasks.greatest_ratio),
    Figure("E.4", "E.4", "Least stiffness ratio over time", tasks.least_ratio),
    Figure("F.4", "F.4", "Normal projection at a corner", depth.corner),
    Figure("F.5", "F.5", "Tandpasta's redistribution", peg_in_hole.redistribution),
    Figure("algorithms", None, "Every algorithm on the planar peg-in-hole", comparison.algorithms),
    Figure("discussion", None, "Cases of the thesis's discussion", comparison.discussion),
    Figure("stiffness", None, "Stiffness in every direction, all algorithms", stiffness_fields.of_all_algorithms),
    Figure("proxy", None, "The drill turned in the hole, with a proxy and with shaping", drill.rotated),
    Figure("torque", None, "The torque that is lost as the drill is turned", drill.lost),
    Figure("precision", None, "Work against precision", performance.work_precision),
    Figure("query-time", None, "Query time over penetration depth", performance.query_time),
    Figure("latency", None, "Latency of a step", performance.latency),
    Figure("growth", None, "How cost grows", performance.growth),
    *(Figure(f"stability-{name}", None, f"Stability over {name.replace('_', ' ')}", stability.stability_map(name))
      for name in STABILITY_MAPS),
    Figure("devices", None, "What each device renders with each algorithm", stability.of_all_devices),
    Figure("stability-integrators", None, "Stability under each integrator", stability.integrators),
)
