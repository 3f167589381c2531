"""Measurements of scripts/bench (performance.json in the folder of results, if it is there): targets as ratios, whether they are
met, and how cost grows."""
import re
from pathlib import Path

from hapbench_bench import peers
from hapbench_bench.table import met, number, quantity, spread

from .figures import figure_markup
from .json_input import InputError, load_object, member, objects, shown
from .markup import cell, command, heading_cell, table, text

FIGURE = "growth"  # which stands here instead of among the others
FILE = "performance.json"
NUMBERS = {"ratios": ("ratio", "low", "high", "seconds"), "limits": ("value", "at_most")}
TEXTS = {"ratios": ("what", "over"), "limits": ("what", "unit")}


def load_performance(results: Path):
    """The object, its rows checked; None without a file."""
    file = results / FILE
    if not file.is_file():
        return None
    value = load_object(file)
    for key in ("commit", "date"):
        require(value, key, str, file, "")
    machine = member(value, "machine", dict, file, "", {})
    for key in ("cpu", "instruction_set", "compiler", "flags"):
        require(machine, key, str, file, "/machine")
    for part in NUMBERS:
        for i, row in enumerate(objects(value, part, file)):
            for key in TEXTS[part]:
                require(row, key, str, file, f"/{part}/{i}")
            for key in NUMBERS[part]:
                require(row, key, (int, float), file, f"/{part}/{i}")
            if row.get("at_most") is not None:
                require(row, "at_most", (int, float), file, f"/{part}/{i}")
    return value


def require(value, key, kind, file, place):
    found = value.get(key)
    if not isinstance(found, kind) or isinstance(found, bool):
        raise InputError(f"{file}: {place}/{key}: got {shown(found)}; allowed: {'a string' if kind is str else 'a number'}")


def performance_section(performance, figures, links):
    shown = "".join(figure_markup(figure, links) for figure in figures)
    figures_ = f"<div class=figures>{shown}</div>" if shown else ""
    if performance is None:
        return f'<p class="note">No {FILE} among these results (<code>scripts/bench --out</code>).</p>{figures_}{peers_table()}'
    machine = performance["machine"]
    return ("<p>What a part of the program takes over what another takes that ran in the same minutes, brute force wherever that "
            "makes sense: such ratios differ little between machines, and a target can be one. Below them what has a limit "
            "of its own. Machine: "
            f"{text(machine['cpu'])}, {text(machine['instruction_set'])}, {text(machine['compiler'])}; commit "
            f"<code>{text(performance['commit'])}</code>, {text(performance['date'])}.</p>" + command("scripts/bench")
            + ratios_table(performance.get("ratios", [])) + limits_table(performance.get("limits", [])) + figures_ + peers_table())


def coded(words):
    return re.sub(r"`([^`]*)`", r"<code>\1</code>", text(words))


def verdict(value, at_most):
    said = met(value, at_most).strip("*")
    tone = {"yes": "good", "no": "bad"}.get(said)
    return cell(f'<span class="verdict {tone}">{"✓" if said == "yes" else "✗"} {said}</span>' if tone else "")


def ratios_table(rows):
    cells = [[cell(coded(row["what"])), cell(coded(row["over"])),
              cell(f"{number(row['ratio'])} {spread(row)}", row["ratio"], "number"),
              cell("" if row.get("at_most") is None else f"≤ {number(row['at_most'])}", classes="number"),
              verdict(row["ratio"], row.get("at_most")), cell(quantity(row["seconds"], "s"), row["seconds"], "number")]
             for row in rows]
    headings = [heading_cell("What"), heading_cell("Over"), heading_cell("Ratio", True), heading_cell("Target", True),
                heading_cell("Met"), heading_cell("Takes", True)]
    return table(headings, cells, "<b>Ratios</b>", "sortable")


def limits_table(rows):
    cells = [[cell(coded(row["what"])), cell(quantity(row["value"], row["unit"]), row["value"], "number"),
              cell(f"≤ {quantity(row['at_most'], row['unit'])}", classes="number"), verdict(row["value"], row["at_most"])]
             for row in rows]
    headings = [heading_cell("What"), heading_cell("Measured", True), heading_cell("Limit", True), heading_cell("Met")]
    return table(headings, cells, "<b>Limits</b>", "sortable")


def peers_table():
    """Other libraries, from the record of this tree."""
    record = peers.record()
    cells = []
    for row in record["rows"]:
        name, answers, _ = peers.LIBRARIES[row["library"]]
        cells.append([cell(text(name)), cell(text(answers)), cell(text(row["task"])),
                      cell(f"{number(row['ratio'])} × {spread(row)}", row["ratio"], "number"),
                      cell(quantity(row["seconds"], "s"), row["seconds"], "number"),
                      cell(f"{row['contacts']:.0f}, {row['our_contacts']:.0f}", classes="number"), cell(peers.depths(row), classes="number")])
    headings = [heading_cell("Library"), heading_cell("Answers"), heading_cell("Scene"), heading_cell("Over ours", True),
                heading_cell("Takes", True), heading_cell("Contacts, ours", True), heading_cell("Depth, ours", True)]
    return ("<p>Other collision libraries at the same poses of the same block, timed in one process with our search: CGAL is asked "
            "our question and gives the same points, the others answer with triangles. "
            f"{text(record['cpu'])}, {text(record['compiler'])}; commit <code>{text(record['commit'])}</code>, "
            f"{text(record['date'])}.</p>" + command("scripts/bench --peers")
            + table(headings, cells, "<b>Other libraries</b>", "sortable"))
