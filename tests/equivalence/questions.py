"""The questions, one a row: what the program of commit 661d2580 was asked, and what is asked today for the same answer. A question
whose answer has left the program leaves with its tables, in a commit that says why."""
import math
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Question:
    name: str
    old: str  # the words of 661d2580, without --json and --out
    tables: dict  # on record: where today's answer has them, a CSV file in --out, "json" and the place of a list in what is printed, a
    # function of the JSON that is printed, or a file and a function of its rows
    new: str = ""  # today's words, where they are others
    columns: dict = field(default_factory=dict)  # on record: today's name, where it is another; None: not told any more
    tolerance: dict = field(default_factory=dict)  # of a column on record: (relative, the reason); without, the same text or number
    status: int = 0


K = "rendering.stiffness_N_per_m"


def limit(name, words, status=0):
    """Asked over one seed: a table of values is searched as before, while an interval that is the answer is tried between its ends."""
    return Question(name, f"limit {words}", {"limits": "json.limits"}, f"limit {words} --stable settled --over seed=1", status=status)


def converge(name, words):
    return Question(name, f"converge {words}", {"orders": "converge.csv", "levels": "converge_levels.csv"})


def of_grid(low, high):
    """The runs of limit_runs.csv at five stiffnesses in equal ratios from low to high: every second or fourth that its search tries at once."""
    grid = [low * (high / low) ** (i / 4) for i in range(5)]
    return lambda rows: [row for row in rows if any(math.isclose(float(row[K]), value, rel_tol=1e-9) for value in grid)]


def stability_map(name, x, words, y="stiffness_N_per_m", wall=False):
    """K over another field: what a map was, `limit --over` answers, and its runs have the classes. Margins, the integrator and what the map
    did not ask for are not told, and no_theory is an empty theory."""
    path, low, high, between = words.split()[2].partition("=")[0], *((1e2, 1e5, "0.1:1e11") if wall else (1e3, 1e7, "10:1e9"))
    untold = ("lambda_max", "stability_margin", "integrator", "class_from_far", "overrides", "relative_difference", "no_theory", f"tangent_{y}")
    known = ("worst_hand", "passive_colgate_schenkel", "passive_with_delay", "stable_gil_hulin", "passive_abbott_okamura", "exact_undamped_handle")
    bisected = (1e-9, "an edge by eigenvalues, bisected from another range to rounding")
    grid = (1e-12, "the same value of a range, whose ends are others")
    return Question(f"map_{name}", f"stability --map {name} --size 5 --algorithms shaped_stiffness",
                    {"classes": ("limit_runs.csv", of_grid(low, high)), "edge": "limit.csv"},
                    f"limit {words} --between {between} --stable bounded --algorithms shaped_stiffness",
                    {x: path, y: K, f"analytic_{y}": "theory", f"simulation_{y}": "limit", **{f"{limit}_{y}": limit for limit in known},
                     **dict.fromkeys(untold)},
                    {x: grid, y: grid, f"stable_gil_hulin_{y}": grid, f"analytic_{y}": bisected, f"worst_hand_{y}": bisected,
                     f"simulation_{y}": (2e-3, "bisection on runs ends at a width of 0.1 %, wherever it begins")})


def limit_of_spring(name):
    """Rows of one table that three studies have today. What grows and its unit are in the study, the damping there is by zeta, and lambda_max is
    told of cases alone that are compared."""
    bisected = (1e-9, "an edge that was in closed form or by bisection to 1e-10, now bisected to rounding")
    return Question(f"spring_{name}", "stability single_spring", {"limits": "limit.csv"}, f"limit spring_{name}",
                    {"analytic": "theory", "eigenvalue": "theory", "simulation": "limit",
                     **dict.fromkeys(("case", "unit", "damping_at_limit_N_s_per_m", "lambda_max"))},
                    {"analytic": bisected, "eigenvalue": bisected,
                     "simulation": (2e-4, "bisection on runs ends at a width of 1e-4, wherever it begins")})


def accuracy(name, words=""):
    """Errors of a panel of run time against error. How stiff a law may be with late contacts is asked of `limit`, and what stood in a
    setting's name, too, stands there alone."""
    return Question(f"accuracy_{name}", f"precision {name} --repetitions 1 {words}".rstrip(), {"errors": f"panel {name}"}, f"hapbench_accuracy ^{name}/",
                    tolerance=dict.fromkeys(("kept_mean", "force_error_relative", "depth_error_max_m"), (1e-12, "of forces in place of depths, added up in another order")) if name == "reduction" else {})


