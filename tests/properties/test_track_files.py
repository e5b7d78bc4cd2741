"""No damage to a track file gives anything but a run or messages: no panic, no traceback, no hang, no NaN."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from damage import damaged, places, runs_or_is_refused
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lmap import toml

pytestmark = [pytest.mark.needs_core, pytest.mark.slow]
ROOT = Path(__file__).parents[2]


def profile(name: str, kind: str) -> dict[str, Any]:
    text = (ROOT / f"models/profiles/{name}.csv").read_text(encoding="utf-8")
    return {"kind": kind, **json.loads(toml.core().read_profile(text, name))}


BASE = toml.loads((ROOT / "models/tracks/plain_1435_as60.toml").read_text(encoding="utf-8"))
VEHICLE = toml.loads((ROOT / "models/vehicles/suspended_wheelset.toml").read_text(encoding="utf-8"))
PROFILES = {"s1002": profile("s1002", "wheel"), "as60": profile("as60", "rail")}
CURVED = BASE | {
    "length": 60.0,
    "layout": [
        {"kind": "tangent", "length": 20.0},
        {"kind": "clothoid", "length": 15.0},
        {"kind": "curve", "length": 15.0, "radius": 600.0, "cant_mm": 60.0},
        {"kind": "clothoid", "length": 10.0},
    ],
}
ROUGH = BASE | {
    "length": 30.0,
    "fade_in": 10.0,
    "irregularity": [
        {
            "kind": "psd",
            "form": "fra_hamid_yang",
            "class": 6,
            "wavelengths": [1.5, 40.0],
            "seed": 1,
            "period": 100.0,
        },
        {
            "kind": "psd",
            "form": "erri",
            "level": "low",
            "wavelengths": [3.0, 30.0],
            "seed": 2,
            "period": 90.0,
        },
        {
            "kind": "shape",
            "shape": "versine",
            "channel": "vertical",
            "start": 15.0,
            "length": 5.0,
            "height": 0.01,
        },
    ],
}
PASSING = BASE | {
    "length": 70.0,
    "layout": [
        {"kind": "tangent", "length": 15.0},
        {"kind": "cubic_parabola", "length": 10.0},
        {"kind": "curve", "length": 10.0, "radius": -600.0, "widening_mm": 4.0},
        {"kind": "bloss", "length": 10.0},
        {"kind": "tangent", "length": 5.0, "gradient": 0.01},
        {"kind": "helmert", "length": 10.0},
        {"kind": "tangent", "length": 10.0},
    ],
}
SHAPES = [
    {"shape": "flat_hump", "channel": "gauge", "start": 12.0, "length": 14.0, "rise": 2.0, "height": 0.002},
    {
        "shape": "kink",
        "channel": "left_lateral",
        "start": 12.0,
        "length": 8.0,
        "height": 0.002,
        "rounding": 1.0,
    },
    {
        "shape": "dipped_weld",
        "channel": "right_vertical",
        "start": 20.0,
        "length": 2.0,
        "dip_angle": 0.002,
        "rounding": 0.2,
    },
    {
        "shape": "rectified_sine",
        "channel": "vertical",
        "start": 12.0,
        "length": 6.0,
        "height": 0.002,
        "waves": 2,
    },
]
OWN = BASE | {
    "length": 30.0,
    "fade_in": 10.0,
    "irregularity": [
        *({"kind": "shape"} | shape for shape in SHAPES),
        {
            "kind": "psd",
            "form": "table",
            "density": {"vertical": [[0.01, 1e-5], [0.1, 1e-7], [1.0, 1e-10]]},
            "wavelengths": [1.5, 40.0],
            "seed": 1,
            "period": 100.0,
        },
        {
            "kind": "measured",
            "file": "line.csv",
            "text": "s_m,vertical_mm,left_lateral_mm\n0,0,0\n10,1,0.5\n20,-1,0\n31,0,0.2\n40,0,0\n",
            "repeat_blend": 10.0,
        },
    ],
}
TRACKS = {"curved": CURVED, "rough": ROUGH, "passing": PASSING, "own": OWN}
PLACES = {name: places(track) for name, track in TRACKS.items()}
WORDS = [
    "as60",
    "clothoid",
    "cross_level",
    "cubic_parabola",
    "curve",
    "erri",
    "flat_hump",
    "fra_hamid_yang",
    "high",
    "kink",
    "left_lateral",
    "measured",
    "psd",
    "rigid",
    "shape",
    "s_m,vertical_mm\n0,1\n",
    "sine",
    "table",
    "tangent",
    "",
]


def case(track: Any, run: dict[str, Any]) -> dict[str, Any]:
    return {
        "format": 1,
        "label": "damaged",
        "vehicle": VEHICLE,
        "condition": "textbook",
        "track": track,
        "run": {"friction": 0.3, "wheel_profile": "s1002", **run},
        "profiles": PROFILES,
    }


RUN = {"kind": "time", "speed": 20.0, "integrator": {"kind": "ros2", "step": 0.001}, "output_step": 0.01}


@pytest.mark.parametrize("name", TRACKS)
def test_the_good_track_runs(name: str) -> None:
    assert runs_or_is_refused(case(TRACKS[name], RUN))


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(data=st.data(), name=st.sampled_from(sorted(TRACKS)))
def test_a_damaged_track_is_run_or_refused(data: st.DataObject, name: str) -> None:
    track = damaged(data, TRACKS[name], PLACES[name], WORDS)
    length = track.get("length") if isinstance(track, dict) else None
    whole = case(track, RUN)
    if isinstance(length, int | float) and length > 200.0:
        # to its end it would run for long, as it should: asked for is what can be said of it before
        railsim = toml.core()
        try:
            railsim.check_case(json.dumps(whole))
            railsim.track_extremes(json.dumps(whole))
        except railsim.RailsimError:
            pass
        return
    runs_or_is_refused(whole)
