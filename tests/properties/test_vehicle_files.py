"""No damage to a vehicle file gives anything but a vehicle or messages: no panic, no traceback, no hang, no NaN."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest
from damage import damaged, places, runs_or_is_refused
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lmap import toml

pytestmark = pytest.mark.needs_core
ROOT = Path(__file__).parents[2]
NAMES = ["bobo86", "manchester1", "suspended_wheelset", "wagon2"]
WORDS = [
    "line",
    "x",
    "z",
    "both",
    "pchip",
    "friction",
    "maxwell",
    "bushing",
    "bump_stop",
    "$leaf.kz",
    "{axle}",
    "",
    "body",
]


def document(name: str) -> dict[str, Any]:
    text = (ROOT / f"models/vehicles/{name}.toml").read_text(encoding="utf-8")
    return toml.loads(text)


def profile(name: str, kind: str) -> dict[str, Any]:
    text = (ROOT / f"models/profiles/{name}.csv").read_text(encoding="utf-8")
    return {"kind": kind, **json.loads(toml.core().read_profile(text, name))}


DATA = {name: document(name) for name in NAMES}
PLACES = {name: places(DATA[name]) for name in NAMES}
TRACK = toml.loads((ROOT / "models/tracks/plain_1435_as60.toml").read_text(encoding="utf-8")) | {
    "length": 100.0
}
PROFILES = {"s1002": profile("s1002", "wheel"), "as60": profile("as60", "rail")}
STEPPED = {
    "kind": "time",
    "speed": 20.0,
    "integrator": {"kind": "heun", "step": 0.0004},
    "output_step": 0.004,
}


def case(vehicle: Any, condition: str, run: dict[str, Any]) -> dict[str, Any]:
    return {
        "format": 1,
        "label": "damaged",
        "vehicle": vehicle,
        "condition": condition,
        "track": TRACK,
        "run": {"friction": 0.3, "wheel_profile": "s1002", **run},
        "profiles": PROFILES,
    }


def resolved(vehicle: Any) -> dict[str, Any] | None:
    """What the core reads out of a vehicle; nothing where it is refused with messages."""
    railsim = toml.core()
    try:
        summary: dict[str, Any] = json.loads(railsim.vehicle_resolve(json.dumps(vehicle), "{}", None))
    except railsim.InputError as error:
        if not error.faults:
            raise
        return None
    assert math.isfinite(summary["mass"])
    return summary


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(data=st.data(), name=st.sampled_from(NAMES))
def test_a_damaged_vehicle_is_a_vehicle_or_refused(data: st.DataObject, name: str) -> None:
    railsim = toml.core()
    spoiled = damaged(data, DATA[name], PLACES[name], WORDS)
    summary = resolved(spoiled)
    if summary is None:
        return
    try:
        # compiles the model: ends, preloads, geometry
        channels = railsim.channels(json.dumps(case(spoiled, summary["design_condition"], STEPPED)))
    except railsim.RailsimError:
        return
    assert len({name for name, *_ in channels}) == len(channels)


@pytest.mark.slow
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    data=st.data(),
    name=st.sampled_from(NAMES),
    run=st.sampled_from(
        [
            {"kind": "equilibrium", "speed": 0.0},
            {"kind": "equilibrium", "speed": 20.0},
            {"kind": "modal", "speed": 0.0},
        ]
    ),
)
def test_a_damaged_vehicle_stands_or_is_refused(data: st.DataObject, name: str, run: dict[str, Any]) -> None:
    spoiled = damaged(data, DATA[name], PLACES[name], WORDS)
    summary = resolved(spoiled)
    if summary is not None:
        runs_or_is_refused(case(spoiled, summary["design_condition"], run))
