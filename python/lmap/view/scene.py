"""What the page draws, as plain data: pieces of bodies, connections with what hovering says, rails, outline."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from lmap.view.checks import Finding
from lmap.view.model import Connection, Model, Point
from lmap.view.shapes import Box, Solid, outside, shapes

RAIL_WIDTH, RAIL_HEAD, RAIL_HEIGHT, RAIL_FOOT, RAIL_WEB = 0.072, 0.045, 0.172, 0.15, 0.018
"""m; a 60 kg/m rail, drawn of three boxes."""

OVERHANG = 0.5
"""m of rail beyond the vehicle at either end: less than what the page shows, or they have no ends to be seen."""

_UNITS = {
    "stiffness": ("N/m", "N m/rad"),
    "damping": ("N s/m", "N m s/rad"),
    "axial": ("N/m", ""),
    "shear": ("N/m", ""),
    "bending": ("N m/rad", ""),
    "clearance": ("m", ""),
    "preload": ("N", "N m"),
}
"""Unit by key: of the first three numbers, and of the last three where there are six."""


def scene(
    model: Model, gauge: float | None, found: Sequence[Finding], motions: Sequence[Mapping[str, Any]] = ()
) -> dict[str, Any]:
    """Everything that the page needs. Lengths in m, angles in rad, vehicle axes (x forward, y right, z down)."""
    solids = shapes(model)
    drawn = {name: [shape.solid() for shape in pieces] for name, pieces in solids.items()}
    groups = {connection.name: _group(connection, model) for connection in model.connections}
    ends = _extent(model, drawn)
    heaviest = max(
        (body for body in model.bodies if body.radius is None), key=lambda body: body.mass, default=None
    )
    return {
        "name": model.name,
        "title": model.title,
        "condition": model.condition or "",
        "hash": model.hash,
        "extent": ends,
        "bodies": [
            {
                "name": body.name,
                "at": _round(body.position),
                "kind": "wheelset" if body.radius is not None else "body",
                "glass": body is heaviest,
                "hover": _hover(body.name, _body_lines(body.mass, body.inertia, body.position, body.radius)),
                "pieces": [_piece(solid) for solid in drawn[body.name]],
            }
            for body in model.bodies
        ],
        "groups": list(dict.fromkeys(groups.values())),
        "connections": [
            {
                "name": connection.name,
                "kind": connection.kind,
                "group": groups[connection.name],
                "between": list(connection.between),
                "points": [_round(point) for point in connection.points],
                "feet": [
                    _round(outside(solids[body], point)[1])
                    for body, point in zip(connection.between, connection.points, strict=True)
                ],
                "values": values_text(connection),
                "hover": _hover(connection.name, _connection_lines(connection)),
            }
            for connection in model.connections
        ],
        "sensors": [
            {
                "name": sensor.name,
                "body": sensor.body,
                "at": _round(sensor.position),
                "hover": _hover(sensor.name, [f"sensor on {sensor.body}", _at(sensor.position)]),
            }
            for sensor in model.sensors
        ],
        "outline": _outline(model.outline),
        "rails": [_piece(box.solid()) for box in _rails(gauge, ends)],
        "gauge": gauge,
        "findings": [
            {"kind": one.kind, "message": one.message, "limit": one.limit, "at": _round(one.at)}
            for one in found
        ],
        "motions": list(motions),
    }


def values_text(connection: Connection) -> str:
    """The law's values in one line."""
    return "; ".join(_value_lines(connection))


def _connection_lines(connection: Connection) -> list[str]:
    a, b = connection.points
    lines = [
        f"{connection.kind}: {connection.between[0]} to {connection.between[1]}",
        *_value_lines(connection),
    ]
    if connection.carries_weight:
        lines.append("carries weight")
    if connection.mirrored:
        lines.append("mirrored: values as on the right side")
    return (
        [*lines, _at(a)]
        if a == b
        else [*lines, f"from {_at(a)}", f"to {_at(b)}, length {math.dist(a, b):.3f} m"]
    )


def _value_lines(connection: Connection) -> list[str]:
    return [f"{key.replace('_', ' ')} {_shown(key, value)}" for key, value in connection.values.items()]


def _shown(key: str, value: Any) -> str:
    first, last = _UNITS.get(key, ("", ""))
    if _numbers(value):
        head, tail = list(value)[:3], list(value)[3:]
        text = f"{' / '.join(f'{number:g}' for number in head)} {first}".rstrip()
        return f"{text}, {' / '.join(f'{number:g}' for number in tail)} {last}".rstrip() if tail else text
    if isinstance(value, int | float) and not isinstance(value, bool):
        return f"{value:g} {first}".rstrip()
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {_shown(name, item)}" for name, item in value.items())
    if isinstance(value, list | tuple):
        return f"table of {len(value)}" if len(value) > 6 else ", ".join(_shown("", item) for item in value)
    return str(value)


