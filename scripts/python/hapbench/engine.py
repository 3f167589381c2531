"""Functions that run the commands of the program and return their results in memory."""
import json
import operator
import os
import shutil
import sys
import tempfile
import warnings
import weakref
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from ._packages import PROGRAM, use_this_python
from .errors import ScenarioError, ScenarioWarning, shown
from .results import Folder, Run, Trial
from .table import Table

try:
    from . import _hapbench
except ImportError as error:
    raise ImportError(
        "the compiled module of hapbench, which computes, is not in the folder of this package; "
        "hapbench.load works without the module. To compile the module, in the source tree: "
        "pip install ./scripts/python, or scripts/build --python && "
        "export PYTHONPATH=$PWD/build/release/lib/python3/dist-packages"
    ) from error

_hapbench.set_program(str(PROGRAM))
use_this_python()

Scenario = str | os.PathLike[str] | dict[str, Any]
Overrides = Mapping[str, object] | None
Names = str | Sequence[str] | None
Mounted = tuple[Sequence[float], Sequence[float]]  # (position [m], quaternion w, x, y, z)
OutputFolder = str | os.PathLike[str] | None
Progress = Callable[[str, int, int], object] | bool | None


def run(
    scenario: Scenario,
    overrides: Overrides = None,
    *,
    record: str | Iterable[str] = (),
    progress: Progress = None,
) -> Run:
    """Run a scenario and return its Run in memory, with the same numbers as `hapbench run` writes.

    `scenario`: a file, the name of a bundled scenario, or a dict; relative paths in a dict start from the working
    directory. `overrides`: fields as in --set, such as {"rendering.stiffness_N_per_m": 4e4}. `record`: what to record
    in addition to the scenario's own list, a name or a list of names: "contacts", "energy", "stiffness_tensor",
    "ideal_trajectory", "force_reference", "six_dof", "timing". `progress`: None for a progress bar if standard error is
    a terminal, False for no bar, or a function of (label, done, total). Ctrl-C stops the run with KeyboardInterrupt.
    Raises ScenarioError.
    """
    recorded = record.split(",") if isinstance(record, str) else record
    overrides = {**(overrides or {}), **{f"record.{what}": True for what in recorded}}
    with _Scratch() as scratch:
        found = scratch.call(_hapbench.run, scratch.file_of(scenario), _words(overrides), progress)
    summary = json.loads(found["summary"])
    for warning in found["warnings"]:
        warnings.warn(warning, ScenarioWarning, stacklevel=2)
    trials = [
        {name: _table(name, given) for name, given in trial.items()} for trial in found["trials"]
    ]
    only = dict(trials[0]) if len(trials) == 1 else {}
    if found["targets"] is not None:
        only["targets"] = _table("targets", found["targets"])
    return Run(
        summary,
        json.loads(found["scenario"]),
        only,
        timing=json.loads(found["timing"]),
        trials=map(Trial, trials) if len(trials) > 1 else (),
        unmet=found["unmet"],
    )


def compare(
    scenarios: Scenario | Sequence[Scenario],
    algorithms: Names = None,
    overrides: Overrides = None,
    *,
    seeds: int | None = None,
    jitter: float | None = None,
    by: Names = None,
    full: bool = False,
    jobs: int | None = None,
    out: OutputFolder = None,
    progress: Progress = None,
) -> "Report":
    """Run scenarios with several algorithms (default: all), as `hapbench compare` does.

    Returns a Report. `runs` has the runs by path: "mean", or "drag_molar/mean/seed_0" with several scenarios and seeds.
    Its tables are `comparison` and, with several scenarios or seeds or with `by`, `ranking`. A run that fails stops at
    its failure and has no metrics; with `full`, it continues to its end and has metrics. `out` names the folder of the
    results, which is kept; without `out`, the folder is temporary and is deleted with the Report. `scenarios`,
    `overrides` and `progress` as in `run`.
    """
    return _report(
        ["compare"],
        scenarios,
        overrides,
        out,
        progress,
        algorithms=algorithms,
        seeds=seeds,
        jitter=jitter,
        by=by,
        full=full,
        jobs=jobs,
    )


