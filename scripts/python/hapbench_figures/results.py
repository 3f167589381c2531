"""Reads what hapbench wrote: tables (CSV) and summaries (JSON) below one directory."""
from functools import lru_cache
from pathlib import Path

import numpy as np

from hapbench.columns import read_columns, read_records
from hapbench.errors import ResultError
from hapbench.results import read_json


class MissingResult(Exception):
    """A figure's data is not there; the figure is skipped."""


# Several figures show one table.
_columns = lru_cache(maxsize=None)(read_columns)


def _records(file):
    rows = read_records(file)
    if not rows:
        raise ResultError(f"{file}: no rows")
    return rows


class Results:
    """A directory of results, as scripts/reproduce leaves it. Remembers what was read since `start`."""

    def __init__(self, directory):
        self.directory = Path(directory)
        self.sources = set()

    def start(self):
        self.sources = set()

    def has(self, path):
        return (self.directory / path).is_file()

    def glob(self, pattern):
        return sorted(p.relative_to(self.directory).as_posix() for p in self.directory.glob(pattern))

    def table(self, path):
        """Columns of numbers by name."""
        return self._read(path, _columns)

    def records(self, path):
        """Rows as dictionaries of texts, for tables that hold names or gaps."""
        return self._read(path, _records)

    def json(self, path):
        return self._read(path, read_json)

    def _read(self, path, read):
        file = self.directory / path
        if not file.is_file():
            raise MissingResult(f"no {path}")
        self.sources.add(path)
        return read(file)


def numbers(records, name):
    """A column of `records`, gaps as not-a-number."""
    return np.array([float(row[name]) if row[name] else np.nan for row in records])
