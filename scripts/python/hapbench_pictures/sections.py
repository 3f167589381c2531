"""The sections of a page of runs that are text and tables."""
import json
import shlex

import numpy as np
from scipy import stats

from hapbench.results import at, number_or_none
from hapbench_report.live_link import live_link
from hapbench_report.markup import cell, columns, command, deserved_digits, heading_cell, named, number, number_cell, table, text
from hapbench_report.runs import plugin_text, provenance_of, provenance_section

from .given import SEED_FOLDER

FIRST = ("force_mean_in_contact_N", "force_max_N", "force_step_p99_N", "force_rms_above_30Hz_N", "inside_max_m")


def summary_section(runs, labels):
    names = list(dict.fromkeys(run.name for run in runs))
    descriptions = list(dict.fromkeys(str(run.scenario.get("description") or "") for run in runs))
    about = "".join(f"<p class=lead>{text(words)}</p>" for words in descriptions[:3] if words)
    return f"<h1>{named(', '.join(names))}</h1>{about}{first_table(runs, labels)}"


def first_table(runs, labels):
    shown = [name for name in FIRST if any(run.metric(name) is not None for run in runs)]
    return table(*metric_rows(runs, labels, "metrics", shown, (heading_cell("Outcome"), [outcome_cell(run) for run in runs]),
                              (heading_cell("In contact", True), [cell(contact_text(run), run.metric("contact_share") or 0, "number") for run in runs])),
                 classes="sortable")


def outcome_cell(run):
    """What a copy of a bundled scenario inherits may surprise its owner."""
    how = text(run.outcome.replace("_", " ") or "–")
    if run.expected:
        return cell(how)
    wanted = at(run.scenario, "/expect/outcome") or "other results"
    wanted = " or ".join(map(str, wanted)) if isinstance(wanted, list) else wanted
    return cell(f'<b class=bad>{how}</b><br><span class=note>its field <code>expect</code> names {text(wanted)}; a scenario that was copied '
                "keeps that field, <code>--set expect={}</code> drops it</span>")


def contact_text(run):
    return f"{percent(run.metric('contact_share'))} of {number(at(run.summary, '/duration_s'), 4)} s"


def percent(share):
    return "–" if share is None else f"{number(100 * share, 3)} %"


def warnings_section(runs, labels):
    said = [(label, warning) for run, label in zip(runs, labels) for warning in run.warnings]
    return said and "<ul>" + "".join(f"<li><b>{text(label)}:</b> {text(warning)}</li>" for label, warning in said) + "</ul>"


def diagnosis_section(runs, labels):
    """What is wrong by the rules of the program, and what to try; of runs that were asked for it."""
    said = [(label, found) for run, label in zip(runs, labels) for found in run.summary.get("diagnosis", ())]
    return said and "<ul>" + "".join(f"<li><b>{text(label)}:</b> {text(found['says'])} <i>try: {text(found['try'])}</i></li>" for label, found in said) + "</ul>"


def metric_rows(runs, labels, section, names, *beside):
    """Headings and rows of a table of metrics, a row for each run; `beside`: pairs of a heading and its cells."""
    values = [[number_or_none(run.sections.get(section, {}).get(name)) for name in names] for run in runs]
    headings, cells = columns(names, values, [[run.tolerance(section, name) for name in names] for run in runs])
    rows = [[cell(named(label), classes="name"), *(of[i] for _, of in beside), *own] for i, (label, own) in enumerate(zip(labels, cells))]
    return [heading_cell("Run"), *(heading for heading, _ in beside), *headings], rows


def metrics_section(runs, labels):
    """All that the summaries measured, section by section."""
    names = dict.fromkeys((section, name) for run in runs for section, values in run.sections.items() for name in values)
    rows = [[cell(text(section)), cell(f"<code>{text(name)}</code>"),
             *(metric_cell(run.sections.get(section, {}).get(name), run.tolerance(section, name)) for run in runs)]
            for section, name in names]
    headings = [heading_cell("Section"), heading_cell("Metric"), *(heading_cell(text(label), True) for label in labels)]
    return table(headings, rows, "<b>All metrics</b> <code>hapbench describe</code> and a metric's name explain it")


def seeds_section(runs):
    """What lies between laws over the seeds of a comparison: of each metric the law with the least mean against every other."""
    scenes = {}
    for run in runs:
        if SEED_FOLDER.fullmatch(run.folder.name):
            scenes.setdefault(run.name, {}).setdefault(run.algorithm, {})[run.folder.name] = run
    said = [f"<li>{text(scene)}, <code>{name}</code>: {text(sentence)}</li>" for scene, laws in scenes.items() for name in FIRST
            for sentence in between(laws, name)]
    return said and f"<ul>{''.join(said)}</ul><p class=note>Seed by seed, as a seed gives all laws the same start; ±: 95 % interval of the mean.</p>"


def between(laws, metric):
    """A sentence for each law beside the one with the least mean, over the seeds in which both have the metric."""
    values = {law: {seed: run.metric(metric) for seed, run in of.items() if run.metric(metric) is not None} for law, of in laws.items()}
    values = {law: of for law, of in values.items() if len(of) > 1}
    least = min(values, key=lambda law: np.mean(list(values[law].values())), default=None)
    for law in values:
        shared = [seed for seed in values[law] if seed in values[least]]
        if law == least or len(shared) < 2:
            continue
        more = np.array([values[law][seed] - values[least][seed] for seed in shared])
        mean, within = more.mean(), stats.t.ppf(0.975, len(more) - 1) * stats.sem(more)
        yield (f"{law} has {number(mean, 3)} ± {number(within, 2)} more than {least} over {len(more)} seeds, "
               + ("which chance does not explain" if mean > within else "which may be chance"))


def metric_cell(value, tolerance):
    return number_cell(value, deserved_digits(value, tolerance, 5)) if not isinstance(value, (list, dict, str)) else cell(text(json.dumps(value)), classes="number")


def scenario_section(runs, labels):
    return "".join(
        f"<details><summary>Scenario of {text(label)}</summary><pre>{text(json.dumps(run.scenario, indent=2, ensure_ascii=False))}</pre>"
        f"{live_link(run.scenario)}"
        f"<p class=note>State hash {text(run.summary.get('state_hash', '–'))}{plugin_text(run)}.</p></details>"
        for run, label in zip(runs, labels) if run.scenario)


def commands_section(runs, words):
    lines = [f"hapbench run {quoted(run.folder / 'scenario.effective.json')}{plugin_option(run)} "
             f"--out {quoted(run.folder.name + '_again')}" for run in runs if run.scenario]
    given = " ".join(quoted(word) for word in words)
    return ((f"<p>Each run again, the same bytes:</p>{command(chr(10).join(lines))}" if lines else "")
            + f"<p>Pictures and this page:</p>{command(f'hapbench plot {given}{chr(10)}hapbench report {given}')}"
            + "<p class=note>The paths are those of the machine that wrote this page. Elsewhere, save a scenario from above as a file.</p>")


def plugin_option(run):
    """The option that loads a plugin's law; results know it by its file's name."""
    file = at(run.summary, "/provenance/plugin/file")
    return f" --module {quoted(file)}" if file else ""


def quoted(path):
    return shlex.quote(str(path))


def provenance(runs):
    return provenance_section(provenance_of(runs))
