"""The palette of figures and pages: one colour, line and marker for each algorithm everywhere, for
each class of runs, and for what is neither.

Every colour has a contrast of at least 4.5 to the ground it is drawn on (WCAG 2.1, AA), so that names can be written in
it: `colour` on white, `dark` on the dark page. For readers with deuteranopia, protanopia or tritanopia the colours of
ALGORITHMS differ by at least 6 (CIEDE2000), those of SERIES by at least 12; a test simulates their vision. Dashes and
markers are a second code. An algorithm without an entry gets a look by its name.
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
    "original_averaging": Look("original averaging (DP)", "#0567D3", "#83A8FF", (), "s"),
    "summation": Look("summation", "#780034", "#F68EAD", (5, 1.5), "^"),
    "mean": Look("mean", "#057478", "#78CDD1", (3, 1, 1, 1), "v"),
    "virtual_coupling": Look("virtual coupling", "#5322AA", "#CEBAFF", (1, 1), "D"),
    "shaped_stiffness": Look("stiffness shaping (HS)", "#000000", "#F2F2F2", (), "o"),
    "tandpasta": Look("tandpasta", "#123F0E", "#94BF86", (7, 2, 1, 2), "P"),
    "normal_projection": Look("normal projection", "#97426A", "#9B9D99", (2, 1), "X"),
    "exact_shaping": Look("exact shaping (ours)", "#BD00BC", "#D181B4", (4, 1, 1, 1, 1, 1), "h"),
    "continuous_normal_projection": Look(
        "contin. projection (ours)", "#7B5843", "#DBBDAB", (3, 1), "*"
    ),
    "least_squares": Look("least squares (ours)", "#0003EA", "#7F8BFF", (1, 1.5), "d"),
    "highest_depth": Look("highest depth", "#002C50", "#CADBF4", (6, 2), "<"),
    "mcneely": Look("McNeely, 10/N", "#A2560C", "#EAA330", (3, 1.5, 1, 1.5), "1"),
    "static_coupling": Look("static coupling", "#00567E", "#0AAED3", (2, 2), "2"),
    "merged_shaping": Look("merged shaping (ours)", "#961356", "#FF64D1", (4, 1, 1, 1), "p"),
    "proxy": Look("proxy (ours)", "#005701", "#49CF56", (8, 1), ">"),
}
# Numbers of the thesis, in a colour that no algorithm has; hollow diamonds and dotted lines in figures.
PUBLISHED, PUBLISHED_DARK = "#C2261C", "#FF8A75"

# For curves that are of no algorithm, or all of one.
SERIES = (
    Look("", "#1F5FD6", "#63A7B5", (), "o"),
    Look("", "#945200", "#E1A902", (4, 1.2), "s"),
    Look("", "#000000", "#F2F2F2", (1, 1.65), "^"),
    Look("", "#752B6E", "#FC84FE", (5, 1.5), "v"),
    Look("", "#494944", "#B4B8B3", (3, 1, 1, 1), "D"),
    Look("", "#14794E", "#8EE288", (6, 2), "x"),
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
