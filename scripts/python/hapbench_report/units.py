"""What the name of a column says: its title and unit, and the factor that makes its numbers short."""
from statistics import median

# Ending of a name -> unit; the longest that fits.
UNITS = {
    "N_per_m": "N/m", "N_s_per_m": "N s/m", "m_per_s": "m/s", "m_per_s2": "m/s²", "m2_per_s2": "m²/s²", "rad_per_s": "rad/s",
    "s_per_m": "s/m", "per_s": "1/s",
    "m": "m", "mm": "mm", "s": "s", "N": "N", "J": "J", "W": "W", "kg": "kg", "rad": "rad", "Hz": "Hz", "bytes": "bytes"}
PER = "seconds_per_"  # time of a step or of a call
SMALL_M = 0.01  # lengths below are shown in millimetres


def column(name, values=()):
    """Title, unit (empty for numbers without one) and factor of a column with these numbers."""
    if name.startswith(PER):
        return f"time of a {name.removeprefix(PER)}", "µs", 1e6
    ending = max((e for e in UNITS if name.endswith("_" + e)), key=len, default="")
    title, unit = name.removesuffix("_" + ending) if ending else name, UNITS.get(ending, "")
    sizes = [abs(value) for value in values if value]
    if unit == "m" and sizes and median(sizes) < SMALL_M:
        return spaced(title), "mm", 1e3
    return spaced(title), unit, 1


def spaced(name):
    return name.replace("_", " ")
