"""Options of `import stroke`. Options of the command line override the options of a preset."""
import json
import math
import sys
from dataclasses import dataclass, field
from pathlib import Path

from hapbench_command import (
    Faults,
    fail,
    finite_number,
    plain,
    quoted,
    require_name,
    shown,
    unique_keys,
)

PRESETS = Path(__file__).resolve().parents[3] / "scenarios" / "library" / "presets"
DECIMALS = ("auto", "comma", "point")
FORMATS = ("csv", "traj", "hapi", "hapi-binary")
# Columns of each representation of an orientation, in the order in which they are read.
ORIENTATIONS = {
    "none": (),
    "axis": ("axis_x", "axis_y", "axis_z"),
    "quat_wxyz": ("qw", "qx", "qy", "qz"),
    "quat_xyzw": ("qx", "qy", "qz", "qw"),
    "axis_angle": ("axis_x", "axis_y", "axis_z", "angle"),
    "matrix": ("r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"),
}
QUANTITIES = list(
    dict.fromkeys(
        [
            "time",
            "position",
            "px",
            "py",
            "pz",
            "orientation",
            "force",
            "mfx",
            "mfy",
            "mfz",
            *sum(ORIENTATIONS.values(), ()),
        ]
    )
)


@dataclass
class Options:
    """Describes the meaning of the numbers in a recording. Defaults: metres, seconds, newtons and radians; the tip
    points along -z of the tool frame."""

    format: str = "csv"
    # True if the numbers of a hapi-binary file have four bytes, false for eight bytes.
    floats: bool = False
    # Decimal sign: "comma", "point", or "auto", which determines it from the numbers of the file.
    decimal: str = "auto"
    columns: dict = field(
        default_factory=dict
    )  # for each quantity, the names or numbers (from 1) that its column may have
    optional: set = field(default_factory=set)  # quantities of `columns` that the file may omit
    sample_rate_Hz: float | None = None  # sampling rate of a file without times
    scale: dict = field(
        default_factory=dict
    )  # for "time", "position", "angle" and "force": the factor from the recorded unit to the SI unit
    # Representation of the orientation, a key of ORIENTATIONS. None: determined from the names of the columns.
    orientation: str | None = None
    named: frozenset = frozenset()  # quantities of `columns` that the command line sets
    tip_axis: tuple = (
        0.0,
        0.0,
        -1.0,
    )  # direction out of the tip in the recorded tool frame, of any length
    frame: tuple = (
        (1.0, 0.0, 0.0),
        (0.0, 1.0, 0.0),
        (0.0, 0.0, 1.0),
    )  # rotation from the recorded world frame to the scenario's frame
    # Vector in the scenario's frame that is added to the positions [m].
    shift: tuple = (0.0, 0.0, 0.0)
    # True if the recorded forces act on the object; they are then negated.
    force_by_tool: bool = False
    rate: float | None = None  # rate of the stroke [Hz]; None: as recorded
    # Window [samples] and order of the smoothing polynomial; None: no smoothing.
    smooth: dict | None = None
    max_speed: float = 5.0  # larger speeds between samples are errors [m/s]
    max_gap: float = 0.5  # longer times between samples are errors [s]
    skip_bad_rows: bool = False
    # "thin" omits rows that repeat a held sample; "keep" uses these rows as samples.
    held_rows: str = "thin"

    def set(self, name, value):
        """Sets an option from a JSON value."""
        allowed, fits, read = _FIELDS[name]
        if not fits(value):
            fail(f"{name}: got {shown(value)}; allowed: {allowed}")
        if read:
            setattr(self, name, read(self, value))


