"""Reads what hapbench wrote: tables (CSV) and summaries (JSON) below one directory."""
import csv
import io
import json
from functools import lru_cache
from pathlib import Path

import numpy as np


class MissingResult(Exception):
    """A figure's data is not there; the figure is skipped."""


class BadResult(Exception):
    """A result file cannot be understood."""


@lru_cache(maxsize=None)
def _numbers(path):
    with open(path, encoding="utf-8") as file:
        names = file.readline().strip().split(",")
        # Empty cells, such as the ratio of a row without contact; twice, as of two beside each other one is found.
        body = file.read().replace(",,", ",nan,").replace(",,", ",nan,").replace(",\n", ",nan\n")
    rows = np.loadtxt(io.StringIO(body), delimiter=",", ndmin=2)
    if rows.shape[0] == 0:
        raise ValueError("no rows")
    if rows.shape[1] != len(names):
        raise ValueError(f"{len(names)} columns in the first line, {rows.shape[1]} in the others")
    return {name: rows[:, i] for i, name in enumerate(names)}


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
        return self._read(path, _numbers)

    def records(self, path):
        """Rows as dictionaries of texts, for tables that hold names or gaps."""

        def read(file):
            with open(file, encoding="utf-8", newline="") as stream:
                rows = list(csv.DictReader(stream))
            if not rows:
                raise ValueError("no rows")
            return rows

        return self._read(path, read)

    def json(self, path):
        return self._read(path, lambda file: json.loads(file.read_text(encoding="utf-8")))

    def _read(self, path, read):
        file = self.directory / path
        if not file.is_file():
            raise MissingResult(f"no {path}")
        self.sources.add(path)
        try:
            return read(file)
        except (ValueError, OSError) as error:
            raise BadResult(f"{file}: {error}") from error


def numbers(records, name):
    """A column of `records`, gaps as not-a-number."""
    return np.array([float(row[name]) if row[name] else np.nan for row in records])


def envelope(time, values, bins):
    """Least and greatest value in each of so many spans of time: what a plot of all rows would show."""
    parts = [part for part in np.array_split(np.arange(len(time)), bins) if len(part)]
    middle = np.array([time[part].mean() for part in parts])
    return (middle, np.array([values[part].min() for part in parts]), np.array([values[part].max() for part in parts]))
