"""Outlines: cross-sections as polygons, a body displaced within a reference outline, and the least clearance.

Lengths in m, y to the right and z down, seen from behind; a section and an outline are given by the points of their
right half, from the bottom up, and are mirrored.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Points = npt.NDArray[np.float64]
"""One row a point: y, z."""


class Clearance(NamedTuple):
    """How far a body stays inside an outline."""

    distance: float
    """m; negative where it infringes."""
    body: tuple[float, float]
    """The body's nearest point."""
    outline: tuple[float, float]
    """The outline's nearest point."""


def closed(half: Sequence[Sequence[float]]) -> Points:
    """The whole polygon of a right half, points from the bottom up."""
    right = np.asarray(half, dtype=np.float64)
    left = right[::-1] * np.array([-1.0, 1.0])
    return np.concatenate((right, left))


def displaced(section: Points, *, y: float, z: float, roll: float, centre: float) -> Points:
    """A section whose body has moved by `y` (right) and `z` (down) and rolled about its `centre`, right side down."""
    arm = section[:, 1] - centre
    sine, cosine = math.sin(roll), math.cos(roll)
    return np.column_stack(
        (y + section[:, 0] * cosine - arm * sine, z + centre + section[:, 0] * sine + arm * cosine)
    )


def clearance(body: Points, outline: Points) -> Clearance:
    """Least distance between the boundaries of a body and of the outline around it; negative with a corner outside."""
    found = [_nearest(point, outline, outer=True) for point in body] + [
        _swapped(_nearest(point, body, outer=False)) for point in outline
    ]
    return min(found, key=lambda one: one.distance)


def _swapped(found: Clearance) -> Clearance:
    return Clearance(found.distance, found.outline, found.body)


def _nearest(point: Points, polygon: Points, *, outer: bool) -> Clearance:
    """From a point to a polygon's boundary; counted positive inside where the polygon is the `outer` one."""
    begin, along = polygon, np.roll(polygon, -1, axis=0) - polygon
    squares = np.maximum((along**2).sum(axis=1), 1e-30)
    share = np.clip((((point - begin) * along).sum(axis=1)) / squares, 0.0, 1.0)
    feet = begin + share[:, None] * along
    distances = np.hypot(*(point - feet).T)
    best = int(np.argmin(distances))
    right_side = _inside(point, polygon) == outer
    at = (float(point[0]), float(point[1]))
    return Clearance(
        float(distances[best]) * (1.0 if right_side else -1.0),
        at,
        (float(feet[best, 0]), float(feet[best, 1])),
    )


def _inside(point: Points, polygon: Points) -> bool:
    """Whether a ray to the right crosses the boundary an odd number of times."""
    here, after = polygon, np.roll(polygon, -1, axis=0)
    crosses = (here[:, 1] > point[1]) != (after[:, 1] > point[1])
    if not crosses.any():
        return False
    a, b = here[crosses], after[crosses]
    y = a[:, 0] + (point[1] - a[:, 1]) * (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
    return bool(np.count_nonzero(y > point[0]) % 2)
