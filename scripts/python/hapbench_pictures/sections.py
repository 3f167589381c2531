"""Builds those sections of the page about runs that consist of texts and tables."""
import json
from pathlib import Path

from hapbench.results import at
from hapbench_command import file_word, shell_line
from hapbench_report.markup import (
    cell,
    columns,
    command,
    heading_cell,
    named,
    number,
    number_cell,
    table,
    text,
)
from hapbench_report.page import live_link
from hapbench_report.runs import plugin_text

FIRST = (
    "force_mean_in_contact_N",
    "force_max_N",
    "force_step_p99_N",
    "force_rms_above_30Hz_N",
    "inside_max_m",
)


def summary_section(runs, labels):
    names = list(dict.fromkeys(run.name for run in runs))
    descriptions = list(dict.fromkeys(str(run.scenario.get("description") or "") for run in runs))
    about = "".join(f"<p class=lead>{text(words)}</p>" for words in descriptions[:3] if words)
    return f"<h1>{named(', '.join(names))}</h1>{about}{first_table(runs, labels)}"


def first_table(runs, labels):
    shown = [name for name in FIRST if any(run.metric(name) is not None for run in runs)]
    headings, cells = columns(
        shown,
        [[run.metric(name) for name in shown] for run in runs],
        [[run.tolerance("metrics", name) for name in shown] for run in runs],
    )
    rows = [
        [
            cell(named(label), classes="name"),
            outcome_cell(run),
            cell(contact_text(run), run.metric("contact_share") or 0, "number"),
            *values,
        ]
        for run, label, values in zip(runs, labels, cells)
    ]
    return table(
        [heading_cell("Run"), heading_cell("Outcome"), heading_cell("In contact", True), *headings],
        rows,
        classes="sortable",
    )


def outcome_cell(run):
    """Returns a table cell with the outcome of a run. For an unexpected outcome, the cell also names the expected
    outcome, because a copy of a bundled scenario inherits the expectation."""
    how = text(run.outcome.replace("_", " ") or "–")
    if run.expected:
        return cell(how)
    wanted = at(run.scenario, "/expect/outcome") or "other metric values"
    wanted = " or ".join(map(str, wanted)) if isinstance(wanted, list) else wanted
    return cell(
        f"<b class=bad>{how}</b><br><span class=note>its field <code>expect</code> requires "
        f"{text(wanted)}; a copied scenario keeps this field, and <code>--set expect={{}}</code> "
        "removes it</span>"
    )


def contact_text(run):
    share = run.metric("contact_share")
    return (
        f"{'–' if share is None else f'{number(100 * share, 3)} %'} of "
        f"{number(at(run.summary, '/duration_s'), 4)} s"
    )


def texts_section(runs, labels, of_run):
    """Returns an HTML list of the texts that `of_run` returns for each run, such as the warnings of the run. Each text
    follows the label of its run."""
    items = "".join(
        f"<li><b>{text(label)}:</b> {words}</li>"
        for run, label in zip(runs, labels)
        for words in of_run(run)
    )
    return items and f"<ul>{items}</ul>"


def diagnosed(run):
    return [
        f"{text(found['says'])} <i>Try: {text(found['try'])}</i>"
        for found in run.summary.get("diagnosis", ())
    ]


def metric_names(runs):
    """Returns (section, name) of each metric that some run has, each once."""
    return dict.fromkeys(
        (section, name)
        for run in runs
        for section, values in run.sections.items()
        for name in values
    )


def metrics_section(runs, labels):
    """Returns a table of all metrics in the summaries of the runs, section by section."""
    rows = [
        [
            cell(text(section)),
            cell(f"<code>{text(name)}</code>"),
            *(
                metric_cell(run.sections.get(section, {}).get(name), run.tolerance(section, name))
                for run in runs
            ),
        ]
        for section, name in metric_names(runs)
    ]
    headings = [
        heading_cell("Section"),
        heading_cell("Metric"),
        *(heading_cell(text(label), True) for label in labels),
    ]
    return table(
        headings,
        rows,
        "<b>All metrics</b> <code>hapbench describe</code> and a metric's name explain it",
    )


def metric_cell(value, tolerance):
    return (
        number_cell(value, 5, tolerance)
        if not isinstance(value, (list, dict, str))
        else cell(text(json.dumps(value)), classes="number")
    )


def scenario_section(runs, labels):
    return "".join(
        "<details><summary>Scenario of "
        f"{text(label)}</summary><pre>{text(json.dumps(run.scenario, indent=2, ensure_ascii=False))}</pre>"
        f"{live_link(run.scenario)}"
        f"<p class=note>State hash {text(run.summary.get('state_hash', '–'))}{plugin_text(run)}.</p></details>"
        for run, label in zip(runs, labels)
        if run.scenario
    )


def commands_section(runs, words):
    lines = [
        f"hapbench run {shell_line(file_word(run.folder / 'scenario.effective.json'))}{module_options([run])} "
        f"--out {shell_line(file_word(run.folder.name + '_again'))}"
        for run in runs
        if run.scenario
    ]
    given = shell_line(*words)
    return (
        (
            f"<p>These commands repeat each run, with identical results:</p>{command(chr(10).join(lines))}"
            f"{note_on_modules(runs)}"
            if lines
            else ""
        )
        + "<p>These commands write the pictures and this page again:</p>"
        + f"{command(f'hapbench plot {given}{chr(10)}hapbench report {given}')}"
        + "<p class=note>The paths belong to the machine that wrote this page. On another machine, save "
        "a scenario from above as a file.</p>"
    )


def note_on_modules(runs):
    """Returns a note that asks the reader to replace the names of modules in the commands by their paths, because a
    summary records the name but not the path of a module with a force law. Returns an empty text if no name must be
    replaced."""
    files = (Path(file) for run in runs for file in module_files(run))
    names = sorted({file.name for file in files if len(file.parts) == 1})
    if not names:
        return ""
    return f"<p class=note>In the commands, replace {text(', '.join(names))} by the path on this machine.</p>"


def module_options(runs):
    """Returns the options --module that load the modules of the runs, each module once. A module contains a force law
    or a source of contacts."""
    files = dict.fromkeys(file_word(file) for run in runs for file in module_files(run))
    return "".join(f" --module {shell_line(file)}" for file in files)


def module_files(run):
    """Returns the files of the modules of a run: of its force law, and of its source of contacts."""
    files = [at(run.summary, "/provenance/plugin/file")]
    source = at(run.scenario, "/rendering/contact_source")
    if isinstance(source, dict) and source.get("type") == "plugin":
        files.append(run.folder / source["file"])
    return [file for file in files if file]
