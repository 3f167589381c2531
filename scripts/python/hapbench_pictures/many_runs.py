"""Page of `hapbench report` for many runs. It begins with a table of metrics for each law, with mean and spread. Then
follow the differences between laws, curves of the mean with a band, and every run in a folded section."""
import re

import numpy as np
from scipy import stats

from hapbench_command import shell_line
from hapbench_looks import look
from hapbench_report.markup import (
    cell,
    column,
    command,
    deserved_digits,
    folded,
    heading_cell,
    in_colour,
    known_number,
    named,
    number,
    table,
    text,
)
from hapbench_report.replay import player, replays, surface_of
from hapbench_report.runs import provenance_of, provenance_section
from hapbench_style import Sheet

from .bands import draw_bands
from .drawing import SCENE_SIZE, SIZE, drawing, on_both_grounds, pareto_section
from .panels import AXIS_COLUMNS, PATH_COLUMNS, PATH_MARKS, RunLook, draw_section, surface_text
from .quantities import SHORT, TRAJECTORY, USUAL, Samples, tables_of
from .ranking_plot import failures_text, ranking_figure
from .ranking_values import RESOLUTION, has_repetitions, value_of
from .run_plot import profile_of
from .sections import (
    FIRST,
    diagnosed,
    first_table,
    metric_names,
    module_options,
    note_on_modules,
    scenario_section,
)

MANY_LAWS = 8  # number of laws, over all scenes, above which several scenes count as many runs
ON_PAGE = Sheet(10.0, 3)  # size of the pictures on the page [inch]
NUMBER = re.compile(r"(?<![\w.])[-+]?\d[\d.,]*(?:e[-+]?\d+)?")


def are_many(scenes):
    """Returns True if runs are repeated over seeds, or if more than MANY_LAWS laws ran in several scenes."""
    laws = sum(len(scene.laws) for scene in scenes)
    return has_repetitions(scenes) or len(scenes) > 1 and laws > MANY_LAWS


def many_sections(scenes, runs, words):
    """Returns the sections of the page that are not empty."""
    first = [next(iter(law.runs.values())) for scene in scenes for law in scene.laws]
    drawn = [run for run in first if TRAJECTORY in tables_of(run)]
    names = [name_of(run, scenes) for run in drawn]
    found = (
        ("summary", "Summary", "Summary", summary(scenes, runs)),
        ("seeds", "Differences", "Differences between laws, over the seeds", seeds_section(scenes)),
        (
            "warnings",
            "Warnings",
            "Warnings",
            grouped(scenes, lambda run: map(text, [*run.gaps, *run.warnings])),
        ),
        ("diagnosis", "Diagnosis", "Problems found, and what to try", grouped(scenes, diagnosed)),
        (
            "replay",
            "Replay",
            "Replay of the first run of each law",
            drawn and player(replays(drawn, names)),
        ),
        ("curves", "Curves", "Curves", "".join(curves(scene, len(scenes) > 1) for scene in scenes)),
        ("pareto", "Depth, vibration", "Depth and vibration", pareto_section(runs)),
        ("metrics", "Metrics", "All metrics and runs", metrics(scenes, runs)),
        ("scenario", "Scenario", "Scenario", scenarios(scenes)),
        ("rerun", "Rerun", "Run it again", again(runs, words)),
        ("provenance", "Provenance", "Provenance", provenance_section(provenance_of(runs))),
    )
    return [entry for entry in found if entry[3]]


def name_of(run, scenes):
    law = next(law.label for scene in scenes for law in scene.laws if run in law.runs.values())
    return f"{run.name}, {law}" if len(scenes) > 1 else law


def scene_title(scene):
    return f"<h3>{named(scene.name)}</h3>"


# ---- Laws by metrics


