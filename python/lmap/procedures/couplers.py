"""The coupler to an equal neighbour (LMAP 2C.3): which angles it makes with the two bodies along the track.

The vehicle behind is this one, one length over couplers back: it stands there as this one did when it was there, before
the run's start as at the start. Between the pivots of both couplers, each its `shank_m` behind the pulling face, runs a
straight line. Columns, rad, of the vehicle in front and of the one behind against their own longitudinal axis:

| column | angle |
|---|---|
| `coupler.front.yaw`, `coupler.rear.yaw` | sideways, + towards the right |
| `coupler.front.pitch`, `coupler.rear.pitch` | up and down, + downwards |

In a full curve all are L/2R (`lmap.formulas.coupler_angle`); where the curvature changes the two bodies' differ.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, ConfigDict, Field

from lmap.errors import InputProblem, Problem
from lmap.formulas import CANT_BASE
from lmap.verdict import Drawing, DrawnCurve
from lmap.view.model import Model

if TYPE_CHECKING:
    import polars as pl

Array = npt.NDArray[np.float64]

UNITS: Mapping[str, str] = {
    f"coupler.{which}.{way}": "rad" for which in ("front", "rear") for way in ("yaw", "pitch")
}

_STEP = 0.05
"""m between the points at which the track's line is summed."""
_BEFORE = 100.0
"""m of straight track before the run's."""
_LINEAR = ("tangent", "curve", "clothoid")


class Coupler(BaseModel):
    """`[test] coupler`."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    shank_m: float = Field(gt=0.0, allow_inf_nan=False)
    """From the pulling face back to the pivot."""


class Body(NamedTuple):
    """A body's end of its couplers, m in its axes from its centre of mass."""

    name: str
    length: float
    """Over couplers."""
    pivot: float
    """Of a coupler, before and behind the vehicle's middle."""
    centre: float
    """Of mass, before the vehicle's middle."""
    below: float
    """The couplers below the centre of mass."""


def body_of(model: Model, coupler: Coupler) -> Body:
    """The car body; an `InputProblem` where the vehicle says nothing of its couplers."""
    length, height = ends(model)
    body = model.bodies[0]
    return Body(
        body.name, length, length / 2.0 - coupler.shank_m, body.position[0], -height - body.position[2]
    )


def ends(model: Model) -> tuple[float, float]:
    """Length over couplers and height of the couplers above rail, m."""
    outline = model.outline
    if outline is None:
        found = f"{model.name} without [outline]"
        allowed = "length_over_couplers and coupler_height in its [outline]"
        raise InputProblem(Problem(key=("vehicle",), found=found, allowed=allowed))
    return float(outline["length_over_couplers"]), float(outline["coupler_height"])


class Line:
    """The design line of a track: origin and axes of its frame at a place."""

    def __init__(self, layout: Sequence[Mapping[str, Any]], end: float) -> None:
        places, values = _knots(layout)
        self._s = np.arange(-_BEFORE, end + _BEFORE, _STEP)
        curvature, gradient, sine = (np.interp(self._s, places, one) for one in values)
        self._heading = _summed(curvature)
        self._gradient, self._cant = gradient, np.arcsin(sine)
        level = np.cos(gradient)
        ahead = (level * np.cos(self._heading), level * np.sin(self._heading), -np.sin(gradient))
        self._origin = [_summed(one) for one in ahead]

    def at(self, s: Array) -> tuple[Array, Array]:
        """Origins (n, 3) and axes (n, 3, 3) at places."""
        heading, gradient, cant, *origin = (
            np.interp(s, self._s, one) for one in (self._heading, self._gradient, self._cant, *self._origin)
        )
        return np.stack(origin, axis=1), _z(heading) @ _y(gradient) @ _x(cant)


def _knots(layout: Sequence[Mapping[str, Any]]) -> tuple[list[float], list[list[float]]]:
    """Places between which curvature, gradient angle and sine of cant are linear, and these there."""
    levels: list[tuple[float, float, float] | None] = []
    for number, part in enumerate(layout):
        kind = part.get("kind")
        if kind not in _LINEAR:
            found, allowed = f'"{kind}"', "tangent, curve or clothoid, where the test has couplers"
            raise InputProblem(Problem(key=("track", "layout", number, "kind"), found=found, allowed=allowed))
        passing = kind == "clothoid"
        radius = float(part.get("radius", math.inf))
        sine = float(part.get("cant_mm", 0.0)) / (1e3 * CANT_BASE)
        levels.append(None if passing else (1.0 / radius, math.atan(float(part.get("gradient", 0.0))), sine))
    places, found_ = [0.0], [next((level for level in levels[:1] if level), (0.0, 0.0, 0.0))]
    for number, (part, level) in enumerate(zip(layout, levels, strict=True)):
        if level is not None and level != found_[-1]:
            places.append(places[-1])
            found_.append(level)
        places.append(places[-1] + float(part["length"]))
        found_.append(level or next((one for one in levels[number + 1 :] if one), found_[-1]))
    return places, [list(one) for one in zip(*found_, strict=True)]


