"""Pictures that manuals show below the commands that draw them."""
import re
import shlex

from .manuals import ROOT

FOLDER = ROOT / "results" / "reference" / "gallery"
PAGES = (ROOT / "README.md", ROOT / "scenarios" / "TUNING.md")
# Commands, the last of which plots, and below them the picture.
ILLUSTRATED = re.compile(r"((?:^    hapbench .*\n)+)\n!\[[^]]*\]\([^)]*/gallery/(\w+\.svg)\)", re.M)


def draw_all(program, scratch):
    pictures = [found for page in PAGES for found in ILLUSTRATED.findall(page.read_text(encoding="utf-8"))]
    for commands, picture in pictures:
        *runs, plot = (shlex.split(line, comments=True)[1:] for line in commands.splitlines())
        for words in runs:
            program.run([*words, "--quiet"], scratch)
        program.run([*plot, "--quiet", "--out", FOLDER / picture], scratch)
    print(f"drew {len(pictures)} pictures into {FOLDER.relative_to(ROOT)}")