def sweep(
    scenario: Scenario,
    vary: Mapping[str, object],
    overrides: Overrides = None,
    *,
    sample: str | None = None,
    seed: int | None = None,
    keep_runs: bool = False,
    resume: bool = False,
    full: bool = False,
    jobs: int | None = None,
    out: OutputFolder = None,
    progress: Progress = None,
) -> "Report":
    """Run a scenario over a grid or a sample of values of any fields, as `hapbench sweep` does.

    `vary`: values by field, such as {"rendering.stiffness_N_per_m": [2e4, 4e4]}; a string is interpreted as by --vary
    ("1e4:1e5:10:log"). A run that fails stops at its failure and has no metrics; with `full`, it continues to its end
    and has metrics. Returns a Report whose table `sweep` has a row for each run.
    """
    words = ["sweep"]
    for field, values in vary.items():
        words += [
            "--vary",
            f"{field}={values if isinstance(values, str) else ','.join(map(_value, values))}",
        ]
    return _report(
        words,
        scenario,
        overrides,
        out,
        progress,
        sample=sample,
        seed=seed,
        keep_runs=keep_runs,
        resume=resume,
        full=full,
        jobs=jobs,
    )


def limit(
    scenarios: Scenario | Sequence[Scenario],
    overrides: Overrides = None,
    *,
    vary: str | None = None,
    between: str | None = None,
    over: Mapping[str, str] | None = None,
    algorithms: Names = None,
    device: Names = None,
    stable: str | None = None,
    resolution: float | None = None,
    jobs: int | None = None,
    out: OutputFolder = None,
    progress: Progress = None,
) -> "Report":
    """Search the stability limit of a field, as `hapbench limit` does. `over`: other fields and their values, in the
    syntax of --over; the limit is searched for each combination of these values. Returns a Report with the tables
    `limit` and `limit_runs`."""
    words = [
        "limit",
        *(word for path, values in (over or {}).items() for word in ("--over", f"{path}={values}")),
    ]
    return _report(
        words,
        scenarios,
        overrides,
        out,
        progress,
        vary=vary,
        between=between,
        algorithms=algorithms,
        device=device,
        stable=stable,
        resolution=resolution,
        jobs=jobs,
    )


def command(*words: object, progress: Progress = None) -> Any:
    """Run a command of the program, such as `hapbench.command("describe", "mean")`, and return the parsed output of
    --json. A command without the option --json, such as plot, returns its text. Returns None if the command prints
    nothing. Raises ScenarioError if the program rejects the input.
    """
    given = [str(word) for word in words]
    end = given.index("--") if "--" in given else len(given)  # the words after "--" are no options
    answer = None
    try:
        answer = _hapbench.command([*given[:end], "--json", *given[end:]], progress)
    except ScenarioError as error:
        if "--json" in given or 'unknown option "--json"' not in error.problem:
            raise
    status, text, messages, errors = answer or _hapbench.command(given, progress)
    _warn(messages + errors, status)
    try:
        return json.loads(text) if text else None
    except ValueError:
        return Text(text)


class Text(str):
    """A text that a notebook and an interactive Python print without quotes and escapes."""

    def __repr__(self) -> str:
        return str(self)


def describe(name: str = "") -> Text:
    """Explain a name of hapbench (a law, field, metric, column, device, claim or term), as `hapbench describe` does, or
    list all names. `hapbench.command("describe", name)` returns the same as data."""
    words = ["describe", *([name] if name else [])]
    status, text, messages, errors = _hapbench.command(words, False)
    _warn(messages + errors, status)
    return Text(text)


@cache
def columns_of(file: str) -> list[dict[str, str]]:
    """Returns name, unit and meaning of each column of a result file. Returns an empty list if the program does not
    know the file."""
    try:
        found = command("describe", file)
    except ScenarioError:
        return []
    meanings = found if isinstance(found, list) else [found]
    return next((one["columns"] for one in meanings if one.get("kind") == "file"), [])


def algorithms() -> list[str]:
    """Return the names of all algorithms, including user-defined laws."""
    return _hapbench.algorithms()


