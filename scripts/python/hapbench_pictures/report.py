"""`hapbench report`: one page of the runs given, and nothing else."""
from pathlib import Path

from hapbench_command import Arguments, write
from hapbench_report.json_input import InputError
from hapbench_report.page import whole_page
from hapbench_report.replay import player

from .curves import curves_section, fidelity_section
from .given import common_folder, given_runs, given_sweep, labels
from .quantities import TRAJECTORY, tables_of
from .replay import replays
from .sections import (commands_section, metrics_section, provenance, scenario_section, summary_section,
                       warnings_section)

STYLE = Path(__file__).parent / "page.css"


def arguments(words):
    parser = Arguments(prog="hapbench report", description="Writes a page of runs.")
    parser.add_argument("runs", nargs="+", metavar="RUN")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--quiet", action="store_true")
    return parser.parse_args(words)


def report(words):
    options = arguments(words)
    if given_sweep(options.runs):
        raise InputError(f"{options.runs[0]}: is a sweep; allowed: folders of runs (\"hapbench plot\" draws a sweep; with "
                         "--keep-runs it keeps its runs, in the folder \"runs\")")
    runs = given_runs(options.runs)
    page = whole_page(sections(runs, labels(runs), options.runs), further_style=STYLE.read_text(encoding="utf-8"),
                      title=", ".join(dict.fromkeys(run.name for run in runs)))
    file = options.out or common_folder(options.runs) / "report.html"
    if file.suffix not in (".html", ".htm"):
        raise InputError(f"--out {file}: got \"{file.suffix}\"; allowed: .html")
    write(file, page.encode())
    if not options.quiet:
        print(f"page of {len(runs)} run{'s' if len(runs) > 1 else ''} in {file}, {len(page.encode()) / 1e6:.1f} MB")


def sections(runs, names, words):
    """The sections that have something to show."""
    drawn = [(run, name) for run, name in zip(runs, names) if TRAJECTORY in tables_of(run)]
    found = (
        ("summary", "Summary", "Summary", summary_section(runs, names)),
        ("warnings", "Warnings", "Warnings", warnings_section(runs, names)),
        ("replay", "Replay", "Replay", drawn and player(replays(*zip(*drawn)))),
        ("curves", "Curves", "Curves", drawn and curves_section(*zip(*drawn))),
        ("fidelity", "Fidelity", "Against the measured force", fidelity_section(runs, names)),
        ("metrics", "Metrics", "Metrics", metrics_section(runs, names)),
        ("scenario", "Scenario", "Scenario", scenario_section(runs, names)),
        ("rerun", "Rerun", "Run it again", commands_section(runs, words)),
        ("provenance", "Provenance", "Provenance", provenance(runs)),
    )
    return [entry for entry in found if entry[3]]
