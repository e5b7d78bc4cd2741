"""Specs, overrides and cases, on the stand-in core."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from lmap.errors import InputProblem
from lmap.spec import overrides
from lmap.spec.case import Case, VehicleData, build, merged
from lmap.spec.load import load
from lmap.spec.model import RunPart

pytestmark = pytest.mark.usefixtures("toy")

SWAY = Path("specs/sway.toml")


def problems(text: str, **settings: Any) -> list[str]:
    """Messages about a spec, without the file's name."""
    path = Path("specs/bad.toml")
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputProblem) as caught:
        load(path, settings)
    return [str(problem).removeprefix("specs/bad.toml:") for problem in caught.value.problems]


def edited(old: str, new: str) -> str:
    text = SWAY.read_text(encoding="utf-8")
    assert old in text
    return text.replace(old, new, 1)


# ---- faults of a spec


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            'vehicle = "toy"',
            'vehicel = "toy"',
            (
                '4: vehicel: found an unknown key "vehicel"; allowed: assumed, condition, criterion, id, procedure, '
                'run, set, sign_off, test, title, track, vehicle (did you mean "vehicle"?)'
            ),
        ),
        (
            'speed = "110% design"',
            "speed = 0.0",
            '12: run.speed: found 0.0; allowed: a number > 0 (m/s), "110% design", or a list of these',
        ),
        (
            'speed = "110% design"',
            "speed_kmh = [10, 0]",
            "12: run.speed_kmh: found [10, 0]; allowed: a number > 0 (km/h), or a list of these",
        ),
        ("friction = 0.4", "friction = true", "13: run.friction: found true; allowed: a number"),
        ("friction = 0.4", 'friction = "0.3"', '13: run.friction: found "0.3"; allowed: a number'),
        ("max_abs = 0.35", "max_abs = true", "22: criterion[0].max_abs: found true; allowed: a number"),
        (
            'speed = "110% design"',
            'speed = "fast"',
            '12: run.speed: found "fast"; allowed: a number > 0 (m/s), "110% design", or a list of these',
        ),
        ("friction = 0.4", "friction = -0.4", "13: run.friction: found -0.4; allowed: a number >= 0"),
        ("friction = 0.4", "friction = nan", "13: run.friction: found NaN; allowed: a finite number"),
        (
            "max_abs = 0.35",
            "max_asb = 0.35",
            (
                '22: criterion[0].max_asb: found an unknown key "max_asb"; allowed: case, chain, max, max_abs, min, '
                'name, needs, published, reason, signal, source, strict, unit (did you mean "max_abs"?)'
            ),
        ),
        (
            "window_s = 5.0",
            'window_s = "5 s"',
            '20: criterion[0].chain[1].average_peak.window_s: found "5 s"; allowed: a number',
        ),
        ('name = "wheel L/V"', 'name = "lateral acceleration"', None),
    ],
)
def test_faults_name_line_key_found_and_allowed(old: str, new: str, message: str | None) -> None:
    found = problems(edited(old, new))
    if message is None:
        message = '28: criterion[1].name: found "lateral acceleration" again; allowed: a name of its own'
    assert message in found


def test_all_faults_of_a_spec_are_found_at_once() -> None:
    text = edited("friction = 0.4", "friction = -0.4").replace('"110% design"', "0").replace("id =", "idd =")
    assert len(problems(text)) == 4


def test_both_speeds_are_refused() -> None:
    [message] = problems(edited("friction = 0.4", "speed_kmh = 100.0"))
    assert message.endswith("allowed: one of speed and speed_kmh")


# ---- overrides


def test_settings_are_numbers_texts_lists_and_tables() -> None:
    parsed = overrides.parse(["a.b=5e5", "run.speed=110% design", "c=[1, 2]", "d = true", "e=x=y"])
    assert parsed == {"a.b": 5e5, "run.speed": "110% design", "c": [1, 2], "d": True, "e": "x=y"}


@pytest.mark.parametrize("bad", ["a", "=3", "a=", ""])
def test_a_setting_without_key_or_value_is_refused(bad: str) -> None:
    with pytest.raises(InputProblem, match="KEY=VALUE"):
        overrides.parse([bad])