def summary(scenes, runs):
    descriptions = dict.fromkeys(str(run.scenario.get("description") or "") for run in runs)
    about = "".join(f"<p class=lead>{text(words)}</p>" for words in list(descriptions)[:3] if words)
    shown = shown_metrics(scenes, runs)
    tables = "".join(
        (scene_title(scene) if len(scenes) > 1 else "") + law_table(scene, shown)
        for scene in scenes
    )
    ranked = [name for name in shown if any(name in scene.better for scene in scenes)] or shown
    return (
        f"<h1>{named(', '.join(scene.name for scene in scenes))}</h1>{about}"
        f"<p>{extent(scenes, runs)}</p>{tables}{NOTE}{ranking(scenes, ranked[:3])}"
    )


NOTE = (
    "<p class=note>Each entry is mean ± standard deviation over seeds; a deviation below the error of the metric is "
    "left out. A seed counts if no law failed with it, except "
    "laws that fail with every seed. Seeds agree if the deviation is at most 0.1 % of the mean. The rank is in bold: "
    "1 + the number of laws that are better by more than 0.1 % and by more than both errors. There is no rank if the "
    "metric has no better direction or if the numbers do not differ by more than their errors. "
    "Laws with failed runs rank behind the other laws, in the order of their number of failed runs. Digits follow the "
    "error of the number; ≤ stands for a number that is not larger than its error, which has a rank only if runs "
    "failed.</p>"
)


def shown_metrics(scenes, runs):
    """Returns the metrics of the ranking and the default metrics, without metrics that no run has."""
    known = dict.fromkeys(name for scene in scenes for name in [*scene.better, *FIRST])
    return [name for name in known if any(value_of(run, name) is not None for run in runs)]


def extent(scenes, runs):
    """Returns a text with the numbers of runs, laws, scenes and seeds."""
    laws = {law.label for scene in scenes for law in scene.laws}
    seeds = max(len(law.runs) for scene in scenes for law in scene.laws)
    failures = sum(len(law.failures) for scene in scenes for law in scene.laws)
    counts = ((len(runs), "run"), (len(scenes), "scene"), (len(laws), "law"), (seeds, "seed"))
    counted = ", ".join(f"{count} {what}{'s' if count != 1 else ''}" for count, what in counts)
    return f"{counted}. " + (
        f"<b class=bad>{failures} of the runs failed.</b>" if failures else "No run failed."
    )


def law_table(scene, shown):
    """Returns a table of the metrics of a scene, with a row for each law. The law that is best in the first metric is
    in the first row."""
    entries = {name: scene.entries(name) for name in shown}
    ranks = {name: scene.ranks(name) for name in shown}
    heads = {
        name: column(name, [of.mean for of in found.values() if of.mean is not None])
        for name, found in entries.items()
    }
    rows = [
        [
            cell(in_colour(look(law.algorithm), text(law.label)), law.label, "name"),
            failures_cell(law),
            *(
                mean_cell(entries[name][law.label], ranks[name][law.label], heads[name][2])
                for name in shown
            ),
        ]
        for law in scene.sorted_laws(shown[0])
    ]
    headings = [heading_cell("Law"), heading_cell("Failed")]
    headings += [heading_cell(text(title), True, unit) for title, unit, _ in heads.values()]
    return table(headings, rows, classes="sortable")


def failures_cell(law):
    if not law.failures:
        return cell(f"0 of {len(law.runs)}", 0)
    count = "" if len(law.runs) > 1 else "1 of 1 "
    return cell(f"<b class=bad>{count}{text(failures_text(law))}</b>", len(law.failures))


def mean_cell(of, rank, factor=1.0):
    """Returns a table cell with the mean, the spread and the rank of a law. The numbers have as many digits as are
    significant. `of`: the Entry of the law."""
    if of.mean is None:
        return cell("–", classes="number")
    error = of.shown_error
    shown = known_number(factor * of.mean, error and factor * error)
    if of.seeds_agree and not of.is_unknown:
        shown += " <span class=note>seeds agree</span>"
    elif of.spread is not None and not of.is_unknown and of.spread >= of.error:
        digits = deserved_digits(of.spread, of.tolerance, 2)
        shown += f" ± {number(factor * of.spread, digits)}"
    shown = shown if rank is None else f"{shown} <b>{rank}</b>"
    return cell(shown, factor * of.mean, "number")


