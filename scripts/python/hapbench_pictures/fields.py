"""Fields of scenarios: in which some differ, and how a field is written in a legend or on an axis."""
import json

from hapbench_report.markup import column

# Titles of fields whose last name says too little, and symbols in formulas.
TITLES, SYMBOLS = {"time.step_s": "time step"}, {"rendering.stiffness_N_per_m": "K"}
NO_INPUT = ("expect", "description", "name", "source")


def differing(scenarios):
    """The paths at which they differ, with the value of each; names, descriptions and expectations aside."""
    flat = [dict(leaves(scenario)) for scenario in scenarios]
    values = {path: [fields.get(path) for fields in flat] for path in dict.fromkeys(p for fields in flat for p in fields)}
    return {path: of for path, of in values.items()
            if len({json.dumps(value, sort_keys=True) for value in of}) > 1 and not path.startswith(NO_INPUT)}


def leaves(value, path=""):
    if not isinstance(value, dict):
        yield path, value
        return
    for key, part in value.items():
        yield from leaves(part, f"{path}.{key}" if path else key)


def title_and_unit(path):
    """ "rendering.mass_kg" -> "mass", "kg"; no unit where the name has none."""
    title, unit, _ = column(path.rpartition(".")[2])
    return TITLES.get(path, title), unit


def axis(path, among=()):
    """A field or column as a title with its unit; by its whole path where another one would have the same title."""
    title, unit = title_and_unit(path)
    if any(other != path and title_and_unit(other)[0] == title for other in among):
        return path
    title = " ".join([title, SYMBOLS[path]]) if path in SYMBOLS else title
    return f"{title} [{unit}]" if unit else title


def entry(path, value, among):
    """A field and its value, for a legend: "K = 40 000 N/m"."""
    title, unit = title_and_unit(path)
    if any(other != path and title_and_unit(other)[0] == title for other in among):
        return f"{path}={shown(value)}"
    return f"{SYMBOLS.get(path, title)} = {shown(value)}{' ' if unit else ''}{unit}"


def shown(value):
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return value if isinstance(value, str) else json.dumps(value)
    if 1e4 <= abs(value) < 1e7 and value == int(value):
        return f"{int(value):,}".replace(",", " ")
    return f"{value:.6g}"
