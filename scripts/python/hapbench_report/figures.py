"""Figures that figures.json lists. Each figure has a caption, and the claims and files to which it belongs."""
import base64
import re
from dataclasses import dataclass
from pathlib import Path

from hapbench.columns import read_bytes
from hapbench.errors import InputError
from hapbench.results import member, objects, read_json, shown

from .markup import command, folded, listed, text, typeset


@dataclass
class Figure:
    id: str
    title: str
    thesis_figure: str
    caption: str
    sources: list
    drawing: bytes  # contents of the SVG file

    @property
    def name(self):
        return (
            f"Fig. {self.thesis_figure.removeprefix('Fig. ')}"
            if self.thesis_figure
            else self.title or self.id
        )

    def is_about(self, claim):
        """Returns True if the place of the claim in the thesis names the figure, or if the figure draws a scenario that
        decides the claim."""
        named = " ".join(re.findall(r"Fig\. (?:[A-F]\.?)?\d+", str(claim.get("place", ""))))
        drawn = {Path(source).parent.name for source in self.sources}
        return bool(
            labels(named) & labels(self.thesis_figure)
            or drawn & set(map(str, claim.get("scenarios") or ()))
        )


def labels(thesis_figure):
    """Returns the numbers of figures without the letters of their panels: "7a–c, B.4" gives {"7", "B.4"}."""
    return {
        prefix + digits
        for prefix, digits in re.findall(
            r"(?<![A-Za-z0-9.])((?:[A-F]\.)?)(\d+)(?![0-9])",
            re.sub(r"\b([A-F])(?=\d)", r"\1.", thesis_figure),
        )
    }


def load_figures(directory: Path):
    file = directory / "figures.json"
    value = read_json(file)
    entries = objects(value if isinstance(value, dict) else {"figures": value}, "figures", file)
    return [figure(entry, i, file) for i, entry in enumerate(entries)]


def figure(entry, i, file):
    pointer = f"/figures/{i}"
    id_, title, caption = (
        member(entry, key, str, file, pointer, "") for key in ("id", "title", "caption")
    )
    sources, files = (member(entry, key, list, file, pointer, []) for key in ("sources", "files"))
    # Only the name is used, because the figure is in the folder of figures.json.
    drawing = next(
        (file.parent / Path(str(name)).name for name in files if str(name).endswith(".svg")), None
    )
    if drawing is None or not drawing.is_file():
        raise InputError(
            f"{file}: {pointer}/files: got {shown(files)}; allowed: an SVG file beside it"
        )
    return Figure(
        id_ or f"figure-{i + 1}",
        title,
        str(entry.get("thesis_figure") or ""),
        caption,
        list(map(str, sources)),
        read_bytes(drawing),
    )


def figures_section(figures, claims):
    if not figures:
        return '<p class="note">No figures were given (<code>--figures</code>).</p>'
    return (
        "<p>The figures are drawn from the results above. Red hollow marks are published numbers of the thesis. "
        "A click enlarges a figure. "
        "<span class=dark-only>On the dark page, black and white are exchanged; captions "
        "name the colours of the light page. </span>"
        "This command draws the figures again:</p>"
        f"{command('scripts/figures results/out/reproduce --out results/out/figures')}"
        f"<div class=figures>{''.join(figure_markup(figure, claims) for figure in figures)}</div>"
    )


def figure_markup(figure, claims):
    about = [claim_link(claim) for claim in claims if figure.is_about(claim)]
    files = "<br>".join(f"<code>{text(source)}</code>" for source in figure.sources)
    title, name = (
        text(figure.title or figure.id),
        f"{text(figure.name)}: " if figure.thesis_figure else "",
    )
    image = f"data:image/svg+xml;base64,{base64.b64encode(figure.drawing).decode()}"
    return (
        f'<figure id="figure-{text(figure.id)}"><h3>{name}{title}</h3>'
        f'<button type="button" class="enlarge" aria-label="Enlarge {title}"><img src="{image}" alt="{title}"></button>'
        f"<figcaption>{typeset(figure.caption)}</figcaption>{listed('Claims', about)}"
        + (folded("Files", f"<p>{files}</p>") if files else "")
        + "</figure>"
    )


def claim_link(claim):
    id_ = text(claim.get("id", ""))
    return f'<a href="#claim-{id_}">{id_}</a>'
