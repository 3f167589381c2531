"""Generated parts of a manual, which stand between `<!-- generated: NAME -->` and `<!-- /generated -->`: sessions, tables of the
ledger (claims.json) and of its robustness as results/reference holds them, and tables of studies that are too wide for a manual as
the program prints them."""
import json
import re
import shlex
import textwrap
from pathlib import Path

import numpy as np
from hapbench.columns import read_records
from hapbench_report.ledger import plausible

from .manuals import ROOT
from .program import ProgramError

BLOCK = re.compile(r"(<!-- generated: (\S+)[^\n]*-->\n)(.*?)(<!-- /generated -->)", re.S)
BEGIN = "<!-- generated:"
REFERENCE = ROOT / "results" / "reference"
VERDICTS = ("reproduced", "reproduced in kind", "not reproduced", "refuted", "not reproducible")
TASKS = {"D1": "upright, 0.52 mm aside", "D2": "upright, centre", "D3": "turning, 3 mm high", "D4": "turning, 4 mm high"}
PAIR = re.compile(r"success(?: rate)? (.+?) vs ([^;(]+)")


class BlockError(Exception):
    """A block that nobody makes, or that has no end."""


def renewed(text, makers):
    """The text with each block made anew by `makers[NAME](old)`; blocks without a maker stay."""
    if text.count(BEGIN) != len(BLOCK.findall(text)):
        raise BlockError('a block that begins with "<!-- generated: NAME -->" lacks its end "<!-- /generated -->"')

    def replaced(found):
        head, name, old, tail = found.groups()
        return f"{head}{makers[name](old).strip(chr(10))}\n{tail}" if name in makers else found[0]

    return BLOCK.sub(replaced, text)


def number(value):
    """Three digits, with an exponent only where the zeros would have to be counted."""
    if value and abs(value) < 1e-3:
        return f"{value:.3g}".replace("e-0", "e-")
    return f"{value:.0f}" if abs(value) >= 1e3 else f"{value:.3g}"


def session(old, program, directory):
    """A command in a manual with what it printed, on which commit and machine: the block with the output of its first command."""
    line = next((line.strip() for line in old.splitlines() if line.strip().startswith("$ hapbench ")), None)
    if line is None:
        raise ProgramError("a session begins with an indented line: $ hapbench …")
    output = program.run(shlex.split(line)[2:], directory)
    shown = "\n".join(f"    {text}".rstrip() for text in [line, "", *output.strip("\n").splitlines()])
    return program.stamped(shown, old)


def read(name):
    return json.loads((REFERENCE / name).read_text(encoding="utf-8"))


def headline(_old=""):
    """How many claims have which verdict, and how many verdicts are steady."""
    return wrapped([read("claims.json")["headline"]])


def main_results(_old=""):
    """The main results, as the ledger opens with them."""
    return (REFERENCE / "claims.md").read_text(encoding="utf-8").split("\n\n")[0]


def verdicts(_old=""):
    """How many claims have which verdict, how many of them steadily, and which; then what was found on the way."""
    ledger = read("claims.json")["claims"]
    claims = [claim for claim in ledger if not claim["ours"]]
    lines = ["| verdict | claims | steady | which |", "|---|---|---|---|"]
    for verdict in VERDICTS:
        those = [claim for claim in claims if claim["verdict"] == verdict]
        steady = sum(claim["sureness"] == "steady" for claim in those)
        lines.append(f"| {verdict} | {len(those)} of {len(claims)} | {steady} | {' '.join(claim['id'] for claim in those)} |")
    ours = [f"{claim['id']} {claim['claim']} ({claim['verdict']})" for claim in ledger if claim["ours"]]
    return wrapped([*lines, "", f"Found on the way, and no claims of the thesis: {'; '.join(ours)}."])


def experiments(_old=""):
    """Success in the thesis's experiments, measured with simulated subjects and published with people."""
    by_id = {claim["id"]: claim for claim in read("claims.json")["claims"]}
    lines = ["| task and target | original algorithm, ours (published) | stiffness shaping, ours (published) |", "|---|---|---|"]
    for id_, task in TASKS.items():
        published = PAIR.search(re.sub(r" \(printed [^)]*\)", "", by_id[id_]["published"]))
        measured = PAIR.search(by_id[id_]["measured"])
        cells = (f"{measured[i].strip()} ({published[i].strip()})" for i in (1, 2))
        lines.append(f"| {task} ({id_}) | {' | '.join(cells)} |")
    return "\n".join(lines)