def load_plugin(file: str | os.PathLike[str]) -> None:
    """Load a module with hapbench's C interface, as the option --module does.

    If the module is a force law, all commands then know the law. If the module is a source of contacts, scenarios that
    name its file may then use it. Raises ScenarioError if the file is not a module, or if another thread computes.
    """
    command("--module", os.fspath(file), "describe", "--quiet")


def allow_modules() -> None:
    """Allow scenarios to load every library that they name, until Python ends, as the option --allow-modules does.

    The code of a library can do anything that you can. Without this call, a scenario that names a library is refused
    unless load_plugin has loaded the library."""
    _hapbench.allow_modules()


def main(words: Sequence[str] | None = None) -> int:
    """Run the program with these arguments (default: the arguments of the command line) and return its exit status. At
    the end of a script that defines force laws, `main` makes these laws available in every command.
    """
    sys.stdout.flush()
    try:
        return _hapbench.main(list(map(str, sys.argv[1:] if words is None else words)))
    except KeyboardInterrupt:
        return 130


class Report(Folder):
    """The folder that a command wrote, with its tables and runs. `report` is the parsed output of --json. `status` is
    the exit status: 0, or 3 if a run did not end as its scenario expects."""

    def __init__(
        self, folder: Path, status: int, report: Any, scratch: "_Scratch | None" = None
    ) -> None:
        super().__init__(folder)
        self.status, self.report = status, report
        self._scratch = scratch  # temporary folder; deleted together with this object


class Simulation(_hapbench.Simulation):
    """One run of a scenario, computed step by step, for loops of your own. `scenario` and `overrides` as in `run`.

      simulation = hapbench.Simulation("drag_molar")
      while simulation.step():
          print(simulation.state["force_N"], len(simulation.contacts["depths_m"]))

    `step()` computes the next row; it returns False and computes nothing if the run has ended. `advance(steps)`
    computes at most `steps` rows while other Python threads can run, and returns their number. `reset()` restores the
    start, bit for bit. `rows` is the number of computed rows, `steps` the number of rows of the whole run, and
    `time_step_s` the time between rows [s]. `outcome` says how the run ended; it is "completes" while the run
    continues.

    `state` is the last row as a dict, with the values before the integrator moved the tool: step, time_s, position_m,
    velocity_m_per_s, axis, force_N, spring_force_N, stiffness_tensor (in units of K), measured_force_N, input_force_N,
    handle_m, colliding, depth_max_m. `contacts` has the rendered contacts of this row as a dict of arrays: index,
    points_m, normals, depths_m, gradients, weights.
    """

    def __init__(self, scenario: Scenario, overrides: Overrides = None) -> None:
        with _Scratch() as scratch:
            scratch.call(super().__init__, scratch.file_of(scenario), _words(overrides or {}))

    def advance(self, steps: int) -> int:
        try:
            return super().advance(steps)
        except TypeError:
            _check_arguments(("steps", steps, _is_unsigned, "an integer from 0 to 2**64 - 1"))
            raise


