"""The table of all runs; parameters, provenance and command of each."""
import json

from .colours import algorithm_name
from .json_input import at
from .links import listed
from .markup import cell, command, counted, folded, heading_cell, number_cell, table, text
from .section_ledger import filters

# Metric of summary.json -> heading, unit and factor.
METRICS = (
    ("force_max_N", "Max force", "N", 1),
    ("velocity_total_variation_m_per_s", "Velocity TV", "m/s", 1),
    ("force_reversals", "Reversals", "", 1),
    ("depth_max_m", "Max depth", "mm", 1000),
    ("ratio_min", "Ratio min", "", 1),
    ("ratio_max", "Ratio max", "", 1),
    ("colliding_mean", "Points raw", "", 1),
    ("rendered_mean", "Points rendered", "", 1),
)


def runs_section(runs):
    rows = []
    for run in runs:
        outcome = text(run.outcome.replace("_", " ")) + ("" if run.expected else ' <b class="bad">✗ unexpected</b>')
        rows.append([cell(text(part_of(run))), cell(f'<a href="#{run.anchor}">{text(run.name)}</a>', classes="name"),
                     cell(algorithm_name(run.algorithm, text(run.algorithm)), classes="name"), cell(outcome),
                     number_cell(at(run.summary, "/steps")),
                     *(number_cell(scaled(run.metric(key), factor), 3) for key, _, _, factor in METRICS)])
    headings = [*(heading_cell(t) for t in ("Part", "Scenario", "Algorithm", "Outcome")),
                heading_cell("Steps", True), *(heading_cell(title, True, unit) for _, title, unit, _ in METRICS)]
    return ("<p>Click a heading to sort; scenarios lead to parameters, provenance and the command.</p>"
            + filters("runs-table", [("Part", 0), ("Algorithm", 2), ("Outcome", 3)])
            + table(headings, rows, "<b>All runs</b> TV: total variation; ratio: combined stiffness along a contact in units "
                    "of K; points: mean numbers of colliding points, raw and rendered", "sortable", "runs-table"))


def scaled(value, factor):
    return value if value is None or factor == 1 else value * factor


def parameters_section(runs, links):
    return ("<p>The full scenario of every run, defaults filled in; saved to a file and run again it gives the same "
            "bytes.</p>" + "\n".join(folded(f"{text(part)} <span class=note>{counted(len(own), 'run')}</span>",
                                          "".join(run_details(run, links) for run in own))
                                   for part, own in by_part(runs).items()))


def by_part(runs):
    parts = {}
    for run in runs:
        parts.setdefault(part_of(run), []).append(run)
    return parts


def part_of(run):
    return run.path.rpartition("/")[0] or run.group


def run_details(run, links):
    description = str(run.scenario.get("description", ""))
    source = str(run.scenario.get("source", ""))
    about = f"<p>{text(description)}" + (f" <span class=note>Thesis: {text(source)}</span>" if source else "") + "</p>"
    claims, figures = links.of_run(run)
    parts = [(title, run.scenario.get(title)) for title in run.scenario
             if title not in ("name", "description", "source", "expect")]
    return (f'<details id="{run.anchor}"><summary>{text(run.path)}</summary>{about}'
            f"{listed('Claims', claims)}{listed('Figures', figures)}{command(rerun(run))}"
            f"<pre>{text(compact(dict(parts)))}</pre>"
            f"<p class=note>State hash {text(run.summary.get('state_hash', '–'))}, scenario hash "
            f"{text(at(run.summary, '/provenance/scenario_hash') or '–')}{plugin_text(run)}.</p></details>")


def rerun(run):
    """The command of this very run. A comparison is one scenario through several algorithms."""
    line = f"hapbench run {run.name} --out {run.path}"
    return line + (f" --set rendering.algorithm={run.algorithm}" if run.compared else "")


def compact(parts):
    """One line per part."""
    return "\n".join(f"{key}: {json.dumps(value, ensure_ascii=False)}" for key, value in parts.items())


def plugin_text(run):
    plugin = at(run.summary, "/provenance/plugin")
    return f", law from {text(plugin['file'])} with hash {text(plugin['hash'])}" if plugin else ""


def provenance_of(runs):
    """Distinct builds and machines, with the number of their runs."""
    found = {}
    for run in runs:
        # What is the scenario's or the law's own is no other build.
        build = {k: v for k, v in (run.summary.get("provenance") or {}).items() if k not in ("scenario_hash", "plugin")}
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