@pytest.mark.parametrize(
    "settings",
    [
        ["a.b=1", "a.b=2"],
        ["a.b=1", " a.b = 1"],
        ["run.speed=3", "run.speed_kmh=9"],
        ["run.speed_kmh=9", "run.speed=3"],
    ],
)
def test_a_key_that_is_set_twice_is_refused(settings: list[str]) -> None:
    with pytest.raises(InputProblem, match=r"^--set: found .* after .*; allowed: each key once"):
        overrides.parse(settings)


def test_two_ways_of_writing_the_speed_are_refused() -> None:
    with pytest.raises(InputProblem, match=r"run\.speed.*run\.speed_kmh"):
        overrides.checked({"run.speed": 30.0, "run.speed_kmh": 100.0})
    assert overrides.checked({"run.speed_kmh": 100.0}) == {"run.speed_kmh": 100.0}


@pytest.mark.parametrize(
    ("setting", "messages"),
    [
        ("a=nan", ["--set a: found NaN"]),
        ("run.friction={left=nan, right=0.4}", ["--set run.friction.left: found NaN"]),
        ("a.b=[1, {c=-inf}, inf]", ["--set a.b[1].c: found -inf", "--set a.b[2]: found inf"]),
    ],
)
def test_a_setting_that_is_not_finite_is_refused_where_it_stands(setting: str, messages: list[str]) -> None:
    with pytest.raises(InputProblem) as raised:
        overrides.parse([setting])
    assert str(raised.value).splitlines() == [f"{one}; allowed: a finite number" for one in messages]


def test_four_names_mean_the_spec_and_all_others_the_vehicle() -> None:
    own, parameters = overrides.split({"run.speed": 1, "condition": 2, "secondary.kz": 3, "runner.k": 4})
    assert own == {"run.speed": 1, "condition": 2}
    assert parameters == {"secondary.kz": 3, "runner.k": 4}


@pytest.mark.parametrize(("key", "other"), [("speed", "speed_kmh"), ("speed_kmh", "speed")])
def test_one_way_to_write_the_speed_replaces_the_other(key: str, other: str) -> None:
    document, faults = overrides.apply({"run": {other: 1.0, "friction": 0.4}}, {f"run.{key}": 2.0})
    assert document == {"run": {key: 2.0, "friction": 0.4}}
    assert not faults


def test_the_callers_settings_win_over_the_files() -> None:
    text = SWAY.read_text(encoding="utf-8") + '\n[set]\n"run.speed" = 10.0\n"secondary.kz" = 1.0\n'
    path = Path("specs/with_set.toml")
    path.write_text(text, encoding="utf-8")
    loaded = load(path, {"run.speed_kmh": 72.0})
    assert loaded.spec.run.speeds is not None
    assert [speed.resolve(99.0) for speed in loaded.spec.run.speeds] == [20.0]
    assert loaded.parameters == {"secondary.kz": 1.0}


def test_overriding_does_not_change_the_document() -> None:
    document = {"run": {"speed": 1.0}}
    overrides.apply(document, {"run.speed": 2.0, "track.length": 3.0})
    assert document == {"run": {"speed": 1.0}}


@pytest.mark.parametrize("key", ["vehicle.mass", "condition.tare", "track", "run", "run."])
def test_keys_that_are_neither_are_refused(key: str) -> None:
    _, faults = overrides.apply({}, {key: 1.0})
    assert [fault.key for fault in faults] == [("set", key)]


def test_a_fault_of_a_setting_names_its_origin() -> None:
    text = SWAY.read_text(encoding="utf-8")
    settings = {"run.speed": 0}
    assert problems(text, **settings)[0].startswith(" --set run.speed: found 0;")
    line = text.count("\n") + 3
    [message] = problems(text + '\n[set]\n"run.speed" = 0\n')
    assert message.startswith(f'{line}: set."run.speed": found 0;')


# ---- run


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ({"speed": "110% design"}, [11.0]),
        ({"speed": ["20 % design", "100% design"]}, [2.0, 10.0]),
        ({"speed": 7}, [7.0]),
        ({"speed_kmh": [36, 18.0]}, [10.0, 5.0]),
    ],
)
def test_speeds_resolve_to_metres_per_second(written: dict[str, Any], expected: list[float]) -> None:
    speeds = RunPart.model_validate(written).speeds
    assert speeds is not None
    assert [speed.resolve(10.0) for speed in speeds] == pytest.approx(expected)


