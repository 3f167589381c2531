"""Tables of studies that are too wide for a manual as the program prints them."""
import json

# Name in the study, heading, factor of the unit.
COLUMNS = (
    ("ideal_height_error_rms_m", "height error [mm rms]", 1e3),
    ("ideal_lateral_error_rms_m", "lateral error [mm rms]", 1e3),
    ("interpenetration_max_m", "deepest in the wall [mm]", 1e3),
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
