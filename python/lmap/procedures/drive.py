"""Runs with a driver (LMAP stage 3): traction, brakes, a train.

One case for every `[[test.case]]` of the spec: its label, and what it changes in `[run]` and `[track]`. Without a
speed the vehicle starts from rest. Added to every frame, the same in each row: `run.duration` (s), `run.distance`
(m), `run.final_speed`, `run.least_speed` (m/s), `run.deceleration` (m/s2, the mean from start to end),
`run.movement` (m, the largest distance from the start), `run.time_to_speed` (s) and `run.distance_to_speed` (m): to the
speed at which `until` ends the run, no number (NaN) where it ends otherwise. The air brake by itself gets
`brake.application_time` and `brake.release_time` (s, from the last command).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict, Field

from lmap.errors import InputProblem, KeyPath, Problem
from lmap.procedures import drive_air_brake, drive_drawings
from lmap.procedures.base import CaseFigures, settings
from lmap.spec.case import Case, VehicleData, build, merged
from lmap.spec.model import Spec
from lmap.verdict import Drawing, Fact
from lmap.view.model import table

if TYPE_CHECKING:
    import polars as pl

NAME = "drive"
SUMMARY = "runs with traction, brakes and a train, one for each case of the spec"
UNITS: Mapping[str, str] = {
    "run.duration": "s",
    "run.distance": "m",
    "run.final_speed": "m/s",
    "run.least_speed": "m/s",
    "run.deceleration": "m/s2",
    "run.movement": "m",
    "run.time_to_speed": "s",
    "run.distance_to_speed": "m",
    "brake.application_time": "s",
    "brake.release_time": "s",
}


class Variant(BaseModel):
    """`[[test.case]]`: one run."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    label: str = Field(min_length=1)
    """Of its case."""
    speed_kmh: float | None = Field(default=None, ge=0.0, allow_inf_nan=False)
    """Initial speed instead of the spec's."""
    run: dict[str, Any] = Field(default_factory=dict)
    """Laid over `[run]`."""
    track: dict[str, Any] = Field(default_factory=dict)
    """Laid over `[track]`."""


class Settings(BaseModel):
    """`[test]`."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    kind: str = Field(default="time", pattern="^(time|air_brake)$")
    """`air_brake` tests the air brake by itself, nothing moving."""
    case: list[Variant] = Field(min_length=1)
    """The runs."""


SETTINGS = Settings


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """One for each `[[test.case]]`."""
    test = settings(spec, Settings)
    speeds, profiles = spec.run.speeds or [], spec.run.wheel_profile or [vehicle.wheel_profile or ""]
    _refuse_several(spec)
    start = speeds[0].resolve(vehicle.design_speed) if speeds else 0.0
    found = []
    for variant in test.case:
        run = merged(
            {"kind": test.kind, "speed": start, "wheel_profile": profiles[0], **spec.run.rest}, variant.run
        )
        if variant.speed_kmh is not None:
            run["speed"] = variant.speed_kmh / 3.6
        track = merged(spec.track, variant.track)
        found.append(build(label=variant.label, vehicle=vehicle, track=track, run=run))
    return found


def _refuse_several(spec: Spec) -> None:
    """Cases of several speeds or profiles would have one label."""
    run = spec.run
    written = {"speed": run.speed, "speed_kmh": run.speed_kmh, "wheel_profile": run.wheel_profile}
    allowed = "one; a [[test.case]] may have its own speed_kmh, and wheel_profile in its run"
    problems = [
        Problem(key=("run", key), found=f"{len(values)} values", allowed=allowed)
        for key, values in written.items()
        if values is not None and len(values) > 1
    ]
    if problems:
        raise InputProblem(problems)


def origin(spec: Spec, label: str, key: KeyPath) -> KeyPath:
    """A key of the case where its `[[test.case]]` writes it, or more of it than the spec's own table does."""
    common: Mapping[str, Any] = {"run": spec.run.rest, "track": spec.track}
    for index, variant in enumerate(settings(spec, Settings).case):
        own: Mapping[str, Any] = {"run": variant.run, "track": variant.track}
        if variant.label == label and _depth(own, key) >= max(2, _depth(common, key)):
            return ("test", "case", index, *key)
    return key


def _depth(table: Any, key: KeyPath) -> int:
    """How many steps of a key a table has."""
    steps = 0
    for step in key:
        if not isinstance(table, Mapping) or step not in table:
            break
        table, steps = table[step], steps + 1
    return steps


def quantities(
    spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
) -> Mapping[str, pl.DataFrame]:
    """The frames with what each run came to."""
    drives = {case.label: case.data["run"].get("drive", {}) for case in cases(spec, vehicle)}
    brake = table(vehicle, "air_brake")
    return {
        label: _with_sums(frame, drives[label].get("until", {}))
        if "v" in frame.columns
        else _with_times(frame, drives[label], brake)
        for label, frame in frames.items()
    }


def _with_times(frame: pl.DataFrame, drive: Mapping[str, Any], brake: Mapping[str, Any]) -> pl.DataFrame:
    import polars as pl

    applied, released = drive_air_brake.times(frame, drive_air_brake.last_command(drive, brake))
    return frame.with_columns(
        pl.lit(applied).alias("brake.application_time"), pl.lit(released).alias("brake.release_time")
    )


def _with_sums(frame: pl.DataFrame, until: Mapping[str, Any]) -> pl.DataFrame:
    import polars as pl

    t, s, v = pl.col("t"), pl.col("s"), pl.col("v")
    duration, distance = t.last() - t.first(), s.last() - s.first()
    reached = _reached(until, float(frame["v"][-1]))
    return frame.with_columns(
        duration.alias("run.duration"),
        distance.alias("run.distance"),
        v.last().alias("run.final_speed"),
        v.min().alias("run.least_speed"),
        ((v.first() - v.last()) / duration).alias("run.deceleration"),
        (s - s.first()).abs().max().alias("run.movement"),
        (duration if reached else pl.lit(float("nan"))).alias("run.time_to_speed"),
        (distance if reached else pl.lit(float("nan"))).alias("run.distance_to_speed"),
    )


def _reached(until: Mapping[str, Any], speed: float) -> bool:
    """Whether the last speed, m/s, is one that ends the run."""
    below, above = until.get("speed_below"), until.get("speed_above")
    return (below is not None and speed <= below) or (above is not None and speed >= above)


def drawings(spec: Spec, quantities: Mapping[str, pl.DataFrame], vehicle: VehicleData) -> list[Drawing]:
    """Effort over speed, adhesion over slip, slip, stops, brakes, parking, motors: what the runs have channels for."""
    runs = {case.label: case.data["run"] for case in cases(spec, vehicle)}
    published = {
        label: time
        for criterion in spec.criterion
        if {"run.duration", "run.time_to_speed"} & set(criterion.signal)
        for label, time in criterion.published.items()
    }
    return drive_drawings.drawings(quantities, runs, vehicle, published)


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """Nothing beside the verdicts."""
    return []
