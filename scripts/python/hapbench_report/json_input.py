"""Reading JSON that others wrote: what is wrong is told in one line with file, place, value and what is allowed."""
import json
import math

from hapbench.errors import InputError
from hapbench.results import read_json as load_json


def shown(value):
    text = json.dumps(value)
    return text if len(text) <= 60 else text[:57] + "…"


def load_object(file, **how):
    """An object; `how` as of json.loads. Raises InputError."""
    value = load_json(file, **how)
    if not isinstance(value, dict):
        raise InputError(f"{file}: /: got {shown(value)}; allowed: an object")
    return value


def member(value, key, kind, file, place, default=None):
    """value[key], which must be of that kind (object, array, string) when it is there."""
    names = {dict: "an object", list: "an array", str: "a string"}
    found = value.get(key, default)
    if found is not default and not isinstance(found, kind):
        raise InputError(f"{file}: {place}/{key}: got {shown(found)}; allowed: {names[kind]}")
    return found


def objects(value, key, file, place=""):
    """The array of objects value[key]; empty when it is absent."""
    found = member(value, key, list, file, place, [])
    for i, entry in enumerate(found):
        if not isinstance(entry, dict):
            raise InputError(f"{file}: {place}/{key}/{i}: got {shown(entry)}; allowed: an object")
    return found


def at(value, pointer):
    """The value that a JSON pointer names, or None."""
    for key in pointer.strip("/").split("/"):
        if isinstance(value, list):
            value = value[int(key)] if key.isdecimal() and int(key) < len(value) else None
        else:
            value = value.get(key) if isinstance(value, dict) else None
    return value


def number_or_none(value):
    """A finite number, else None. Booleans are not numbers here."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        return value if math.isfinite(value) else None
    except OverflowError:
        return None
