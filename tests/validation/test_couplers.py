"""Angles of the coupler between two equal vehicles against the chords of a curve."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import polars as pl
import pytest

from lmap.errors import InputProblem
from lmap.formulas import coupler_angle
from lmap.procedures.couplers import UNITS, Body, Line, with_angles

Compare = Callable[..., None]
BODY = Body(name="carbody", length=22.0, pivot=10.2, centre=0.0, below=1.05)


def standing(places: list[float], layout: list[dict[str, object]]) -> pl.DataFrame:
    """A body whose middle keeps to the track, as bogies 6.6 m from it make it do in a full curve."""
    s = np.array(places)
    none = np.zeros_like(s)
    poses = {f"carbody.{part}": none for part in ("y", "phi", "theta", "psi")}
    frame = pl.DataFrame({"s": s, **poses, "carbody.z": none - 1.95})
    return with_angles(frame, BODY, Line(layout, max(places)))


@pytest.mark.parametrize("radius", [160.0, -160.0, 800.0])
def test_in_a_full_curve_it_is_half_the_turn_between_the_chords(radius: float, compare: Compare) -> None:
    frame = standing([60.0, 70.0, 80.0], [{"kind": "curve", "radius": radius, "length": 100.0}])
    expected = math.degrees(coupler_angle(BODY.length, radius))
    for which, sign in (("front", 1.0), ("rear", 1.0)):
        ours = math.degrees(frame[f"coupler.{which}.yaw"][1])
        compare(f"R {radius:g} m, {which}, degrees", ours, sign * expected, 0.005 * abs(expected), "L/2R")
    assert frame["coupler.front.pitch"].abs().max() < 1e-9


def test_over_a_round_hump_and_through_a_dip_too(compare: Compare) -> None:
    for gradient, way in ((-0.2, 1.0), (0.2, -1.0)):
        layout = [
            {"kind": "tangent", "length": 20.0},
            {"kind": "clothoid", "length": 100.0},
            {"kind": "tangent", "length": 50.0, "gradient": gradient},
        ]
        radius = 100.0 / math.atan(0.2)
        frame = standing([70.0, 80.0, 90.0], layout)
        expected = way * math.degrees(BODY.length / (2.0 * radius))
        for which in ("front", "rear"):
            ours = math.degrees(frame[f"coupler.{which}.pitch"][1])
            compare(f"gradient {gradient:g}, {which}, degrees", ours, expected, 0.01, "L/2R")


def test_on_straight_track_there_is_none_whatever_its_gradient() -> None:
    frame = standing([30.0, 40.0], [{"kind": "tangent", "length": 100.0, "gradient": 0.03}])
    assert all(frame[name].abs().max() < 1e-9 for name in UNITS)


def test_a_vehicle_that_stands_askew_turns_its_coupler() -> None:
    s = np.array([0.0, 100.0])
    poses = {f"carbody.{part}": np.zeros(2) for part in ("y", "phi", "theta")}
    frame = pl.DataFrame({"s": s, **poses, "carbody.z": [-1.95] * 2, "carbody.psi": [0.01] * 2})
    found = with_angles(frame, BODY, Line([{"kind": "tangent", "length": 100.0}], 100.0))
    # both pivots are 10.2 m from their middle, and to either side: the coupler lies across
    across = 2.0 * 10.2 * math.sin(0.01)
    along = 22.0 - 2.0 * 10.2 * math.cos(0.01)
    expected = math.atan2(across, along) + 0.01
    assert found["coupler.front.yaw"][1] == pytest.approx(expected, abs=1e-9)


def test_a_passage_that_is_not_linear_is_refused() -> None:
    with pytest.raises(InputProblem, match=r"track\.layout\[1\]\.kind|layout"):
        Line([{"kind": "tangent", "length": 10.0}, {"kind": "bloss", "length": 10.0}], 20.0)
