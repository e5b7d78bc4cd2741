"""Critical speed (LMAP 1.6): started fast and disturbed on ideal straight track, slowed down, until hunting ends.

One case for every wheel profile and speed of the spec; `run.search` says how the critical speed is found. The criteria
judge the column `critical_speed`. What else the reading hangs on is shown by further searches, `[test.beside]`: each
gives a case of its own, `beside: <name>`, for each wheel profile.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from lmap.errors import KeyPath
from lmap.procedures.base import CaseFigures, expand, settings
from lmap.spec.case import Case, VehicleData
from lmap.spec.model import Spec
from lmap.verdict import Drawing, DrawnCurve, Fact

if TYPE_CHECKING:
    import polars as pl

NAME = "critical_speed"
SUMMARY = "ideal straight track, from very fast down: the speed at which hunting ends"
UNITS: Mapping[str, str] = {}

BESIDE = "beside: "
"""What the labels of cases begin with that are shown beside the spec's own search."""


class Beside(BaseModel):
    """Another search; what it does not say is as in `[run]`."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    speed_kmh: float | None = Field(default=None, gt=0.0, allow_inf_nan=False)
    """Speed at which it begins, km/h."""
    integrator: dict[str, Any] | None = None
    """As `run.integrator`."""
    search: dict[str, Any]
    """As `run.search`."""


class Settings(BaseModel):
    """`[test]`."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    beside: dict[str, Beside] = Field(default_factory=dict)
    """Other searches, by the names that they are shown under."""


SETTINGS = Settings

_STEPPED = ("disturbance", "integrator", "output_step")
"""Keys of `[run]` that a search without time stepping has no use for."""


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """A case for every wheel profile and speed, then for every wheel profile and search beside them."""
    found = expand(spec, vehicle, kind="critical_speed")
    profiles = spec.run.wheel_profile or [""]
    for name, beside in sorted(settings(spec, Settings).beside.items(), key=lambda one: _rank(one[1])):
        for profile in profiles:
            own = next(case for case in found if profile in ("", case.data["run"]["wheel_profile"]))
            label = BESIDE + " ".join(part for part in (name, profile if len(profiles) > 1 else "") if part)
            run = {**own.data["run"], "search": beside.search}
            if beside.speed_kmh is not None:
                run["speed"] = beside.speed_kmh / 3.6
            if beside.integrator is not None:
                run["integrator"] = beside.integrator
            if beside.search.get("method") == "linear":
                run = {key: value for key, value in run.items() if key not in _STEPPED}
            found.append(Case(label, {**own.data, "label": label, "run": run}))
    return found


def _rank(beside: Beside) -> tuple[bool, float]:
    """Ramps first, the fastest of them before the others."""
    rate = beside.search.get("deceleration")
    return (not isinstance(rate, int | float), -float(rate) if isinstance(rate, int | float) else 0.0)


def origin(spec: Spec, label: str, key: KeyPath) -> KeyPath:
    """A key of a search beside the spec's own is written in its table, if that has it."""
    for name, beside in settings(spec, Settings).beside.items():
        if label.removeprefix(BESIDE).startswith(name) and label.startswith(BESIDE) and key[:1] == ("run",):
            own = "speed_kmh" if key[1:2] == ("speed",) else str(key[1]) if len(key) > 1 else ""
            if getattr(beside, own, None) is not None:
                return ("test", "beside", name, own, *key[2:])
    return key


def quantities(
    spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
) -> Mapping[str, pl.DataFrame]:
    """The frames as they are."""
    return frames


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """Nothing beside the verdicts."""
    return []


def drawings(spec: Spec, quantities: Mapping[str, pl.DataFrame], vehicle: VehicleData) -> list[Drawing]:
    """Amplitude of hunting against speed: ramps as lines, limit cycles as points, linear critical speeds upright."""
    curves: list[DrawnCurve] = []
    for label, frame in quantities.items():
        name = label.removeprefix(BESIDE)
        if not {"v", "swing"} <= set(frame.columns):
            continue
        if "direction" in frame.columns:
            for direction, word in ((-1.0, "down"), (1.0, "up")):
                part = frame.filter(frame["direction"] == direction)
                curves.append(_swing(f"{name}, stepped {word}", part, "points"))
        else:
            curves.append(_swing(name, frame.gather_every(max(1, frame.height // _POINTS)), "line"))
    largest = max((max(curve.y, default=0.0) for curve in curves), default=0.0)
    for label, frame in quantities.items():
        if {"real", "critical_speed"} <= set(frame.columns) and frame.height:
            speed = 3.6 * float(frame["critical_speed"][0])
            name = f"{label.removeprefix(BESIDE)}: small disturbances grow"
            curves.append(DrawnCurve(name=name, x=[speed] * 2, y=[0.0, largest], role="limit"))
    if not curves:
        return []
    caption = "Largest lateral motion of any axle, peak to peak. A ramp lags behind the limit cycle that it follows."
    return [
        Drawing(
            title="Hunting against speed",
            x_label="speed (km/h)",
            y_label="motion of an axle (mm)",
            curves=tuple(curves),
            caption=caption,
        )
    ]


_POINTS = 600
"""Of a ramp's line, at most twice as many."""


def _swing(name: str, frame: pl.DataFrame, role: Literal["line", "points"]) -> DrawnCurve:
    speeds = [3.6 * v for v in frame["v"].to_list()]
    return DrawnCurve(name=name, x=speeds, y=[1e3 * y for y in frame["swing"].to_list()], role=role)
