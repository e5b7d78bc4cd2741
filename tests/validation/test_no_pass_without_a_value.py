"""On the real core: what cannot be judged is an error with its reason, never a pass."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import lmap
from lmap.errors import InputProblem
from lmap.verdict import Outcome, SpecVerdict

pytestmark = pytest.mark.needs_core
SPECS = Path(__file__).parents[2] / "specs"
SHORT = {
    "track.length": 80.0,
    "track.fade_in": 10.0,
    "track.irregularity.period": 50.0,
    "run.wheel_profile": "anzr1",
}


def checked(spec: Path, **settings: Any) -> SpecVerdict:
    [found] = lmap.check(spec, set=settings, cache=False).specs
    return found


def test_a_window_longer_than_the_run_is_an_error() -> None:
    spec = checked(SPECS / "hunting.toml", **SHORT)
    first = spec.criteria[0]
    assert (spec.outcome, first.outcome, first.value) == (Outcome.ERROR, Outcome.ERROR, None)
    assert "shorter than the window of 5 s" in str(first.message)


def test_a_stretch_without_samples_is_an_error(tmp_path: Path) -> None:
    text = (SPECS / "hunting.toml").read_text(encoding="utf-8")
    spec_file = tmp_path / "empty.toml"
    spec_file.write_text(
        text.replace("chain = [", "chain = [{ section = { from_m = 5000.0 } }, ", 1), encoding="utf-8"
    )
    spec = checked(spec_file, **SHORT)
    assert spec.outcome is Outcome.ERROR
    assert "no sample lies within" in str(spec.criteria[0].message)


@pytest.mark.parametrize(
    ("name", "end", "criterion", "why"),
    [
        ("parking", 12.0, "movement in 60 s", "the run ends at 12 s, before 70 s"),
        ("continuous_effort", 1.0, "balance speed kept", "the run ends at 1 s, before 60 s"),
        (
            "balance_speed",
            1.0,
            "time to 92 % of the balance speed",
            "run.time_to_speed has no value in this run",
        ),
        ("effort_speed", 1.0, "time to 40 km/h", "run.time_to_speed has no value in this run"),
    ],
)
def test_a_driven_run_that_is_too_short_is_an_error(name: str, end: float, criterion: str, why: str) -> None:
    spec = checked(SPECS / f"{name}.toml", **{"run.drive.until.time": end})
    judged = [one for one in spec.criteria if one.name == criterion]
    assert spec.outcome is Outcome.ERROR
    assert {(one.outcome, one.value, one.message) for one in judged} == {(Outcome.ERROR, None, why)}


def test_what_does_not_exist_is_refused_before_anything_runs(tmp_path: Path) -> None:
    text = (SPECS / "hunting.toml").read_text(encoding="utf-8")
    spec_file = tmp_path / "none.toml"
    spec_file.write_text(text.replace("ws*.*.LV", "ws9.left.LV", 1), encoding="utf-8")
    with pytest.raises(InputProblem, match=r"found \"ws9\.left\.LV\"; allowed: a channel of the vehicle"):
        lmap.check(spec_file)


def test_a_run_that_derails_is_an_error_in_every_criterion() -> None:
    settings = {"run.speed_kmh": 120.0, "run.wheel_profile": "anzr1", "run.integrator.step": 0.001}
    spec = checked(SPECS / "small_curve.toml", **settings)
    judged = [one for one in spec.criteria if one.judged]
    assert spec.outcome is Outcome.ERROR
    assert {one.outcome for one in judged} == {Outcome.ERROR}
    assert all("run ended" in str(one.message) and " m: " in str(one.message) for one in judged), judged[
        0
    ].message
