"""What the program of commit 661d2580 answered is still answered: answers.txt, a table behind each line "# question table", with the
columns by their names of today. A question whose answer has left the program leaves with its tables, in a commit that says why.

    python3 tests/scripts/fixture.py tests/equivalence/equivalence_test.py PROGRAM [NAME…]     all questions, or those of these names
"""
import csv
import json
import math
import shlex
import sys
import tempfile
import unittest
from pathlib import Path

from fixture import PROGRAM, must

HERE = Path(__file__).resolve().parent
NAMED = sys.argv[2:]
KNOWN = {
    title: list(csv.DictReader(text.splitlines()))
    for title, _, text in (
        part.partition("\n")
        for part in (HERE / "answers.txt").read_text(encoding="utf-8").split("# ")[1:]
    )
}
K = "rendering.stiffness_N_per_m"
# A wall, a hand and a device with friction and encoder: no theory but that of the loop.
LOOP = """{"time": {"step_s": 0.001, "steps": 600}, "tool": {"diameter_m": 0.01, "length_m": 0.1},
    "environment": {"type": "plane", "size_m": 0.006, "spacing_m": 0.001},
    "hand": {"type": "mass_spring_damper", "mass_kg": 0.2, "stiffness_N_per_m": 300, "damping_N_s_per_m": 6, "target": {"x_m": 0, "y_m": 0, "z_m": -0.003}},
    "device": {"type": "impedance", "handle_mass_kg": 0.1, "viscous_N_s_per_m": 0.5, "coulomb_N": 0.1, "encoder_step_m": 1e-5},
    "rendering": {"stiffness_N_per_m": 2000, "damping_ratio": 0.1, "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0}}}"""
# Questions by their names, in groups. Of an interval that is the answer, values between its ends are tried, but over one seed only one.
LIMITS = {
    "limit_of_springs": f"single_spring --vary {K} --algorithms mean,summation,tandpasta",
    "limit_smallest_mass": "single_spring --vary rendering.mass_kg --smallest",
    "limit_time_step": "springs_oscillation --vary time.step_s --resolution 0.01",
    "limit_both_ends_of_damping": "loop.json --vary rendering.damping_N_s_per_m --between 0.01:1e4 --resolution 0.01",
    "limit_on_device": f"loop.json --vary {K} --algorithms mean,summation,shaped_stiffness,proxy --resolution 0.01",
    "limit_servo_delay": "device_at_wall --vary device.servo.delay_samples --between 0:60",
    "limit_with_bound": f"poke_plane --vary {K} --smallest --bound inside_settled_m=3e-4 --resolution 0.01",
    "limit_in_hole": f"tap_hole --vary {K} --algorithms mean,summation,shaped_stiffness,normal_projection,proxy --resolution 0.05",
    "limit_without_effect": """loop.json --vary device.velocity_filter.cutoff_Hz --resolution 0.1
        --set 'device.velocity_filter={"type": "low_pass", "cutoff_Hz": 100}' --set rendering.damping_ratio=0""",
    "limit_mesh": f"drag_molar --vary {K} --resolution 0.05 --algorithms mean,shaped_stiffness,summation",
}
CONVERGENCE = {
    "converge_springs": "springs_oscillation --metric force_max_N,inside_max_m,final_position_m.x",
    "converge_step": "poke_plane --metric force_max_N,inside_settled_m,passivity.energy_min_J --levels 6",
    "converge_shell": "drag_molar --vary environment.spacing_m --metric force_rms_above_30Hz_N,inside_max_m --levels 3 --set time.duration_s=1",
    "converge_other_field": "explorer_on_bumps --vary tool.grid_m --metric force_max_N,force_mean_in_contact_N --levels 3 --to 1%",
    "converge_on_device": "loop.json --metric force_max_N,inside_settled_m --levels 5 --ratio 3",
}
HAND = """'hand={"type": "mass_spring_damper", "mass_kg": 0.2, "stiffness_N_per_m": 100, "damping_N_s_per_m": 2, "target": {"x_m": 0, "y_m": 0, "z_m": 0}}'"""
MAPS = {
    "map_time_step": "single_spring --over time.step_s=5e-5:5e-3:5:log --set time.steps=8000",
    "map_damping_ratio": "single_spring --over rendering.damping_ratio=0:3:5 --set time.steps=8000",
    "map_z_width": "wall_on_handle --over rendering.damping_N_s_per_m=0.1:150:5:log",
    "map_delay": "wall_on_handle --over device.delay_samples=0:8:5",
    "map_velocity_filter": """wall_on_handle --over device.velocity_filter.cutoff_Hz=20:500:5:log
        --set 'device.velocity_filter={"type": "low_pass", "cutoff_Hz": 100}'""",
    "map_hand": f"wall_on_handle --over hand.stiffness_N_per_m=10:1e4:5:log --set {HAND}",
}
ACCURACY = [
    f"accuracy_{panel}"
    for panel in (
        "integrators",
        "shaping",
        "spacing",
        "reduction",
        "merging",
        "algorithms",
        "events",
        "late_contacts",
    )
]
SPRINGS = [f"spring_{field}" for field in ("stiffness", "damping", "time_step")]
# By the beginning of a question's name and the column: how far the number may be off, relative. All others are the same.
TOLERANCES = {
    "map_": {
        **dict.fromkeys(
            (
                "time.step_s",
                "rendering.damping_N_s_per_m",
                "hand.stiffness_N_per_m",
                K,
                "stable_gil_hulin",
            ),
            1e-12,
        ),  # the same value of a range, whose ends are others
        **dict.fromkeys(
            ("theory", "worst_hand"), 1e-9
        ),  # an edge by eigenvalues, bisected from another range
        "limit": 2e-3,
    },  # bisection on runs ends at 0.1 %
    "accuracy_reduction": dict.fromkeys(
        ("kept_mean", "force_error_relative", "depth_error_max_m"), 1e-12
    ),  # forces added up in another order
    "spring_": {"closed_form": 1e-9, "theory": 1e-9, "limit": 2e-4},
}