def options_of(requested):
    """Returns the Options for a parsed command line of `import stroke`."""
    options = Options()
    if requested.preset:
        _apply_preset(options, requested.preset)
    for name in ("format", "decimal", "orientation", "frame"):
        if value := getattr(requested, name):
            options.set(name, value)
    columns = dict(assignments("columns", requested.columns))
    options.set("columns", columns)
    fields = {name: _value(value) for name, value in assignments("set", requested.set)}
    for name in fields:
        require_name("--set: got", name, list(_FIELDS))
        if getattr(requested, name, None):
            fail(f"--{name} and --set {name}: allowed: one of them")
    options.set(
        "scale",
        {
            quantity: _number("--scale", factor)
            for quantity, factor in assignments("scale", requested.scale)
        },
    )
    if requested.smooth:
        options.smooth = _smoothing(requested.smooth)
    for name, value in fields.items():
        options.set(name, value)
    options.named = frozenset(columns) | set(fields.get("columns", ()))
    options.optional -= options.named
    if "time" in options.named:
        if "sample_rate_Hz" in fields:
            fail("--columns time and --set sample_rate_Hz: allowed: one of them")
        options.sample_rate_Hz = None
    options.rate = requested.rate
    options.skip_bad_rows = requested.skip_bad_rows
    _refuse_without_effect(options)
    if not 1e-9 < math.hypot(*options.tip_axis) < 1e9:
        fail("tip_axis: allowed: a direction")
    if options.sample_rate_Hz is not None and not 0.0 < options.sample_rate_Hz <= 1e6:
        fail(f"sample_rate: got {plain(options.sample_rate_Hz)} Hz; allowed: > 0 ... 1e6")
    return options


def _refuse_without_effect(options):
    """Refuses options that the format of the file makes ineffective."""
    is_binary = options.format == "hapi-binary"
    if options.floats and not is_binary:
        fail(f"floats=true: got format {options.format}; allowed: --format hapi-binary")
    if options.decimal != "auto" and is_binary:
        fail(f"decimal: got {options.decimal}; allowed for format hapi-binary: auto")


def list_of_presets():
    return [
        {"preset": name, "description": _read_preset(file).get("description", ""), "file": file}
        for name, file in _presets().items()
    ]


def _presets():
    """Returns a dict from the name of each preset to its file."""
    return {file.stem: str(file) for file in sorted(PRESETS.glob("*.json"))}


def _read_preset(file):
    """Returns the JSON object of a preset's file. Its fields are options. Users copy and modify such files."""
    try:
        with open(file, encoding="utf-8-sig") as stream:
            preset = json.load(stream, object_pairs_hook=unique_keys)
    except OSError as error:
        fail(f"cannot be read: {error.strerror}", file)
    except json.JSONDecodeError as error:
        fail(f"is not JSON: syntax error at line {error.lineno}, column {error.colno}", file)
    except (ValueError, RecursionError):
        fail("is not JSON in UTF-8", file)
    except Faults as faults:
        fail(faults.list[0][1], file)
    if not isinstance(preset, dict):
        fail(f"a preset: got {shown(preset)}; allowed: an object", file)
    return preset


def _apply_preset(options, file):
    # A pipe, such as /dev/fd/63, has no extension but is a file and not the name of a preset.
    if not file.endswith(".json") and "/" not in file and not Path(file).is_fifo():
        presets = _presets()
        require_name("preset: got", file, list(presets))
        file = presets[file]
    try:
        for name, value in _read_preset(file).items():
            require_name("got field", name, list(_FIELDS))
            options.set(name, value)
        if options.sample_rate_Hz is not None and "time" in options.columns:
            fail("columns: time and sample_rate_Hz: allowed: one of them")
    except Faults as faults:
        fail(faults.list[0][1], file)
    options.optional = {"orientation", "force"} & set(options.columns)


def assignments(option, words):
    """Yields (name, value) for each word NAME=VALUE of an option. Fails if a name is given twice."""
    names = set()
    for word in words:
        name, equals, value = word.partition("=")
        if not name or not equals:
            fail(f"--{option}: got {quoted(word)}; allowed: NAME=VALUE")
        if name in names:
            fail(f"--{option}: got {quoted(name)} twice; allowed: once")
        names.add(name)
        yield name, value


def _value(word):
    """Parses a value of --set: JSON, or a list of numbers and words separated by commas."""
    try:
        return json.loads(word, object_pairs_hook=unique_keys)
    except ValueError:
        return [_value(part) for part in word.split(",")] if "," in word else word


def _number(option, word):
    value = finite_number(word.encode("utf-8", "surrogateescape"))
    if math.isnan(value):
        fail(f"{option}: got {quoted(word)}; allowed: a number")
    return value


