"""What a case will take, roughly: only the order and the shares matter, for starting the longest first and for saying
when all will be done.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from lmap.spec.case import Case

_STAGES = {"heun": 2.0, "rk4": 4.0, "ros2": 4.0}
"""Right-hand sides of a step; of the implicit scheme with what its matrices cost."""
_RHS = 6e-6
"""Seconds for the right-hand side of one wheelset with its share of the vehicle."""
_START = 0.1
"""Seconds that any case takes: to be read, compiled and brought to balance."""
_BALANCE = 0.05
"""Seconds for one more balance."""


def estimate(case: Case) -> float:
    """Seconds on one processor."""
    run, track = _table(case.data.get("run")), _table(case.data.get("track"))
    wheelsets = max(1, len(case.data.get("vehicle", {}).get("wheelset", ())) or 6)
    match run.get("kind", "time"):
        case "time":
            seconds = _ratio(track.get("length"), run.get("speed"))
            until = _table(_table(run.get("drive")).get("until"))
            seconds = min(seconds, _number(until.get("time"), seconds))
            return _START + seconds * _per_second(run, wheelsets)
        case "critical_speed":
            return _START + _search(run, wheelsets)
        case "quasi_static":
            return _START + _BALANCE * _number(run.get("load_steps"), 10.0) * max(1, _corners(run))
        case "modal":
            return _START + 2.0 * _BALANCE * max(1, len(run.get("speeds") or ()))
        case _:
            return _START + _BALANCE


def _search(run: Mapping[str, Any], wheelsets: int) -> float:
    search = _table(run.get("search"))
    fall = abs(_number(run.get("speed"), 50.0) - _number(search.get("end_speed"), 20.0))
    match search.get("method"):
        case "ramp_down":
            return _ratio(fall, search.get("deceleration")) * _per_second(run, wheelsets)
        case "bifurcation":
            return 2.0 * _ratio(fall, search.get("speed_step")) * 10.0 * _per_second(run, wheelsets)
        case _:
            return 20.0 * _BALANCE


def _per_second(run: Mapping[str, Any], wheelsets: int) -> float:
    """Seconds of work for a simulated one."""
    integrator = _table(run.get("integrator"))
    stages = _STAGES.get(str(integrator.get("kind")), 4.0)
    return stages * _RHS * wheelsets / max(_number(integrator.get("step"), 1e-3), 1e-6)


def _corners(run: Mapping[str, Any]) -> int:
    loads = run.get("load") or ()
    return max((len(load.get("path", ())) - 1 for load in loads if isinstance(load, Mapping)), default=1)


def _table(value: object) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}


def _number(value: object, otherwise: float) -> float:
    return float(value) if isinstance(value, int | float) and value > 0.0 else otherwise


def _ratio(of: object, by: object) -> float:
    return _number(of, 100.0) / _number(by, 20.0)
