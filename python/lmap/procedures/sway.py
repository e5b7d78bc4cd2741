"""Sway (LMAP 2A.2): the body that leans on cant or in a curve within the kinematic outline. `where` says how:

- `rig`: one side raised in steps to `cant_mm`, lowered again, then the other side: the track under the vehicle is
  tilted, which is gravity tilted the other way;
- `curve`: in balance at the spec's speed in a curve of `radius`, canted so that each of `deficiencies_mm` is left;
- `standing`: in balance on straight track with `cant_mm`.

Rig and standing vehicle roll at the spec's (small) speed: the contact of a standing wheel is frictionless in the
core, so that the vehicle would slide into its flanges, where a real one stands.

Columns: `clearance` of the body at the bogie centres (m, negative outside), `tilt` (m, what the right rail lies lower),
`roll` of the body against the axles (rad) and its lateral place `lateral` (m) against theirs; in a curve
`throw_centre` and `throw_end` by formula, which outlines of this kind allow for separately.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from lmap.criteria.units import STANDARD_GRAVITY
from lmap.errors import InputProblem, KeyPath, Problem
from lmap.formulas import CANT_BASE, throw_centre, throw_end, unbalanced_acceleration
from lmap.outline import closed
from lmap.procedures.axles import two_bogies
from lmap.procedures.base import MOST_CANT_MM, CaseFigures, expand, origin_of_curve, settings
from lmap.procedures.displaced import LoadCase, Outline, case_of_load, drawn, section, set_loads, worst
from lmap.spec.case import Case, VehicleData
from lmap.spec.model import Spec
from lmap.verdict import Drawing, DrawnCurve, Fact
from lmap.view.model import Model, resolved

if TYPE_CHECKING:
    import polars as pl

NAME = "sway"
SUMMARY = "the body that leans on cant or in a curve within the kinematic outline"
UNITS: Mapping[str, str] = {
    "clearance": "m",
    "tilt": "m",
    "roll": "rad",
    "lateral": "m",
    "throw_centre": "m",
    "throw_end": "m",
}


MOST_STEPS = 100
"""Of the rig, from level to the largest cant."""


class Settings(BaseModel):
    """`[test]`."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    where: Literal["rig", "curve", "standing"]
    """On the cant test rig, running in a curve, or standing on cant."""
    outline: Outline
    """By name in a spec: models/outlines."""
    load_case: list[LoadCase] = Field(min_length=1)
    """The states of the vehicle."""
    cant_mm: float = Field(default=0.0, ge=0.0, le=MOST_CANT_MM)
    """Rig and standing: the largest."""
    step_mm: float = Field(default=10.0, gt=0.0)
    """Rig: from one step to the next."""
    radius: float | None = Field(default=None, gt=0.0)
    """Curve: m, to the right."""
    deficiencies_mm: list[float] = Field(default_factory=list)
    """Curve: cant deficiencies."""

    @model_validator(mode="after")
    def _not_too_many_steps(self) -> Self:
        if self.cant_mm > MOST_STEPS * self.step_mm:
            raise ValueError(f"a step_mm that makes at most {MOST_STEPS} steps of cant_mm")
        return self


SETTINGS = Settings


def tilts(test: Settings) -> list[float]:
    """Rig: what the right rail lies lower than the left, step by step, m."""
    steps = max(round(test.cant_mm / test.step_mm), 1)
    path = [*range(steps + 1), *range(steps - 1, -steps - 1, -1), *range(-steps + 1, 1)]
    return [test.cant_mm / 1e3 * k / steps for k in path]


