"""A range of speeds over the track that the spec writes: irregularities, isolated or cyclic, straight or in a curve.

One run for every wheel profile and speed, and beside them the vehicle at rest (`wheel_forces`). `[test]` says where
a run begins and ends, which may depend on the speed: so that it lasts long enough before and after what it
passes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pydantic import Field

from lmap.errors import InputProblem, Problem
from lmap.procedures import couplers, wheel_forces
from lmap.procedures.base import CaseFigures, Table, expand, settings
from lmap.spec.case import Case, VehicleData
from lmap.spec.model import Spec
from lmap.verdict import Drawing, Fact

if TYPE_CHECKING:
    import polars as pl

NAME = "speed_range"
SUMMARY = "one run for each speed over irregularities, on straight track or in a curve"
UNITS: Mapping[str, str] = {}


class Place(Table):
    """A place on the track that moves with the speed."""

    at_m: float = Field(allow_inf_nan=False)
    """m along the track."""
    travel_s: float = Field(ge=0.0, allow_inf_nan=False)
    """s of travel before (of a start) or after it (of an end)."""


class Slow(Table):
    """What runs below a speed are stepped with: the damping of creep is inversely proportional to the speed."""

    below_kmh: float = Field(gt=0.0, allow_inf_nan=False)
    """It holds below this speed."""
    integrator: dict[str, Any]
    """In place of `run.integrator`; checked by the core."""


class Settings(wheel_forces.Settings):
    """`[test]`."""

    start: Place | None = None
    """Where the first wheelset is at the start; the beginning of the track if absent."""
    end: Place | None = None
    """Where the run ends; `track.length` if absent."""
    slow: list[Slow] = Field(default_factory=list)
    """The entry with the lowest `below_kmh` above a run's speed holds for it; else `run.integrator`."""


SETTINGS = Settings


derived = wheel_forces.derived
quantities = wheel_forces.quantities


def drawings(spec: Spec, quantities: Mapping[str, pl.DataFrame], vehicle: VehicleData) -> list[Drawing]:
    """The couplers where their angles are largest, of runs that have `run.couplers`."""
    return couplers.drawings(spec, quantities, vehicle)


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """A run for every wheel profile and speed, then the vehicle at rest."""
    own = settings(spec, Settings)
    _check_given_once(spec, own)
    runs = [_placed(case, own) for case in expand(spec, vehicle)]
    return [stepped(case, own.slow) for case in runs] + wheel_forces.static_cases(spec, vehicle)


def _check_given_once(spec: Spec, own: Settings) -> None:
    """Where `[test]` says where runs begin and end, nothing else does."""
    given = (
        (own.start, spec.run.rest, ("run", "start"), "test.start"),
        (own.end, spec.track, ("track", "length"), "test.end"),
    )
    for place, table, key, said in given:
        if place is not None and key[1] in table:
            allowed = f"none beside {said}, which says it for each speed"
            raise InputProblem(Problem(key=key, found=f"{table[key[1]]}", allowed=allowed))


def _placed(case: Case, own: Settings) -> Case:
    """The case with its own start and end."""
    track, run = dict(case.data["track"]), dict(case.data["run"])
    if own.start is not None:
        start = own.start.at_m - own.start.travel_s * run["speed"]
        if start < -1e-6 * own.start.at_m:
            allowed = f"a place and a time so that the run starts at 0 m or beyond at {case.label}"
            found = f"a start at {start:.4g} m"
            raise InputProblem(Problem(key=("test", "start"), found=found, allowed=allowed))
        run["start"] = max(start, 0.0)
        if track.get("irregularity") and track.get("fade_in"):
            track["fade_start"] = run["start"]
    if own.end is not None:
        track["length"] = own.end.at_m + own.end.travel_s * run["speed"]
    return Case(case.label, {**case.data, "track": track, "run": run})


def stepped(case: Case, slow: Sequence[Slow]) -> Case:
    """The case with the integrator for its speed."""
    run = case.data["run"]
    fitting = [one for one in slow if run["speed"] * 3.6 < one.below_kmh]
    if not fitting:
        return case
    nearest = min(fitting, key=lambda one: one.below_kmh)
    return Case(case.label, {**case.data, "run": {**run, "integrator": dict(nearest.integrator)}})


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """Nothing beside the verdicts."""
    return []
