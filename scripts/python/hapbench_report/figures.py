"""The drawn figures: figures.json tells what they show; each with its caption, the claims and runs it belongs to, and how to
draw it again."""
import base64
from dataclasses import dataclass
from pathlib import Path

from .json_input import InputError, load_json, member, objects, shown
from .links import figure_name
from .markup import command, folded, listed, text, typeset

MEDIA_TYPES = {".svg": "image/svg+xml", ".png": "image/png"}
# A vector drawing is preferred up to this size; beyond it the picture, if that is smaller. Forty figures must fit.
LARGEST_SVG_BYTES = 250_000


@dataclass
class Figure:
    id: str
    title: str
    thesis_figure: str
    caption: str
    sources: list
    file: Path

    def data_uri(self):
        media = MEDIA_TYPES[self.file.suffix]
        try:
            data = self.file.read_bytes()
        except OSError as error:
            raise InputError(f"{self.file}: cannot be read: {error}") from error
        return f"data:{media};base64,{base64.b64encode(data).decode()}"


def load_figures(directory: Path):
    file = directory / "figures.json"
    value = load_json(file)
    entries = objects(value if isinstance(value, dict) else {"figures": value}, "figures", file)
    return [figure(entry, i, file) for i, entry in enumerate(entries)]


def figure(entry, i, file):
    place = f"/figures/{i}"
    text = {key: member(entry, key, str, file, place, "") for key in ("id", "title", "caption")}
    # A figure of our own has none.
    thesis_figure = entry.get("thesis_figure") or entry.get("thesis figure") or ""
    sources = entry.get("sources") or []
    return Figure(text["id"] or f"figure-{i + 1}", text["title"], str(thesis_figure), text["caption"],
                  [str(source) for source in (sources if isinstance(sources, list) else [sources])],
                  chosen_file(entry.get("files"), file, place))


def chosen_file(files, file, place):
    names = list(files.values()) if isinstance(files, dict) else files if isinstance(files, list) else [files]
    known = {}
    for name in names:
        if isinstance(name, str) and Path(name).suffix in MEDIA_TYPES:
            # Only the name: a figure lies beside its list.
            known[Path(name).suffix] = file.parent / Path(name).name
    present = {suffix: path for suffix, path in known.items() if path.is_file()}
    if not present:
        raise InputError(f"{file}: {place}/files: got {shown(files)}; allowed: an SVG or PNG file beside it")
    if ".svg" in present and (".png" not in present or present[".svg"].stat().st_size <= LARGEST_SVG_BYTES):
        return present[".svg"]
    return min(present.values(), key=lambda path: path.stat().st_size)


def figures_section(figures, links):
    if not figures:
        return '<p class="note">No figures were given (<code>--figures</code>).</p>'
    shown = "\n".join(figure_markup(figure, links) for figure in figures)
    return ("<p>Redrawn from the results above, published numbers as red hollow marks where the thesis gives them. A click "
            "enlarges a figure. <span class=dark-only>On the dark page black and white have changed places; captions name the colours "
            "of the light one. </span>To draw them "
            f"again:</p>{command('scripts/figures results/out/reproduce --out results/out/figures')}<div class=figures>{shown}</div>")


def figure_markup(figure, links):
    name = f"{figure_name(figure)}: " if figure.thesis_figure else ""
    claims, runs = links.of_figure(figure)
    files = "<br>".join(links.of_source(source) for source in figure.sources)
    data = listed("Runs", runs) + (f"<p><b>Files</b><br>{files}</p>" if files else "")
    title = text(figure.title or figure.id)
    return (f'<figure id="figure-{text(figure.id)}"><h3>{text(name)}{title}</h3>'
            f'<button type="button" class="enlarge" aria-label="Enlarge {title}">'
            f'<img src="{figure.data_uri()}" alt="{title}"></button>'
            f"<figcaption>{typeset(figure.caption)}</figcaption>{listed('Claims', claims)}"
            + (folded("Runs and files", data) if data else "") + "</figure>")
