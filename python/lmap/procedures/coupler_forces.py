"""Longitudinal forces in curves (LMAP 2C.8): what buff and draft at angled couplers take off the wheels.

First the formula (`lmap.formulas.coupler_unloading`): coupled to equal vehicles in a curve of `radius`, the couplers
make an angle with the body; the lateral part of the force turns it about the rails, shared by the wheels of the nearest
bogie. Label `formula`, one row, column `unloading` (of the static wheel load) and `lateral_force` (N).

Then the same forces on both ends of the car body, in balance, rolling slowly through that curve, step by step from
nothing to the whole force: labels `draft` and `buff`, column `<axle>.<side>.unloading`. LMAP asks for time stepping
only where the formula gives more than 90 %: `[[test.stepped]]`, a run along the spec's track between two equal
neighbours, with the force of `[test]` in both couplers (`way`) or with what the train in its `run.train` gives.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from lmap.errors import InputProblem, JudgementProblem, KeyPath, Problem
from lmap.formulas import coupler_angle, coupler_unloading
from lmap.procedures.base import (
    MOST_CANT_MM,
    CaseFigures,
    at_rest,
    origin_of_curve,
    settings,
    unloading_units,
    with_unloading,
)
from lmap.spec.case import Case, VehicleData, build, merged
from lmap.spec.model import Spec
from lmap.verdict import Drawing, DrawnCurve, Fact
from lmap.view.model import Model, resolved

if TYPE_CHECKING:
    import polars as pl

NAME = "coupler_forces"
SUMMARY = (
    "wheel unloading by buff and draft at angled couplers in a curve: formula, then balance in the curve"
)
UNITS: Mapping[str, str] = {"unloading": "1", "lateral_force": "N"}

REST = "at rest"


class Stepped(BaseModel):
    """`[[test.stepped]]`: one run in time."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    label: str = Field(min_length=1)
    """Of its case."""
    way: Literal["draft", "buff"] | None = None
    """Which way the force of `[test]` acts in both couplers; without it they have what `run.train` gives."""
    run: dict[str, Any] = Field(default_factory=dict)
    """Laid over `[run]`."""
    track: dict[str, Any] = Field(default_factory=dict)
    """Laid over `[track]`."""


class Settings(BaseModel):
    """`[test]`."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    radius: float = Field(gt=0.0, allow_inf_nan=False)
    """Of the curve, to the right, m."""
    cant_mm: float = Field(default=0.0, ge=0.0, le=MOST_CANT_MM)
    """Of the curve."""
    force: float = Field(gt=0.0, allow_inf_nan=False)
    """Along the couplers at both ends, N."""
    ways: list[Literal["draft", "buff"]] = Field(default_factory=list)
    """Which ways are brought to balance in the curve."""
    wheels_that_share: int = Field(gt=0)
    """Wheels on one rail over which the formula shares what is lost at one end; at most all that the vehicle has."""
    shank: float | None = Field(default=None, gt=0.0, allow_inf_nan=False)
    """From a coupler's pivot to its pulling face, m; only runs in time need it."""
    build_up_s: float = Field(default=5.0, gt=0.0, allow_inf_nan=False)
    """Time in which the force of `[test]` grows to its whole in a run in time."""
    stepped: list[Stepped] = Field(default_factory=list)
    """Runs in time."""

    @model_validator(mode="after")
    def _something_to_do(self) -> Self:
        if not self.ways and not self.stepped:
            raise ValueError("ways or stepped, one of them at least")
        if self.stepped and self.shank is None:
            raise ValueError("shank, which runs in time need")
        return self


SETTINGS = Settings


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """The vehicle at rest on level track, a case for each way in which the couplers push, then the runs in time."""
    test, model = settings(spec, Settings), resolved(vehicle)
    _check_shares(test, model)
    [rest] = at_rest(spec, vehicle)
    speeds = spec.run.speeds
    if speeds is None or len(speeds) != 1:
        raise InputProblem(Problem(key=("run", "speed"), found="none or several", allowed="one speed"))
    length = float(spec.track["length"])
    curve = {"kind": "curve", "length": length, "radius": test.radius, "cant_mm": test.cant_mm}
    still = {key: value for key, value in rest.data["run"].items() if key != "load_steps"}
    level = {"layout": [{"kind": "tangent", "length": length}]}
    found = [build(label=REST, vehicle=vehicle, track={**spec.track, **level}, run=still)]
    for way in dict.fromkeys(test.ways):
        run: dict[str, Any] = {
            **rest.data["run"],
            "kind": "quasi_static",
            "speed": speeds[0].resolve(vehicle.design_speed),
            "load": _loads(test, model, 1.0 if way == "draft" else -1.0),
        }
        found.append(build(label=way, vehicle=vehicle, track={**spec.track, "layout": [curve]}, run=run))
    stepping = {**still, "kind": "time", "speed": speeds[0].resolve(vehicle.design_speed)}
    for one in test.stepped:
        run = merged({**stepping, "couplers": _couplers(test, one)}, one.run)
        found.append(build(label=one.label, vehicle=vehicle, track=merged(spec.track, one.track), run=run))
    return found


