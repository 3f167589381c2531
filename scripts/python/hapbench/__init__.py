"""hapbench from Python: runs scenes, compares, sweeps, searches limits, with user-defined force laws, and reads
results.

  import hapbench
  r = hapbench.run("peg_in_hole_2d", {"rendering.stiffness_N_per_m": 4e4})
  r.trajectory["fx_N"], r.summary["metrics"]["force_max_N"]

Reading results (`load`) requires only numpy. `audit` also requires scipy and the program. Everything else requires the
compiled module that is installed with the program.
"""
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

__version__ = "0.4.0"  # must equal the version in CMakeLists.txt

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


if not TYPE_CHECKING:  # the imports above already provide the names for a type checker

    def __getattr__(name):
        """Imports a name at its first use, because most names require the compiled module or scipy."""
        if name not in __all__:
            raise AttributeError(f"module 'hapbench' has no attribute {name!r}")
        from importlib import import_module

        return getattr(import_module("." + _MODULES.get(name, "engine"), __name__), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
