"""Bad input on the real core: one clear message with file, key and line, exit code 2, nothing written."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from commands import spoil

from lmap.errors import listed
from lmap.procedures import BY_NAME

pytestmark = pytest.mark.needs_core
ROOT = Path(__file__).parents[2]
SPEC = "specs/hunting.toml"
VEHICLE = "models/vehicles/coco134.toml"


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the project's models and specs, to be spoiled."""
    for folder in ("models", "specs"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def messages(place: Path, refused: Callable[..., list[str]]) -> Callable[..., list[str]]:
    """What a bad check says."""
    return lambda *arguments: refused("check", *arguments, "--report", "out")


def line_of(path: str, text: str) -> int:
    content = Path(path).read_text(encoding="utf-8")
    return content[: content.index(text)].count("\n") + 1


def test_a_missing_file(messages: Callable[..., list[str]]) -> None:
    assert messages("specs/hunt.toml") == [
        "lmap: specs/hunt.toml: found no such file; allowed: a spec file or folder"
    ]


def test_a_toml_syntax_error(messages: Callable[..., list[str]]) -> None:
    line = spoil(SPEC, "friction = 0.4", "friction = = 0.4")
    [message] = messages(SPEC)
    assert message.startswith(f"lmap: {SPEC}:{line}: found ")


def test_an_unknown_key_of_the_core_with_the_nearest_known_one(messages: Callable[..., list[str]]) -> None:
    line = spoil(SPEC, "output_step", "outputstep")
    found = messages(SPEC)
    assert any(
        message.startswith(f"lmap: {SPEC}:{line}: run.outputstep: found ")
        and 'mean "output_step"?' in message
        for message in found
    ), found


@pytest.mark.parametrize(
    ("key", "hint"),
    [("speed_khm", "speed_kmh"), ("controler", "controller"), ("wheel_profil", "wheel_profile")],
)
def test_an_unknown_key_of_a_run_offers_what_only_specs_have(
    messages: Callable[..., list[str]], key: str, hint: str
) -> None:
    [message] = messages(SPEC, "--set", f"run.{key}=3")
    assert message.startswith(
        f"lmap: {SPEC}: --set run.{key}: found an unknown key; allowed: contact, controller, "
    )
    assert ", speed_kmh, " in message
    assert message.endswith(f'(did you mean "{hint}"?)')


def test_an_unknown_key_of_the_run_of_one_case_of_a_spec(messages: Callable[..., list[str]]) -> None:
    line = spoil("specs/all_weather.toml", "run = { drive = {", "run = { controler = 3, drive = {")
    [message] = messages("specs/all_weather.toml")
    assert message.startswith(
        f"lmap: specs/all_weather.toml:{line}: test.case[1].run.controler: found an unknown key"
    )
    assert ", controller, " in message
    assert "speed_kmh" not in message
    assert message.endswith('(did you mean "controller"?)')


def test_an_unknown_key_inside_a_tagged_table(messages: Callable[..., list[str]]) -> None:
    line = spoil(SPEC, "seed = 1", "sede = 1")
    found = messages(SPEC)
    assert any(
        message.startswith(f"lmap: {SPEC}:{line}: track.irregularity.sede: found ") and "seed" in message
        for message in found
    ), found


def test_an_unknown_key_of_the_spec(messages: Callable[..., list[str]]) -> None:
    line = spoil(SPEC, "condition =", "conditon =")
    [message] = messages(SPEC)
    assert message.startswith(f'lmap: {SPEC}:{line}: conditon: found an unknown key "conditon"; allowed: ')
    assert message.endswith('(did you mean "condition"?)')


def test_a_negative_mass(messages: Callable[..., list[str]]) -> None:
    line = spoil(VEHICLE, "mass = 14860.0", "mass = -14860.0")
    [message] = messages(SPEC)
    assert message == (
        f"lmap: {VEHICLE}:{line}: parameters.bogie.mass: found -14860.0 (from $bogie.mass); "
        "allowed: a number > 0 kg"
    )


def test_a_negative_mass_that_is_set(messages: Callable[..., list[str]]) -> None:
    [message] = messages(SPEC, "--set", "bogie.mass=-3")
    assert message == (
        f"lmap: {SPEC}: --set bogie.mass: found -3 (from $bogie.mass); allowed: a number > 0 kg"
    )


def test_numbers_that_are_not_finite_are_named_where_they_stand_in_what_is_set(
    messages: Callable[..., list[str]],
) -> None:
    assert messages(SPEC, "--set", "run.friction={left=nan, right=0.4}", "--set", "secondary.kz=-inf") == [
        "lmap: --set run.friction.left: found NaN; allowed: a finite number",
        "lmap: --set secondary.kz: found -inf; allowed: a finite number",
    ]


def test_a_connection_to_a_body_that_does_not_exist(messages: Callable[..., list[str]]) -> None:
    line = spoil(VEHICLE, 'between = ["{bogie}", "carbody"]', 'between = ["{bogie}", "carbdoy"]')
    found = messages(SPEC)
    assert all(
        message.startswith(f"lmap: {VEHICLE}:{line}: ") and "carbdoy" in message for message in found
    ), found
    assert found
    assert all("carbody" in message for message in found), found


def test_a_profile_with_three_points(messages: Callable[..., list[str]]) -> None:
    profile = "models/profiles/anzr1_worn_1.csv"
    Path(profile).write_text("# three points\n-10.0,0.0\n0.0,0.0\n10.0,0.0\n", encoding="utf-8")
    [message] = messages(SPEC)
    assert message.startswith(f"lmap: {profile}: profiles.anzr1_worn_1")
    assert "3 points" in message


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ('speed = "110% design"', "speed = 0.0", "run.speed"),
        ('speed = "110% design"', "speed_kmh = 0", "run.speed_kmh"),
        ('speed = "110% design"', 'speed = "0% design"', "run.speed"),
    ],
)
def test_a_speed_of_zero(messages: Callable[..., list[str]], old: str, new: str, key: str) -> None:
    line = spoil(SPEC, old, new)
    [message] = messages(SPEC)
    assert message.startswith(f"lmap: {SPEC}:{line}: {key}: found ")
    assert "a number > 0" in message


