"""Which columns of a recording hold a quantity: by their names or numbers, never by guess; and the units in names."""
import re
from dataclasses import dataclass

from hapbench_command import fail, nearest, quoted

UNITS = {
    "time": {"s": 1.0, "sec": 1.0, "secs": 1.0, "second": 1.0, "seconds": 1.0}
    | {unit: 1e-3 for unit in ("ms", "msec", "millisecond", "milliseconds")}
    | {unit: 1e-6 for unit in ("us", "µs", "μs", "usec", "microsecond", "microseconds")}
    | {unit: 1e-9 for unit in ("ns", "nsec", "nanosecond", "nanoseconds")},
    "position": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "nm": 1e-9}
    | {"meter": 1.0, "meters": 1.0, "metre": 1.0, "metres": 1.0, "in": 0.0254, "inch": 0.0254}
    | {"millimeter": 1e-3, "millimeters": 1e-3, "millimetre": 1e-3, "millimetres": 1e-3},
    "force": {"N": 1.0, "n": 1.0, "newton": 1.0, "newtons": 1.0, "mN": 1e-3, "mn": 1e-3, "kN": 1e3}
    | {"kn": 1e3, "gf": 9.80665e-3, "kgf": 9.80665, "lbf": 4.4482216152605},
    "angle": {"rad": 1.0, "rads": 1.0, "radian": 1.0, "radians": 1.0, "mrad": 1e-3}
    | {unit: 0.017453292519943295 for unit in ("deg", "degs", "degree", "degrees", "°")},
}
# A name such as x_mm also has a unit. Short ones such as x_m or x_cm may mean something else.
_ENDINGS = "ms msec us usec ns nsec mm um mN kN deg".split()
_UNCLEAR_ENDINGS = ("cm", "in", "inch", "nm")
_BRACKETED = re.compile(r"\s*([\[(])\s*([^\[\]()]*?)\s*[\])]\s*$")
# Names, in lower case and without units, that say what a column holds.
NAMED_AS = {
    "force": re.compile(r"f_?[xyz]|.*force.*"),
    "position": re.compile(r"p?_?[xyz]|.*pos(ition)?([^a-z].*|)"),
}
ABSENT = "\x01absent"  # begins the names of columns that a reader has added; no message names them
SI = {"time": "s", "position": "m", "force": "N", "angle": "rad"}


@dataclass
class Unit:
    text: str  # as the name has it
    is_sure: bool  # in square brackets or at the end of the name after "_": nothing but a unit


def without_unit(name):
    """(name, Unit or None): "x [mm]", "x/mm" and "x, mm" are x in mm. Brackets around a number or a component, as in
    q[0], are an index."""
    found = _BRACKETED.search(name)
    if found and found[2] in ("", "-", "1"):
        return name[: found.start()] if found[2] != "1" else name, None
    if found and not found[2].isdigit() and found[2] not in ("x", "y", "z", "w"):
        return name[: found.start()], Unit(found[2], found[1] == "[")
    for mark in "/,":
        head, _, ending = name.rpartition(mark)
        if head and any(ending.strip() in known for known in UNITS.values()):
            return head.strip(), Unit(ending.strip(), True)
    head, _, ending = name.rpartition("_")
    return name, Unit(ending, True) if head and ending in _ENDINGS else None


def substituted(name, tokens):
    """Lists of names with each of `tokens` in place of one of them in `name`: pose.x gives pose.x, pose.y, pose.z."""
    found = []
    for token in tokens:
        for at in re.finditer(re.escape(token), name, re.IGNORECASE):
            big = at[0].isupper()
            found.append(
                [
                    name[: at.start()] + (one.upper() if big else one) + name[at.end() :]
                    for one in tokens
                ]
            )
    return found


def numbered(name, count):
    """Lists of `count` names with the numbers that follow one in `name`: p[0] gives p[0], p[1], p[2]."""
    return [
        [name[: at.start()] + str(int(at[0]) + i) + name[at.end() :] for i in range(count)]
        for at in re.finditer(r"\d+", name)
        if int(at[0]) in (0, 1)
    ]


def cells_of_matrix(name):
    """Lists of the nine names of a matrix, row by row: r11 gives r11, r12 ... r33; R[0][0] likewise."""
    return [
        [
            name[: at.start()] + f"{int(at[1]) + i}{at[2]}{int(at[3]) + j}" + name[at.end() :]
            for i in range(3)
            for j in range(3)
        ]
        for at in re.finditer(r"(\d)(\D{0,2})(\d)", name)
        if at[1] == at[3] and at[1] in "01"
    ]


