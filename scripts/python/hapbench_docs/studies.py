"""Tables of studies that are too wide for a manual as the program prints them."""
import json

from hapbench_bench.table import number

# Name in the study, heading, factor of the unit.
COLUMNS = (
    ("ideal_height_error_rms_m", "height error [mm rms]", 1e3),
    ("ideal_lateral_error_rms_m", "lateral error [mm rms]", 1e3),
    ("interpenetration_max_m", "deepest in the wall [mm]", 1e3),
    ("force_step_max_N", "largest force step [N]", 1.0),
)


SOURCES = {"own": "ours", "fcl": "FCL", "bullet": "Bullet"}
TASKS = (("T1", "poke_on_flat"), ("T2", "rotate_in_hole"), ("T3", "round_the_wall"))
# The ideal trajectory of the hole means something in T2 only.
SOURCE_COLUMNS = (
    ("contacts_mean", "contacts", 1.0),
    ("depth_max_mean_m", "deepest [µm]", 1e6),
    ("spring_force_error_rms_N", "force apart [N rms]", 1.0),
    ("way_apart_rms_m", "way apart [µm rms]", 1e6),
    ("ideal_height_error_rms_m", "height error [mm rms]", 1e3),
    ("force_step_max_N", "largest force step [N]", 1.0),
)


def ideal_trajectory(old, program, directory):
    """Every algorithm against the ideal trajectory of task 2."""
    found = json.loads(program.run(["precision", "algorithms", "--repetitions", "1", "--json"], directory))[0]["rows"]
    lines = [f"| | {' | '.join(heading for _, heading, _ in COLUMNS)} |", "|---" * (len(COLUMNS) + 1) + "|"]
    for row in found:
        cells = (f"{factor * row[name]:.3g}" if row.get(name) is not None else "" for name, _, factor in COLUMNS)
        lines.append(f"| `{row['setting'].replace(' + ', '` + `')}` | {' | '.join(cells)} |")
    return program.stamped("\n".join(lines), old)


def contact_sources(old, program, directory):
    """The default law with the contacts of other libraries, in the tasks; the old table if they are not built."""
    lines = [f"| task | contacts of | {' | '.join(heading for _, heading, _ in SOURCE_COLUMNS)} |",
             "|---" * (len(SOURCE_COLUMNS) + 2) + "|"]
    for task, scene in TASKS:
        words = ["precision", "contact_sources", "--scenario", scene, "--repetitions", "1", "--json"]
        found = json.loads(program.run(words, directory))[0]["rows"]
        if any(row["outcome"] == "not built" for row in found):
            return old
        for row in found:
            cells = [f"{number(factor * row[name])}" if task == "T2" or not name.startswith("ideal_") else ""
                     for name, _, factor in SOURCE_COLUMNS]
            lines.append(f"| {task} | {SOURCES[row['setting']]} | {' | '.join(cells)} |")
    return program.stamped("\n".join(lines), old)
