"""Speed ranges and curves: what `[test]` may say, and what a run is stepped with."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import pytest
from pydantic import ValidationError

from lmap.procedures import curves, speed_range
from lmap.procedures.curves import Curve
from lmap.procedures.speed_range import Slow, stepped
from lmap.spec.case import Case

TIERS = [
    Slow(below_kmh=120.0, integrator={"kind": "rk4", "step": 0.0005}),
    Slow(below_kmh=30.0, integrator={"kind": "ros2", "step": 0.0005}),
    Slow(below_kmh=60.0, integrator={"kind": "rk4", "step": 0.00025}),
]


@pytest.mark.parametrize(
    ("kmh", "kind", "step"),
    [
        (126.5, "rk4", 0.001),
        (120.0, "rk4", 0.001),
        (69.0, "rk4", 0.0005),
        (46.0, "rk4", 0.00025),
        (23.0, "ros2", 0.0005),
    ],
)
def test_a_run_is_stepped_by_the_nearest_entry_above_its_speed(kmh: float, kind: str, step: float) -> None:
    case = Case("a", {"run": {"speed": kmh / 3.6 + 1e-9, "integrator": {"kind": "rk4", "step": 0.001}}})
    assert stepped(case, TIERS).data["run"]["integrator"] == {"kind": kind, "step": step}


@pytest.mark.parametrize(
    "written",
    [
        {"radius_m": 400.0},
        {"radius_m": 400.0, "unbalanced": 0.7, "speed_kmh": 80.0},
        {"radius_m": 0.0, "speed_kmh": 80.0},
        {"radius_m": 400.0, "cant_mm": -10.0, "speed_kmh": 80.0},
        {"radius": 400.0, "speed_kmh": 80.0},
    ],
)
def test_a_curve_has_a_radius_and_one_speed(written: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        Curve.model_validate(written)


def test_a_curve_to_the_left_is_as_fast_and_canted_the_other_way() -> None:
    right, left = (Curve(radius_m=r, cant_mm=100.0, unbalanced=0.72) for r in (400.0, -400.0))
    assert right.speed(9.81) == left.speed(9.81)
    own = curves.Settings(curves=[left], straight_m=10.0, transition_m=20.0, curve_m=30.0, exit_m=5.0)
    layout, length = curves._layout(own, left)
    assert (layout[2]["radius"], layout[2]["cant_mm"], length) == (-400.0, -100.0, 85.0)


def test_more_cant_than_any_speed_asks_for_has_no_speed() -> None:
    assert math.isnan(Curve(radius_m=400.0, cant_mm=100.0, unbalanced=-0.7).speed(9.81))


@pytest.mark.parametrize("procedure", [speed_range, curves])
def test_derived_columns_are_those_of_wheels_axles_and_bodies(procedure: Any) -> None:
    channels = {"ws1.left.Q": "N", "ws1.right.Q": "N", "ws1.sum_Y": "N", "bogie1.theta": "rad"}
    assert set(procedure.derived(SimpleNamespace(test={}), channels)) == {
        "ws1.prudhomme",
        *(f"ws1.{side}.{part}" for side in ("left", "right") for part in ("unloading", "nadal")),
        *(f"bogie1.{side}.{part}" for side in ("left", "right") for part in ("unloading", "LV")),
    }
