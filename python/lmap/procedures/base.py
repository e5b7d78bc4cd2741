"""What a procedure is, and what most of them share.

A procedure is a module with two pure functions: `cases` turns a spec into cases, `quantities` turns the
frames of all cases into what the criteria judge. It never calls the simulator, opens no file and judges
nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, TypeVar, runtime_checkable

from pydantic import BaseModel, ConfigDict, ValidationError

from lmap.errors import InputProblem, KeyPath, Problem, problems_of_validation
from lmap.spec.case import Case, VehicleData, build
from lmap.spec.model import Spec
from lmap.verdict import CriterionVerdict, Drawing, Fact

if TYPE_CHECKING:
    import polars as pl

_Settings = TypeVar("_Settings", bound=BaseModel)


@dataclass(frozen=True, slots=True, kw_only=True)
class CaseFigures:
    """What the core says about a case's track and contact, for the facts shown beside the verdicts."""

    case: Case
    track_extremes: Mapping[str, tuple[float, float]]
    """Least and largest deviation by name, m; empty where the core gave none."""
    conicity: float | None
    """Equivalent conicity at `CONICITY_AMPLITUDE`."""


CONICITY_AMPLITUDE = 0.003
"""m, the amplitude at which EN 15302 and UIC 519 quote one figure for a profile pair."""


