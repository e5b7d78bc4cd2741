"""Quantities of wheel forces that need more than one wheel or the wheel at rest, for tests that are run in time.

Each run has a `static` case beside it, the vehicle standing on straight level track, which gives every wheel's Q0
and the flange angle of its profile; it is not judged itself. Columns that are added to the frames:

| column | formula |
|---|---|
| `ws1.left.unloading` | (Q0 - Q)/Q0 of the wheel: 0 at rest, 1 where it lifts |
| `bogie1.left.unloading` | the same of all wheels on that side under the body, together |
| `bogie1.left.LV` | sum of Y over sum of Q of these wheels (truck-side L/V) |
| `ws1.left.nadal` | Y/Q over Nadal's limit, with the profile's own flange angle and the spec's friction |
| `ws1.prudhomme` | Y right - Y left over Prud'homme's limit |

Bodies that carry no wheels have none of them. The wheels under a body are those that bear on it through connections
with `carries_weight`: all wheels for a car body.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pydantic import Field

from lmap.errors import JudgementProblem
from lmap.formulas import nadal_limit, prudhomme_limit
from lmap.procedures.base import Table, unloading_units, wheelsets, with_unloading
from lmap.spec.case import Case, VehicleData, build
from lmap.spec.model import Spec
from lmap.view.model import resolved

if TYPE_CHECKING:
    import polars as pl


class Settings(Table):
    """Keys of `[test]` that every procedure with these columns has."""

    prudhomme_factor: float = Field(default=1.0, gt=0.0, allow_inf_nan=False)
    """K of Prud'homme's limit: 1.0 for locomotives and passenger vehicles, 0.85 for wagons (UIC 518, EN 14363)."""


STATIC = "static"
"""Label of the case at rest; the wheel profile's name follows where the spec names any."""
SIDES = ("left", "right")
_STANDING = ("creep", "friction", "gravity", "contact")
"""Keys of `[run]` that a vehicle at rest has a use for."""
_STANDING_TRACK = 200.0
"""m of straight level track under the vehicle at rest: any length that it fits on gives the same."""


def static_cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """The vehicle standing on straight level track, once for every wheel profile that the spec names."""
    track = {key: value for key, value in spec.track.items() if key in _RAILS} | {"length": _STANDING_TRACK}
    kept = {key: value for key, value in spec.run.rest.items() if key in _STANDING}
    cases = []
    for profile in _profiles(spec):
        run: dict[str, Any] = {"kind": "equilibrium", "speed": 0.0, **kept}
        own = profile or vehicle.wheel_profile
        if own is not None:
            run["wheel_profile"] = own
        cases.append(build(label=_static_label(profile), vehicle=vehicle, track=track, run=run))
    return cases


_RAILS = (
    "name",
    "title",
    "gauge",
    "gauge_point_depth",
    "rail_inclination",
    "rail_profile",
    "support",
)
"""Keys of `[track]` without layout and irregularity."""


def _profiles(spec: Spec) -> Sequence[str | None]:
    return spec.run.wheel_profile or [None]


def _static_label(profile: str | None) -> str:
    return STATIC if profile is None else f"{STATIC} {profile}"


def derived(spec: Spec, channels: Mapping[str, str]) -> dict[str, str]:
    """Name and unit of every column that `quantities` may add to frames with these channels."""
    axles = wheelsets(channels)
    bodies = [name.removesuffix(".theta") for name in channels if name.endswith(".theta")]
    added = unloading_units(channels) | {f"{axle}.prudhomme": "1" for axle in axles}
    for side in SIDES:
        added |= {f"{axle}.{side}.nadal": "1" for axle in axles}
        added |= {f"{body}.{side}.{part}": "1" for body in bodies for part in ("unloading", "LV")}
    return added


