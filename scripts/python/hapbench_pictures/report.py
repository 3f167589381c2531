"""`hapbench report`: writes one page about the given runs. Each quantity is drawn for a light and for a dark
background."""
import math
from pathlib import Path

import numpy as np

from hapbench.errors import InputError
from hapbench.results import SCENARIO, SUMMARY
from hapbench_command import DIFFERENT, SUCCESS, write_all
from hapbench_report.markup import in_colour, text
from hapbench_report.page import live_page_in, whole_page
from hapbench_report.replay import player, replays, surface_of
from hapbench_report.runs import provenance_of, provenance_section

from .differences import are_equal, differences, in_words, number as number_of
from .drawing import SCENE_SIZE, SIZE, drawing, pareto_section
from .given import common_folder, given_runs, given_sweep, labels
from .many_runs import are_many, many_sections
from .panels import (
    AXIS_COLUMNS,
    PATH_COLUMNS,
    PATH_MARKS,
    draw_over_time,
    draw_section,
    looks,
    surface_text,
)
from .quantities import SHORT, TRAJECTORY, USUAL, Samples, switch_of, tables_of
from .ranking_values import scenes_of
from .run_plot import profile_of
from .sections import (
    commands_section,
    diagnosed,
    metrics_section,
    scenario_section,
    summary_section,
    texts_section,
)

STYLE = Path(__file__).parent / "page.css"


def report(options):
    """Writes the page and returns the exit status. With --tolerance, writes no page but compares two folders; the exit
    status then states whether the folders differ."""
    if options.tolerance is not None:
        return test_of_regression(options)
    if given_sweep(options.runs):
        raise InputError(
            f'{options.runs[0]}: is a sweep; allowed: folders of runs ("hapbench plot" draws a sweep; with '
            '--keep-runs it keeps its runs, in the folder "runs")'
        )
    runs = given_runs(options.runs, with_contacts=True)
    scenes = scenes_of(runs, map(Path, options.runs))
    page = whole_page(
        many_sections(scenes, runs, options.runs)
        if are_many(scenes)
        else differences_section(options.runs) + sections(runs, labels(runs), options.runs),
        further_style=STYLE.read_text(encoding="utf-8"),
        title=", ".join(dict.fromkeys(run.name for run in runs)),
    )
    file = options.out or common_folder(options.runs) / "report.html"
    if file.suffix not in (".html", ".htm"):
        raise InputError(f'--out {file}: got "{file.suffix}"; allowed: .html')
    # A path may contain bytes that are not UTF-8.
    write_all({file: page.encode(errors="replace"), **live_page_in(file.parent)})
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
    """Returns a list with the section that states the differences of two runs. `words`: the given folders. The list is
    empty if `words` are not the folders of two different single runs."""
    a, b = map(Path, words) if len(words) == 2 else (Path(), Path())
    if a == b or not all(
        (folder / name).is_file() for folder in (a, b) for name in (SUMMARY, SCENARIO)
    ):
        return []
    words = in_words(a, b, differences(a, b), 0.0)
    return [("differences", "Differences", "What differs", f"<pre>{text(words)}</pre>")]


def sections(runs, names, words):
    """Returns the sections of the page that are not empty."""
    drawn = [(run, name) for run, name in zip(runs, names) if TRAJECTORY in tables_of(run)]
    found = (
        ("summary", "Summary", "Summary", summary_section(runs, names)),
        (
            "warnings",
            "Warnings",
            "Warnings",
            texts_section(runs, names, lambda run: map(text, [*run.gaps, *run.warnings])),
        ),
        (
            "diagnosis",
            "Diagnosis",
            "Problems found, and what to try",
            texts_section(runs, names, diagnosed),
        ),
        ("replay", "Replay", "Replay", drawn and player(replays(*zip(*drawn)))),
        ("curves", "Curves", "Curves", drawn and curves_section(*zip(*drawn))),
        ("pareto", "Depth, vibration", "Depth and vibration", pareto_section(runs)),
        ("metrics", "Metrics", "Metrics", metrics_section(runs, names)),
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
    ]  # includes the quantities that begin with the first contact
    figures = [
        drawing(
            SCENE_SIZE,
            lambda ax, shown, paper: draw_section(
                ax, samples, shown, profile_of(runs[0]), surface, paper
            ),
            light,
            "The scene",
            "; ".join([PATH_MARKS, "outlines: the tool of the first run", *surface_text(surface)]),
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
        f"<p>{names} Circle: start; square: end; triangles and dotted lines: first touch. Outlines: the tool of the "
        f"first run at four times.{hints}</p>"
        f"<div class=curves>{''.join(figures)}</div>"
    )


def spoken(quantity, samples, labels):
    """Returns a description of a picture for screen readers: name and range of values of each run that has a finite
    value."""
    parts = []
    for s, label in zip(samples, labels):
        found = s.of(quantity)
        if found is not None and np.isfinite(found[2]).any():
            parts.append(
                f"{label} {np.nanmin(found[1]):.3g} to {np.nanmax(found[2]):.3g} {quantity.unit}".strip()
            )
    return "; ".join(parts)
