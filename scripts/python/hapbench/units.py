"""Units, by the names of columns."""

# Ending of a name -> unit; the longest that fits.
UNITS = {
    "N_per_m": "N/m", "N_s_per_m": "N s/m", "m_per_s": "m/s", "m_per_s2": "m/s²", "m2_per_s2": "m²/s²", "rad_per_s": "rad/s",
    "s_per_m": "s/m", "per_s": "1/s",
    "m": "m", "mm": "mm", "s": "s", "N": "N", "Nm": "N m", "J": "J", "W": "W", "kg": "kg", "rad": "rad", "Hz": "Hz", "bytes": "bytes"}


def ending_of(name):
    """The end of a name that says its unit, "" where it has none."""
    return max((ending for ending in UNITS if name.endswith("_" + ending)), key=len, default="")


def unit_of(name):
    """The unit of a column, "" where its name says none."""
    return UNITS.get(ending_of(name), "")
