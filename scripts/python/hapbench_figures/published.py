"""The numbers that the thesis publishes, from results/reference/published (see results/reference/published.schema.json)."""
import json
from functools import lru_cache
from pathlib import Path

DIRECTORY = Path(__file__).resolve().parents[3] / "results" / "reference" / "published"


@lru_cache(maxsize=None)
def entries():
    """Every entry by its id."""
    found = {}
    for file in sorted(DIRECTORY.glob("*.json")):
        for entry in json.loads(file.read_text(encoding="utf-8"))["values"]:
            if entry["id"] in found:
                raise ValueError(f"{file}: id {entry['id']} appears twice")
            found[entry["id"]] = entry
    return found


def value(id_):
    """The number of an entry with a single one or a mean."""
    entry = entries()[id_]
    return entry["value"] if "value" in entry else entry["mean"]


def spread(id_):
    """Standard deviation or standard error, whichever the entry has."""
    entry = entries()[id_]
    return entry["std"] if "std" in entry else entry["standard_error"]
