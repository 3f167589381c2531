"""Every figure with its caption, and how to draw it again."""
from .markup import command, text


def figures_section(figures):
    if not figures:
        return '<p class="note">No figures were given (<code>--figures</code>).</p>'
    shown = "\n".join(figure_markup(figure) for figure in figures)
    return ("<p>Redrawn from the results above, published numbers as marks where the thesis gives them. To draw them "
            f"again:</p>{command('scripts/figures results/out/reproduce --out results/out/figures')}<div class=figures>{shown}</div>")


def figure_markup(figure):
    place = f"Fig. {figure.thesis_figure.removeprefix('Fig. ')}: " if figure.thesis_figure else ""
    files = "<br>".join(f"<code>{text(source)}</code>" for source in figure.sources)
    sources = f"<details><summary>Data</summary>{files}</details>" if files else ""
    return (f'<figure id="figure-{text(figure.id)}"><h3>{text(place)}{text(figure.title)}</h3>'
            f'<img src="{figure.data_uri()}" alt="{text(figure.title or figure.id)}">'
            f"<figcaption>{text(figure.caption)}</figcaption>{sources}</figure>")
