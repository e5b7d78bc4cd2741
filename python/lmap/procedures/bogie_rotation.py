"""Rotational resistance of a bogie (LMAP 2C.4b): the moment that turns it under the body, over wheelbase and axle load.

(b) `standing`: the leading bogie is turned under a body that is held, by the angle that it has in a curve of `radius`
(half the distance of the bogie centres over the radius), to the other side and back, in steps. Its axles stand on rails
without friction or guidance, as on turntables (`run.contact`: textbook). What holds it is the moment of springs and
friction; the dampers' share at `rate` is added from their damping.

(a) `curve`: the vehicle runs through that curve at the speeds of the spec, in balance; the moment is what all
connections between them put on the leading bogie frame there by the body. Nothing turns at a rate in the full curve:
the dampers' share is added as in the loop. The loop at the same angle stands beside it, and has what friction adds:
a balance that was not led to its place leaves friction elements without force.

Moments are about the vertical axis through the frame's centre of mass. With `conditions` all of it is done in each, and
the labels end with its name.

Columns: `angle` (rad) of the bogie against the body, `moment` (N m) with the dampers' share, `x_factor`; in the curve
`loop_moment` and `loop_x_factor` too, the loop's at that angle.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict, Field

from lmap.errors import InputProblem, JudgementProblem, KeyPath, Problem
from lmap.formulas import x_factor
from lmap.procedures.axles import Bogie, two_bogies
from lmap.procedures.base import (
    MOST_CANT_MM,
    CaseFigures,
    at_rest,
    expand,
    in_condition,
    origin_of_curve,
    settings,
)
from lmap.spec.case import Case, VehicleData, build
from lmap.spec.model import Spec
from lmap.verdict import Drawing, DrawnCurve, Fact
from lmap.view.model import Connection, Model, resolved

if TYPE_CHECKING:
    import polars as pl

NAME = "bogie_rotation"
SUMMARY = "moment that turns a bogie under the body, standing and in a curve, over wheelbase and axle load"
UNITS: Mapping[str, str] = {
    "angle": "rad",
    "moment": "N m",
    "x_factor": "1",
    "loop_moment": "N m",
    "loop_x_factor": "1",
}

STANDING, REST, CURVE = "standing", "at rest", "curve"
# Rollers: no conicity, so that nothing centres the axles; their creep coefficients are not used at rest.
_ROLLERS = {
    "kind": "textbook",
    "conicity": 0.0,
    "f11": 1.0e7,
    "f22": 1.0e7,
    "f23": 0.0,
    "stiffness": 1.0e9,
    "damping": 0.0,
}


class Settings(BaseModel):
    """`[test]`."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    radius: float = Field(gt=0.0, allow_inf_nan=False)
    """Of the smallest curve, m."""
    cant_mm: float = Field(default=0.0, ge=0.0, le=MOST_CANT_MM)
    """Of that curve, where the vehicle runs through it."""
    rate: float = Field(ge=0.0, allow_inf_nan=False)
    """At which the bogie is turned, rad/s: what yaw dampers add hangs on it."""
    steps: int = Field(ge=1, le=100)
    """Load steps from straight to the full angle."""
    conditions: list[str] = Field(default_factory=list)
    """Conditions of the vehicle; the spec's own where none is given."""


SETTINGS = Settings


def turned(test: Settings, bogies: tuple[Bogie, Bogie]) -> float:
    """Angle of a bogie under the body in the curve, rad."""
    return (bogies[0].centre - bogies[1].centre) / 2.0 / test.radius


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """The loop, the vehicle at rest for its axle load, and the curve at each speed; all of them in each condition."""
    test, model = settings(spec, Settings), resolved(vehicle)
    front, rear = two_bogies(model)
    if len(spec.run.wheel_profile or [""]) != 1:
        raise InputProblem(Problem(key=("run", "wheel_profile"), found="several", allowed="one"))
    [rest] = at_rest(spec, vehicle)
    found = [build(label=REST, vehicle=vehicle, track=spec.track, run=rest.data["run"])]
    angle = turned(test, (front, rear))
    body = model.bodies[0].name
    held = [f"{body}.{part}" for part in ("x", "y", "z", "phi", "theta", "psi")]
    path = [share * angle for share in (0.0, 1.0, 0.0, -1.0, 0.0, 1.0)]
    load = [{"kind": "displacement", "coordinate": f"{front.frame.name}.psi", "path": path}]
    own = {"kind": "quasi_static", "load": load, "load_steps": test.steps, "hold": held, "contact": _ROLLERS}
    run: dict[str, Any] = {**rest.data["run"], **own}
    found.append(build(label=STANDING, vehicle=vehicle, track=spec.track, run=run))
    found += _curves(spec, vehicle, test)
    names = dict.fromkeys(test.conditions) or [None]
    return [
        in_condition(case, name, vehicle, ("test", "conditions"), label=f"{case.label}{_of(name)}")
        for name in names
        for case in found
    ]


