"""Closed forms against vectors of the standards and of hand calculation."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import pytest

from lmap import formulas
from lmap.errors import JudgementProblem

GM_TT0088 = {"track_mass": 245.0, "track_stiffness": 62.0e6, "track_damping": 55.4e3}


@pytest.mark.parametrize(
    ("speed_kmh", "dip_angle", "kilonewton"),
    [(115.0, 0.020, 261.2), (115.0, 0.014, 215.7), (115.0, 0.010, 185.4), (126.5, 0.020, 276.4)],
)
def test_p2_of_the_seed_locomotive_on_the_track_of_gm_tt0088(
    speed_kmh: float, dip_angle: float, kilonewton: float
) -> None:
    found = formulas.p2_force(
        static=109.508e3, dip_angle=dip_angle, speed=speed_kmh / 3.6, unsprung_mass=1425.0, **GM_TT0088
    )
    assert round(found / 1e3, 1) == kilonewton


def test_p2_without_a_dip_is_the_static_load() -> None:
    assert formulas.p2_force(static=1e5, dip_angle=0.0, speed=30.0, unsprung_mass=1425.0, **GM_TT0088) == 1e5


@pytest.mark.parametrize("share", [1.0, 1.5, 100.0])
def test_p2_refuses_a_track_so_damped_that_a_dip_would_take_load_off(share: float) -> None:
    limit = formulas.p2_damping_limit(1425.0, 245.0, 62.0e6)
    assert limit == pytest.approx(4.0 * math.sqrt(62.0e6 * 1670.0) / math.pi)
    track = GM_TT0088 | {"track_damping": share * limit}
    with pytest.raises(JudgementProblem, match="less damping of the track"):
        formulas.p2_force(static=1e5, dip_angle=0.02, speed=30.0, unsprung_mass=1425.0, **track)
    track = GM_TT0088 | {"track_damping": 0.999 * limit}
    assert formulas.p2_force(static=1e5, dip_angle=0.02, speed=30.0, unsprung_mass=1425.0, **track) > 1e5


def test_twist_of_en_14363_over_the_lengths_of_the_reference_locomotive() -> None:
    assert round(1e3 * formulas.en_twist(3.8, bogie=True), 2) == 5.68
    assert round(1e3 * 3.8 * formulas.en_twist(3.8, bogie=True), 1) == 21.6
    assert round(1e3 * formulas.en_twist(13.2, bogie=False), 2) == 3.14
    assert round(1e3 * 13.2 * formulas.en_twist(13.2, bogie=False), 0) == 41.0


@pytest.mark.parametrize(
    ("radius", "moment", "x"), [(160.0, 47.3, 0.057), (100.0, 75.7, 0.091), (80.0, 94.7, 0.114)]
)
def test_x_factor_of_a_linear_bogie(radius: float, moment: float, x: float) -> None:
    turned = 1.1475e6 * 6.6 / radius
    assert round(turned / 1e3, 1) == moment
    assert round(formulas.x_factor(turned, 3.8, 2 * 109.508e3), 3) == x


def test_cant_deficiency_as_acceleration() -> None:
    assert round(formulas.unbalanced_acceleration(0.110, 9.80665), 3) == 0.719
    assert round(formulas.unbalanced_acceleration(1.45 * 0.110, 9.80665), 3) == 1.043


def test_throws_are_those_of_chords_on_circles() -> None:
    """Exact geometry: axles on the arc, bogie centres on the bogies' chords, body on the centres' chord."""
    radius, pivots, wheelbase, length = 200.0, 13.2, 3.8, 22.0
    pivot_radius = math.sqrt(radius**2 - (wheelbase / 2) ** 2)
    middle = math.sqrt(pivot_radius**2 - (pivots / 2) ** 2)
    assert formulas.throw_centre(pivots, wheelbase, radius) == pytest.approx(radius - middle, rel=1e-3)
    end = math.hypot(middle, length / 2)
    assert formulas.throw_end(length, pivots, wheelbase, radius) == pytest.approx(end - radius, rel=1e-3)
    assert round(formulas.throw_centre(pivots, wheelbase, radius), 4) == 0.1179  # by hand: 188.68/1600
    assert round(formulas.throw_end(length, pivots, wheelbase, radius), 4) == 0.1846  # by hand: 295.32/1600


def test_coupler_force_in_a_curve_by_hand() -> None:
    """300 kN at 22/(2 100) = 0.11 rad: 32.93 kN sideways; 0.9 m above rail on 1.5 m: 19.76 kN off one rail."""
    angle = formulas.coupler_angle(22.0, 100.0)
    assert angle == pytest.approx(0.11)
    assert 300e3 * math.sin(angle) == pytest.approx(32.934e3, abs=1.0)
    assert formulas.coupler_unloading(300e3, angle, 0.9) == pytest.approx(19.760e3, abs=1.0)


def test_two_chords_of_equal_vehicles_make_twice_the_coupler_angle() -> None:
    """Exact geometry: pulling faces of neighbours meet on the symmetry line between them."""
    length, pivots, radius = 22.0, 13.2, 100.0
    middle = math.sqrt(radius**2 - (pivots / 2) ** 2)
    half_turn = math.atan((length / 2) / middle)  # of the radius from a body's middle to the coupler
    assert formulas.coupler_angle(length, radius) == pytest.approx(half_turn, rel=0.01)


def test_rollover_of_a_rigid_vehicle() -> None:
    assert formulas.rollover_unloading(0.72, 1.5, 9.81) == pytest.approx(0.147, abs=5e-4)


@pytest.mark.parametrize(
    ("rail", "law", "falling"),
    [("dry", (0.60, 0.15), (0.47, 0.44, 0.7)), ("wet", (0.29, 0.09), (0.30, 0.38, 0.1))],
)
def test_polachs_formula_with_table_4_of_the_paper(
    rail: str, law: tuple[float, float], falling: tuple[float, float, float]
) -> None:
    """The points of `polach_table4_22kmh.csv`, whose head has its patch, within 0.1 %."""
    table = Path(__file__).parents[2] / "crates/railsim/tests/data/polach_table4_22kmh.csv"
    with table.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    assert len(rows) > 10
    stiffness = 80.77e9 * 7.7463e-3 * 5.4550e-3 * 4.30
    for row in rows:
        slip = float(row["slip"])
        friction = formulas.falling_friction(*falling, slip * 22.0 / 3.6)
        found = formulas.polach_adhesion(slip, friction, *law, stiffness, 109.5e3)
        assert found == pytest.approx(float(row[f"fx_{rail}"]), rel=1e-3)


def test_a_notch_is_level_then_of_constant_power() -> None:
    assert formulas.notch_effort(1.0, 0.0, 450e3, 2.6e6) == 450e3
    assert formulas.notch_effort(1.0, 26.0, 450e3, 2.6e6) == pytest.approx(100e3)
    assert formulas.notch_effort(0.5, 5.0, 450e3, 2.6e6) == pytest.approx(130e3)
    assert formulas.notch_effort(0.5, 2.0, 450e3, 2.6e6) == 225e3
