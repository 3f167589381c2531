"""hapbench from Python: run scenes, compare, sweep, find their limits, with force laws of your own, and read results.

    import hapbench
    r = hapbench.run("peg_in_hole_2d", {"rendering.stiffness_N_per_m": 4e4})
    r.trajectory["fx_N"], r.summary["metrics"]["force_max_N"]

Reading results (`load`) needs numpy alone, `audit` also scipy and the program; everything else the compiled module
that comes with the program."""
from typing import TYPE_CHECKING

from .errors import InputError, ResultError, ScenarioError, ScenarioWarning
from .results import Folder, Run, Trial, load
from .table import Table

if TYPE_CHECKING:
    from .auditing import audit
    from .engine import (
        Renderer,
        Report,
        Simulation,
        algorithms,
        allow_modules,
        command,
        compare,
        describe,
        limit,
        load_plugin,
        main,
        run,
        sweep,
    )
    from .laws import Parameter, force_law

__version__ = "0.4.0"  # of CMakeLists.txt

__all__ = [
    "Folder",
    "InputError",
    "Parameter",
    "Renderer",
    "Report",
    "ResultError",
    "Run",
    "ScenarioError",
    "ScenarioWarning",
    "Simulation",
    "Table",
    "Trial",
    "algorithms",
    "allow_modules",
    "audit",
    "command",
    "compare",
    "describe",
    "force_law",
    "limit",
    "load",
    "load_plugin",
    "main",
    "run",
    "sweep",
]

_MODULES = {"Parameter": "laws", "audit": "auditing", "force_law": "laws"}


if not TYPE_CHECKING:  # which knows the names by the imports above

    def __getattr__(name):
        """Imports names when they are first used: most need the compiled module, or scipy."""
        if name not in __all__:
            raise AttributeError(f"module 'hapbench' has no attribute {name!r}")
        from importlib import import_module

        return getattr(import_module("." + _MODULES.get(name, "engine"), __name__), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
