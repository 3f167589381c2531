"""python -m hapbench_import WORDS…; the program calls it for `hapbench import stroke`."""
import sys
from pathlib import Path

from hapbench_command import (
    CommandLine,
    answer,
    exit_status,
    fail,
    leave,
    refuse_source,
    shell_line,
    stop_on_ctrl_c,
    table_text,
    write,
)

from .options import DECIMALS, FORMATS, ORIENTATIONS, PRESETS, list_of_presets, options_of

FOOTER = """\
--columns: time, and position, orientation and force by the name of their first column, whose \
others are found by their names (x, y, z), or by its number, which the others follow; or each by \
itself as px, py, pz, qw, qx, qy, \
qz, mfx, mfy, mfz. --orientation is none, axis (the direction out of the tip), quat_wxyz, \
quat_xyzw, axis_angle (axis, angle) or \
matrix (r11, r12 ... r33, row by row); it turns the tool's frame into the world's. Units in names, \
such as "x [mm]", are applied.
--set: sample_rate_Hz of a file without times; tip_axis, the direction out of the tip in the \
tool's frame, default 0,0,-1; shift, \
added to the places of the tip [m]; force_by_tool=true, forces are the tool's on the object and \
are turned round; max_speed, faster \
jumps are refused [m/s], default 5; max_gap, longer gaps are refused, not bridged [s], default \
0.5; held_rows=keep, rows that repeat a pose are samples, default thin; floats=true, hapi-binary has \
numbers of four bytes.
Rows with wrong numbers, times that do not increase, quaternions not of unit length and jumps are \
refused with their first line, and \
nothing is written.
  hapbench import stroke
  hapbench import stroke log.txt --preset hapi --smooth window=11,order=3 --out stroke.csv
  hapbench import stroke rec.csv --columns time=t,position=5,orientation=8,force=fx \\
    --orientation quat_xyzw --scale time=1e-6,position=0.001"""


def command_line():
    line = CommandLine(
        "import stroke",
        "Make a stroke to play back from a recording: poses and measured forces",
        FOOTER,
    )
    line.text(
        "file", "the recording; without it, the presets are listed", nargs="?", metavar="file"
    )
    line.text("--preset", "a layout by name or from FILE.json; options below override it")
    line.text(
        "--set",
        "any field of such a file: NAME=VALUE (below); repeatable",
        metavar="TEXT ...",
        action="append",
        default=[],
    )
    line.one_of(
        FORMATS, "--format", "csv (default), traj (blanks between numbers), hapi, hapi-binary"
    )
    line.one_of(
        DECIMALS, "--decimal", "the decimal sign: comma, point or auto (default), which finds it"
    )
    line.texts("--columns", "where quantities are, by name or number from 1 (below)")
    line.texts("--scale", "what units are: time [s], position [m], angle [rad], force [N] (below)")
    line.one_of(
        list(ORIENTATIONS),
        "--orientation",
        "what its columns hold; default: as their names say; none: the tool never turns",
    )
    line.texts("--frame", "recorded directions that are the scenario's x, y, z; y up: x,-z,y")
    line.text(
        "--rate",
        "[Hz] of the stroke; default: as recorded, or the median's if irregular",
        metavar="FLOAT",
        type=float,
    )
    line.texts("--smooth", "window=N,order=M: Savitzky-Golay over N samples, an odd number")
    line.flag("--skip-bad-rows", "leave bad rows out and say which, instead of refusing")
    line.text("--out", "the stroke; default: FILE_stroke.csv here")
    line.add_output_options()
    return line


def run(options):
    if not options.file:
        presets = list_of_presets()
        table = table_text(
            ["PRESET", "of"], [[one["preset"], one["description"]] for one in presets], options.wide
        )
        return answer(
            options,
            f"{table}\nCopy one from {PRESETS}, correct it and give it as --preset FILE.json.",
            presets,
        )
    if not options.preset and not options.columns:
        fail("--columns or --preset is missing: which columns hold time and position?")
    from .recording import open_recording  # loads numpy and scipy, which the help does without
    from .stroke import import_stroke, stroke_text, table_of

    out = options.out or f"{Path(options.file).stem}_stroke.csv"
    refuse_source(out, options.file, "recording")
    asked = options_of(options)
    stroke, found = import_stroke(open_recording(options.file, asked), asked)
    write(Path(out), stroke_text(stroke))
    scenario = f"{Path(out).stem}.json"
    next_line = (
        f"{shell_line('hapbench', 'new', 'stroke', '--from', out, '--out', scenario)} && "
        f"{shell_line('hapbench', 'run', scenario)}"
    )
    table = table_text(["of the stroke", ""], table_of(found), options.wide)
    answer(
        options, f"{out}\n{table}\nnext: {next_line}", {"file": out} | found | {"next": next_line}
    )


if __name__ == "__main__":
    stop_on_ctrl_c("import stroke")
    asked_for = command_line().parse(sys.argv[1:])
    doing = "" if asked_for.quiet else "importing"
    leave(exit_status("import stroke", doing, lambda: run(asked_for)))
