"""HTML from values. Every text from outside goes through `text`."""
import html
import json

from .json_input import number_or_none

ABSENT = "–"


def text(value):
    return html.escape(str(value), quote=True)


def number(value, digits=4):
    """A number with so many significant digits, or a dash."""
    value = number_or_none(value)
    if value is None:
        return ABSENT
    if isinstance(value, int) and abs(value) < 10 ** 7:
        return str(value)
    # The Unicode minus is as wide as a plus and does not break the line.
    return f"{value:.{digits}g}".replace("-", "−")


def cell(value, sort_key=None, classes=""):
    """A table cell from ready HTML; sort_key overrides the shown text when the table is sorted."""
    attributes = f' class="{classes}"' if classes else ""
    if sort_key is not None:
        attributes += f' data-sort="{text(sort_key)}"'
    return f"<td{attributes}>{value}</td>"


def number_cell(value, digits=4):
    value = number_or_none(value)
    return cell(number(value, digits), "" if value is None else repr(value), "number")


def heading_cell(title, numeric=False):
    return f'<th scope="col"{" class=number" if numeric else ""}>{title}</th>'


def table(headings, rows, caption="", classes="", element_id=""):
    """Rows are lists of cells (ready HTML). The wrapper scrolls where the page is narrower than the table."""
    identity = f' id="{element_id}"' if element_id else ""
    shown_caption = f"<caption>{caption}</caption>" if caption else ""
    body = "\n".join(f"<tr>{''.join(row)}</tr>" for row in rows)
    return (f'<div class="wide" tabindex="0" role="region" aria-label="{text(strip(caption) or "table")}">'
            f'<table class="{classes}"{identity}>{shown_caption}<thead><tr>{"".join(headings)}</tr></thead>\n'
            f"<tbody>\n{body}\n</tbody></table></div>")


def strip(markup):
    """Ready HTML without its tags, for labels."""
    out, inside = [], False
    for c in html.unescape(markup):
        inside = c == "<" or (inside and c != ">")
        if not inside and c != ">":
            out.append(c)
    return "".join(out)


def command(line):
    return f"<pre class=command><code>{text(line)}</code></pre>"


def embedded_json(value):
    """JSON for a script element: it cannot end the element, nor hold what JSON does not know."""
    packed = json.dumps(value, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
    return packed.replace("<", "\\u003c")
