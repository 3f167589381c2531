"""Finds the columns of a log by their usual names, and the axes of the log: three, two for a planar log, or one."""
import re
from copy import copy

import numpy as np
from hapbench_command import quoted
from hapbench_import.columns import ABSENT, Names
from hapbench_import.recording import Recording

# Usual names of the first column of each quantity. Names are in lower case, without units and without any character
# other than letters and digits.
USUAL = {
    "time": "time times t ts timestamp stamp secs simtime headerstamp clock",
    "position": "px posx positionx poseposition posepositionx tipx toolx tcpx eex hipx hx pos0 p0 position0 x",
    "force": "fx forcex wrenchforcex contactforcex fextx fcmdx commandedx commandedforcex forcecommandedx force0 f0",
    "velocity": "vx velx velocityx twistlinearx vel0 v0",
    "measured": "measuredx measuredforcex forcemeasuredx fmeasuredx fsensorx",
    "contacts": "colliding contacts ncontacts ncon numcontacts contactcount",
    "orientation": "qw qx quatw quatx orientationw orientationx poseorientationx",
}
# Further usual names for a log of one axis.
ALONE = {"position": "position pos x y z", "force": "force f", "velocity": "velocity vel v"}
ALONE["measured"] = "measured measuredforce forcemeasured"
# Components of the quantities that need all axes of a log, named as in --columns.
PARTS = {"position": ("px", "py", "pz"), "force": ("mfx", "mfy", "mfz")}
PLANES = ("xy", "xz", "yz")  # axes of planar logs
# Endings that the name of a first column may lack in --columns.
FIRST_ENDINGS = ("_x", ".x", "x", "[0]", "_0", ".0", "0")


def key_of(name):
    return re.sub(r"[^a-z0-9]", "", name.lower())


class UsualNames:
    """Finds columns by their usual names."""

    def __init__(self, names):
        self._keys = {}
        for name, bare, unit in zip(names.names, names.bare, names.units):
            for text in (name, bare, bare.removesuffix(f"_{unit.text}") if unit else bare):
                key = key_of(text)
                for ending in ("", "mpers", "m", "s", "n"):  # endings of SI units, as in px_m
                    if ending == "" or re.search(r"_(m|s|N|m_per_s)$", text):
                        self._keys.setdefault(key.removesuffix(ending) or key, name)

    def find(self, words):
        return next((self._keys[word] for word in words.split() if word in self._keys), None)


def with_usual_columns(recording, options):
    """Adds to options.columns the columns with usual names, for quantities that the user did not name. Returns
    (recording, axes of the log, such as "xyz", or "x" for a log of one axis). For a log of one or two axes, the
    recording gets columns of zeros for the missing axes.
    """
    names = Names(recording)
    usual = UsualNames(names)
    given = {
        quantity
        for quantity in ("time", "position", "force", "orientation")
        if quantity in options.columns or set(PARTS.get(quantity, ())) & set(options.columns)
    }
    if options.sample_rate_Hz:
        given.add("time")
    for quantity in ("time", "position", "force"):
        if quantity in given:
            continue
        name = usual.find(USUAL[quantity]) or usual.find(ALONE.get(quantity, ""))
        if name is None:
            hint = (
                ", or --set sample_rate_Hz=... for a log without times"
                if quantity == "time"
                else of_one_axis(usual)
            )
            names.fail(
                quantity, f"no usual name; --columns {quantity}=NAME or number names it{hint}"
            )
        options.columns[quantity] = [name]
    if "orientation" not in given and not options.orientation:
        name = usual.find(USUAL["orientation"])
        if name is not None:
            options.columns["orientation"] = [name]
            options.optional = options.optional | {"orientation"}
    columns = {quantity: axis_columns(names, options, quantity) for quantity in PARTS}
    if None in columns.values():
        return recording, "xyz"  # Columns reports the fault
    columns = with_equal_axes(names, columns, given)
    axes = "".join(columns["position"])
    if axes == "xyz":
        return recording, axes
    if len(axes) == 1:
        axes = "x"
        columns = {quantity: {"x": next(iter(one.values()))} for quantity, one in columns.items()}
    return with_missing_axes(recording, options, names, columns), axes


def of_one_axis(usual):
    """Returns a hint if the log has usual names of position and force for the y axis or for the z axis: the option that
    reads the log as a log of one axis. Returns an empty text for other logs."""
    for axis in "yz":
        found = usual.find(f"p{axis} pos{axis} position{axis}"), usual.find(f"f{axis} force{axis}")
        if all(found):
            return "; for a log of one axis: --columns position={},force={}".format(*found)
    return ""


def axis_columns(names, options, quantity):
    """Returns a dict from axis to column for position or force. The axes are x, y and z, two of them for a planar log,
    or x alone for a log of one axis. Returns None if the options contradict each other."""
    parts = [part for part in PARTS[quantity] if part in options.columns]
    if parts:
        if quantity in options.columns:
            return None
        found = {part: names.find(part, options.columns[part])[0] for part in parts}
        for part, column in found.items():
            if column is None:
                names.unknown(part, options.columns[part])
        return {part[-1]: column for part, column in found.items()}
    column, by_number = names.find(quantity, options.columns[quantity], FIRST_ENDINGS)
    if column is None:
        names.unknown(quantity, options.columns[quantity])
    if by_number and not are_alone(names, options):
        return dict(zip("xyz", range(column, column + 3)))
    found = names.components(column, ("x", "y", "z"))
    if found is not None and not by_number:
        return dict(zip("xyz", found))
    for pair in PLANES:
        found = names.components(column, tuple(pair))
        # The name of the second component of a plane, such as y, selects this component alone.
        if found is not None and found[0] == column:
            return dict(zip(pair, found))
    return {"x": column}


