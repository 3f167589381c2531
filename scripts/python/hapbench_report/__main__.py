"""The command line of scripts/report."""
import os
import subprocess
import sys
from pathlib import Path

from hapbench_command import (
    DIFFERENT,
    SUCCESS,
    Arguments,
    exit_status,
    leave,
    stop_on_ctrl_c,
    write_all,
)

if __name__ == "__main__":
    stop_on_ctrl_c("report")

from hapbench.errors import InputError

from .figures import load_figures
from .ledger import load_claims
from .page import live_page_in, thesis_page
from .runs import REPLAY_DIRECTORY, load_runs

# Scenes of the replay: (scenario, further settings, algorithms). The page initially shows the first two algorithms.
REPLAYED = (
    (
        "task2_rotate_signed_distance",
        ("time.duration_s=6",),
        ("original_averaging", "shaped_stiffness"),
    ),
    (
        "peg_in_hole_2d_shaped_stiffness",
        (),
        ("original_averaging", "shaped_stiffness", "summation", "mean", "exact_shaping"),
    ),
)
# Settings that record every step, because the sound and the drawn peaks of the replay need every step. The settings
# remove the expectations, which apply only to the scenario's own algorithm.
RECORDED = (
    "record.contacts=true",
    "record.stiffness_tensor=true",
    "record.every=1",
    "record.ratio_iterations=[]",
    "expect={}",
)


def arguments(words):
    parser = Arguments(
        prog="scripts/report",
        description="Writes one self-contained HTML file: ledger, figures, all runs, and a replay.",
    )
    parser.add_argument(
        "results", type=Path, metavar="RESULTS_DIR", help="results that scripts/reproduce wrote"
    )
    parser.add_argument(
        "--figures",
        type=Path,
        metavar="DIR",
        help="figures that scripts/figures wrote; default: no figures",
    )
    parser.add_argument(
        "--claims", type=Path, metavar="FILE", help="the ledger, claims.json; default: no ledger"
    )
    parser.add_argument(
        "--program",
        type=Path,
        metavar="FILE",
        help=f"the program hapbench, which records the runs of the replay into RESULTS_DIR/"
        f"{REPLAY_DIRECTORY}; default: the replay shows the recorded runs that RESULTS_DIR already has",
    )
    parser.add_argument("--out", type=Path, metavar="FILE", help="default: RESULTS_DIR/report.html")
    return parser.parse_args(words)


def record(program, directory):
    for scenario, further, algorithms in REPLAYED:
        for algorithm in algorithms:
            settings = [
                f"--set={text}"
                for text in (*RECORDED, *further, f"rendering.algorithm={algorithm}")
            ]
            line = [
                program,
                "run",
                scenario,
                *settings,
                "--quiet",
                "--out",
                directory / scenario / algorithm,
            ]
            try:
                done = subprocess.run(
                    line, capture_output=True, text=True, stdin=subprocess.DEVNULL
                )
            except OSError as error:
                raise InputError(f"{program}: {error}") from error
            if done.returncode not in (SUCCESS, DIFFERENT):
                lines = done.stderr.strip().splitlines() or ["no message"]
                raise InputError(
                    f"{program} run {scenario}: exit status {done.returncode}: {lines[-1]}"
                )


def run(options):
    if not options.results.is_dir():
        raise InputError(f"{options.results}: no such directory; scripts/reproduce writes one")
    runs = load_runs(options.results, but=REPLAY_DIRECTORY)
    if not runs:
        raise InputError(
            f"{options.results}: holds no summary.json; allowed: a directory that scripts/reproduce wrote"
        )
    if options.program:
        record(options.program, options.results / REPLAY_DIRECTORY)
        os.environ["HAPBENCH_PROGRAM"] = str(options.program)
    recorded = {run.path: run for run in load_runs(options.results / REPLAY_DIRECTORY)}
    replayed = [
        f"{scenario}/{algorithm}"
        for scenario, _, algorithms in REPLAYED
        for algorithm in algorithms
    ]
    ledger = load_claims(options.claims) if options.claims else ([], "", [])
    figures = load_figures(options.figures) if options.figures else []
    page = thesis_page(
        runs, ledger, figures, [recorded[path] for path in replayed if path in recorded]
    )
    out = options.out or options.results / "report.html"
    write_all({out: page, **live_page_in(out.parent)})
    print(f"{out}: {len(page.encode()) / 1e6:.1f} MB, {len(runs)} runs")


if __name__ == "__main__":
    requested = arguments(sys.argv[1:])
    leave(exit_status("report", "writing the report", lambda: run(requested)))
