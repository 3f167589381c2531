"""What the terminal can show: its width, its characters, its colours."""
import locale
import os
import shutil
import sys
from dataclasses import dataclass

WIDEST = 100


@dataclass(frozen=True)
class Terminal:
    width: int
    unicode: bool
    colour: bool


def this_terminal():
    width = min(WIDEST, shutil.get_terminal_size((WIDEST, 24)).columns)
    return Terminal(max(40, width), knows_unicode(),
                    sys.stdout.isatty() and "NO_COLOR" not in os.environ and os.environ.get("TERM") != "dumb")


def knows_unicode():
    """Of the user's locale. Python's own encoding does not tell: it takes UTF-8 where the locale has none."""
    try:
        locale.setlocale(locale.LC_CTYPE, "")
    except locale.Error:
        return False
    return locale.nl_langinfo(locale.CODESET).replace("-", "").upper() == "UTF8"


def coloured(text, colour):
    """The text in a colour given as #rrggbb. Nearly black and nearly white stay as the terminal has its text."""
    rgb = [int(colour[i:i + 2], 16) for i in (1, 3, 5)]
    if max(rgb) < 70 or min(rgb) > 200:
        return text
    return f"\x1b[38;2;{rgb[0]};{rgb[1]};{rgb[2]}m{text}\x1b[0m"
