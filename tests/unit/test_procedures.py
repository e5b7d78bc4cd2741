"""Procedures: pure, complete, listed."""

from __future__ import annotations

import copy
import functools
import tomllib
from pathlib import Path

import pytest

from lmap import procedures
from lmap.errors import InputProblem
from lmap.prepare import Prepared, prepare
from lmap.procedures import hunting
from lmap.procedures.base import CaseFigures, Procedure
from lmap.spec.model import RunPart

every_procedure = pytest.mark.parametrize("procedure", procedures.PROCEDURES, ids=lambda one: one.NAME)


@pytest.fixture
def prepared(toy: Path) -> Prepared:
    del toy  # the working folder
    return prepare(Path("specs/sway.toml"))


def test_the_list_is_sorted_by_name() -> None:
    names = [procedure.NAME for procedure in procedures.PROCEDURES]
    assert names == sorted(set(names)) == list(procedures.BY_NAME)


SPECS = Path(__file__).resolve().parents[2] / "specs"


@functools.cache
def _shipped(procedure: str) -> Prepared:
    """The first spec that ships with a procedure, ready to run."""
    for path in sorted(SPECS.glob("*.toml")):
        if tomllib.loads(path.read_text(encoding="utf-8"))["procedure"] == procedure:
            return prepare(path)
    raise AssertionError(f"no spec has the procedure {procedure}")


@pytest.mark.needs_core
@every_procedure
def test_a_procedure_is_pure_and_never_calls_the_core(
    procedure: Procedure, monkeypatch: pytest.MonkeyPatch
) -> None:
    def forbidden() -> None:
        raise AssertionError("a procedure asked for the core")

    one = _shipped(procedure.NAME)
    spec, vehicle = one.spec, one.vehicle.data
    monkeypatch.setattr("lmap.toml.core", forbidden)
    before = (spec.model_dump(), copy.deepcopy(dict(vehicle.document)))
    first, second = procedure.cases(spec, vehicle), procedure.cases(spec, vehicle)
    assert [case.hash for case in first] == [case.hash for case in second]
    assert [case.label for case in first] == [case.label for case in one.cases]
    assert (spec.model_dump(), dict(vehicle.document)) == before


def test_hunting_runs_every_profile_at_every_speed(prepared: Prepared) -> None:
    run = RunPart.model_validate({"speed_kmh": [36.0, 72.0], "wheel_profile": ["round", "worn"], "x": 1})
    spec = prepared.spec.model_copy(update={"run": run})
    cases = hunting.cases(spec, prepared.vehicle.data)
    assert [case.label for case in cases] == [
        "round 36 km/h",
        "round 72 km/h",
        "worn 36 km/h",
        "worn 72 km/h",
    ]
    assert [case.data["run"]["speed"] for case in cases] == [10.0, 20.0, 10.0, 20.0]
    assert cases[0].data["run"] == {"kind": "time", "speed": 10.0, "wheel_profile": "round", "x": 1}
    assert len({case.hash for case in cases}) == 4


def test_without_a_profile_the_vehicles_own_is_run_and_the_label_says_the_speed(prepared: Prepared) -> None:
    spec = prepared.spec.model_copy(update={"run": RunPart.model_validate({"speed": 10.0})})
    [case] = hunting.cases(spec, prepared.vehicle.data)
    assert (case.label, case.data["run"]["wheel_profile"]) == ("36 km/h", "round")


def test_a_missing_speed_is_bad_input(prepared: Prepared) -> None:
    spec = prepared.spec.model_copy(update={"run": RunPart()})
    with pytest.raises(InputProblem, match=r"run\.speed: found nothing"):
        hunting.cases(spec, prepared.vehicle.data)


def test_hunting_shows_its_track_beside_the_papers_and_the_conicities(prepared: Prepared) -> None:
    facts = {fact.name: (fact.value, fact.published) for fact in prepared.facts}
    assert facts == {
        "irregularity, lateral": ("+5.100 / -5.000 mm", "+4.553 / -4.842 mm"),
        "irregularity, vertical": ("+5.800 / -6.000 mm", "+5.631 / -5.940 mm"),
        "irregularity, cant": ("+4.100 / -4.000 mm", "+4.114 / -4.504 mm"),
        "irregularity, gauge": ("1431.200 to 1438.900 mm", "1430.496 to 1439.114 mm"),
        "irregularity, wavelengths": ("1.5 to 40 m", None),
        "equivalent conicity at 3 mm, round": ("0.1500", None),
        "equivalent conicity at 3 mm, worn": ("0.1500", None),
    }


def test_the_papers_extremes_stand_beside_its_own_class_alone(prepared: Prepared) -> None:
    track = {**prepared.spec.track, "irregularity": {"kind": "psd", "class": 5, "wavelengths": [1.5, 40.0]}}
    spec = prepared.spec.model_copy(update={"track": track})
    figures = [
        CaseFigures(case=case, track_extremes={"lateral": (-1.0, 1.0)}, conicity=None)
        for case in hunting.cases(spec, prepared.vehicle.data)
    ]
    assert [fact.published for fact in hunting.facts(spec, figures)] == [None, None]