class Renderer(_hapbench.Renderer):
    """The force of a scenario in a haptic loop of your own. This class is the Python interface of hapbench_renderer.h;
    the comments in that header are the full documentation.

      renderer = hapbench.Renderer("drag_molar", {"time.step_s": 0.001}, max_force_N=3)
      out = renderer.step(time.monotonic_ns(), position, velocity_m_per_s=velocity)
      out["force_N"], out["status"]

    `mode`: "impedance" or "admittance". `world_from_device`, `handle_from_tip`: (position [m], quaternion w, x, y, z).
    `stale_s`: longest time between two calls [s], larger than the period. `torque`: True to compute out["torque_N_m"].
    `allow_modules`: True to load libraries that the scenario names. Raises ScenarioError.

    `step` returns a dict: force_N, torque_N_m, set_position_m, set_velocity_m_per_s, gain, dt_s, call, status
    ("WAITING", "RAMPING", "ON", "CLAMPED", "STALE", "FAULT"), contacts, limited. `period_s` is the time between two
    calls [s], `inspection` describes the scenario that was opened, and `fault` is the reason of the last FAULT.
    `log_header()`, and `log_row()` after each step, return the lines of a log for `hapbench run SCENARIO --replay`.
    Python has no real-time guarantees: for a device, use C or C++.

    If a law in Python raises an exception, the status is FAULT, and `fault` has the text of the exception. If the
    exception is not derived from Exception, such as KeyboardInterrupt, `step` also raises it.
    """

    def __init__(
        self,
        scenario: Scenario,
        overrides: Overrides = None,
        *,
        max_force_N: float,
        mode: str = "impedance",
        scale: float = 1.0,
        world_from_device: Mounted = ((0, 0, 0), (1, 0, 0, 0)),
        handle_from_tip: Mounted = ((0, 0, 0), (1, 0, 0, 0)),
        max_force_rate_N_per_s: float = float("inf"),
        ramp_s: float = 0.5,
        stale_s: float = 0.01,
        engage_force_N: float = 0.2,
        torque: bool = False,
        allow_modules: bool = False,
    ) -> None:
        modes = {"impedance": 1, "admittance": 2}
        if mode not in modes:
            raise ValueError(f"mode: got {mode!r}; allowed: {', '.join(modes)}")
        limits = {
            "max_force_N": max_force_N,
            "max_force_rate_N_per_s": max_force_rate_N_per_s,
            "ramp_s": ramp_s,
            "stale_s": stale_s,
            "engage_force_N": engage_force_N,
        }
        try:
            with _Scratch() as scratch:
                scratch.call(
                    super().__init__,
                    scratch.file_of(scenario),
                    _words(overrides or {}),
                    modes[mode],
                    (1 if allow_modules else 0) | (2 if torque else 0),
                    world_from_device,
                    scale,
                    handle_from_tip,
                    tuple(limits.values()),
                )
        except TypeError:
            pose = "(position of 3 numbers, quaternion of 4 numbers)"
            _check_arguments(
                ("world_from_device", world_from_device, _is_pose, pose),
                ("handle_from_tip", handle_from_tip, _is_pose, pose),
                *(
                    (name, value, _is_number, "a number")
                    for name, value in {"scale": scale, **limits}.items()
                ),
            )
            raise

    def step(
        self,
        time_ns: int,
        position_m: Sequence[float],
        orientation_wxyz: Sequence[float] = (1, 0, 0, 0),
        *,
        velocity_m_per_s: Sequence[float] | None = None,
        angular_velocity_rad_per_s: Sequence[float] | None = None,
        hand_force_N: Sequence[float] | None = None,
        applied_force_N: Sequence[float] | None = None,
        clutch: bool = False,
        rearm: bool = False,
    ) -> dict[str, Any]:
        """Render the force for one measurement of the handle. The measurement is in the device's frame."""
        given = {
            "velocity_m_per_s": velocity_m_per_s,
            "angular_velocity_rad_per_s": angular_velocity_rad_per_s,
            "hand_force_N": hand_force_N,
            "applied_force_N": applied_force_N,
        }
        bits = (16 if clutch else 0) | (32 if rearm else 0)
        try:
            return super().step(time_ns, position_m, orientation_wxyz, list(given.values()), bits)
        except TypeError:
            time = "an integer from 0 to 2**64 - 1 [ns], such as time.monotonic_ns()"
            _check_arguments(
                ("time_ns", time_ns, _is_unsigned, time),
                ("position_m", position_m, _is_vector, "3 numbers"),
                ("orientation_wxyz", orientation_wxyz, _is_quaternion, "4 numbers"),
                *(
                    (name, vector, _is_vector, "3 numbers, or None")
                    for name, vector in given.items()
                    if vector is not None
                ),
            )
            raise


def _check_arguments(*arguments: tuple[str, object, Callable[[object], bool], str]) -> None:
    """Raises a ValueError for the first argument that is not valid. Called after the compiled module has refused the
    arguments of a call, because the message of the module names no argument. Each argument is a tuple of its name, its
    value, a function that returns true if the value is valid, and a text that states which values are valid.
    """
    for name, value, is_valid, allowed in arguments:
        if not is_valid(value):
            raise ValueError(f"{name}: got {shown(value)}; allowed: {allowed}") from None


def _is_number(value: Any) -> bool:
    try:
        return not isinstance(value, str) and isinstance(float(value), float)
    except (TypeError, ValueError, OverflowError):
        return False


