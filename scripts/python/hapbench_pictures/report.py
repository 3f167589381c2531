"""`hapbench report`: one page of the runs given, and nothing else. Curves are drawn on light and on dark ground, one drawing for
each quantity; with a measured force, the rendered one beside it."""
import base64
import math
from pathlib import Path

import numpy as np

from hapbench.results import SCENARIO, SUMMARY
from hapbench_command import DIFFERENT, SUCCESS, write
from hapbench_report.json_input import InputError
from hapbench_report.live_link import place_live_page
from hapbench_report.markup import in_colour, table, text
from hapbench_report.page import whole_page
from hapbench_report.replay import player
from hapbench_style import SETTINGS, curve, picture, plt

from .differences import are_equal, differences, in_words, number
from .given import common_folder, given_runs, given_sweep, labels
from .panels import DARK, LIGHT, PATH_COLUMNS, SPANS, draw_over_time, draw_path, looks, on_dark, projections, settings
from .quantities import REFERENCE, SHORT, TRAJECTORY, USUAL, Samples, quantity, tables_of
from .replay import replays, surface_of
from .sections import (commands_section, diagnosis_section, metric_rows, metrics_section, provenance, scenario_section, seeds_section, summary_section, warnings_section)

STYLE = Path(__file__).parent / "page.css"
SIZE, PATH_SIZE = (4.0, 2.0), (4.0, 2.9)  # [inch]: on a phone as legible as the text around it


def report(options):
    """The exit status, which tells whether the two folders of --tolerance differ."""
    if options.tolerance is not None:
        return test_of_regression(options)
    if given_sweep(options.runs):
        raise InputError(f"{options.runs[0]}: is a sweep; allowed: folders of runs (\"hapbench plot\" draws a sweep; with "
                         "--keep-runs it keeps its runs, in the folder \"runs\")")
    runs = given_runs(options.runs)
    page = whole_page(differences_section(options.runs) + sections(runs, labels(runs), options.runs), further_style=STYLE.read_text(encoding="utf-8"),
                      title=", ".join(dict.fromkeys(run.name for run in runs)))
    file = options.out or common_folder(options.runs) / "report.html"
    if file.suffix not in (".html", ".htm"):
        raise InputError(f"--out {file}: got \"{file.suffix}\"; allowed: .html")
    write(file, page.encode(errors="replace"))  # a path need not be UTF-8
    place_live_page(file.parent)
    if not options.quiet:
        print(f"page of {len(runs)} run{'s' if len(runs) > 1 else ''} in {file}, {file.stat().st_size / 1e6:.1f} MB")
    return SUCCESS


def test_of_regression(options):
    if len(options.runs) != 2:
        raise InputError(f"--tolerance: got {len(options.runs)} folders; allowed: two, whose results are compared")
    tolerance = number(options.tolerance)
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
    if a == b or not all((folder / name).is_file() for folder in (a, b) for name in (SUMMARY, SCENARIO)):
        return []
    words = in_words(a, b, differences(a, b), 0.0)
    return [("differences", "Differences", "What differs", f"<pre>{text(words)}</pre>")]


def sections(runs, names, words):
    """The sections that have something to show."""
    drawn = [(run, name) for run, name in zip(runs, names) if TRAJECTORY in tables_of(run)]
    found = (
        ("summary", "Summary", "Summary", summary_section(runs, names)),
        ("warnings", "Warnings", "Warnings", warnings_section(runs, names)),
        ("diagnosis", "Diagnosis", "What is wrong, and what to try", diagnosis_section(runs, names)),
        ("replay", "Replay", "Replay", drawn and player(replays(*zip(*drawn)))),
        ("curves", "Curves", "Curves", drawn and curves_section(*zip(*drawn))),
        ("fidelity", "Fidelity", "Against the measured force", fidelity_section(runs, names)),
        ("late", "Late contacts", "Contacts that came late", late_section(runs, names)),
        ("metrics", "Metrics", "Metrics", metrics_section(runs, names)),
        ("seeds", "Seeds", "Between algorithms, over the seeds", seeds_section(runs)),
        ("scenario", "Scenario", "Scenario", scenario_section(runs, names)),
        ("rerun", "Rerun", "Run it again", commands_section(runs, words)),
        ("provenance", "Provenance", "Provenance", provenance(runs)),
    )
    return [entry for entry in found if entry[3]]


