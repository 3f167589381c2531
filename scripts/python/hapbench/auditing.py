"""hapbench.audit(): analyses the log of any haptic or contact engine."""
import os
from collections.abc import Mapping
from typing import Any

from ._packages import find_packages
from .errors import InputError


def audit(
    table: Mapping[str, Any],
    device: str | os.PathLike | None = None,
    *,
    columns: Mapping[str, str | int] | None = None,
    scale: Mapping[str, float] | None = None,
    force_by_tool: bool = False,
    touch: float | None = None,
) -> dict[str, Any]:
    """Reports energy, vibration and stiffness of a log, as `hapbench audit --json` does.

    `table`: columns of numbers by name, such as a Table, a dict of arrays or a pandas.DataFrame, with the time, the
    position of the tool and the force on the tool. `device`: a preset or FILE.json; the stiffness is compared with the
    linear limit of this device. `columns`, `scale`: like the options of the command. `force_by_tool`: the logged forces
    act on the object, and their sign is changed. `touch`: force above which a row is in contact [N]; None: any force.
    Raises InputError.
    """
    if not list(table):
        raise InputError(
            "table: got no columns; allowed: columns of numbers with the time, the position of the tool and the force "
            "on it, such as t, px, py, pz, fx, fy, fz"
        )
    find_packages()
    from hapbench_audit.audit import audit_log
    from hapbench_audit.log import log_of_table

    log = log_of_table(table, columns or {}, scale or {}, force_by_tool, touch)
    found = audit_log(log, None if device is None else os.fspath(device))[0]
    return found | {
        "columns": log.columns,
        "columns_not_read": log.columns_not_read,
        "scales": log.scales,
    }
