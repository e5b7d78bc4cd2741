"""The drawing (LMAP 1.2): is everything in its place and of its size?

Nothing is simulated. What a program can see is measured, in metres: each element against the mirror image of its
partner (`<element>.asymmetry`), attachment points and sensors against their bodies (`<element>.<body>.outside`),
tape circles against the rail heads (`<wheelset>.<side>.off_rail`). The rest is for a person: the verdict is `manual`
until the spec carries a sign-off with the hash of this very model.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from lmap.procedures.base import CaseFigures, Look
from lmap.spec.case import Case, VehicleData
from lmap.spec.model import Spec
from lmap.verdict import Fact
from lmap.view import checks, sign_off
from lmap.view.model import resolved
from lmap.view.scene import scene

if TYPE_CHECKING:
    import polars as pl

NAME = "view"
SUMMARY = "the vehicle as drawn: symmetry, attachment points, wheels on rails; the rest signed by a person"
UNITS: Mapping[str, str] = {}


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """None: nothing is simulated."""
    return []


def quantities(
    spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
) -> Mapping[str, pl.DataFrame]:
    """The frames as they are, of which there are none."""
    return frames


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """Nothing beside the verdicts."""
    return []


def look(spec: Spec, vehicle: VehicleData, settings: Mapping[str, Any]) -> Look:
    """The measures, the sign-off and the drawing of a vehicle in the spec's condition."""
    import polars as pl

    model = resolved(vehicle)
    gauge = gauge_of(spec.track)
    measured = {one.name: one.value for one in checks.measures(model, gauge)}
    for kind in checks.UNITS:
        if not any(name.endswith(f".{kind}") for name in measured):
            measured[f"none.{kind}"] = (
                0.0  # nothing there to be wrong, e.g. a wheelset alone without connections
            )
    person = sign_off.verdict(
        model, spec.sign_off, index=len(spec.criterion), vehicle=spec.vehicle, settings=settings
    )
    return Look(
        label=person.case,
        hash=model.hash,
        frame=pl.DataFrame({"t": [0.0], "s": [0.0], **{name: [value] for name, value in measured.items()}}),
        units={name: checks.UNITS[name.rpartition(".")[2]] for name in measured},
        by_person=person,
        drawing=scene(model, gauge, checks.findings(model, gauge)),
    )


def gauge_of(track: Mapping[str, Any]) -> float | None:
    """The gauge of a track, m, where it has one."""
    gauge = track.get("gauge")
    return float(gauge) if isinstance(gauge, int | float) and not isinstance(gauge, bool) else None
