"""A command in a manual with what it printed, on which commit and machine."""
import shlex

from .program import ProgramError


def renewed(old, program, directory):
    """The block with the output of its first command."""
    line = next((line.strip() for line in old.splitlines() if line.strip().startswith("$ hapbench ")), None)
    if line is None:
        raise ProgramError("a session begins with an indented line: $ hapbench …")
    output = program.run(shlex.split(line)[2:], directory)
    shown = "\n".join(f"    {text}".rstrip() for text in [line, "", *output.strip("\n").splitlines()])
    return program.stamped(shown, old)
