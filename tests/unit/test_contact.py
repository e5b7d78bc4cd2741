"""lmap.contact: arrays in, arrays out; what is refused and how that is said."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from lmap import contact
from lmap.errors import InputProblem

pytestmark = pytest.mark.needs_core
PATCH = {"a": 0.006, "b": 0.006, "n": 1e5, "mu": 0.3}


def uic60() -> np.ndarray:
    """Half of the upright UIC 60 head as tangent arcs R300, R80, R13, then the side 1:20, mirrored; mm."""
    y = np.concatenate([np.arange(0.0, 35.9, 0.05), np.arange(35.9, 36.0, 0.005)])
    z = np.where(
        y <= 10.5,
        300.0 - np.sqrt(300.0**2 - y**2),
        np.where(
            y <= 25.988,
            80.1347 - np.sqrt(80.0**2 - (y - 7.7) ** 2),
            14.9089 - np.sqrt(np.maximum(13.0**2 - (y - 23.0162) ** 2, 0.0)),
        ),
    )
    depth = np.arange(14.5, 29.0, 0.25)
    half = np.concatenate([np.stack([y, z], 1), np.stack([35.287 + 0.05 * depth, depth], 1)])
    return np.concatenate([half[:0:-1] * [-1.0, 1.0], half])


@pytest.fixture(scope="module")
def pair() -> contact.Pair:
    return contact.Pair("s1002", uic60(), inclination=1 / 40)


def test_hertz_of_a_sphere_is_the_closed_form() -> None:
    """a^3 = 3 N R/(4 E*), approach a^2/R, p0 = 3N/(2 pi a^2) (Johnson 4.22 to 4.24)."""
    n = np.array([0.0, 1e3, 1e5])
    patch = contact.hertz(n, 1 / 0.46, 1 / 0.46)
    modulus = contact.patch.YOUNGS_MODULUS / (2.0 * (1.0 - contact.patch.POISSON_RATIO**2))
    a = np.cbrt(0.75 * n * 0.46 / modulus)
    np.testing.assert_allclose(patch.a, a, rtol=1e-12)
    np.testing.assert_allclose(patch.b, a, rtol=1e-12)
    np.testing.assert_allclose(patch.approach, a**2 / 0.46, rtol=1e-12)
    np.testing.assert_allclose(patch.max_pressure[1:], 1.5 * n[1:] / (math.pi * a[1:] ** 2), rtol=1e-12)
    assert patch.max_pressure[0] == 0.0


def test_arrays_broadcast_as_in_numpy() -> None:
    patch = contact.hertz(np.array([1e4, 1e5])[:, None], 2.0, np.array([1.0, 2.0, 3.0]))
    assert {array.shape for array in patch} == {(2, 3)}
    forces = contact.creep_forces("fastsim", np.full((4, 1), 1e-3), np.linspace(0.0, 1e-3, 5), **PATCH)
    assert {array.shape for array in forces} == {(4, 5)}
    one = contact.creep_forces("fastsim", 1e-3, 1e-3, **PATCH)
    assert one.fx.shape == ()
    assert one.fx == forces.fx[0, -1]
    assert contact.kalker(np.ones((2, 2))).c11.shape == (2, 2)


def test_kalker_at_a_node_of_his_table() -> None:
    found = contact.kalker([0.1, 1.0, 1 / 0.3], 0.25)
    np.testing.assert_allclose(found.c11, [3.31, 4.12, 6.34], rtol=1e-12)
    np.testing.assert_allclose(found.c22, [2.52, 3.67, 6.40], rtol=1e-12)
    np.testing.assert_allclose(found.c23, [0.473, 1.47, 4.32], rtol=1e-12)


@pytest.mark.parametrize("law", contact.LAWS)
def test_every_law_opposes_the_creepage(law: str) -> None:
    forces = contact.creep_forces(law, [1e-4, 0.0], [0.0, 1e-4], **PATCH)
    assert forces.fx[0] < 0.0
    assert forces.fy[1] < 0.0
    assert abs(forces.fy[0]) < 1e-9 * abs(forces.fx[0])


def test_laws_are_those_of_the_core() -> None:
    from lmap import toml

    with pytest.raises(toml.core().InputError) as told:
        toml.core().creep_forces('{"kind": "nothing"}', {})
    for law in contact.LAWS:
        assert f"`{law}`" in str(told.value)
    assert str(told.value).count("`") == 2 * (len(contact.LAWS) + 1)


def test_friction_falls_with_the_slip_velocity() -> None:
    constant = contact.creep_forces("polach", [0.2], **PATCH)
    falling = contact.creep_forces("polach", [0.2], **PATCH, falling={"ratio": 0.4, "decay": 0.6}, speed=20.0)
    assert 0.39 < float(falling.fx[0] / constant.fx[0]) < 0.5


def test_non_elliptic_patch_on_a_circle() -> None:
    """On a circle at one load: approach 1.1^(-1/3), area 1.1^(2/3), peak pressure 1.1^(-2/3) of Hertz's."""
    y = np.linspace(-0.02, 0.02, 2001)
    hertz = contact.hertz(1e5, 2.0, 2.0)
    found = contact.non_elliptic(y, y**2, curvature=2.0, force=1e5)
    assert found.approach / float(hertz.approach) == pytest.approx(1.1 ** (-1 / 3), rel=1e-4)
    assert found.area / (math.pi * float(hertz.a) ** 2) == pytest.approx(1.1 ** (2 / 3), rel=1e-4)
    assert found.max_pressure / float(hertz.max_pressure) == pytest.approx(1.1 ** (-2 / 3), rel=1e-4)
    x, z = np.meshgrid(np.linspace(-0.01, 0.01, 801), np.linspace(-0.01, 0.01, 801))
    assert float(found.pressure(x, z).sum()) * 2.5e-5**2 == pytest.approx(1e5, rel=1e-3)
    again = contact.non_elliptic(y, y**2 + 0.003, curvature=2.0, approach=found.approach)
    assert again.force == pytest.approx(1e5, rel=1e-9)


