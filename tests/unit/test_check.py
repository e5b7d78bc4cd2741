"""The whole way from specs to verdicts, on the stand-in core."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import polars as pl
import pytest

import lmap
from lmap.check import find_specs
from lmap.errors import InputProblem, SimulationProblem
from lmap.execute.local import run_cases
from lmap.execute.progress import Lines, Progress
from lmap.prepare import prepare
from lmap.report import junit
from lmap.spec.case import Case
from lmap.verdict import Outcome

pytestmark = pytest.mark.usefixtures("toy")


class Heard(Progress):
    def __init__(self) -> None:
        self.events: list[tuple[Any, ...]] = []

    def begin(self, cases: Any, jobs: int, known: int = 0, about: int = 0) -> None:
        self.events.append(("begin", list(cases), jobs))

    def update(self, index: int, fraction: float, distance: float, factor: float) -> None:
        self.events.append(("update", index))

    def done(self, index: int, wall_s: float, trouble: str | None) -> None:
        self.events.append(("done", index, trouble))

    def end(self) -> None:
        self.events.append(("end",))


def test_a_check_judges_every_criterion_in_every_case() -> None:
    acceptance = lmap.check("sway")
    [spec] = acceptance.specs
    assert (acceptance.outcome, acceptance.exit_code) == (Outcome.PASS, 0)
    assert [(c.name, c.case) for c in spec.criteria] == [
        (name, case)
        for name in ("lateral acceleration", "wheel L/V", "wheelset motion")
        for case in ("round", "worn")
    ]
    # results come back last first: each in its own place all the same
    assert [case.label for case in spec.cases] == ["round", "worn"]
    assert [case.hash for case in spec.cases] == [criterion.case_hash for criterion in spec.criteria[:2]]
    assert [file.role for file in spec.inputs] == [
        "spec",
        "vehicle",
        "track",
        "profile",
        "profile",
        "profile",
    ]
    assert spec.criteria[0].published == 0.055


def without_limits() -> None:
    spec = Path("specs/sway.toml")
    lines = spec.read_text(encoding="utf-8").splitlines()
    kept = [line for line in lines if not line.startswith(("max", "min", "strict"))]
    spec.write_text("\n".join(kept) + "\n", encoding="utf-8")


def test_a_spec_without_a_limit_does_not_pass() -> None:
    without_limits()
    acceptance = lmap.check("sway")
    assert (acceptance.outcome, acceptance.exit_code) == (Outcome.NOT_ASSESSED, 1)
    assert all(criterion.outcome is Outcome.PASS for criterion in acceptance.specs[0].criteria)
    suite = ET.fromstring(junit(acceptance))[0]
    assert [suite.get(key) for key in ("tests", "failures", "errors", "skipped")] == ["7", "0", "0", "1"]


def test_a_spec_without_a_limit_that_cannot_be_judged_stays_an_error() -> None:
    without_limits()
    assert lmap.check("sway", set={"run.test": "diverge"}).outcome is Outcome.ERROR


def test_a_bad_vehicle_fails() -> None:
    acceptance = lmap.check("sway", set={"yaw_damper.cx": 0.0})
    assert acceptance.exit_code == 1
    assert acceptance.specs[0].criteria[0].outcome is Outcome.FAIL
    assert acceptance.specs[0].overrides == {"yaw_damper.cx": 0.0}


@pytest.mark.parametrize(
    ("trouble", "message"),
    [
        ("diverge", "the run ended early: run ended at t ="),
        ("raise", "the run ended early: static equilibrium did not converge"),
    ],
)
def test_a_run_that_does_not_reach_its_end_is_an_error(trouble: str, message: str) -> None:
    acceptance = lmap.check("sway", set={"run.test": trouble})
    assert acceptance.exit_code == 2
    assert all(criterion.outcome is Outcome.ERROR for criterion in acceptance.specs[0].criteria)
    assert (acceptance.specs[0].criteria[0].message or "").startswith(message)


def test_a_nan_is_an_error() -> None:
    acceptance = lmap.check("sway", set={"run.test": "hole"})
    assert acceptance.exit_code == 2
    assert "not finite in 1 of" in (acceptance.specs[0].criteria[0].message or "")
    assert acceptance.specs[0].criteria[2].outcome is Outcome.PASS


def test_too_few_samples_for_the_filter_are_an_error() -> None:
    acceptance = lmap.check("sway", set={"run.output_step": 0.01})
    assert acceptance.specs[0].criteria[0].outcome is Outcome.ERROR


def test_nothing_runs_where_anything_is_wrong(fake_core: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    def forbidden(*_: object) -> None:
        raise AssertionError("a case ran")

    monkeypatch.setattr(fake_core, "run_cases", forbidden)
    text = Path("specs/sway.toml").read_text(encoding="utf-8")
    Path("specs/other.toml").write_text(text.replace("trail_pivot.ay", "trial_pivot.ay"), encoding="utf-8")
    Path("specs/third.toml").write_text(text.replace("friction", "fricton"), encoding="utf-8")
    with pytest.raises(InputProblem) as caught:
        lmap.check(["specs", "nowhere"])
    assert [str(problem).split("; ")[0] for problem in caught.value.problems] == [
        'found "nowhere"',
        'specs/other.toml:19: criterion[0].signal[1]: found "carbody.trial_pivot.ay"',
        'specs/third.toml:13: run.fricton: found an unknown key "fricton"',
    ]


def test_the_channel_meant_is_suggested() -> None:
    text = Path("specs/sway.toml").read_text(encoding="utf-8")
    Path("specs/other.toml").write_text(text.replace("trail_pivot.ay", "trial_pivot.ay"), encoding="utf-8")
    with pytest.raises(InputProblem, match=r'did you mean "carbody\.trail_pivot\.ay"'):
        prepare(Path("specs/other.toml"))


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"vehicle": "toi"}, 'specs/sway.toml: --set vehicle: found "toi"; allowed: a vehicle that ships'),
        (
            {"condition": "tara"},
            'specs/sway.toml: --set condition: found "tara"; allowed: a condition of models',
        ),
        ({"yaw_dmper.cx": 0.0}, "specs/sway.toml: --set yaw_dmper.cx: found an unknown parameter"),
        ({"run.wheel_profile": "ruond"}, 'specs/sway.toml: --set run.wheel_profile: found "ruond"'),
        ({"track.base": "x"}, 'specs/sway.toml: --set track.base: found "x"; allowed: a track that ships'),
    ],
)
def test_faults_of_settings_name_them(settings: dict[str, Any], message: str) -> None:
    with pytest.raises(InputProblem) as caught:
        lmap.check("sway", set=settings)
    assert str(caught.value).startswith(message)


def test_a_vehicle_that_is_set_is_seen_from_the_working_folder() -> None:
    text = Path("models/vehicles/toy.toml").read_text(encoding="utf-8")
    Path("mine.toml").write_text(text.replace('name = "toy"', 'name = "mine"', 1), encoding="utf-8")
    assert prepare(Path("specs/sway.toml"), {"vehicle": "./mine.toml"}).vehicle.data.name == "mine"
    with pytest.raises(InputProblem, match=r"--set vehicle: found \"\./gone\.toml\", which is no file"):
        prepare(Path("specs/sway.toml"), {"vehicle": "./gone.toml"})


def test_a_track_and_a_profile_that_are_set_are_seen_from_the_working_folder() -> None:
    text = Path("models/tracks/toy_track.toml").read_text(encoding="utf-8")
    Path("mine.toml").write_text(text.replace("1.435", "1.6"), encoding="utf-8")
    Path("mine.csv").write_bytes(Path("models/profiles/round.csv").read_bytes())
    own = {"track.base": "./mine.toml", "run.wheel_profile": "./mine.csv"}
    prepared = prepare(Path("specs/sway.toml"), own)
    assert prepared.spec.track["gauge"] == 1.6
    assert [one.path for one in prepared.inputs if one.path.startswith("mine")] == ["mine.toml", "mine.csv"]
    with pytest.raises(InputProblem, match=r"--set track\.base: found \"\./gone\.toml\", which is no file"):
        prepare(Path("specs/sway.toml"), {"track.base": "./gone.toml"})


def test_faults_of_a_case_name_the_file_that_holds_the_part() -> None:
    vehicle = Path("models/vehicles/toy.toml")
    vehicle.write_text(
        vehicle.read_text(encoding="utf-8").replace("mass = 87", "mass = -87"), encoding="utf-8"
    )
    track = Path("models/tracks/toy_track.toml")
    track.write_text(track.read_text(encoding="utf-8") + "gaugee = 1.4\n", encoding="utf-8")
    with pytest.raises(InputProblem) as caught:
        lmap.check("sway")
    assert [str(problem).split("; ")[0] for problem in caught.value.problems] == [
        'models/tracks/toy_track.toml:4: gaugee: found an unknown key "gaugee"',
        "models/vehicles/toy.toml:13: body[0].mass: found -87180.0",
    ]


def test_a_profile_with_three_points_is_refused() -> None:
    Path("models/profiles/worn.csv").write_text("0.0,0.0\n1.0,0.0\n2.0,0.0\n", encoding="utf-8")
    with pytest.raises(
        InputProblem, match=r"^models/profiles/worn\.csv: profiles\.worn\.points: found 3 points"
    ):
        lmap.check("sway")


def test_specs_are_found_by_file_folder_name_and_id() -> None:
    spec = Path("specs/sway.toml").resolve()
    for given in ("specs/sway.toml", "specs", "sway", "9.1", Path("specs/sway.toml")):
        assert [path.resolve() for path in find_specs(given)] == [spec]


@pytest.mark.parametrize("given", ["specs/none.toml", "swya", "models"])
def test_a_spec_that_is_none_is_refused(given: str) -> None:
    with pytest.raises(InputProblem):
        find_specs(given)


def test_a_spec_given_twice_runs_once_and_equal_cases_run_once() -> None:
    heard = Heard()
    text = Path("specs/sway.toml").read_text(encoding="utf-8")
    Path("specs/again.toml").write_text(text.replace('"9.1"', '"9.2"'), encoding="utf-8")
    acceptance = lmap.check(["specs", "sway"], progress=heard)
    assert [spec.id for spec in acceptance.specs] == ["9.1", "9.2"]
    assert [event[1:] for event in heard.events if event[0] == "done"] == [(1, None), (0, None)]
    assert heard.events[-1] == ("end",)


def test_progress_ends_when_a_run_is_interrupted(
    fake_core: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(fake_core, "run_cases", interrupted)
    heard = Heard()
    with pytest.raises(KeyboardInterrupt):
        lmap.check("sway", progress=heard)
    assert heard.events[-1] == ("end",)


def test_plain_progress_is_a_few_lines(capsys: pytest.CaptureFixture[str]) -> None:
    case = prepare(Path("specs/sway.toml")).cases[0]
    run_cases([case], progress=Lines())
    out = capsys.readouterr()
    assert out.out == ""
    lines = out.err.splitlines()
    assert lines[0] == "running 1 case on 1 thread"
    assert lines[1] == "round: 180 of 600 m, 25.0 times real time"
    assert len(lines) == 5


def test_simulate_gives_the_frame_or_says_why_not() -> None:
    case = prepare(Path("specs/sway.toml")).cases[0]
    frame = lmap.simulate(case)
    assert isinstance(frame, pl.DataFrame)
    assert frame.columns[:3] == ["t", "s", "v"]
    assert lmap.simulate(case.json).equals(frame)
    with pytest.raises(SimulationProblem, match="derailed"):
        lmap.simulate({**case.data, "run": {**case.data["run"], "test": "diverge"}})


def nested(depth: int) -> dict[str, Any]:
    table: dict[str, Any] = {}
    for _ in range(depth):
        table = {"a": table}
    return table


@pytest.mark.parametrize(
    ("case", "message"),
    [
        ("{", "line 1: found no JSON"),
        ("[1]", "found no table but list"),
        (7, "found no table but int"),
        ('{"run": {"speed": NaN}}', "run.speed: found nan; allowed: a finite number"),
        ('{"run": {"speed": 1e999}}', "run.speed: found inf; allowed: a finite number"),
        ({"run": {"speed": math.nan}}, "run.speed: found nan; allowed: a finite number"),
        ({"run": {"speed": np.float32(3.0)}}, "run.speed: found np.float32(3.0) of type float32"),
        ({"track": {"points": [1.0, np.int64(3)]}}, "track.points[1]: found np.int64(3) of type int64"),
        ({"run": {3: 1.0}}, "run: found the key 3"),
        ('{"label": "\\ud800"}', "label: found "),
        ('{"a":' * 100_000, "found tables or lists too deep in each other"),
        (nested(100_000), "found tables or lists too deep in each other"),
        (Case("x", {"run": {"speed": math.inf}}), "run.speed: found inf"),
    ],
    ids=range(13),
)
def test_a_case_that_is_none_is_refused_with_its_key(case: Any, message: str) -> None:
    with pytest.raises(InputProblem) as caught:
        lmap.simulate(case)
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"secondary.kz": math.nan}, 'set."secondary.kz": found nan; allowed: a finite number'),
        ({"secondary.kz": np.int64(3)}, 'set."secondary.kz": found np.int64(3) of type int64'),
        ({"run.speed": [1.0, np.float32(3)]}, 'set."run.speed"[1]: found np.float32(3.0) of type float32'),
        ({3: 1.0}, "set: found the key 3"),
        (["run.speed=3"], "set: found list; allowed: a mapping"),
    ],
)
def test_settings_that_no_spec_could_write_are_refused_with_their_key(settings: Any, message: str) -> None:
    with pytest.raises(InputProblem) as caught:
        lmap.check("sway", set=settings)
    assert str(caught.value).startswith(message)


def test_a_vehicle_is_loaded_and_resolved() -> None:
    toy = lmap.Vehicle.load("toy")
    assert (toy.data.name, toy.data.conditions) == ("toy", ("full", "tare"))
    assert toy.data.design_speed == pytest.approx(115.0 / 3.6)
    soft = toy.resolve({"secondary.kz": 1.0}, condition="tare")
    assert soft.data.document["parameters"]["secondary.kz"] == 1.0
    assert toy.data.document["parameters"]["secondary.kz"] == 5.8e5


def test_a_report_folder_holds_the_cases_of_one_check(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    first = lmap.check("sway", report=folder)
    (folder / "cases" / "mine.json").write_text("{}", encoding="utf-8")
    second = lmap.check("sway", set={"run.speed_kmh": 90}, report=folder)
    hashes = {case.hash for case in second.specs[0].cases}
    assert hashes.isdisjoint(case.hash for case in first.specs[0].cases)
    assert {path.stem for path in (folder / "cases").iterdir()} == hashes | {"mine"}
