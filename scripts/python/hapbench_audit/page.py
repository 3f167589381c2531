"""Builds the HTML page of an audit, in the style of `hapbench report`."""
from pathlib import Path

from hapbench_import.stroke import columns_text
from hapbench_pictures import report as run_report
from hapbench_pictures.panels import DARK
from hapbench_report.markup import cell, command, heading_cell, number_cell, table, text
from hapbench_report.page import whole_page

from .picture import colours_of
from .text import table_rows

MAX_CONTACTS = 200  # largest number of contacts in the table of the page; audit.json has all


def page_of(log, audit, drawing, line):
    """Returns the page as a text. `drawing`: the Drawing of the audit. `line`: the command line that made the page."""
    sections = (
        ("summary", "Summary", "Summary", summary(log, audit)),
        ("warnings", "Warnings", "Warnings", listed(map(text, audit["warnings"]))),
        ("diagnosis", "Diagnosis", "Problems found, and what to try", diagnosis(audit)),
        (
            "missing",
            "To say more",
            "To say more, the log lacks",
            listed(map(text, audit["missing"])),
        ),
        ("curves", "Curves", "Curves", curves(drawing)),
        ("contacts", "Contacts", "Contacts", contacts_table(audit)),
        ("columns", "Columns", "Columns of the log", columns_section(log)),
        ("rerun", "Rerun", "Run it again", command(line)),
    )
    return whole_page(
        [one for one in sections if one[3]],
        title=f"audit of {Path(log.file).name}",
        further_style=run_report.STYLE.read_text(encoding="utf-8"),
    )


def listed(words):
    items = "".join(f"<li>{one}</li>" for one in words)
    return items and f"<ul>{items}</ul>"


def summary(log, audit):
    rows = [
        [cell(f"<b>{text(one)}</b>"), *(cell(text(word)) for word in words)]
        for one, *words in table_rows(audit)
    ]
    return f"<h1>{text(Path(log.file).name)}</h1>" + table(
        [heading_cell("Subject"), heading_cell("Quantity"), heading_cell("What the log shows")],
        rows,
    )


def diagnosis(audit):
    return (
        listed(
            f"<b>{text(one['rule'])}:</b> {text(one['says'])} <i>Try: {text(one['try'])}</i>"
            for one in audit["diagnosis"]
        )
        or "<p>No rule exceeds its threshold.</p>"
    )


def curves(drawing):
    """Returns the HTML of all panels. Each panel is drawn on a light and on a dark background."""

    def drawn(title, part):
        return run_report.drawing(
            run_report.SIZE,
            lambda ax, _, paper: part(ax, colours_of(paper == DARK)),
            [],
            title,
            "see the summary for its numbers",
        )

    return f"<div class=curves>{''.join(drawn(*one) for one in drawing.panels())}</div>"


def contacts_table(audit):
    rows = []
    for one in audit["contacts"][:MAX_CONTACTS]:
        spring = one["spring"] or {}
        rows.append(
            [
                number_cell(one["start_s"], 6),
                number_cell(one["end_s"] - one["start_s"]),
                number_cell(one["force_max_N"], 3),
                number_cell(1e3 * one["work_J"], 3),
                number_cell(one["created_J"] and 1e3 * one["created_J"], 3),
                number_cell(1e3 * one["error_J"], 1),
                number_cell(spring.get("stiffness_N_per_m"), 4),
                number_cell(spring.get("damping_N_s_per_m"), 3),
            ]
        )
    more = len(audit["contacts"]) - len(rows)
    note = f"<p class=note>and {more} more in audit.json</p>" if more > 0 else ""
    headings = (
        ("from", "s"),
        ("duration", "s"),
        ("largest force", "N"),
        ("work on the tool", "mJ"),
        ("created", "mJ"),
        ("error at most", "mJ"),
        ("K", "N/m"),
        ("B", "N s/m"),
    )
    return (
        rows
        and table(
            [heading_cell(name, True, unit) for name, unit in headings], rows, classes="sortable"
        )
        + note
    )


def columns_section(log):
    return f"<p>{text(columns_text(log.columns, log.columns_not_read, log.scales))}</p>"
