"""Command line of scripts/docs."""
import difflib
import re
import shlex
import sys
import tempfile
from pathlib import Path

from hapbench_command import FAILED, SUCCESS, Arguments, exit_status, print_error, write

from .manuals import (
    MAKERS,
    ROOT,
    Manual,
    Program,
    manuals,
    renewed,
    session,
    write_files_of_getting_started,
)

GALLERY = ROOT / "results" / "reference" / "gallery"
# Matches consecutive lines of commands in a manual, and the picture from the gallery below these lines. The last
# command draws the picture.
ILLUSTRATED = re.compile(r"((?:^    hapbench .*\n)+)\n!\[[^]]*\]\([^)]*/gallery/(\w+\.svg)\)", re.M)

DESCRIPTION = """Renews the generated blocks of the manuals: sessions (commands with their output),
the tables of the ledger and of its robustness, from results/reference, and, with --gallery, the
pictures of commands. Needs the built program. Keeps measured times. The exit status is 1 if --check
finds a block that is not current."""


def arguments(words):
    parser = Arguments(prog="scripts/docs", description=DESCRIPTION)
    parser.add_argument(
        "--program",
        type=Path,
        default=ROOT / "build" / "release" / "bin" / "hapbench",
        metavar="FILE",
        help="default: build/release/bin/hapbench",
    )
    parser.add_argument(
        "--tables",
        action="store_true",
        help="renew only the tables from results/reference, which need no program",
    )
    parser.add_argument(
        "--gallery",
        action="store_true",
        help="also renew the pictures of results/reference/gallery",
    )
    parser.add_argument(
        "--check", action="store_true", help="write nothing; show the blocks that are not current"
    )
    return parser.parse_args(words)


def draw_gallery(program, scratch):
    """Draws the pictures that the manuals show below their commands. Executes these commands in the folder
    `scratch`."""
    pictures = [
        found for manual in map(Manual, manuals()) for found in ILLUSTRATED.findall(manual.text)
    ]
    for commands, picture in pictures:
        *runs, plot = (shlex.split(line, comments=True)[1:] for line in commands.splitlines())
        for words in runs:
            program.run([*words, "--quiet"], scratch)
        program.run([*plot, "--quiet", "--out", GALLERY / picture], scratch)
    print(f"drew {len(pictures)} pictures into {GALLERY.relative_to(ROOT)}")


def run(chosen):
    program, stale = None if chosen.tables else Program(chosen.program), False
    with tempfile.TemporaryDirectory(prefix="hapbench-docs-") as scratch:
        if chosen.gallery and program:
            draw_gallery(program, Path(scratch))
        if program:
            write_files_of_getting_started(Path(scratch))
            program.run(["new", "drag", "--from", "my.obj", "--extent", "10mm"], scratch)
        of_program = (
            {"session": lambda old: session(old, program, Path(scratch))} if program else {}
        )
        for manual in map(Manual, manuals()):
            text = renewed(manual.text, MAKERS | of_program)
            if text == manual.text:
                continue
            name = str(manual.file.relative_to(ROOT))
            if chosen.check:
                print(
                    "\n".join(
                        difflib.unified_diff(
                            manual.text.splitlines(),
                            text.splitlines(),
                            name,
                            f"{name}, renewed",
                            lineterm="",
                        )
                    )
                )
                stale = True
            else:
                write(manual.file, text)
                print(f"renewed {name}")
    if stale:
        print_error("the manuals are not current; scripts/docs renews them")
    return FAILED if stale else SUCCESS


if __name__ == "__main__":
    options = arguments(sys.argv[1:])
    sys.exit(exit_status("docs", "", lambda: run(options)))
