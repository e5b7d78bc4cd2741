"""Modes at rest (LMAP 1.4): is every motion damped, and is none too stiff to be followed in time?

One case for every wheel profile, standing with wheels that stick; a row for each mode. The criteria judge the damping
ratio and the magnitude of the eigenvalue, which this procedure adds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from lmap.procedures.base import CaseFigures
from lmap.spec.case import Case, VehicleData, build
from lmap.spec.model import Spec
from lmap.verdict import Fact

if TYPE_CHECKING:
    import polars as pl

NAME = "modes"
SUMMARY = "eigenvalues of the vehicle at rest, its wheels sticking"
UNITS: Mapping[str, str] = {"magnitude": "rad/s"}


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """A case for every wheel profile, or for the vehicle's own."""
    found = []
    for profile in spec.run.wheel_profile or [vehicle.wheel_profile or ""]:
        run: dict[str, Any] = {"kind": "modal", **spec.run.rest, "speed": 0.0}
        if profile:
            run["wheel_profile"] = profile
        label = profile if spec.run.wheel_profile else "at rest"
        found.append(build(label=label, vehicle=vehicle, track=spec.track, run=run))
    return found


def quantities(
    spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
) -> Mapping[str, pl.DataFrame]:
    """The modes with the magnitude of each eigenvalue."""
    import polars as pl

    magnitude = (pl.col("real") ** 2 + pl.col("imag") ** 2).sqrt().alias("magnitude")
    # A frame without modes is left as it is: the criterion then says which channel is missing.
    return {
        label: frame.with_columns(magnitude) if {"real", "imag"} <= set(frame.columns) else frame
        for label, frame in frames.items()
    }


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """Nothing beside the verdicts."""
    return []
