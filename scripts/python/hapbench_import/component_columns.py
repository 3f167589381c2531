"""Finds the columns of each quantity and of its components in a recording. The options name the columns."""
import re

from .columns import NAMED_AS, Names, scale_of
from .options import ORIENTATIONS
from .split_times import fractions_of, name_of
from .unread_orientation import unread_orientations

# Key: the components of a group, named as in --columns. Value: how the names of columns state these components, such as
# x in pos_x.
LETTERS = {
    ("px", "py", "pz"): ("x", "y", "z"),
    ("mfx", "mfy", "mfz"): ("x", "y", "z"),
    ("axis_x", "axis_y", "axis_z"): ("x", "y", "z"),
    ("axis_x", "axis_y", "axis_z", "angle"): ("x", "y", "z", "angle"),
    ("qw", "qx", "qy", "qz"): ("w", "x", "y", "z"),
    ("qx", "qy", "qz", "qw"): ("x", "y", "z", "w"),
}
# Components of all representations of an orientation, named as in --columns.
PARTS = list(dict.fromkeys(sum(ORIENTATIONS.values(), ())))


# Usual names of the w component of the tool's quaternion, in lower case and without other characters than letters.
USUAL_W = ("qw", "quatw", "quaternionw", "orientationw", "poseorientationw", "posequaternionw")


def add_usual_orientation(recording, options):
    """Adds the columns of a quaternion with usual names to options.columns, if the options neither name an orientation
    nor exclude it. Adds a note to the recording about this quaternion, or about columns of an orientation that are
    not read."""
    if options.orientation is not None or {"orientation", *PARTS} & set(options.columns):
        return
    names = Names(recording)
    found = [
        (re.sub(r"[^a-z]", "", name.lower()) in USUAL_W, column)
        for column, name in enumerate(names.bare)
        if re.search(r"(?i)(^|[^a-z])(q|quat|quaternion|orientation|rotation)[^a-z]*w$", name)
        and names.components(column, ("w", "x", "y", "z"), numbers=False)
    ]
    usual = [column for is_usual, column in found if is_usual]
    if len(usual) == 1:
        options.columns["orientation"] = [str(names.names[usual[0]])]
        quaternion = names.components(usual[0], ("w", "x", "y", "z"), numbers=False)
        recording.notes.append(
            "the orientation is read from the columns "
            f"{', '.join(map(names.title, quaternion))}, by their names (--orientation none: the tool does not rotate)"
        )
        return
    named = {names.find(quantity, words)[0] for quantity, words in options.columns.items()}
    unread = [
        (names.title(column), f"--columns orientation={names.names[column]} reads it")
        for _, column in found
    ]
    if not unread:
        unread = unread_orientations(names, named - {None})
    if unread:
        title, how = unread[0]
        recording.notes.append(
            f"the file has an orientation, {title}, that was not named, so the tool does not rotate ({how}; "
            "--orientation none omits this warning)"
        )


def one_axis(group):
    """Returns the end of an error message, which explains what to do with a recording of one axis. Returns an empty
    text for quantities other than position and force."""
    if group not in ("position", "force"):
        return ""
    return (
        " for x, y and z: a stroke has three components. Add columns of zeros to a recording of one axis "
        "(hapbench audit reads it as it is)"
    )


