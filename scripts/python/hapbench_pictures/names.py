"""Hints at the name that was meant."""
import difflib


def nearest(name, names):
    """ "; did you mean "x"" when one of the names is near, else nothing."""
    lower = {candidate.lower(): candidate for candidate in names}
    close = difflib.get_close_matches(name.lower(), lower, 1) or [n for n in lower if name.lower() in n][:1]
    return f"; did you mean \"{lower[close[0]]}\"" if close else ""
