"""A control law of the user's: a Python function that sees channels at every sample and sets torques and brakes.

    def hold(t, seen):
        return {"torque": [20e3 if seen["ws1.slip"] < 0.05 else 10e3] * 6}

    frame = lmap.controller.simulate(case, hold, channels=["ws1.slip"])

The case has a table `run.drive`, whose `period` (s) is the time between two samples. What the function leaves out stays
with the vehicle's own controllers. Such a run is the slow path: it calls Python some hundred times a second.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from lmap import toml
from lmap.errors import InputProblem, Problem, SimulationProblem
from lmap.simulate import as_case, check_case
from lmap.spec.case import Case

if TYPE_CHECKING:
    import polars as pl

Controller = Callable[[float, dict[str, float]], Mapping[str, float | Sequence[float]] | None]
"""`controller(t, seen)` gives `torque` (N m, a number for each wheelset) and `independent_brake` (Pa), or nothing."""


def named(name: str) -> Controller:
    """The function that `module:function` names; an `InputProblem` where there is none."""
    module, colon, function = name.partition(":")
    allowed = '"module:function", a module that Python finds and a function in it'
    if not colon or not module or not function:
        raise InputProblem(Problem(key=("controller",), found=f'"{name}"', allowed=allowed))
    try:
        found = getattr(importlib.import_module(module), function)
    except Exception as error:  # whatever a module does when it is imported
        why = f'"{name}": {type(error).__name__}: {error}'
        raise InputProblem(Problem(key=("controller",), found=why, allowed=allowed)) from error
    if not callable(found):
        raise InputProblem(Problem(key=("controller",), found=f'"{name}", no function', allowed=allowed))
    law: Controller = found
    return law


def simulate(
    case: Case | Mapping[str, Any] | str, controller: Controller | str, *, channels: Sequence[str]
) -> pl.DataFrame:
    """The channels of a case under a control law, a function or its name.

    Raises `InputProblem` for a case, a channel or a name that is none, `SimulationProblem` for a run that could not be
    finished, the controller's own failure too.
    """
    import polars as pl

    name = (
        controller if isinstance(controller, str) else getattr(controller, "__qualname__", repr(controller))
    )
    law = named(controller) if isinstance(controller, str) else controller
    case = as_case(case)
    check_case(case)
    railsim = toml.core()
    results: list[Any] = []

    def done(_index: int, result: Any) -> None:
        results.append(result)

    def answered(t: float, seen: dict[str, float]) -> dict[str, float | list[float]] | None:
        answer = law(t, seen)
        return None if answer is None else {key: _plain(value) for key, value in answer.items()}

    railsim.run_controlled(case.json, name, list(channels), answered, lambda *_: None, done)
    [result] = results
    if isinstance(result, railsim.InputError):
        raise InputProblem(toml.problems_of_core(result))
    if isinstance(result, railsim.RailsimError):
        raise SimulationProblem(str(result))
    if result.ended["kind"] == "diverged":
        raise SimulationProblem(result.ended["message"])
    return pl.DataFrame(result)


def _plain(value: Any) -> float | list[float]:
    """A number or numbers."""
    try:
        return [float(one) for one in value] if hasattr(value, "__iter__") else float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{value!r}, neither a number nor numbers") from None