def _tilted_gravity(model: Model, path: Sequence[float], gravity: float) -> list[dict[str, Any]]:
    """Forces that turn every body's weight from the track's normal to where it is on tilted track."""
    loads = []
    for body in model.bodies:
        sines = [tilt / CANT_BASE for tilt in path]
        weight = body.mass * gravity
        across = [weight * s for s in sines]
        along = [weight * (math.sqrt(1.0 - s * s) - 1.0) for s in sines]
        for axis, values in (("y", across), ("z", along)):
            loads.append({"kind": "force", "body": body.name, "axis": axis, "path": values})
    return loads


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """One for each load case; in a curve for each deficiency too."""
    test, model = settings(spec, Settings), resolved(vehicle)
    section(model)
    [rolling, *others] = expand(spec, vehicle, kind="quasi_static")
    if others:
        raise InputProblem(Problem(key=("run",), found="several", allowed="one speed and one wheel profile"))
    run = rolling.data["run"]
    found = []
    for load in test.load_case:
        if load.condition is not None and test.where == "rig":
            allowed = "the spec's own condition on the rig: the weights that are tilted are those of it"
            raise InputProblem(Problem(key=("test", "load_case"), found="a condition", allowed=allowed))
        for label, track, loads in _states(spec, test, model, float(run["speed"]), load):
            own: dict[str, Any] = {"load": loads, "load_steps": 1} if loads else {"kind": "equilibrium"}
            found.append(case_of_load(load, vehicle, label=label, track=track, run={**run, **own}))
    return found


def _states(
    spec: Spec, test: Settings, model: Model, speed: float, load: LoadCase
) -> list[tuple[str, dict[str, Any], list[dict[str, Any]]]]:
    """Label, track and loads of each case of a load case."""
    length = float(spec.track["length"])
    gravity = float(spec.run.rest.get("gravity", STANDARD_GRAVITY))
    if test.where == "rig":
        path = tilts(test)
        loads = _tilted_gravity(model, path, gravity) + set_loads(load, model, len(path))
        return [(load.label, spec.track, loads)]
    if test.where == "standing":
        layout = [{"kind": "tangent", "length": length, "cant_mm": test.cant_mm}]
        return [(load.label, {**spec.track, "layout": layout}, set_loads(load, model, 1))]
    if test.radius is None or not test.deficiencies_mm:
        allowed = "radius and deficiencies_mm"
        raise InputProblem(Problem(key=("test",), found='where = "curve" without them', allowed=allowed))
    found = []
    for number, deficiency in enumerate(test.deficiencies_mm):
        low, high = deficiencies(speed, test.radius, gravity)
        if not low <= deficiency / 1e3 <= high:
            between = f"{1e3 * low:.0f} to {1e3 * high:.0f} mm at this speed and radius"
            allowed = f"{between}: a cant of {MOST_CANT_MM:g} mm at most"
            key = ("test", "deficiencies_mm", number)
            raise InputProblem(Problem(key=key, found=f"{deficiency:g} mm", allowed=allowed))
        cant = cant_for(speed, test.radius, deficiency / 1e3, gravity)
        layout = [{"kind": "curve", "length": length, "radius": test.radius, "cant_mm": 1e3 * cant}]
        name = f"{load.label}, {deficiency:g} mm"
        found.append((name, {**spec.track, "layout": layout}, set_loads(load, model, 1)))
    return found


def deficiencies(speed: float, radius: float, gravity: float) -> tuple[float, float]:
    """Cant deficiency, m, on the largest cant and on as much to the other side."""
    free, sine = speed**2 / radius, MOST_CANT_MM / 1e3 / CANT_BASE
    level, lowered = free * math.sqrt(1.0 - sine * sine), gravity * sine
    return (level - lowered) * CANT_BASE / gravity, (level + lowered) * CANT_BASE / gravity


def cant_for(speed: float, radius: float, deficiency: float, gravity: float) -> float:
    """Cant, m, with which V2/R cos c - g sin c is the acceleration of a cant deficiency (m)."""
    wanted, free = unbalanced_acceleration(deficiency, gravity), speed**2 / radius
    # free cos c - gravity sin c = wanted, exactly
    angle = math.atan2(free, gravity) - math.asin(wanted / math.hypot(free, gravity))
    return CANT_BASE * math.sin(angle)