def robustness(_old=""):
    """How firmly the verdicts hold over the choices on record: and the fragile ones."""
    claims = read("claims.json")["claims"]
    sampled = [claim for claim in claims if claim["robustness"]]
    always = [claim for claim in sampled if claim["robustness"]["holds"] == claim["robustness"]["judged"]]
    fragile = [claim for claim in sampled if claim["sureness"] == "fragile"]
    untouched = [claim["id"] for claim in claims if not claim["choices_reach_it"] and claim["verdict"] != "not reproducible"]
    judged = [claim["robustness"]["judged"] for claim in sampled]
    lines = [f"Of {len(sampled)} verdicts that were sampled, in {min(judged)} to {max(judged)} readings, "
             f" {len(always)} are the same in every sample. No recorded choice reaches {' '.join(untouched)}. Fragile are "
             "these; the ledger has the others:",
             "", "| claim | recorded | recorded verdict in | decided by (first-order Sobol index) |", "|---|---|---|---|"]
    for claim in fragile:
        counts = claim["robustness"]
        by = counts["decided_by"]
        decided = f"`{by['choice']}` ({by['index']:.2f})" if by else "no single choice"
        lines.append(f"| {claim['id']} | {claim['verdict']} | {counts['holds']} of {counts['judged']} | {decided} |")
    return wrapped(lines)


def choices(_old=""):
    """What the thesis leaves open and what was chosen."""
    lines = ["| id | choice | the thesis | value | plausible | seen results? | why | fields |", "|---|---|---|---|---|---|---|---|"]
    for choice in read("choices.json")["choices"]:
        fields = "; ".join(f"`{field['path']}{' ×' if field.get('times') else ''}` of {', '.join(field['scenarios'])}" for field in choice.get("fields", []))
        value = f"{choice['value']} {choice.get('unit', '')}".strip()
        lines.append(f"| {choice['id']} | {choice['what']} | {choice['thesis']} | {value} | {plausible(choice)} | {choice['chosen']} | "
                     f"{choice['why']} | {fields or 'read by rules'} |")
    return "\n".join(lines)


def rows_of(text, block, column):
    """Name of the algorithm -> number, of a column of a block's table; without rows of an algorithm with something else."""
    table = next(found[3] for found in BLOCK.finditer(text) if found[2] == block)
    rows = re.findall(r"^\| `(\w+)` \|(.*)\|$", table, re.M)
    return {name: float(cells.split("|")[column]) for name, cells in rows if cells.split("|")[column].strip()}


def ranking(values, unit):
    """The best three and the worst, in words."""
    def shown(name):
        return f"`{name}` ({values[name]:.3g} {unit})"

    best = sorted(values, key=values.get)
    return f"{', '.join(map(shown, best[:3]))}; last {shown(best[-1])}"


def which_law(text):
    """Which algorithm when, by the tables of the same manual."""
    vibrations = {}
    for line in next(found[3] for found in BLOCK.finditer(text) if found[2] == "session").splitlines():
        law, *cells = line.split() or [""]
        if len(cells) >= 3 and all(re.fullmatch(r"[\d.]+(e[+-]\d+)?", cell) for cell in cells[-3:]):
            vibrations[law] = float(cells[-3])  # the last three are vibration, depth, how the tool shakes
    lines = []
    for title, values, unit in (
            ("Nearest to the ideal trajectory in height", rows_of(text, "in_the_hole", 0), "mm rms"),
            ("Least deep in the wall", rows_of(text, "in_the_hole", 2), "mm"),
            ("Least vibration of the force, peg in the hole", vibrations, "N rms above 30 Hz"),
            ("Least jump of the force as contacts come and go", rows_of(text, "in_the_hole", 6), "N")):
        lines += [f"- {title}: {ranking(values, unit)}."]
    return "\n".join(textwrap.fill(line, 110, subsequent_indent="  ") for line in lines)


def wrapped(lines, width=110):
    """Sentences in lines of that width; tables stay."""
    return "\n".join(line if line.startswith("|") else "\n".join(textwrap.wrap(line, width)) for line in lines)


