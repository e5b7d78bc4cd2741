"""`lmap modes` and `Vehicle.modes` on the real core."""

from __future__ import annotations

import json
from pathlib import Path

import polars as pl
import pytest
from typer.testing import CliRunner

import lmap
from lmap.cli.app import app
from lmap.errors import InputProblem

pytestmark = pytest.mark.needs_core


def test_a_vehicle_gives_named_modes_and_their_shapes() -> None:
    frame = lmap.Vehicle.load("coco134").modes([0.0, 30.0])
    standing = frame.filter(pl.col("v") == 0.0)
    assert "car body bounce" in standing["name"]
    bounce = standing.row(by_predicate=pl.col("name") == "car body bounce", named=True)
    # 134 t: 8 secondary springs of 5.8e5 N/m on 12 primary of 4e6 and six tracks of 1.5e8, one above the other.
    stiffness = 1.0 / (1.0 / (8 * 5.8e5) + 1.0 / (12 * 4e6) + 1.0 / (6 * 1.5e8))
    assert bounce["natural_frequency"] == pytest.approx((stiffness / 87180.0) ** 0.5 / 6.2832, rel=0.03)
    assert bounce["re.carbody.z"] == pytest.approx(1.0, abs=1e-6)
    assert any("hunting" in name for name in frame.filter(pl.col("v") == 30.0)["name"])


def test_a_softer_spring_lowers_the_bounce() -> None:
    def bounce(**overrides: float) -> float:
        frame = lmap.Vehicle.load("coco134", overrides=dict(overrides)).modes()
        return float(frame.filter(pl.col("name") == "car body bounce")["natural_frequency"][0])

    assert bounce(**{"secondary.kz": 2.9e5}) == pytest.approx(bounce() / 2**0.5, rel=0.05)


def test_the_command_prints_json_and_writes_a_page(tmp_path: Path) -> None:
    out = tmp_path / "out"
    arguments = ["modes", "coco134", "--speed-kmh", "0,60:120:60", "--json", "--out", str(out)]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.output
    document = json.loads(done.stdout)
    assert document["vehicle"] == "coco134"
    assert {round(mode["speed_kmh"]) for mode in document["modes"]} == {0, 60, 120}
    page = (out / "root_locus.html").read_text(encoding="utf-8")
    assert "bogies hunting" in page
    assert 'src="http' not in page
    assert pl.read_parquet(out / "modes.parquet").height == len(document["modes"])


def test_the_table_shows_what_moves() -> None:
    done = CliRunner().invoke(app, ["modes", "coco134", "--speed-kmh", "0", "--below-hz", "3"])
    assert done.exit_code == 0, done.output
    assert "car body lower sway" in done.stdout
    assert "carbody.y 1.00" in done.stdout


@pytest.mark.parametrize("text", ["5x", "-3", "10:5:1", "1:2", "0:1000:0.1", "", "nan", "1,,2"])
def test_speeds_that_are_none_are_refused(text: str) -> None:
    with pytest.raises(InputProblem, match="--speed-kmh"):
        CliRunner().invoke(app, ["modes", "coco134", "--speed-kmh", text], catch_exceptions=False)


@pytest.mark.parametrize("speed", [[], -1.0, float("nan"), [10.0, float("inf")]])
def test_speeds_that_no_vehicle_has_are_refused(speed: float | list[float]) -> None:
    with pytest.raises(InputProblem, match="speed"):
        lmap.Vehicle.load("coco134").modes(speed)


def test_a_friction_out_of_range_is_refused() -> None:
    with pytest.raises(InputProblem, match="friction"):
        lmap.Vehicle.load("coco134").modes(10.0, friction=0.0)
