"""Tables that hapbench writes as CSV: stability limits, precision studies and their times, comparisons."""
from dataclasses import dataclass
from pathlib import Path

from hapbench.columns import read_rows

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
    return Study(file.relative_to(results).as_posix(), *read_rows(file))


def load_studies(results: Path):
    """The CSV tables that stand beside runs rather than in one."""
    files = [file for file in sorted(results.rglob("*.csv"))
             if not file.with_name("summary.json").exists() and is_table(file.relative_to(results))]
    return [study for study in (load_study(file, results) for file in files) if len(study.rows) <= MOST_ROWS]


def is_table(path: Path):
    return path.parts[0] != "replay" and not path.name.startswith("stability_")