def ranking(scenes, shown):
    words = "; ".join(
        f"{scene.name}, {name}: {', '.join(law.label for law in scene.sorted_laws(name))}"
        for scene in scenes
        for name in shown
    )
    figure = on_both_grounds(
        lambda paper, _: ranking_figure(scenes, shown, ON_PAGE),
        (),
        (),
        "Ranking, best on top",
        words,
    )
    return f"<div class=ranking>{figure}</div>"


# ---- Differences and warnings


def seeds_section(scenes):
    """Returns a section that compares, for each metric, the law with the smallest mean with every other law."""
    parts = []
    for scene in scenes:
        items = [
            f"<li><code>{name}</code>: {text(sentence)}</li>"
            for name in FIRST
            for sentence in between(scene, name)
        ]
        if items:
            title = f"{named(scene.name)}: {len(items)} pairs of laws and metrics"
            parts.append(folded(title, f"<ul>{''.join(items)}</ul>"))
    return "".join(parts) and (
        "<p>Paired differences: with one seed all algorithms have the same start. ±: 95 % confidence "
        f"interval of the mean difference.</p>{''.join(parts)}"
    )


def between(scene, metric):
    """Yields a sentence for each law except the law with the smallest mean: the difference between the two laws, over
    the seeds for which both laws have the metric."""
    laws = {law.label: law.values(metric) for law in scene.laws if len(law.values(metric)) > 1}
    best = min(laws, key=lambda label: np.mean(list(laws[label].values())), default=None)
    errors = {label: of.error for label, of in scene.entries(metric).items()}
    for label, values in laws.items():
        shared = [seed for seed in values if seed in laws[best]]
        if label == best or len(shared) < 2:
            continue
        more = np.array([values[seed] - laws[best][seed] for seed in shared])
        mean, within = more.mean(), stats.t.ppf(0.975, len(more) - 1) * stats.sem(more)
        error, size = errors[label] + errors[best], max(map(abs, laws[best].values()))
        if abs(mean) <= max(error, RESOLUTION * size):
            why = f"the errors of both numbers, {number(error, 2)}" if error else "0.1 %"
            yield f"{label} and {best} cannot be told apart: they differ by less than {why}"
            continue
        if within <= RESOLUTION * mean:
            yield f"{label} is {number(mean, 3)} above {best} over {len(more)} seeds, which agree: significant"
            continue
        yield (
            f"{label} is {number(mean, 3)} ± {number(within, 2)} above {best} over {len(more)} seeds: "
            + ("significant" if mean > within else "not significant (may be chance)")
        )


def grouped(scenes, of_run):
    """Returns a list of the texts that `of_run` returns for the runs, as HTML. Texts that differ only in their numbers
    share one entry."""
    groups = {}
    for scene in scenes:
        for law in scene.laws:
            for run in law.runs.values():
                for words in dict.fromkeys(of_run(run)):
                    alike = groups.setdefault(NUMBER.sub("#", words), {})
                    alike.setdefault((scene.name, law.label), []).append(words)
    items = "".join(
        f"<li>{group_text(alike, len(scenes) > 1)}</li>"
        for alike in sorted(groups.values(), key=lambda of: -sum(map(len, of.values())))
    )
    return items and f"<ul>{items}</ul>"


def group_text(alike, names_scene):
    every = [words for of in alike.values() for words in of]
    whose = ", ".join(
        f"{f'{scene}: ' if names_scene else ''}{label}{f' {len(of)}' if len(of) > 1 else ''}"
        for (scene, label), of in alike.items()
    )
    count = f"{len(every)} run{'s' if len(every) > 1 else ''}"
    differ = " <span class=note>(numbers of the first run)</span>" if len(set(every)) > 1 else ""
    return f"<b>{count}</b> ({text(whose)}): {every[0]}{differ}"


# ---- Curves, metrics, scenarios and commands


