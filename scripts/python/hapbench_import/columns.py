"""Finds the columns of a quantity by their names or numbers, and reads units from the names. A name that does not state
which columns belong together is not guessed."""
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
# Endings of column names that are certainly units, as in x_mm. Other endings, as in x_m and x_cm, may have another
# meaning.
_ENDINGS = "ms msec us usec ns nsec mm um mN kN deg".split()
_BRACKETED = re.compile(r"\s*([\[({<])\s*([^\[\](){}<>]*?)\s*[\])}>]\s*$")
# Brackets in front of further words, as in "x (mm) raw".
_BRACKETED_INSIDE = re.compile(r"\s*([\[({<])\s*([^\[\](){}<>]*?)\s*[\])}>](?=\s*\w)")
_BETWEEN_WORDS = re.compile(r"[_\s.:,/-]+")
# Names directly in front of a unit, as in xmm, tipXmm and timems.
_HEADS = {
    "time": re.compile(r"(?i:t|time|stamp|timestamp)"),
    "position": re.compile(
        r"((|.*[^A-Za-z])(?i:p|pos|position|tip|tool)?[xyzXYZ]|.*[a-z][XYZ])|(|.*[^A-Za-z]|[xyz])(?i:pos|position)"
    ),
    "force": re.compile(r"(|.*[^A-Za-z])(?i:f[xyz]?|force[xyz]?)"),
}
# Patterns of names, in lower case and without units, that state the quantity of a column.
NAMED_AS = {
    "force": re.compile(r"f_?[xyz]|.*force.*"),
    "position": re.compile(r"p?_?[xyz]|.*pos(ition)?([^a-z].*|)"),
}
# Prefix of the names of columns that the audit has added to a log of one axis. Messages do not name these columns.
ABSENT = "\x01absent"
SI = {"time": "s", "position": "m", "force": "N", "angle": "rad"}


@dataclass
class Unit:
    text: str  # unit as written in the name
    # True if `text` is certainly a unit: in square brackets, or after "/", "," or "_" at the end of the name. False if
    # `text` is in round brackets.
    is_sure: bool


def without_unit(name):
    """Returns (name, Unit or None) of a column name: "x [mm]", "x/mm", "x, mm" and "x mm" are x in mm. Brackets around
    a number or a component, as in q[0], contain an index and no unit."""
    found = _BRACKETED.search(name)
    if found and found[2] in ("", "-", "1"):
        return name[: found.start()] if found[2] != "1" else name, None
    if found and not found[2].isdigit() and found[2] not in ("x", "y", "z", "w"):
        return name[: found.start()], Unit(found[2], found[1] == "[")
    found = _BRACKETED_INSIDE.search(name)
    if found and any(found[2] in known for known in UNITS.values()) and found[2] not in "xyzw":
        return name[: found.start()] + name[found.end() :], Unit(found[2], found[1] == "[")
    for mark in "/,":
        head, _, ending = name.rpartition(mark)
        if head and any(ending.strip() in known for known in UNITS.values()):
            return head.strip(), Unit(ending.strip(), True)
    for mark in " :-":
        head, _, ending = name.rpartition(mark)
        if head.strip() and ending in _ENDINGS:
            return head.strip(), Unit(ending, True)
    head, _, ending = name.rpartition("_")
    return name, Unit(ending, True) if head and ending in _ENDINGS else None


def unit_in(quantity, text):
    """Returns the name of the unit in UNITS that `text` is, or None. Upper case and lower case are equal, except if
    upper case is another prefix: MN are meganewtons, and mN are millinewtons."""
    known = UNITS[quantity]
    if text in known:
        return text
    is_mega = text[:1] == "M" and text[1:] in known
    return text.lower() if text.lower() in known and not is_mega else None


def substituted(name, tokens):
    """Returns lists of column names. In each list, one occurrence of a token in `name` is replaced by each of `tokens`:
    pose.x gives [pose.x, pose.y, pose.z]."""
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
    """Returns lists of `count` column names in which a number of `name` (0 or 1) increases: p[0] gives [p[0], p[1],
    p[2]]."""
    return [
        [name[: at.start()] + str(int(at[0]) + i) + name[at.end() :] for i in range(count)]
        for at in re.finditer(r"\d+", name)
        if int(at[0]) in (0, 1)
    ]