def _summed(values: Array) -> Array:
    """The integral along the line, zero at its start."""
    return np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1])) * _STEP])


def _turn(angle: Array, first: int, second: int) -> Array:
    found = np.zeros((len(angle), 3, 3))
    found[:, range(3), range(3)] = 1.0
    found[:, first, first] = found[:, second, second] = np.cos(angle)
    found[:, first, second], found[:, second, first] = -np.sin(angle), np.sin(angle)
    return found


def _x(angle: Array) -> Array:
    return _turn(angle, 1, 2)


def _y(angle: Array) -> Array:
    return _turn(angle, 2, 0)


def _z(angle: Array) -> Array:
    return _turn(angle, 0, 1)


class _Pair(NamedTuple):
    """Both vehicles: pivots of the coupler between them (n, 3) and axes of the bodies (n, 3, 3)."""

    front: Array
    front_axes: Array
    rear: Array
    rear_axes: Array


def _pair(frame: pl.DataFrame, body: Body, line: Line) -> _Pair:
    s = frame["s"].to_numpy()

    def pivot(places: Array, ahead: float) -> tuple[Array, Array]:
        y, z, roll, pitch, yaw = (
            np.interp(places, s, frame[f"{body.name}.{part}"].to_numpy())
            for part in ("y", "z", "phi", "theta", "psi")
        )
        origin, track = line.at(places + body.centre)
        axes = track @ _z(yaw) @ _x(roll) @ _y(pitch)
        placed = np.stack([np.zeros_like(y), y, z], axis=1)
        arm = np.array([ahead - body.centre, 0.0, body.below])
        return origin + np.einsum("nij,nj->ni", track, placed) + axes @ arm, axes

    return _Pair(*pivot(s, -body.pivot), *pivot(s - body.length, body.pivot))


def with_angles(frame: pl.DataFrame, body: Body, line: Line) -> pl.DataFrame:
    """The frame with the columns above."""
    import polars as pl

    pair = _pair(frame, body, line)
    back = np.einsum("nji,nj->ni", pair.front_axes, pair.rear - pair.front)
    ahead = np.einsum("nji,nj->ni", pair.rear_axes, pair.front - pair.rear)
    found = {
        "coupler.front.yaw": np.arctan2(back[:, 1], -back[:, 0]),
        "coupler.front.pitch": np.arctan2(back[:, 2], -back[:, 0]),
        "coupler.rear.yaw": np.arctan2(ahead[:, 1], ahead[:, 0]),
        "coupler.rear.pitch": np.arctan2(ahead[:, 2], ahead[:, 0]),
    }
    return frame.with_columns(pl.Series(name, values) for name, values in found.items())


def drawing(label: str, frame: pl.DataFrame, body: Body, line: Line) -> Drawing:
    """Both bodies, their coupler and the track where its angle is largest: from above, or from the side."""
    sizes = {name: float(frame[name].abs().max()) for name in UNITS}  # type: ignore[arg-type]
    worst = max(sizes, key=lambda name: sizes[name])
    row = int(frame[worst].abs().arg_max() or 0)
    pair = _pair(frame[row : row + 1], body, line)
    s = float(frame["s"][row])
    down = worst.endswith("pitch")
    over = 2 if down else 1
    track = line.at(np.linspace(s - 1.5 * body.length, s + 0.5 * body.length, 60))[0]
    axis, across = pair.front_axes[0][:, 0], pair.front_axes[0][:, over]

    def seen(name: str, points: Array) -> DrawnCurve:
        """In the axes of the vehicle in front, from its pivot."""
        from_pivot = points - pair.front[0]
        x, y = (from_pivot @ axis).tolist(), (from_pivot @ across).tolist()
        return DrawnCurve(name=name, x=x, y=y)

    curves = [seen("track", track)]
    for name, pivot, axes, way in (
        ("in front", pair.front[0], pair.front_axes[0], 1.0),
        ("behind", pair.rear[0], pair.rear_axes[0], -1.0),
    ):
        far = pivot + way * 2.0 * body.pivot * axes[:, 0]
        curves.append(seen(f"body {name}, between its pivots", np.stack([pivot, far])))
    curves.append(seen("coupler", np.stack([pair.front[0], pair.rear[0]])))
    angle = math.degrees(float(frame[worst].abs()[row]))
    return Drawing(
        title=f"Coupler to an equal neighbour, {label}, from {'the side' if down else 'above'}",
        x_label="along the vehicle in front (m)",
        y_label="down (m)" if down else "right (m)",
        curves=tuple(curves),
        y_down=True,
        caption=f"At s = {s:.1f} m, where {worst} is largest: {angle:.2f} degrees. Scales differ.",
    )
