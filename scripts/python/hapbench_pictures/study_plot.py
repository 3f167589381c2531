"""Draws the picture of a folder that `limit`, `tune` or `converge` wrote. The files in the folder select the
picture."""
from collections import Counter

from hapbench.columns import is_number, number_in, read_records
from hapbench.errors import InputError
from hapbench.results import Files, MissingResult
from hapbench_command import print_warning
from hapbench_style import SETTINGS, SHEET, plt

from .convergence_plot import LEVELS, ORDERS, TIMES, draw_converge
from .limit_plot import LIMIT, LIMIT_RUNS, draw_limits
from .tuning_plot import LAWS, TRIALS, draw_tune
from .work_precision_plot import (
    ERRORS,
    MODEL_ERRORS,
    MODEL_TIMES,
    draw_model_errors,
    draw_work_precision,
)

PICTURES = {
    TRIALS: draw_tune,
    ERRORS: draw_work_precision,
    MODEL_ERRORS: draw_model_errors,
    LEVELS: draw_converge,
    LIMIT_RUNS: draw_limits,
}

KINDS = {
    TRIALS: "the trials of tune",
    ERRORS: "errors and run times of converge",
    MODEL_ERRORS: "errors and run times of converge",
    LEVELS: "the levels of converge",
    LIMIT_RUNS: "the limits of limit",
}


# For each table with details, the table with one row for each search, law, metric or level, and the columns that both
# share. The columns of limit_runs.csv depend on the search.
MAIN = {TRIALS: LAWS, MODEL_ERRORS: MODEL_TIMES, LEVELS: ORDERS, TIMES: LEVELS, LIMIT_RUNS: LIMIT}
KEYS = {
    TRIALS: ["algorithm"],
    MODEL_ERRORS: ["problem"],
    LEVELS: ["metric"],
    TIMES: ["value"],
    LIMIT_RUNS: [],
}


def kind_of(path):
    """Returns a description of the results in a folder, for messages."""
    return next(kind for name, kind in KINDS.items() if (path / name).is_file())


def draw_study(path, sheet=SHEET):
    files = Files(path)
    draw = next(draw for name, draw in PICTURES.items() if (path / name).is_file())
    try:
        with plt.rc_context(SETTINGS):
            for detail, main in MAIN.items():
                if all(files.has(name) for name in (detail, main)):
                    check_rows(files, detail, main)
            figure = draw(files, sheet)
    except MissingResult as error:
        raise InputError(f"{path}: {error}") from error
    except (LookupError, TypeError, ValueError) as error:
        read = ", ".join(sorted(files.sources))
        raise InputError(
            f"{path}: {read}: is not a table that hapbench wrote, or rows are missing: {error}"
        ) from error
    for name in sorted(files.sources):
        for text in infinite_numbers(path / name):
            print_warning(text)
    return figure


def check_rows(files, detail, main):
    """Prints a warning if two tables of a study do not name the same searches, laws, metrics or levels. `detail`: name
    of a table with one or several rows for each row of the table `main`."""
    rows, whole = files.records(detail), files.records(main)
    names = KEYS[detail] or columns_before_field(rows[0], whole[0])
    keys = [name for name in names if name in rows[0] and name in whole[0]]

    def key_of(row):
        return tuple(float(row[key]) if is_number(row[key]) else row[key] for key in keys)

    counts, known = Counter(map(key_of, rows)), set(map(key_of, whole))
    for row in rows:
        if key_of(row) not in known:
            words = ", ".join(f"{key} {row[key] or 'empty'}" for key in keys)
            print_warning(
                f"{row.file}: line {row.line}: {main} has no row with {words}; one of the files was cut or edited"
            )
            return
    for row in whole:
        found = counts[key_of(row)]
        is_counted = detail == LIMIT_RUNS and "runs" in row
        runs = number_in(row, "runs") if is_counted else max(found, 1)
        if runs != found:
            of_runs = f" of {runs:g}" if is_counted else ""
            print_warning(
                f"{rows[0].file}: {found or 'no'}{of_runs} rows for line {row.line} of {main}; the file was cut or "
                "edited"
            )
            return


def columns_before_field(row, of_main):
    """Returns the columns of limit_runs.csv that identify a search: all columns except the searched field and the class
    of a run."""
    return [name for name in row if name not in (of_main["field"], "class")]


def infinite_numbers(file):
    """Returns a list with a text about the first infinite number of a table; an empty list if there is no such number.
    The program writes an infinite number, for example, for the limit of a loop that is always stable.
    """
    return [
        f"{file}: line {row.line}: {name}: got {text}; infinite numbers are not drawn"
        for row in read_records(file)
        for name, text in row.items()
        if text.lstrip("+-").lower() in ("inf", "infinity")
    ][:1]
