"""Curves in a terminal: dots of braille where it knows them, else a letter for each run."""
import locale
import os
import shutil
import sys
from dataclasses import dataclass, replace

import numpy as np

from hapbench_style import reduced

from .panels import LARGEST_RATIO
from .quantities import range_of

HEIGHT, MARGIN = 6, 10  # characters of a panel, and of the numbers left of it
BRAILLE = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))  # bits of the dots, by row and column
LETTERS = "abcdefghijklmnopqrstuvwxyz"
SEVERAL = "+"  # where letters would hide each other
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
    """Whether the user's locale is UTF-8. Python's own encoding does not tell: it is UTF-8 where the locale has none."""
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


class Canvas:
    """Characters of which each holds 2 x 4 dots, or one letter."""

    def __init__(self, width, height, terminal, letters):
        # Without colour a dot does not tell whose it is.
        self.terminal, self.letters = terminal, letters or not terminal.unicode
        self.across, self.down = (1, 1) if self.letters else (2, 4)
        self.width, self.height = width, height
        self.dots = np.zeros((height, width), int)
        self.owner = np.full((height, width), -1)
        self.shared = np.zeros((height, width), bool)

    @property
    def columns(self):
        return self.width * self.across

    @property
    def rows(self):
        return self.height * self.down

    def column(self, i, low, high, owner):
        """Dots from one row to another, counted from below, in column i."""
        for row in range(min(low, high), max(low, high) + 1):
            y, x = self.height - 1 - row // self.down, i // self.across
            self.shared[y, x] |= self.owner[y, x] not in (-1, owner)
            self.owner[y, x] = owner
            self.dots[y, x] |= 1 if self.letters else BRAILLE[self.down - 1 - row % self.down][i % self.across]

    def line(self, y, looks):
        return "".join(self.character(y, x, looks) for x in range(self.width)).rstrip()

    def character(self, y, x, looks):
        owner = self.owner[y, x]
        if owner < 0:
            return " "
        if self.letters and self.shared[y, x]:
            return SEVERAL
        one = LETTERS[owner % 26] if self.letters and len(looks) > 1 else "*" if self.letters else chr(0x2800 + self.dots[y, x])
        return coloured(one, looks[owner].colour) if self.terminal.colour else one


def sketch(quantities, samples, looks, terminal):
    """The lines to print. Runs that differ in the seed only are drawn as one."""
    groups = list(dict.fromkeys(one.group or one.label for one in looks))
    owners = [groups.index(one.group or one.label) for one in looks]
    shown = [replace(looks[owners.index(i)], label=name) for i, name in enumerate(groups)]
    several = len(shown) > 1
    letters = several and not terminal.colour
    lines = [legend(shown, terminal, letters or not terminal.unicode), ""] if several else []
    begin, end = (extreme(float(s.trajectory["time_s"][i]) for s in samples) for extreme, i in ((min, 0), (max, -1)))
    if begin < 0.02 * end:
        begin = 0.0
    for quantity in quantities:
        canvas = Canvas(terminal.width - MARGIN, HEIGHT, terminal, letters)
        series = [(i, of) for i, of in zip(owners, (s.of(quantity) for s in samples)) if of is not None]
        scale = Scale([of for _, of in series], range_of(quantity, samples))
        for i, (time, low, high) in series:
            draw(canvas, i, time, scale(low), scale(high), begin, end)
        lines += panel(quantity, canvas, scale, shown, series)
    return lines + time_axis(begin, end, terminal.width, [s.first_touch_s for s in samples])


class Scale:
    """From numbers to 0 ... 1; beyond the calmest run's peak logarithmic where another run is thrown about, else cut off at
    `shown`, where given."""

    def __init__(self, series, shown=None):
        peaks = [peak for peak in (float(np.nanmax(np.abs(of[2]), initial=0.0)) for of in series) if peak > 0]
        self.unit = min(peaks) if peaks and max(peaks) > LARGEST_RATIO * min(peaks) else None
        # A column of nothing but NaN has no bounds.
        self.low = float(np.nanmin([np.nanmin(of[1], initial=np.inf) for of in series]))
        self.high = float(np.nanmax([np.nanmax(of[2], initial=-np.inf) for of in series]))
        if not self.low <= self.high:
            self.low = self.high = 0.0
        self.most, self.cut_off = self.high, shown is not None and self.unit is None
        if self.cut_off:
            self.low, self.high = shown

    def bent(self, values):
        return values if self.unit is None else np.arcsinh(np.asarray(values) / self.unit)

    def __call__(self, values):
        low, high = self.bent(self.low), self.bent(self.high)
        if self.cut_off:
            values = np.clip(values, self.low, self.high)
        return (self.bent(values) - low) / (high - low) if high > low else np.where(np.isnan(values), np.nan, 0.5)