class Procedure(Protocol):
    """The shape of a procedure's module."""

    NAME: str
    SUMMARY: str
    UNITS: Mapping[str, str]
    """Units of the columns that `quantities` adds. Where their names depend on the vehicle: see `Deriving`."""

    def cases(self, spec: Spec, vehicle: VehicleData) -> list[Case]:
        """The cases that a spec expands to, profiles still by name."""

    def quantities(
        self, spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
    ) -> Mapping[str, pl.DataFrame]:
        """What is judged, by label; by default the frames themselves.

        `frames` holds the cases that reached their end. A label that is left out is not judged, one that no case
        has is judged too. A `JudgementProblem` says why nothing can be.
        """

    def facts(self, spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
        """What is shown beside the verdicts."""


@runtime_checkable
class Set(Procedure, Protocol):
    """A procedure with numbers of its own in the spec's table `[test]`."""

    SETTINGS: type[BaseModel]
    """Its keys; see `settings`."""


@runtime_checkable
class Deriving(Procedure, Protocol):
    """A procedure that adds columns whose names depend on the vehicle."""

    def derived(self, spec: Spec, channels: Mapping[str, str]) -> Mapping[str, str]:
        """Name and unit of the columns that `quantities` adds to frames with these channels (name to unit)."""


@runtime_checkable
class Rewriting(Procedure, Protocol):
    """A procedure whose cases hold what the spec writes under another key."""

    def origin(self, spec: Spec, label: str, key: KeyPath) -> KeyPath:
        """Where the spec writes a key of the case of this label, so that a fault of it is told there."""


@runtime_checkable
class Illustrated(Procedure, Protocol):
    """A procedure that draws what was judged."""

    def drawings(
        self, spec: Spec, quantities: Mapping[str, pl.DataFrame], vehicle: VehicleData
    ) -> list[Drawing]:
        """Plots for the report, of what `quantities` gave."""


class Table(BaseModel):
    """A table of `[test]`: no unknown key, no text for a number."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


def settings(spec: Spec, kind: type[_Settings]) -> _Settings:
    """The spec's `[test]`, checked; an `InputProblem` with every fault, keys starting at the spec."""
    try:
        return kind.model_validate(spec.test)
    except ValidationError as error:
        known: dict[KeyPath, list[str]] = {(): list(kind.model_fields)}
        faults = problems_of_validation(error.errors(include_url=False), known)
        raise InputProblem([fault.at(prefix=("test",)) for fault in faults]) from None


@dataclass(frozen=True, slots=True, kw_only=True)
class Look:
    """What a procedure sees in the vehicle itself."""

    label: str
    """Stands for a case's."""
    hash: str
    """Of the model."""
    frame: pl.DataFrame
    """One row, a column for each measure, for the criteria."""
    units: Mapping[str, str]
    """By column."""
    by_person: CriterionVerdict
    """What only a person can say."""
    drawing: Mapping[str, Any]
    """Plain data of the 3D page."""


@runtime_checkable
class Looking(Procedure, Protocol):
    """A procedure that simulates nothing: it has no cases and looks at the vehicle."""

    def look(self, spec: Spec, vehicle: VehicleData, settings: Mapping[str, Any]) -> Look:
        """What is seen; `settings` are the named parameters of the vehicle that are set otherwise."""


def expand(spec: Spec, vehicle: VehicleData, *, kind: str = "time") -> list[Case]:
    """A case for every wheel profile and speed that the spec lists, profiles outermost.

    The label says what varies: the wheel profile where the spec names any, the speed where it lists several
    or where nothing else would be said.
    """
    speeds = spec.run.speeds
    if speeds is None:
        allowed = 'a speed in m/s, "110% design" or a list; or speed_kmh'
        raise InputProblem(Problem(key=("run", "speed"), found="nothing", allowed=allowed))
    profiles = spec.run.wheel_profile or ([vehicle.wheel_profile] if vehicle.wheel_profile else [])
    if not profiles:
        allowed = "the name of a profile, or a list of names"
        raise InputProblem(Problem(key=("run", "wheel_profile"), found="nothing", allowed=allowed))
    cases = []
    for profile in profiles:
        for written in speeds:
            speed = written.resolve(vehicle.design_speed)
            parts = [profile] if spec.run.wheel_profile else []
            if len(speeds) > 1 or not parts:
                parts.append(f"{speed * 3.6:.6g} km/h")
            run: dict[str, Any] = {"kind": kind, **spec.run.rest, "speed": speed, "wheel_profile": profile}
            cases.append(build(label=" ".join(parts), vehicle=vehicle, track=spec.track, run=run))
    return cases


def at_rest(spec: Spec, vehicle: VehicleData, run: Mapping[str, Any] | None = None) -> list[Case]:
    """A case for every wheel profile of the spec, standing in balance; `run` adds to `[run]`."""
    profiles = spec.run.wheel_profile or [vehicle.wheel_profile or ""]
    cases = []
    for profile in profiles:
        own: dict[str, Any] = {"kind": "equilibrium", "speed": 0.0, **spec.run.rest, **(run or {})}
        if profile:
            own["wheel_profile"] = profile
        label = profile if spec.run.wheel_profile else "at rest"
        cases.append(build(label=label, vehicle=vehicle, track=spec.track, run=own))
    return cases


def in_condition(
    case: Case, condition: str | None, vehicle: VehicleData, key: KeyPath, *, label: str
) -> Case:
    """A case under another label in a condition of the vehicle that `key` names; its own where that is None."""
    if condition is None:
        return Case(label, {**case.data, "label": label})
    if vehicle.conditions and condition not in vehicle.conditions:
        allowed = "a condition of the vehicle: " + ", ".join(vehicle.conditions)
        raise InputProblem(Problem(key=key, found=f'"{condition}"', allowed=allowed))
    return Case(label, {**case.data, "label": label, "condition": condition})


MOST_CANT_MM = 300.0
"""mm of cant that any `[test]` may ask for: the core's own limit."""


def origin_of_curve(key: KeyPath) -> KeyPath:
    """A key of a case whose layout is one curve, as `[test]` writes it: `radius`, `cant_mm`."""
    own = key[:2] == ("track", "layout") and key[-1] in ("radius", "cant_mm")
    return ("test", key[-1]) if own else key


def wheelsets(columns: Iterable[str]) -> list[str]:
    """Names of the wheelsets among a frame's columns, in their order: those with wheel forces."""
    return [name.removesuffix(".left.Q") for name in columns if name.endswith(".left.Q")]


def with_unloading(frame: pl.DataFrame, level: pl.DataFrame) -> pl.DataFrame:
    """A frame with `<axle>.<side>.unloading`: the share that a wheel has lost of its load in `level`'s first row."""
    import polars as pl

    loads = [name for name in frame.columns if name.endswith(".Q") and name in level.columns]
    return frame.with_columns(
        (1.0 - pl.col(name) / float(level[name][0])).alias(f"{name.removesuffix('.Q')}.unloading")
        for name in loads
    )


def unloading_units(channels: Iterable[str]) -> dict[str, str]:
    """Names and units of the columns of `with_unloading`."""
    return {f"{name}.{side}.unloading": "1" for name in wheelsets(channels) for side in ("left", "right")}
