"""Every figure, by captions.txt: its id, which figure of the thesis it redraws, the function that draws it, and what it shows."""
import re
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path

CAPTIONS = Path(__file__).parent / "captions.txt"
HEAD = re.compile(r"(\S+)\] (.+) · (\w+)\.(\w+)(?:\((\w+)\))? · (.+)")


@dataclass(frozen=True)
class Figure:
    """`draw(results)` returns the drawing and the values of its caption; it raises MissingResult when its data is not there."""

    id: str
    thesis: str  # empty for ours
    draw: partial
    title: str
    caption: str
    differs: str  # from the thesis's figure, and why
    rows: tuple  # claims that it draws, besides those whose place names the thesis's figure

    @property
    def stem(self):
        return "figure_" + self.id.replace("-", "_")


def entry(text, before):
    """A figure; without a caption it has that of the one before it."""
    head, *lines = text.strip().split("\n")
    id_, thesis, module, function, argument, title = HEAD.fullmatch(head).groups()
    text, _, rows = " ".join(lines).partition(" Rows: ")
    caption, _, differs = text.partition(" Differs: ")
    draw = partial(call, module, function, *([argument] if argument else []))
    return Figure(id_, thesis.removeprefix("-"), draw, title, caption or before.caption, differs, tuple(rows.rstrip(".").split()))


def call(module, function, *arguments_and_results):
    *arguments, results = arguments_and_results
    return getattr(import_module(f".{module}", __package__), function)(results, *arguments)


FIGURES = []
for text in CAPTIONS.read_text(encoding="utf-8").split("\n\n[")[1:]:
    FIGURES.append(entry(text, FIGURES[-1] if FIGURES else None))