def cells_of_matrix(name):
    """Returns lists of the nine column names of a 3 × 3 matrix, row by row: r11 gives r11, r12 ... r33. Names such as
    R[0][0] are also found."""
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
    """The names of the columns of a recording, with and without their units, and functions that find columns by
    name."""

    def __init__(self, recording):
        self.file, self.names = recording.file, recording.names
        self.stated_units, self._other_headers = recording.stated_units, recording.other_headers
        parts = [without_unit(name.lstrip("%# ")) for name in self.names]
        self.bare, self.units = [bare for bare, _ in parts], [unit for _, unit in parts]

    def fail(self, quantity, problem):
        known_names = self.in_file()
        known = ", ".join(f"{i} {name}".rstrip() for i, name in enumerate(known_names[:20], 1)) + (
            ", ..." if len(known_names) > 20 else ""
        )
        fail(f"columns: {quantity}: {problem}; the file has {known}", self.file)

    def in_file(self):
        """Returns the names of the columns in the file, without the columns that the audit has added."""
        return [name for name in self.names if not name.startswith(ABSENT)]

    def title(self, column):
        return f"{column + 1} {self.names[column]}".rstrip()

    def others(self, used):
        """Returns number and name of each column that is not in `used`, a result of Columns.used()."""
        read = {part["column"] for parts in used.values() for part in parts}
        return [self.title(i) for i in range(len(self.in_file())) if i + 1 not in read]

    def index(self, quantity, name):
        """Returns the index of the column of this name, or None. The name may omit the unit. Fails if two columns have
        the name."""
        if not name:
            return None
        # The header may have a unit instead of a name; see without_unit().
        for names, text in ((self.names, name), (self.bare, name), (self.names, f"[{name}]")):
            if names.count(text) > 1:
                self.fail(quantity, f"two columns are named {quoted(name)}: give its number")
            if text in names:
                return names.index(text)
        return None

    def find(self, quantity, words, endings=("_x", ".x")):
        """Returns (column, whether it was found by its number) for the first of `words` that names a column. A word is
        the name of a column, which may lack one of `endings`, or otherwise the number of a column. Returns
        (None, False) if no word names a column."""
        for word in words:
            bare = word.lstrip("%# ")  # a header in a comment begins with a comment character
            for name in (word, bare, *(bare + ending for ending in endings)):
                if (column := self.index(quantity, name)) is not None:
                    return column, False
            if word.isascii() and word.isdigit() and 1 <= int(word) <= len(self.names):
                return int(word) - 1, True
        return None, False

    def unknown(self, quantity, words):
        word, known_names = (words or [""])[0], list(filter(None, self.in_file()))
        near = nearest(word, known_names)
        if len(known_names) == 1 and word in known_names[0]:
            near = "; allowed between columns: commas, semicolons, tabs or blanks"
        for line, others in self._other_headers:
            if word in others:
                near = f"; line {line} has this name, but another line is the header: give a number"
        self.fail(quantity, f"got {quoted(word)}{near}")

    def indices(self, names):
        """Returns the columns of all `names`, or None if a name is missing or names several columns. `names` have no
        units; the names of the columns are compared without their units."""
        found = [self.bare.index(name) if self.bare.count(name) == 1 else None for name in names]
        return None if None in found or len(set(found)) < len(found) else found

    def components(self, column, tokens, numbers=True):
        """Returns the columns of all components if `column` is one of these columns and their names state the
        components. Otherwise returns None. `tokens`: names of the components. With `numbers`, names such as q0 are also
        accepted, although they do not state the order of the components."""
        name = self.bare[column]
        if not name:
            return None
        if tokens[0] == "r11":
            variants = cells_of_matrix(name)
        elif tokens[-1] == "angle":
            return self._axis_and_angle(name)
        else:
            variants = substituted(name, tokens)
        variants += numbered(name, len(tokens)) if numbers else []
        return next(
            (found for variant in variants if (found := self.indices(variant)) is not None), None
        )

    def _axis_and_angle(self, name):
        for variant in substituted(name, ("x", "y", "z")):
            ends = [letters.replace("\0", one) for letters in _between(variant) for one in _ANGLES]
            for angle in (*ends, *_ANGLES):
                if (found := self.indices([*variant, angle])) is not None:
                    return found
        return None

    def unit(self, quantity, columns):
        """Returns the Unit that the names of the columns state, or None. Fails if the names state different units."""
        units = {
            self.units[column].text: self.units[column] for column in columns if self.units[column]
        }
        if len(units) > 1:
            self.fail(quantity, f"its columns have different units ({', '.join(sorted(units))})")
        return next(iter(units.values()), None)


_ANGLES = ("angle", "theta", "a", "Angle", "phi")


