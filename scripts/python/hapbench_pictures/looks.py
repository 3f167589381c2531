"""How runs are drawn: the colour of their algorithm, and a line style where two runs share one."""
from dataclasses import dataclass

from matplotlib import colors

from hapbench_figures.style import look

LINES = ("-", (0, (4, 1.5)), (0, (1, 1)), (0, (4, 1, 1, 1)))
INK = {False: "#1d2126", True: "#e7e9ea"}
PAPER = {False: "#ffffff", True: "#1c2024"}
FAINT = {False: "#d8dadc", True: "#383e44"}
MUTED = {False: "#5b636c", True: "#a3abb3"}


@dataclass(frozen=True)
class RunLook:
    label: str
    colour: str
    line: object


def looks(runs, labels, dark=False):
    """One look for each run. In a single algorithm's runs only the line styles, or else the colours of other
    algorithms, could tell them apart: the styles do, as a colour stands for an algorithm everywhere."""
    seen, found = {}, []
    for run, label in zip(runs, labels):
        nth = seen[run.algorithm] = seen.get(run.algorithm, -1) + 1
        own = look(run.algorithm)
        line = own.line if len({r.algorithm for r in runs}) == len(runs) else LINES[nth % len(LINES)]
        found.append(RunLook(label, on_paper(own, dark), line))
    return found


def on_paper(own, dark):
    """The colour, legible (contrast at least 4.5 to 1) on this paper."""
    given = getattr(own, "dark", None) if dark else own.colour
    return legible(given or own.colour, PAPER[dark], INK[dark])


def legible(colour, paper, ink):
    mixed = colour
    for i in range(1, 21):
        if contrast(mixed, paper) >= 4.5:
            return mixed
        share = i / 20
        mixed = colors.to_hex([(1 - share) * c + share * k for c, k in zip(colors.to_rgb(colour), colors.to_rgb(ink))])
    return mixed


def contrast(a, b):
    """The contrast ratio of WCAG 2."""
    bright, dim = sorted((luminance(a), luminance(b)), reverse=True)
    return (bright + 0.05) / (dim + 0.05)


def luminance(colour):
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in colors.to_rgb(colour)]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