def _of(condition: str | None) -> str:
    """What the labels of a condition end with."""
    return f", {condition}" if condition else ""


def _curves(spec: Spec, vehicle: VehicleData, test: Settings) -> list[Case]:
    """The curve, in balance, at each speed; none without a speed."""
    if spec.run.speeds is None:
        return []
    length = float(spec.track["length"])
    curve = {"kind": "curve", "length": length, "radius": test.radius, "cant_mm": test.cant_mm}
    track = {**spec.track, "layout": [curve]}
    found = []
    for case in expand(spec, vehicle, kind="equilibrium"):
        label = f"{CURVE}, {float(case.data['run']['speed']) * 3.6:.6g} km/h"
        found.append(build(label=label, vehicle=vehicle, track=track, run=case.data["run"]))
    return found


def origin(spec: Spec, label: str, key: KeyPath) -> KeyPath:
    """The curve is written in `[test]`."""
    return origin_of_curve(key) if label.startswith(CURVE) else key


def yaw_damping(model: Model, bogie: Bogie) -> float:
    """Moment per rate of yaw of a bogie under the body by all that connects the two, N m s/rad.

    Linear dampers and the damping of bushings; a damper in series with a spring counts as without it, which is the
    worst. A `JudgementProblem` for a law whose damping is not one number.
    """
    return sum(
        _damping(connection, bogie.centre)
        for connection in model.connections
        if bogie.frame.name in connection.between and model.bodies[0].name in connection.between
    )


def _damping(connection: Connection, centre: float) -> float:
    if "damping" not in connection.values:
        return 0.0
    damping = connection.values["damping"]
    x, y = connection.points[0][0] - centre, connection.points[0][1]
    if (
        isinstance(damping, list)
        and len(damping) in (3, 6)
        and all(isinstance(c, int | float) for c in damping)
    ):
        own = float(damping[5]) if len(damping) == 6 else 0.0
        return float(damping[0]) * y**2 + float(damping[1]) * x**2 + own
    if isinstance(damping, int | float) and connection.points[0] != connection.points[1]:
        (ax, ay, _), (bx, by, _) = connection.points
        length = math.dist(*connection.points)
        arm = ((ax - centre) * (by - ay) - ay * (bx - ax)) / length
        return float(damping) * arm**2
    raise JudgementProblem(
        f"what {connection.name} adds to the moment at a rate is not known: {connection.kind}"
    )


def quantities(
    spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
) -> Mapping[str, pl.DataFrame]:
    """The loop, and a row for each curve; in each condition."""
    test = settings(spec, Settings)
    found: dict[str, pl.DataFrame] = {}
    for condition in dict.fromkeys(test.conditions) or [None]:
        found |= _judged(test, frames, vehicle, _of(condition))
    return found


