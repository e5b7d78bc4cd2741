"""Properties that every creep law and every patch has, for any input."""

from __future__ import annotations

import contextlib
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lmap import contact

pytestmark = pytest.mark.needs_core

LIMITED = [law for law in contact.LAWS if law != "kalker_linear"]
PAIR: dict[str, contact.Pair] = {}


@st.composite
def contacts(draw: st.DrawFn, spin: bool = True) -> dict[str, Any]:
    """A patch of 1 to 20 mm, axis ratio to 10, with any creepage."""
    size, ratio = draw(st.floats(1e-3, 2e-2)), draw(st.floats(0.1, 10.0))
    creepage = st.floats(-0.5, 0.5) | st.floats(-1e-3, 1e-3)
    return {
        "xi": draw(creepage),
        "eta": draw(creepage),
        "phi": draw(st.floats(-5.0, 5.0)) if spin else 0.0,
        "a": size * ratio**0.5,
        "b": size / ratio**0.5,
        "n": draw(st.floats(1.0, 2e5)),
        "mu": draw(st.floats(0.01, 0.8)),
    }


@pytest.mark.parametrize("law", contact.LAWS)
@settings(deadline=None)
@given(given=contacts())
def test_no_creepage_no_force(law: str, given: dict[str, Any]) -> None:
    forces = contact.creep_forces(law, **{**given, "xi": 0.0, "eta": 0.0, "phi": 0.0})
    assert (float(forces.fx), float(forces.fy)) == (0.0, 0.0)


@pytest.mark.parametrize("law", LIMITED)
@settings(deadline=None)
@given(given=contacts())
def test_friction_is_the_bound(law: str, given: dict[str, Any]) -> None:
    forces = contact.creep_forces(law, **given)
    bound = given["mu"] * given["n"]
    assert np.hypot(forces.fx, forces.fy) <= 1.02 * bound


@pytest.mark.parametrize("law", contact.LAWS)
@settings(deadline=None)
@given(given=contacts())
def test_mirrored_creepage_gives_the_mirrored_force(law: str, given: dict[str, Any]) -> None:
    one = contact.creep_forces(law, **given)
    other = contact.creep_forces(law, **{**given, "eta": -given["eta"], "phi": -given["phi"]})
    scale = 1e-9 * (given["mu"] * given["n"] + abs(float(one.fx)) + abs(float(one.fy)))
    assert abs(float(one.fx - other.fx)) <= scale
    assert abs(float(one.fy + other.fy)) <= scale


@pytest.mark.parametrize("law", contact.LAWS)
@settings(deadline=None)
@given(given=contacts(spin=False))
def test_force_opposes_sliding(law: str, given: dict[str, Any]) -> None:
    forces = contact.creep_forces(law, **given)
    power = float(forces.fx) * given["xi"] + float(forces.fy) * given["eta"]
    # at creepages of 1e-100 the forces are rounding errors of sums that vanish
    assert power <= 1e-12 * given["mu"] * given["n"] * np.hypot(given["xi"], given["eta"])


@given(
    n=st.floats(1.0, 2e5),
    more=st.floats(1.001, 10.0),
    k_x=st.floats(0.1, 10.0),
    k_y=st.floats(0.1, 100.0),
)
def test_hertz_grows_with_the_load(n: float, more: float, k_x: float, k_y: float) -> None:
    small, large = contact.hertz(n, k_x, k_y), contact.hertz(n * more, k_x, k_y)
    assert all(float(one) < float(other) for one, other in zip(small, large, strict=True))


@settings(max_examples=30, deadline=None)
@given(y=st.floats(-0.006, 0.006), step=st.floats(1e-7, 1e-6))
def test_contact_on_the_tread_moves_continuously(y: float, step: float) -> None:
    """A cone on a head of R300: no jump, and 20 um at most for a micrometre."""
    wheel = contact.read_profile("anzr1")
    pair = PAIR.setdefault("pair", contact.Pair(wheel, "as60", inclination=0.05, gauge_point_depth=0.016))
    before, after = pair.rolling_radius_difference([y, y + step])
    assert abs(after - before) < 0.2 * step + 1e-9


@settings(max_examples=50, deadline=None)
@given(
    points=st.lists(st.tuples(st.floats(-200.0, 200.0), st.floats(-200.0, 200.0)), min_size=1, max_size=40),
    y=st.floats(-1.0, 1.0),
)
def test_no_finite_profile_ends_in_a_panic(points: list[tuple[float, float]], y: float) -> None:
    from lmap.errors import InputProblem

    with contextlib.suppress(InputProblem):
        pair = contact.Pair(points, "as60", inclination=0.05)
        pair.rolling_radius_difference(y)
        pair.contacts(y, load=1e5)
