"""Command line of `hapbench import stroke`, which runs python -m hapbench_import WORDS…."""
import sys
from pathlib import Path

from hapbench_command import (
    CommandLine,
    answer,
    exit_status,
    fail,
    file_word,
    leave,
    refuse_source,
    shell_line,
    stop_on_ctrl_c,
    table_text,
    write,
)

from .options import DECIMALS, FORMATS, ORIENTATIONS, PRESETS, list_of_presets, options_of

NOTES = [
    "Columns: time, position, orientation and force, each given by its first column; or single components: px, py, pz, "
    "qw, qx, qy, qz, mfx, mfy, mfz. The name of a first column also selects the other components, by their names (x, "
    "y, z). A column number, counted from 1, also selects the columns after it.",
    'Units in column names, such as "x [mm]", are applied; --scale overrides them.',
    "A quaternion in columns named qw, qx, qy, qz is also read if --columns does not name it; --orientation none "
    "ignores it.",
    "Orientation: none, axis (direction out of the tip), quat_wxyz, quat_xyzw, axis_angle (axis, "
    "angle) or matrix (r11, r12 ... r33, row by row). The orientation rotates the tool's frame into "
    "the frame of the scene.",
    "Fields of --set: sample_rate_Hz (for a file without times), tip_axis (direction out of the "
    "tip in the tool's frame, default 0,0,-1), shift (added to the positions [m]), "
    "force_by_tool=true (the forces of the file act on the object; the command changes their "
    "sign), floats=true (hapi-binary with 4-byte numbers), max_speed, max_gap, held_rows.",
    "Held rows: if the file repeats each pose in several rows, the first row of each pose is used; "
    "with --set held_rows=keep all rows are samples (default: thin, which omits repeated rows).",
    "Rejected: invalid numbers, times that do not increase, quaternions not of unit length, jumps "
    "faster than max_speed (default 5 m/s), gaps longer than max_gap (default 0.5 s). Each kind "
    "of fault is listed with its first row and the number of rows, nothing is written, and the "
    "exit status is 2.",
    "Files: the stroke, a CSV file with one pose per row. It replaces an earlier file.",
]
EXAMPLES = [
    "hapbench import stroke",
    "hapbench import stroke log.txt --preset hapi --out stroke.csv",
    "hapbench import stroke rec.csv --columns time=t,position=5,orientation=8 \\\n"
    "    --orientation quat_xyzw --scale time=1e-6,position=0.001",
]


def command_line():
    line = CommandLine(
        "import stroke",
        "Convert a recording of poses (and measured forces) into a stroke that a scenario plays back.",
        NOTES,
        EXAMPLES,
        'scenarios/README.md, section "Strokes"',
    )
    line.text("file", "<recording>", "the recording; without it, the presets are listed", nargs="?")
    line.text(
        "--preset",
        "<preset>",
        "layout of the recording: a name or FILE.json; other options override it",
    )
    line.text(
        "--set",
        "<field=value>",
        "any field of a preset, see below; repeatable",
        action="append",
        default=[],
    )
    line.one_of(
        FORMATS,
        "--format",
        "<format>",
        "csv (default), traj (separated by blanks), hapi or hapi-binary",
    )
    line.texts(
        "--columns",
        "<name=column,...>",
        "columns of the quantities, by name or number, such as time=t,position=5; "
        "required without --preset",
    )
    line.texts(
        "--scale",
        "<name=factor,...>",
        "units of the file: seconds per unit of time, and so on for position [m], angle [rad] "
        "and force [N]; "
        "time=1e-6,position=0.001 are microseconds and millimetres",
    )
    line.one_of(
        DECIMALS,
        "--decimal",
        "<sign>",
        "decimal sign: comma, point or auto (default: auto; found from the numbers)",
    )
    line.one_of(
        list(ORIENTATIONS),
        "--orientation",
        "<kind>",
        "what the orientation columns hold, see below (default: found from their names; none: "
        "the tool does not rotate)",
    )
    line.texts(
        "--frame",
        "<axis,axis,axis>",
        "recorded directions that become x, y and z (default: x,y,z); for y up: x,-z,y",
    )
    line.text(
        "--rate",
        "<Hz>",
        "sample rate of the stroke (default: as recorded; if irregular, from the median interval)",
        type=float,
    )
    line.texts(
        "--smooth",
        "<window=n,order=m>",
        "smooth the poses with a Savitzky-Golay filter over n samples, an odd number",
    )
    line.flag(
        "--skip-bad-rows",
        "skip invalid rows and jumps and list them, instead of rejecting the file; only a larger --set max_gap=... "
        "accepts a longer gap",
    )
    line.text(
        "--out", "<file.csv>", "stroke to write (default: FILE_stroke.csv in the current folder)"
    )
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
            f"{table}\nTo adapt a preset, copy its file from {PRESETS}, edit the copy and use --preset FILE.json.",
            presets,
        )
    if not options.preset and not options.columns:
        fail("--columns or --preset is missing: which columns hold time and position?")
    # Imported here, because it loads numpy and scipy, which the help does not need.
    from .recording import open_recording
    from .stroke import import_stroke, stroke_text, table_of

    out = options.out or f"{Path(options.file).stem}_stroke.csv"
    refuse_source(out, options.file, "recording")
    layout = options_of(options)
    stroke, found = import_stroke(open_recording(options.file, layout), layout)
    write(Path(out), stroke_text(stroke))
    scenario = f"{Path(out).stem}.json"
    next_line = (
        f"{shell_line('hapbench', 'new', 'stroke', '--from', file_word(out), '--out', file_word(scenario))} && "
        f"{shell_line('hapbench', 'run', file_word(scenario))}"
    )
    table = table_text(["of the stroke", ""], table_of(found), options.wide)
    answer(
        options, f"{out}\n{table}\nnext: {next_line}", {"file": out} | found | {"next": next_line}
    )


if __name__ == "__main__":
    stop_on_ctrl_c("import stroke")
    requested = command_line().parse(sys.argv[1:])
    doing = "" if requested.quiet else "importing"
    leave(exit_status("import stroke", doing, lambda: run(requested)))
