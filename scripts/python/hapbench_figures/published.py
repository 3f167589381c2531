"""The numbers that the thesis publishes, from results/reference/published.json."""
import json
from functools import lru_cache
from pathlib import Path

LEDGER = "claims.json"  # beside the results: what was measured for each claim
FILE = Path(__file__).resolve().parents[3] / "results" / "reference" / "published.json"


@lru_cache(maxsize=None)
def entries():
    """Every entry by its id."""
    return {entry["id"]: entry for entry in json.loads(FILE.read_text(encoding="utf-8"))["values"]}


def value(id_):
    """The number of an entry with a single one or a mean."""
    entry = entries()[id_]
    return entry["value"] if "value" in entry else entry["mean"]


def spread(id_):
    """Standard deviation or standard error, whichever the entry has."""
    entry = entries()[id_]
    return entry["std"] if "std" in entry else entry["standard_error"]
