"""`run.friction` as a table, through `lmap check`: per rail, along the track, falling with the slip velocity."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import polars as pl
import pytest
from commands import Ran

pytestmark = pytest.mark.needs_core

SPEC = """\
id = "friction"
title = "A coach in a curve of 300 m"
procedure = "hunting"
vehicle = "manchester1"
condition = "benchmark"

[track]
length = 150.0
layout = [
    { kind = "tangent", length = 5.0 },
    { kind = "clothoid", length = 20.0 },
    { kind = "curve", length = 125.0, radius = 300.0 },
]

[run]
speed = 10.0
friction = 0.4
wheel_profile = "s1002"
integrator = { kind = "ros2", step = 0.001 }
output_step = 0.01

[[criterion]]
name = "wheel L/V"
signal = "ws*.*.LV"
chain = [{ max_abs = {} }]
unit = "1"
max_abs = 10.0
source = "assumed"
reason = "the frames are looked at, not the verdict"
"""
Run = Callable[[str], pl.DataFrame]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lmap: Callable[..., Ran]) -> Run:
    """The frame of the spec's one case with a friction given by `--set`."""
    monkeypatch.chdir(tmp_path)
    Path("friction.toml").write_text(SPEC, encoding="utf-8")

    def call(friction: str) -> pl.DataFrame:
        friction_set = ("--set", f"run.friction={friction}")
        code, _, err = lmap("check", "friction.toml", "--quiet", "--report", "out", *friction_set)
        assert code == 0, err
        [path] = Path("out", "cases").glob("*.parquet")
        frame = pl.read_parquet(path)
        path.unlink()
        return frame

    return call


def inner(frame: pl.DataFrame, start: float, end: float) -> float:
    """Mean L/V of the leading axle's inner wheel over a stretch of track: nothing but creep, the flange is outside."""
    on_it = frame.filter((pl.col("s") > start) & (pl.col("s") < end))
    return float(on_it.select(pl.col("ws1.right.LV").mean()).item())


@pytest.mark.slow
def test_friction_is_that_of_the_rail_the_place_and_the_slip_velocity(run: Run) -> None:
    dry, wet = run("0.4"), run("0.15")
    # in the sharp curve creep is near to friction, and no more than friction
    assert 0.2 < inner(dry, 80, 140) < 0.4
    assert 0.13 < inner(wet, 80, 140) < 0.16  # with the angle of the contact plane, some mrad

    wet_from_90 = run("{ value = 0.4, along = [{ from = 90.0, transition = 5.0, value = 0.15 }] }")
    assert inner(wet_from_90, 55, 75) == pytest.approx(inner(dry, 55, 75), rel=0.02)
    assert inner(wet_from_90, 120, 140) == pytest.approx(inner(wet, 120, 140), rel=0.05)

    # the inner rail alone: the outer flange then has less to push against
    inner_wet = run("{ left = 0.4, right = 0.15 }")
    assert inner(inner_wet, 80, 140) == pytest.approx(inner(wet, 80, 140), rel=0.2)
    flange = [
        float(frame.filter(pl.col("s") > 80).select(pl.col("ws1.left.Y").mean()).item())
        for frame in (inner_wet, dry)
    ]
    assert flange[0] < flange[1]

    # slip velocities are some cm/s: friction that falls to nothing at once leaves hardly any
    falling = run("{ value = 0.4, falling = { ratio = 0.25, decay = 1000.0 } }")
    assert inner(falling, 80, 140) < 0.6 * inner(dry, 80, 140)
    assert inner(falling, 80, 140) > 0.25 * 0.4 * 0.5
    never = run("{ value = 0.4, falling = { ratio = 0.25, decay = 0.0 } }")
    assert never.drop("t").equals(dry.drop("t"))