@pytest.mark.parametrize(
    ("new", "said"),
    [
        (
            "speed = 250",
            "run.speed: found 250 m/s; allowed: at most 200 m/s, which is 720 km/h (250 km/h is 69.44 m/s)",
        ),
        ("speed_kmh = 1260", "run.speed_kmh: found 350 m/s; allowed: at most 200 m/s, which is 720 km/h"),
    ],
)
def test_a_speed_beyond_anything_on_rails(messages: Callable[..., list[str]], new: str, said: str) -> None:
    line = spoil(SPEC, 'speed = "110% design"', new)
    assert messages(SPEC) == [f"lmap: {SPEC}:{line}: {said}"]


def test_a_criterion_on_a_channel_that_does_not_exist(messages: Callable[..., list[str]]) -> None:
    line = spoil(SPEC, '"carbody.trail_pivot.ay"', '"carbody.trial_pivot.ay"')
    [message] = messages(SPEC)
    assert message == (
        f'lmap: {SPEC}:{line}: criterion[0].signal[1]: found "carbody.trial_pivot.ay"; allowed: a channel of the '
        'vehicle (`lmap channels VEHICLE` lists them) (did you mean "carbody.trail_pivot.ay"?)'
    )


def test_an_unknown_parameter_of_the_vehicle(messages: Callable[..., list[str]]) -> None:
    [message] = messages(SPEC, "--set", "secondry.kz=5e5")
    assert message.startswith(f"lmap: {SPEC}: --set secondry.kz: found ")
    assert "secondary.kz" in message


def test_a_unit_of_another_quantity(messages: Callable[..., list[str]]) -> None:
    spoil(SPEC, 'unit = "g"', 'unit = "mm"')
    [message] = messages(SPEC)
    assert message.startswith(
        f"lmap: {SPEC}:{line_of(SPEC, 'unit = ' + chr(34) + 'mm')}: criterion[0].unit: "
    )


@pytest.mark.slow
def test_every_message_of_several_specs(messages: Callable[..., list[str]]) -> None:
    shutil.copy(SPEC, "specs/other.toml")
    spoil(SPEC, "friction = 0.4", "friction = -0.4")
    spoil("specs/other.toml", 'procedure = "hunting"', 'procedure = "huntign"')
    found = messages("specs")
    assert [message.split(":")[1].strip() for message in found] == [SPEC, "specs/other.toml"]
    assert found[1].endswith(
        f'found "huntign"; allowed: {listed(sorted(BY_NAME), 40)} (did you mean "hunting"?)'
    )


