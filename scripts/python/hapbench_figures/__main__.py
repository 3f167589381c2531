"""Command line of scripts/figures."""
import json
import re
import sys
import time
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import hapbench_style as style
from hapbench.columns import read_bytes
from hapbench.errors import InputError, ResultError
from hapbench.results import Files, MissingResult, read_json
from hapbench_command import (
    BAD_INPUT,
    SUCCESS,
    Arguments,
    exit_status,
    named_in_errors,
    print_error,
    write,
    write_all,
)

from .scene import LEDGER

CAPTIONS = Path(__file__).parent / "captions.txt"
HEAD = re.compile(r"(\S+)\] (.+) · (\w+)\.(\w+)(?:\((\w+)\))? · (.+)")
NOTHING_DRAWN = 1
ROWS = "rows.json"
NUMBER = re.compile(r"(?:[A-F]\.)?\d+")  # number of a figure
FORMATS = ("svg", "pdf", "png")
PAGE = """# Stored figures

*Reference.* This page shows every figure of the thesis that a simulation can draw, and some figures of this project.
`scripts/figures RESULTS --out DIR --record results/reference/figures` draws them from the results of
`scripts/reproduce`. *Data: ours* marks numbers that hapbench computed, *published* marks numbers of the thesis. Numbers
such as 3.2 and C.4.2 are sections of the thesis. *Raw points* are the colliding points before local average and
reduction. *Differs* states how a figure differs from the thesis's figure, and why.
"""


@dataclass(frozen=True)
class Figure:
    """One figure, as captions.txt describes it."""

    id: str
    # Number of the thesis's figure that this figure redraws; empty for figures of this project.
    thesis: str
    module: str
    function: str
    argument: str | None
    title: str
    caption: str
    differs: str  # text about the difference from the thesis's figure, with the reason
    # Claims that the figure draws in addition to the claims that are located in the thesis's figure.
    rows: tuple

    @property
    def stem(self):
        return "figure_" + self.id.replace("-", "_")

    def draw(self, results):
        """Returns (figure, values that its caption prints). Raises MissingResult if a result file is missing."""
        function = getattr(import_module(f".{self.module}", __package__), self.function)
        return function(results, self.argument) if self.argument else function(results)


def catalogue():
    """Returns all figures in the order of captions.txt. An entry without a caption has the caption of the previous
    entry."""
    found = []
    for text in CAPTIONS.read_text(encoding="utf-8").split("\n\n[")[1:]:
        head, *lines = text.strip().split("\n")
        id_, thesis, module, function, argument, title = HEAD.fullmatch(head).groups()
        text, _, rows = " ".join(lines).partition(" Rows: ")
        caption, _, differs = text.partition(" Differs: ")
        found.append(
            Figure(
                id_,
                thesis.removeprefix("-"),
                module,
                function,
                argument,
                title,
                caption or found[-1].caption,
                differs,
                tuple(rows.rstrip(".").split()),
            )
        )
    return found


FIGURES = catalogue()


def arguments(argv):
    parser = Arguments(
        prog="scripts/figures",
        description="Draws the figures of the thesis with data of hapbench, and the figures of this project, as "
        "SVG, PDF and PNG. If the data of a figure is missing, the command skips the figure and prints a message.",
    )
    parser.add_argument(
        "results", nargs="?", metavar="RESULTS_DIR", help="results that scripts/reproduce wrote"
    )
    parser.add_argument("--out", metavar="DIR", help="directory of the figures and of figures.json")
    parser.add_argument(
        "--only",
        metavar="ID,…",
        help="draw only these figures; A.4 also selects figures such as A.4-root-locus",
    )
    parser.add_argument(
        "--record",
        metavar="DIR",
        help="also copy the SVGs of the figures of the thesis into DIR, renew the figures of this project that "
        "DIR already has, and write figures.md, a page with all these figures",
    )
    parser.add_argument("--list", action="store_true", help="list the figures")
    chosen = parser.parse_args(argv)
    if not chosen.list and not (chosen.results and chosen.out):
        parser.error("RESULTS_DIR and --out DIR are required, or --list")
    return chosen


def selection(only):
    """Returns the figures that `only` names, a list of identifiers separated by commas; all figures if `only` is empty.
    An identifier such as A.4 also selects A.4-root-locus. Raises InputError for an unknown figure.
    """
    chosen = []
    for id_ in only.split(",") if only else ():
        found = [f for f in FIGURES if f.id == id_ or f.id.startswith(id_ + "-")]
        if not found:
            raise InputError(
                f"--only: no figure {id_!r}; allowed: {', '.join(f.id for f in FIGURES)}"
            )
        chosen += [f for f in found if f not in chosen]
    return chosen or FIGURES