def origin(spec: Spec, label: str, key: KeyPath) -> KeyPath:
    """The shank, and the curve of the balances, are written in `[test]`."""
    if key == ("run", "couplers", "shank"):
        return ("test", "shank")
    return origin_of_curve(key) if label in settings(spec, Settings).ways else key


def _check_shares(test: Settings, model: Model) -> None:
    most = len(model.wheelsets)
    if test.wheels_that_share > most:
        key, found = ("test", "wheels_that_share"), str(test.wheels_that_share)
        raise InputProblem(Problem(key=key, found=found, allowed=f"1 to {most}, the wheels on one rail"))


def _couplers(test: Settings, one: Stepped) -> dict[str, Any]:
    """`run.couplers`: between equal neighbours, with the force of `[test]` or without any beside the train's."""
    if one.way is None:
        return {"shank": test.shank}
    force = test.force if one.way == "draft" else -test.force
    course = [[0.0, 0.0], [test.build_up_s, force]]
    return {"shank": test.shank, "front": course, "rear": course}


def _loads(test: Settings, model: Model, sign: float) -> list[dict[str, Any]]:
    """Both couplers pull (+) or push: along the vehicle they cancel, across they add up, to the inside (pull)."""
    length, height = _ends(model)
    across = 2.0 * test.force * math.sin(coupler_angle(length, test.radius))
    position = [0.0, 0.0, -height]
    path = [0.0, sign * across]
    return [{"kind": "force", "body": model.bodies[0].name, "axis": "y", "position": position, "path": path}]


def _ends(model: Model) -> tuple[float, float]:
    """Length over couplers and height of the couplers above rail, m."""
    outline = model.outline
    if outline is None:
        found = f"{model.name} without [outline]"
        allowed = "length_over_couplers and coupler_height in its [outline]"
        raise InputProblem(Problem(key=("vehicle",), found=found, allowed=allowed))
    return float(outline["length_over_couplers"]), float(outline["coupler_height"])


def derived(spec: Spec, channels: Mapping[str, str]) -> Mapping[str, str]:
    """Unloading of each wheel."""
    return unloading_units(channels)


def quantities(
    spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
) -> Mapping[str, pl.DataFrame]:
    """The formula's row, and the frames of all others with unloading."""
    import polars as pl

    test, model = settings(spec, Settings), resolved(vehicle)
    if REST not in frames:
        raise JudgementProblem(
            "the vehicle at rest, whose wheel loads the others are compared with, has no result"
        )
    level = frames[REST]
    loads = [float(level[name][0]) for name in level.columns if name.endswith(".Q")]
    if not loads:
        raise JudgementProblem("the vehicle at rest has no wheel loads")
    length, height = _ends(model)
    angle = coupler_angle(length, test.radius)
    lost = coupler_unloading(test.force, angle, height) / test.wheels_that_share
    formula = pl.DataFrame(
        {
            "step": [0.0],
            "s": [0.0],
            "unloading": [lost / min(loads)],
            "lateral_force": [test.force * math.sin(angle)],
        }
    )
    return {"formula": formula} | {
        label: with_unloading(frame, level) for label, frame in frames.items() if label != REST
    }


def drawings(spec: Spec, quantities: Mapping[str, pl.DataFrame], vehicle: VehicleData) -> list[Drawing]:
    """Unloading of the worst wheel of each axle over the coupler force."""
    test = settings(spec, Settings)
    found = []
    for label, frame in quantities.items():
        if label == "formula":
            continue
        if "t" in frame.columns:
            found.append(_along(label, frame))
            continue
        share = [test.force * k / max(frame.height - 1, 1) / 1e3 for k in range(frame.height)]
        worst = [
            DrawnCurve(
                name=name.removesuffix(".unloading"), x=share, y=[100.0 * v for v in frame[name].to_list()]
            )
            for name in frame.columns
            if name.endswith(".unloading")
        ]
        formula = [100.0 * float(quantities["formula"]["unloading"][0]) * f * 1e3 / test.force for f in share]
        found.append(
            Drawing(
                title=f"{label}, curve of {test.radius:g} m",
                x_label="coupler force (kN)",
                y_label="wheel unloading (%)",
                curves=(*worst, DrawnCurve(name="formula", x=share, y=formula, role="limit")),
                caption="Without coupler force the curve alone has moved load between the wheels.",
            )
        )
    return found


def _along(label: str, frame: pl.DataFrame) -> Drawing:
    """Unloading of every wheel of a run in time along the track."""
    frame = frame.gather_every(max(1, frame.height // 500))
    place = frame["s"].to_list()
    curves = [
        DrawnCurve(name=name.removesuffix(".unloading"), x=place, y=(100.0 * frame[name]).to_list())
        for name in frame.columns
        if name.endswith(".unloading")
    ]
    return Drawing(title=label, x_label="place (m)", y_label="wheel unloading (%)", curves=tuple(curves))


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """Nothing beside the verdicts."""
    return []
