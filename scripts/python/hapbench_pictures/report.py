"""`hapbench report`: one page of the runs given, and nothing else. Curves are drawn on light and on
dark ground, one drawing for each quantity."""
import base64
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy import stats

from hapbench.errors import InputError
from hapbench.results import SCENARIO, SUMMARY, at
from hapbench_command import DIFFERENT, SUCCESS, shell_line, write
from hapbench_looks import look
from hapbench_report.markup import (
    cell,
    columns,
    command,
    deserved_digits,
    heading_cell,
    in_colour,
    named,
    number,
    number_cell,
    table,
    text,
)
from hapbench_report.page import live_link, place_live_page, whole_page
from hapbench_report.replay import player, replays, surface_of
from hapbench_report.runs import plugin_text, provenance_of, provenance_section
from hapbench_style import SETTINGS, picture, plt

from .differences import are_equal, differences, in_words, number as number_of
from .given import SEED_FOLDER, common_folder, given_runs, given_sweep, labels
from .over_axes import Axis, look_of, over_axes, pareto
from .panels import (
    AXIS_COLUMNS,
    DARK,
    LIGHT,
    PATH_COLUMNS,
    RunLook,
    draw_over_time,
    draw_section,
    looks,
    settings,
)
from .plot import profile_of
from .quantities import SHORT, TRAJECTORY, USUAL, Samples, switch_of, tables_of

STYLE = Path(__file__).parent / "page.css"
FIRST = (
    "force_mean_in_contact_N",
    "force_max_N",
    "force_step_p99_N",
    "force_rms_above_30Hz_N",
    "inside_max_m",
)
SIZE, SCENE_SIZE = (4.0, 2.0), (4.0, 2.9)  # [inch]: on a phone as legible as the text around it


def report(options):
    """The exit status, which tells whether the two folders of --tolerance differ."""
    if options.tolerance is not None:
        return test_of_regression(options)
    if given_sweep(options.runs):
        raise InputError(
            f'{options.runs[0]}: is a sweep; allowed: folders of runs ("hapbench plot" draws a sweep; with '
            '--keep-runs it keeps its runs, in the folder "runs")'
        )
    runs = given_runs(options.runs)
    page = whole_page(
        differences_section(options.runs) + sections(runs, labels(runs), options.runs),
        further_style=STYLE.read_text(encoding="utf-8"),
        title=", ".join(dict.fromkeys(run.name for run in runs)),
    )
    file = options.out or common_folder(options.runs) / "report.html"
    if file.suffix not in (".html", ".htm"):
        raise InputError(f'--out {file}: got "{file.suffix}"; allowed: .html')
    write(file, page.encode(errors="replace"))  # a path need not be UTF-8
    place_live_page(file.parent)
    if not options.quiet:
        print(
            f"page of {len(runs)} run{'s' if len(runs) > 1 else ''} in {file}, {file.stat().st_size / 1e6:.1f} MB"
        )
    return SUCCESS


def test_of_regression(options):
    if len(options.runs) != 2:
        raise InputError(
            f"--tolerance: got {len(options.runs)} folders; allowed: two, whose results are compared"
        )
    tolerance = number_of(options.tolerance)
    if not 0.0 <= tolerance < math.inf:
        raise InputError(f"--tolerance: got {options.tolerance}; allowed: a number >= 0")
    a, b = map(Path, options.runs)
    found = differences(a, b)
    if not options.quiet:
        print(in_words(a, b, found, tolerance))
    return SUCCESS if are_equal(found, tolerance) else DIFFERENT


def differences_section(words):
    """Of two runs what differs; of other folders nothing."""
    a, b = map(Path, words) if len(words) == 2 else (Path(), Path())
    if a == b or not all(
        (folder / name).is_file() for folder in (a, b) for name in (SUMMARY, SCENARIO)
    ):
        return []
    words = in_words(a, b, differences(a, b), 0.0)
    return [("differences", "Differences", "What differs", f"<pre>{text(words)}</pre>")]


def sections(runs, names, words):
    """The sections that have something to show."""
    drawn = [(run, name) for run, name in zip(runs, names) if TRAJECTORY in tables_of(run)]
    found = (
        ("summary", "Summary", "Summary", summary_section(runs, names)),
        (
            "warnings",
            "Warnings",
            "Warnings",
            said_section(runs, names, lambda run: map(text, run.warnings)),
        ),
        (
            "diagnosis",
            "Diagnosis",
            "Problems found, and what to try",
            said_section(runs, names, diagnosed),
        ),
        ("replay", "Replay", "Replay", drawn and player(replays(*zip(*drawn)))),
        ("curves", "Curves", "Curves", drawn and curves_section(*zip(*drawn))),
        ("pareto", "Depth, vibration", "Depth and vibration", pareto_section(runs)),
        ("metrics", "Metrics", "Metrics", metrics_section(runs, names)),
        ("seeds", "Seeds", "Differences between algorithms, over the seeds", seeds_section(runs)),
        ("scenario", "Scenario", "Scenario", scenario_section(runs, names)),
        ("rerun", "Rerun", "Run it again", commands_section(runs, words)),
        ("provenance", "Provenance", "Provenance", provenance_section(provenance_of(runs))),
    )
    return [entry for entry in found if entry[3]]


