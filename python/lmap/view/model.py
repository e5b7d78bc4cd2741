"""The vehicle with its templates copied, its references replaced and its mirrored elements made: what stands where.

The core expands it when the vehicle is resolved (`VehicleData.model`); here it is given types.
Axes x forward, y right, z down from the vehicle's centre at top of rail; m, kg, kg m2.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from lmap.spec.case import VehicleData

Point = tuple[float, float, float]

_COMMON = ("between", "carries_weight", "kind", "mirror", "name", "position", "positions")
"""Keys of a connection that are not its law's, its axes or its preload."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """A body or a wheelset."""

    name: str
    mass: float
    inertia: Point
    position: Point
    """Centre of mass."""
    radius: float | None = None
    """Of a wheelset's wheels at the tape circle; none: no wheelset."""
    tape_half_distance: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Connection:
    """A force element between two body-fixed points."""

    name: str
    kind: str
    between: tuple[str, str]
    points: tuple[Point, Point]
    values: Mapping[str, Any]
    """The law's own keys, as written for the right side."""
    carries_weight: bool
    mirrored: bool
    """Made from the one on the other side."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensor:
    """A named point whose motion is recorded."""

    name: str
    body: str
    position: Point


@dataclass(frozen=True, slots=True, kw_only=True)
class Model:
    """Everything that has a place."""

    name: str
    title: str
    condition: str | None
    hash: str
    bodies: tuple[Body, ...]
    """Wheelsets last."""
    connections: tuple[Connection, ...]
    sensors: tuple[Sensor, ...]
    shapes: tuple[Mapping[str, Any], ...]
    equipment: tuple[Mapping[str, Any], ...]
    outline: Mapping[str, Any] | None

    @property
    def wheelsets(self) -> tuple[Body, ...]:
        """Bodies that roll."""
        return tuple(body for body in self.bodies if body.radius is not None)


def model_hash(vehicle: VehicleData) -> str:
    """SHA-256 of the vehicle as resolved in its condition: every number and name that the core computes with.

    How the numbers are written (parameters, templates, comments, 1 or 1.0) does not enter.
    """
    text = json.dumps(
        _exact(vehicle.model["written"]), sort_keys=True, separators=(",", ":"), ensure_ascii=False
    )
    return hashlib.sha256(text.encode()).hexdigest()


def resolved(vehicle: VehicleData) -> Model:
    """What stands where."""
    model, written = vehicle.model, vehicle.model["written"]
    return Model(
        name=vehicle.name,
        title=vehicle.title,
        condition=vehicle.condition or vehicle.design_condition,
        hash=model_hash(vehicle),
        bodies=tuple(_body(one) for one in (*model["bodies"], *model["wheelsets"])),
        connections=tuple(
            _connection(one, written["connection"][one["element"]]) for one in model["connections"]
        ),
        sensors=tuple(
            Sensor(name=one["name"], body=one["body"], position=_point(one["position"]))
            for one in model["sensors"]
        ),
        shapes=tuple(written.get("shape", ())),
        equipment=tuple(written.get("equipment", ())),
        outline=written.get("outline"),
    )


def table(vehicle: VehicleData, name: str) -> dict[str, Any]:
    """A table of the vehicle's file with its references replaced; empty where there is none."""
    return dict(vehicle.model["written"].get(name) or {})


def _body(given: Mapping[str, Any]) -> Body:
    return Body(
        name=given["name"],
        mass=given["mass"],
        inertia=_point(given["inertia"]),
        position=_point(given["position"]),
        radius=given.get("radius"),
        tape_half_distance=given.get("tape_half_distance", 0.0),
    )


def _connection(made: Mapping[str, Any], written: Mapping[str, Any]) -> Connection:
    return Connection(
        name=made["name"],
        kind=written["kind"],
        between=(written["between"][0], written["between"][1]),
        points=(_point(made["points"][0]), _point(made["points"][1])),
        values={key: value for key, value in written.items() if key not in _COMMON},
        carries_weight=written.get("carries_weight", False),
        mirrored=made["mirrored"],
    )


def _point(given: Sequence[float]) -> Point:
    return (float(given[0]), float(given[1]), float(given[2]))


def _exact(value: Any) -> Any:
    """Numbers as floats, without the sign of zero, so that 1 and 1.0, 0 and -0 are one model."""
    match value:
        case bool() | str() | None:
            return value
        case int() | float():
            return float(value) + 0.0
        case Mapping():
            return {key: _exact(item) for key, item in value.items()}
        case _:
            return [_exact(item) for item in value]