def _smoothing(words):
    smoothing = {"window": 0, "order": 0}
    for name, value in assignments("smooth", words):
        if not (value.isascii() and value.isdigit() and int(value) <= 100_000):
            fail(f"--smooth: {name}: got {quoted(value)}; allowed: a whole number")
        require_name("--smooth: got", name, list(smoothing))
        smoothing[name] = int(value)
    return smoothing


def _is_number(value):
    """Returns True for a number that a double can represent. json.loads also accepts NaN, infinities and integers of
    any length."""
    return (
        isinstance(value, (int, float))
        and not isinstance(value, bool)
        and abs(value) <= sys.float_info.max
    )


def _is_positive(value):
    return _is_number(value) and value > 0


def _is_column(value):
    """Returns True for a column name, a column number, or a list of names and numbers."""
    return (
        isinstance(value, str)
        or _is_number(value)
        or isinstance(value, list)
        and all(map(_is_column, value))
    )


def _is_vector(value):
    return isinstance(value, list) and len(value) == 3 and all(map(_is_number, value))


def _vector(_, value):
    return tuple(map(float, value))


def _named(name, valid):
    def read(_, value):
        require_name(f"{name}: got", value, list(valid))
        return value

    return read


def _columns(options, value):
    for quantity in value:
        require_name("columns: got", quantity, QUANTITIES)
    return options.columns | {
        quantity: list(map(str, column if isinstance(column, list) else [column]))
        for quantity, column in value.items()
    }


def _scale(options, value):
    for quantity, factor in value.items():
        require_name("scale: got", quantity, ("time", "position", "angle", "force"))
        if not 0.0 < factor < math.inf:
            fail(f"scale: {quantity}: got {plain(factor)}; allowed: > 0")
    return options.scale | value


def _frame(_, words):
    """Returns the rotation matrix from the recorded frame to the scenario's frame. `words`: the recorded directions
    that become the x, y and z axes of the scenario, such as x, -z, y."""
    rows = [
        [
            0.0 if word.removeprefix("-") != letter else -1.0 if word.startswith("-") else 1.0
            for letter in "xyz"
        ]
        for word in words
    ]
    # Each row of the matrix is a unit vector, or zero for an invalid word. The determinant of a reflection is -1; the
    # frame of a tool cannot be reflected.
    if (
        len(rows) != 3
        or sum(
            rows[0][i] * (rows[1][i - 2] * rows[2][i - 1] - rows[1][i - 1] * rows[2][i - 2])
            for i in range(3)
        )
        < 0.5
    ):
        fail(
            'frame: allowed: three of x, y, z, each once, with or without "-", as in "x,-z,y", '
            "that make a right-handed frame"
        )
    return rows


# Fields of a preset: (allowed values as text, check of a value, conversion of a value). The conversion is None for a
# field that only describes the preset.
_FIELDS = {
    "description": ("a text", lambda v: isinstance(v, str), None),
    "format": ("a text", lambda v: isinstance(v, str), _named("format", FORMATS)),
    "floats": ("true, false", lambda v: isinstance(v, bool), lambda _, v: v),
    "columns": (
        "an object of names or numbers",
        lambda v: isinstance(v, dict) and all(map(_is_column, v.values())),
        _columns,
    ),
    "sample_rate_Hz": ("a number", _is_number, lambda _, v: float(v)),
    "scale": (
        "an object of numbers",
        lambda v: isinstance(v, dict) and all(map(_is_number, v.values())),
        _scale,
    ),
    "orientation": ("a text", lambda v: isinstance(v, str), _named("orientation", ORIENTATIONS)),
    "tip_axis": ("three numbers", _is_vector, _vector),
    "shift": ("three numbers", _is_vector, _vector),
    "decimal": ("a text", lambda v: isinstance(v, str), _named("decimal", DECIMALS)),
    "held_rows": ("a text", lambda v: isinstance(v, str), _named("held_rows", ("thin", "keep"))),
    "max_speed": ("a number > 0", _is_positive, lambda _, v: float(v)),
    "max_gap": ("a number > 0", _is_positive, lambda _, v: float(v)),
    "frame": (
        "a list of texts",
        lambda v: isinstance(v, list) and all(isinstance(one, str) for one in v),
        _frame,
    ),
    "force_by_tool": ("true, false", lambda v: isinstance(v, bool), lambda _, v: v),
}