STEP, PUSH, RAMP = "specs/step.toml", "specs/vertical_push.toml", "specs/critical_speed.toml"
STAGE_1 = [
    # spec, what is written, what stands there instead, start and parts of the message
    (STEP, '"carbody.z" = -0.02', '"carbody.q" = -0.02', "run.disturbance", ["`carbody.q`", "x, y, z, phi"]),
    (STEP, '"carbody.z" = -0.02', '"carbody.z" = "x"', "run.disturbance", ['found "x"', "a number"]),
    (STEP, "band = 0.001", "bend = 0.001", "test.bend", ['"bend"', 'mean "band"?']),
    (STEP, "band = 0.001", "band = 1.5", "test.band", ["found 1.5", "< 1"]),
    (STEP, "residual_s = 10.0", "", "test.residual_s", ["found nothing"]),
    (STEP, "step = 0.005", "step = -1", "run.integrator[1].step", ["found -1", "above 0"]),
    (STEP, "step = 0.005", "steps = 0.005", "run.integrator[1].steps", ["unknown key", "step"]),
    (STEP, '{ kind = "ros2", step = 0.005 }', "3", "run.integrator[1]", ["found 3", "kind"]),
    (PUSH, '"carbody.z"', '"carbody.theta"', "run.load", ["no displacement", "y or z of a body"]),
    (PUSH, '"carbody.z"', '"carbdoy.z"', "run.load[0].coordinate", ["`carbdoy.z`", "carbody"]),
    (PUSH, "path = [0.0, 0.05]", "path = []", "run.load[0].path", ["found"]),
    (RAMP, 'disturbance = { "carbody.y" = 0.02 }', "", "run.disturbance", ["found nothing", "carbody.y"]),
    (
        RAMP,
        "[run.search.hunting]",
        "disturbance = {}\n[run.search.hunting]",
        "run.search.disturbance",
        ["unknown"],
    ),
    (RAMP, "speed_kmh = 250.0", "speed_kmh = 0.0", "test.beside.bifurcation.speed_kmh", ["found 0", "> 0"]),
    (RAMP, "end_speed = 44.4", "end_speed = 4444.4", "test.beside.bifurcation.search.end_speed", ["below"]),
    (RAMP, "spacing = 10.0", "spacing = -1", "test.beside.linear.search.spacing", ["found -1", "> 0"]),
    (RAMP, "[test.beside.linear]", "[test.besides.linear]", "test.besides", ['mean "beside"?']),
]


@pytest.mark.parametrize(
    ("spec", "old", "new", "key", "parts"), STAGE_1, ids=[f"{Path(row[0]).stem}-{row[3]}" for row in STAGE_1]
)
def test_faults_of_stage_1(
    messages: Callable[..., list[str]], spec: str, old: str, new: str, key: str, parts: list[str]
) -> None:
    spoil(spec, old, new)
    found = messages(spec)
    wanted = [line for line in found if line.startswith(f"lmap: {spec}:") and f": {key}" in line]
    assert wanted, found
    assert all(part in wanted[0] for part in parts), found


TRACTION = {
    "a curve that goes back": (
        "notches = 8",
        "notches = 1\nnotch_curves = [[[5.0, 4.5e5], [3.0, 2.0e5]]]",
        "traction.notch_curves[0][1][0]: found 3 m/s",
    ),
    "a curve of one point": (
        "notches = 8",
        "notches = 1\nnotch_curves = [[]]",
        "traction.notch_curves[0]",
    ),
    "a point of one number": (
        "notches = 8",
        "notches = 1\nnotch_curves = [[[0.0], [3.0, 2.0e5]]]",
        "traction.notch_curves[0][0]",
    ),
    "a negative effort": (
        "notches = 8",
        "notches = 1\nnotch_curves = [[[0.0, 4.5e5], [3.0, -2.0e5]]]",
        "traction.notch_curves[0][1][1]: found -200000 N",
    ),
    "no list": ("notches = 8", 'notches = 8\nnotch_curves = "steep"', "traction.notch_curves"),
    "too few curves": (
        "notches = 8",
        "notches = 8\nnotch_curves = [[[0.0, 4.5e5], [3.0, 2.0e5]]]",
        "traction.notch_curves: found 1 curves",
    ),
    "a negative power": ("power_at_rail = 2.6e6", "power_at_rail = -2.6e6", "power_at_rail"),
    "a negative starting effort": ("max_effort = 450.0e3", "max_effort = -450.0e3", "max_effort"),
    "a negative continuous rating": (
        "notches = 8",
        "notches = 8\nthermal = { continuous_effort = -3e5, short_time_effort = 4e5, short_time = 600.0 }",
        "traction.thermal.continuous_effort: found -300000",
    ),
    "a short-time rating below the continuous one": (
        "notches = 8",
        "notches = 8\nthermal = { continuous_effort = 3e5, short_time_effort = 2e5, short_time = 600.0 }",
        "traction.thermal.short_time_effort: found 200000 N",
    ),
    "a negative short time": (
        "notches = 8",
        "notches = 8\nthermal = { continuous_effort = 3e5, short_time_effort = 4e5, short_time = -600.0 }",
        "traction.thermal.short_time: found -600",
    ),
}


@pytest.mark.parametrize("what", TRACTION)
def test_traction_data_that_are_none_are_one_message(what: str, messages: Callable[..., list[str]]) -> None:
    old, new, expected = TRACTION[what]
    spoil(VEHICLE, old, new)
    [message] = messages("specs/effort_speed.toml")
    assert message.startswith(f"lmap: {VEHICLE}:"), message
    assert expected in message
