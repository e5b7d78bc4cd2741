"""What driven runs come to: frames made by hand."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import polars as pl
import pytest

from lmap.errors import InputProblem
from lmap.prepare import prepare
from lmap.procedures import drive
from lmap.procedures.drive_air_brake import Command, last_command, times

SPECS = Path(__file__).parents[2] / "specs"
BRAKE = {
    "pipe_pressure": 500e3,
    "insensitivity": 15e3,
    "distributor_ratio": 2.5,
    "max_cylinder": 350e3,
    "max_independent": 330e3,
}


@pytest.mark.parametrize(
    ("asked", "command"),
    [
        ({}, None),
        ({"independent_brake": 300e3}, None),
        ({"independent_brake": [[1.0, 300e3]]}, Command(1.0, 0.0, 300e3)),
        ({"independent_brake": [[1.0, 900e3]]}, Command(1.0, 0.0, 330e3)),
        ({"independent_brake": [[0.0, 300e3], [2.0, 0.0]]}, Command(2.0, 300e3, 0.0)),
        ({"brake_pipe_reduction": [[1.0, 100e3]]}, Command(1.0, 0.0, 250e3)),
        ({"brake_pipe_reduction": [[1.0, 10e3]]}, None),
        ({"brake_pipe_reduction": [[0.0, 140e3], [1.0, 0.0]]}, Command(1.0, 350e3, 0.0)),
        ({"brake_pipe_reduction": [[1.0, 100e3]], "emergency": 4.0}, Command(4.0, 250e3, 350e3)),
        (
            {"brake_pipe_reduction": [[1.0, 140e3]], "independent_brake": [[5.0, 300e3]]},
            Command(1.0, 0.0, 350e3),
        ),
        ({"emergency": 0.0}, Command(0.0, 0.0, 350e3)),
    ],
)
def test_the_command_of_a_static_test(asked: dict[str, Any], command: Command | None) -> None:
    assert last_command(asked, BRAKE) == command


def cylinder(*pressures: float) -> pl.DataFrame:
    return pl.DataFrame({"t": [float(k) for k in range(len(pressures))], "brake.cylinder": pressures})


def test_brake_times_run_from_the_command_to_shares_of_what_is_asked_for() -> None:
    rising = cylinder(0.0, 0.0, 0.0, 200e3, 284e3, 286e3, 300e3)
    assert times(rising, Command(1.0, 0.0, 300e3))[0] == 4.0  # 285 kPa
    falling = cylinder(300e3, 300e3, 100e3, 16e3, 14e3)
    assert times(falling, Command(1.0, 300e3, 0.0))[1] == 3.0  # 15 kPa


def test_a_brake_that_does_not_get_there_has_no_time() -> None:
    """Against its own last pressure a brake of half the pressure would be quick."""
    weak = cylinder(0.0, 150e3, 150e3, 150e3)
    assert all(map(math.isnan, times(weak, Command(0.0, 0.0, 300e3))))
    assert all(map(math.isnan, times(cylinder(300e3, 200e3, 100e3), Command(0.0, 300e3, 0.0))))
    assert all(map(math.isnan, times(weak, None)))


@pytest.mark.needs_core
@pytest.mark.parametrize(("last", "time", "way"), [(11.11, 2.0, 30.0), (11.0, math.nan, math.nan)])
def test_a_speed_that_was_not_reached_has_no_time(last: float, time: float, way: float) -> None:
    """The run is to end above 11.1 m/s, or after 150 s."""
    prepared = prepare(SPECS / "balance_speed.toml")
    frame = pl.DataFrame({"t": [0.0, 1.0, 2.0], "s": [5.0, 15.0, 35.0], "v": [0.0, 10.0, last]})
    made = drive.quantities(prepared.spec, {"dry": frame}, prepared.vehicle.data)["dry"]
    assert made["run.duration"][0] == 2.0
    for name, expected in (("run.time_to_speed", time), ("run.distance_to_speed", way)):
        assert made[name][0] == pytest.approx(expected, nan_ok=True)


@pytest.mark.needs_core
@pytest.mark.parametrize(
    "key", ["run.speed_kmh", "run.speed", "run.wheel_profile"], ids=lambda key: key.partition(".")[2]
)
def test_several_speeds_or_profiles_are_one_message(key: str) -> None:
    values = ["anzr1", "anzr1_worn_1"] if key.endswith("profile") else [10.0, 20.0]
    with pytest.raises(InputProblem, match=f"{key}: found 2 values; allowed: one; a \\[\\[test.case") as one:
        prepare(SPECS / "gradient_starting.toml", {key: values})
    assert len(one.value.problems) == 1
