"""Hints at the name that was meant."""
import difflib


def nearest(name, names):
    """What ends a message about a name that is none, in the words of the program; nothing when none is near."""
    lower = {candidate.lower(): candidate for candidate in reversed(names)}
    # Half a name before one that merely looks alike.
    longer = sorted((n for n in lower if n.startswith(name.lower())), key=len) or [n for n in lower if name.lower() in n]
    close = longer or difflib.get_close_matches(name.lower(), lower, 1)
    return f"; nearest valid name: \"{lower[close[0]]}\"" if close else ""
