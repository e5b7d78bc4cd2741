"""The couplers of a run as drawn, from angles made by hand."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import polars as pl
import pytest

import lmap
from lmap.procedures import couplers
from lmap.spec.model import Spec
from lmap.toml import loads
from lmap.verdict import Drawing

pytestmark = pytest.mark.needs_core
ROOT = Path(__file__).parents[2]
LENGTH, SHANK = 22.0, 0.8
"""Of coco134, and of the spec."""


def drawn(written: dict[str, Any], **angles: float) -> list[Drawing]:
    """In a place where the angles are these, rad, and nowhere else but a vehicle's length on."""
    text = (ROOT / "specs" / "small_curve.toml").read_text(encoding="utf-8")
    spec = Spec.model_validate(loads(text) | {"run": written})
    names = [f"coupler.{end}.{plane}" for end in ("front", "rear") for plane in ("yaw", "pitch")]
    columns = {name: [0.0, angles.get(name.split(".", 1)[1].replace(".", "_"), 0.0)] for name in names}
    later = {name: [*values, 0.9 * values[1]] for name, values in columns.items()}
    frame = pl.DataFrame({"s": [0.0, 50.0, 50.0 + LENGTH], **later})
    return couplers.drawings(spec, {"run": frame}, lmap.Vehicle.load("coco134", beside=ROOT).data)


def turn(drawing: Drawing, name: str) -> float:
    """Of a line against the vehicle's, rad."""
    curve = {curve.name: curve for curve in drawing.curves}[name]
    return math.atan2(curve.y[1] - curve.y[0], abs(curve.x[1] - curve.x[0]))


def test_the_neighbour_is_turned_by_both_angles() -> None:
    [drawing] = drawn({"speed": 1.0, "couplers": {"shank": SHANK}}, front_yaw=0.07, rear_yaw=0.05)
    assert turn(drawing, "coupler") == pytest.approx(0.07)
    # The neighbour's rear coupler has what this vehicle's has a length further on.
    assert turn(drawing, "neighbour, between its pivots") == pytest.approx(0.07 + 0.9 * 0.05)
    ends = {curve.name: curve for curve in drawing.curves}
    assert ends["coupler"].x == pytest.approx([0.0, 2 * SHANK * math.cos(0.07)])
    assert ends["vehicle, between its pivots"].x == pytest.approx([-(LENGTH - 2 * SHANK), 0.0])
    assert drawing.y_down
    assert "coupler.front.yaw is largest: 4.01 degrees" in drawing.caption


def test_from_the_side_and_backwards_where_that_is_worst() -> None:
    [drawing] = drawn({"speed": 1.0, "couplers": {"shank": SHANK}}, rear_pitch=-0.06)
    coupler = next(curve for curve in drawing.curves if curve.name == "coupler")
    assert coupler.x[1] < 0.0
    assert coupler.y[1] < 0.0
    assert not drawing.y_down


def test_what_is_not_known_is_not_drawn() -> None:
    [drawing] = drawn({"speed": 1.0, "couplers": {"shank": SHANK, "neighbour_length": 15.0}}, front_yaw=0.07)
    assert [curve.name for curve in drawing.curves] == ["vehicle, between its pivots", "coupler"]
    assert drawn({"speed": 1.0}) == []
