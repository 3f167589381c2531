"""Every figure with its caption, the claims and runs it belongs to, and how to draw it again."""
from .links import figure_name, listed
from .markup import command, folded, text, typeset


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
