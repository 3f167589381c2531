"""The palette of figures and pages: one colour, line and marker for each algorithm everywhere, for
each class of runs, and for what is neither.

Every colour has a contrast of at least 4.5 to the ground it is drawn on (WCAG 2.1, AA), so that names can be written in
it: `colour` on white, `dark` on the dark page. The hues were spread for readers with and without deuteranopia and
protanopia; dashes and markers tell apart what colours cannot. An algorithm without an entry gets a look by its name.
"""
import colorsys
import zlib
from dataclasses import dataclass
from functools import lru_cache


@dataclass(frozen=True)
class Look:
    label: str
    colour: str
    dark: str
    dash: tuple  # lengths drawn and left out in turn, in widths of the line; empty: a solid line
    marker: str  # of matplotlib

    @property
    def line(self):
        """The line's style as matplotlib has it."""
        return (0, self.dash) if self.dash else "-"


ALGORITHMS = {
    "original_averaging": Look("original averaging (DP)", "#0B6BC4", "#6CB4F5", (), "s"),
    "summation": Look("summation", "#6D122C", "#E98AA0", (5, 1.5), "^"),
    "mean": Look("mean", "#027A7D", "#4FC9CC", (3, 1, 1, 1), "v"),
    "virtual_coupling": Look("virtual coupling", "#5A34A9", "#B79BF5", (1, 1), "D"),
    "shaped_stiffness": Look("stiffness shaping (HS)", "#000000", "#F2F2F2", (), "o"),
    "tandpasta": Look("tandpasta", "#123C04", "#A5C98A", (7, 2, 1, 2), "P"),
    "normal_projection": Look("normal projection", "#515454", "#B5B9B9", (2, 1), "X"),
    "exact_shaping": Look("exact shaping (ours)", "#BD1BC3", "#F08CF3", (4, 1, 1, 1, 1, 1), "h"),
    "continuous_normal_projection": Look(
        "contin. projection (ours)", "#775543", "#D3AE97", (3, 1), "*"
    ),
    "least_squares": Look("least squares (ours)", "#1B06E8", "#8F9BFF", (1, 1.5), "d"),
    "highest_depth": Look("highest depth", "#09335D", "#C3D3EA", (6, 2), "<"),
    "mcneely": Look("McNeely, 10/N", "#8A4B00", "#F0B060", (3, 1.5, 1, 1.5), "1"),
    "static_coupling": Look("static coupling", "#00516B", "#5FC4E8", (2, 2), "2"),
    "merged_shaping": Look("merged shaping (ours)", "#9F0375", "#F07CC8", (4, 1, 1, 1), "p"),
    "proxy": Look("proxy (ours)", "#1D6A01", "#7EDB5A", (8, 1), ">"),
}
# Numbers of the thesis, in a colour that no algorithm has; hollow diamonds and dotted lines in figures.
PUBLISHED, PUBLISHED_DARK = "#C2261C", "#FF8A75"

# For curves that are of no algorithm, or all of one.
SERIES = (
    Look("", "#00647D", "#5FC4E8", (), "o"),
    Look("", "#8A5600", "#E9B64C", (4, 1.2), "s"),
    Look("", "#000000", "#F2F2F2", (1, 1.65), "^"),
    Look("", "#8A3B75", "#F07CC8", (5, 1.5), "v"),
    Look("", "#5F5F5F", "#B5B9B9", (3, 1, 1, 1), "D"),
    Look("", "#1D6A01", "#7EDB5A", (6, 2), "x"),
)

# Class of a run -> its name, colour and hatching; light to dark, so that they can be told apart in grey.
CLASSES = {
    "stable": ("stable", "#CFE6F5", ""),
    "decaying": ("decaying", "#E9F3FA", "/////"),
    "vibrating": ("vibrating", "#E0A030", ""),
    "thrown_out": ("thrown out", "#B05A1E", ""),
    "diverged": ("diverged", "#7A2E00", ""),
    # Classes of runs that tell nothing of stability, and outcomes of a sweep's runs.
    "went_through": ("passed through", "#8E7CC3", "xxxxx"),
    "stuck": ("stuck", "#5B7F95", "....."),
    "lost_contact": ("lost contact", "#B05A1E", "\\\\\\\\\\"),
    "not_dragged": ("not dragged", "#C9B458", "-----"),
    "no_contact": ("no contact", "#E2E2E2", ""),
    "diverges": ("diverges", "#7A2E00", ""),
    "error": ("error", "#3A3A3A", "+++++"),
}


def look_of_class(name):
    return CLASSES.get(name) or (name.replace("_", " "), "#C8C8C8", "xxx")


def by_class(names):
    """Names of classes in the order of the table."""
    order = list(CLASSES)
    return sorted(
        set(names), key=lambda name: (order.index(name) if name in order else len(order), name)
    )


# For algorithms without an entry.
FURTHER_DASHES = ((2, 2), (6, 1, 1, 1), (4, 2), (1, 2))
FURTHER_MARKERS = ("8", "H", "3", "4", "+", "x", ".")
# The largest and the least relative luminance that keep a contrast of 4.5 to the light and to the dark ground.
LIGHTEST_ON_WHITE, DARKEST_ON_BLACK = 0.14, 0.30


@lru_cache(maxsize=None)
def look(algorithm):
    """The look of any algorithm. Without an entry above, its name alone decides, so that it is the same everywhere."""
    if algorithm in ALGORITHMS:
        return ALGORITHMS[algorithm]
    number = zlib.crc32(algorithm.encode())
    number, dash = divmod(number, len(FURTHER_DASHES))
    hue, marker = divmod(number, len(FURTHER_MARKERS))
    return Look(
        algorithm.replace("_", " "),
        *in_hue(hue % 360 / 360),
        FURTHER_DASHES[dash],
        FURTHER_MARKERS[marker],
    )


def in_hue(hue):
    """The most vivid colours of a hue, 0 to 1, that can be read on the light and on the dark ground."""
    shades = [colorsys.hls_to_rgb(hue, percent / 100, 0.65) for percent in range(101)]
    light = max((s for s in shades if luminance(s) <= LIGHTEST_ON_WHITE), key=luminance)
    dark = min((s for s in shades if luminance(s) >= DARKEST_ON_BLACK), key=luminance)
    return ["#" + "".join(f"{round(255 * part):02X}" for part in shade) for shade in (light, dark)]


def luminance(rgb):
    """Relative luminance of WCAG 2.1; parts from 0 to 1."""
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in rgb]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
