"""Syntax check (LMAP 1.1): the automatic check of the vehicle's description, `lmap lint`.

One case of kind `lint` for every wheel profile and speed of the spec. What is judged is how many findings there
are: all errors, and those of stiffness alone. Warnings are counted.
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

NAME = "lint"
SUMMARY = "the description of the vehicle, checked by rules: lmap lint"
UNITS: Mapping[str, str] = {"errors": "1", "soft_or_stiff": "1", "warnings": "1"}

_SOFT_OR_STIFF = ("LM403", "LM701", "LM702")


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """A case for every wheel profile and speed."""
    return expand(spec, vehicle, kind="lint")


def quantities(
    spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
) -> Mapping[str, pl.DataFrame]:
    """One row with the numbers of findings; a frame without findings is a good one."""
    return {label: _counts(frame) for label, frame in frames.items()}


def _counts(frame: pl.DataFrame) -> pl.DataFrame:
    import polars as pl

    if not {"severity", "code"} <= set(frame.columns):
        return frame  # no frame of findings: its criteria cannot be judged
    severity = pl.col("severity")
    return frame.select(
        t=pl.lit(0.0),
        s=pl.lit(0.0),
        errors=(severity == 2.0).sum().cast(pl.Float64),
        soft_or_stiff=pl.col("code").is_in(_SOFT_OR_STIFF).sum().cast(pl.Float64),
        warnings=(severity == 1.0).sum().cast(pl.Float64),
    )


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """None."""
    return []