def text_of(value):
    """A cell as CSV files have it: of a list how long it is."""
    if isinstance(value, list):
        return str(len(value))
    return (
        ""
        if value is None
        else str(value).lower()
        if isinstance(value, bool)
        else value
        if isinstance(value, str)
        else repr(value)
    )


def of_grid(rows, low, high):
    """The runs at five stiffnesses in equal ratios from low to high: every second or fourth that the search tries at once."""
    grid = [low * (high / low) ** (i / 4) for i in range(5)]
    return [
        row
        for row in rows
        if any(math.isclose(float(row[K]), value, rel_tol=1e-9) for value in grid)
    ]


def answers(name):
    """The tables of a question by their names, as today's program has them."""
    with tempfile.TemporaryDirectory(prefix="hapbench-test-") as scratch:
        Path(scratch, "loop.json").write_text(LOOP, encoding="utf-8")

        def asked(command, words, program=PROGRAM, more="--json --out out"):
            return json.loads(
                must(program, *command.split(), *shlex.split(words), *more.split(), cwd=scratch)
            )

        def table(file):
            return list(
                csv.DictReader(Path(scratch, "out", file).read_text(encoding="utf-8").splitlines())
            )

        if name in LIMITS:
            return {
                "limits": asked("limit", f"{LIMITS[name]} --stable settled --over seed=1")["limits"]
            }
        if name in ACCURACY:
            told = asked(
                "",
                f"--benchmark_filter=^{name.removeprefix('accuracy_')}/",
                PROGRAM.with_name("hapbench_accuracy"),
                "--benchmark_min_time=0.0001 --benchmark_format=json",
            )["benchmarks"]
            return {
                "errors": [
                    {
                        **one,
                        "setting": one["name"].partition("/")[2].removesuffix("/manual_time"),
                        "outcome": one["label"],
                    }
                    for one in told
                ]
            }
        if name in CONVERGENCE:
            asked("converge", CONVERGENCE[name])
            return {"orders": table("converge.csv"), "levels": table("converge_levels.csv")}
        if name in SPRINGS:
            asked("limit", name)
            return {"limits": table("limit.csv")}
        wall = "wall_on_handle" in MAPS[name]
        asked(
            "limit",
            f"{MAPS[name]} --between {'0.1:1e11' if wall else '10:1e9'} --stable bounded --algorithms shaped_stiffness",
        )
        return {
            "classes": of_grid(table("limit_runs.csv"), *((1e2, 1e5) if wall else (1e3, 1e7))),
            "edge": table("limit.csv"),
        }


def same(value, known, relative):
    try:
        return value == known or math.isclose(
            float(value), float(known), rel_tol=relative, abs_tol=0.0
        )
    except ValueError:
        return False


def differences(question, table, rows):
    """What is not as on record, a line each."""
    known = KNOWN[f"{question} {table}"]
    within = next((of for begin, of in TOLERANCES.items() if question.startswith(begin)), {})
    if len(rows) != len(known):
        yield f"{table}: {len(known)} rows on record, now {len(rows)}"
    for i, (row, before) in enumerate(zip(rows, known)):
        for column, cell in before.items():
            if not same(text_of(row.get(column, "")), cell, within.get(column, 0.0)):
                yield f"{table}, row {i + 1} ({', '.join(list(before.values())[:2])}): {column} {cell} on record, now {row.get(column, 'missing')}"


class Equivalence(unittest.TestCase):
    def test_old_answers_hold(self):
        questions = [*LIMITS, *CONVERGENCE, *MAPS, *ACCURACY, *SPRINGS]
        self.assertEqual({title.split()[0] for title in KNOWN}, set(questions))
        for question in NAMED or questions:
            with self.subTest(question=question):
                found = [
                    line
                    for table, rows in answers(question).items()
                    for line in differences(question, table, rows)
                ]
                self.assertEqual(found[:20], [], f"{len(found)} differences")

    def test_another_number_is_found(self):
        rows = KNOWN["limit_of_springs limits"]
        self.assertEqual(list(differences("limit_of_springs", "limits", rows)), [])
        other = repr(math.nextafter(float(rows[0]["limit"]), math.inf))
        self.assertEqual(
            len(
                list(
                    differences(
                        "limit_of_springs", "limits", [{**rows[0], "limit": other}, *rows[1:]]
                    )
                )
            ),
            1,
        )
