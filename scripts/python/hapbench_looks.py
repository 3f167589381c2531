"""Palette of figures and pages. Each algorithm has the same colour, line style and marker in all figures and pages.
Each class of runs, such as "stable", has the same colour and hatching in all of them.

Each colour has a contrast of at least 4.5 to its background (WCAG 2.1, AA), so that names can be printed in it:
`colour` on white, and `dark` on the dark page. For readers with deuteranopia, protanopia or tritanopia, the colours of
ALGORITHMS differ by at least 6 (CIEDE2000), and the colours of SERIES by at least 12. A test simulates their vision.
Dashes and markers also distinguish curves. An algorithm without an entry in ALGORITHMS has a look that follows from its
name. If two algorithms of a picture would look alike, distinguish() chooses another look.
"""
import colorsys
import zlib
from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True)
class Look:
    label: str
    colour: str
    dark: str
    dash: tuple  # alternating lengths of dashes and gaps, in line widths; empty for a solid line
    marker: str  # marker of matplotlib

    @property
    def line(self):
        """Returns the line style for matplotlib."""
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
# Colour of the numbers that the thesis publishes; no algorithm has this colour. Figures draw these numbers as hollow
# diamonds and dotted lines.
PUBLISHED, PUBLISHED_DARK = "#C2261C", "#FF8A75"

# Looks of curves that do not belong to an algorithm, and of curves that all belong to the same algorithm.
SERIES = (
    Look("", "#1F5FD6", "#63A7B5", (), "o"),
    Look("", "#945200", "#E1A902", (4, 1.2), "s"),
    Look("", "#000000", "#F2F2F2", (1, 1.65), "^"),
    Look("", "#752B6E", "#FC84FE", (5, 1.5), "v"),
    Look("", "#494944", "#B4B8B3", (3, 1, 1, 1), "D"),
    Look("", "#14794E", "#8EE288", (6, 2), "X"),
)
# Markers of series(). All can be filled, because hollow marks have a meaning in some pictures.
SERIES_MARKERS = (*(look.marker for look in SERIES), "<", ">", "p", "*", "d", "h", "P")


def series(count):
    """Returns the looks of `count` curves. The first looks are SERIES. Each further look has a colour of SERIES with
    another marker and other dashes. The number of markers, 13, has no common divisor with the number of colours, 6, so
    that 78 looks differ in colour or marker."""
    looks = []
    for i in range(count):
        turn, colour = divmod(i, len(SERIES))
        looks.append(
            replace(
                SERIES[colour],
                dash=SERIES[(colour + turn) % len(SERIES)].dash,
                marker=SERIES_MARKERS[i % len(SERIES_MARKERS)],
            )
        )
    return looks


