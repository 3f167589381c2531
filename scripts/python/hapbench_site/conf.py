"""Sphinx's settings for the site."""
import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from hapbench_docs.manuals import anchor  # noqa: E402  (the path comes first)

project = html_title = "hapbench"
version = release = os.environ["HAPBENCH_SITE_VERSION"]
extensions = ["myst_parser"]
myst_heading_anchors = 6
myst_heading_slug_func = anchor
nitpicky = True
smartquotes = False
highlight_language = "none"
html_theme = "furo"
html_theme_options = {f"{theme}_css_variables": {"color-brand-primary": colour, "color-brand-content": colour}
                      for theme, colour in (("light", "#0a5c8f"), ("dark", "#7cc0ee"))}
html_static_path = [str(Path(__file__).parent / "static")]
html_css_files = ["hapbench.css"]
html_copy_source = html_show_sourcelink = html_show_sphinx = html_show_copyright = False
pygments_style, pygments_dark_style = "tango", "monokai"


def setup(app):
    """Kinds of things that the search finds by their names."""
    for kind in ("command", "field", "metric", "algorithm", "model", "scenario"):
        app.add_object_type(kind, kind)
    app.add_object_type("cpp-name", "cpp-name", objname="C++")
    app.add_object_type("python-name", "python-name", objname="Python")