def origin(spec: Spec, label: str, key: KeyPath) -> KeyPath:
    """Track that is written in `[test]`."""
    return origin_of_curve(key) if settings(spec, Settings).where != "rig" else key


def quantities(
    spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
) -> Mapping[str, pl.DataFrame]:
    """The frames with clearance and what it comes from, row by row."""
    test, model = settings(spec, Settings), resolved(vehicle)
    return {
        label: _with_sway(frame, test, model, load)
        for load in test.load_case
        for label, frame in frames.items()
        if label == load.label or label.startswith(f"{load.label}, ")
    }


def _with_sway(frame: pl.DataFrame, test: Settings, model: Model, load: LoadCase) -> pl.DataFrame:
    import polars as pl

    outline, stations = closed(test.outline.kinematic), _stations(model)
    body, axles = model.bodies[0].name, [axle.name for axle in model.wheelsets]
    nearest = [
        worst(frame, row, model, outline, stations=stations, wheel_wear=load.wheel_wear)[0].distance
        for row in range(frame.height)
    ]
    tilt = tilts(test) if test.where == "rig" else [CANT_BASE * math.sin(c) for c in frame["cant"].to_list()]
    front, rear = two_bogies(model)
    pivots, curvature = front.centre - rear.centre, float(frame["curvature"][0])
    added = [
        pl.Series("clearance", nearest),
        pl.Series("tilt", tilt),
        (pl.col(f"{body}.phi") - pl.mean_horizontal(f"{name}.phi" for name in axles)).alias("roll"),
        (
            pl.col(f"{body}.y")
            - pl.mean_horizontal(f"{name}.y" for name in axles)
            - curvature * pivots**2 / 8.0
        ).alias("lateral"),
    ]
    if curvature != 0.0:
        length, radius = float((model.outline or {})["length_over_couplers"]), abs(1.0 / curvature)
        added.append(pl.lit(throw_centre(pivots, front.wheelbase, radius)).alias("throw_centre"))
        added.append(pl.lit(throw_end(length, pivots, front.wheelbase, radius)).alias("throw_end"))
    return frame.with_columns(added)


def _stations(model: Model) -> tuple[float, float]:
    """The bogie centres: elsewhere the throw comes in."""
    front, rear = two_bogies(model)
    return front.centre, rear.centre


def drawings(spec: Spec, quantities: Mapping[str, pl.DataFrame], vehicle: VehicleData) -> list[Drawing]:
    """The body where it is nearest to the outline; on the rig its roll over the cant too."""
    test, model = settings(spec, Settings), resolved(vehicle)
    outline = closed(test.outline.kinematic)
    curves = [drawn(test.outline.title, outline, "limit")]
    for load in test.load_case:
        for label, frame in quantities.items():
            if label == load.label or label.startswith(f"{load.label}, "):
                row = int(frame["clearance"].arg_min() or 0)
                placed = worst(
                    frame, row, model, outline, stations=_stations(model), wheel_wear=load.wheel_wear
                )
                curves.append(drawn(label, placed[1]))
    found = [
        Drawing(
            title="Body within the kinematic outline, where it is nearest",
            x_label="lateral (m)",
            y_label="height above rail (m)",
            curves=tuple(curves),
            equal_axes=True,
        )
    ]
    for name, shown, unit in (("roll", "roll", "mrad"), ("lateral", "lateral place", "mm")):
        loops = tuple(
            DrawnCurve(
                name=label,
                x=[1e3 * v for v in frame["tilt"].to_list()],
                y=[1e3 * v for v in frame[name].to_list()],
            )
            for label, frame in quantities.items()
            if frame.height > 1
        )
        if loops:
            found.append(
                Drawing(
                    title=f"Sway on the rig: {shown} of the body against its axles",
                    x_label="cant (mm)",
                    y_label=f"{shown} ({unit})",
                    curves=loops,
                )
            )
    return found


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """Nothing beside the verdicts."""
    return []
