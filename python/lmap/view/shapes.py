"""Bodies as boxes and cylinders: corners and faces to draw, and how far a point is outside.

A body without a declared shape is the box of even density that has its mass and inertia.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from lmap.view.model import Body, Model, Point

THINNEST = 0.1
"""m; edges of boxes are drawn no shorter: inertia that a plate or a point has gives none."""

AXLE_RADIUS = 0.09
"""m; drawn."""
JOURNAL = 0.22
"""m from tape circle to the end of the axle as drawn; axle boxes sit beyond it, where they can be seen."""
WHEEL_INSIDE, WHEEL_OUTSIDE = 0.07, 0.065
"""m from the tape circle to the wheel's back and front: 135 mm wide, 1360 mm between backs."""
FLANGE_HEIGHT, FLANGE_WIDTH = 0.028, 0.032
"""m; drawn."""

_SIDES = 28


@dataclass(frozen=True, slots=True)
class Solid:
    """One piece of a body, in vehicle axes."""

    vertices: tuple[Point, ...]
    faces: tuple[tuple[int, int, int], ...]
    edges: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class Box:
    """Along the axes of the vehicle."""

    centre: Point
    size: Point

    def nearest(self, point: Point) -> Point:
        """The point of the box that is nearest; the point itself if inside."""
        x, y, z = (
            min(max(value, middle - length / 2), middle + length / 2)
            for value, middle, length in zip(point, self.centre, self.size, strict=True)
        )
        return (x, y, z)

    def solid(self) -> Solid:
        """Its corners, twelve triangles and edges."""
        signs = [(i, j, k) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]
        (cx, cy, cz), (lx, ly, lz) = self.centre, self.size
        corners = tuple((cx + i * lx / 2, cy + j * ly / 2, cz + k * lz / 2) for i, j, k in signs)
        sides = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
        faces = tuple(face for a, b, c, d in sides for face in ((a, b, c), (a, c, d)))
        edges = tuple((a, b) for a in range(8) for b in range(a + 1, 8) if (a ^ b).bit_count() == 1)
        return Solid(corners, faces, edges)


@dataclass(frozen=True, slots=True)
class Cylinder:
    """About a line along x, y or z."""

    centre: Point
    axis: int
    radius: float
    length: float

    def nearest(self, point: Point) -> Point:
        """The point of the cylinder that is nearest; the point itself if inside."""
        across = [i for i in range(3) if i != self.axis]
        offset = [point[i] - self.centre[i] for i in across]
        away = math.hypot(*offset)
        scale = min(1.0, self.radius / away) if away > 0.0 else 1.0
        result = list(point)
        half = self.length / 2
        along = point[self.axis] - self.centre[self.axis]
        result[self.axis] = self.centre[self.axis] + min(max(along, -half), half)
        for i, by in zip(across, offset, strict=True):
            result[i] = self.centre[i] + scale * by
        return (result[0], result[1], result[2])

    def solid(self) -> Solid:
        """A prism of many sides."""
        across = [i for i in range(3) if i != self.axis]
        vertices: list[Point] = []
        for end in (-0.5, 0.5):
            for side in range(_SIDES):
                point = list(self.centre)
                angle = 2.0 * math.pi * side / _SIDES
                point[self.axis] += end * self.length
                point[across[0]] += self.radius * math.cos(angle)
                point[across[1]] += self.radius * math.sin(angle)
                vertices.append((point[0], point[1], point[2]))
        n = _SIDES
        ring = [(i, (i + 1) % n) for i in range(n)]
        faces = [(a, b, n + a) for a, b in ring] + [(b, n + b, n + a) for a, b in ring]
        faces += [(0, a, a + 1) for a in range(1, n - 1)]
        faces += [(n, n + a + 1, n + a) for a in range(1, n - 1)]
        edges = [*ring, *((n + a, n + b) for a, b in ring)]
        return Solid(tuple(vertices), tuple(faces), tuple(edges))


