"""python -m hapbench_import NAME=VALUE…; the program calls it for `hapbench import`.

The words are the options of the command, one for each value of a list, and `presets`, their folder, and
`stiffness_N_per_m`, for the report. Writes the stroke. Prints JSON: `table` and `json` of the report, or of the presets
for `list`; or `faults`, each a place and a problem; or `io_error`, the number of a system error."""
import json
import os
import sys
from pathlib import Path

from hapbench_command import INTERRUPTED, SUCCESS, write

from .faults import Faults
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


def main():
    given = {}
    for word in sys.argv[1:]:
        # Independent of the locale: arguments are bytes, and texts are UTF-8.
        name, _, value = os.fsencode(word).decode("utf-8", "surrogateescape").partition("=")
        given.setdefault(name, []).append(value)
    try:
        reply = run(given)
    except Faults as faults:
        reply = {"faults": faults.list}
    except OSError as error:
        reply = {"io_error": error.errno}
    except KeyboardInterrupt:
        return INTERRUPTED
    sys.stdout.buffer.write(json.dumps(reply, ensure_ascii=False).encode("utf-8", "replace"))
    return SUCCESS


if __name__ == "__main__":
    sys.exit(main())