def _between(names):
    """Returns a list with one text: the first of `names`, in which a NUL character replaces the component. For the
    names axis_x, axis_y and axis_z, the text is "axis_" and NUL."""
    at = next(i for i, pair in enumerate(zip(*names)) if len(set(pair)) > 1)
    return [names[0][:at] + "\0" + names[0][at + 1 :]]


def scale_text(quantity, scale):
    return "" if scale == 1.0 else f" (times {scale:.6g}, in {SI[quantity]})"


def scale_of(names, quantity, columns, given, notes):
    """Returns the factor to SI units: the factor `given` by the user. If `given` is None, returns the factor of the
    unit in the column names, or 1 without a known unit."""
    unit = names.unit(quantity, columns)
    known = UNITS[quantity]
    found = None if unit is None else unit_in(quantity, unit.text)
    factor = None if found is None else known[found]
    title = names.title(columns[0]) if columns else ""
    if unit and factor is None and given is None:
        problem = f"column {title}: the unit {quoted(unit.text)} is unknown"
        if unit.text[:1] == "M" and unit.text.lower() in known:
            problem += f" (it begins with mega; {unit.text.lower()} begins with milli)"
        if unit.is_sure:
            names.fail(
                quantity, f"{problem}: give the unit with --scale {quantity}=..., in {SI[quantity]}"
            )
        notes.append(f"{problem}; read as {SI[quantity]} (--scale {quantity}=...)")
    if factor is not None and given is not None and abs(given / factor - 1.0) > 1e-6:
        notes.append(
            f"column {title} says {unit.text}, a scale of {factor:g}; --scale {quantity}={given:g} was used"
        )
    if unit is None and given is None:
        notes += unclear_units(names, quantity, columns)
    if factor is not None and given is None:
        notes += units_of_others(names, quantity, columns, factor)
    return given if given is not None else factor if factor is not None else 1.0


def units_of_others(names, quantity, columns, factor):
    """Returns a list with at most one note about columns of a quantity that have no unit, although another column of
    the quantity has a unit other than the SI unit. `factor`: factor of this unit to the SI unit."""
    with_unit = [column for column in columns if names.units[column]]
    without = [
        column
        for column in columns
        if not names.units[column] and not names.names[column].startswith(ABSENT)
    ]
    if factor == 1.0 or not without:
        return []
    text, titles = names.units[with_unit[0]].text, ", ".join(map(names.title, without))
    are = (
        f"columns {titles} have no unit and are"
        if len(without) > 1
        else f"column {titles} has no unit and is"
    )
    return [
        f"{are} read in {text}, the unit of column {names.title(with_unit[0])} (--scale {quantity}={factor:g} confirms "
        f"this; --scale {quantity}=1 reads the {quantity} in {SI[quantity]})"
    ]


def unclear_units(names, quantity, columns):
    """Returns a list with at most one note about a unit that the columns of a quantity may have. The name of a column
    may contain the unit, or a comment of the file may state it. The values are read in the SI unit.
    """
    for column in columns:
        unit = unclear_unit(quantity, names.names[column])
        if unit:
            factor = UNITS[quantity].get(unit, UNITS[quantity].get(unit.lower()))
            factors = (
                f"{factor:g}" if unit_in(quantity, unit) else f"1e6 (mega) or {factor:g} (milli)"
            )
            return [
                f"column {names.title(column)} is read as {SI[quantity]}; if its name says {unit}, "
                f"--scale {quantity}={factors}"
            ]
    for line, unit in names.stated_units if columns else ():
        if UNITS[quantity].get(unit, 1.0) != 1.0:
            return [
                f"line {line} states the unit {unit}, but column {names.title(columns[0])} is read as {SI[quantity]}; "
                f"if {unit} is its unit, --scale {quantity}={UNITS[quantity][unit]:g}"
            ]
    return []


def unclear_unit(quantity, name):
    """Returns a unit that the name of a column may contain, or None. The unit is not an SI unit, and the name may have
    another meaning: x_cm may be in centimetres, or the x of a centre of mass."""
    known = {unit for unit, factor in UNITS[quantity].items() if factor != 1.0}
    words = [word for word in _BETWEEN_WORDS.split(name) if word]
    for at, word in enumerate(words if len(words) > 1 else ()):
        # The preposition "in" is a unit only at the end of a name.
        if (word in known or word.lower() in known) and (word != "in" or at == len(words) - 1):
            return word
    for end in range(1, len(name) - 1) if quantity in _HEADS else ():
        unit = name[end:]
        is_unit = (unit in known or unit.lower() in known) and unit.lower() != "in"
        if is_unit and _HEADS[quantity].fullmatch(name[:end]):
            return unit
    return None