def draw(figure, results, directory):
    """Draws one figure and writes its files into `directory`. Returns the figure's entry for figures.json."""
    drawing, values = figure.draw(results)
    files = [f"{figure.stem}.{kind}" for kind in FORMATS]
    write_all(
        {
            directory / name: style.picture(drawing, kind, salt=figure.stem)
            for kind, name in zip(FORMATS, files)
        }
    )
    style.plt.close(drawing)
    return {
        "id": figure.id,
        "title": figure.title,
        "thesis_figure": figure.thesis or None,
        "caption": figure.caption.format(**values),
        "files": files,
        "sources": sorted(results.sources),
    }


def write_index(directory, entries):
    """Writes figures.json. Keeps the entries of figures that still exist and were not drawn this time."""
    file = directory / "figures.json"
    known = {entry["id"]: entry for entry in read_json(file)["figures"]} if file.is_file() else {}
    known |= {entry["id"]: entry for entry in entries}
    known = {
        f.id: known[f.id]
        for f in FIGURES
        if f.id in known and (directory / f"{f.stem}.svg").is_file()
    }
    write(file, json.dumps({"figures": list(known.values())}, indent=2, ensure_ascii=False) + "\n")
    return known


def measured(figure, claims):
    """Returns the measured numbers, except run times, of each claim that a figure draws. If these numbers have changed
    since the figure was drawn, the figure is outdated."""
    numbers = set(NUMBER.findall(figure.thesis))
    drawn = {}
    for claim in claims:
        named = {
            number
            for part in claim["place"].split(", ")
            if part.startswith("Fig. ")
            for number in NUMBER.findall(part)
        }
        if not claim["timing"] and (claim["id"] in figure.rows or named & numbers):
            drawn[claim["id"]] = claim["measured"]
    return drawn


def record(directory, page, drawn, claims):
    """Copies figures in `drawn` into the directory `page`: each figure that redraws a figure of the thesis, and each
    figure that the directory already has. Writes figures.md about the copied figures, and
    rows.json with the measured numbers of the claims that the copied figures draw. `drawn`: entries of figures.json by
    identifier.
    """
    text, rows, files = PAGE, {}, {}
    for figure in FIGURES:
        on_record = page / f"{figure.stem}.svg"
        if figure.id not in drawn or not (figure.thesis or on_record.is_file()):
            continue
        files[on_record] = read_bytes(directory / on_record.name)
        rows[figure.id] = measured(figure, claims)
        name = f"Figure {figure.thesis}" if figure.thesis else "Ours"
        text += f"\n## {name}: {figure.title}\n\n![{figure.title}]({on_record.name})\n\n{drawn[figure.id]['caption']}"
        text += f" Differs: {figure.differs}\n" if figure.differs else "\n"
    files[page / "figures.md"] = text
    files[page / ROWS] = json.dumps(rows, indent=1, ensure_ascii=False) + "\n"
    write_all(files)


def run(chosen):
    figures, started = selection(chosen.only), time.monotonic()
    if chosen.list:
        print("\n".join(f"{figure.id:24} {figure.title}" for figure in figures))
        return SUCCESS
    if not Path(chosen.results).is_dir():
        raise InputError(f"{chosen.results}: no such directory")
    directory = Path(chosen.out)
    style.plt.rcParams.update(style.SETTINGS)
    with named_in_errors(directory):
        directory.mkdir(parents=True, exist_ok=True)
    entries, skipped, bad = [], False, {}
    for figure in figures:
        results = Files(chosen.results)
        try:
            entries.append(draw(figure, results, directory))
        except MissingResult as missing:
            skipped = True
            print(f"figures: skipped {figure.id} ({missing})", file=sys.stderr)
        except ResultError as error:
            bad[str(error)] = None
        except (KeyError, IndexError, TypeError, ValueError) as error:
            # The file can be parsed, but lacks columns, rows or members that hapbench writes.
            bad[
                f"figure {figure.id}: {', '.join(sorted(results.sources))}: {type(error).__name__}: {error}"
            ] = None
    index = write_index(directory, entries)
    if chosen.record and entries:
        record(directory, Path(chosen.record), index, Files(chosen.results).json(LEDGER)["claims"])
    if skipped:
        print(
            'figures: "scripts/reproduce --figure ID" computes the data of a figure and draws the figure',
            file=sys.stderr,
        )
    for line in bad:
        print_error(line)
    print(f"{len(entries)} figures in {directory}, {time.monotonic() - started:.0f} s")
    return BAD_INPUT if bad else SUCCESS if entries else NOTHING_DRAWN


def main(argv=None):
    chosen = arguments(argv)
    return exit_status("figures", "", lambda: run(chosen))


if __name__ == "__main__":
    sys.exit(main())
