"""python -m hapbench_pictures plot|report WORDS…; the program calls it for `hapbench plot` and `hapbench report`."""
import sys
from importlib import import_module
from pathlib import Path

from hapbench_command import SHARED, CommandLine, exit_status, leave, stop_on_ctrl_c

PLOT_FOOTER = """\
--y takes force, spring, measured, input, reference, force_error, torque (needs record.torque), \
depth, ratio, contacts, rendered, \
speed, x, y, z, path, energy, input_energy, or any column of the runs' tables; by default force, \
depth, ratio, contacts, path, and \
energy where it was recorded. force, speed and the like are lengths of vectors, drawn as \
|rendered force|; --y fx_N,fy_N,fz_N \
draws the components.
A comparison's folder stands for all its runs. Runs have the colour of their algorithm; several \
runs of one algorithm have \
colours of their own. Triangles mark the first touch. A peak of more than three times the range \
of settled contact is cut off, \
and its value written there. Of long runs the least and the greatest value for each pixel are \
drawn, so that no spike is lost.
Of a sampled sweep the metric is drawn over each field, with how much each matters: Spearman's \
rank correlation and the \
first-order Sobol index.
  hapbench plot results/out/drag_molar
  hapbench plot results/out/compare_drag_molar --y force,depth --out drag.png
  hapbench plot results/out/sweep_tap_wall --metric force_max_N"""
REPORT_FOOTER = """\
One HTML file that needs no server and no network. The replay shows up to four runs side by side, \
with their depths if they were \
run with --set record.contacts=true. Of two runs, what differs comes first.
For a regression test keep the results of a good version and compare every new one with them by \
--tolerance: outcome, metrics, \
warnings, trajectory.csv and sweep.csv, and with 0 the state hash. What one of them alone has \
makes them differ; fields are shown \
but do not count; provenance, times and counted work are not looked at.
  hapbench report results/out/drag_molar
  hapbench report results/out/compare_drag_molar
  hapbench report results/good results/out --tolerance 1e-9"""


def plot_line():
    line = CommandLine("plot", "Draw runs over time and in space, a sweep, limits", PLOT_FOOTER)
    line.text("runs", "folders that run, compare, sweep or limit wrote", nargs="+", metavar="RUN")
    line.text(
        "--out", "FILE.svg, .png or .pdf (default: plot.svg in the folder of the runs)", type=Path
    )
    line.flag("--quiet", SHARED)
    line.texts("--y", "the quantities to draw, separated by commas (below)")
    line.text("--metric", "for a sweep: the column of sweep.csv to draw")
    line.text(
        "--where",
        "for a sweep: only runs with this, as 'inside_max_m<3e-4' (sweep --help)",
        metavar="TEXT ...",
        action="append",
        default=[],
    )
    line.text("--from", "time from which to draw [s]", dest="start")
    line.text("--to", "time up to which to draw [s]", dest="end")
    return line


def report_line():
    line = CommandLine(
        "report",
        "Write a page of runs: curves, replay with sound, metrics, scenario, commands",
        REPORT_FOOTER,
    )
    line.text("runs", "folders that run or compare wrote", nargs="+", metavar="RUN")
    line.text("--out", "FILE.html (default: report.html in the folder of the runs)", type=Path)
    line.flag("--quiet", SHARED)
    line.text(
        "--tolerance",
        "no page: compare the results of two folders, in status 3 if they differ by more than "
        "this, of a metric relative "
        "to the larger of the two, of a column to its largest magnitude; 0: the same digits",
    )
    return line


def main(words):
    command, *rest = words
    line, doing = {"plot": (plot_line, "drawing"), "report": (report_line, "writing the report")}[
        command
    ]
    options = line().parse(rest)
    # The module loads matplotlib, which the help does without.
    return exit_status(
        command,
        "" if options.quiet else doing,
        lambda: getattr(import_module(f"hapbench_pictures.{command}"), command)(options),
    )


if __name__ == "__main__":
    stop_on_ctrl_c(sys.argv[1])
    leave(main(sys.argv[1:]))