def quantities(
    spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
) -> Mapping[str, pl.DataFrame]:
    """Frames of the runs with the columns above, by label; the static ones are left out.

    Raises a `JudgementProblem` where the vehicle at rest is missing.
    """
    own = {key: value for key, value in spec.test.items() if key in Settings.model_fields}
    factor = Settings.model_validate(own).prudhomme_factor
    groups = wheels_under(vehicle)
    result = {}
    for label, frame in frames.items():
        if label == STATIC or label.startswith(f"{STATIC} "):
            continue
        at_rest = frames.get(_static_label(_profile_of(spec, label)))
        if at_rest is None:
            raise JudgementProblem("the vehicle at rest was not found: there are no static wheel loads")
        result[label] = with_unloading(frame, at_rest).with_columns(
            _columns(at_rest, groups, friction=_friction(spec), prudhomme_factor=factor)
        )
    return result


def _profile_of(spec: Spec, label: str) -> str | None:
    """The wheel profile of a run: its label begins with it."""
    for profile in spec.run.wheel_profile or ():
        if label == profile or label.startswith(f"{profile} "):
            return profile
    return None


def _friction(spec: Spec) -> float | None:
    """One coefficient for all wheels, where the spec has one."""
    return float(spec.run.friction) if isinstance(spec.run.friction, int | float) else None


def _columns(
    at_rest: pl.DataFrame,
    groups: Mapping[str, Sequence[str]],
    *,
    friction: float | None,
    prudhomme_factor: float,
) -> list[pl.Expr]:
    import polars as pl

    axles = wheelsets(at_rest.columns)
    q0 = {f"{axle}.{side}": float(at_rest.item(0, f"{axle}.{side}.Q")) for axle in axles for side in SIDES}
    columns: list[pl.Expr] = []
    if friction is not None:
        limit = nadal_limit(float(at_rest.item(0, "flange_angle")), friction)
        columns += [(pl.col(f"{wheel}.LV") / limit).alias(f"{wheel}.nadal") for wheel in q0]
    for axle in axles:
        limit = prudhomme_limit(q0[f"{axle}.left"] + q0[f"{axle}.right"], prudhomme_factor)
        columns.append((pl.col(f"{axle}.sum_Y") / limit).alias(f"{axle}.prudhomme"))
    for body, under in groups.items():
        for side in SIDES:
            lateral, vertical = (
                pl.sum_horizontal(f"{axle}.{side}.{part}" for axle in under) for part in ("Y", "Q")
            )
            load = sum(q0[f"{axle}.{side}"] for axle in under)
            columns.append((lateral / vertical).alias(f"{body}.{side}.LV"))
            columns.append((1.0 - vertical / load).alias(f"{body}.{side}.unloading"))
    return columns


def wheels_under(vehicle: VehicleData) -> dict[str, list[str]]:
    """The wheelsets that bear on each body, in order; bodies without any are left out."""
    model = resolved(vehicle)
    axles = [body.name for body in model.wheelsets]
    beside: dict[str, set[str]] = {body.name: set() for body in model.bodies}
    for connection in model.connections:
        if connection.carries_weight:
            one, other = connection.between
            beside.setdefault(one, set()).add(other)
            beside.setdefault(other, set()).add(one)
    height = _distances(axles, beside)
    found: dict[str, list[str]] = {}
    for axle in axles:
        # up alone: what stands on a bogie frame does not load the other bogie
        reached, level = {axle}, [axle]
        while level:
            above = {up for one in level for up in beside[one] if height[up] > height[one]} - reached
            reached |= above
            level = sorted(above)
        for body in model.bodies:
            if body.name in reached and body.name != axle:
                found.setdefault(body.name, []).append(axle)
    return found


def _distances(start: Sequence[str], beside: Mapping[str, set[str]]) -> dict[str, int]:
    """Connections from the nearest of `start` to everything that can be reached."""
    distance = dict.fromkeys(start, 0)
    level = list(start)
    while level:
        further = sorted({other for one in level for other in beside[one]} - distance.keys())
        distance |= dict.fromkeys(further, distance[level[0]] + 1)
        level = further
    return distance