def curves_section(runs, labels):
    quantities = [SHORT[name] for name in USUAL if name in SHORT]
    quantities = [q for q in quantities if any(q.file in tables_of(run) for run in runs)]
    samples = [Samples(run, quantities, PATH_COLUMNS) for run in runs]
    light, surface = looks(runs, labels), surface_of(runs)
    figures = [drawing(SIZE, lambda ax, shown, q=q: draw_over_time(ax, q, samples, shown), light,
                       f"{q.axis} over time", spoken(q, samples, labels), xlabel="time [s]") for q in quantities]
    figures += [drawing(PATH_SIZE, lambda ax, shown, plane=plane: draw_path(ax, plane, samples, shown, surface), light,
                        f"Way of the tip, {plane[0]} and {plane[1]}", "Circles: start; dots: surface") for plane in projections(samples)]
    return f"<p>{key(light)} Triangles and dotted lines: first touch.{' Dots: section of the surface.' if surface is not None else ''}</p><div class=curves>{''.join(figures)}</div>"


def key(light):
    return " ".join(f"<b>{in_colour(one, text(one.label))}</b>" for one in light)


def spoken(quantity, samples, labels):
    """The picture in words: the range of every run."""
    parts = []
    for s, label in zip(samples, labels):
        found = s.of(quantity)
        if found is not None and np.isfinite(found[2]).any():
            parts.append(f"{label} {np.nanmin(found[1]):.3g} to {np.nanmax(found[2]):.3g} {quantity.unit}".strip())
    return "; ".join(parts)


def drawing(size, draw, light, title, words, **labels):
    images = []
    for paper, shown, name in ((LIGHT, light, "only-light"), (DARK, on_dark(light), "only-dark")):
        with plt.rc_context({**SETTINGS, **settings(paper)}):
            figure, ax = plt.subplots(figsize=size)
            draw(ax, shown)
            ax.set(**labels)
            data = base64.b64encode(picture(figure, "svg")).decode()
            plt.close(figure)
        images.append(f'<img class="{name}" src="data:image/svg+xml;base64,{data}" alt="{text(f"{title}: {words}")}">')
    return f"<figure><figcaption>{text(title)}</figcaption>{''.join(images)}</figure>"


def fidelity_section(runs, labels):
    """Empty without a run whose stroke has a measured force."""
    known = [(run, label) for run, label in zip(runs, labels) if run.sections.get("fidelity")]
    if not known:
        return ""
    runs, labels = zip(*known)
    about = ("<b>Rendered against measured force</b> The normal is that of what is rendered, before damping and friction; "
             "<code>hapbench describe</code> explains each")
    return table(*metric_rows(runs, labels, "fidelity", list(runs[0].sections["fidelity"])), about, "sortable") + force_curves(runs, labels)


def late_section(runs, labels):
    """Empty without a run whose contacts a slower loop finds."""
    known = [(run, label) for run, label in zip(runs, labels) if run.sections.get("contacts")]
    if not known:
        return ""
    runs, labels = zip(*known)
    about = "<b>How old the contacts are that rows use</b> and how many queries were lost; <code>hapbench describe</code> explains each"
    return table(*metric_rows(runs, labels, "contacts", list(runs[0].sections["contacts"])), about, "sortable")


def force_curves(runs, labels):
    """Curves of the runs that recorded both forces."""
    drawn = [(run, label) for run, label in zip(runs, labels) if {TRAJECTORY, REFERENCE} <= set(tables_of(run))]
    if not drawn:
        return "<p class=note>With --set record.force_reference=true the curves stand here.</p>"
    runs, labels = zip(*drawn)
    force, reference, error = (quantity(name, runs) for name in ("force", "reference", "force_error"))
    samples, light = [Samples(run, (force, reference, error)) for run in runs], looks(runs, labels)

    def both(ax, shown):
        # One recording is behind all runs of a scene: its curve is drawn once, in the colour of the text.
        time, _, measured = samples[0].of(reference)
        ax.plot(*curve(time, measured, measured, SPANS), color=ax.xaxis.label.get_color(), lw=0.8, ls=":")
        for s, one in zip(samples, shown):
            time, _, rendered = s.of(force)
            ax.plot(*curve(time, rendered, rendered, SPANS), color=one.colour, ls=one.line, lw=0.9)
        ax.set_ylabel("force [N]")

    def errors(ax, shown):
        for s, one in zip(samples, shown):
            time, _, off = s.of(error)
            ax.plot(*curve(time, off, off, SPANS), color=one.colour, ls=one.line, lw=0.9)
        ax.set_ylabel("||f - f_m|| [N]")

    figures = [drawing(SIZE, both, light, "Rendered and measured force [N] over time", spoken(reference, samples, labels),
                       xlabel="time [s]"),
               drawing(SIZE, errors, light, "Their difference [N] over time", spoken(error, samples, labels), xlabel="time [s]")]
    return f"<p>{key(light)} Dotted: the force measured with the stroke.</p><div class=curves>{''.join(figures)}</div>"
