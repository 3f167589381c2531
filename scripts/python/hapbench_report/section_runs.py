"""The table of all runs; parameters, provenance and command of each; studies; timing."""
import json

from .json_input import at, number_or_none
from .markup import cell, command, heading_cell, number_cell, table, text
from .section_ledger import filters
from .studies import LIMITS

# Metric of summary.json -> heading and factor.
METRICS = (
    ("force_max_N", "Max force, N", 1),
    ("velocity_total_variation_m_per_s", "Velocity TV, m/s", 1),
    ("force_reversals", "Reversals", 1),
    ("depth_max_m", "Max depth, mm", 1000),
    ("ratio_min", "Ratio min", 1),
    ("ratio_max", "Ratio max", 1),
    ("colliding_mean", "Points raw", 1),
    ("rendered_mean", "Points rendered", 1),
)


def runs_section(runs):
    rows = []
    for run in runs:
        outcome = text(run.outcome.replace("_", " ")) + ("" if run.expected else ' <b class="bad">✗ unexpected</b>')
        rows.append([cell(text(run.group)), cell(f'<a href="#{run.anchor}">{text(run.path.split("/")[-1])}</a>', classes="name"),
                     cell(text(run.algorithm)), cell(outcome),
                     number_cell(at(run.summary, "/steps")),
                     *(number_cell(scaled(run.metric(key), factor), 3) for key, _, factor in METRICS)])
    headings = [*(heading_cell(t) for t in ("Part", "Name", "Algorithm", "Outcome")),
                heading_cell("Steps", True), *(heading_cell(title, True) for _, title, _ in METRICS)]
    return ("<p>Click a heading to sort; names lead to parameters, provenance and the command.</p>"
            + filters("runs-table", [("Part", 0), ("Algorithm", 2), ("Outcome", 3)])
            + table(headings, rows, "<b>All runs</b> TV: total variation; ratio: combined stiffness along a contact in units "
                    "of K; points: mean numbers of colliding points, raw and rendered", "sortable", "runs-table"))


def scaled(value, factor):
    return value if value is None or factor == 1 else value * factor


def parameters_section(runs):
    return ("<p>The full scenario of every run, defaults filled in; saved to a file and run again it gives the same "
            "bytes.</p>" + "\n".join(run_details(run) for run in runs))


def run_details(run):
    description = str(run.scenario.get("description", ""))
    source = str(run.scenario.get("source", ""))
    about = f"<p>{text(description)}" + (f" <span class=note>Thesis: {text(source)}</span>" if source else "") + "</p>"
    parts = [(title, run.scenario.get(title)) for title in run.scenario
             if title not in ("name", "description", "source", "expect")]
    return (f'<details id="{run.anchor}"><summary>{text(run.path)}</summary>{about}{command(rerun(run))}'
            f"<pre>{text(compact(dict(parts)))}</pre>"
            f"<p class=note>State hash {text(run.summary.get('state_hash', '–'))}, scenario hash "
            f"{text(at(run.summary, '/provenance/scenario_hash') or '–')}.</p></details>")


def rerun(run):
    """The command of this very run. A comparison is one scenario through several algorithms."""
    line = f"hapbench run {run.name} --out {run.path}"
    return line + (f" --set rendering.algorithm={run.algorithm}" if run.compared else "")


def compact(parts):
    """One line per part."""
    return "\n".join(f"{key}: {json.dumps(value, ensure_ascii=False)}" for key, value in parts.items())


def studies_section(studies):
    # Limits and times have places of their own.
    others = [s for s in studies if s.path != LIMITS and not s.path.endswith("_timing.csv")]
    others.sort(key=lambda study: not study.path.startswith("precision/"))
    shown = "".join(study_table(study) for study in others)
    return ("<p>Precision studies give the error against a reference solution, one study per choice; their times are under "
            "Timing.</p>" + shown if shown else '<p class="note">No studies among these results.</p>')


def provenance_of(runs):
    """Distinct builds and machines, with the number of their runs."""
    found = {}
    for run in runs:
        build = {k: v for k, v in (run.summary.get("provenance") or {}).items() if k != "scenario_hash"}
        key = json.dumps(build, sort_keys=True)
        found[key] = found.get(key, 0) + 1
    return [(json.loads(key), count) for key, count in sorted(found.items())]


def provenance_section(provenance):
    keys = sorted({key for build, _ in provenance for key in build})
    rows = [[*(cell(text(build.get(key, "–"))) for key in keys), cell(str(count), classes="number")]
            for build, count in provenance]
    headings = [*(heading_cell(text(key.replace("_", " "))) for key in keys), heading_cell("Runs", True)]
    mixed = ("<p><b class=bad>✗ These results come from more than one build or machine.</b></p>"
             if len(provenance) > 1 else "")
    dirty = any(str(build.get("commit", "")).endswith("-dirty") for build, _ in provenance)
    note = ("<p class=note>A commit that ends in -dirty had changes that were not committed.</p>" if dirty else "")
    return mixed + table(headings, rows, "<b>What produced the results</b>") + note


def study_table(study):
    factors = [1e6 if title.startswith("seconds_per_") else 1 for title in study.header]
    rows = [[study_cell(value, factor) for value, factor in zip(row, factors)] for row in study.rows]
    numeric = [all(is_number(row[i]) for row in study.rows) for i in range(len(study.header))]
    headings = [heading_cell(text(title.replace("seconds_per_", "µs per ").replace("_", " ")), n)
                for title, n in zip(study.header, numeric)]
    return table(headings, rows, f"<b>{text(study.title)}</b> <code>{text(study.path)}</code>", "sortable")


def is_number(value):
    try:
        return number_or_none(float(value)) is not None
    except ValueError:
        return False


def study_cell(value, factor):
    return number_cell(scaled(float(value), factor)) if is_number(value) else cell(text(value))


def timing_section(runs, studies):
    timed = [run for run in runs if run.timing]
    rows = [[cell(f'<a href="#{run.anchor}">{text(run.path)}</a>'), cell(text(run.algorithm)),
             number_cell(in_microseconds(run, "/step_mean_s"), 3), number_cell(at(run.timing, "/shell_s"), 3),
             number_cell(at(run.timing, "/loop_s"), 3), cell(text(at(run.timing, "/build/instruction_set") or "–"))]
            for run in timed]
    headings = [heading_cell("Run"), heading_cell("Algorithm"), *(heading_cell(t, True) for t in (
        "Mean step, µs", "Shell, s", "Loop, s")), heading_cell("Instruction set")]
    of_runs = table(headings, rows, "<b>Runs that recorded their time</b>", "sortable") if rows else ""
    timed_studies = "".join(study_table(study) for study in studies if study.path.endswith("_timing.csv"))
    of_studies = f"<div class=tables>{timed_studies}</div>" if timed_studies else ""
    note = ("<p>Wall times on the machine named under provenance; the only numbers here that differ from run to run. "
            "The trainer's loop has 488 µs per step (2048 Hz).</p>")
    return note + (of_runs + of_studies or '<p class="note">No times were recorded (<code>--set record.timing=true</code>).</p>')


def in_microseconds(run, pointer):
    return scaled(number_or_none(at(run.timing, pointer)), 1e6)