def _numbers(value: Any) -> bool:
    return (
        isinstance(value, list | tuple)
        and 0 < len(value) <= 6
        and all(isinstance(item, int | float) and not isinstance(item, bool) for item in value)
    )


def _body_lines(mass: float, inertia: Point, position: Point, radius: float | None) -> list[str]:
    lines = [
        f"mass {mass:g} kg",
        f"inertia {' / '.join(f'{value:g}' for value in inertia)} kg m2",
        f"centre of mass {_at(position)}",
    ]
    return lines if radius is None else [*lines, f"wheel radius {radius:g} m"]


def _at(point: Point) -> str:
    return "x {:.3f}, y {:.3f}, z {:.3f} m".format(*(value + 0.0 for value in point))


def _hover(name: str, lines: Sequence[str]) -> list[str]:
    return [name, *lines]


def _group(connection: Connection, model: Model) -> str:
    """The words of a connection's name without those that say which one: `yaw_damper` of `yaw_damper_bogie1_left`."""
    which = {body.name for body in model.bodies} | {"left", "right", "front", "rear", "lead", "trail"}
    words = [word for word in connection.name.split("_") if word not in which and not word.isdigit()]
    return " ".join(words) or connection.kind.replace("_", " ")


def _extent(model: Model, drawn: Mapping[str, Sequence[Solid]]) -> list[list[float]]:
    """Least and largest x, y, z of what is drawn of the vehicle."""
    points = [vertex for solids in drawn.values() for solid in solids for vertex in solid.vertices]
    points += [point for connection in model.connections for point in connection.points]
    points += [sensor.position for sensor in model.sensors]
    if model.outline is not None:
        half = float(model.outline["length_over_couplers"]) / 2
        width = float(model.outline["width"]) / 2
        points += [(-half, -width, 0.0), (half, width, -float(model.outline["height"]))]
    least = [min(point[i] for point in points) for i in range(3)]
    most = [max(point[i] for point in points) for i in range(3)]
    return [[round(value, 4) for value in least], [round(value, 4) for value in most]]


def _outline(outline: Mapping[str, Any] | None) -> dict[str, Any] | None:
    """Lines: the envelope over couplers, width and height; the section where one is given; the coupler faces."""
    if outline is None:
        return None
    half = float(outline["length_over_couplers"]) / 2
    width, height = float(outline["width"]) / 2, float(outline["height"])
    coupler = -float(outline["coupler_height"])
    section = [(float(y), float(z)) for y, z in outline.get("section", ())]
    if section:
        ring = [*section, *((-y, z) for y, z in reversed(section))]
        ring.append(ring[0])
        lines = [[(x, y, z) for y, z in ring] for x in (-half, half)]
        lines += [[(-half, y, z), (half, y, z)] for y, z in ring[:-1]]
    else:
        box = Box((0.0, 0.0, -height / 2), (2 * half, 2 * width, height)).solid()
        lines = [[box.vertices[a], box.vertices[b]] for a, b in box.edges]
    text = [
        f"length over couplers {2 * half:g} m",
        f"width {2 * width:g} m, height {height:g} m",
        f"coupler height {-coupler:g} m",
    ]
    return {
        "lines": [[_round(point) for point in line] for line in lines],
        "couplers": [_round((x, 0.0, coupler)) for x in (-half, half)],
        "hover": _hover("outline", text),
    }


def _rails(gauge: float | None, extent: Sequence[Sequence[float]]) -> list[Box]:
    if gauge is None:
        return []
    first, last = extent[0][0] - OVERHANG, extent[1][0] + OVERHANG
    x, length = (first + last) / 2, last - first
    boxes = []
    for side in (-1.0, 1.0):
        y = side * (gauge / 2 + RAIL_WIDTH / 2)
        foot = 0.02
        web = RAIL_HEIGHT - RAIL_HEAD - foot
        boxes.append(Box((x, y, RAIL_HEAD / 2), (length, RAIL_WIDTH, RAIL_HEAD)))
        boxes.append(Box((x, y, RAIL_HEAD + web / 2), (length, RAIL_WEB, web)))
        boxes.append(Box((x, y, RAIL_HEIGHT - foot / 2), (length, RAIL_FOOT, foot)))
    return boxes


def _piece(solid: Solid) -> dict[str, Any]:
    return {
        "vertices": [_round(vertex) for vertex in solid.vertices],
        "faces": [list(face) for face in solid.faces],
        "edges": [list(edge) for edge in solid.edges],
    }


def _round(point: Sequence[float]) -> list[float]:
    """To 0.1 mm, for the page alone."""
    return [round(value, 4) + 0.0 for value in point]