def test_rolling_radius_difference_of_equal_wheels_is_odd(pair: contact.Pair) -> None:
    y = np.array([[0.0, 0.001], [0.003, -0.003]])
    found = pair.rolling_radius_difference(y)
    assert found.shape == y.shape
    assert found[0, 0] == pytest.approx(0.0, abs=1e-12)
    assert found[1, 0] == pytest.approx(-found[1, 1], abs=1e-9)
    assert np.isnan(pair.rolling_radius_difference(0.2))


def test_conicity_of_a_cone_is_its_own() -> None:
    amplitude = np.array([0.001, 0.003])
    y = np.linspace(-0.01, 0.01, 201)
    for method in contact.METHODS:
        found = contact.curve_conicity(y, 2.0 * 0.05 * y, amplitude, method=method)
        np.testing.assert_allclose(found, 0.05, rtol=1e-4)
    assert np.isnan(contact.curve_conicity(y, -y, 0.003))


def test_methods_agree_where_the_difference_is_straight(pair: contact.Pair) -> None:
    found = [float(pair.conicity(0.006, method=method)) for method in contact.METHODS]
    assert max(found) < 1.5 * min(found)


def test_contacts_are_mirrored(pair: contact.Pair) -> None:
    one, other = pair.contacts(0.004), pair.contacts(-0.004)
    right, left = one.where(one.side == 1.0), other.where(other.side == -1.0)
    for name in ("y_rail", "z_rail", "y_wheel", "z_wheel", "angle", "k_yy"):
        np.testing.assert_allclose(getattr(right, name), getattr(left, name), atol=1e-9)
    assert len(one) == len(one.y) > 1
    assert np.isnan(one.normal).all()


def test_patches_carry_the_load(pair: contact.Pair) -> None:
    found = pair.contacts(0.0, load=1e5)
    for side in (-1.0, 1.0):
        rows = found.where(found.side == side)
        assert float((rows.normal * np.cos(rows.angle)).sum()) == pytest.approx(1e5, rel=1e-6)


def test_flange_play_is_symmetrical(pair: contact.Pair) -> None:
    left, right = pair.flange_play()
    assert 0.004 < right < 0.012
    assert left == pytest.approx(-right, abs=1e-6)


def test_left_and_right_may_differ() -> None:
    other = contact.Pair("s1002", uic60(), inclination=1 / 40, left={"radius": 0.459})
    assert float(other.rolling_radius_difference(0.0)) == pytest.approx(0.001, abs=1e-9)


def test_patch_with_and_without_an_ellipse(pair: contact.Pair) -> None:
    """Both carry the load; where the profiles make nearly an ellipse their areas are within the method's error."""
    found = {normal: pair.patch(0.003, load=8e4, normal=normal) for normal in contact.pair.NORMALS}
    x, y = np.meshgrid(np.linspace(-0.015, 0.015, 601), np.linspace(-0.02, 0.02, 801))
    for patch in found.values():
        assert patch.force == pytest.approx(8e4)
        assert float(patch.pressure(x, y + patch.origin).sum()) * 5e-5**2 == pytest.approx(8e4, rel=3e-3)
    assert 0.7 < found["kik_piotrowski"].area / found["hertz"].area < 1.6
    rows = pair.contacts(0.003, load=8e4)
    row = rows.where(rows.side == 1.0)
    assert found["hertz"].a == pytest.approx(float(row.a[0]), rel=0.01)
    with pytest.raises(InputProblem, match='did you mean "hertz"'):
        pair.patch(0.0, normal="herz")  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["w.csv", "w.whl", "w.prw", "w.wheel"])
