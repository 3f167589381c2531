"""The manuals: where they are, the commands they document, their links."""
import re
import shlex
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
NOT_OURS = ("build", "results/out")
COMMAND = re.compile(r"^\s*(?:\$ )?((?:build/\S+/hapbench|hapbench|scripts/[a-z]+)(?:\s.*)?)$")
LINK = re.compile(r"\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#{1,6} (.+)$", re.M)
# Words that end a command of the shell.
ENDS = re.compile(r"^(?:\||&&|;|\d?>.*|<.*)$")


def manuals():
    """Every Markdown file of the tree."""
    for file in sorted(ROOT.rglob("*.md")):
        where = file.relative_to(ROOT)
        hidden = any(part.startswith(".") for part in where.parts)
        if not hidden and not any(where.is_relative_to(folder) for folder in NOT_OURS):
            yield file


@dataclass(frozen=True)
class Command:
    manual: Path
    line: int
    words: tuple  # without comments, redirections and pipes

    def __str__(self):
        return f"{self.manual.relative_to(ROOT)}:{self.line}: {' '.join(self.words)}"


class Manual:
    def __init__(self, file):
        self.file = Path(file)
        self.text = self.file.read_text(encoding="utf-8")

    def code(self):
        """Number and text of the lines in fences, or indented by four and more."""
        fenced = False
        for number, line in enumerate(self.text.splitlines(), 1):
            if line.lstrip().startswith("```"):
                fenced = not fenced
            elif fenced or line.startswith("    "):
                yield number, line

    def commands(self):
        """The commands that begin with hapbench, build/…/hapbench or scripts/…; a backslash at the end joins the next line."""
        lines = list(self.code())
        while lines:
            number, line = lines.pop(0)
            while line.endswith("\\") and lines:
                line = line[:-1] + lines.pop(0)[1].strip()
            found = COMMAND.match(line)
            if found:
                words = shlex.split(found[1], comments=True)
                end = next((i for i, word in enumerate(words) if ENDS.match(word)), len(words))
                yield Command(self.file, number, tuple(words[:end]))

    def anchors(self):
        """Anchors of its headings, as GitHub makes them."""
        return {re.sub(r"[^\w\- ]", "", title.strip().lower()).replace(" ", "-") for title in HEADING.findall(self.text)}


def broken_links(manual):
    """Relative links that lead nowhere."""
    for link in LINK.findall(manual.text):
        if re.match(r"^[a-z]+:", link):
            continue
        path, _, fragment = link.partition("#")
        target = (manual.file.parent / path) if path else manual.file
        if not target.exists() or fragment and target.suffix == ".md" and fragment not in Manual(target).anchors():
            yield link
