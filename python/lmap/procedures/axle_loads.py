"""Axle loads (LMAP 2B.1): standing, or rolling slowly along straight track; and wheel load over wheel diameter.

A case for every wheel profile and speed of the spec: with an `integrator` in `[run]` it is stepped in time, without one
the vehicle is in balance (at rest unless a speed is given). Added to each row: `<axle>.axle_load`, `<axle>.side_spread`
(what the heavier wheel carries above the mean of both), `axle_spread` (the axle farthest from the mean of all) and
`<axle>.<side>.PD`, the wheel load over the diameter of a worn-out wheel.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict, Field

from lmap.procedures.base import CaseFigures, at_rest, expand, settings, wheelsets
from lmap.spec.case import Case, VehicleData
from lmap.spec.model import Spec
from lmap.verdict import Fact

if TYPE_CHECKING:
    import polars as pl

NAME = "axle_loads"
SUMMARY = "axle loads and wheel load over wheel diameter, standing or rolling slowly"
UNITS: Mapping[str, str] = {"axle_spread": "1"}


class Settings(BaseModel):
    """`[test]`."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    worn_diameter: float = Field(gt=0.0, allow_inf_nan=False)
    """Of a wheel at its wear limit, m."""


SETTINGS = Settings


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """In time where there is an integrator, else a balance."""
    kind = "time" if "integrator" in spec.run.rest else "equilibrium"
    return at_rest(spec, vehicle) if spec.run.speeds is None else expand(spec, vehicle, kind=kind)


def derived(spec: Spec, channels: Mapping[str, str]) -> Mapping[str, str]:
    """Load and spread of each axle, P/D of each wheel."""
    added: dict[str, str] = {}
    for name in wheelsets(channels):
        added |= {f"{name}.axle_load": "N", f"{name}.side_spread": "1"}
        added |= {f"{name}.{side}.PD": "N/m" for side in ("left", "right")}
    return added


def quantities(
    spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
) -> Mapping[str, pl.DataFrame]:
    """The frames with these columns."""
    worn = settings(spec, Settings).worn_diameter
    return {label: _with_loads(frame, worn) for label, frame in frames.items()}


def _with_loads(frame: pl.DataFrame, worn: float) -> pl.DataFrame:
    import polars as pl

    names = wheelsets(frame.columns)
    if not names:
        return frame  # its criteria then say which channel is missing
    for name in names:
        left, right = pl.col(f"{name}.left.Q"), pl.col(f"{name}.right.Q")
        frame = frame.with_columns(
            (left + right).alias(f"{name}.axle_load"),
            ((left - right).abs() / (left + right)).alias(f"{name}.side_spread"),
            (left / worn).alias(f"{name}.left.PD"),
            (right / worn).alias(f"{name}.right.PD"),
        )
    loads = [pl.col(f"{name}.axle_load") for name in names]
    mean = pl.mean_horizontal(loads)
    off = pl.max_horizontal([(load / mean - 1.0).abs() for load in loads])
    return frame.with_columns(off.alias("axle_spread"))


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """Nothing beside the verdicts."""
    return []