def curves_section(runs, labels):
    quantities = [SHORT[name] for name in USUAL if name in SHORT]
    quantities = [q for q in quantities if any(q.file in tables_of(run) for run in runs)]
    samples = [Samples(run, quantities, (*PATH_COLUMNS, *AXIS_COLUMNS)) for run in runs]
    light, surface = looks(runs, labels), surface_of(runs)
    span = [
        end(end(s.trajectory["time_s"]) for s in samples) for end in (min, max)
    ]  # also of what begins with contact
    figures = [
        drawing(
            SCENE_SIZE,
            lambda ax, shown, paper: draw_section(
                ax, samples, shown, profile_of(runs[0]), surface, paper
            ),
            light,
            "The scene",
            "Circles: start positions; outlines: the tool of the first run; filled: the solid environment",
        )
    ]
    figures += [
        drawing(
            SIZE,
            lambda ax, shown, paper, q=q: draw_over_time(ax, q, samples, shown),
            light,
            f"{q.axis} over time",
            spoken(q, samples, labels),
            xlabel="time [s]",
            xlim=span,
        )
        for q in quantities
    ]
    lacking = [
        SHORT[name]
        for name, section in (("energy", "metrics"), ("reference", "fidelity"))
        if any(section in run.sections for run in runs)
    ]
    hints = "".join(
        f" <code>{switch_of(q.file)}</code> adds the {q.title}."
        for q in lacking
        if q not in quantities
    )
    names = " ".join(f"<b>{in_colour(one, text(one.label))}</b>" for one in light)
    return (
        f"<p>{names} Triangles and dotted lines: first touch. Outlines: the tool of the first run "
        f"at four times.{hints}</p>"
        f"<div class=curves>{''.join(figures)}</div>"
    )


def spoken(quantity, samples, labels):
    """The picture in words: the range of every run."""
    parts = []
    for s, label in zip(samples, labels):
        found = s.of(quantity)
        if found is not None and np.isfinite(found[2]).any():
            parts.append(
                f"{label} {np.nanmin(found[1]):.3g} to {np.nanmax(found[2]):.3g} {quantity.unit}".strip()
            )
    return "; ".join(parts)


def drawing(size, draw, light, title, words, **labels):
    images = []
    for paper, shown, name in (
        (LIGHT, light, "only-light"),
        (DARK, [replace(one, colour=one.dark) for one in light], "only-dark"),
    ):
        with plt.rc_context({**SETTINGS, **settings(paper)}):
            figure, ax = plt.subplots(figsize=size)
            draw(ax, shown, paper)
            ax.set(**labels)
            data = base64.b64encode(picture(figure, "svg")).decode()
            plt.close(figure)
        images.append(
            f'<img class="{name}" src="data:image/svg+xml;base64,{data}" alt="{text(f"{title}: {words}")}">'
        )
    return f"<figure><figcaption>{text(title)}</figcaption>{''.join(images)}</figure>"


MOST_LAWS = 2  # that a table tells apart at a glance
DEEPER, SHAKIER = "inside_max_m", "force_rms_above_30Hz_N"


def pareto_section(runs):
    """Of a comparison with many laws: how deep each lets the tool against how much it vibrates,
    over all scenes and seeds."""
    found = {}
    for run in runs:
        values = (run.metric(DEEPER), run.metric(SHAKIER))
        if None not in values:
            found.setdefault(run.algorithm, []).append(values)
    if len(found) <= MOST_LAWS:
        return ""
    means = {name: np.mean(values, axis=0) * (1e3, 1.0) for name, values in found.items()}
    front = pareto(np.array(list(means.values())))

    def draw(ax, shown, paper):
        ax.plot(*front.T, color=ax.xaxis.label.get_color(), lw=0.8, ls=":", zorder=1)
        series = [
            (
                one.label.replace("_", " "),
                mean[:1],
                mean[1:],
                look_of(one.label, color=one.colour, ls="none"),
            )
            for one, mean in zip(shown, means.values())
        ]
        every = np.array(list(means.values()))
        over_axes(
            ax,
            Axis.of("largest depth inside [mm]", every[:, 0]),
            Axis.of("force above 30 Hz [N rms]", every[:, 1]),
            series,
        )
        ax.legend(loc="upper left", bbox_to_anchor=(1, 1.05), fontsize=6, handletextpad=0.1)
        ax.margins(0.08)

    light = [RunLook(name, look(name).colour, look(name).dark, ()) for name in means]
    words = "; ".join(f"{name} {mean[0]:.3g} mm, {mean[1]:.3g} N" for name, mean in means.items())
    return (
        "<p>Mean over all runs of an algorithm. Dotted line: algorithms that no "
        "other algorithm beats in both depth and vibration.</p><div class=curves>"
        + drawing(SCENE_SIZE, draw, light, "Depth and vibration", words)
        + "</div>"
    )


