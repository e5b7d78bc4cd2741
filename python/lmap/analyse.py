"""Analyses of a vehicle without a spec: its case on its own base track, and its modes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lmap import contact, files, toml
from lmap.errors import InputProblem, Problem
from lmap.simulate import simulate
from lmap.spec.case import Case, VehicleData, build, merged

if TYPE_CHECKING:
    import polars as pl

FRICTION = 0.4
"""Dry rail, where nobody says otherwise."""


def vehicle_case(
    vehicle: VehicleData,
    beside: Path,
    run: Mapping[str, Any],
    *,
    label: str,
    track: Mapping[str, Any] | None = None,
) -> Case:
    """A case of a vehicle on its own base track, its profiles in it.

    `beside` is the vehicle's file: track and profiles are looked for from there. `track` goes over the base
    track. Friction and wheel profile that `run` does not name are 0.4 and the vehicle's own. Raises
    `InputProblem`.
    """
    whole: dict[str, Any] = {"length": 200.0, **(track or {})}
    places = [beside]
    if vehicle.track is not None:
        base = toml.load(files.find(files.TRACK, vehicle.track, beside), "track")
        whole = merged(base.data.get("track", base.data), whole)
        places.append(base.path)
    own = {"friction": FRICTION, "wheel_profile": vehicle.wheel_profile}
    case = build(label=label, vehicle=vehicle, track=whole, run={**own, **run})
    data = {}
    for profile, key in case.profile_names.items():
        path = first_place(profile, places)
        points = contact.profile_points(files.read_text(path, "profile"), profile)
        data[profile] = {"kind": "wheel" if key[-1] == "wheel_profile" else "rail", **points}
    return case.with_profiles(data)


def modes_case(
    vehicle: VehicleData, beside: Path, speeds: Sequence[float], *, friction: float = FRICTION
) -> Case:
    """The case that gives a vehicle's modes at each of the speeds (m/s)."""
    wrong = [speed for speed in speeds if not (math.isfinite(speed) and speed >= 0.0)]
    if wrong or not speeds:
        found = f"{wrong[0]} m/s" if wrong else "no speed"
        raise InputProblem(Problem(key=("speed",), found=found, allowed="m/s from 0 up, one or more"))
    run = {"kind": "modal", "speed": speeds[0], "speeds": list(speeds), "friction": friction}
    return vehicle_case(vehicle, beside, run, label="modes")


def modes(
    vehicle: VehicleData, beside: Path, speeds: Sequence[float], *, friction: float = FRICTION
) -> pl.DataFrame:
    """A row for each mode at each speed (m/s, 0 stands with wheels that stick), lowest frequency first.

    Columns: `name`, `v`, `mode`, `branch` of the root locus, `frequency` of the damped motion and
    `natural_frequency` (Hz), `damping_ratio`, `real` (1/s), `imag` (rad/s), and the shape, `re.` and `im.` with
    every coordinate (`re.carbody.y`): the largest is 1. Raises `InputProblem` or `SimulationProblem`.
    """
    frame = simulate(modes_case(vehicle, beside, speeds, friction=friction))
    return frame.select("name", *[name for name in frame.columns if name != "name"])


def first_place(name: str, places: Sequence[Path]) -> Path:
    """A profile seen from the first place that has it."""
    failure: InputProblem | None = None
    for place in places:
        try:
            return files.find(files.PROFILE, name, place)
        except InputProblem as error:
            failure = failure or error
    assert failure is not None  # places is never empty
    raise failure
