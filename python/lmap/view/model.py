"""The vehicle with its templates copied, its references replaced and its mirrored elements made: what stands where.

The core does the same before a run and has refused what is wrong when this is asked; here nothing is checked again.
Axes x forward, y right, z down from the vehicle's centre at top of rail; m, kg, kg m2.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from lmap.spec.case import VehicleData

Point = tuple[float, float, float]

_LISTS = ("body", "connection", "gap", "sensor", "wheelset")
_POSITIONS = ("position", "positions")
_OWN = ("parameters", "condition", "template", "use", "include")
_COMMON = ("axes", "between", "carries_weight", "kind", "mirror", "name", "position", "positions", "preload")
_WORD = re.compile(r"\{([^{}]*)\}")


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
    text = json.dumps(_exact(_expanded(vehicle)), sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()


def resolved(vehicle: VehicleData) -> Model:
    """What stands where, of a vehicle that the core has accepted."""
    document = _expanded(vehicle)
    bodies = [
        Body(name=b["name"], mass=b["mass"], inertia=_point(b["inertia"]), position=_point(b["position"]))
        for b in document["body"]
    ]
    bodies += [
        Body(
            name=w["name"],
            mass=w["mass"],
            inertia=_point(w["inertia"]),
            position=(float(w["position"][0]), float(w["position"][1]), -float(w["radius"])),
            radius=float(w["radius"]),
            tape_half_distance=float(w["tape_half_distance"]),
        )
        for w in document["wheelset"]
    ]
    return Model(
        name=vehicle.name,
        title=vehicle.title,
        condition=vehicle.condition or vehicle.design_condition,
        hash=model_hash(vehicle),
        bodies=tuple(bodies),
        connections=tuple(one for written in document["connection"] for one in _connections(written)),
        sensors=tuple(
            Sensor(name=f"{s['body']}.{s['name']}", body=s["body"], position=_point(s["position"]))
            for s in document["sensor"]
        ),
        shapes=tuple(document.get("shape", ())),
        equipment=tuple(document.get("equipment", ())),
        outline=document.get("outline"),
    )


def table(vehicle: VehicleData, name: str) -> dict[str, Any]:
    """A table of the vehicle's file with its references replaced; empty where there is none."""
    found: dict[str, Any] = _expanded(vehicle).get(name, {})
    return found


def _connections(written: Mapping[str, Any]) -> Iterator[Connection]:
    ends = written["positions"] if "positions" in written else [written["position"]] * 2
    points = (_point(ends[0]), _point(ends[1]))

    def one(suffix: str, points: tuple[Point, Point], *, mirrored: bool = False) -> Connection:
        return Connection(
            name=f"{written['name']}{suffix}",
            kind=written["kind"],
            between=(written["between"][0], written["between"][1]),
            points=points,
            values={
                key: value
                for key, value in written.items()
                if key not in _COMMON or key in ("axes", "preload")
            },
            carries_weight=bool(written.get("carries_weight", False)),
            mirrored=mirrored,
        )

    if not written.get("mirror", False):
        yield one("", points)
        return
    yield one("_right", points)
    yield one("_left", (_mirror(points[0]), _mirror(points[1])), mirrored=True)


def _mirror(point: Point) -> Point:
    return (point[0], -point[1], point[2])


def _point(written: Sequence[float]) -> Point:
    return (float(written[0]), float(written[1]), float(written[2]))


def _expanded(vehicle: VehicleData) -> dict[str, Any]:
    """The document as one flat table: lists expanded, condition applied, every reference a number."""
    document = vehicle.document
    named = _flat(document.get("parameters", {}))
    condition = vehicle.condition or vehicle.design_condition or "full"
    named |= _flat(document.get("condition", {}).get(condition, {}))
    numbers = {name: _number(name, named) for name in named}
    whole: dict[str, Any] = {
        key: _replaced(value, {}, numbers)
        for key, value in document.items()
        if key not in _OWN and key not in _LISTS
    }
    whole |= {kind: [] for kind in _LISTS}
    _copy(document, {}, (0.0, 0.0, 0.0), document.get("template", {}), numbers, whole)
    return whole


def _copy(
    table: Mapping[str, Any],
    words: Mapping[str, str],
    shift: Point,
    templates: Mapping[str, Any],
    numbers: Mapping[str, float],
    out: dict[str, Any],
) -> None:
    """Adds the lists of a table and of all that it uses."""
    for kind in _LISTS:
        for written in table.get(kind, ()):
            element = _replaced(written, words, numbers)
            for key in _POSITIONS:
                if key in element:
                    element[key] = _shifted(element[key], shift)
            out[kind].append(element)
    for written in table.get("use", ()):
        use = _replaced(written, words, numbers)
        at = use.get("at", (0.0, 0.0, 0.0))
        further = (shift[0] + at[0], shift[1] + at[1], shift[2] + at[2])
        _copy(templates[use["template"]], use.get("with", {}), further, templates, numbers, out)


def _shifted(position: Sequence[Any], shift: Point) -> list[Any]:
    if position and isinstance(position[0], list | tuple):
        return [_shifted(one, shift) for one in position]
    return [value + by for value, by in zip(position, shift, strict=False)]


def _replaced(value: Any, words: Mapping[str, str], numbers: Mapping[str, float]) -> Any:
    """A copy with placeholders filled in, then references replaced."""
    match value:
        case str():
            text = _WORD.sub(lambda match: words.get(match[1], match[0]), value)
            name = text.removeprefix("-")
            if not name.startswith("$") or name[1:] not in numbers:
                return text
            return -numbers[name[1:]] if text.startswith("-") else numbers[name[1:]]
        case Mapping():
            return {key: _replaced(item, words, numbers) for key, item in value.items()}
        case list() | tuple():
            return [_replaced(item, words, numbers) for item in value]
        case _:
            return value


def _flat(table: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Nested tables as dotted names; a dot inside a key counts as nesting."""
    found: dict[str, Any] = {}
    for key, value in table.items():
        name = f"{prefix}{key}"
        found |= _flat(value, f"{name}.") if isinstance(value, Mapping) else {name: value}
    return found


def _number(name: str, named: Mapping[str, Any]) -> float:
    """The value of a parameter; those that refer to others are followed, rings the core has refused."""
    sign, value = 1.0, named[name]
    while isinstance(value, str):
        if value.startswith("-"):
            sign, value = -sign, value[1:]
        value = named[value.removeprefix("$")]
    return sign * float(value)


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