@dataclass(frozen=True, slots=True)
class Line:
    """Through points."""

    points: tuple[Point, ...]

    def nearest(self, point: Point) -> Point:
        """The point of the line that is nearest."""
        pairs = zip(self.points, self.points[1:], strict=False)
        return min((_on_segment(point, a, b) for a, b in pairs), key=lambda near: math.dist(near, point))

    def solid(self) -> Solid:
        """Edges alone."""
        return Solid(self.points, (), tuple((i, i + 1) for i in range(len(self.points) - 1)))


Shape = Box | Cylinder | Line


def shapes(model: Model) -> dict[str, tuple[Shape, ...]]:
    """The shapes of every body by name: declared ones, else wheels with their axle, else the box of its inertia."""
    declared: dict[str, list[Shape]] = {body.name: [] for body in model.bodies}
    for table in model.shapes:
        declared[table["body"]].append(_declared(table))
    result: dict[str, tuple[Shape, ...]] = {}
    for body in model.bodies:
        if declared[body.name]:
            result[body.name] = tuple(declared[body.name])
        elif body.radius is not None:
            result[body.name] = _wheelset(body)
        else:
            result[body.name] = (Box(body.position, box_of_inertia(body)),)
    for table in model.equipment:
        size = _point(table.get("size", (0.0, 0.0, 0.0)))
        if all(length > 0.0 for length in size):
            result[table["body"]] += (Box(_point(table["position"]), size),)
    return result


def box_of_inertia(body: Body) -> Point:
    """Length, width and height of the box of even density with this mass and inertia, m.

    Ixx = m (b2 + h2) / 12 and so on, solved for the edges; where no rigid body has such inertia, or a plate has it,
    the edge is `THINNEST`.
    """
    xx, yy, zz = body.inertia

    def edge(two: float) -> float:
        return max(math.sqrt(max(6.0 * two / body.mass, 0.0)), THINNEST)

    return (edge(yy + zz - xx), edge(xx + zz - yy), edge(xx + yy - zz))


def outside(shapes: Sequence[Shape], point: Point) -> tuple[float, Point]:
    """How far a point is outside all of the shapes, m (0 inside), and the nearest point of them."""
    near = min((shape.nearest(point) for shape in shapes), key=lambda near: math.dist(near, point))
    return math.dist(near, point), near


def _wheelset(body: Body) -> tuple[Shape, ...]:
    assert body.radius is not None
    x, y, z = body.position
    tape, radius = body.tape_half_distance, body.radius
    pieces: list[Shape] = [
        Cylinder((x, y, z), 1, min(AXLE_RADIUS, radius / 3), 2.0 * (tape + JOURNAL)),
    ]
    for side in (-1.0, 1.0):
        middle = y + side * (tape + (WHEEL_OUTSIDE - WHEEL_INSIDE) / 2)
        back = y + side * (tape - WHEEL_INSIDE + FLANGE_WIDTH / 2)
        pieces.append(Cylinder((x, middle, z), 1, radius, WHEEL_INSIDE + WHEEL_OUTSIDE))
        pieces.append(Cylinder((x, back, z), 1, radius + FLANGE_HEIGHT, FLANGE_WIDTH))
    return tuple(pieces)


def _declared(table: Mapping[str, Any]) -> Shape:
    match table["kind"]:
        case "box":
            return Box(_point(table["position"]), _point(table["size"]))
        case "cylinder":
            axis = "xyz".index(table["axis"])
            return Cylinder(_point(table["position"]), axis, float(table["radius"]), float(table["length"]))
        case _:
            return Line(tuple(_point(point) for point in table["points"]))


def _point(written: Sequence[float]) -> Point:
    return (float(written[0]), float(written[1]), float(written[2]))


def _on_segment(point: Point, a: Point, b: Point) -> Point:
    along = [q - p for p, q in zip(a, b, strict=True)]
    square = sum(d * d for d in along)
    part = 0.0
    if square > 0.0:
        part = sum((p - q) * d for p, q, d in zip(point, a, along, strict=True)) / square
    part = min(max(part, 0.0), 1.0)
    return (a[0] + part * along[0], a[1] + part * along[1], a[2] + part * along[2])
