"""Classes that read results of the program: Run (one run), Folder (a folder of results) and Files (single files below a
folder). Importing them does not need the compiled module hapbench._hapbench."""
import html
import json
import math
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache, cached_property, lru_cache
from pathlib import Path
from typing import Any

from .columns import read_columns, read_mixed, read_records, read_text
from .errors import ResultError
from .table import Table, joined, unit_of

SUMMARY, SCENARIO = "summary.json", "scenario.effective.json"
COMPARISON, RANKING = "comparison", "ranking"  # names of the tables that `compare` writes
KINDS = {dict: "an object", list: "an array", str: "a string"}


def read_json(file, **how):
    """Returns the content of a JSON file. `how`: keyword arguments of json.loads. Raises ResultError if the file cannot
    be read or parsed."""
    try:
        return json.loads(read_text(file), **how)
    except (ValueError, RecursionError) as error:
        raise ResultError(f"{file}: not JSON: {error}") from error


def read_object(file, **how):
    """Returns the object in a JSON file. `how`: keyword arguments of json.loads. Raises ResultError if the file cannot
    be read or holds no object."""
    value = read_json(file, **how)
    if not isinstance(value, dict):
        raise ResultError(f"{file}: /: got {shown(value)}; allowed: an object")
    return value


def shown(value):
    text = json.dumps(value)
    return text if len(text) <= 60 else text[:57] + "…"


def member(value, key, kind, file, pointer="", default=None):
    """Returns value[key], or `default` if the key is missing. Raises ResultError if value[key] does not have the type
    `kind` (dict, list or str)."""
    found = value.get(key, default)
    if found is not default and not isinstance(found, kind):
        raise ResultError(f"{file}: {pointer}/{key}: got {shown(found)}; allowed: {KINDS[kind]}")
    return found


def objects(value, key, file):
    """Returns the array value[key], or an empty list if the key is missing. Raises ResultError if an element is not an
    object."""
    found = member(value, key, list, file, default=[])
    for i, entry in enumerate(found):
        if not isinstance(entry, dict):
            raise ResultError(f"{file}: /{key}/{i}: got {shown(entry)}; allowed: an object")
    return found


def at(value, pointer):
    """Returns the value at a JSON pointer, or None if the pointer leads nowhere."""
    for key in pointer.strip("/").split("/"):
        if isinstance(value, list):
            value = value[int(key)] if key.isdecimal() and int(key) < len(value) else None
        else:
            value = value.get(key) if isinstance(value, dict) else None
    return value


def objects_in(value):
    """Yields every object in a JSON value, outermost first."""
    if isinstance(value, dict):
        yield value
    for part in (
        value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    ):
        yield from objects_in(part)