def test_what_procedures_do_not_expand_goes_through() -> None:
    part = RunPart.model_validate(
        {"speed": 1.0, "integrator": {"kind": "heun", "step": 1e-3}, "friction": 0.3}
    )
    assert part.rest == {"integrator": {"kind": "heun", "step": 1e-3}, "friction": 0.3}


# ---- cases


def vehicle() -> VehicleData:
    return VehicleData(
        file="toy.toml",
        document={"name": "toy"},
        name="toy",
        title="Toy",
        design_speed=30.0,
        wheel_radius=0.5,
        wheel_profile="round",
        track=None,
        condition="tare",
        conditions=("tare",),
        design_condition="full",
        mass=1.0,
        bodies=(),
    )


def test_the_hash_is_that_of_the_sorted_json_and_knows_no_order() -> None:
    one = Case("x", {"b": 1.0, "a": {"d": 2, "c": 3}})
    other = Case("x", {"a": {"c": 3, "d": 2}, "b": 1.0})
    assert one.json == '{"a":{"c":3,"d":2},"b":1.0}'
    assert one.hash == other.hash
    assert len(one.hash) == 64


def test_a_case_round_trips_through_its_json() -> None:
    case = build(label="x", vehicle=vehicle(), track={"length": 0.1 + 0.2}, run={"speed": 35.13888888888889})
    assert Case("x", json.loads(case.json)).hash == case.hash


def test_a_case_does_not_hold_nan() -> None:
    with pytest.raises(ValueError, match="not JSON compliant"):
        _ = Case("x", {"a": float("nan")}).json


def test_a_case_takes_only_the_profiles_that_it_names() -> None:
    case = build(label="x", vehicle=vehicle(), track={"rail_profile": "flat"}, run={"wheel_profile": "round"})
    assert list(case.with_profiles({"flat": 1, "round": 2, "worn": 3}).data["profiles"]) == ["flat", "round"]


def test_the_spec_is_laid_over_the_base_track() -> None:
    base = {"length": 1.0, "support": {"mass": 1.0, "ky": 2.0}, "irregularity": {"kind": "psd", "class": 6}}
    over = {"length": 2.0, "support": {"ky": 3.0}, "irregularity": {"kind": "bump", "height": 1.0}}
    assert merged(base, over) == {
        "length": 2.0,
        "support": {"mass": 1.0, "ky": 3.0},
        "irregularity": {"kind": "bump", "height": 1.0},
    }
    assert base["length"] == 1.0


# ---- a variant: another spec with some keys set otherwise


def variant(text: str) -> Path:
    path = Path("twins/sway.toml")
    path.parent.mkdir(exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


def test_a_variant_is_the_spec_that_it_names_with_its_keys_set() -> None:
    found = load(
        variant('spec = "sway"\nmust_fail = "wheel L/V"\n[set]\n"run.speed_kmh" = 200\n"a.b" = 1.0\n')
    )
    speeds = found.spec.run.speeds
    assert speeds is not None
    assert speeds[0].resolve(1.0) == pytest.approx(200 / 3.6)
    assert found.parameters == {"a.b": 1.0}
    assert found.asked.shown == "twins/sway.toml"
    assert found.document.shown == "specs/sway.toml"


def test_a_caller_sets_over_a_variant() -> None:
    path = variant('spec = "sway"\n[set]\n"run.speed_kmh" = 200\n')
    speeds = load(path, {"run.speed": 10.0}).spec.run.speeds
    assert speeds is not None
    assert speeds[0].resolve(1.0) == 10.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('spec = "swey"', 'twins/sway.toml:1: spec: found "swey"; .*did you mean "sway"'),
        ('spec = "sway"\ntitel = "x"', 'twins/sway.toml:2: titel: found an unknown key "titel"'),
        ('spec = "sway"\nset = 3', "twins/sway.toml:2: set: found no table"),
        ("spec = 3", "twins/sway.toml:1: spec: found 3"),
        ('spec = "./sway.toml"', "twins/sway.toml:1: spec: found .*, a variant itself"),
        (
            'spec = "sway"\n[set]\n"run.friction" = -1.0',
            'twins/sway.toml:3: set."?run.friction"?: found -1.0',
        ),
    ],
)
def test_faults_of_a_variant_name_its_own_lines(text: str, message: str) -> None:
    with pytest.raises(InputProblem, match=message):
        load(variant(text))
