"""What scripts/bench has measured: performance.json in the folder of results, if it is there."""
from pathlib import Path

from .json_input import InputError, load_object, member, objects, shown

FILE = "performance.json"
NUMBERS = {"ratios": ("ratio", "low", "high", "seconds"), "limits": ("value", "at_most")}
TEXTS = {"ratios": ("what", "over"), "limits": ("what", "unit")}


def load_performance(results: Path):
    """The object, its rows checked; None without a file."""
    file = results / FILE
    if not file.is_file():
        return None
    value = load_object(file)
    for key in ("commit", "date"):
        require(value, key, str, file, "")
    machine = member(value, "machine", dict, file, "", {})
    for key in ("cpu", "instruction_set", "compiler", "flags"):
        require(machine, key, str, file, "/machine")
    for part in NUMBERS:
        for i, row in enumerate(objects(value, part, file)):
            for key in TEXTS[part]:
                require(row, key, str, file, f"/{part}/{i}")
            for key in NUMBERS[part]:
                require(row, key, (int, float), file, f"/{part}/{i}")
            if row.get("at_most") is not None:
                require(row, "at_most", (int, float), file, f"/{part}/{i}")
    return value


def require(value, key, kind, file, place):
    found = value.get(key)
    if not isinstance(found, kind) or isinstance(found, bool):
        raise InputError(f"{file}: {place}/{key}: got {shown(found)}; allowed: {'a string' if kind is str else 'a number'}")
