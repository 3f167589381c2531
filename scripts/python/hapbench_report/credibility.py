"""How far to believe a number: the page of scenarios/validation as a section."""
import posixpath
import re
from pathlib import Path

from .markup import heading_cell, table, text

PAGE = Path(__file__).resolve().parents[3] / "scenarios" / "validation" / "README.md"
INSIDE = {"thesis_claims/README.md": "ledger", "studies/README.md": "studies"}  # sections of the report, by the end of a path


def load_credibility(page=PAGE):
    """The page as Markdown; None without it, as in an installed tree."""
    return page.read_text(encoding="utf-8") if page.is_file() else None


def credibility_section(loaded):
    if loaded is None:
        return '<p class="note">No page of scenarios/validation in this tree.</p>'
    return "".join(block_of(part) for part in re.split(r"(?m)^(?=##+ )", loaded))


def block_of(part):
    """A heading with paragraphs, commands, lists and tables below it; the page's own title is the section's."""
    out = []
    for block in re.split(r"\n{2,}", part.strip()):
        lines = block.split("\n")
        if block.startswith("## "):
            out.append(f"<h3>{text(block[3:])}</h3>")
        elif block.startswith("    "):
            out.append("<pre>" + text("\n".join(line[4:] for line in lines)) + "</pre>")
        elif block.startswith("|"):
            head, _, *rows = ([inline(cell) for cell in re.split(r"(?<!\\)\|", line.strip("|"))] for line in lines)
            out.append(table([heading_cell(cell) for cell in head], [[f"<td>{cell}</td>" for cell in row] for row in rows], classes="stack"))
        elif block.startswith("- "):
            out.append("<ul>" + "".join(f"<li>{inline(' '.join(item.split()))}</li>" for item in re.split(r"(?m)^- ", block)[1:]) + "</ul>")
        elif not block.startswith("# "):
            out.append(f"<p>{inline(block)}</p>")
    return "".join(out)


def inline(markdown):
    """Code, bold and links; a link leads to the section of the report that shows the same, or names its file."""
    html = re.sub(r"`([^`]*)`", r"<code>\1</code>", text(markdown.strip()))
    html = re.sub(r"\*\*([^*]*)\*\*", r"<b>\1</b>", html)
    return re.sub(r"\[([^]]*)\]\(([^)]*)\)", linked, html)


def linked(found):
    shown, path = found[1], found[2].partition("#")[0]
    section = next((section for end, section in INSIDE.items() if path.endswith(end)), None)
    if section:
        return f'<a href="#{section}">{shown}</a>'
    return f"{shown} (<code class=file>{posixpath.normpath(f'scenarios/validation/{path}')}</code>)"
