"""Reads the units of columns from lines of a header, and from comments."""
import re

from .columns import UNITS, without_unit


def with_units(names, units):
    """Returns the names with units in square brackets. `units`: one text for each name, or an empty list."""
    if not units:
        return names
    return [f"{name} [{unit}]".lstrip() if unit else name for name, unit in zip(names, units)]


def are_distinct(names):
    """Returns True if no name occurs twice. Several columns may have an empty name."""
    named = [name for name in names if name]
    return len(set(named)) == len(named)


def units_of(words):
    """Returns the units in a line of the header if the line has only units; "" for a column without a unit. Returns an
    empty list if a word is not a unit, or if no column has a unit."""
    words = [word.strip("[](){}<>") for word in words]
    is_unit = [
        word in ("", "-") or any(word in known for known in UNITS.values()) for word in words
    ]
    if not all(is_unit) or not any(word not in ("", "-") for word in words):
        return []
    return ["" if word == "-" else word for word in words]


def names_and_units(headers, notes):
    """Returns (names of the columns, line numbers of the header). `headers`: lines that can be a header, the last line
    first. A line of units below the names gives the units of the columns. Without names, the names have only units.
    """
    if not headers:
        return [], []
    number, words = headers[0]
    units = units_of(words)
    if not units and (are_distinct(words) or len(headers) < 2 or not are_distinct(headers[1][1])):
        return words, [number]
    above = headers[1] if len(headers) > 1 and not units_of(headers[1][1]) else None
    notes.append(
        f"line {number} has the units of the columns"
        if units
        else f"line {number} is read as the units of the columns"
    )
    if above is None:
        return with_units([""] * len(units), units), [number]
    return with_units(above[1], units or words), [number, above[0]]


def with_commented_units(names, headers, notes):
    """Returns (names with units, line numbers of the units). `headers`: comments that can be a line of a header. The
    units come from the last comment with nothing but units, unless one of the names already has a unit.
    """
    number, units = next(
        ((number, units) for number, words in headers if (units := units_of(words))), (None, [])
    )
    if not units or len(units) != len(names) or any(without_unit(name)[1] for name in names):
        return names, []
    notes.append(f"line {number} has the units of the columns")
    return with_units(names, units), [number]


def stated_units(comments):
    """Returns (line number, unit) of each unit in comments such as "# units: mm" and "# x, y, z in mm"."""
    found = []
    for number, comment in comments:
        text = comment.decode("utf-8", "replace")
        of_units = re.search(r"(?i)\bunits?\b(.*)", text)
        words = re.split(r"[^\w°]+", of_units[1]) if of_units else []
        words += re.findall(r"(?:\bin |[\[({<=])\s*([^\W\d_]+)", text)
        known = (word for word in words if any(word in units for units in UNITS.values()))
        found += [(number, word) for word in dict.fromkeys(known) if word != "in"]
    return found
