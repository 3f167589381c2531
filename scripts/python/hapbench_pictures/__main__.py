"""python -m hapbench_pictures plot|report WORDS…; the program calls it for `hapbench plot` and `hapbench report`."""
import sys
from importlib import import_module
from pathlib import Path

from hapbench_command import SHARED, CommandLine, exit_status, leave, stop_on_ctrl_c

PLOT_NOTES = [
    "Quantities of --y: force, spring, measured, input, reference, force_error, torque (with "
    "record.torque), depth, ratio, contacts, rendered, speed, x, y, z, path, energy, input_energy, "
    "or any column of the runs' tables. force, speed and other vectors are drawn as their length; "
    "--y fx_N,fy_N,fz_N draws components.",
    "Runs: several folders are drawn into one picture; the folder of a comparison stands for all its runs. "
    "Each force law has its own colour; if all runs use one law, each run has its own colour. There are six such "
    "colours; a seventh run has the look of the first. Runs that differ only in the seed share a colour. A "
    "circle marks the start of a path, a square its end, a triangle the first touch.",
    "Peaks: a peak of more than three times the range of settled contact is cut off and labelled "
    "with its value, and so is a peak that is 100 times (in a failed run 5 times) as large as the "
    "peaks of the other runs.",
    "A comparison with a ranking (several seeds, scenes, or --by): each metric by law, the best "
    "on top with its rank; --y draws the runs over time instead. --metric draws other metrics by "
    "law, also without a ranking. Grey: the tolerance of the mean. A mean that is not larger than its "
    "tolerance is drawn as a hollow mark at mean + error. Failed runs are counted in red and have no "
    "value.",
    "Limits: marks are simulated limits, lines or hollow squares linear limits; with --device a "
    "colour for each device, dotted lines for published limits. The mark of a simulated limit is "
    "also hollow, and not joined to others, if stable and unstable runs alternate (column "
    "non_monotonic_runs).",
    "Logs of a loop: a folder of run --replay, or a log itself; the force over time, with the "
    "late calls. A replay folder has only the new outputs. To draw their difference from the "
    "recorded outputs, also name the recorded log.",
    "A sampled sweep: the metric over each field, with the influence of the field: Spearman's rank "
    "correlation and first-order Sobol index.",
    "Files: plot.svg in the folder that is drawn, or beside the log; if several folders or logs "
    "are named, in the nearest folder that contains them all. It replaces an earlier picture.",
]
PLOT_EXAMPLES = [
    "hapbench plot results/out/drag_molar",
    "hapbench plot results/out/compare_drag_molar --y force,depth --out drag.png",
    "hapbench plot results/out/compare_tap_wall --metric force_max_N --width single",
    "hapbench plot results/out/sweep_tap_wall --metric force_max_N",
    "hapbench plot results/out/drag_molar_replay loop.csv",
]
REPORT_NOTES = [
    "Page: one HTML file that needs no other file, no server and no network. It shows curves, "
    "metrics, scenarios and commands, and plays back up to four runs side by side. Runs with "
    "--set record.contacts=true also show depths. For two runs, their differences come first. If "
    "the live page is built (scripts/live/README.md), it is copied beside the page, which then "
    "links to it.",
    "Many runs (several seeds, or several scenes with more than 8 runs in total): the page begins "
    "with laws by metrics and the ranking; curves are means over the seeds.",
    "A sweep: use sweep --keep-runs, then report FOLDER/runs.",
    "--tolerance compares outcome, metrics, warnings, trajectory.csv and sweep.csv, and with 0 "
    "also the state hash. A result that only one folder has counts as a difference. Provenance, "
    "run times and counts of work are ignored; different fields of the scenarios are shown, but "
    "are no difference of the results.",
    "Exit status: with --tolerance 0 if the folders agree, 3 if they differ; 2 bad input.",
]
REPORT_EXAMPLES = [
    "hapbench report results/out/drag_molar",
    "hapbench report results/out/compare_drag_molar",
    "hapbench report results/good results/out --tolerance 1e-9",
]
MANUAL = 'results/README.md, section "Pictures and pages of your own runs"'


def plot_line():
    line = CommandLine(
        "plot",
        "Draw runs over time and in space, sweeps, and limits.",
        PLOT_NOTES,
        PLOT_EXAMPLES,
        MANUAL,
    )
    line.text(
        "runs",
        "<dir>",
        "folders of run, compare, sweep, limit, converge or tune; or one or two logs of a loop (see below)",
        nargs="+",
    )
    line.text(
        "--out",
        "<file>",
        "picture to write, ending in .svg, .png or .pdf (default: plot.svg, see below)",
        type=Path,
    )
    line.flag("--quiet", SHARED)
    line.texts(
        "--y",
        "<name,...>",
        "quantities to draw (default: force, depth, ratio, contacts, path; also reference, force_error and "
        "energy if the run recorded them; for energy, run with --set record.energy=true)",
    )
    line.texts(
        "--metric",
        "<name,...>",
        "metrics to draw by law, with mean, spread and every run; for a sweep: one column of sweep.csv",
    )
    line.one_of(
        ("single", "double", "slide"),
        "--width",
        "<name>",
        "size: single or double column of a journal (89 or 183 mm wide), or slide (160 mm x 90 mm); "
        "default: double",
    )
    line.text(
        "--where",
        "<condition>",
        "for a sweep: draw only runs that meet it, such as 'inside_max_m<3e-4' (sweep --help); repeatable",
        action="append",
        default=[],
    )
    line.text(
        "--dpi",
        "<number>",
        "pixels per inch of a .png, or of the surface points in a .pdf, which are an image (default: "
        "300)",
    )
    line.text("--from", "<s>", "start of the time span to draw", dest="start")
    line.text(
        "--to",
        "<s>",
        "end of the time span to draw, not the file of the picture (see --out)",
        dest="end",
    )
    return line


def report_line():
    line = CommandLine(
        "report",
        "Write a page that shows and plays back runs, or compare the results of two folders.",
        REPORT_NOTES,
        REPORT_EXAMPLES,
        MANUAL,
    )
    line.text("runs", "<dir>", "folders of run or compare", nargs="+")
    line.text(
        "--out",
        "<file.html>",
        "page to write (default: report.html in the folder of the runs; of several folders, in the nearest "
        "folder that contains them all)",
        type=Path,
    )
    line.flag("--quiet", SHARED)
    line.text(
        "--tolerance",
        "<ratio>",
        "compare two folders instead of writing a page; allowed relative difference of single "
        "numbers, and of table entries relative to the largest value of their column; 0: identical "
        "digits",
    )
    return line


def main(words):
    command, *rest = words
    line, doing = {"plot": (plot_line, "drawing"), "report": (report_line, "writing the report")}[
        command
    ]
    options = line().parse(rest)
    # Imported here, because the module loads matplotlib, which the help does not need.
    return exit_status(
        command,
        "" if options.quiet else doing,
        lambda: getattr(import_module(f"hapbench_pictures.{command}"), command)(options),
    )


if __name__ == "__main__":
    stop_on_ctrl_c(sys.argv[1])
    leave(main(sys.argv[1:]))