class Columns:
    """The columns that the options name. Each quantity has a list of column indices in the order of its components; the
    list is empty if the options name no column."""

    def __init__(self, recording, options):
        self._options, self.notes, self.scales = options, [], {}
        self.names = names = Names(recording)
        self.time = [] if options.sample_rate_Hz else self._group("time", ("time",))
        # Unit [s] of the second column of times, which has the fractions of whole seconds.
        self.unit_of_fractions = 0.0
        if self.time and (fractions := fractions_of(recording, self.time[0])):
            self.time.append(fractions[0])
            self.unit_of_fractions = fractions[1]
        self.position = self._group("position", ("px", "py", "pz"))
        if not self.position:
            names.fail("position", "is missing")
        if not options.sample_rate_Hz and not self.time:
            names.fail("time", "is missing (or give --set sample_rate_Hz=...)")
        self.kind = self._kind_of_orientation()
        self.orientation = self._group("orientation", ORIENTATIONS[self.kind])
        if not self.orientation and self.kind != "none" and "orientation" not in options.optional:
            names.fail("orientation", "is missing")
        self.force = self._group("force", ("mfx", "mfy", "mfz"))
        self._refuse_unused()
        self._refuse_shared()
        self._note_lone_order()
        self._note_other_quantity()

    def used(self):
        """Returns a dict from quantity to a list with a dict for each component: the component, and the number (from 1)
        and the name of its column."""
        return {
            quantity: [
                {
                    "component": component,
                    "column": column + 1,
                    "name": self.names.names[column],
                }
                for component, column in zip(components, columns)
            ]
            for quantity, components, columns in (
                (
                    "time",
                    ("s", name_of(self.unit_of_fractions)) if self.time[1:] else ("time",),
                    self.time,
                ),
                ("position", ("x", "y", "z"), self.position),
                ("orientation", ORIENTATIONS[self.kind], self.orientation),
                ("force", ("x", "y", "z"), self.force),
            )
        }

    def scale(self, quantity, columns):
        """Returns the factor from the unit of a quantity to its SI unit. Stores the factor in `scales`."""
        if quantity not in self.scales:
            given = self._options.scale.get(quantity)
            # A column of fractions of a second has the unit of its fractions.
            named = columns[:1] if quantity == "time" else columns
            self.scales[quantity] = scale_of(self.names, quantity, named, given, self.notes)
        return self.scales[quantity]

    def _group(self, group, parts):
        """Returns the columns of a group of components. The options may give one name for each component, the number of
        the first column, or the name of the first component's column."""
        wanted, named = self._options.columns, self._options.named
        alone = [part for part in parts if part != group and part in wanted]
        # The command line takes precedence over the preset.
        if alone and not (group in named and not named & set(alone)):
            if group in named:
                self.names.fail(
                    group,
                    f"its columns are given by {group} and by {alone[0]}; allowed: only one of the two",
                )
            for part in parts:
                if part not in wanted:
                    self.names.fail(
                        part, f"is missing; --columns names other components of {group}"
                    )
            return [self._column(part) for part in parts]
        if not parts or group not in wanted:
            return []
        if len(parts) == 1:
            column = self._column(group)
            return [] if column is None else [column]
        letters = LETTERS.get(parts, parts)
        first, by_number = self._first(group, letters)
        if first is None:
            if group not in self._options.optional:
                self.names.unknown(group, wanted[group])
            self.notes.append(
                f"the file has no columns of {group} with the names of the preset: the stroke has no {group}"
            )
            return []
        found = self.names.components(first, letters)
        if by_number:
            return self._consecutive(group, first, found, len(parts))
        if found is None:
            self._refuse_name(group, first, parts)
        if letters[0] not in ("w", "x") or len(letters) != 4 or letters[3] == "angle":
            if found[0] != first:
                self.names.fail(
                    group,
                    f"column {self.names.title(first)} is not its first component by name; allowed: "
                    f"{group}={self.names.names[found[0]]}",
                )
        elif found[0] != first:
            self.notes.append(self._other_order(first, found))
        return found

    def _first(self, group, letters):
        """Returns (column of the group's first component, True if the option gives its number). The option may give the
        name without the component, such as "pos" for "pos_x"."""
        endings = [f"{mark}{letters[0]}" for mark in ("_", ".", "")] + ["[0]", "_0", ".0", "0"]
        if letters[0] != "x":
            endings = ["_x", *endings]
        return self.names.find(group, self._options.columns[group], endings)

    def _consecutive(self, group, first, by_name, count):
        if first + count > len(self.names.names):
            self.names.fail(
                group, f"takes columns {first + 1} ... {first + count}{one_axis(group)}"
            )
        found = list(range(first, first + count))
        if by_name is not None and by_name != found:
            titles = ", ".join(map(self.names.title, found))
            self.notes.append(
                f"columns {titles} are read as {group} in this order, as their number says; by their names the order "
                f"would be {', '.join(map(self.names.title, by_name))} "
                f"(--columns {group}={self.names.names[by_name[0]]})"
            )
        return found

    def _refuse_name(self, group, first, parts):
        """Fails for a column name from which the names of the other components cannot be derived."""
        names, count = self.names, len(parts)
        alone = ",".join(f"{part}=..." for part in parts)
        consecutive = (
            f", or {group}={first + 1} for the columns "
            f"{', '.join(map(names.title, range(first, first + count)))}"
            if first + count <= len(names.names)
            else ""
        )
        names.fail(
            group,
            f'the names do not say which columns go with "{names.names[first]}"; allowed: {alone}{consecutive}'
            + ("" if consecutive else one_axis(group)),
        )

    def _other_order(self, first, found):
        shown = ", ".join(self.names.names[column] for column in sorted(found))
        return (
            f"--orientation {self.kind} says that the first component is "
            f"{self.names.names[found[0]]}, and --columns that "
            f"it is {self.names.names[first]}: the quaternion was read by the names of its columns ({shown})"
        )

    def _kind_of_orientation(self):
        """Returns the representation of the orientation: set by --orientation or the preset, else determined from the
        names of the columns."""
        kind, wanted = self._options.orientation, self._options.columns
        parts = {part for part in PARTS if part in wanted}
        if kind is not None or ("orientation" not in wanted and not parts):
            return kind or "none"
        if "orientation" not in wanted:
            return next((kind for kind, of in ORIENTATIONS.items() if parts <= set(of)), "none")
        first, by_number = self.names.find(
            "orientation", wanted["orientation"], ("_x", ".x", "x", "_w", ".w", "w")
        )
        if first is None:
            self.names.unknown("orientation", wanted["orientation"])

        def shown(kind):
            letters = LETTERS.get(ORIENTATIONS[kind], ORIENTATIONS[kind])
            return None if by_number else self.names.components(first, letters, numbers=False)

        if quaternion := shown("quat_wxyz"):
            return "quat_wxyz" if quaternion[0] == first else "quat_xyzw"
        for kind in ("axis_angle", "matrix"):
            if shown(kind):
                return kind
        kinds = ", ".join(kind for kind in ORIENTATIONS if kind != "none")
        self.names.fail(
            "orientation",
            f"the name of column {self.names.title(first)} does not show the kind of orientation; --orientation is "
            f"missing; allowed: {kinds} (convert Euler angles into one of these kinds first)",
        )

    def _refuse_unused(self):
        """Refuses a column that the command line names and that is not used."""
        used = {"time": self.time, "position": self.position, "force": self.force}
        used["orientation"] = self.orientation
        parts = {"position": ("px", "py", "pz"), "force": ("mfx", "mfy", "mfz")}
        for quantity in self._options.named:
            group = next((g for g, members in parts.items() if quantity in members), None)
            if quantity in PARTS and quantity not in ORIENTATIONS[self.kind]:
                of_kind = ", ".join(ORIENTATIONS[self.kind]) or "no columns"
                self.names.fail(quantity, f"is not used: --orientation {self.kind} takes {of_kind}")
            if not used.get(group or quantity, True):
                self.names.fail(
                    quantity, f"is not used: --orientation {self.kind} takes no columns"
                )

    def _refuse_shared(self):
        """Refuses two quantities that use the same column."""
        owners = {}
        for quantity, parts in self.used().items():
            for part in parts:
                other = owners.setdefault(part["column"], quantity)
                if other != quantity:
                    self.names.fail(
                        quantity,
                        f"column {self.names.title(part['column'] - 1)} is also named for {other}",
                    )

    def _note_lone_order(self):
        """Adds a note if the user assigned single components to columns whose names state another component."""
        wanted = self._options.columns
        for group, parts, columns in (
            ("position", ("px", "py", "pz"), self.position),
            ("force", ("mfx", "mfy", "mfz"), self.force),
            ("orientation", ("qw", "qx", "qy", "qz"), self._quaternion()),
        ):
            if len(columns) != len(parts) or not set(parts) <= set(wanted):
                continue
            by_name = self.names.components(columns[0], LETTERS[parts])
            if by_name and sorted(by_name) == sorted(columns) and by_name != columns:
                self.notes.append(
                    f"the columns of {group} are read as {', '.join(parts)} from "
                    f"{', '.join(map(self.names.title, columns))}, as --columns says; their names say otherwise"
                )

    def _note_other_quantity(self):
        """Adds a note if a position is read from columns that are named as forces, or a force from columns that are
        named as positions."""
        for group, columns, other in (
            ("position", self.position, "force"),
            ("force", self.force, "position"),
        ):
            bare = [self.names.bare[column].lower() for column in columns]
            if bare and all(map(NAMED_AS[other].fullmatch, bare)):
                self.notes.append(
                    f"the columns of {group} are {', '.join(map(self.names.title, columns))}, which are named as "
                    f"{other}"
                )

    def _quaternion(self):
        """Returns the columns of a quaternion, w first; empty for other representations."""
        if self.kind == "quat_xyzw":
            return self.orientation[3:] + self.orientation[:3]
        return self.orientation if self.kind == "quat_wxyz" else []

    def _column(self, quantity):
        column, _ = self.names.find(quantity, self._options.columns[quantity])
        if column is None and quantity not in self._options.optional:
            self.names.unknown(quantity, self._options.columns[quantity])
        return column
