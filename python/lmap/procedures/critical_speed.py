"""Critical speed (LMAP 1.6): started fast and disturbed on ideal straight track, slowed down, until hunting ends.

One case for every wheel profile and speed of the spec; `run.search` says how the critical speed is found. The criteria
judge the column `critical_speed`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from lmap.procedures.base import CaseFigures, expand
from lmap.spec.case import Case, VehicleData
from lmap.spec.model import Spec
from lmap.verdict import Fact

if TYPE_CHECKING:
    import polars as pl

NAME = "critical_speed"
SUMMARY = "ideal straight track, from very fast down: the speed at which hunting ends"
UNITS: Mapping[str, str] = {}


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """A case for every wheel profile and speed."""
    return expand(spec, vehicle, kind="critical_speed")


def quantities(
    spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
) -> Mapping[str, pl.DataFrame]:
    """The frames as they are."""
    return frames


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """Nothing beside the verdicts."""
    return []
