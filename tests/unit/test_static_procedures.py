"""Parts of the static procedures: paths, averages, bad input."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from lmap.errors import InputProblem
from lmap.prepare import prepare
from lmap.procedures import sway, twist


def settings(**other: object) -> twist.Settings:
    written = {
        "twist_body": "EN 14363",
        "twist_bogie": "EN 14363",
        "loops": ["axle"],
        "steps": 2,
        "beyond": 0.5,
    }
    return twist.Settings.model_validate(written | other)


def test_the_path_of_a_twist_goes_beyond_to_both_sides_and_up_again() -> None:
    up_and_down = [0, 0.5, 1, 1.5, 1, 0.5, 0, -0.5, -1, -1.5, -1, -0.5, 0, 0.5, 1, 1.5]
    assert twist.levels(settings()) == up_and_down


def test_friction_is_averaged_out() -> None:
    """A line with a friction of 0.2 about it: rising branches above, falling ones below, the first in between."""
    levels = twist.levels(settings())
    values = [level + (0.2 if k >= 10 or k in (3, 9) else -0.2) for k, level in enumerate(levels)]
    values[0:3] = levels[0:3]
    mean = twist.averaged(values, 2)
    for k, level in enumerate(levels):
        assert mean[k] == pytest.approx(max(-1.0, min(1.0, level)))


def test_any_deficiency_within_the_bounds_has_a_cant_that_leaves_it() -> None:
    speed, radius, gravity = 32.0, 800.0, 9.80665
    low, high = sway.deficiencies(speed, radius, gravity)
    assert sway.cant_for(speed, radius, low, gravity) == pytest.approx(0.3)
    assert sway.cant_for(speed, radius, high, gravity) == pytest.approx(-0.3)
    cant = sway.cant_for(speed, radius, 0.11, gravity)
    left = speed**2 / radius * math.cos(math.asin(cant / 1.5)) - gravity * cant / 1.5
    assert left == pytest.approx(gravity * 0.11 / 1.5)


def test_the_steps_of_the_rig() -> None:
    outline = {
        "name": "x",
        "title": "x",
        "source": "assumed",
        "static": [(1, -1), (1, -2)],
        "kinematic": [(1, -1), (1, -2)],
    }
    test = sway.Settings.model_validate(
        {
            "where": "rig",
            "outline": outline,
            "load_case": [{"label": "x"}],
            "cant_mm": 20.0,
            "step_mm": 10.0,
        }
    )
    assert sway.tilts(test) == [0, 0.01, 0.02, 0.01, 0, -0.01, -0.02, -0.01, 0]


ROOT = Path(__file__).resolve().parents[2]


def _curve(**other: float) -> dict[str, float]:
    return {"radius_m": 300.0, "cant_mm": 0.0, "unbalanced": 0.7} | other


@pytest.mark.needs_core
@pytest.mark.parametrize(
    ("spec", "settings_", "message"),
    [
        (
            "sway_rig",
            {"test.outline": "nowhere"},
            'test.outline: found "nowhere"; allowed: a reference outline',
        ),
        ("sway_rig", {"test.cant": 100.0}, "test.cant: found an unknown key.*cant_mm"),
        ("sway_curve", {"test.radius": -1.0}, "test.radius: found -1"),
        ("sway_curve", {"test.deficiencies_mm": []}, "allowed: radius and deficiencies_mm"),
        ("heights", {"test.load_case": [{"label": "x", "spring_set": {"foo*": 0.01}}]}, 'found "foo\\*"'),
        ("heights", {"test.load_case": [{"label": "x", "condition": "no"}]}, "a condition of the vehicle"),
        (
            "p2",
            {"test.track_damping": 55.4e6},
            "test.track_damping: found 5.54e.07 N s/m; allowed: less than",
        ),
        ("coupler_forces", {"test.wheels_that_share": 7}, "test.wheels_that_share: found 7; allowed: 1 to 6"),
        ("coupler_forces", {"test.radius": 5.0}, "coupler_forces.toml.*test.radius: found 5; allowed: 10 m"),
        ("bogie_rotation", {"test.radius": 6.0}, "bogie_rotation.toml.*test.radius: found 6"),
        (
            "bogie_rotation",
            {"test.conditions": ["half"]},
            'test.conditions: found "half"; allowed: a condition',
        ),
        ("sway_rig", {"test.step_mm": 1e-5}, "at most 100 steps"),
        ("sway_rig", {"test.cant_mm": 1600.0}, "test.cant_mm: found 1600"),
        (
            "sway_curve",
            {"test.deficiencies_mm": [3000.0]},
            "test.deficiencies_mm.0: found 3000 mm; allowed: -109 to",
        ),
        ("rollover", {"test.curves": [_curve(cant_mm=1600.0)]}, "test.curves.0.cant_mm: found 1600"),
        (
            "rollover",
            {"test.curves": [_curve(radius_m=2.0)]},
            "test.curves.0.radius_m: found 2; allowed: 10 m",
        ),
        (
            "rollover",
            {"test.curves": [_curve(radius_m=1e300, unbalanced=1e10)]},
            "test.curves.0.radius_m: found 1e.300",
        ),
        ("rollover", {"test.transition_m": 1e9}, "rollover.toml.*test.transition_m"),
        ("rollover", {"track.length": 50.0}, "track.length: found a length; allowed: none"),
        ("flat_hump", {"track.length": 0}, "track.length: found 0; allowed: none beside test.end"),
        ("flat_hump", {"run.start": 5.0}, "run.start: found 5.0; allowed: none beside test.start"),
        ("twist", {"vehicle": "wagon2", "condition": "loaded"}, "wagon2"),
        ("twist", {"run.speed_kmh": [1.0, 2.0]}, "allowed: one speed"),
        ("twist", {"test.loops": ["all"]}, "test.loops"),
        ("p2", {"test.dip_angle": -0.01}, "test.dip_angle"),
        ("axle_loads", {"test.worn": 1.0}, "worn_diameter"),
        ("coupler_forces", {"test.ways": []}, "ways or stepped"),
        ("coupler_forces", {"test.stepped": [{"label": "x"}]}, "shank"),
        ("coupler_forces_run", {"test.shank": 0.0}, "test.shank: found 0"),
        (
            "coupler_forces_run",
            {"test.shank": 750.0},
            "test.shank: found 750 m; allowed: below half the length",
        ),
        ("small_curve", {"run.couplers.shank": 750.0}, "run.couplers.shank: found 750 m"),
        ("small_curve", {"run.couplers": {"shank": 0.8, "front": [[0.0, 1e5]]}}, "front.*beside run.drive"),
        ("small_curve", {"vehicle": "wagon2"}, "run.couplers: found it with a vehicle without"),
    ],
)
def test_bad_input_is_one_message_each(
    spec: str, settings_: dict[str, Any], message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    with pytest.raises(InputProblem, match=message):
        prepare(ROOT / "specs" / f"{spec}.toml", settings_)
