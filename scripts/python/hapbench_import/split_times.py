"""Finds times in two columns: whole seconds, and the fractions of the seconds in a smaller unit, such as secs and nsecs
of ROS or tv_sec and tv_usec."""
import re

import numpy as np

_SECONDS = re.compile(r"(|.*[._ /-])(s|secs?|seconds?)")
# Key: unit of the fractions [s]. Value: endings of the names of their columns.
_FRACTIONS = {
    1e-3: "ms msecs? millis millisecs? milliseconds?",
    1e-6: "us usecs? micros microsecs? microseconds?",
    1e-9: "ns nsecs? nanos nanosecs? nanoseconds?",
}
_UNIT_IN_BRACKETS = re.compile(r"\s*[\[({<][^\[\](){}<>]*[\])}>]\s*$")
# Smallest fraction of all rows that repeat the time of the row before. The fractions of a second are then likely to be
# in a column that is not read.
MOST = 0.5


def fractions_of(recording, time):
    """Returns (column, unit [s]) of the fractions that belong to a column of whole seconds, or None. The name of the
    column states the unit, and its values are whole numbers of at least 0 s and below 1 s. Adds a note to the recording
    about a column with such a name and other values."""
    names = [_UNIT_IN_BRACKETS.sub("", name).lower() for name in recording.names]
    seconds = _SECONDS.fullmatch(names[time])
    if not seconds:
        return None
    found = [
        (column, unit)
        for unit, endings in _FRACTIONS.items()
        for column, name in enumerate(names)
        if name.startswith(seconds[1])
        and any(re.fullmatch(one, name[len(seconds[1]) :]) for one in endings.split())
    ]
    if not found or not _is_whole(recording.column(time)):
        return None
    fitting = [one for one in found if _is_fraction(recording.column(one[0]), one[1])]
    if len(fitting) == 1:
        return fitting[0]
    titles = ", ".join(recording.title(column) for column, _ in found)
    recording.notes.append(
        f"column {recording.title(time)} has whole seconds, and columns {titles} may all have their fractions: none is "
        "added"
        if fitting
        else f"column {recording.title(time)} has whole seconds, but column {titles} does not have their fractions "
        "(whole numbers from 0, below one second): it is not added"
    )
    return None


def name_of(unit):
    """Returns the name of a unit of fractions [s], such as "us"."""
    return _FRACTIONS[unit].split()[0]


def _is_whole(values):
    known = values[np.isfinite(values)]
    return bool((known == np.rint(known)).all())


def _is_fraction(values, unit):
    known = values[np.isfinite(values)]
    return (
        bool(len(known))
        and _is_whole(known)
        and known.min() >= 0.0
        and known.max() * unit < 1.0 - 1e-12
    )


def repeats_most(times):
    """Returns the number of times that equal the time before if most times do, otherwise 0."""
    known = times[np.isfinite(times)]
    repeated = int(np.sum(np.diff(known) == 0.0))
    return repeated if repeated > MOST * len(known) else 0


def remedy_of_repeated_times(recording, time, used):
    """Returns the likely cause of times that most rows repeat, and a remedy, for a message. `time`: column of the
    times. `used`: columns with another meaning. A column of fractions has whole numbers that increase while the time is
    constant, and that decrease when the time increases."""
    times = recording.column(time)
    for column in range(len(recording.names)):
        if column == time or column in used:
            continue
        values = recording.column(column)
        known = np.isfinite(times) & np.isfinite(values)
        steps, changes = np.diff(values[known]), np.diff(times[known]) != 0.0
        unit = next((one for one in _FRACTIONS if _is_fraction(values, one)), None)
        if unit and len(steps) and (steps[~changes] > 0.0).all() and (steps[changes] < 0.0).all():
            ending = _FRACTIONS[unit].split()[1].removesuffix("s?")
            return (
                f"column {recording.title(column)} may have the fractions of a second: name the columns t_sec and "
                f"t_{ending} in the header, and --columns time=t_sec joins them"
            )
    not_added = [note for note in recording.notes if note.endswith("added")]
    return not_added[0] if not_added else "is the column with the fractions of a second missing?"