# Files that the questions name.
GIVEN = {
    # A wall, a hand and a device with friction and encoder: no theory but that of the loop.
    "loop.json": """{"time": {"step_s": 0.001, "steps": 600}, "tool": {"diameter_m": 0.01, "length_m": 0.1},
        "environment": {"type": "plane", "size_m": 0.006, "spacing_m": 0.001},
        "hand": {"type": "mass_spring_damper", "mass_kg": 0.2, "stiffness_N_per_m": 300, "damping_N_s_per_m": 6, "target": {"x_m": 0, "y_m": 0, "z_m": -0.003}},
        "device": {"type": "impedance", "handle_mass_kg": 0.1, "viscous_N_s_per_m": 0.5, "coulomb_N": 0.1, "encoder_step_m": 1e-5},
        "rendering": {"stiffness_N_per_m": 2000, "damping_ratio": 0.1, "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0}}}""",
}

QUESTIONS = [
    limit("limit_of_springs", f"single_spring --vary {K} --algorithms mean,summation,tandpasta"),
    limit("limit_smallest_mass", "single_spring --vary rendering.mass_kg --smallest"),
    limit("limit_time_step", "springs_oscillation --vary time.step_s --resolution 0.01"),
    limit("limit_both_ends_of_damping", "loop.json --vary rendering.damping_N_s_per_m --between 0.01:1e4 --resolution 0.01"),
    limit("limit_on_device", f"loop.json --vary {K} --algorithms mean,summation,shaped_stiffness,proxy --resolution 0.01"),
    limit("limit_servo_delay", "device_at_wall --vary device.servo.delay_samples --between 0:60"),
    limit("limit_with_bound", f"poke_plane --vary {K} --smallest --bound inside_settled_m=3e-4 --resolution 0.01"),
    limit("limit_in_hole", f"tap_hole --vary {K} --algorithms mean,summation,shaped_stiffness,normal_projection,proxy --resolution 0.05"),
    limit("limit_without_effect", """loop.json --vary device.velocity_filter.cutoff_Hz --resolution 0.1
          --set 'device.velocity_filter={"type": "low_pass", "cutoff_Hz": 100}' --set rendering.damping_ratio=0"""),
    limit("limit_mesh", f"drag_molar --vary {K} --resolution 0.05 --algorithms mean,shaped_stiffness,summation"),
    converge("converge_springs", "springs_oscillation --metric force_max_N,inside_max_m,final_position_m.x"),
    converge("converge_step", "poke_plane --metric force_max_N,inside_settled_m,passivity.energy_min_J --levels 6"),
    converge("converge_shell", "drag_molar --vary environment.spacing_m --metric force_rms_above_30Hz_N,inside_max_m --levels 3 --set time.duration_s=1"),
    converge("converge_other_field", "explorer_on_bumps --vary tool.grid_m --metric force_max_N,force_mean_in_contact_N --levels 3 --to 1%"),
    converge("converge_on_device", "loop.json --metric force_max_N,inside_settled_m --levels 5 --ratio 3"),
    # The maps over mass, contacts, wedge, servo delay of the admittance device, encoder step and friction are a page of text: they are asked no more.
    stability_map("time_step", "time_step_s", "single_spring --over time.step_s=5e-5:5e-3:5:log --set time.steps=8000"),
    stability_map("damping_ratio", "damping_ratio", "single_spring --over rendering.damping_ratio=0:3:5 --set time.steps=8000"),
    stability_map("z_width", "wall_damping_N_s_per_m", "wall_on_handle --over rendering.damping_N_s_per_m=0.1:150:5:log", wall=True),
    stability_map("delay", "delay_samples", "wall_on_handle --over device.delay_samples=0:8:5", wall=True),
    stability_map("velocity_filter", "cutoff_Hz", """wall_on_handle --over device.velocity_filter.cutoff_Hz=20:500:5:log
                  --set 'device.velocity_filter={"type": "low_pass", "cutoff_Hz": 100}'""", wall=True),
    stability_map("hand", "hand_stiffness_N_per_m", """wall_on_handle --over hand.stiffness_N_per_m=10:1e4:5:log
                  --set 'hand={"type": "mass_spring_damper", "mass_kg": 0.2, "stiffness_N_per_m": 100, "damping_N_s_per_m": 2,
                  "target": {"x_m": 0, "y_m": 0, "z_m": 0}}'""", wall=True),
    *map(accuracy, ("integrators", "shaping", "spacing", "reduction", "merging", "algorithms", "events")),
    accuracy("late_contacts", "--set time.duration_s=0.2"),
    *map(limit_of_spring, ("stiffness", "damping", "time_step")),
]