# Name, colour and hatching of each class of runs. The first five classes also differ in brightness, so that they can be
# distinguished in grey.
CLASSES = {
    "stable": ("stable", "#CFE6F5", ""),
    "decaying": ("decaying", "#E9F3FA", "/////"),
    "vibrating": ("vibrating", "#E0A030", ""),
    "thrown_out": ("thrown out", "#B05A1E", ""),
    "diverged": ("diverged", "#7A2E00", ""),
    # The following classes do not show whether a run is stable. Some are outcomes of the runs of a sweep.
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
    """Returns the distinct names of classes in the order of CLASSES; unknown names follow."""
    order = list(CLASSES)
    return sorted(
        set(names), key=lambda name: (order.index(name) if name in order else len(order), name)
    )


# Dashes and markers of algorithms without an entry in ALGORITHMS.
FURTHER_DASHES = ((2, 2), (6, 1, 1, 1), (4, 2), (1, 2))
FURTHER_MARKERS = ("8", "H", "3", "4", "+", "x", ".")
# Two pairs of limits of the relative luminance. Each pair has the largest luminance of a colour on white and the
# smallest luminance of a colour on the dark page. Colours within the first pair of limits have a contrast of at least
# 5.4 to their background. Colours within the second pair have a contrast of at least 10.
LUMINANCES = ((0.14, 0.30), (0.05, 0.60))
HUES = 24
# Smallest distance in OKLab at which the colours of two lines in a figure can be distinguished. It corresponds to about
# 6 in CIEDE2000.
MIN_DISTANCE = 0.08
# Looks that distinguish() chose for algorithms of the current picture, by the name of the algorithm.
CHOSEN = {}

# Matrices of linear RGB that simulate types of colour vision: Machado, Oliveira and Fernandes (IEEE TVCG 15, 2009),
# severity 1.
VISIONS = {
    "usual": np.eye(3),
    "protanopia": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "deuteranopia": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
    "tritanopia": np.array(
        [
            [1.255528, -0.076749, -0.178779],
            [-0.078411, 0.930809, 0.147602],
            [0.004733, 0.691367, 0.303900],
        ]
    ),
}
# TO_CONES converts linear RGB to cone responses. TO_OKLAB converts the cube roots of the cone responses to OKLab
# (Ottosson, 2020).
TO_CONES = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
TO_OKLAB = np.array(
    [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ]
)


def law_name(algorithm):
    """Returns the name of a law as figures, pages and printed tables show it."""
    return algorithm.replace("_", " ")


def look(algorithm):
    """Returns the look of an algorithm: its entry in ALGORITHMS, or else the look that distinguish() chose, or else the
    look that follows from its name."""
    return ALGORITHMS.get(algorithm) or CHOSEN.get(algorithm) or by_name(algorithm)


def by_name(algorithm):
    number = zlib.crc32(algorithm.encode())
    number, dash = divmod(number, len(FURTHER_DASHES))
    hue, marker = divmod(number, len(FURTHER_MARKERS))
    return Look(
        law_name(algorithm),
        *in_hue(hue % 360 / 360),
        FURTHER_DASHES[dash],
        FURTHER_MARKERS[marker],
    )


def distinguish(algorithms):
    """Chooses looks for those algorithms of one picture that have no entry in ALGORITHMS. If the colour that follows
    from an algorithm's name is too close to another colour of the picture for some type of colour vision, the algorithm
    gets the hue that is most distant from the other colours. Otherwise it keeps its colour. If another algorithm of the
    picture has the same marker, the algorithm gets an unused marker."""
    CHOSEN.clear()
    names = sorted(set(algorithms))
    looks = [Look("", PUBLISHED, PUBLISHED_DARK, (), "")]
    looks += [ALGORITHMS[name] for name in names if name in ALGORITHMS]
    hues = [in_hue(i / HUES, of) for of in LUMINANCES for i in range(HUES)]
    too_close = []  # names whose default colour is too close to another colour
    for name in (name for name in names if name not in ALGORITHMS):
        default = by_name(name)
        if distance((default.colour, default.dark), looks) < MIN_DISTANCE:
            too_close.append(name)
            continue
        CHOSEN[name] = replace(default, marker=free_marker(default, looks))
        looks.append(CHOSEN[name])
    for name in too_close:
        default, (light, dark) = by_name(name), max(hues, key=lambda pair: distance(pair, looks))
        CHOSEN[name] = replace(default, colour=light, dark=dark, marker=free_marker(default, looks))
        looks.append(CHOSEN[name])


def free_marker(default, looks):
    used = [one.marker for one in looks]
    return next((m for m in (default.marker, *FURTHER_MARKERS) if m not in used), default.marker)


def distance(pair, looks):
    """Returns the smallest distance in OKLab between `pair` and the colours of `looks`, over all types of colour
    vision. `pair`: (colour on white, colour on the dark page). Only colours on the same background are compared.
    """
    return min(
        (
            np.linalg.norm(
                oklab(pair[ground]) - oklab((one.colour, one.dark)[ground]), axis=1
            ).min()
            for one in looks
            for ground in (0, 1)
        ),
        default=np.inf,
    )


def oklab(colour):
    """Returns the OKLab coordinates of a colour "#RRGGBB", with a row for each type of colour vision in VISIONS."""
    rgb = np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
    seen = np.array([matrix @ linear(rgb) for matrix in VISIONS.values()])
    return np.cbrt(np.clip(seen, 0, 1) @ TO_CONES.T) @ TO_OKLAB.T


def in_hue(hue, luminances=LUMINANCES[0]):
    """Returns two colours of a hue (0 to 1). The first, for a white background, is the lightest colour whose relative
    luminance is at most luminances[0]. The second, for the dark page, is the darkest colour whose relative luminance is
    at least luminances[1].
    """
    shades = [colorsys.hls_to_rgb(hue, percent / 100, 0.65) for percent in range(101)]
    light = max((s for s in shades if luminance(s) <= luminances[0]), key=luminance)
    dark = min((s for s in shades if luminance(s) >= luminances[1]), key=luminance)
    return ["#" + "".join(f"{round(255 * part):02X}" for part in shade) for shade in (light, dark)]


def linear(rgb):
    """Converts sRGB components (0 to 1) to linear RGB."""
    rgb = np.asarray(rgb)
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def luminance(rgb):
    """Returns the relative luminance by WCAG 2.1 of a colour with sRGB components from 0 to 1."""
    return float(linear(rgb) @ (0.2126, 0.7152, 0.0722))
