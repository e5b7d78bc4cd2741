"""The couplers of a run (`run.couplers`) as drawn: vehicle and neighbour where the angle between them is largest.

The angles are the core's channels `coupler.{front,rear}.{yaw,pitch}`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from lmap.spec.case import VehicleData
from lmap.spec.model import Spec
from lmap.verdict import Drawing, DrawnCurve
from lmap.view.model import resolved

if TYPE_CHECKING:
    import polars as pl

Array = npt.NDArray[np.float64]

_WAYS = {"front": 1.0, "rear": -1.0}
_OTHER = {"front": "rear", "rear": "front"}
_SEEN = {"yaw": ("above", "right (m)"), "pitch": ("the side", "up (m)")}
_CHANNELS = [f"coupler.{end}.{plane}" for end in _WAYS for plane in _SEEN]


def drawings(spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData) -> list[Drawing]:
    """One for each frame; none where the run has no couplers."""
    written, outline = spec.run.rest.get("couplers"), resolved(vehicle).outline
    if written is None or outline is None:
        return []
    length = float(outline["length_over_couplers"])
    equal = not {"neighbour_length", "neighbour_pivots"} & set(written)
    shank = float(written["shank"])
    return [_drawing(label, frame, length, shank, equal=equal) for label, frame in frames.items()]


def _drawing(label: str, frame: pl.DataFrame, length: float, shank: float, *, equal: bool) -> Drawing:
    """In the vehicle's axes, from its pivot.

    An equal neighbour has at its coupler the angle that this vehicle has there when it stands in the neighbour's place.
    """
    largest = {name: frame[name].abs().max() for name in _CHANNELS}
    worst = max(_CHANNELS, key=lambda name: largest[name])  # type: ignore[arg-type, return-value]
    _, end, plane = worst.split(".")
    row = int(frame[worst].abs().arg_max() or 0)
    s, angle, way = float(frame["s"][row]), float(frame[worst][row]), _WAYS[end]
    body = way * (length - 2.0 * shank)
    pivot = np.zeros(2)
    far = pivot + 2.0 * shank * _towards(way, angle)
    curves = [
        _line("vehicle, between its pivots", np.array([-body, 0.0]), pivot),
        _line("coupler", pivot, far),
    ]
    if equal:
        its = f"coupler.{_OTHER[end]}.{plane}"
        turned = angle + float(np.interp(s + way * length, frame["s"], frame[its]))
        curves.append(_line("neighbour, between its pivots", far, far + abs(body) * _towards(way, turned)))
    seen, across = _SEEN[plane]
    return Drawing(
        title=f"Coupler to the neighbour, {label}, from {seen}",
        x_label="along the vehicle (m)",
        y_label=across,
        curves=tuple(curves),
        y_down=plane == "yaw",
        caption=f"At s = {s:.1f} m, where {worst} is largest: {math.degrees(abs(angle)):.2f} degrees. Scales differ.",
    )


def _towards(way: float, angle: float) -> Array:
    return np.array([way * math.cos(angle), math.sin(angle)])


def _line(name: str, *points: Array) -> DrawnCurve:
    x, y = np.stack(points, axis=1).tolist()
    return DrawnCurve(name=name, x=x, y=y)