TAPPED = 10_000.0  # K [N/m] of the wall that a hand taps on with a controller
CONTROLLERS = (
    ("none", None),
    ("`energy_tank`, 0.1 J", {"type": "energy_tank"}),
    ("`energy_tank`, 1 mJ", {"type": "energy_tank", "capacity_J": 1e-3}),
    ("`actuator_limited_passivity`, 20 N s/m", {"type": "actuator_limited_passivity", "max_damping_N_s_per_m": 20}),
    ("`actuator_limited_passivity`, 100 N s/m", {"type": "actuator_limited_passivity", "max_damping_N_s_per_m": 100}),
    ("the same, 3 N", {"type": "actuator_limited_passivity", "max_damping_N_s_per_m": 100, "max_force_N": [3, 3, 3]}),
)


def controllers(old, program, directory):
    """What force stages gain at a wall on a handle and what they cost a hand that taps on a wall: stiffness and damping felt by
    least squares of the rendered force over depth and velocity in contact."""
    lines = ["| force stage | bounded up to [N/m], B = 0.1, 3.9, 150 N s/m | created [mJ] | taken [mJ] | rows changed [%] | "
             "stiffness felt, of K | damping felt [N s/m] | largest force step [N] |", "|---" * 8 + "|"]
    for name, stage in CONTROLLERS:
        chosen = [] if stage is None else ["--set", f"rendering.force_stage={json.dumps(stage)}"]
        program.run(["limit", "wall_on_handle", "--over", "rendering.damping_N_s_per_m=0.1:150:3:log", "--between", "1:1e9", "--stable", "bounded",
                     "--algorithms", "summation", "--out", "over", *chosen], directory)
        edges = read_records(Path(directory) / "over" / "limit.csv")
        run = json.loads(program.run(["run", "tap_wall", "--set", f"rendering.stiffness_N_per_m={TAPPED:g}", "--set", "record.trajectory=true",
                                      "--set", "expect={}", "--out", "tap", "--json", *chosen], directory))
        run = run[0] if isinstance(run, list) else run
        touching = [row for row in read_records(Path(directory) / "tap" / "trajectory.csv") if float(row["rendered"]) > 0]
        column = lambda key: np.array([float(row[key]) for row in touching])
        felt, _, _, _ = np.linalg.lstsq(-np.column_stack([column("pz_m"), column("vz_m_per_s")]), column("fz_N"), rcond=None)
        of_stage = run.get("force_stage", {"taken_J": 0.0, "changed_share": 0.0})
        cells = [", ".join(number(float(edge["limit"])) for edge in edges), number(1e3 * run["passivity"]["net_created_J"]),
                 number(1e3 * of_stage["taken_J"]), number(100 * of_stage["changed_share"]), number(felt[0] / TAPPED), number(round(felt[1], 3)),
                 number(run["metrics"]["force_step_max_N"])]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return program.stamped("\n".join(lines), old)


DAMPINGS = (
    ("0", ["rendering.damping_ratio=0"]),
    ("zeta 0.7", ["rendering.damping_ratio=0.7"]),
    ("chi 10", ['rendering.damping={"type":"hunt_crossley","chi_s_per_m":10}']),
    ("chi 100", ['rendering.damping={"type":"hunt_crossley","chi_s_per_m":100}']),
)
DAMPED = ("landing_force_max_N", "force_rms_above_30Hz_N", "settled_force_step_max_N")


def hunt_crossley(old, program, directory):
    """Laws on the molar under damping that is there at once and damping that grows with depth."""
    found = {}
    for name, overrides in DAMPINGS:
        words = [word for override in (*overrides, "record.energy=true", "expect={}") for word in ("--set", override)]
        for run in json.loads(program.run(["compare", "drag_molar", "--algorithms", "shaped_stiffness,summation,proxy", *words, "--json"], directory)):
            found.setdefault(run["algorithm"], {})[name] = run
    lines = ["| | damping | outcome | landing [N] | above 30 Hz [N rms] | largest settled step [N] | created [mJ] | damped [mJ] |", "|---" * 8 + "|"]
    for law, runs in found.items():
        for name, run in runs.items():
            metrics = [number(run["metrics"][key]) if run["metrics"].get(key) is not None else "-" for key in DAMPED]
            energy = [number(1e3 * run["passivity"]["net_created_J"]), number(-1e3 * run["energy"]["damping_J"])]
            cells = [*metrics, *energy] if run["outcome"] == "completes" else ["-"] * 5
            lines.append(f"| `{law}` | {name} | {run['outcome']} | {' | '.join(cells)} |")
    return program.stamped("\n".join(lines), old)


# The tables that need no program.
MAKERS = {"headline": headline, "main_results": main_results, "verdicts": verdicts, "experiments": experiments,
          "robustness": robustness, "choices": choices}
