"""Every figure: its id, which figure of the thesis it redraws, and the function that draws it."""
from dataclasses import dataclass
from typing import Callable, Optional

from . import (comparison, damping, depth, drill, experiments, peg_in_hole, performance, stability, stiffness_fields, subjects,
               tasks)


@dataclass(frozen=True)
class Figure:
    """`draw(results)` returns the drawing and its caption; it raises MissingResult when its data is not there."""

    id: str
    thesis: Optional[str]
    title: str
    draw: Callable
    differs: str = ""  # from the thesis's figure, and why
    page: bool = False  # ours, and on record all the same

    @property
    def stem(self):
        return "figure_" + self.id.replace("-", "_").replace("/", "_")



FIGURES = (
    Figure("2", "2", "Excessive stiffness and ways to merge contacts", stiffness_fields.excessive_stiffness,
           "Computed stiffness fields in place of sketches."),
    Figure("4", "4", "Contacts before and after the reduction", tasks.point_counts,
           "Three hands of ours in place of one logged person, since no recording is published; both readings of the "
           "density; the loop load is that of the machine that drew it, and is missing where none was timed."),
    Figure("5", "5", "Stiffness ratio over the iterations, by task", tasks.convergence_by_task,
           "By task, as quantiles over all steps in contact, in place of a recording over time (E.3 and E.4 have that); "
           "scripted hands."),
    Figure("6", "6", "Displacement with and without the limit of the input force", damping.force_limit,
           "A scripted hand that presses evenly up to 5 N in place of a person."),
    Figure("7", "7a-c", "Trajectory of the tip against the ideal one", drill.trajectory,
           "Constant hands in place of one recording split at 2 N: which force pressed decides the height. The path over "
           "the tilt is ours."),
    Figure("8", "8", "Shortest distance and surface normal", depth.shortest_distance_and_normal,
           "Depths of a point that crosses the median line, computed, in place of sketches."),
    Figure("A.1", "A.1", "The planar simulation", peg_in_hole.simulation_view,
           "The hole's depth and the pose are not published, and are ours."),
    Figure("A.2", "A.2a-b", "Peg-in-hole, original algorithm and stiffness shaping", peg_in_hole.trajectories,
           "Snapshots and the tip's velocity in place of one path each; depth of the hole, first tilt and turn rate are "
           "ours. Without friction, as Table A.1 has none; with that of Table B.1 thin beside it."),
    Figure("A.4-springs", "A.4 (springs)", "Springs, damping and force not limited", comparison.unlimited,
           "With 100 pairs the damping of a sum is 22 times what A.3 allows, so that not every law reaches the origin "
           "(ERRATA.md)."),
    Figure("A.5", "A.5", "Springs, damping and force limited", comparison.limited,
           "As figure A.4; the thesis does not say which laws it draws."),
    Figure("A.4-root-locus", "A.4 (root locus)", "Root locus of the integrator", stability.root_locus,
           "Nothing: eigenvalues of the same matrix."),
    Figure("B.3", "B.3", "Gradient flipping", depth.gradient_flipping,
           "Computed gradients and forces in place of sketches."),
    Figure("B.4", "B.4, B.5", "Damping against an implicit plane", damping.implicit_plane,
           "B.4 and B.5 in one, from computed forces; (c) is ours, and leaves the tangential damping out."),
    Figure("B.3.3", None, "A few contacts turn the original algorithm round", peg_in_hole.turned_direction),
    Figure("C.1", "C.1", "Underestimated depth", depth.underestimation,
           "Computed depths in place of sketches."),
    Figure("C.2", "C.2", "Distribution of the number of contacts", tasks.count_distribution,
           "Distributions in place of a recording over time, which figure 4 has; scripted hands."),
    Figure("C.3", "C.3", "Stiffness fields as the peg tilts", stiffness_fields.fields_over_tilt,
           "Computed stiffness fields in place of shaded sketches."),
    Figure("C.4", "C.4", "Convergence of the stiffness ratio", tasks.convergence,
           "Quantiles over all steps of tasks 2 and 3, both densities, in place of one recording."),
    Figure("D.6", "D.6", "Effort the subjects felt", experiments.questionnaires,
           "The published numbers alone: nothing simulated fills in forms."),
    Figure("D.7", "D.7", "Vertical peg-in-hole task", experiments.vertical,
           "Simulated subjects beside the published means; what their threshold does is in the figure "
           "\"threshold\"."),
    Figure("D.8", "D.8", "Rotational peg-in-hole task", experiments.rotational,
           "As figure D.7."),
    Figure("E.1", "E.1", "Position of the tip over time", tasks.positions,
           "Scripted hands and paths: no recording is published."),
    Figure("E.2", "E.2", "Model force over time", tasks.model_force,
           "As figure E.1; task 2's hand presses with a tenth of appendix D's forces, since only the published counts "
           "calibrate it."),
    Figure("E.3", "E.3", "Greatest stiffness ratio over time", tasks.greatest_ratio,
           "As figure E.1; ranges in spans of time."),
    Figure("E.4", "E.4", "Least stiffness ratio over time", tasks.least_ratio,
           "As figure E.3."),
    Figure("F.4", "F.4", "Normal projection at a corner", depth.corner,
           "A run against a corner in place of a sketch."),
    Figure("F.5", "F.5", "Tandpasta's redistribution", peg_in_hole.redistribution,
           "Forces to scale at one pose of ours."),
    Figure("threshold", None, "Success against what the task checks", subjects.threshold, page=True),
    Figure("algorithms", None, "Every algorithm on the planar peg-in-hole", comparison.algorithms),
    Figure("discussion", None, "Cases of the thesis's discussion", comparison.discussion),
    Figure("stiffness", None, "Stiffness in every direction, all algorithms", stiffness_fields.of_all_algorithms),
    Figure("proxy", None, "The drill turned in the hole, with a proxy and with shaping", drill.rotated),
    Figure("torque", None, "The torque that is lost as the drill is turned", drill.lost),
    Figure("accuracy", None, "Run time against error", performance.run_time_against_error),
    Figure("latency", None, "Latency of a step", performance.latency),
    *(Figure(f"stability-{name}", None, f"Stability over {name.replace('_', ' ')}", stability.stability_over(f"stability_{name}"))
      for name in ("time_step", "damping_ratio", "z_width", "delay", "velocity_filter", "hand")),
    Figure("devices", None, "What each device renders with each algorithm", stability.of_all_devices),
    Figure("hardware", None, "Measured and predicted limits of a real paddle", stability.hardware),
    Figure("stability-integrators", None, "Stability under each integrator", stability.integrators),
)
