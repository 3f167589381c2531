"""Analyses the log of any haptic or contact engine: python -m hapbench_audit ARGUMENTS…. The program runs this module
for `hapbench audit`."""
import sys
from pathlib import Path

from hapbench_command import (
    DIFFERENT,
    CommandLine,
    answer,
    exit_status,
    leave,
    print_error,
    shell_line,
    stop_on_ctrl_c,
    table_text,
    write_all,
)
from hapbench_import.options import DECIMALS, ORIENTATIONS

NOTES = [
    "Log: a CSV file (or a text table) with time, position of the tool and force on it, one row "
    "per step. Usual column names are found (t, px, py, pz, fx, fy, fz); --columns names others: "
    "time, position, force, orientation, velocity, contacts (number of contacts), measured (force "
    "from a sensor). A log of one axis has one position and one force; a planar log has two of each. "
    'Units in names, such as "x [mm]", are applied.',
    "Fields of --set: force_by_tool=true (the log has the force of the tool on the object; audit "
    "reverses its sign), touch_N (a row with a larger force is in contact; default: any force), "
    'sample_rate_Hz (for a log without times), and those of "hapbench import stroke --help" except held_rows and '
    "tip_axis.",
    "Energy: the sum of f . dp, with the force of a row held until the next row. Positive work is "
    "energy that the engine gives to the hand; the largest sum from the start to any row is the "
    "net created energy (energy_mJ). If the log begins in contact, the energy stored there is "
    'subtracted, which needs a stiffness. "Without holding" is the same sum for a force that changes '
    "linearly between rows.",
    "Motion: record several taps, presses to several depths at several speeds, and releases. A constant press shows no "
    "stiffness.",
    "Contacts: each contact lasts from touch to release. Its first 0.05 s are a landing, the rest is settled contact, "
    "as in `run`.",
    "Stiffness: a regression of the force on position and velocity along the normal of the surface, for delays of "
    "whole rows. The result is the weighted median of the contacts. If the log does not determine a number, audit "
    "omits the number, and the text below the table names what the log lacks.",
    "Expectations: bounds on numbers of the audit, such as energy_mJ=1, "
    "force_rms_above_30Hz_N=0.1 or stiffness_N_per_m=900:1100. A number that the log does not "
    "determine does not meet its expectation.",
    "Files: audit.json, audit.svg and audit.html in results/out/audit_LOG. They replace earlier files, but only if all "
    "three can be written.",
    "Exit status: 0 success, also if audit finds problems; 2 bad input; 3 an expectation is not met.",
]
EXAMPLES = [
    "hapbench audit log.csv",
    "hapbench audit log.csv --device touch --expect energy_mJ=1",
    "hapbench audit rec.csv --columns time=stamp_ns,position=tip_x,force=f_x \\\n"
    "    --scale time=1e-9 --set force_by_tool=true",
]


def command_line():
    line = CommandLine(
        "audit",
        "Report what a log of any haptic or contact engine shows: energy, vibration, stiffness, and what to try.",
        NOTES,
        EXAMPLES,
        "results/AUDIT.md",
    )
    line.text("log", "<log.csv>", "log of time, position and force")
    line.text(
        "--device",
        "<device>",
        'print the stiffness as a multiple of the linear limit of this device: a preset ("hapbench '
        'describe presets") or FILE.json',
    )
    line.texts(
        "--columns",
        "<name=column,...>",
        "columns of the quantities, by name or number from 1 (default: usual names)",
    )
    line.texts(
        "--scale",
        "<name=factor,...>",
        "units of the log: seconds per unit of time, and so on for position [m], force [N] and angle [rad]",
    )
    line.one_of(
        list(ORIENTATIONS),
        "--orientation",
        "<kind>",
        "what the orientation columns hold (default: found from their names)",
    )
    line.one_of(
        DECIMALS,
        "--decimal",
        "<sign>",
        "decimal sign: comma, point or auto (default: auto; found from the numbers)",
    )
    line.text("--preset", "<preset>", "layout of the log, as in import stroke: a name or FILE.json")
    line.text(
        "--set",
        "<field=value>",
        "force_by_tool=true, touch_N, sample_rate_Hz or any field of a preset, see below; repeatable",
        action="append",
        default=[],
    )
    line.flag("--skip-bad-rows", "skip invalid rows and list them, instead of rejecting the log")
    line.texts(
        "--expect",
        "<metric=max,...>",
        "end with exit status 3 if a number is unknown, above MAX or outside MIN:MAX",
    )
    line.text("--out", "<dir>", "folder of the results (default: results/out/audit_LOG)", type=Path)
    line.add_output_options()
    return line


def run(options):
    # Imported here, because these modules load numpy, scipy and matplotlib, which the help does not need.
    import json

    from hapbench_import.stroke import columns_text

    from .audit import audit_log
    from .expect import expectations, unmet_text
    from .log import read_log
    from .page import page_of
    from .picture import Drawing, draw
    from .text import below_table, table_rows

    log = read_log(options)
    audit, contacts, spectrum = audit_log(log, options.device)
    audit["expectations"] = expectations(options.expect, audit)
    audit["columns"], audit["columns_not_read"] = log.columns, log.columns_not_read
    audit["scales"] = log.scales
    out = options.out or Path("results/out") / f"audit_{Path(options.log).stem}"
    drawing = Drawing(log, audit, contacts, spectrum)
    line = shell_line("hapbench", "audit", *sys.argv[1:])
    write_all(
        {
            out / "audit.json": json.dumps(audit, indent=2, ensure_ascii=False) + "\n",
            out / "audit.svg": draw(drawing),
            out / "audit.html": page_of(log, audit, drawing, line).encode(errors="replace"),
        }
    )
    unmet = [unmet_text(one) for one in audit["expectations"] if not one["met"]]
    table = table_text(["audit of", Path(options.log).name, ""], table_rows(audit), options.wide)
    columns = columns_text(log.columns, log.columns_not_read, log.scales)
    below = "\n".join(below_table(audit))
    answer(options, f"{columns}\n\n{table}\n{below}\n\nresults in {out}", audit)
    for one in unmet:
        print_error(one)
    return DIFFERENT if unmet else None


if __name__ == "__main__":
    stop_on_ctrl_c("audit")
    requested = command_line().parse(sys.argv[1:])
    doing = "" if requested.quiet else "auditing"
    leave(exit_status("audit", doing, lambda: run(requested)))
