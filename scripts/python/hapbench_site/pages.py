"""The manuals as pages of the site: the same tree, in which a README is its folder's index and a link to a source file one to
a page that shows it."""
import os
import re
import shutil
from pathlib import PurePosixPath

from hapbench_command import write
from hapbench_docs.manuals import LINK, ROOT, manuals

TUTORIALS = ROOT / "scenarios" / "tutorials"
PICTURES = {".svg", ".png"}
LANGUAGES = {".c": "c", ".h": "c", ".cpp": "cpp", ".hpp": "cpp", ".json": "json", ".py": "python", ".cmake": "cmake"}
# Of records that the program writes without a heading.
TITLES = {"claims": "Claims: the ledger", "choices": "Choices on record", "robustness": "Robustness of the verdicts"}
# Caption of the side bar: the pages below it, by name; the rest of the manuals follows by itself.
START = ("scenarios/tutorials/index", "scenarios/TUNING", "scenarios/GALLERY", "live", "scenarios/GLOSSARY")
MANUALS = ("scenarios/index", "algorithms/index", "device_model/index", "results/index", "sim/index", "scenarios/batch/index",
           "scenarios/studies/index", "scenarios/thesis_claims/index", "scenarios/validation/index",
           "scripts/python/index", "tests/index")
REFERENCE = ("reference/commands", "reference/fields", "reference/metrics", "reference/algorithms", "reference/models",
             "reference/scenarios", "reference/cpp", "reference/python")


class SiteError(Exception):
    """Something of the site does not hold: a link, a warning of Sphinx, a cell of a tutorial."""


def page_of(file):
    """Name of the page of a manual: its path without suffix, a README's that of its folder's index."""
    where = file.relative_to(ROOT).with_suffix("")
    return str(where.with_name("index") if where.name == "README" else where)


class Mirror:
    """The folder from which Sphinx makes the site."""

    def __init__(self, folder):
        self.folder = folder
        self.pages = {file: page_of(file) for file in manuals()}
        self._shown = set()

    def add(self, page, text):
        write(self.folder / f"{page}.md", text)

    def add_manuals(self):
        for file, page in self.pages.items():
            if not file.is_relative_to(TUTORIALS):
                text = self.linked(file.read_text(encoding="utf-8"), file)
                self.add(page, text if re.search(r"^# ", text, re.M) else f"# {TITLES.get(file.stem, file.stem)}\n\n{text}")
        self.add("index", (self.folder / "index.md").read_text(encoding="utf-8") + "\n" + self._contents())

    def linked(self, text, file, page=None):
        """The text of a manual with links that lead from its page to others; brings along what they lead to."""
        here = PurePosixPath(page or self.pages[file]).parent
        return LINK.sub(lambda found: f"]({self._link(found[1], file, here)})", text)

    def _link(self, link, file, here):
        path, _, anchor = link.partition("#")
        if re.match(r"^[a-z]+:", link) or not path:
            return link
        target = (file.parent / path).resolve()
        if target.is_dir():
            target /= "README.md"
        if not target.exists():
            raise SiteError(f"{file.relative_to(ROOT)}: its link {link} leads nowhere")
        if target in self.pages:
            page = f"{self.pages[target]}.md"
        elif target.suffix in PICTURES:
            page = str(target.relative_to(ROOT))
            self._copy(target, page)
        else:
            page = f"source/{target.relative_to(ROOT)}.md"
            self._show(target)
        return os.path.relpath(page, here) + (f"#{anchor}" if anchor else "")

    def _copy(self, file, where):
        to = self.folder / where
        to.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, to)

    def _show(self, file):
        """A page with a source file."""
        name = str(file.relative_to(ROOT))
        if name in self._shown:
            return
        self._shown.add(name)
        self._copy(file, f"source/{name}")
        self.add(f"source/{name}", f"---\norphan: true\nnosearch: true\n---\n\n# {name}\n\n```{{literalinclude}} {file.name}\n"
                                   f":language: {LANGUAGES.get(file.suffix, 'text')}\n```\n")

    def _contents(self):
        tutorials = {page for file, page in self.pages.items() if file.is_relative_to(TUTORIALS)}
        named = {"index", *START, *MANUALS, *tutorials}
        rest = sorted(page for page in self.pages.values() if page not in named)
        readmes = [page for page in rest if page.endswith("/index")]
        groups = {"Start": START, "Manuals": (*MANUALS, *readmes), "Reference": REFERENCE, "Record": [page for page in rest if page not in readmes]}
        return "\n".join(contents(pages, caption) for caption, pages in groups.items())


def contents(pages, caption="", hidden=True):
    options = (f":caption: {caption}\n" if caption else "") + (":hidden:\n" if hidden else "") + ":maxdepth: 1\n"
    return "```{toctree}\n" + options + "\n" + "".join(f"/{page}\n" for page in pages) + "```\n"
