"""Angles of the couplers between equal vehicles against the chords of a curve, in both planes, through the core."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import pytest

from lmap.analyse import vehicle_case
from lmap.formulas import coupler_angle
from lmap.simulate import simulate
from lmap.vehicle import Vehicle

if TYPE_CHECKING:
    import polars as pl

pytestmark = [pytest.mark.needs_core, pytest.mark.slow]

Compare = Callable[..., None]
LENGTH, PIVOTS, SHANK = 22.0, 13.2, 0.8
"""Over couplers, between bogie centres, from a coupler's pivot to its pulling face, m: coco134."""
BELOW = 1.95 - 0.90
"""Couplers under the car body's centre of mass, m."""
ENDS = {"front": 1.0, "rear": -1.0}


def passed(layout: list[dict[str, Any]]) -> pl.DataFrame:
    """coco134 between equal neighbours, slowly until all three are on the layout's third part."""
    vehicle = Vehicle.load("coco134")
    run = {
        "kind": "time",
        "speed": 4.0,
        "friction": 0.4,
        "integrator": {"kind": "ros2", "step": 0.001},
        "output_step": 0.05,
        "couplers": {"shank": SHANK},
    }
    track = {"length": 80.0, "layout": layout}
    return simulate(
        vehicle_case(vehicle.data, vehicle.document.path, run, label="between neighbours", track=track)
    )


def stands(frame: pl.DataFrame, name: str) -> float:
    """Mean over the last second."""
    return float(frame[name][-20:].mean())  # type: ignore[arg-type]


def moved(frame: pl.DataFrame, part: str) -> float:
    """Where the car body stands against where it stood on straight level track."""
    return stands(frame, f"carbody.{part}") - float(frame[f"carbody.{part}"][0])


@pytest.mark.parametrize("radius", [300.0, -300.0])
def test_in_a_full_curve_it_is_half_the_turn_between_the_chords(radius: float, compare: Compare) -> None:
    frame = passed(
        [
            {"kind": "tangent", "length": 15.0},
            {"kind": "clothoid", "length": 20.0},
            {"kind": "curve", "length": 80.0, "radius": radius},
        ]
    )
    y, phi, psi = (moved(frame, part) for part in ("y", "phi", "psi"))
    for end, way in ENDS.items():
        # L/2R is for a body on its chord; this one stands beside it, the neighbour's pivot is two shanks away.
        aside = y - BELOW * phi - PIVOTS**2 / (8 * radius) + way * (LENGTH / 2 - SHANK) * psi
        closed = coupler_angle(LENGTH, radius) - aside / (2 * SHANK) - way * psi
        ours = stands(frame, f"coupler.{end}.yaw")
        what = (
            f"R {radius:g} m, {end}, degrees; on its chord {math.degrees(coupler_angle(LENGTH, radius)):.3f}"
        )
        compare(what, math.degrees(ours), math.degrees(closed), 0.01, "L/2R, body where it stands")


@pytest.mark.parametrize("gradient", [0.15, -0.15])
def test_over_a_round_hump_and_through_a_dip_too(gradient: float, compare: Compare) -> None:
    frame = passed(
        [
            {"kind": "tangent", "length": 15.0},
            {"kind": "clothoid", "length": 100.0},
            {"kind": "tangent", "length": 50.0, "gradient": gradient},
        ]
    )
    radius = 100.0 / math.atan(gradient)  # + a dip, with its centre above
    z, theta = (moved(frame, part) for part in ("z", "theta"))
    for end, way in ENDS.items():
        low = z + PIVOTS**2 / (8 * radius) - way * (LENGTH / 2 - SHANK) * theta
        closed = coupler_angle(LENGTH, radius) + low / (2 * SHANK) - way * theta
        ours = stands(frame, f"coupler.{end}.pitch")
        what = f"R {radius:.0f} m, {end}, degrees; on its chord {math.degrees(coupler_angle(LENGTH, radius)):.3f}"
        compare(what, math.degrees(ours), math.degrees(closed), 0.01, "L/2R, body where it stands")
        assert abs(float(frame[f"coupler.{end}.yaw"].abs().max())) < 1e-6  # type: ignore[arg-type]
        assert abs(float(frame["coupler.rear.pitch"][0])) < 1e-6
