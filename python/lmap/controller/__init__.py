"""A control law of the user's: a Python function or an FMU that sees channels at every sample, sets torques and brakes.

    def hold(t, seen):
        return {"torque": [20e3 if seen["ws1.slip"] < 0.05 else 10e3] * 6}

    frame = lmap.controller.simulate(case, hold, channels=["ws1.slip"])

A spec names it (`run.controller`, see `docs/concepts/controller.md`). The case has a table `run.drive`, whose `period`
(s) is the time between two samples. What the law leaves out stays with the vehicle's own controllers. Such a run is the
slow path: it calls Python some hundred times a second. It is run anew every time, in this process: its result hangs on
code that the case does not hold.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lmap.controller import ports, python_law
from lmap.controller.bind import law_file, with_controller
from lmap.controller.python_law import Controller
from lmap.errors import InputProblem, SimulationProblem
from lmap.execute.local import REFUSED, run_cases
from lmap.simulate import as_case, check_case
from lmap.simulate import channels as channels_of
from lmap.spec.case import Case, Control

if TYPE_CHECKING:
    import polars as pl

__all__ = ["Controller", "law_file", "named", "simulate", "with_controller"]


def named(name: str) -> Controller:
    """The callable that `module:function` names in a module that Python finds; an `InputProblem` where none is."""
    try:
        return python_law.named(name)
    except InputProblem as error:
        raise InputProblem([one.at(prefix=("controller",)) for one in error.problems]) from None


def simulate(
    case: Case | Mapping[str, Any] | str,
    controller: Controller | str | None = None,
    *,
    channels: Sequence[str] = (),
) -> pl.DataFrame:
    """The channels of a case under a control law: a function, its name, or by default what `run.controller` names.

    A function sees `channels`. Raises `InputProblem` for a case, a channel or a name that is none and for a law that
    fails, `SimulationProblem` for a run that could not be finished.
    """
    case = as_case(case)
    if controller is None:
        case = with_controller(case, Path.cwd())
    else:
        bare = {key: value for key, value in case.data["run"].items() if key != "controller"}
        case = replace(case, data={**case.data, "run": bare})
    check_case(case)
    if controller is not None:
        case = replace(case, control=_control(case, controller, channels))
    [outcome] = run_cases([case], jobs=1)
    if outcome.ended.get("kind") == REFUSED:
        raise InputProblem(outcome.problems)
    if outcome.frame is None or not outcome.complete:
        raise SimulationProblem(outcome.ended.get("message") or "the run did not reach its end")
    return outcome.frame


def _control(case: Case, controller: Controller | str, seen: Sequence[str]) -> Control:
    name = (
        controller if isinstance(controller, str) else getattr(controller, "__qualname__", repr(controller))
    )
    law = named(controller) if isinstance(controller, str) else controller
    layout = ports.Layout(
        inputs=tuple((one, one) for one in seen),
        targets=ports.targets([channel.name for channel in channels_of(case)]),
    )
    return Control(name, layout.channels, layout.outputs, lambda: python_law.Running(law, layout))
