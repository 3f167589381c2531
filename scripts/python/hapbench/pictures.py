"""Draws results as matplotlib Figures, with the same content as the pictures of `hapbench plot`."""
import argparse
import json
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ._packages import find_packages

if TYPE_CHECKING:
    from .results import Folder, Run
    from .table import Table

WIDTHS = ("single", "double", "slide")


def plot(
    result: "Run | Folder",
    metric: str | Iterable[str] = (),
    y: str | Iterable[str] = (),
    where: str | Iterable[str] = (),
    width: str = "double",
) -> Any:
    """Returns the figure that `hapbench plot` draws of a result. Each argument is the option of the same name of the
    command."""
    if width not in WIDTHS:
        raise ValueError(f"width: got {width!r}; allowed: {', '.join(WIDTHS)}")
    find_packages()
    _import_pyplot()
    from hapbench_pictures.plot import figure_of

    with tempfile.TemporaryDirectory(prefix="hapbench-") as scratch:
        folder = result.folder or _write(result, Path(scratch))
        options = argparse.Namespace(
            runs=[str(folder)],
            metric=_names(metric),
            y=_names(y),
            where=_names(where),
            width=width,
            start=None,
            end=None,
            quiet=True,
        )
        return _for_notebooks(lambda: figure_of(options))


def plot_table(table: "Table", y: Iterable[str], x: str | None, width: str) -> Any:
    """Returns a figure of the columns `y` of a table over the column `x`."""
    if width not in WIDTHS:
        raise ValueError(f"width: got {width!r}; allowed: {', '.join(WIDTHS)}")
    find_packages()
    _import_pyplot()
    from hapbench_looks import series
    from hapbench_style import SETTINGS, SHEETS, legend_above, legend_height, plt

    of_numbers = [name for name, values in table.items() if values.dtype != object]
    if not of_numbers:
        raise ValueError(f"{table.name} has no column of numbers")
    x = x or ("time_s" if "time_s" in of_numbers else of_numbers[0])
    for name in (x, *y):
        table[name]  # raises a KeyError that lists the columns, if there is no column of this name
        if name not in of_numbers:
            raise ValueError(
                f"{table.name}: column {name!r} has texts; allowed: {', '.join(of_numbers)}"
            )
    others = [name for name in of_numbers if name != x and name != "step"]
    # Without names in `y`, draws all columns that have the same unit as the first column.
    shown = list(y) or [n for n in others if table.units[n] == table.units[others[0]]]
    units = {table.units[name] for name in shown}

    def draw() -> Any:
        sheet = SHEETS[width]
        with plt.rc_context(SETTINGS):
            figure, ((ax,),) = sheet.panels(1, 1, 2.2 + legend_height(shown, sheet.width))
            for name, look in zip(shown, series(len(shown))):
                ax.plot(table[x], table[name], color=look.colour, ls=look.line, label=name)
            ax.set_xlabel(_label(x, table.units[x]))
            ax.set_ylabel(_label(shown[0] if len(shown) == 1 else "", ", ".join(sorted(units))))
            if len(shown) > 1:
                legend_above(figure, *ax.get_legend_handles_labels(), columns=None)
            return figure

    return _for_notebooks(draw)


def _label(name: str, unit: str) -> str:
    return f"{name} [{unit or 1}]".lstrip()


def _names(given: str | Iterable[str]) -> list[str]:
    return given.split(",") if isinstance(given, str) else list(given)


def _import_pyplot() -> None:
    """Imports pyplot before the modules of the pictures. These modules select a backend without windows, unless pyplot
    is already imported. A notebook thus keeps its own backend."""
    import matplotlib.pyplot  # noqa: F401


def _for_notebooks(draw: Callable[[], Any]) -> Any:
    """Draws a figure, closes it for pyplot, and returns it. A notebook then shows the figure exactly once, as the value
    of a cell."""
    from hapbench_style import SCREEN_DPI, picture, plt

    figure = draw()
    plt.close(figure)
    figure._repr_png_ = lambda: picture(figure, "png", dpi=SCREEN_DPI)
    return figure


def _write(run: "Run", folder: Path) -> Path:
    """Writes a run that exists only in memory into a folder, as the files that the pictures read. Returns the folder of
    the run."""
    if run.trials:
        raise ValueError(
            f"{run.name} has {len(run.trials)} trials; allowed: a table of one, as run.trials[0].trajectory.plot()"
        )
    from .engine import _name_files

    scenario = json.loads(json.dumps(run.scenario))
    _name_files(scenario)
    (folder / "summary.json").write_text(json.dumps(run.summary), encoding="utf-8")
    (folder / "scenario.effective.json").write_text(json.dumps(scenario), encoding="utf-8")
    for name, table in run.tables.items():
        rows = np.column_stack(list(table.values()))
        lines = [",".join(table), *(",".join(map(_text, row)) for row in rows.tolist())]
        (folder / f"{name}.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return folder


def _text(number: float) -> str:
    return "" if number != number else repr(number)