def curves(scene, is_titled):
    """Returns drawings of each quantity over time, as HTML. The curve of a law is the mean over those of its runs that
    did not fail. The band of the curve reaches from the smallest to the largest value."""
    quantities = [SHORT[name] for name in USUAL if name in SHORT]
    laws, light, samples = [], [], []
    for law in scene.laws:
        runs = [run for seed, run in law.runs.items() if seed not in law.failures]
        runs = [run for run in runs if TRAJECTORY in tables_of(run)]
        if runs:
            law_look = look(law.algorithm)
            laws.append(law)
            light.append(RunLook(law.label, law_look.colour, law_look.dark, law_look.dash))
            samples.append(
                [Samples(run, quantities, (*PATH_COLUMNS, *AXIS_COLUMNS)) for run in runs]
            )
    if not laws:
        return ""
    first, surface = [of[0] for of in samples], surface_of([first_run(laws[0])])
    profile = profile_of(first_run(laws[0]))
    figures = [
        drawing(
            SCENE_SIZE,
            lambda ax, shown, paper: draw_section(ax, first, shown, profile, surface, paper),
            light,
            "The scene, first run of each law",
            "; ".join([PATH_MARKS, *surface_text(surface)]),
        )
    ]
    figures += [
        drawing(
            SIZE,
            lambda ax, shown, paper, q=q: draw_bands(ax, q, samples, shown),
            light,
            f"{q.axis} over time",
            f"mean and range over the seeds of {', '.join(one.label for one in light)}",
            xlabel="time [s]",
        )
        for q in quantities
        if any(of.of(q) is not None for of in first)
    ]
    names = " ".join(f"<b>{in_colour(one, text(one.label))}</b>" for one in light)
    title = scene_title(scene) if is_titled else ""
    return (
        f"{title}<p>{names} Lines: mean over the seeds. Bands: smallest to largest value. Failed runs are left "
        f"out. {PATH_MARKS.capitalize()}.</p><div class=curves>{''.join(figures)}</div>"
    )


def first_run(law):
    return next(iter(law.runs.values()))


def metrics(scenes, runs):
    """Returns the metrics of all laws and of all runs, in folded sections."""
    parts = [
        folded(
            f"All metrics of {named(scene.name)}, mean ± standard deviation", metrics_table(scene)
        )
        for scene in scenes
    ]
    labels = [
        f"{name_of(run, scenes)}, seed {seed}"
        for scene in scenes
        for law in scene.laws
        for seed, run in law.runs.items()
    ]
    ordered = [run for scene in scenes for law in scene.laws for run in law.runs.values()]
    parts.append(folded(f"All {len(runs)} runs", first_table(ordered, labels)))
    return "".join(parts)


def metrics_table(scene):
    runs = [run for law in scene.laws for run in law.runs.values()]
    rows = []
    for section, name in metric_names(runs):
        key = name if section == "metrics" else f"{section}.{name}"
        found = scene.entries(key)
        if any(of.mean is not None for of in found.values()):
            cells = (mean_cell(of, None) for of in found.values())
            rows.append([cell(text(section)), cell(f"<code>{text(name)}</code>"), *cells])
    headings = [heading_cell("Section"), heading_cell("Metric")]
    return table([*headings, *(heading_cell(text(law.label), True) for law in scene.laws)], rows)


def scenarios(scenes):
    """Returns the scenario of the first run of each scene. The other runs differ only in law, seed and start."""
    runs = [first_run(scene.laws[0]) for scene in scenes]
    return (
        "<p>The runs of a scene differ in law, seed and start only; one scenario stands for all.</p>"
        + scenario_section(runs, [f"{run.name}, {run.algorithm}" for run in runs])
    )


def again(runs, words):
    given = shell_line(*words)
    repeat = (
        f"find {given} -name scenario.effective.json | while read -r s; do hapbench run "
        f'"$s"{module_options(runs)} --quiet --out "again/${{s%/*}}"; done'
    )
    return (
        f"<p>This command repeats all {len(runs)} runs, with identical results:</p>"
        f"{command(repeat)}{note_on_modules(runs)}"
        "<p>These commands write the picture and this page again:</p>"
        f"{command(f'hapbench plot {given}{chr(10)}hapbench report {given}')}"
        "<p class=note>The paths belong to the machine that wrote this page.</p>"
    )
