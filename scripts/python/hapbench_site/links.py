"""Checks of the built site: every link leads to a file and to a place in it."""
from html.parser import HTMLParser
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """What a page refers to, and the places in it."""

    def __init__(self, file):
        super().__init__()
        self.links, self.places = [], {"", "top"}
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.places.update(filter(None, (given.get("id"), given.get("name") if tag == "a" else None)))
        self.links += filter(None, (given.get("href"), given.get("src"), given.get("data") if tag == "object" else None))


def broken(site, own=lambda file: True):
    """(page, link) that lead nowhere; `own(file)`: whether the links of a page are checked."""
    pages = {file.resolve(): Page(file) for file in sorted(site.rglob("*.html"))}
    for file, page in pages.items():
        for link in page.links if own(file) else ():
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            if not target.is_file() or target in pages and unquote(parts.fragment) not in pages[target].places:
                yield file.relative_to(site.resolve()), link
