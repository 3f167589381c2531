"""python -m hapbench_import NAME=VALUE…; the program calls it for `hapbench import`.

The words are the options of the command, one for each value of a list, and `presets`, their folder, and
`stiffness_N_per_m`, for the report. Writes the stroke. Prints JSON: `table` and `json` of the report, or of the presets
for `list`; or `faults`, each a place and a problem; or `io_error`, the number of a system error."""
import os
import sys
from pathlib import Path

from hapbench_command import write

from .faults import run_asked
from .options import list_of_presets, options_of
from .recording import open_recording
from .report import json_of, table_of
from .stroke import import_stroke, stroke_text


def run(given):
    if "list" in given:
        return list_of_presets(given)
    options = options_of(given)
    report = import_stroke(open_recording(given["file"][0], options), options)
    write(Path(os.fsdecode(given["out"][0].encode("utf-8", "surrogateescape"))), stroke_text(report.stroke))
    stiffness = float(given["stiffness_N_per_m"][0])
    return {"table": table_of(report, stiffness), "json": {"file": given["out"][0]} | json_of(report, stiffness)}


if __name__ == "__main__":
    sys.exit(run_asked(run))
