"""Longitudinal forces in curves (LMAP 2C.8): what buff and draft at angled couplers take off the wheels.

First the formula (`lmap.formulas.coupler_unloading`): coupled to equal vehicles in a curve of `radius`, the couplers
make an angle with the body; the lateral part of the force turns it about the rails, shared by the wheels of the nearest
bogie. Label `formula`, one row, column `unloading` (of the static wheel load) and `lateral_force` (N).

Then the same forces on both ends of the car body, in balance, rolling slowly through that curve, step by step from
nothing to the whole force: labels `draft` and `buff`, column `<axle>.<side>.unloading`. LMAP asks for time stepping
only where the formula gives more than 90 %.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from lmap.errors import InputProblem, JudgementProblem, Problem
from lmap.formulas import coupler_angle, coupler_unloading
from lmap.procedures.base import CaseFigures, at_rest, settings, unloading_units, with_unloading
from lmap.procedures.couplers import ends
from lmap.spec.case import Case, VehicleData, build
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


class Settings(BaseModel):
    """`[test]`."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    radius: float = Field(gt=0.0, allow_inf_nan=False)
    """Of the curve, to the right, m."""
    cant_mm: float = Field(default=0.0, ge=0.0)
    """Of the curve."""
    force: float = Field(gt=0.0, allow_inf_nan=False)
    """Along the couplers at both ends, N."""
    ways: list[Literal["draft", "buff"]] = Field(min_length=1)
    wheels_that_share: int = Field(gt=0)
    """Wheels on one rail over which the formula shares what is lost at one end."""


SETTINGS = Settings


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """The vehicle at rest on level track, then a case for each way in which the couplers push."""
    test, model = settings(spec, Settings), resolved(vehicle)
    [rest] = at_rest(spec, vehicle)
    speeds = spec.run.speeds
    if speeds is None or len(speeds) != 1:
        raise InputProblem(Problem(key=("run", "speed"), found="none or several", allowed="one speed"))
    length = float(spec.track["length"])
    curve = {"kind": "curve", "length": length, "radius": test.radius, "cant_mm": test.cant_mm}
    still = {key: value for key, value in rest.data["run"].items() if key != "load_steps"}
    found = [build(label=REST, vehicle=vehicle, track=spec.track, run=still)]
    for way in dict.fromkeys(test.ways):
        run: dict[str, Any] = {
            **rest.data["run"],
            "kind": "quasi_static",
            "speed": speeds[0].resolve(vehicle.design_speed),
            "load": _loads(test, model, 1.0 if way == "draft" else -1.0),
        }
        found.append(build(label=way, vehicle=vehicle, track={**spec.track, "layout": [curve]}, run=run))
    return found


def _loads(test: Settings, model: Model, sign: float) -> list[dict[str, Any]]:
    """Both couplers pull (+) or push: along the vehicle they cancel, across they add up, to the inside (pull)."""
    length, height = ends(model)
    across = 2.0 * test.force * math.sin(coupler_angle(length, test.radius))
    position = [0.0, 0.0, -height]
    path = [0.0, sign * across]
    return [{"kind": "force", "body": model.bodies[0].name, "axis": "y", "position": position, "path": path}]


def derived(spec: Spec, channels: Mapping[str, str]) -> Mapping[str, str]:
    """Unloading of each wheel."""
    return unloading_units(channels)


def quantities(
    spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
) -> Mapping[str, pl.DataFrame]:
    """The formula's row, and the frames of both ways with unloading."""
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
    length, height = ends(model)
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


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """Nothing beside the verdicts."""
    return []
