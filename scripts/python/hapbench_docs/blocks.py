"""Generated parts of a manual: what stands between `<!-- generated: NAME -->` and `<!-- /generated -->`."""
import re
import shlex

from .program import ProgramError

BLOCK = re.compile(r"(<!-- generated: (\S+)[^\n]*-->\n)(.*?)(<!-- /generated -->)", re.S)
BEGIN = "<!-- generated:"


class BlockError(Exception):
    """A block that nobody makes, or that has no end."""


def renewed(text, makers):
    """The text with each block made anew by `makers[NAME](old)`; blocks without a maker stay."""
    if text.count(BEGIN) != len(BLOCK.findall(text)):
        raise BlockError('a block that begins with "<!-- generated: NAME -->" lacks its end "<!-- /generated -->"')

    def replaced(found):
        head, name, old, tail = found.groups()
        return f"{head}\n{makers[name](old).strip(chr(10))}\n\n{tail}" if name in makers else found[0]

    return BLOCK.sub(replaced, text)


def session(old, program, directory):
    """A command in a manual with what it printed, on which commit and machine: the block with the output of its first command."""
    line = next((line.strip() for line in old.splitlines() if line.strip().startswith("$ hapbench ")), None)
    if line is None:
        raise ProgramError("a session begins with an indented line: $ hapbench …")
    output = program.run(shlex.split(line)[2:], directory)
    shown = "\n".join(f"    {text}".rstrip() for text in [line, "", *output.strip("\n").splitlines()])
    return program.stamped(shown, old)
