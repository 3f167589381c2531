"""Force laws written in Python."""
import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from .engine import _hapbench
from .errors import shown

Law = TypeVar("Law", bound=Callable[..., Any])
_ARGUMENTS = ("depths", "gradients", "points", "normals", "stiffness")


@dataclass(frozen=True)
class Parameter:
    """A parameter of a force law. A scenario sets it as rendering.parameters.LAW.NAME."""

    default: float
    least: float
    greatest: float
    unit: str = "1"
    meaning: str = "parameter of a law in Python"


def force_law(
    name: str,
    parameters: Mapping[str, Parameter | float] | None = None,
    *,
    depth_model: str | None = None,
    formula: str | None = None,
    source: str | None = None,
    known_failure: str | None = None,
) -> Callable[[Law], Law]:
    """Register a function as a force law. Every scenario and command of this process then knows the law by `name`.

        @hapbench.force_law("mine", parameters={"share": hapbench.Parameter(0.5, 0, 1)})
        def mine(depths, gradients, share):
            return share * numpy.ones(len(depths))

    The function is called in every step with contact. Its arguments are selected by their names and may be in any
    order: `depths` (n) [m]; `gradients` (n × 3), unit vectors along which a point leaves the tool; `points` (n × 3)
    [m]; `normals` (n × 3), out of the environment; `stiffness`, K of one spring [N/m]; and the `parameters` of the
    law, as floats. The next call overwrites the arrays: copy the values that you keep. The function may change the
    arrays: hapbench computes the force of the weights from its own depths and gradients.

    The function returns the weights c_i of the springs, either one for each contact or one for all contacts. The force
    is f = -K Σ c_i d_i u_i, with the depths d_i and the gradients u_i, and the stiffness tensor is S = Σ c_i u_i u_iᵀ.
    Alternatively, the function returns a tuple of the force [N] and the symmetric 3 × 3 tensor S in units of K. If
    opposite entries of S differ by rounding, hapbench uses their mean. Damping and friction are computed with S. If the
    function returns a tuple, the energy and the moment of the force are computed as if one spring of stiffness K in the
    middle of the contacts rendered this force.

    A class can replace the function. Each run then creates an object of the class and calls it, so that a law can have
    a state.

    An exception in the law stops the computation, and the call that started the computation raises it. In a Renderer,
    the status becomes FAULT instead. Registering a second law of the same name replaces the first law. `parameters`: by
    name, a Parameter or a number; a number is the default of a parameter in the range from 0 (or from the number, if it
    is negative) to 1e12. At most 1000 parameters are allowed, and their names must differ from the inputs above.
    `depth_model`: the only depth model for which the law is defined; None for all. The first line of the function's
    docstring is the summary of the law.
    """
    specified = _specified(name, parameters)

    def add(law):
        is_class = inspect.isclass(law)
        texts = (
            _summary(law),
            formula or "as written in Python",
            source or _location(law),
            known_failure or "unknown",
        )
        table = [
            (key, p.default, p.least, p.greatest, p.unit, p.meaning) for key, p in specified.items()
        ]
        _hapbench.add_force_law(
            name,
            law,
            is_class,
            _arguments(name, law, specified),
            table,
            texts,
            depth_model or "",
            *_origin(law),
        )
        return law

    return add


def _specified(name, parameters):
    """Returns the parameters of a law as a dict from name to Parameter. Raises an error for arguments of force_law that
    are not a name and a dict, because otherwise nothing would be registered without a notice."""
    if not isinstance(name, str):
        raise TypeError(
            f"force_law: got {_shown(name)} as the name; allowed: a text, as in the line "
            '@hapbench.force_law("mine") above the law'
        )
    if not isinstance(parameters, (Mapping, type(None))):
        raise TypeError(
            f"force law {name!r}: got {_shown(parameters)} as the parameters; allowed: a dict. A law that exists "
            f"is registered by hapbench.force_law({name!r})(LAW)"
        )
    specified = {
        key: value
        if isinstance(value, Parameter)
        else Parameter(float(value), min(0.0, float(value)), 1e12)
        for key, value in (parameters or {}).items()
    }
    for key in specified:
        if key in _ARGUMENTS:
            raise ValueError(
                f"force law {name!r}: got a parameter {key!r}, which is the name of an input of every law; "
                f"allowed: names other than {', '.join(_ARGUMENTS)}"
            )
    return specified


def _shown(value):
    """Returns a text of one line for an argument that is not allowed."""
    if callable(value):
        return f"the {type(value).__name__} {getattr(value, '__name__', '')!r}"
    return shown(value)


def _arguments(name, law, specified):
    function = law.__call__ if inspect.isclass(law) else law
    given = list(inspect.signature(function).parameters.values())[
        1 if inspect.isclass(law) else 0 :
    ]
    for parameter in given:
        if parameter.kind not in (parameter.POSITIONAL_ONLY, parameter.POSITIONAL_OR_KEYWORD):
            raise TypeError(
                f"force law {name!r}: argument {parameter.name!r} must be a positional argument"
            )
        if parameter.name not in (*_ARGUMENTS, *specified):
            raise TypeError(
                f"force law {name!r}: unknown argument {parameter.name!r}; "
                f"allowed: {', '.join((*_ARGUMENTS, *specified))}"
            )
    unused = set(specified) - {parameter.name for parameter in given}
    if unused:
        raise TypeError(
            f"force law {name!r}: parameter {min(unused)!r} is not an argument of the law"
        )
    return [parameter.name for parameter in given]


def _origin(law):
    """Returns (file name, source text) of a law, for the provenance of results. Returns ("Python", "") if the source is
    not available."""
    try:
        return Path(inspect.getsourcefile(law) or "").name or "Python", inspect.getsource(law)
    except (OSError, TypeError):
        return "Python", ""


def _summary(law):
    lines = (inspect.getdoc(law) or "").strip().splitlines()
    return lines[0].rstrip(".") if lines else "a law written in Python"


def _location(law):
    module = getattr(law, "__module__", "?")
    return f"Python, {module}.{getattr(law, '__qualname__', '?')}"