def number_or_none(value):
    """Returns a finite number unchanged, and None for anything else. A boolean is not a number."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        return value if math.isfinite(value) else None
    except OverflowError:
        return None


class Tables(Mapping[str, Table]):
    """A mapping from names to tables. Each table is read from its file at its first use."""

    def __init__(self, readers: Mapping[str, Callable[[], Table]]) -> None:
        self._readers = {name: cache(read) for name, read in readers.items()}

    def __getitem__(self, name: str) -> Table:
        return self._readers[name]()

    def __iter__(self) -> Iterator[str]:
        return iter(self._readers)

    def __len__(self) -> int:
        return len(self._readers)


class _WithTables:
    """Base class that offers tables as attributes: `run.trajectory` is `run.tables["trajectory"]`."""

    tables: Mapping[str, Table]

    def __getattr__(self, name: str) -> Table:
        if name.startswith("_") or name == "tables":
            raise AttributeError(name)
        if name in self.tables:
            return self.tables[name]
        raise AttributeError(self._no_table(name))

    def _no_table(self, name: str) -> str:
        return f"no table or attribute {name!r}; tables: {', '.join(self.tables) or 'none'}"

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.tables]


class Run(_WithTables):
    """Results of one run.

    `summary`, `scenario` (with every default filled in) and `timing` are dicts: the contents of summary.json,
    scenario.effective.json and timing.json. The recorded tables are attributes. The table `trajectory` is always
    recorded; the tables `contacts`, `stiffness_tensor`, `ratios`, `energy`, `ideal_trajectory`, `force_reference`,
    `six_dof` and `targets` are recorded if the scenario requests them. The mapping `tables` has the same tables by
    name. If a scenario has several trials, each element of `trials` holds the tables of one trial.

    `folder` is the folder from which the run was read, or None if hapbench.run() has computed the run in memory.
    `unmet` lists the expectations of the scenario that a run in memory did not meet; it is None for a run from a
    folder.
    """

    def __init__(
        self,
        summary: dict[str, Any],
        scenario: dict[str, Any],
        tables: Mapping[str, Table],
        timing: dict[str, Any] | None = None,
        trials: "Iterable[Trial]" = (),
        folder: Path | None = None,
        unmet: list[str] | None = None,
    ) -> None:
        self.summary, self.scenario, self.timing = summary, scenario, timing or {}
        self.tables, self.trials, self.folder = tables, list(trials), folder
        self.unmet = unmet

    @property
    def name(self) -> str:
        return str(self.summary.get("name", ""))

    @property
    def algorithm(self) -> str:
        return str(self.summary.get("algorithm", ""))

    @property
    def outcome(self) -> str:
        return str(self.summary.get("outcome", ""))

    @property
    def expected(self) -> bool:
        """True if the run ended as its scenario expects."""
        return bool(self.summary.get("expected"))

    @property
    def warnings(self) -> list[str]:
        texts = self.summary.get("warnings")
        return [str(warning) for warning in texts] if isinstance(texts, list) else []

    @property
    def metrics(self) -> dict[str, Any]:
        found = self.summary.get("metrics")
        return found if isinstance(found, dict) else {}

    @property
    def state_hash(self) -> str | None:
        """Hash of the bit patterns of position, velocity and force in every step. Identical runs have equal hashes."""
        return self.summary.get("state_hash")

    def plot(
        self, y: str | Iterable[str] = (), metric: str | Iterable[str] = (), width: str = "double"
    ) -> Any:
        """Returns the matplotlib Figure that `hapbench plot` draws of this run. Each argument has the meaning of the
        option of the same name: `y` names the quantities over time, `metric` names metrics, and `width` is "single",
        "double" (the column widths of a journal) or "slide"."""
        from .pictures import plot

        return plot(self, metric=metric, y=y, width=width)

    def _repr_html_(self) -> str:
        """Returns outcome, metrics with units, and warnings as HTML for a notebook."""
        rows = "".join(
            f"<tr><td>{html.escape(name)}</td><td>{value:.5g}</td><td>{html.escape(unit_of(name))}</td></tr>"
            for name, value in self.metrics.items()
            if number_or_none(value) is not None
        )
        warnings = "".join(f"<p>Warning: {html.escape(text)}</p>" for text in self.warnings)
        return (
            f"<p><b>{html.escape(self.name)}</b> with {html.escape(self.algorithm)}: {html.escape(self.outcome)}</p>"
            f"{warnings}<details><summary>metrics</summary><table><tbody>{rows}</tbody></table></details>"
        )

    def _no_table(self, name: str) -> str:
        fields = {
            "contacts",
            "energy",
            "stiffness_tensor",
            "ideal_trajectory",
            "force_reference",
            "six_dof",
            "trajectory",
        }
        hint = f"; hapbench.run(…, record=[{name!r}]) records it" if name in fields else ""
        trials = (
            f"; it has {len(self.trials)} trials with tables of their own" if self.trials else ""
        )
        return super()._no_table(name) + trials + hint

    def __repr__(self) -> str:
        return f"<run {self.name} with {self.algorithm}: {self.outcome}, tables {', '.join(self.tables) or 'none'}>"


class Folder(_WithTables):
    """Results in a folder that a command such as sweep, compare or limit wrote.

    `tables` maps relative paths (without .csv) to the tables of the CSV files below the folder, except the files of
    single runs. `runs` maps relative paths to the runs below the folder. `json` maps names (without .json) to the
    contents of the JSON files in the folder. `folder.sweep` is the table of sweep.csv. A comparison of several
    scenarios has one table for each scenario; `folder.comparison` concatenates these tables and adds a column with the
    scenario.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)
        files = [file for file in sorted(self.folder.rglob("*.csv")) if not _is_of_run(file)]
        readers = {
            file.relative_to(self.folder).with_suffix("").as_posix(): _reader(file, _columns_of)
            for file in files
        }
        parts = {
            name.rpartition("/")[0]: name for name in readers if name.endswith(f"/{COMPARISON}")
        }
        if parts and COMPARISON not in readers:
            readers[COMPARISON] = lambda: joined(
                {scene: self.tables[name] for scene, name in parts.items()}, "scenario", COMPARISON
            )
        self.tables = Tables(readers)

    @cached_property
    def runs(self) -> dict[str, Run]:
        files = sorted(self.folder.rglob(SUMMARY))
        found = {
            file.parent.relative_to(self.folder).as_posix(): load_run(file.parent) for file in files
        }
        for run in found.values():
            # The files of the run may be in a temporary folder that is deleted together with this Folder object. The
            # run therefore keeps a reference to this object.
            run.part_of = self
        return found

    @cached_property
    def json(self) -> dict[str, Any]:
        return {file.stem: read_json(file) for file in sorted(self.folder.glob("*.json"))}

    def plot(
        self,
        metric: str | Iterable[str] = (),
        y: str | Iterable[str] = (),
        where: str | Iterable[str] = (),
        width: str = "double",
    ) -> Any:
        """Returns the matplotlib Figure that `hapbench plot` draws of this folder. `metric`: names of the metrics that
        are drawn for each law, or one column of sweep.csv. `y`: names of the quantities that are drawn over time.
        `where`: conditions that select rows of sweep.csv. `width`: see Run.plot()."""
        from .pictures import plot

        return plot(self, metric=metric, y=y, where=where, width=width)

    def _repr_html_(self) -> str:
        """Returns HTML for a notebook: the folder, the names of its tables, its number of runs, and one table. This
        table is the ranking, otherwise the comparison, otherwise the first table."""
        first = next(
            (name for name in (RANKING, COMPARISON, *self.tables) if name in self.tables), None
        )
        shown = self.tables[first]._repr_html_() if first else ""
        names = html.escape(", ".join(self.tables) or "none")
        return (
            f"<p>{html.escape(str(self.folder))}: tables {names}; {len(self.runs)} runs</p>{shown}"
        )

    def __repr__(self) -> str:
        return f"<{self.folder}: tables {', '.join(self.tables) or 'none'}>"