def _is_unsigned(value: Any) -> bool:
    try:
        return 0 <= operator.index(value) < 2**64
    except TypeError:
        return False


def _is_vector(value: Any, size: int = 3) -> bool:
    try:
        return (
            not isinstance(value, (str, bytes))
            and len(value) == size
            and all(map(_is_number, value))
        )
    except TypeError:
        return False


def _is_quaternion(value: Any) -> bool:
    return _is_vector(value, 4)


def _is_pose(value: Any) -> bool:
    try:
        position, orientation = value
    except (TypeError, ValueError):
        return False
    return _is_vector(position) and _is_quaternion(orientation)


class _Scratch:
    """A temporary folder for results and for scenarios that are dicts. It is deleted together with this object."""

    def __init__(self):
        self.path = Path(tempfile.mkdtemp(prefix="hapbench-"))
        self._remove = weakref.finalize(self, shutil.rmtree, self.path, ignore_errors=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._remove()

    def file_of(self, scenario):
        """Returns the argument that names the scenario for the engine: its file or name, or for a dict a file in this
        folder."""
        if not isinstance(scenario, dict):
            return os.fspath(scenario)
        scenario = json.loads(json.dumps(scenario, default=_plain))
        extended = scenario.get("extends")
        if (
            isinstance(extended, str) and Path(extended).is_file()
        ):  # otherwise the text may be the name of a bundled scenario
            scenario["extends"] = str(Path(extended).absolute())
        _name_files(scenario)
        name = str(scenario.get("name") or "scenario").replace("/", "_")
        file = Path(tempfile.mkdtemp(dir=self.path), f"{name}.json")
        file.write_text(json.dumps(scenario), encoding="utf-8")
        return str(file)

    def call(self, function, *arguments):
        """Calls a function of the engine. If the scenario is a dict, an error names only the field, because the file of
        the scenario is temporary."""
        try:
            return function(*arguments)
        except ScenarioError as error:
            if not error.file.startswith(str(self.path)):
                raise
            raise ScenarioError(
                [("", fault.pointer, fault.problem) for fault in error.faults]
            ) from None


def _name_files(part):
    """Makes the paths in a scenario absolute. All fields named "file", at any depth, are paths; no other field is."""
    for key, value in part.items() if isinstance(part, dict) else enumerate(part):
        if key == "file" and isinstance(value, str):
            part[key] = str(Path(value).absolute())
        elif isinstance(value, (dict, list)):
            _name_files(value)


def _report(words, scenarios, overrides, out, progress, **options):
    scratch = _Scratch()
    given = [scenarios] if isinstance(scenarios, (str, dict, os.PathLike)) else list(scenarios)
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if value is None or value is False:
            continue
        words = [*words, option]
        if value is not True:
            words.append(
                value
                if isinstance(value, str)
                else _value(value)
                if isinstance(value, (int, float))
                else ",".join(value)
            )
    for word in _words(overrides or {}):
        words = [*words, "--set", word]
    folder = Path(out) if out is not None else scratch.path / "out"
    words = [*words, "--out", str(folder), "--json", "--", *map(scratch.file_of, given)]
    status, text, messages, errors = scratch.call(_hapbench.command, words, progress)
    _warn(messages + errors, status)
    return Report(folder, status, json.loads(text) if text else None, scratch)


def _warn(messages, status):
    for warning in messages:
        warnings.warn(warning, ScenarioWarning, stacklevel=4)
    if status == 1:
        raise RuntimeError(messages[-1] if messages else "hapbench: a run could not be computed")


def _words(overrides):
    return [f"{field}={_value(value)}" for field, value in overrides.items()]


def _value(value):
    """Returns the argument of --set for a value: a string unchanged, any other value as JSON."""
    return value if isinstance(value, str) else json.dumps(value, default=_plain)


def _plain(value):
    """Converts numbers and arrays of numpy to values that JSON can represent."""
    return value.tolist()


def _table(name, given):
    columns, numbers = given
    names = [column for column, _, _ in columns]
    return Table(
        zip(names, numbers.T.copy()),
        {column: unit for column, unit, _ in columns},
        {column: meaning for column, _, meaning in columns},
        name,
    )
