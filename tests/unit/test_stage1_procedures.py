"""The procedures of stage 1 on frames made by hand: what they read out of them, and what the description says alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import lmap
from lmap.criteria import Criterion
from lmap.errors import InputProblem, JudgementProblem
from lmap.procedures import critical_speed, quasi_static, step, suspension
from lmap.spec.model import RunPart, Spec
from lmap.toml import loads
from lmap.vehicle import Vehicle
from lmap.view.model import resolved

pytestmark = pytest.mark.needs_core
ROOT = Path(__file__).parents[2]


def spec(name: str) -> Spec:
    return Spec.model_validate(loads((ROOT / f"specs/{name}.toml").read_text(encoding="utf-8")))


@pytest.fixture(scope="module")
def locomotive() -> Vehicle:
    return lmap.Vehicle.load("coco134", beside=ROOT)


# ------------------------------------------------------------------------------------------------- description


def test_springs_in_series(locomotive: Vehicle) -> None:
    """8 secondary springs of 0.58 MN/m over 12 primary ones of 4 MN/m, half of them in each bogie."""
    model = resolved(locomotive.data)
    assert suspension.bogies(model, "carbody") == ["bogie1", "bogie2"]
    above, below = 8 * 5.8e5, 12 * 4.0e6
    by_hand = above * below / (above + below)
    assert suspension.vertical_stiffness(model, "carbody") == pytest.approx(by_hand, rel=1e-12)


def test_flexicoils_count_along_their_axis_and_rods_do_not() -> None:
    model = resolved(lmap.Vehicle.load("bobo86", beside=ROOT).data)
    above, below = 8 * 5.5e5, 8 * 2.2e6
    by_hand = above * below / (above + below)
    assert suspension.vertical_stiffness(model, "carbody") == pytest.approx(by_hand, rel=1e-12)


def test_what_cannot_be_worked_out_is_said() -> None:
    model = resolved(lmap.Vehicle.load("wagon2", beside=ROOT).data)
    assert suspension.bogies(model, "body") == []
    with pytest.raises(JudgementProblem, match="a friction: its vertical stiffness is not worked out"):
        suspension.vertical_stiffness(model, "body")


# ------------------------------------------------------------------------------------------------------- push


def pushed(locomotive: Vehicle, **changes: Any) -> pl.DataFrame:
    """A straight push of 0, 10, 20 mm: 4.2 MN/m in all, shared out evenly."""
    push = np.array([0.0, 0.01, 0.02])
    names = [f"ws{i}.{side}.Q" for i in range(1, 7) for side in ("left", "right")]
    columns = dict.fromkeys(names, 100000.0 + 4200000.0 / 12 * push)
    columns |= {"step": np.arange(3.0), "s": np.zeros(3)}
    columns |= {"carbody.z": -2.0 + push, "carbody.z.reaction": 4.2e6 * push}
    columns |= {"bogie1.z": -0.7 + 0.1 * push, "bogie2.z": -0.7 + 0.1 * push}
    columns |= changes
    frame = pl.DataFrame(columns)
    made = quasi_static.quantities(spec("vertical_push"), {"at rest": frame}, locomotive.data)
    return made["at rest"]


def test_an_even_push_has_no_difference(locomotive: Vehicle) -> None:
    found = pushed(locomotive)
    assert found.height == 2
    assert found["stiffness"].to_list() == pytest.approx([4.2e6] * 2)
    for name in ("nonlinearity", "bogie_difference", "load_difference"):
        assert found[name].abs().max() == pytest.approx(0.0, abs=1e-12)
    series = 4.64e6 * 48e6 / (4.64e6 + 48e6)
    assert found["stiffness_error"].to_list() == pytest.approx([4.2e6 / series - 1.0] * 2)


def test_a_wheel_that_takes_more_is_found_against_its_images(locomotive: Vehicle) -> None:
    found = pushed(locomotive, **{"ws1.left.Q": np.array([1e5, 1e5 + 3850.0, 1e5 + 7700.0])})
    mean = (11 * 3500.0 + 3850.0) / 12
    assert found["load_difference"][0] == pytest.approx(350.0 / mean)


def test_a_bogie_that_sinks_less_is_found(locomotive: Vehicle) -> None:
    found = pushed(locomotive, **{"bogie2.z": np.array([-0.7, -0.6995, -0.699])})
    assert found["bogie_difference"].to_list() == pytest.approx([0.5, 0.5])


def test_a_push_that_turns_back_is_refused(locomotive: Vehicle) -> None:
    with pytest.raises(JudgementProblem, match="comes back"):
        pushed(locomotive, **{"carbody.z": np.array([0.0, 0.01, 0.0])})


def test_without_a_push_there_is_no_case(locomotive: Vehicle) -> None:
    own = spec("vertical_push")
    with pytest.raises(InputProblem, match=r"run\.load: found no displacement of a body"):
        quasi_static.cases(own.model_copy(update={"run": RunPart()}), locomotive.data)


# ------------------------------------------------------------------------------------------------------- step


def settling(locomotive: Vehicle, rates: dict[str, float]) -> dict[str, pl.DataFrame]:
    """Wheel forces that decay at these rates (1/s) from 10 % of 100 kN, 40 s long."""
    t = np.arange(0.0, 40.0, 0.01)
    frames = {}
    for label, rate in rates.items():
        force = 1e5 * (1.0 + 0.1 * np.exp(-rate * t) * np.cos(8.0 * t))
        names = [f"ws{i}.{side}.Q" for i in range(1, 7) for side in ("left", "right")]
        frames[label] = pl.DataFrame({"t": t, "s": 30.0 * t, **dict.fromkeys(names, force)})
    return dict(step.quantities(spec("step"), frames, locomotive.data))


def test_the_settle_time_is_that_of_the_envelope(locomotive: Vehicle) -> None:
    """0.1 exp(-r t) = 0.001 at t = ln(100)/r; the last swing before it is at most half a period, 0.39 s, earlier."""
    found = settling(locomotive, {"fine": 2.0, "coarse": 1.0})
    fine, coarse = (found[label]["settle_time"][0] for label in ("fine", "coarse"))
    assert 0.0 <= np.log(100.0) / 2.0 - fine <= 0.4
    assert 0.0 <= np.log(100.0) - coarse <= 0.4
    assert found["fine"]["settle_spread"][0] == pytest.approx(coarse / fine - 1.0)
    assert found["fine"]["residual_leading"][0] < 1e-6


def test_what_never_settles_has_the_end_for_its_time_and_a_residual(locomotive: Vehicle) -> None:
    found = settling(locomotive, {"fine": 0.0})["fine"]
    assert found["settle_time"][0] > 39.5
    assert found["residual_trailing"][0] == pytest.approx(1e4, rel=1e-3)


def test_a_start_in_balance_shows_nothing(locomotive: Vehicle) -> None:
    with pytest.raises(JudgementProblem, match="nothing settles"):
        settling(locomotive, {"fine": 1e9})


def test_every_integrator_is_a_case(locomotive: Vehicle) -> None:
    own = spec("step")
    cases = step.cases(own, locomotive.data)
    assert [case.label for case in cases] == ["ros2 1 ms", "ros2 5 ms"]
    assert [case.data["run"]["integrator"]["step"] for case in cases] == [0.001, 0.005]
    assert step.origin(own, "ros2 5 ms", ("run", "integrator", "step")) == ("run", "integrator", 1, "step")
    assert step.origin(own, "ros2 5 ms", ("run", "friction")) == ("run", "friction")


# ----------------------------------------------------------------------------------------------- critical speed


def test_searches_beside_are_cases_that_the_limit_leaves_out(locomotive: Vehicle) -> None:
    own = spec("critical_speed")
    cases = {case.label: case.data["run"] for case in critical_speed.cases(own, locomotive.data)}
    judged, shown = own.criterion
    assert [label for label in cases if judged.applies_to(label)] == ["400 km/h"]
    assert [label for label in cases if shown.applies_to(label)] == [
        "beside: 10 km/h/s",
        "beside: 2.5 km/h/s",
        "beside: 1 km/h/s",
        "beside: bifurcation",
        "beside: linear",
    ]
    rates = {label: 3.6 * run["search"].get("deceleration", 0.0) for label, run in cases.items()}
    assert rates["400 km/h"] == pytest.approx(5.0, rel=1e-6)
    assert rates["beside: 10 km/h/s"] == pytest.approx(10.0, rel=1e-6)
    assert rates["beside: 2.5 km/h/s"] == pytest.approx(2.5, rel=1e-6)
    assert rates["beside: 1 km/h/s"] == pytest.approx(1.0, rel=1e-6)
    assert "integrator" not in cases["beside: linear"]


def test_motion_is_drawn_against_speed(locomotive: Vehicle) -> None:
    v = np.linspace(100.0, 20.0, 2000)
    ramp = pl.DataFrame({"v": v, "swing": 1e-3 * v, "critical_speed": np.full(2000, 40.0)})
    steps = pl.DataFrame(
        {"v": [50.0, 40.0, 50.0], "direction": [-1.0, -1.0, 1.0], "swing": [0.01, 0.002, 0.0]}
    )
    linear = pl.DataFrame({"v": [40.0], "real": [0.1], "critical_speed": [51.0]})
    frames = {"400 km/h": ramp, "beside: bifurcation": steps, "beside: linear": linear}
    [drawing] = critical_speed.drawings(spec("critical_speed"), frames, locomotive.data)
    curves = {curve.name: curve for curve in drawing.curves}
    assert len(curves["400 km/h"].x) <= 1200
    assert curves["bifurcation, stepped down"].y == [10.0, 2.0]
    assert curves["bifurcation, stepped up"].x == [180.0]
    assert curves["linear: small disturbances grow"].x == pytest.approx([183.6] * 2)


# --------------------------------------------------------------------------------------------------- criteria


@pytest.mark.parametrize(
    ("case", "label", "applies"),
    [
        (None, "a", True),
        ("a", "a", True),
        ("a", "b", False),
        ("!beside: *", "400 km/h", True),
        ("!beside: *", "beside: linear", False),
        (["a*", "!ab"], "ac", True),
        (["a*", "!ab"], "ab", False),
    ],
)
def test_a_criterion_may_leave_cases_out(case: str | list[str] | None, label: str, applies: bool) -> None:
    written: dict[str, Any] = {
        "name": "x",
        "signal": "y",
        "chain": [{"mean": {}}],
        "unit": "m",
        "source": "none",
    }
    criterion = Criterion.model_validate(written if case is None else written | {"case": case})
    assert criterion.applies_to(label) is applies