def load(folder: str | os.PathLike[str]) -> "Run | Folder":
    """Reads a folder of results. Returns a Run if the folder holds one run, otherwise a Folder of tables and runs.
    Raises ResultError if the folder or a file cannot be read."""
    folder = Path(folder)
    if not folder.is_dir():
        raise ResultError(
            f"{folder}: is not a folder; allowed: a folder that run, compare, sweep, limit … wrote"
        )
    if (folder / SUMMARY).is_file():
        return load_run(folder)
    found = Folder(folder)
    if not found.tables and not found.runs:
        raise ResultError(f"{folder}: holds no results of hapbench")
    return found


def load_run(folder, kind=Run):
    """Returns the run in a folder as an object of the class `kind`, which is Run or derived from Run."""
    folder = Path(folder)
    trials = sorted(
        folder.glob("subject_*_trial_*"),
        key=lambda trial: [int(number) for number in re.findall(r"\d+", trial.name)],
    )
    return kind(
        read_object(folder / SUMMARY),
        _optional(folder / SCENARIO),
        _tables_of(folder),
        timing=_optional(folder / "timing.json"),
        folder=folder,
        trials=[Trial(_tables_of(trial, folder)) for trial in trials],
    )


class Trial(_WithTables):
    """The tables of one trial of a run."""

    def __init__(self, tables: Mapping[str, Table]) -> None:
        self.tables = tables

    def __repr__(self) -> str:
        return f"<trial: tables {', '.join(self.tables) or 'none'}>"


def _is_of_run(file):
    return any((folder / SUMMARY).is_file() for folder in list(file.parents)[:2])


def _tables_of(folder, described=None):
    columns = _optional((described or folder) / "columns.json")
    return Tables(
        {file.stem: _reader(file, columns.get(file.name)) for file in sorted(folder.glob("*.csv"))}
    )


def _columns_of(file):
    """Returns the descriptions that `hapbench describe` prints of the columns of `file`; they depend only on the file's
    name. Returns an empty list if the compiled module cannot be imported."""
    try:
        from .engine import columns_of
    except ImportError:
        return []
    return columns_of(file.name)


def _reader(file, described=None):
    """Returns a function that reads the table of `file`. `described`: a list with name, unit and meaning of each
    column, or a function that returns this list for a file, or None. If `described` is a list that is not empty, all
    columns must contain numbers; otherwise columns may also contain texts."""

    def read():
        if not described or callable(described):
            columns = read_mixed(file)
            known = {
                c["name"]: c for c in (described(file) if described else []) if c["name"] in columns
            }
            field = columns.get("field", [""])
            units = {"unit of the field": unit_of(field[0]) if len(set(field)) == 1 else ""}
            return Table(
                columns,
                {name: units.get(c["unit"], c["unit"]) for name, c in known.items()},
                {name: c["meaning"] for name, c in known.items()},
                file.stem,
            )
        return Table(
            read_columns(file, may_be_empty=True),
            {c["name"]: c["unit"] for c in described},
            {c["name"]: c["meaning"] for c in described},
            file.stem,
        )

    return read


def _optional(file):
    return read_object(file) if file.is_file() else {}


class MissingResult(Exception):
    """Raised if a result file does not exist."""


class Files:
    """Reads tables and JSON files below a directory. The argument `path` of each method is relative to the directory.
    `sources`: the paths that were read since `sources` was last cleared."""

    def __init__(self, directory):
        self.directory, self.sources = Path(directory), set()

    def has(self, path):
        return (self.directory / path).is_file()

    def table(self, path):
        """Returns the columns of a table of numbers, by name."""
        return self._read(path, _columns)

    def records(self, path):
        """Returns each row of a table as a dict from column name to text. A text may be empty and need not be a number.
        Raises ResultError if there are no rows."""
        rows = self._read(path, read_records)
        if not rows:
            raise ResultError(f"{self.directory / path}: no rows")
        return rows

    def json(self, path):
        return self._read(path, read_json)

    def _read(self, path, read):
        if not self.has(path):
            raise MissingResult(f"no {path}")
        self.sources.add(path)
        return read(self.directory / path)


# The columns are cached, because several figures draw the same table.
_columns = lru_cache(maxsize=16)(read_columns)
