"""Static heights (LMAP 2A.1): the standing body at its highest and lowest within the static outline.

A balance at rest for each `load_case` of the spec: a condition of the vehicle, wheel wear, springs that have settled or
failed. Columns: `clearance` (m, least distance to the outline, negative outside), `highest` and `lowest` (m above
rail).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict, Field

from lmap.errors import InputProblem, Problem
from lmap.outline import closed
from lmap.procedures.base import CaseFigures, at_rest, settings
from lmap.procedures.displaced import (
    LoadCase,
    Outline,
    body_on_track,
    case_of_load,
    drawn,
    section,
    set_loads,
    worst,
)
from lmap.spec.case import Case, VehicleData
from lmap.spec.model import Spec
from lmap.verdict import Drawing, Fact
from lmap.view.model import Model, resolved

if TYPE_CHECKING:
    import polars as pl

NAME = "heights"
SUMMARY = "the standing body at its highest and lowest within the static outline"
UNITS: Mapping[str, str] = {"clearance": "m", "highest": "m", "lowest": "m"}


class Settings(BaseModel):
    """`[test]`."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    outline: Outline
    """By name in a spec: models/outlines."""
    load_case: list[LoadCase] = Field(min_length=1)
    """The states of the vehicle."""


SETTINGS = Settings


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """One for each load case."""
    test, model = settings(spec, Settings), resolved(vehicle)
    section(model)
    [rest, *others] = at_rest(spec, vehicle)
    if others:
        raise InputProblem(Problem(key=("run", "wheel_profile"), found="several", allowed="one"))
    found = []
    for load in test.load_case:
        forces = set_loads(load, model, 1)
        own: dict[str, Any] = {"kind": "quasi_static", "load": forces} if forces else {}
        run = {**rest.data["run"], **own}
        found.append(case_of_load(load, vehicle, label=load.label, track=spec.track, run=run))
    return found


def _stations(model: Model) -> tuple[float, ...]:
    """Both ends and the middle of the body: pitch lowers an end."""
    length = float((model.outline or {})["length_over_couplers"])
    return (length / 2.0, 0.0, -length / 2.0)


def quantities(
    spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
) -> Mapping[str, pl.DataFrame]:
    """Heights and clearance of each load case."""
    import polars as pl

    test, model = settings(spec, Settings), resolved(vehicle)
    outline, stations = closed(test.outline.static), _stations(model)
    found = {}
    for load in test.load_case:
        if load.label not in frames:
            continue
        frame, shape = frames[load.label], section(model)
        drop = [body_on_track(frame, 0, model, x=x, wheel_wear=load.wheel_wear)[1] for x in stations]
        nearest, _ = worst(frame, 0, model, outline, stations=stations, wheel_wear=load.wheel_wear)
        own = {
            "clearance": nearest.distance,
            "highest": -float(shape[:, 1].min()) - min(drop),
            "lowest": -float(shape[:, 1].max()) - max(drop),
        }
        found[load.label] = frame.head(1).with_columns(**{name: pl.lit(value) for name, value in own.items()})
    return found


def drawings(spec: Spec, quantities: Mapping[str, pl.DataFrame], vehicle: VehicleData) -> list[Drawing]:
    """All load cases within the outline."""
    test, model = settings(spec, Settings), resolved(vehicle)
    outline = closed(test.outline.static)
    curves = [drawn(test.outline.title, outline, "limit")]
    for load in test.load_case:
        if load.label in quantities:
            frame = quantities[load.label]
            _, placed = worst(frame, 0, model, outline, stations=_stations(model), wheel_wear=load.wheel_wear)
            curves.append(drawn(load.label, placed))
    return [
        Drawing(
            title="Body at rest within the static outline",
            x_label="lateral (m)",
            y_label="height above rail (m)",
            curves=tuple(curves),
            equal_axes=True,
        )
    ]


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """Nothing beside the verdicts."""
    return []
