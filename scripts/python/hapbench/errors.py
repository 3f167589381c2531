"""Exceptions and warnings of the package."""
import re


def shown(value: object) -> str:
    """Returns the representation of a value that is not allowed, cut to 60 characters."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:59]}…"


class InputError(Exception):
    """Invalid input, such as a scenario, an argument or a file. The message is one line that states where the fault is
    and what is allowed."""

    def __str__(self):
        # The errors of the packages of the commands may have several faults: `lines` then has a text for each fault.
        return "; ".join(getattr(self, "lines", ())) or super().__str__()


class ResultError(InputError):
    """A result file is missing or cannot be parsed."""


class ScenarioError(InputError):
    """A scenario or an argument that the engine rejects. The message describes the first of `faults`.

    `file` is the scenario's file ("" for none), `pointer` the JSON pointer of the field ("" for the whole scenario),
    `problem` states what is wrong and what is allowed, and `nearest` is the valid name that is most similar to the
    given name, or None.
    """

    def __init__(self, faults):
        self.file, self.pointer, self.problem = faults[0]
        super().__init__(": ".join(part for part in faults[0] if part))
        found = re.search(r'nearest valid names?: "([^"]*)"', self.problem)
        self.nearest = found.group(1) if found else None
        self.faults = [self] + [ScenarioError([fault]) for fault in faults[1:]]


class ScenarioWarning(UserWarning):
    """A warning: the numbers of a run may mislead, or a field has no effect."""