class Names:
    """The names of a recording's columns, with and without units, and the columns that they stand for."""

    def __init__(self, recording):
        self.file, self.names = recording.file, recording.names
        parts = [without_unit(name.lstrip("%# ")) for name in self.names]
        self.bare, self.units = [bare for bare, _ in parts], [unit for _, unit in parts]

    def fail(self, quantity, problem):
        own = self.own()
        known = ", ".join(f"{i} {name}".rstrip() for i, name in enumerate(own[:20], 1)) + (
            ", ..." if len(own) > 20 else ""
        )
        fail(f"columns: {quantity}: {problem}; the file has {known}", self.file)

    def own(self):
        """The names of the file's columns."""
        return [name for name in self.names if not name.startswith(ABSENT)]

    def title(self, column):
        return f"{column + 1} {self.names[column]}".rstrip()

    def others(self, used):
        """Numbers and names of the columns that are not `used`, the columns by quantity."""
        read = {part["column"] for parts in used.values() for part in parts}
        return [self.title(i) for i in range(len(self.own())) if i + 1 not in read]

    def index(self, quantity, name):
        """The column of this name, or None. A name is whole, or without its unit."""
        if not name:
            return None
        for names in (self.names, self.bare):
            if names.count(name) > 1:
                self.fail(quantity, f"two columns are named {quoted(name)}: give its number")
            if name in names:
                return names.index(name)
        return None

    def find(self, quantity, words, endings=("_x", ".x")):
        """(column, True if the word is a number) of the first of the words that the file has; `endings` may be missing
        in a word. (None, False) if it has none of them."""
        for word in words:
            bare = word.lstrip("%# ")  # of a header in a comment
            for name in (word, bare, *(bare + ending for ending in endings)):
                if (column := self.index(quantity, name)) is not None:
                    return column, False
            if word.isascii() and word.isdigit() and 1 <= int(word) <= len(self.names):
                return int(word) - 1, True
        return None, False

    def unknown(self, quantity, words):
        word, own = (words or [""])[0], list(filter(None, self.own()))
        near = nearest(word, own)
        if len(own) == 1 and word in own[0]:
            near = "; allowed between columns: commas, semicolons, tabs or blanks"
        self.fail(quantity, f"got {quoted(word)}{near}")

    def indices(self, names):
        """The columns of all these names, or None. Names without units, as units come behind components."""
        found = [self.bare.index(name) if self.bare.count(name) == 1 else None for name in names]
        return None if None in found or len(set(found)) < len(found) else found

    def nanoseconds(self, time):
        """The column of nanoseconds that belongs to a column of whole seconds, as those of ROS: secs and nsecs; in a
        list, which is empty without it. `time`: the column of times in a list."""
        found = re.fullmatch(r"(|.*[._ /])secs?", self.names[time[0]]) if time else None
        for ending in ("nsecs", "nsec", "nanosec", "nanosecs") if found else ():
            if self.names.count(found[1] + ending) == 1:
                return [self.names.index(found[1] + ending)]
        return []

    def components(self, column, tokens, numbers=True):
        """The columns of all components, of which `column` is one, as their names say; None if they do not.
        `numbers`: names with numbers, such as q0, count too, whose order the names do not say."""
        name = self.bare[column]
        if not name:
            return None
        if tokens[0] == "r11":
            ways = cells_of_matrix(name)
        elif tokens[-1] == "angle":
            return self._axis_and_angle(name)
        else:
            ways = substituted(name, tokens)
        ways += numbered(name, len(tokens)) if numbers else []
        return next((found for way in ways if (found := self.indices(way)) is not None), None)

    def _axis_and_angle(self, name):
        for way in substituted(name, ("x", "y", "z")):
            ends = [letters.replace("\0", one) for letters in _between(way) for one in _ANGLES]
            for angle in (*ends, *_ANGLES):
                if (found := self.indices([*way, angle])) is not None:
                    return found
        return None

    def unit(self, quantity, columns):
        """The Unit that the names of columns have, or None; refuses several different ones."""
        units = {
            self.units[column].text: self.units[column] for column in columns if self.units[column]
        }
        if len(units) > 1:
            self.fail(quantity, f"its columns have different units ({', '.join(sorted(units))})")
        return next(iter(units.values()), None)


_ANGLES = ("angle", "theta", "a", "Angle", "phi")


def _between(names):
    """ "axis_\0" of axis_x, axis_y, axis_z: the name with a mark in place of the component."""
    at = next(i for i, pair in enumerate(zip(*names)) if len(set(pair)) > 1)
    return [names[0][:at] + "\0" + names[0][at + 1 :]]


def scale_text(quantity, scale):
    return "" if scale == 1.0 else f" (times {scale:.6g}, in {SI[quantity]})"


def scale_of(names, quantity, columns, given, notes):
    """The factor to SI units: as `given`, or as the units in the names say, or 1."""
    unit = names.unit(quantity, columns)
    known = UNITS[quantity]
    factor = None if unit is None else known.get(unit.text, known.get(unit.text.lower()))
    title = names.title(columns[0]) if columns else ""
    if unit and factor is None and given is None:
        problem = f"column {title}: the unit {quoted(unit.text)} is unknown"
        if unit.is_sure:
            names.fail(
                quantity, f"{problem}: --scale {quantity}=... says what it is in {SI[quantity]}"
            )
        notes.append(f"{problem}; read as {SI[quantity]} (--scale {quantity}=...)")
    if factor is not None and given is not None and abs(given / factor - 1.0) > 1e-6:
        notes.append(
            f"column {title} says {unit.text}, a scale of {factor:g}; --scale {quantity}={given:g} was used"
        )
    if unit is None and given is None and quantity == "position":
        notes += unclear_endings(names, columns)
    return given if given is not None else factor if factor is not None else 1.0


def unclear_endings(names, columns):
    """A note about names such as x_cm, whose ending is a unit or something else, such as the centre of mass."""
    for column in columns:
        ending = names.names[column].rpartition("_")[2]
        if ending in _UNCLEAR_ENDINGS and names.names[column] != ending:
            factor = UNITS["position"][ending]
            return [
                f"column {names.title(column)} is read as m; if its name says {ending}, --scale position={factor:g}"
            ]
    return []
