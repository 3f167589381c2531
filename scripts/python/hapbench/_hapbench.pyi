"""Types of the compiled module of hapbench. Programs should import the package hapbench instead."""
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

_Progress = Callable[[str, int, int], object] | bool | None

def add_force_law(
    name: str,
    callable: object,
    is_class: bool,
    arguments: list[str],
    parameters: list[tuple[str, float, float, float, str, str]],
    texts: tuple[str, str, str, str],
    depth_model: str,
    file: str,
    source: str,
) -> None: ...
def algorithms() -> list[str]: ...
def command(words: list[str], progress: _Progress) -> tuple[int, str, list[str], list[str]]: ...
def main(words: list[str]) -> int: ...
def run(scenario: str, overrides: list[str], progress: _Progress) -> dict[str, Any]: ...
def set_program(program: str) -> None: ...

class Simulation:
    def __init__(self, scenario: str, overrides: list[str]) -> None: ...
    def step(self) -> bool: ...
    def advance(self, steps: int) -> int: ...
    def reset(self) -> None: ...
    @property
    def state(self) -> dict[str, Any]: ...
    @property
    def contacts(self) -> dict[str, npt.NDArray[np.float64]]: ...
    @property
    def rows(self) -> int: ...
    @property
    def steps(self) -> int: ...
    @property
    def time_step_s(self) -> float: ...
    @property
    def outcome(self) -> str: ...

_Vector = Sequence[float]
_Mounted = tuple[_Vector, _Vector]

class Renderer:
    def __init__(
        self,
        scenario: str,
        overrides: list[str],
        mode: int,
        flags: int,
        world_from_device: _Mounted,
        scale: float,
        handle_from_tip: _Mounted,
        limits: _Vector,
        /,
    ) -> None: ...
    def step(
        self,
        time_ns: int,
        position: _Vector,
        orientation: _Vector,
        given: list[_Vector | None],
        bits: int,
        /,
    ) -> dict[str, Any]: ...
    def log_header(self) -> str: ...
    def log_row(self) -> str: ...
    @property
    def period_s(self) -> float: ...
    @property
    def inspection(self) -> str: ...
    @property
    def fault(self) -> str: ...
