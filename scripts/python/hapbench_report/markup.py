"""Functions that format values as HTML. `text` escapes every text that does not come from this program."""
import html
import json
import math
import re
from decimal import Decimal
from pathlib import Path
from statistics import median

from hapbench.results import number_or_none
from hapbench.table import ending_of, unit_of

ABSENT = "–"
ASSETS = Path(__file__).parent / "assets"
PER = "seconds_per_"  # prefix of metrics that are the time of one step or of one call
SMALL_M = 0.01  # lengths below this value [m] are printed in mm
# Title, unit and factor of each metric in the tables of the program. The titles are the headings kRunHeadings of the
# program.
TITLES = {
    "force_max_N": ("largest force", "N", 1),
    "contact_share": ("in contact", "%", 100),
    "landing_force_max_N": ("landing force", "N", 1),
    "force_mean_in_contact_N": ("mean force in contact", "N", 1),
    "force_step_p99_N": ("force step (99 %)", "N", 1),
    "force_rms_above_30Hz_N": ("vibration above 30 Hz", "N rms", 1),
    "force_reversals_per_s": ("reversals", "1/s", 1),
    "inside_max_m": ("max depth inside", "mm", 1e3),
}


def text(value):
    return html.escape(str(value), quote=True)


def named(value):
    """Escapes a name and allows line breaks only after underscores and slashes."""
    return re.sub(r"([_/])(?=\w)", r"\1<wbr>", text(value))


# EXPONENT matches the exponent of a number. MINUS matches the minus sign of a number at the beginning of a word.
EXPONENT = re.compile(r"(?<=\d)e([+-]?)0*(\d+)\b")
MINUS = re.compile(r"(?<![\w.)])-(?=\d)")
SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def typeset(value):
    """Returns text with typographic numbers: "-1.2e-07" becomes "−1.2 × 10⁻⁷"."""
    shown = EXPONENT.sub(
        lambda found: " × 10" + (found[1].replace("+", "") + found[2]).translate(SUPERSCRIPT),
        str(value),
    )
    return text(MINUS.sub("−", shown))


def number(value, digits=4):
    """Formats a number with `digits` significant digits, an integer below 10 million with all digits, and a missing
    number as a dash."""
    value = number_or_none(value)
    if value is None:
        return ABSENT
    if isinstance(value, int) and abs(value) < 10**7:
        return str(value)
    short = f"{value:.{digits}g}"
    # Powers of ten are used only for numbers with many zeros.
    return typeset(format(Decimal(short), "f") if 1e-4 <= abs(value) < 1e7 else short)


def cell(value, sort_key=None, classes=""):
    """Returns a table cell from ready HTML. `sort_key` replaces the shown text when the table is sorted."""
    attributes = f' class="{classes}"' if classes else ""
    if sort_key is not None:
        attributes += f' data-sort="{text(sort_key)}"'
    return f"<td{attributes}>{value}</td>"


def known_number(value, tolerance, max_digits=3):
    """Formats a number with the digits that are significant at its tolerance, at most `max_digits`. If the tolerance is
    at least the magnitude of the number, returns a bound instead: "≤ 0.4", or "0 ± 0.4" for a negative number.
    """
    value = number_or_none(value)
    if value is not None and tolerance and tolerance >= abs(value):
        sign = "≤ " if value >= 0 else "0 ± "
        return sign + number(rounded_up(abs(value) + tolerance), 1)
    return number(value, deserved_digits(value, tolerance, max_digits))


def rounded_up(value):
    """Returns the smallest number with one significant digit that is at least `value`. Precondition: `value` is
    positive."""
    size = 10.0 ** math.floor(math.log10(value))
    return math.ceil(value / size * (1 - 1e-12)) * size


def number_cell(value, digits=4, tolerance=None):
    """Returns a table cell with a number, or with a dash if there is no number. `tolerance`: largest error of the
    number, in the unit of the number."""
    value = number_or_none(value)
    return cell(
        known_number(value, tolerance, digits), "" if value is None else json.dumps(value), "number"
    )


def heading_cell(title, numeric=False, unit=""):
    """Returns a heading cell of a table. The unit stands below the title."""
    below = f"<br><span class=unit>{text(unit)}</span>" if unit else ""
    return f'<th scope="col"{" class=number" if numeric else ""}>{title}{below}</th>'


