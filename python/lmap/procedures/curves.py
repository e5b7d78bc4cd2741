"""Curves: one run through each curve that the spec lists, at its own speed or at the one that gives a stated unbalanced
acceleration.

Straight track, a clothoid, the full curve; with `exit_m` a second clothoid and straight track again. Beside the runs
the vehicle at rest (`wheel_forces`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Self

from pydantic import Field, model_validator

from lmap.criteria.units import STANDARD_GRAVITY
from lmap.errors import InputProblem, KeyPath, Problem
from lmap.formulas import CANT_BASE
from lmap.procedures import wheel_forces
from lmap.procedures.base import MOST_CANT_MM, CaseFigures, Table, expand, settings
from lmap.procedures.speed_range import Slow, stepped
from lmap.spec.case import Case, VehicleData
from lmap.spec.model import RunPart, Spec
from lmap.verdict import Fact

NAME = "curves"
SUMMARY = "one run through each curve of a list, at its speed or its unbalanced acceleration"
UNITS: Mapping[str, str] = {}


class Curve(Table):
    """One curve and how fast it is run."""

    radius_m: float = Field(allow_inf_nan=False)
    """+ to the right."""
    cant_mm: float = Field(default=0.0, ge=0.0, le=MOST_CANT_MM)
    """Of the outer rail above the inner one."""
    unbalanced: float | None = Field(default=None, allow_inf_nan=False)
    """m/s2 in the plane of the rails, + outward: V2/R cos c - g sin c. This or `speed_kmh`."""
    speed_kmh: float | None = Field(default=None, gt=0.0, allow_inf_nan=False)
    """This or `unbalanced`."""
    label: str | None = Field(default=None, min_length=1)
    """Of its case; radius, cant and speed if absent."""

    @model_validator(mode="after")
    def _one_speed(self) -> Self:
        if (self.unbalanced is None) == (self.speed_kmh is None):
            raise ValueError("one of unbalanced and speed_kmh")
        if self.radius_m == 0.0:
            raise ValueError("a radius_m that is not 0")
        return self

    def speed(self, gravity: float) -> float:
        """m/s; NaN where no speed gives so little unbalanced acceleration."""
        if self.speed_kmh is not None:
            return self.speed_kmh / 3.6
        assert self.unbalanced is not None  # one of the two
        sine = self.cant_mm / (1e3 * CANT_BASE)
        square = abs(self.radius_m) * (self.unbalanced + gravity * sine) / math.sqrt(1.0 - sine * sine)
        return math.sqrt(square) if square > 0.0 else math.nan

    def called(self, gravity: float) -> str:
        """Label of its case."""
        speed = self.speed(gravity) * 3.6
        return self.label or f"R {self.radius_m:g} m, {self.cant_mm:g} mm, {speed:.1f} km/h"


class Settings(wheel_forces.Settings):
    """`[test]`."""

    curves: list[Curve] = Field(min_length=1)
    """One case each."""
    straight_m: float = Field(gt=0.0, allow_inf_nan=False)
    """Straight track before the curve."""
    transition_m: float = Field(gt=0.0, allow_inf_nan=False)
    """Length of a clothoid, curvature and cant together."""
    curve_m: float = Field(gt=0.0, allow_inf_nan=False)
    """Full curve."""
    exit_m: float = Field(default=0.0, ge=0.0, allow_inf_nan=False)
    """Straight track after a second clothoid; 0: the run ends in the curve."""
    slow: list[Slow] = Field(default_factory=list)
    """As in `speed_range`."""


SETTINGS = Settings

derived = wheel_forces.derived
quantities = wheel_forces.quantities


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """A run for every wheel profile and curve, then the vehicle at rest."""
    own = settings(spec, Settings)
    for key in ("speed", "speed_kmh"):
        if getattr(spec.run, key) is not None:
            problem = Problem(key=("run", key), found="a speed", allowed="none: each curve has its own")
            raise InputProblem(problem)
    for key in ("length", "layout"):
        if key in spec.track:
            problem = Problem(
                key=("track", key), found=f"a {key}", allowed="none: [test] lays the curves out"
            )
            raise InputProblem(problem)
    runs = [
        case for number, curve in enumerate(own.curves) for case in _runs(spec, vehicle, own, number, curve)
    ]
    return runs + wheel_forces.static_cases(spec, vehicle)


def _runs(spec: Spec, vehicle: VehicleData, own: Settings, number: int, curve: Curve) -> list[Case]:
    """One curve, once for every wheel profile."""
    gravity = _gravity(spec)
    speed = curve.speed(gravity)
    if math.isnan(speed):
        key = ("test", "curves", number, "unbalanced")
        allowed = f"more than -{gravity:g} m/s2 times {curve.cant_mm:g} mm / 1500 mm"
        raise InputProblem(Problem(key=key, found=f"{curve.unbalanced:g} m/s2", allowed=allowed))
    if math.isinf(speed):
        key = ("test", "curves", number, "radius_m")
        raise InputProblem(
            Problem(key=key, found=f"{curve.radius_m:g} m", allowed="a radius with a finite speed")
        )
    run = RunPart.model_validate({**spec.run.model_dump(exclude_none=True), "speed": speed})
    layout, length = _layout(own, curve)
    track = {**spec.track, "layout": layout, "length": length}
    found = expand(spec.model_copy(update={"run": run, "track": track}), vehicle)
    label = curve.called(gravity)
    named = spec.run.wheel_profile is not None
    return [
        stepped(Case(one, {**case.data, "label": one}), own.slow)
        for case in found
        for one in [f"{case.label} {label}" if named else label]
    ]


def _gravity(spec: Spec) -> float:
    return float((spec.run.model_extra or {}).get("gravity", STANDARD_GRAVITY))


_LENGTHS = ("straight_m", "transition_m", "curve_m", "transition_m", "exit_m")
"""What says how long the segments are, in their order."""


def origin(spec: Spec, label: str, key: KeyPath) -> KeyPath:
    """The layout is written in `[test]`."""
    if key[:2] != ("track", "layout") or len(key) < 4:
        return key
    if key[3] == "length":
        return ("test", _LENGTHS[int(key[2])])
    own = {"radius": "radius_m", "cant_mm": "cant_mm"}.get(str(key[3]))
    for number, curve in enumerate(settings(spec, Settings).curves):
        if own is not None and label.endswith(curve.called(_gravity(spec))):
            return ("test", "curves", number, own)
    return key


def _layout(own: Settings, curve: Curve) -> tuple[list[dict[str, Any]], float]:
    """Segments, and their length together."""
    inward = math.copysign(curve.cant_mm, curve.radius_m)
    parts: list[dict[str, Any]] = [
        {"kind": "tangent", "length": own.straight_m},
        {"kind": "clothoid", "length": own.transition_m},
        {"kind": "curve", "length": own.curve_m, "radius": curve.radius_m, "cant_mm": inward},
    ]
    if own.exit_m > 0.0:
        parts.append({"kind": "clothoid", "length": own.transition_m})
        parts.append({"kind": "tangent", "length": own.exit_m})
    return parts, sum(float(part["length"]) for part in parts)


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """Nothing beside the verdicts."""
    return []