def _judged(
    test: Settings, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData, ending: str
) -> dict[str, pl.DataFrame]:
    """The loop and the curves of the cases whose labels end so."""
    import polars as pl

    model = resolved(vehicle)
    front, _rear = two_bogies(model)
    standing, rest = f"{STANDING}{ending}", f"{REST}{ending}"
    if standing not in frames or rest not in frames:
        raise JudgementProblem(f"the standing vehicle{ending} has no result")
    wheels = [f"{one.name}.{side}.Q" for one in front.axles for side in ("left", "right")]
    load = sum(float(frames[rest][wheel][0]) for wheel in wheels) / len(front.axles)
    loop, frame = frames[standing], front.frame.name
    angle = loop[f"{frame}.psi"] - loop[f"{frame}.psi"][0]
    holds = loop[f"{frame}.psi.reaction_moment"]
    added = yaw_damping(model, front) * test.rate
    whole = holds.abs() + added
    columns = {"step": loop["step"], "s": loop["s"], "angle": angle, "moment": holds.sign() * whole}
    found = {standing: pl.DataFrame({**columns, "x_factor": whole / (front.wheelbase * load)})}
    for label, ran in frames.items():
        if not (label.startswith(CURVE) and label.endswith(ending)):
            continue
        bent = float(ran["curvature"][0]) * (front.centre - model.bodies[0].position[0])
        yaw = abs(float(ran[f"{model.bodies[0].name}.psi"][0]) - float(ran[f"{frame}.psi"][0]) - bent)
        moment = abs(float(ran[f"{frame}.yaw_moment"][0])) + added
        read = _at(angle.to_list(), holds.to_list(), yaw) + added
        row = {"step": 0.0, "s": float(ran["s"][0]), "angle": yaw, "moment": moment, "loop_moment": read}
        row["x_factor"] = x_factor(moment, front.wheelbase, load)
        row["loop_x_factor"] = x_factor(read, front.wheelbase, load)
        found[label] = pl.DataFrame({name: [value] for name, value in row.items()})
    return found


def _at(angles: Sequence[float], moments: Sequence[float], angle: float) -> float:
    """Largest moment of the loop at an angle; beyond its ends its last slope goes on."""
    most = max(range(len(angles)), key=lambda k: angles[k])
    found = [
        abs(m + (n - m) * (angle - a) / (b - a))
        for (a, m), (b, n) in pairwise(zip(angles, moments, strict=True))
        if a != b
        and (min(a, b) <= angle <= max(a, b) or (angle > angles[most] and max(a, b) == angles[most]))
    ]
    return max(found)


def drawings(spec: Spec, quantities: Mapping[str, pl.DataFrame], vehicle: VehicleData) -> list[Drawing]:
    """Moment over angle, a drawing for each condition."""
    conditions = dict.fromkeys(settings(spec, Settings).conditions) or [None]
    return [_drawn(spec, quantities, _of(one)) for one in conditions if f"{STANDING}{_of(one)}" in quantities]


def _drawn(spec: Spec, quantities: Mapping[str, pl.DataFrame], ending: str) -> Drawing:
    standing = f"{STANDING}{ending}"
    loop = quantities[standing]
    curves = [
        DrawnCurve(
            name="turned in steps",
            x=[1e3 * v for v in loop["angle"].to_list()],
            y=[v / 1e3 for v in loop["moment"].to_list()],
        )
    ]
    # the point of a curve on the side to which the loop goes first
    side = -1.0 if loop["moment"][1] < 0.0 else 1.0
    curves += [
        DrawnCurve(
            name=label.removesuffix(ending),
            x=[1e3 * float(row["angle"][0])],
            y=[side * float(row["moment"][0]) / 1e3],
            role="points",
        )
        for label, row in quantities.items()
        if label.startswith(CURVE) and label.endswith(ending)
    ]
    reach = [1e3 * float(loop["angle"].min()), 1e3 * float(loop["angle"].max())]  # type: ignore[arg-type]
    share = next((m / x for m, x in loop.select("moment", "x_factor").iter_rows() if x > 0.0), None)
    curves += [
        DrawnCurve(
            name=f"X factor {one.max:g}", x=reach, y=[side * one.max * abs(share) / 1e3] * 2, role="limit"
        )
        for one in spec.criterion
        if share is not None and one.max is not None and one.applies_to(standing)
        for side in (-1.0, 1.0)
    ]
    return Drawing(
        title=f"Rotation of the leading bogie{ending}",
        x_label="angle under the body (mrad)",
        y_label="moment, with the dampers' share (kN m)",
        curves=tuple(curves),
        caption="Turned to one side, to the other and back; without friction the branches are one line.",
    )


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """Nothing beside the verdicts."""
    return []