def table(headings, rows, caption="", classes="", element_id=""):
    """Returns a table as HTML. `headings` and the elements of `rows` are cells as HTML. If the table is wider than the
    page, its frame scrolls. With the class "stack", each row is shown as a card on a narrow page, with the headings
    beside the cells."""
    identity = f' id="{element_id}"' if element_id else ""
    shown_caption = f"<caption>{caption}</caption>" if caption else ""
    shown_headings, shown_rows, role = "".join(headings), ["".join(row) for row in rows], ""
    if "stack" in classes.split():
        # The explicit role keeps the table a table for screen readers, although style sheets change its layout.
        role = ' role="table"'
        names = [
            text(" ".join(strip(heading.replace("<br>", " ")).split())) for heading in headings
        ]
        shown_headings = shown_headings.replace("<th ", '<th role="columnheader" ')
        shown_rows = [
            "".join(
                one.replace("<td", f'<td role="cell" data-label="{name}"', 1)
                for one, name in zip(row, names, strict=True)
            )
            for row in rows
        ]
    row_role = ' role="row"' if role else ""
    body = "\n".join(f"<tr{row_role}>{row}</tr>" for row in shown_rows)
    return (
        f'<div class="wide" tabindex="0" role="region" aria-label="{text(strip(caption) or "table")}">'
        f'<table class="{classes}"{identity}{role}>{shown_caption}<thead><tr{row_role}>{shown_headings}</tr></thead>\n'
        f"<tbody>\n{body}\n</tbody></table></div>"
    )


def folded(summary, content, classes=""):
    """Returns a folded section as HTML. It opens on a click, or if a link leads to an element in it."""
    attributes = f' class="{classes}"' if classes else ""
    return f"<details{attributes}><summary>{summary}</summary>{content}</details>"


def strip(markup):
    """Removes the tags from ready HTML, for labels."""
    return html.unescape(re.sub(r"<[^>]*>", "", markup))


def command(line):
    return f"<pre class=command><code>{text(line)}</code></pre>"


def embedded_json(value):
    """Returns JSON for a script element. The text cannot end the element, and it contains only valid JSON values."""
    packed = json.dumps(value, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
    return packed.replace("<", "\\u003c")


def in_colour(one, shown):
    """Returns `shown` (HTML) in the colours of a Look: one for a light and one for a dark background."""
    return f'<span class=run-name style="--light:{one.colour};--dark:{one.dark}">{shown}</span>'


def column(name, values=()):
    """Returns (title, unit, factor) of a column with this name and these values. The unit is empty for numbers without
    a unit."""
    if name.startswith(PER):
        return f"time of a {name.removeprefix(PER)}", "µs", 1e6
    if name in TITLES:
        return TITLES[name]
    ending = ending_of(name)
    title = (name.removesuffix("_" + ending) if ending else name).replace("_", " ")
    title, unit = re.sub(r"(?<=\d)(?=Hz\b)", " ", title), unit_of(name)
    sizes = [abs(value) for value in values if value]
    return (
        (title, "mm", 1e3)
        if unit == "m" and sizes and median(sizes) < SMALL_M
        else (title, unit, 1)
    )


def deserved_digits(value, tolerance, max_digits):
    """Returns the number of digits of a value that are significant at its tolerance: at least 1 and at most
    `max_digits`. Returns `max_digits` if the value or the tolerance is zero or missing."""
    if not value or not tolerance:
        return max_digits
    return max(
        1,
        min(max_digits, math.floor(math.log10(abs(value))) - math.floor(math.log10(tolerance)) + 1),
    )


def columns(names, rows, tolerances):
    """Returns (heading cells, cells of each row) of a table of numbers. `names`: names of the columns. `rows`: lists of
    numbers, None for a missing number. `tolerances`: largest errors of the numbers."""
    heads = [
        column(name, [v for v in values if v is not None])
        for name, values in zip(names, zip(*rows))
    ]
    return (
        [heading_cell(text(title), True, unit) for title, unit, _ in heads],
        [
            [
                number_cell(None if v is None else v * factor, 3, t and t * factor)
                for v, t, (_, _, factor) in zip(row, within, heads)
            ]
            for row, within in zip(rows, tolerances)
        ],
    )


def fill(file, values):
    """Returns the file's text with each {{name}} replaced by its value."""
    # A single pass does not replace text in a value that looks like a placeholder.
    return re.sub(
        r"\{\{(\w+)\}\}", lambda match: values[match[1]], file.read_text(encoding="utf-8")
    )


def listed(title, links):
    """Returns a paragraph with a title and links; empty if there are no links."""
    return f"<p class=links><b>{title}</b> {', '.join(links)}</p>" if links else ""