def are_alone(names, options):
    """Returns True if column numbers in the options name single columns. A number usually names the first of three
    columns. It names a single column if the columns would otherwise overlap or lie beyond the last column.
    """
    found = [
        names.find(quantity, options.columns[quantity], FIRST_ENDINGS)
        for quantity in PARTS
        if quantity in options.columns
    ]
    numbers = [column for column, by_number in found if by_number]
    return max(numbers) + 3 > len(names.names) or (
        len(numbers) == 2 and abs(numbers[0] - numbers[1]) < 3
    )


def with_equal_axes(names, columns, given):
    """Returns `columns`, a dict from quantity to a dict from axis to column, with equal axes of position and force.
    Fails if the axes differ. Exception: if the user has named a column of a plane and the other quantity has a single
    column, the log has one axis. `given`: quantities that the user has named."""
    position, force = columns["position"], columns["force"]
    if len(position) == len(force) == 1 or list(position) == list(force):
        return columns
    single = min(columns, key=lambda quantity: len(columns[quantity]))
    (other,) = columns.keys() - {single}
    if len(columns[single]) == 1 and len(columns[other]) == 2 and other in given:
        return {quantity: dict([next(iter(one.items()))]) for quantity, one in columns.items()}
    shared = {axis: axis for axis in position if axis in force}
    if len(columns[single]) == 1:
        # The name of the single column may state its axis. Otherwise the last axis is an example.
        (axis,) = columns[single]
        stated = names.bare[columns[single][axis]][-1:].lower()
        shared = {axis: stated if stated in columns[other] else list(columns[other])[-1]}
    option = ",".join(
        f"{'p' if quantity == 'position' else 'mf'}{axis}="
        f"{names.title(columns[quantity][own if quantity == single else axis]).split(' ', 1)[-1]}"
        for quantity in columns
        for own, axis in shared.items()
    )
    titles = [
        " and ".join(names.title(column) for column in one.values()) for one in (position, force)
    ]
    names.fail(
        "force",
        f"positions are in {titles[0]}, but forces in {titles[1]}; allowed: the same axes, as with "
        f"--columns {option}",
    )


def with_missing_axes(recording, options, names, columns):
    """Returns the recording with columns of zeros for the missing axes, and names the columns of all axes in
    options.columns. Adds a note about a planar log."""
    added = len(names.names)
    for quantity, found in columns.items():
        options.columns.pop(quantity, None)
        for part in PARTS[quantity]:
            if part[-1] in found:
                options.columns[part] = [str(found[part[-1]] + 1)]
            else:
                added += 1
                options.columns[part] = [str(added)]
        if quantity in options.named:
            options.named = options.named - {quantity} | set(PARTS[quantity])
    axes = list(columns["position"])
    recording = with_zeros(recording, added - len(names.names))
    if len(axes) == 2:
        missing = next(axis for axis in "xyz" if axis not in axes)
        single = ",".join(
            f"{quantity}={names.names[found[axes[1]]] or found[axes[1]] + 1}"
            for quantity, found in columns.items()
        )
        recording.notes.append(
            f"the log has the axes {axes[0]} and {axes[1]}: position and force along {missing} are read as 0 (for one "
            f"axis: --columns {single})"
        )
    return recording


def with_zeros(recording, count):
    """Returns the recording with `count` additional columns of zeros."""
    added = [f"{ABSENT}_{i}" for i in range(count)]
    if recording.is_binary:
        zeros = [np.zeros(len(recording.rows))] * count
        arrays = [recording.rows[name] for name in recording.names] + zeros
        rows = np.rec.fromarrays(arrays, names=recording.names + added)
        return Recording(
            recording.file, recording.names + added, rows, recording.row_numbers, "row"
        )
    rows = [row + [b"0"] * count for row in recording.rows]
    found = copy(recording)
    found.added = count
    found.names, found.rows, found.notes = recording.names + added, rows, list(recording.notes)
    return found


def extra_columns(names, quantity, word, axes):
    """Returns the columns of a quantity of EXTRA (velocity, measured force, number of contacts). `word`: name or number
    of a column that the user gave, or None. Fails if the log does not have this column or the columns of the other
    components. If `word` is None, searches for a column with a usual name, and returns None if the log does not have
    such a column or the columns of the other components. `axes`: axes of the log, such as "xyz"."""
    if word is not None:
        column, by_number = names.find(quantity, [word], FIRST_ENDINGS)
        if column is None:
            names.unknown(quantity, [word])
    else:
        usual = UsualNames(names)
        name = usual.find(USUAL[quantity])
        if name is None and len(axes) == 1:
            name = usual.find(ALONE.get(quantity, ""))
        if name is None:
            return None
        column, by_number = names.index(quantity, name), False
    if quantity == "contacts" or len(axes) == 1:
        return [column]
    if by_number:
        last = column + len(axes)
        if last > len(names.in_file()):
            names.fail(quantity, f"takes columns {column + 1} ... {last}")
        return list(range(column, last))
    found = names.components(column, tuple(axes))
    if found is None and word is not None:
        names.fail(
            quantity,
            f"the names do not say which columns go with {quoted(names.names[column])}; "
            f"allowed: {quantity}={column + 1} for it and the columns after it",
        )
    return found