# ---- sections of text and tables


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
            *own,
        ]
        for run, label, own in zip(runs, labels, cells)
    ]
    return table(
        [heading_cell("Run"), heading_cell("Outcome"), heading_cell("In contact", True), *headings],
        rows,
        classes="sortable",
    )


def outcome_cell(run):
    """What a copy of a bundled scenario inherits may surprise its owner."""
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


def said_section(runs, labels, of_run):
    """What is said of each run, by its label: warnings; what is wrong by the rules of the program, and what to try."""
    said = "".join(
        f"<li><b>{text(label)}:</b> {words}</li>"
        for run, label in zip(runs, labels)
        for words in of_run(run)
    )
    return said and f"<ul>{said}</ul>"


def diagnosed(run):
    return [
        f"{text(found['says'])} <i>Try: {text(found['try'])}</i>"
        for found in run.summary.get("diagnosis", ())
    ]


def metrics_section(runs, labels):
    """All that the summaries measured, section by section."""
    names = dict.fromkeys(
        (section, name)
        for run in runs
        for section, values in run.sections.items()
        for name in values
    )
    rows = [
        [
            cell(text(section)),
            cell(f"<code>{text(name)}</code>"),
            *(
                metric_cell(run.sections.get(section, {}).get(name), run.tolerance(section, name))
                for run in runs
            ),
        ]
        for section, name in names
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


def seeds_section(runs):
    """What lies between laws over the seeds of a comparison: of each metric the law with the least
    mean against every other."""
    scenes = {}
    for run in runs:
        if SEED_FOLDER.fullmatch(run.folder.name):
            scenes.setdefault(run.name, {}).setdefault(run.algorithm, {})[run.folder.name] = run
    said = [
        f"<li>{text(scene)}, <code>{name}</code>: {text(sentence)}</li>"
        for scene, laws in scenes.items()
        for name in FIRST
        for sentence in between(laws, name)
    ]
    return (
        said
        and f"<ul>{''.join(said)}</ul><p class=note>Paired differences: with one seed all "
        "algorithms have the same start. ±: 95 % confidence interval of the mean difference.</p>"
    )


def between(laws, metric):
    """A sentence for each law beside the one with the least mean, over the seeds in which both have the metric."""
    values = {
        law: {
            seed: run.metric(metric) for seed, run in of.items() if run.metric(metric) is not None
        }
        for law, of in laws.items()
    }
    values = {law: of for law, of in values.items() if len(of) > 1}
    least = min(values, key=lambda law: np.mean(list(values[law].values())), default=None)
    for law in values:
        shared = [seed for seed in values[law] if seed in values[least]]
        if law == least or len(shared) < 2:
            continue
        more = np.array([values[law][seed] - values[least][seed] for seed in shared])
        mean, within = more.mean(), stats.t.ppf(0.975, len(more) - 1) * stats.sem(more)
        yield (
            f"{law} is {number(mean, 3)} ± {number(within, 2)} above {least} over {len(more)} seeds: "
            + ("significant" if mean > within else "not significant (may be chance)")
        )


def metric_cell(value, tolerance):
    return (
        number_cell(value, deserved_digits(value, tolerance, 5))
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
        f"hapbench run {shell_line(run.folder / 'scenario.effective.json')}{plugin_option(run)} "
        f"--out {shell_line(run.folder.name + '_again')}"
        for run in runs
        if run.scenario
    ]
    given = shell_line(*words)
    return (
        (
            f"<p>These commands repeat each run, with identical results:</p>{command(chr(10).join(lines))}"
            if lines
            else ""
        )
        + "<p>These commands write the pictures and this page again:</p>"
        + f"{command(f'hapbench plot {given}{chr(10)}hapbench report {given}')}"
        + "<p class=note>The paths belong to the machine that wrote this page. On another machine, save "
        "a scenario from above as a file.</p>"
    )


def plugin_option(run):
    """Options that load the run's modules: a law, known by its file's name, and a source of contacts."""
    files = [at(run.summary, "/provenance/plugin/file")]
    source = at(run.scenario, "/rendering/contact_source")
    if isinstance(source, dict) and source.get("type") == "plugin":
        files.append(run.folder / source["file"])
    return "".join(f" --module {shell_line(file)}" for file in files if file)
