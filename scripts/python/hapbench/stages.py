"""Force stages written in Python."""
import functools
import inspect
import json
from collections.abc import Callable
from typing import TypeVar

from .engine import _hapbench

Stage = TypeVar("Stage", bound=Callable)
_ARGUMENTS = ("force", "spring", "tensor", "position", "velocity", "device_position", "device_velocity", "device_force", "energy",
              "in_contact", "row", "time_step", "mass", "stiffness")


def force_stage(name: str) -> Callable[[Stage], Stage]:
    """Make a function a force stage: behind any algorithm, it answers the force to render.

        @hapbench.force_stage("brake")
        def brake(force, velocity, damping=1.0):
            return force - damping * velocity

        hapbench.run("drag_molar", {"rendering.force_stage": {"type": "added", "name": "brake", "config": {"damping": 2}}})

    The function is called once in every row, in free air, too. It takes, by the names of its first arguments: `force` that
    would be rendered without it and `spring`, the law's part of it (3) [N], `tensor`, the law's stiffness (3 × 3) in units
    of K, `position`, `velocity` of the tool, `device_position`, `device_velocity` of the handle, `device_force` of the hand
    as it is measured (3), `energy` that its answers have absorbed and can still give back [J], `in_contact`, `row`,
    `time_step` [s], `mass` of the virtual tool [kg], 0 without one, and `stiffness`, K [N/m]. It returns the force (3) [N].

    Further arguments are given by the scenario's `config`. A class in place of a function: an object of it, made with the
    `config` for each run, is called, so that a stage can have a state. An exception ends what is computed and is raised."""

    def add(stage):
        function = stage.__call__ if inspect.isclass(stage) else stage
        names = list(inspect.signature(function).parameters)[1 if inspect.isclass(stage) else 0:]
        given = [word for word in names if word in _ARGUMENTS]
        if names[:len(given)] != given or (inspect.isclass(stage) and names != given):
            raise TypeError(f"force stage {name!r}: arguments {names}; allowed: first some of {', '.join(_ARGUMENTS)}, "
                            "then, of a function, those that the config gives")

        def make(config):
            options = json.loads(config)
            return stage(**options) if inspect.isclass(stage) else functools.partial(stage, **options)

        _hapbench.add_force_stage(name, make, given)
        return stage

    return add
