"""The command line of scripts/report."""
import sys
import tempfile
from pathlib import Path

from hapbench_command import Arguments, exit_status, write

from .credibility import load_credibility
from .figures import load_figures
from .json_input import InputError
from .ledger import load_choices, load_claims
from .live_link import place_live_page
from .page import report
from .replay import packed_replays, record_replays
from .runs import REPLAY_DIRECTORY, load_runs
from .studies import load_studies

CHOICES = Path(__file__).resolve().parents[3] / "results" / "reference" / "choices.json"


def arguments(words):
    parser = Arguments(
        prog="scripts/report", description="Writes one self-contained HTML file: ledger, figures, tables, all runs, and a replay.")
    parser.add_argument("results", type=Path, metavar="RESULTS_DIR", help="what scripts/reproduce wrote")
    parser.add_argument("--figures", type=Path, metavar="DIR", help="what scripts/figures wrote; default: no figures")
    parser.add_argument("--claims", type=Path, metavar="FILE", help="the ledger, claims.json; default: no ledger")
    parser.add_argument("--choices", type=Path, metavar="FILE", default=CHOICES,
                        help="the choices on record; default: results/reference/choices.json of this tree")
    parser.add_argument("--program", type=Path, metavar="FILE", help="a built hapbench, to record the runs of the replay")
    parser.add_argument("--replay", type=Path, metavar="DIR",
                        help=f"runs recorded earlier; default: RESULTS_DIR/{REPLAY_DIRECTORY} if it is there")
    parser.add_argument("--keep-replay", type=Path, metavar="DIR", help="with --program: record into this directory")
    parser.add_argument("--out", type=Path, metavar="FILE", help="default: RESULTS_DIR/report.html")
    return parser.parse_args(words)


def scenes(options):
    if options.program:
        with tempfile.TemporaryDirectory(prefix="hapbench-replay-") as scratch:
            directory = options.keep_replay or Path(scratch)
            record_replays(options.program, directory)
            return packed_replays(directory)
    directory = options.replay or options.results / REPLAY_DIRECTORY
    if options.replay and not options.replay.is_dir():
        raise InputError(f"--replay {options.replay}: no such directory")
    return packed_replays(directory)


def run(options):
    if not options.results.is_dir():
        raise InputError(f"{options.results}: no such directory; scripts/reproduce writes one")
    runs = load_runs(options.results)
    if not runs:
        raise InputError(f"{options.results}: holds no summary.json; allowed: a directory that scripts/reproduce wrote")
    page = report(runs, load_studies(options.results), load_claims(options.claims) if options.claims else [],
                  load_choices(options.choices), load_figures(options.figures) if options.figures else [], scenes(options),
                  load_credibility())
    out = options.out or options.results / "report.html"
    write(out, page)
    place_live_page(out.parent)
    print(f"{out}: {len(page.encode()) / 1e6:.1f} MB, {len(runs)} runs")


def main(words=None):
    options = arguments(words)
    return exit_status("report", "writing the report", lambda: run(options))


if __name__ == "__main__":
    sys.exit(main())
