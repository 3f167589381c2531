"""Draws the picture of a folder that `limit`, `tune` or `converge` wrote. The files in the folder select the
picture."""
from hapbench.errors import InputError
from hapbench.results import Files, MissingResult
from hapbench_style import SETTINGS, SHEET, plt

from .convergence_plot import LEVELS, draw_converge
from .limit_plot import LIMIT_RUNS, draw_limits
from .tuning_plot import TRIALS, draw_tune
from .work_precision_plot import ERRORS, MODEL_ERRORS, draw_model_errors, draw_work_precision

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


def kind_of(path):
    """Returns a description of the results in a folder, for messages."""
    return next(kind for name, kind in KINDS.items() if (path / name).is_file())


def draw_study(path, sheet=SHEET):
    draw = next(draw for name, draw in PICTURES.items() if (path / name).is_file())
    try:
        with plt.rc_context(SETTINGS):
            return draw(Files(path), sheet)
    except MissingResult as error:
        raise InputError(str(error)) from error
    except (KeyError, ValueError, IndexError) as error:
        raise InputError(f"{path}: is not a table that hapbench wrote: {error}") from error
