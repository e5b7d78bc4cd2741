"""A vehicle displaced within an outline: load cases, reference outlines, and the body's place on the track.

A load case may set springs: what a spring has settled by (worn, cracked, failed onto its seat) acts as its stiffness
times that, pulling its two ends together. Wheel wear lets everything down by the radius lost.
"""

from __future__ import annotations

import fnmatch
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from lmap.errors import InputProblem, Problem
from lmap.outline import Clearance, Points, clearance, closed, displaced
from lmap.procedures.base import in_condition
from lmap.spec.case import Case, VehicleData, build
from lmap.verdict import DrawnCurve
from lmap.view.model import Connection, Model

if TYPE_CHECKING:
    import polars as pl

Half = Annotated[list[tuple[float, float]], Field(min_length=2)]
"""Points of a right half, y and z (m), from the bottom up."""


class Outline(BaseModel):
    """A reference outline, as a file in models/outlines has it."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str
    """As specs call it."""
    title: str
    """One line for people."""
    source: str
    """Where it is from; `assumed` where no public source gives it."""
    reason: str | None = None
    """Why it is as it is, where it is assumed."""
    static: Half
    """Of a standing vehicle: points (m from the middle, m above rail) of one half, upwards."""
    kinematic: Half
    """Of a vehicle that leans and moves, likewise."""


class LoadCase(BaseModel):
    """A state of the vehicle."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    label: str = Field(min_length=1)
    """Of its case."""
    condition: str | None = None
    """The spec's own where none is given."""
    wheel_wear: float = Field(default=0.0, ge=0.0, le=0.2)
    """Radius lost, m."""
    spring_set: dict[str, Annotated[float, Field(gt=0.0, le=0.3)]] = Field(default_factory=dict)
    """m by which springs have settled, by name or pattern: `secondary_bogie1_*`."""


def case_of_load(
    load: LoadCase, vehicle: VehicleData, *, label: str, track: Mapping[str, Any], run: Mapping[str, Any]
) -> Case:
    """A case in the condition of a load case."""
    case = build(label=label, vehicle=vehicle, track=track, run=run)
    return in_condition(case, load.condition, vehicle, ("test", "load_case"), label=label)


def set_loads(load: LoadCase, model: Model, rows: int) -> list[dict[str, Any]]:
    """The forces of settled springs, the same in every row."""
    loads = []
    heights = {body.name: body.position[2] for body in model.bodies}
    for pattern, by in load.spring_set.items():
        found = [one for one in model.connections if fnmatch.fnmatchcase(one.name, pattern)]
        if not found:
            names = ", ".join(one.name for one in model.connections if one.carries_weight)
            raise InputProblem(
                Problem(
                    key=("test", "load_case"),
                    found=f'"{pattern}"',
                    allowed=f"springs of the vehicle: {names}",
                )
            )
        for one in found:
            force = _vertical_stiffness(one) * by
            upper = 0 if heights[one.between[0]] < heights[one.between[1]] else 1
            loads += [
                {
                    "kind": "force",
                    "body": one.between[end],
                    "axis": "z",
                    "position": list(one.points[end]),
                    "path": [force if end == upper else -force] * rows,
                }
                for end in (0, 1)
            ]
    return loads


def _vertical_stiffness(connection: Connection) -> float:
    written = connection.values.get("axial" if connection.kind == "shear_spring" else "stiffness")
    if isinstance(written, list) and len(written) in (3, 6):
        written = written[2]
    if isinstance(written, int | float) and connection.kind in ("bushing", "shear_spring"):
        return float(written)
    found = f'"{connection.name}", a {connection.kind}'
    allowed = "springs with one vertical stiffness: bushing, shear_spring"
    raise InputProblem(Problem(key=("test", "load_case"), found=found, allowed=allowed))


def section(model: Model) -> Points:
    """The car body's cross-section; an `InputProblem` where the vehicle has none."""
    written = (model.outline or {}).get("section", ())
    if len(written) < 2:
        found = f"{model.name} without it"
        allowed = "section in its [outline]: points y, z of the right half"
        raise InputProblem(Problem(key=("vehicle",), found=found, allowed=allowed))
    return closed(written)


def body_on_track(
    frame: pl.DataFrame, row: int, model: Model, *, x: float, wheel_wear: float
) -> tuple[float, float, float]:
    """Displacement of the car body to the right and down (m) and its roll, at a place along it, against the track
    there.

    The body is straight: in a curve the track bends away from it by x2/(2R). Heights are from the rail as it lies
    under the vehicle.
    """
    body = model.bodies[0]

    def at(name: str) -> float:
        return float(frame[name][row]) if name in frame.columns else 0.0

    arm = x - body.position[0]
    y = at(f"{body.name}.y") + arm * at(f"{body.name}.psi") - at("curvature") * arm**2 / 2.0
    rails = [at(f"{axle.name}.track_z") for axle in model.wheelsets]
    sunk = sum(rails) / max(len(rails), 1)
    z = at(f"{body.name}.z") - body.position[2] - arm * at(f"{body.name}.theta") - sunk + wheel_wear
    return y, z, at(f"{body.name}.phi")


def worst(
    frame: pl.DataFrame,
    row: int,
    model: Model,
    outline: Points,
    *,
    stations: Sequence[float],
    wheel_wear: float,
) -> tuple[Clearance, Points]:
    """Least clearance of the body over its stations (m along it), and its section there."""
    shape, centre = section(model), model.bodies[0].position[2]
    found = []
    for x in stations:
        y, z, roll = body_on_track(frame, row, model, x=x, wheel_wear=wheel_wear)
        placed = displaced(shape, y=y, z=z, roll=roll, centre=centre)
        found.append((clearance(placed, outline), placed))
    return min(found, key=lambda one: one[0].distance)


def drawn(name: str, points: Points, role: Any = "outline") -> DrawnCurve:
    """A polygon for a drawing, height upward, m."""
    return DrawnCurve(name=name, x=points[:, 0].tolist(), y=(-points[:, 1]).tolist(), role=role)
