"""Tables that hapbench writes as CSV: stability limits, precision studies and their times, comparisons."""
import csv
from dataclasses import dataclass
from pathlib import Path

from .json_input import InputError

# The stability limits, which stand beside the published ones.
LIMITS = "stability/limits.csv"
# A longer one is the data of a figure, not a table to read.
MOST_ROWS = 100


@dataclass
class Study:
    path: str  # of its file, relative to the results
    header: list
    rows: list

    @property
    def title(self):
        return Path(self.path).stem.replace("_", " ")

    @property
    def anchor(self):
        return "study-" + "".join(c if c.isalnum() else "-" for c in self.path)


def load_study(file: Path, results: Path):
    try:
        with file.open(newline="", encoding="utf-8") as text:
            rows = [row for row in csv.reader(text) if row]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{file}: cannot be read: {error}") from error
    if not rows:
        raise InputError(f"{file}: empty; allowed: a header line and rows")
    for line, row in enumerate(rows[1:], start=2):
        if len(row) != len(rows[0]):
            raise InputError(f"{file}: line {line}: got {len(row)} fields; allowed: {len(rows[0])}, as in the header")
    return Study(file.relative_to(results).as_posix(), rows[0], rows[1:])


def load_studies(results: Path):
    """The CSV tables that stand beside runs rather than in one."""
    files = [file for file in sorted(results.rglob("*.csv"))
             if not file.with_name("summary.json").exists() and is_table(file.relative_to(results))]
    return [study for study in (load_study(file, results) for file in files) if len(study.rows) <= MOST_ROWS]


def is_table(path: Path):
    return path.parts[0] != "replay" and not path.name.startswith("stability_")