def draw(canvas, owner, time, low, high, begin, end):
    start, columns, last = float(time[0]), canvas.columns, canvas.rows - 1
    span = max(end - begin, 1e-300)
    mine = max(1, int(round(columns * min(1.0, (time[-1] - start) / span))))
    if len(time) <= 2 * mine:
        # Fewer rows than columns: each column takes the row before it.
        rows = np.searchsorted(time, np.linspace(start, time[-1], mine), side="right") - 1
        low, high, at = low[rows], high[rows], np.arange(mine)
    else:
        t, low, high = reduced(time, low, high, mine)
        at = np.minimum((columns * (t - start) / span).round().astype(int), columns - 1)
    before = None
    for i, least, most in zip(at, low, high):
        if np.isnan(least):
            before = None
            continue
        bottom, top = int(round(least * last)), int(round(most * last))
        # A curve that jumps between two columns stays one curve.
        if before is not None and low is not high and (bottom > before[1] or top < before[0]):
            canvas.column(i, before[1] if bottom > before[1] else before[0], bottom, owner)
        canvas.column(i, bottom, top, owner)
        before = bottom, top


def panel(quantity, canvas, scale, looks, series):
    title = quantity.axis + (" (logarithmic above)" if scale.unit else "")
    peak = max(series, key=lambda entry: np.nanmax(entry[1][2], initial=-np.inf))
    time, values = peak[1][0], peak[1][2]
    if np.isfinite(values).any():
        whose = f" by {looks[peak[0]].label}" if len(looks) > 1 else ""
        title += f", most {scale.most:.4g} at {time[np.nanargmax(values)]:.4g} s{whose}{' (cut off)' if scale.cut_off else ''}"
    labels = {0: f"{scale.high:.4g}", canvas.height - 1: f"{scale.low:.4g}"}
    return [title, *(f"{labels.get(y, ''):>{MARGIN - 2}} |{canvas.line(y, looks)}" for y in range(canvas.height)), ""]


def legend(looks, terminal, letters):
    entries = []
    for i, one in enumerate(looks):
        mark = LETTERS[i % 26] if letters else "\u2588\u2588"
        entries.append(f"{coloured(mark, one.colour) if terminal.colour else mark} {one.label}")
    widths = [len(one.label) + 5 for one in looks]
    if letters:
        entries.append(f"{SEVERAL} several")
        widths.append(len("several") + 5)
    return "\n".join(wrapped(entries, widths, terminal.width))


def wrapped(entries, widths, width):
    lines, used = [[]], 0
    for entry, wide in zip(entries, widths):
        if used + wide > width and lines[-1]:
            lines.append([])
            used = 0
        lines[-1].append(entry)
        used += wide
    return ["   ".join(line) for line in lines]


def time_axis(begin, end, width, touches):
    """Begin, end, and below them where runs first touched."""
    first = f"{begin:.4g}"
    axis = " " * (MARGIN - 1) + first + f"{end:.4g} s".rjust(width - MARGIN - len(first) + 1)
    at = sorted({touch for touch in touches if touch is not None})
    if not at:
        return [axis, *([] if begin else [f"{'':{MARGIN}}no contact"])]
    room = width - MARGIN
    marks = [" "] * room
    for touch in at:
        marks[min(room - 1, int((touch - begin) / (end - begin) * room) if end > begin else 0)] = "^"
    first = f"first touch at {at[0]:.4g} s" + (f" ... {at[-1]:.4g} s" if len(at) > 1 else "")
    return [axis, " " * MARGIN + "".join(marks).rstrip(), " " * MARGIN + first]
