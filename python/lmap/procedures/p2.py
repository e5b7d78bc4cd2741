"""P2 force (LMAP 2B.2): what a wheel does to a dipped joint or weld at speed.

By formula: one balance at rest for each speed and wheel profile gives the static load of every wheel; Jenkins et al.
(1974, `lmap.formulas.p2_force`) add the rest, with half of each wheelset's mass as unsprung mass and what `[test]`
says of
the track. By a run, where `[run]` has an integrator: over the weld that the spec lays on its track; the formula is then
taken on the wheel loads of the run's first row, beside it. Added: `<axle>.<side>.P2`, the formula's.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict, Field

from lmap.errors import InputProblem, JudgementProblem, Problem
from lmap.formulas import p2_damping_limit, p2_force
from lmap.procedures.base import CaseFigures, expand, settings, wheelsets
from lmap.spec.case import Case, VehicleData, build
from lmap.spec.model import Spec
from lmap.verdict import Fact
from lmap.view.model import resolved

if TYPE_CHECKING:
    import polars as pl

NAME = "p2"
SUMMARY = "P2 force over a dipped weld, by formula from the standing vehicle, or by a run"
UNITS: Mapping[str, str] = {}


class Settings(BaseModel):
    """`[test]`; the track's numbers are those of one rail."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    dip_angle: float = Field(gt=0.0, lt=0.2)
    """Whole angle 2 alpha between the rail ends, rad."""
    track_mass: float = Field(gt=0.0)
    """Effective mass of the track under one rail, kg."""
    track_stiffness: float = Field(gt=0.0)
    """Its stiffness, N/m."""
    track_damping: float = Field(ge=0.0)
    """Its damping, N s/m."""
    motor_mass_per_wheel: float = Field(default=0.0, ge=0.0)
    """Unsprung mass beside half the wheelset, e.g. of a nose-suspended motor, kg."""


SETTINGS = Settings


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """A run, or the standing vehicle, for each speed and wheel profile."""
    test, rolling = settings(spec, Settings), expand(spec, vehicle)
    for mass in _unsprung(test, vehicle).values():
        limit = p2_damping_limit(mass, test.track_mass, test.track_stiffness)
        if not test.track_damping < limit:
            found = f"{test.track_damping:g} N s/m"
            allowed = f"less than 4 sqrt(Kt (Mu + Mt))/pi, {limit:.4g} N s/m: from there on the formula has no force"
            raise InputProblem(Problem(key=("test", "track_damping"), found=found, allowed=allowed))
    if "integrator" in spec.run.rest:
        return rolling
    return [
        build(
            label=case.label,
            vehicle=vehicle,
            track=spec.track,
            run={**case.data["run"], "kind": "equilibrium", "speed": 0.0},
        )
        for case in rolling
    ]


def derived(spec: Spec, channels: Mapping[str, str]) -> Mapping[str, str]:
    """P2 of each wheel."""
    return {f"{name}.{side}.P2": "N" for name in wheelsets(channels) for side in ("left", "right")}


def quantities(
    spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
) -> Mapping[str, pl.DataFrame]:
    """The frames with P2 of each wheel by the formula."""
    import polars as pl

    test = settings(spec, Settings)
    masses = _unsprung(test, vehicle)
    speeds = {
        case.label: speed for case, speed in zip(cases(spec, vehicle), _speeds(spec, vehicle), strict=True)
    }
    found = {}
    for label, frame in frames.items():
        names = wheelsets(frame.columns)
        if not names:
            raise JudgementProblem("the frame has no wheel forces")
        added = []
        for name in names:
            for side in ("left", "right"):
                dynamic = p2_force(
                    static=0.0,
                    dip_angle=test.dip_angle,
                    speed=speeds[label],
                    unsprung_mass=masses[name],
                    track_mass=test.track_mass,
                    track_stiffness=test.track_stiffness,
                    track_damping=test.track_damping,
                )
                added.append((pl.col(f"{name}.{side}.Q").first() + dynamic).alias(f"{name}.{side}.P2"))
        found[label] = frame.with_columns(added)
    return found


def _unsprung(test: Settings, vehicle: VehicleData) -> dict[str, float]:
    """Unsprung mass of a wheel of each wheelset, kg."""
    return {body.name: body.mass / 2.0 + test.motor_mass_per_wheel for body in resolved(vehicle).wheelsets}


def _speeds(spec: Spec, vehicle: VehicleData) -> list[float]:
    """Speed of each case, m/s, in their order."""
    return [float(case.data["run"]["speed"]) for case in expand(spec, vehicle)]


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """Nothing beside the verdicts."""
    return []
