"""Stage 1 of the reference locomotive beside the paper and beside closed forms."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import lmap

pytestmark = [pytest.mark.needs_core, pytest.mark.slow]
ROOT = Path(__file__).parents[2]

Compare = Callable[..., None]


def test_a_push_down_meets_springs_track_and_contact_in_series(compare: Compare) -> None:
    """8 secondary and 12 primary springs, 6 track masses, 12 Hertzian contacts of which 1.5 F/approach is the slope.

    The approach of a wheel of 0.5335 m on a rail head of some 0.3 m radius under 110 kN is 0.07 to 0.1 mm: the contacts
    take 0.03 %, whatever it is exactly.
    """
    locomotive = lmap.Vehicle.load("coco134", beside=ROOT)
    push = 0.05
    load = {"kind": "displacement", "coordinate": "carbody.z", "path": [0.0, push]}
    frame = locomotive.run({"kind": "quasi_static", "speed": 0.0, "load": [load], "load_steps": 1})
    wheels = [name for name in frame.columns if name.endswith(".Q")]
    changes = [frame[name][-1] - frame[name][0] for name in wheels]
    springs = [8 * 5.8e5, 12 * 4.0e6, 6 * 1.5e8, 12 * 1.5 * 110e3 / 0.085e-3]
    series = 1.0 / sum(1.0 / k for k in springs)
    compare("1.3a, stiffness, N/m", sum(changes) / push, series, 2e-4 * series, "springs in series")
    compare("1.3a, spread of the changes, N", float(np.ptp(changes)), 0.0, 1e-3, "symmetry")


def test_a_push_aside_is_carried_by_creepage_against_the_yaw(compare: Compare) -> None:
    """Rolling without lateral speed the lateral creepage of a wheel is -yaw: all axles together carry the push by it.

    To the left for a push to the right (psi < 0), and of the same creepage at any speed.
    """
    locomotive = lmap.Vehicle.load("coco134", beside=ROOT)
    load = {"kind": "displacement", "coordinate": "carbody.y", "path": [0.0, 0.01]}
    found = []
    for speed in (5.0, 20.0):
        frame = locomotive.run({"kind": "quasi_static", "speed": speed, "load": [load], "load_steps": 2})
        last = frame.row(-1, named=True)
        found.append(last)
        yaw = last["ws1.psi"]
        # outward is to the left for the left wheel
        compare(
            f"1.3b, creepage at {speed:g} m/s", last["ws1.left.creep_y"], yaw, 0.02 * abs(yaw), "-vy/V + psi"
        )
        assert last["bogie1.psi"] < 0.0
        assert last["bogie2.psi"] < 0.0
        track = sum(last[f"ws{i}.sum_Y"] for i in range(1, 7))
        compare("1.3b, force on the track, N", track, last["carbody.y.reaction"], 0.5, "balance")
    compare(
        "1.3b, yaw, rad", found[0]["bogie1.psi"], found[1]["bogie1.psi"], 1e-9, "ours at four times the speed"
    )


def test_the_start_up_disturbance_beside_the_papers(compare: Compare) -> None:
    """Spiryagin et al. 2013: mean wheel force 109.515 kN, steady by about 4 s with either step."""
    [spec] = lmap.check(ROOT / "specs/step.toml").specs
    weight = 134e3 * 9.80665 / 12e3
    for case in spec.cases:
        frame = case.quantities
        mean = 1e-3 * float(
            np.mean([frame[name].to_numpy().mean() for name in frame.columns if name.endswith(".Q")])
        )
        compare(f"1.5, mean wheel force, {case.label}, kN", mean, 109.515, 0.1095, "Spiryagin et al. 2013")
        compare(f"1.5, the same, {case.label}, kN", mean, weight, 1e-4, "weight over 12 wheels")
        settled = float(frame["settle_time"][0])
        assert settled < 4.0, "Spiryagin et al. 2013: steady by about 4 s"
    times = [float(case.quantities["settle_time"][0]) for case in spec.cases]
    compare("1.5, settle time, coarse against fine, s", times[1], times[0], 0.05 * times[0], "ours, 1 ms")
