"""Reads the columns of a mapping from names to arrays, such as a pandas.DataFrame, as a Recording."""
import re

import numpy as np
from hapbench_command import fail
from hapbench_import.columns import without_unit
from hapbench_import.recording import EXACT, Recording

from .usual_columns import ALONE, FIRST_ENDINGS, USUAL, key_of


def of_table(problem, why):
    """Returns the problem of a table's audit, without options that only the command has. `why`: dict from a column to
    the reason why it is not read."""
    problem = problem.replace("--skip-bad-rows skips bad rows", "leave such rows out of the table")
    problem = re.sub(
        r"--set sample_rate_Hz=([\d.]+) instead of a column of times reads the rows at this rate",
        r"the times k / \1 of the rows k have this rate",
        problem,
    )
    return "; ".join([problem, *why.values()])


def quantity_of(name, columns):
    """Returns the quantity that a column of this name has, or None. `columns`: dict from quantity to the column that
    the user named."""
    for quantity, column in columns.items():
        if name in [f"{column}{end}" for end in ("", *FIRST_ENDINGS)]:
            return quantity
    key = key_of(without_unit(name)[0])
    return next(
        (
            quantity
            for quantity, usual in USUAL.items()
            if key in usual.split() + ALONE.get(quantity, "").split()
        ),
        None,
    )


def recording_of(table):
    """Returns (the columns of numbers of the table as a Recording, dict from the name of each other column to the
    reason why it is not read). An array of two or three columns becomes the columns NAME_x, NAME_y, NAME_z.
    """
    numeric, unread = {}, {}
    for name in table:
        try:
            numeric |= numbers_of(str(name), table[name])
        except ValueError as error:
            unread[str(name)] = str(error)
    lengths = {len(values) for values in numeric.values()}
    if len(lengths) != 1:
        fail(
            "; ".join(
                [
                    f"the table has columns of {sorted(lengths)} numbers; allowed: one length",
                    *(f"column {name}: {reason}" for name, reason in unread.items()),
                ]
            )
        )
    rows = np.rec.fromarrays(list(numeric.values()), names=list(numeric))
    return Recording("table", list(numeric), rows, range(1, len(rows) + 1), "row"), unread


def numbers_of(name, given):
    """Returns a dict from column names to arrays of numbers; NaN for values that are masked, missing or no numbers.
    Raises ValueError if `given` has no numbers or another shape than one column or the components x, y, z.
    """
    values = np.asarray(given)
    if values.ndim not in (1, 2) or values.ndim == 2 and not 1 <= values.shape[1] <= 3:
        raise ValueError(
            f"got shape {values.shape}; allowed: one column of numbers for each component, or an array of the columns "
            "x, y and z"
        )
    if values.dtype.kind in "mM":  # times with a unit
        values = np.where(
            np.isnat(values), np.nan, (values - first_time(values)) / np.timedelta64(1, "ns") * 1e-9
        )
    elif values.dtype.kind in "OSU":
        values = np.vectorize(number_or_nan, otypes=[float])(values)
        if not np.isfinite(values).any():
            raise ValueError("got no numbers; allowed: numbers")
    elif values.dtype.kind not in "biuf":
        raise ValueError(f"got {values.dtype} values; allowed: numbers")
    if is_large(values):
        values = values - values[0]
    values = values.astype(float)
    if isinstance(given, np.ma.MaskedArray):
        values = np.where(np.ma.getmaskarray(given), np.nan, values)
    if values.ndim == 1 or values.shape[1] == 1:
        return {name: values.ravel()}
    return {f"{name}_{axis}": column for axis, column in zip("xyz", values.T)}


def first_time(values):
    """Returns the first time that is not missing; the first if all are missing."""
    known = values[~np.isnat(values)]
    return known[0] if known.size else values.flat[0]


def number_or_nan(value):
    try:
        return float(value)
    except (TypeError, ValueError):
        return np.nan


def is_large(values):
    """Returns True for integers that a double cannot represent exactly, such as nanoseconds since 1970. The caller
    makes such values relative to the first row."""
    return (
        np.issubdtype(values.dtype, np.integer)
        and values.ndim == 1
        and len(values) > 0
        and abs(int(values[-1])) > EXACT
    )
