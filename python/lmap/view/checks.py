"""What can be said of the drawing without a person: symmetry, attachment points, wheels on the rails.

Each check measures in metres; a finding is what exceeds its limit. The spec of test 1.2 has limits of its own and
judges the same measures.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from lmap.view.model import Body, Connection, Model, Point
from lmap.view.shapes import outside, shapes

ASYMMETRY = 0.001
"""m; an element to the mirror image of its partner on the other side."""
OUTSIDE = 0.75
"""m; an attachment point to its body, which is drawn as a box: brackets of low traction rods reach 0.6 m below it."""
OFF_RAIL = 0.001
"""m; a tape circle to the rail head under it."""

HEAD_WIDTH = 0.072
"""m; head of the common 60 kg/m rails: 70 mm (AS60), 72 mm (60E1)."""

UNITS = {"asymmetry": "m", "outside": "m", "off_rail": "m"}
"""Unit by kind of measure: the last part of its name."""

LIMITS = {"asymmetry": ASYMMETRY, "outside": OUTSIDE, "off_rail": OFF_RAIL}


@dataclass(frozen=True, slots=True, kw_only=True)
class Measure:
    """One thing measured."""

    kind: str
    """`asymmetry`, `outside` or `off_rail`."""
    element: str
    """What it is measured on, e.g. `yaw_damper_bogie1_left`."""
    value: float
    """m; nought is right."""
    message: str
    at: Point
    """Where it is, for the drawing."""

    @property
    def name(self) -> str:
        """As a signal of the spec: `<element>.<kind>`."""
        return f"{self.element}.{self.kind}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """A measure beyond its limit."""

    kind: str
    element: str
    value: float
    limit: float
    message: str
    at: Point


def measures(model: Model, gauge: float | None) -> list[Measure]:
    """Everything measured; `gauge` in m, without which the wheels' place on the rails is left out."""
    found = [*_asymmetry(model), *_outside(model)]
    return found if gauge is None else [*found, *_off_rail(model, gauge)]


def findings(model: Model, gauge: float | None) -> list[Finding]:
    """Measures beyond their limits, the worst of each kind first."""
    found = [
        Finding(
            kind=one.kind,
            element=one.element,
            value=one.value,
            limit=LIMITS[one.kind],
            message=one.message,
            at=one.at,
        )
        for one in measures(model, gauge)
        if one.value > LIMITS[one.kind]
    ]
    return sorted(found, key=lambda one: (list(LIMITS).index(one.kind), -one.value))


def _asymmetry(model: Model) -> list[Measure]:
    """Left against right: each body's and connection's mirror image should meet an element of its kind."""
    found = []
    partner: dict[str, Body] = {}
    for body in model.bodies:
        image = _mirror(body.position)
        alike = [other for other in model.bodies if _alike(body, other)]
        nearest = min(alike, key=lambda other: math.dist(other.position, image))
        partner[body.name] = nearest
        away = math.dist(nearest.position, image)
        found.append(_asymmetric(body.name, body.position, away, nearest.name))
    for connection in model.connections:
        images = [_mirror(point) for point in connection.points]
        ends = [partner[name].name for name in connection.between]
        candidates = [
            (max(math.dist(a, b) for a, b in zip(images, points, strict=True)), other.name)
            for other in model.connections
            for points in _ends(other, connection.kind, ends)
        ]
        # its own image stands in where nothing else is of its kind between these bodies
        own = max(math.dist(a, b) for a, b in zip(images, connection.points, strict=True))
        away, name = min(candidates, default=(own, connection.name))
        found.append(_asymmetric(connection.name, connection.points[0], away, name))
    return found


def _alike(body: Body, other: Body) -> bool:
    """Whether one can be the mirror image of the other: wheelsets of wheelsets, bodies of bodies of their mass."""
    if (body.radius is None) != (other.radius is None):
        return False
    return body.name == other.name or math.isclose(body.mass, other.mass, rel_tol=1e-6)


def _ends(other: Connection, kind: str, bodies: list[str]) -> list[tuple[Point, Point]]:
    """The ends of a connection in the order of these bodies; nothing if it is another kind or between others."""
    if other.kind != kind:
        return []
    if list(other.between) == bodies:
        return [other.points]
    if list(other.between) == bodies[::-1]:
        return [(other.points[1], other.points[0])]
    return []


def _asymmetric(name: str, at: Point, away: float, partner: str) -> Measure:
    what = "its own mirror image" if partner == name else f"the mirror image of {partner}"
    message = f"{name} is {_length(away)} from {what}"
    return Measure(kind="asymmetry", element=name, value=away, message=message, at=at)


def _outside(model: Model) -> list[Measure]:
    """Attachment points of connections, and sensors, against the bodies that they are on."""
    solids = shapes(model)
    found = []
    ends = [
        (connection.name, body, point)
        for connection in model.connections
        for body, point in zip(connection.between, connection.points, strict=True)
    ]
    sensors = [(sensor.name, sensor.body, sensor.position) for sensor in model.sensors]
    for name, body, point in [*ends, *sensors]:
        away, _ = outside(solids[body], point)
        element = name if name.startswith(f"{body}.") else f"{name}.{body}"
        message = f"{name} is attached {_length(away)} outside {body}"
        found.append(Measure(kind="outside", element=element, value=away, message=message, at=point))
    return found


def _off_rail(model: Model, gauge: float) -> list[Measure]:
    """Tape circles against the rail heads: lateral distance from the head, height over its top."""
    found = []
    inner, outer = gauge / 2, gauge / 2 + HEAD_WIDTH
    for body in model.wheelsets:
        assert body.radius is not None
        x, y, z = body.position
        for side, sign in (("left", -1.0), ("right", 1.0)):
            across = y + sign * body.tape_half_distance
            beside = max(inner - sign * across, sign * across - outer, 0.0)
            above = abs(z + body.radius)
            away = math.hypot(beside, above)
            message = f"the {side} tape circle of {body.name} is {_length(away)} off its rail head"
            at = (x, across, z + body.radius)
            name = f"{body.name}.{side}"
            found.append(Measure(kind="off_rail", element=name, value=away, message=message, at=at))
    return found


def _mirror(point: Point) -> Point:
    return (point[0], -point[1], point[2])


def _length(value: float) -> str:
    return f"{value * 1e3:.1f} mm" if value < 0.1 else f"{value:.3f} m"