def test_profiles_survive_writing_and_reading(name: str, tmp_path: Path) -> None:
    wheel = contact.read_profile("s1002")
    contact.write_profile(wheel, tmp_path / name)
    back = contact.read_profile(tmp_path / name)
    np.testing.assert_allclose(back.points, wheel.points, atol=1e-6)
    assert back.kind == "wheel"
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_smoothing_and_quality() -> None:
    curve = contact.smooth(contact.read_profile("as60"))
    top = np.argmin(curve.z)
    assert curve.curvature[top] == pytest.approx(1 / 0.3, rel=0.02)
    doubled = contact.read_profile("as60").points
    doubled = np.insert(doubled, 50, doubled[50], axis=0)
    assert "doubled_point" in {finding.code for finding in contact.quality(doubled, "rail")}


def refused(told: pytest.ExceptionInfo[InputProblem]) -> str:
    [problem] = told.value.problems
    return str(problem)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"xi": [0.0, math.nan]}, "xi[1]: found nan; allowed: a finite number"),
        ({"xi": [[0.0, 1.0], [0.0, math.inf]]}, "xi[1][1]: found inf; allowed: a finite number"),
        ({"n": -1.0}, "n: found -1; allowed: a number >= 0"),
        ({"n": [1.0, -2.0]}, "n[1]: found -2; allowed: a number >= 0"),
        ({"mu": -0.3}, "mu: found -0.3; allowed: a number >= 0"),
        ({"a": 0.0}, "a: found 0; allowed: a number > 0"),
        ({"a": "wide"}, "a: found 'wide'; allowed: a number or an array of numbers"),
        ({"shear_modulus": -1.0}, "shear_modulus: found -1; allowed: a number > 0"),
        ({"poisson": 0.7}, "poisson: found 0.7; allowed: 0 to 0.5"),
        (
            {"xi": [1.0, 2.0], "eta": [1.0, 2.0, 3.0]},
            "found arrays of xi (2,), eta (3,); allowed: shapes that numpy broadcasts",
        ),
    ],
)  # fmt: skip
def test_refused_contacts(change: dict[str, object], message: str) -> None:
    given = {"xi": 1e-3, **PATCH, **change}
    with pytest.raises(InputProblem) as told:
        contact.creep_forces("fastsim", **given)  # type: ignore[arg-type]
    assert refused(told) == message


def test_an_unknown_law_with_the_nearest_known_one() -> None:
    with pytest.raises(InputProblem) as told:
        contact.creep_forces("fastsym", 1e-3, **PATCH)
    assert refused(told).startswith('law: found "fastsym"; allowed: fastrip, fastsim, ')
    assert refused(told).endswith('(did you mean "fastsim"?)')


def test_an_unknown_key_of_a_law() -> None:
    with pytest.raises(InputProblem, match="grid"):
        contact.creep_forces({"kind": "fastsim", "grid": 10}, 1e-3, **PATCH)


def test_unknown_words_have_the_nearest_known_one(pair: contact.Pair) -> None:
    with pytest.raises(InputProblem, match='did you mean "integration"'):
        pair.conicity(0.003, method="integracion")
    with pytest.raises(InputProblem, match='did you mean "free"'):
        pair.contacts(0.0, roll="fre")  # type: ignore[arg-type]


@pytest.mark.parametrize("load", [-1.0, 0.0, math.nan])
def test_a_load_that_is_none(pair: contact.Pair, load: float) -> None:
    with pytest.raises(InputProblem, match=r"^load: found .*; allowed: a number > 0$"):
        pair.contacts(0.0, load=load)
    with pytest.raises(InputProblem, match="load: found"):
        pair.patch(0.0, load=load)


@pytest.mark.parametrize("gauge", [1.2, 1.65, 2.0, -1.0, math.nan])
def test_a_gauge_at_which_no_wheelset_stands(gauge: float) -> None:
    with pytest.raises(InputProblem) as told:
        contact.Pair("s1002", uic60(), inclination=1 / 40, gauge=gauge)
    assert "gauge: found" in str(told.value)


def test_profiles_of_the_wrong_side_or_unit() -> None:
    wheel = contact.read_profile("s1002")
    with pytest.raises(InputProblem, match="rail"):
        contact.Pair(uic60(), wheel.points, inclination=1 / 40)
    with pytest.raises(InputProblem, match="mm"):
        contact.Pair(1e-3 * wheel.points, uic60())
    points = wheel.points.copy()
    points[3, 1] = math.nan
    with pytest.raises(InputProblem, match=r"wheel\[3\]\[1\]: found nan"):
        contact.Pair(points, uic60())
    with pytest.raises(InputProblem, match=r"shape \(3,\)"):
        contact.Pair([1.0, 2.0, 3.0], uic60())


def test_a_gap_that_no_patch_fits_in() -> None:
    y = np.linspace(-1e-3, 1e-3, 21)
    with pytest.raises(InputProblem, match="the end of the gap"):
        contact.non_elliptic(y, y**2, curvature=2.0, force=1e5)
    with pytest.raises(InputProblem, match="opens to both sides"):
        contact.non_elliptic(y, y, curvature=2.0, force=1e5)
    with pytest.raises(InputProblem, match="one of the two"):
        contact.non_elliptic(y, y**2, curvature=2.0)
