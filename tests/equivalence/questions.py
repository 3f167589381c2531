"""The questions, one a row: what the program of commit 661d2580 was asked, and what is asked today for the same answer. A question
whose answer has left the program leaves with its tables, in a commit that says why."""
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Question:
    name: str
    old: str  # the words of 661d2580, without --json and --out
    tables: dict  # on record: where today's answer has them, a CSV file in --out or "json" and the place of a list in what is printed
    new: str = ""  # today's words, where they are others
    columns: dict = field(default_factory=dict)  # on record: today's name, where it is another
    tolerance: dict = field(default_factory=dict)  # of a column on record: (relative, the reason); without, the same text or number
    status: int = 0


def limit(name, words, status=0):
    return Question(name, f"limit {words}", {"limits": "json.limits"}, status=status)


def tune(name, words):
    return Question(name, f"tune {words}", {"laws": "json.algorithms", "choice": "json"})


def converge(name, words):
    return Question(name, f"converge {words}", {"orders": "converge.csv", "levels": "converge_levels.csv"})


def devices(name, words, ends="interval"):
    return Question(name, f"compare {words}", {"limits": "json.limits", "ends": f"json.{ends}.limits"})


def stability_map(name):
    return Question(f"map_{name}", f"stability --map {name} --size 5 --algorithms shaped_stiffness",
                    {"classes": f"stability_map_{name}.csv", "edge": f"stability_boundary_{name}.csv"})


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
    "mine.json": '{"type": "impedance", "handle_mass_kg": 0.1, "viscous_N_s_per_m": 0.5, "coulomb_N": 0.1, "delay_samples": 1.5}',
}

K = "rendering.stiffness_N_per_m"
QUESTIONS = [
    limit("limit_of_springs", f"single_spring --vary {K} --algorithms mean,summation,tandpasta"),
    limit("limit_smallest_mass", "single_spring --vary rendering.mass_kg --smallest"),
    limit("limit_time_step", "springs_oscillation --vary time.step_s --resolution 0.01"),
    limit("limit_both_ends_of_damping", "loop.json --vary rendering.damping_N_s_per_m --between 0.01:1e4 --resolution 0.01"),
    limit("limit_on_device", f"loop.json --vary {K} --algorithms mean,summation,shaped_stiffness,proxy --resolution 0.01"),
    limit("limit_by_vibration", f"tap_corner --vary {K} --vibration 0.001 --algorithms all --resolution 0.05"),
    limit("limit_servo_delay", "device_at_wall --vary device.servo.delay_samples --between 0:60"),
    limit("limit_with_bound", f"poke_plane --vary {K} --smallest --bound inside_settled_m=3e-4 --resolution 0.01"),
    limit("limit_in_hole", f"tap_hole --vary {K} --algorithms mean,summation,shaped_stiffness,normal_projection,proxy --resolution 0.05"),
    limit("limit_without_effect", """loop.json --vary device.velocity_filter.cutoff_Hz --resolution 0.1
          --set 'device.velocity_filter={"type": "low_pass", "cutoff_Hz": 100}' --set rendering.damping_ratio=0"""),
    limit("limit_mesh", f"drag_molar --vary {K} --resolution 0.05 --algorithms mean,shaped_stiffness,summation"),
    tune("tune_on_device", "impedance_at_wall --algorithms mean,shaped_stiffness --damping-ratio 0.2:0.3"),
    tune("tune_of_springs", "single_spring"),
    tune("tune_on_preset", "tap_corner --device omega.3 --algorithms proxy,normal_projection --margin 2 --damping-ratio 0.5:0.7"),
    tune("tune_mass_of_admittance", "device_at_wall --mass 0.05:0.5 --damping-ratio 0.3:0.7"),
    tune("tune_of_nothing_feasible", "tap_wall --max-inside 0.0001 --max-vibration 1e-6 --over speeds --damping-ratio 0.5:0.6"),
    tune("tune_with_filters", "loop.json --filters --over hands,seeds --max-step 0.5 --damping-ratio 0.05:0.1"),
    converge("converge_springs", "springs_oscillation --metric force_max_N,inside_max_m,final_position_m.x"),
    converge("converge_step", "poke_plane --metric force_max_N,inside_settled_m,passivity.energy_min_J --levels 6"),
    converge("converge_shell", "drag_molar --vary environment.spacing_m --metric force_rms_above_30Hz_N,inside_max_m --levels 3 --set time.duration_s=1"),
    converge("converge_other_field", "explorer_on_bumps --vary tool.grid_m --metric force_max_N,force_mean_in_contact_N --levels 3 --to 1%"),
    converge("converge_on_device", "loop.json --metric force_max_N,inside_settled_m --levels 5 --ratio 3"),
    devices("devices_over_what_is_not_published", "tap_wall --devices all --algorithms mean --resolution 0.02"),
    devices("devices_in_scenes", "tap_corner tap_hole --devices touch,mine.json,omega.3 --resolution 0.05"),
    devices("devices_over_friction", "loop.json --devices touch,ideal,admittance --friction 0,2 --algorithms mean,summation --resolution 0.05", "friction"),
    *map(stability_map, ("time_step", "mass", "damping_ratio", "contacts", "wedge", "device", "z_width", "delay", "velocity_filter", "hand",
                         "encoder_step", "friction_quantisation")),
    *map(accuracy, ("integrators", "shaping", "spacing", "reduction", "merging", "algorithms", "events")),
    accuracy("late_contacts", "--set time.duration_s=0.2"),
    Question("stability_of_springs", "stability single_spring", {"limits": "limits.csv"}),
    # 64 verdicts: eight claims in eight samples of the choices, which stand in the table, too.
    Question("robustness", "reproduce --only B1b,B2,C2,C3,C5,L2,L3,V1 --robustness 8 --ledger out/claims.json", {"verdicts": "robustness.csv"}),
]
