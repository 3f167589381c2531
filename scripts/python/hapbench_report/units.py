"""What the name of a column says: its title and unit, and the factor that makes its numbers short."""
from statistics import median

from hapbench.units import ending_of, unit_of

PER = "seconds_per_"  # time of a step or of a call
SMALL_M = 0.01  # lengths below are shown in millimetres


def column(name, values=()):
    """Title, unit (empty for numbers without one) and factor of a column with these numbers."""
    if name.startswith(PER):
        return f"time of a {name.removeprefix(PER)}", "µs", 1e6
    ending = ending_of(name)
    title, unit = name.removesuffix("_" + ending) if ending else name, unit_of(name)
    sizes = [abs(value) for value in values if value]
    if unit == "m" and sizes and median(sizes) < SMALL_M:
        return spaced(title), "mm", 1e3
    return spaced(title), unit, 1


def spaced(name):
    return name.replace("_", " ")
