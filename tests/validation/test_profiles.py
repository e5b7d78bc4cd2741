"""Shipped profiles against points that somebody else published."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from lmap import toml

pytestmark = pytest.mark.needs_core

PROFILES = Path(__file__).parents[2] / "models" / "profiles"

Compare = Callable[..., None]
Point = list[float]
Points = list[Point]


def shipped(name: str) -> Points:
    path = PROFILES / f"{name}.csv"
    return points(path.read_text(encoding="utf-8"), path.name)


def points(text: str, name: str) -> Points:
    found: Points = json.loads(toml.core().read_profile(text, name))["points"]
    return found


def off(point: Point, line: Points) -> tuple[float, float, float]:
    """Distance of a point from a polyline, positive to its right, and the normal there."""
    nearest = min(range(len(line)), key=lambda i: math.dist(point, line[i]))
    found = []
    for i in range(max(nearest - 1, 0), min(nearest + 1, len(line) - 1)):
        (ay, az), (by, bz) = line[i], line[i + 1]
        length = math.hypot(by - ay, bz - az)
        if length > 0.0:
            ty, tz = (by - ay) / length, (bz - az) / length
            along = (point[0] - ay) * ty + (point[1] - az) * tz
            beyond = max(-along, along - length, 0.0)
            found.append((beyond, (point[1] - az) * ty - (point[0] - ay) * tz, -tz, ty))
    return min(found)[1:]


def test_uic60_inclined_1_in_40_is_the_manchester_rail(compare: Compare, fetched: Path) -> None:
    """Their rail is given inclined, with its highest point (a sampled one) at the origin, rounded to 1e-6 mm.

    How far that point is from the true top is fitted, as two shifts; the inclination is not.
    """
    file = fetched / "mbench_uic60_v3_canted40.csv"
    head = [p for p in points(file.read_text(encoding="utf-8"), file.name) if p[1] < 28.0]
    assert len(head) > 300
    sin, cos = math.sin(math.atan(1 / 40)), math.cos(math.atan(1 / 40))
    # the top of the inclined R300, centre (0, 300), lies within the arc
    top = [300.0 * sin, 300.0 * cos - 300.0]
    ours = [[y * cos + z * sin - top[0], z * cos - y * sin - top[1]] for y, z in shipped("uic60")]
    source = "Manchester benchmark"
    distances = [off(p, ours) for p in head]
    compare("UIC 60 1:40, largest distance (mm)", max(abs(d[0]) for d in distances), 0.0, 7e-3, source)
    normals = np.array([d[1:] for d in distances])
    shift = np.linalg.lstsq(normals, np.array([d[0] for d in distances]), rcond=None)[0]
    compare("  shift in y that takes it away (mm)", float(shift[0]), 0.0, 7e-3, source)
    compare("  shift in z that takes it away (mm)", float(shift[1]), 0.0, 1e-4, source)
    left = [off([p[0] - shift[0], p[1] - shift[1]], ours)[0] for p in head]
    # a chord of 0.1 mm on R13 is up to 1e-4 mm off its arc
    compare("  largest distance then (mm)", max(map(abs, left)), 0.0, 2e-4, source)
    compare("  rms distance then (mm)", math.sqrt(sum(d * d for d in left) / len(left)), 0.0, 5e-5, source)


def test_s1002_is_the_manchester_wheel(compare: Compare, fetched: Path) -> None:
    """Their wheel is given with the flange at positive y; here turned round in the file already."""
    file = fetched / "mbench_s1002_v3.csv"
    theirs = points(file.read_text(encoding="utf-8"), file.name)
    ours = shipped("s1002")
    tread = [abs(off(p, ours)[0]) for p in theirs if p[0] > -34.0]
    flange = [abs(off(p, ours)[0]) for p in theirs if -62.0 < p[0] <= -34.0]
    compare("S1002 tread, largest distance (mm)", max(tread), 0.0, 2e-4, "Manchester benchmark")
    # chords of 0.1 mm in y at 70 degrees on R12 are up to 9e-4 mm off the arc
    compare("S1002 flange, largest distance (mm)", max(flange), 0.0, 1.5e-3, "Manchester benchmark")
