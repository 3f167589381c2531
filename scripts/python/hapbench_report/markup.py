"""HTML from values. Every text from outside goes through `text`."""
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
PER = "seconds_per_"  # time of a step or of a call
SMALL_M = 0.01  # lengths below are shown in millimetres
# Title, unit and factor of the metrics of the program's tables, with the words of its headings (kRunHeadings).
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
    """A name as text that may go on in another line behind an underscore or a slash, and nowhere within a word."""
    return re.sub(r"([_/])(?=\w)", r"\1<wbr>", text(value))


# A number's exponent, or the minus before a number that begins a word.
EXPONENT = re.compile(r"(?<=\d)e([+-]?)0*(\d+)\b")
MINUS = re.compile(r"(?<![\w.)])-(?=\d)")
SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def typeset(value):
    """Text whose numbers are set as printers do: "-1.2e-07" as "−1.2 × 10⁻⁷"."""
    shown = EXPONENT.sub(
        lambda found: " × 10" + (found[1].replace("+", "") + found[2]).translate(SUPERSCRIPT),
        str(value),
    )
    return text(MINUS.sub("−", shown))


def number(value, digits=4):
    """A number with so many significant digits, or a dash."""
    value = number_or_none(value)
    if value is None:
        return ABSENT
    if isinstance(value, int) and abs(value) < 10**7:
        return str(value)
    short = f"{value:.{digits}g}"
    # Powers of ten only where the zeros would have to be counted.
    return typeset(format(Decimal(short), "f") if 1e-4 <= abs(value) < 1e7 else short)


def cell(value, sort_key=None, classes=""):
    """A table cell from ready HTML; sort_key overrides the shown text when the table is sorted."""
    attributes = f' class="{classes}"' if classes else ""
    if sort_key is not None:
        attributes += f' data-sort="{text(sort_key)}"'
    return f"<td{attributes}>{value}</td>"


def known_number(value, tolerance, most=3):
    """A number with the digits that its tolerance leaves, at most `most`. Where the tolerance is not smaller than the
    number, only the bound is known: "≤ 0.4"."""
    value = number_or_none(value)
    if value is not None and tolerance and tolerance >= abs(value):
        sign = "≤ " if value >= 0 else "0 ± "
        return sign + number(rounded_up(abs(value) + tolerance), 1)
    return number(value, deserved_digits(value, tolerance, most))


def rounded_up(value):
    """The smallest number with one significant digit that is not below a positive value."""
    size = 10.0 ** math.floor(math.log10(value))
    return math.ceil(value / size * (1 - 1e-12)) * size


def number_cell(value, digits=4, tolerance=None):
    """`tolerance`: by how much the number may be wrong, in its unit."""
    value = number_or_none(value)
    return cell(
        known_number(value, tolerance, digits), "" if value is None else json.dumps(value), "number"
    )


def heading_cell(title, numeric=False, unit=""):
    """The unit stands below the title."""
    below = f"<br><span class=unit>{text(unit)}</span>" if unit else ""
    return f'<th scope="col"{" class=number" if numeric else ""}>{title}{below}</th>'


def table(headings, rows, caption="", classes="", element_id=""):
    """Rows are lists of cells (ready HTML). The wrapper scrolls where the page is narrower than the
    table; with the class "stack" each row becomes a card there instead, its cells named by their
    headings."""
    identity = f' id="{element_id}"' if element_id else ""
    shown_caption = f"<caption>{caption}</caption>" if caption else ""
    shown_headings, shown_rows, role = "".join(headings), ["".join(row) for row in rows], ""
    if "stack" in classes.split():
        # A table that is laid out otherwise stays one to those who hear it.
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
    """Ready HTML that opens at a click, and when a link leads into it."""
    attributes = f' class="{classes}"' if classes else ""
    return f"<details{attributes}><summary>{summary}</summary>{content}</details>"


def strip(markup):
    """Ready HTML without its tags, for labels."""
    return html.unescape(re.sub(r"<[^>]*>", "", markup))


def command(line):
    return f"<pre class=command><code>{text(line)}</code></pre>"


def embedded_json(value):
    """JSON for a script element: it cannot end the element, nor hold what JSON does not know."""
    packed = json.dumps(value, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
    return packed.replace("<", "\\u003c")


def in_colour(one, shown):
    """Ready HTML in the colour of a look, on light and on dark ground."""
    return f'<span class=run-name style="--light:{one.colour};--dark:{one.dark}">{shown}</span>'


def column(name, values=()):
    """Title, unit (empty for numbers without one) and factor of a column with these numbers, by its name."""
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


def deserved_digits(value, tolerance, most):
    """How many of `most` significant digits a tolerance leaves a number, one at least."""
    if not value or not tolerance:
        return most
    return max(
        1, min(most, math.floor(math.log10(abs(value))) - math.floor(math.log10(tolerance)) + 1)
    )


def columns(names, rows, tolerances):
    """Heading cells of numbers, and for each row its cells; `rows`: lists of numbers or None, of
    these names, `tolerances`: of them."""
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
    """The file's text with values in the places of {{name}}."""
    # In one pass, so that a value which looks like a placeholder stays what it is.
    return re.sub(
        r"\{\{(\w+)\}\}", lambda match: values[match[1]], file.read_text(encoding="utf-8")
    )


def listed(title, links):
    """A line of links; nothing where there are none."""
    return f"<p class=links><b>{title}</b> {', '.join(links)}</p>" if links else ""
