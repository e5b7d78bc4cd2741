"""What a static test asks of the air brake, and how long the cylinders take."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import polars as pl

FULL, EMPTY = 0.95, 0.05
"""Shares of the pressure asked for at which cylinders count as filled and as empty."""
_AN_INSTANT = 1e-6
"""s; less than any control period."""
_NONE = float("nan")


@dataclass(frozen=True, slots=True)
class Command:
    """A change of what the driver asks for."""

    t: float
    """s"""
    before: float
    """Cylinder pressure asked for until then, Pa."""
    after: float
    """The same from then on."""


def last_command(drive: Mapping[str, Any], brake: Mapping[str, Any]) -> Command | None:
    """The last change of the cylinder pressure that `run.drive` asks for; none where it never changes.

    What is asked for at the start has been there for long; an emergency has not.
    """
    emergency = drive.get("emergency")
    times = {0.0 if emergency is None else float(emergency)}
    times |= {t for t, _ in chain(_steps(drive, "independent_brake"), _steps(drive, "brake_pipe_reduction"))}
    for t in sorted(times, reverse=True):
        found = Command(t, demanded(drive, brake, t - _AN_INSTANT), demanded(drive, brake, t))
        if found.before != found.after:
            return found
    return None


def demanded(drive: Mapping[str, Any], brake: Mapping[str, Any], t: float) -> float:
    """Cylinder pressure (Pa) that the brakes come to if what is asked for at time `t` (s) stays.

    As distributor and independent brake ask for it in `crates/railsim/src/equipment/air_brake.rs`, the rating
    (`max_cylinder`, `max_independent`) at most; a reservoir that has less is the brake's fault, not the driver's wish.
    """
    reduction = _at(drive, "brake_pipe_reduction", t)
    emergency = drive.get("emergency")
    if emergency is not None and t >= emergency:
        reduction = brake["pipe_pressure"]
    automatic = 0.0
    if reduction > brake["insensitivity"]:
        automatic = min(brake["distributor_ratio"] * reduction, brake["max_cylinder"])
    independent = min(_at(drive, "independent_brake", t), brake["max_independent"])
    return float(max(automatic, independent))


def times(frame: pl.DataFrame, command: Command | None) -> tuple[float, float]:
    """Application and release time, s: from the command to 95 % of what is asked for, to 5 % of what was.

    NaN for the one that was not asked for, and where the cylinders do not get there.
    """
    if command is None:
        return _NONE, _NONE
    t, p = frame["t"].to_numpy(), frame["brake.cylinder"].to_numpy()
    applies = command.after > command.before
    there = p >= FULL * command.after if applies else p <= EMPTY * command.before
    there &= t >= command.t - _AN_INSTANT
    took = float(t[there.argmax()]) - command.t if there.any() else _NONE
    return (took, _NONE) if applies else (_NONE, took)


def _steps(drive: Mapping[str, Any], key: str) -> list[tuple[float, float]]:
    """Time (s) and value of every change of a demand."""
    written = drive.get(key, 0.0)
    return [(0.0, written)] if isinstance(written, int | float) else [(float(t), v) for t, v in written]


def _at(drive: Mapping[str, Any], key: str, t: float) -> float:
    passed = [value for begin, value in _steps(drive, key) if begin <= max(t, 0.0)]
    return passed[-1] if passed else 0.0
