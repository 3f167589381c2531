"""Finds columns that state an orientation by their names, although neither the options nor usual names select them."""
import re

from .columns import UNITS
from .options import ORIENTATIONS

_CONVERT = "convert {} into a quaternion"
_QUATERNION = r"(q|quat|quaternion|orientation|orient|rotation|rot|attitude|att)"
# Components at the end of names: (regular expression of the text in front of the component, components, what to do).
# "{0}" is the first column's name, "{1}" the second column's name, and so on.
_W_FIRST = "--columns qw={0},qx={1},qy={2},qz={3} reads it"
_W_LAST = "--columns qx={0},qy={1},qz={2},qw={3} reads it"
_BY_NUMBER = "--columns orientation={0} --orientation quat_wxyz reads it, or --orientation quat_xyzw if {0} is its x"
_ENDINGS = (
    *((_QUATERNION, (w, "x", "y", "z"), _W_FIRST) for w in "rs"),
    *((_QUATERNION, ("i", "j", "k", w), _W_LAST) for w in "rsw"),
    (_QUATERNION, ("0", "1", "2", "3"), _BY_NUMBER),
    (_QUATERNION, ("1", "2", "3", "4"), _BY_NUMBER),
    (r"axis", ("x", "y", "z"), "--columns orientation={0} --orientation axis reads it"),
    (r"(r|rot|rotation|rvec|rotvec)", ("x", "y", "z"), _CONVERT.format("angles of a rotation")),
    (r"(angle|ang|orientation|attitude)", ("x", "y", "z"), _CONVERT.format("Euler angles")),
    *(
        (r"", angles, _CONVERT.format("Euler angles"))
        for angles in (("alpha", "beta", "gamma"), ("phi", "theta", "psi"))
    ),
)
_WITH_ANGLE = r"(.*[^a-z]|)(axis|a|e|k|n|u)[^a-z0-9]*x"
_MATRIX = r"(.*[^a-z]|)(r|rot|rotation|m|mat|matrix)[^a-z0-9]*[01]\D{0,2}[01]\D?"
# Names of Euler angles, which need no second column. Names of their rates are not Euler angles.
_EULER = re.compile(r"(^|[^a-z])(roll|pitch|yaw|euler|rpy)([^a-z]|$)")
_RATE = re.compile(r"rate|vel|speed|torque|gyro|(^|[^a-z])dot")


def unread_orientations(names, taken):
    """Returns (titles of the columns, what to do) of each orientation that the names of columns state. `taken`: indices
    of columns that are used otherwise."""
    keys, found, taken = [_key(names, column) for column in range(len(names.names))], [], set(taken)

    def add(columns, remedy):
        if columns and not taken & set(columns):
            taken.update(columns)
            title = ", ".join(map(names.title, columns))
            found.append((title, remedy.format(*(names.names[column] for column in columns))))

    for column, key in enumerate(keys):
        if re.fullmatch(_MATRIX, key):
            columns = names.components(column, ORIENTATIONS["matrix"], numbers=False)
            add(columns, "--columns orientation={0} reads it")
        if re.fullmatch(_WITH_ANGLE, key):
            columns = names.components(column, ("x", "y", "z", "angle"), numbers=False)
            add(columns, "--columns orientation={0} reads it")
    add(
        [i for i, key in enumerate(keys) if _EULER.search(key) and not _RATE.search(key)],
        _CONVERT.format("Euler angles"),
    )
    for head, components, remedy in _ENDINGS:
        for key in keys:
            if re.fullmatch(f"(.*[^a-z]|){head}[^a-z0-9]*{components[0]}", key):
                add(_columns(names, keys, key, components), remedy)
    return found


def _key(names, column):
    """Returns the name of a column in lower case, without its unit and without brackets around an index."""
    bare, unit = names.bare[column], names.units[column]
    key = re.sub(r"[\[\](){}<>]", "", bare.removesuffix(f"_{unit.text}") if unit else bare)
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", key).lower()


def _columns(names, keys, key, components):
    """Returns the columns of the components if each component has one column, otherwise an empty list. `key`: name of
    the first component's column. Numbered columns that continue, such as the joint angles q1 ... q6, and columns with
    units other than units of angles are no orientation."""
    head = key.removesuffix(components[0])
    if components[0].isdigit():
        around = {str(int(components[0]) - 1), str(int(components[-1]) + 1)}
        if any(head + number in keys for number in around):
            return []
    if any(keys.count(head + component) != 1 for component in components):
        return []
    columns = [keys.index(head + component) for component in components]
    units = [names.units[column].text for column in columns if names.units[column]]
    return columns if all(unit.lower() in UNITS["angle"] for unit in units) else []
