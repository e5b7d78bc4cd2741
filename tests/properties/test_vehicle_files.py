"""No damage to a vehicle file gives anything but a vehicle or messages: no panic, no traceback, no NaN."""

from __future__ import annotations

import copy
import json
import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lmap import toml

pytestmark = pytest.mark.needs_core
ROOT = Path(__file__).parents[2]
NAMES = ["bobo86", "manchester1", "suspended_wheelset", "wagon2"]


def document(name: str) -> dict[str, Any]:
    text = (ROOT / f"models/vehicles/{name}.toml").read_text(encoding="utf-8")
    return toml.loads(text)


def places(node: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    found = [at] if at else []
    if isinstance(node, dict):
        for key, value in node.items():
            found += places(value, (*at, key))
    elif isinstance(node, list):
        for index, value in enumerate(node):
            found += places(value, (*at, index))
    return found


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
VALUES = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False),
    st.sampled_from(
        [
            0,
            -1,
            1,
            1e-300,
            1e300,
            -0.0,
            True,
            None,
            [],
            {},
            [0.0],
            [[0.0, 0.0, 0.0]],
            {"x": [0, 1], "f": [0, 1]},
        ]
    ),
    st.sampled_from(WORDS),
    st.integers(-(2**53), 2**53),
)
DATA = {name: document(name) for name in NAMES}
PLACES = {name: places(DATA[name]) for name in NAMES}


@settings(max_examples=150, deadline=None)
@given(data=st.data(), name=st.sampled_from(NAMES))
def test_a_damaged_vehicle_is_a_vehicle_or_refused(data: st.DataObject, name: str) -> None:
    railsim = toml.core()
    spoiled = copy.deepcopy(DATA[name])
    for _ in range(data.draw(st.integers(1, 3))):
        *path, last = data.draw(st.sampled_from(PLACES[name]))
        node: Any = spoiled
        try:
            for step in path:
                node = node[step]
            if data.draw(st.booleans()):
                node[last] = data.draw(VALUES)
            else:
                del node[last]
        except (KeyError, IndexError, TypeError):
            continue
    try:
        summary = json.loads(railsim.vehicle_resolve(json.dumps(spoiled), "{}", None))
    except railsim.InputError as error:
        if not error.faults:
            raise
        return
    assert math.isfinite(summary["mass"])
    case = {
        "format": 1,
        "label": "damaged",
        "vehicle": spoiled,
        "condition": summary["design_condition"],
        "track": TRACK,
        "run": RUN,
        "profiles": PROFILES,
    }
    try:
        # compiles the model: ends, preloads, geometry
        channels = railsim.channels(json.dumps(case))
    except railsim.RailsimError:
        return
    assert len({name for name, *_ in channels}) == len(channels)


def _profile(name: str, kind: str) -> dict[str, Any]:
    text = (ROOT / f"models/profiles/{name}.csv").read_text(encoding="utf-8")
    return {"kind": kind, **json.loads(toml.core().read_profile(text, name))}


TRACK = toml.loads((ROOT / "models/tracks/plain_1435_as60.toml").read_text(encoding="utf-8")) | {
    "length": 100.0
}
PROFILES = {"s1002": _profile("s1002", "wheel"), "as60": _profile("as60", "rail")}
RUN = {
    "kind": "time",
    "speed": 20.0,
    "friction": 0.3,
    "wheel_profile": "s1002",
    "integrator": {"kind": "heun", "step": 0.0004},
    "output_step": 0.004,
}
