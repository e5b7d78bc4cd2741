"""Motions for the drawing: mode shapes, and the channels of a run, as plain data that the page plays."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from lmap.errors import InputProblem, Problem, listed
from lmap.view.model import Model
from lmap.view.shapes import shapes

if TYPE_CHECKING:
    import polars as pl

COORDINATES = ("x", "y", "z", "phi", "theta", "psi")
"""Of a body: displacements (m) forward, right, down, then roll, pitch, yaw (rad)."""

AMPLITUDE = 0.3
"""m that the farthest point of a mode shape moves at magnification 1: a shape has no size of its own."""

ROWS_PER_SECOND = 25.0
MOST_ROWS = 3000
"""A run is thinned to this for the screen."""

_DIGITS = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class Mode:
    """One mode."""

    name: str
    frequency: float
    """Hz, of the damped motion."""
    damping_ratio: float
    """Part of critical; negative grows."""
    shape: Mapping[str, Sequence[complex]]
    """By body, `COORDINATES` in this order; of any size."""
    speed: float | None = None
    """m/s; 0 stands, none: not said."""


def modes_of(frame: pl.DataFrame, below: float = 30.0) -> list[Mode]:
    """Modes that oscillate, up to a frequency in Hz, from a frame with a row each.

    Columns: `name`, `v` (m/s), `frequency` (Hz), `damping_ratio`, and `re.<body>.<coordinate>` with its `im.`.
    """
    bodies: dict[str, list[str]] = {}
    for column in frame.columns:
        part, _, rest = column.partition(".")
        body, _, coordinate = rest.rpartition(".")
        if part == "re" and coordinate in COORDINATES:
            bodies.setdefault(body, []).append(coordinate)
    found = []
    for row in frame.iter_rows(named=True):
        if not 0.0 < row["frequency"] <= below:
            continue
        shape = {
            body: [
                complex(row[f"re.{body}.{name}"], row[f"im.{body}.{name}"]) if name in own else 0.0
                for name in COORDINATES
            ]
            for body, own in bodies.items()
        }
        found.append(
            Mode(
                name=str(row["name"]),
                frequency=float(row["frequency"]),
                damping_ratio=float(row["damping_ratio"]),
                shape=shape,
                speed=None if row.get("v") is None else float(row["v"]),
            )
        )
    return found


def mode_motions(modes: Sequence[Mode], model: Model) -> list[dict[str, Any]]:
    """Mode shapes in a size that can be seen: at magnification 1 the farthest point moves `AMPLITUDE`."""
    arms = {name: _arms(model, name) for name in (body.name for body in model.bodies)}
    found = []
    for mode in modes:
        shape = {body: [complex(value) for value in q] for body, q in mode.shape.items() if body in arms}
        largest = max((_travel(q, arm) for body, q in shape.items() for arm in arms[body]), default=0.0)
        if not (math.isfinite(largest) and largest > 0.0):
            continue
        scale = AMPLITUDE / largest
        where = ""
        if mode.speed is not None:
            where = ", standing" if mode.speed == 0.0 else f", {mode.speed * 3.6:.0f} km/h"
        found.append(
            {
                "kind": "mode",
                "title": f"{mode.name}: {mode.frequency:.2f} Hz, damping {100.0 * mode.damping_ratio:.1f} %{where}",
                "grows": mode.damping_ratio < 0.0,
                "bodies": {
                    body: [
                        [round(scale * value.real, _DIGITS), round(scale * value.imag, _DIGITS)]
                        for value in q
                    ]
                    for body, q in shape.items()
                },
            }
        )
    return found


def run_motion(frame: pl.DataFrame, model: Model, title: str) -> dict[str, Any]:
    """A run's motion from its channels (`carbody.y`, `carbody.phi`, ...), as displacements from the design position.

    Thinned to some 25 rows a second, evenly; the track's own curve is not drawn, bodies move against its frame.
    Raises `InputProblem` where the frame has no time or moves nothing of this vehicle.
    """
    import polars as pl

    known = set(frame.columns)
    numeric = {name for name, kind in frame.schema.items() if kind.is_numeric()}
    moving = {
        body.name: [name for name in COORDINATES if f"{body.name}.{name}" in numeric] for body in model.bodies
    }
    moving = {body: names for body, names in moving.items() if names}
    if "t" not in numeric or not moving:
        what = "no column t" if "t" not in known else "no motion of any body of this vehicle"
        wanted = listed(f"{body.name}.y" for body in model.bodies)
        raise InputProblem(
            Problem(found=f"{what} in {listed(frame.columns, 6) or 'an empty frame'}", allowed=f"t, {wanted}")
        )
    wanted_columns = ["t", *(f"{body}.{name}" for body, names in moving.items() for name in names)]
    rows = frame.select(pl.col(wanted_columns).cast(pl.Float64)).filter(
        pl.all_horizontal(pl.all().is_finite().fill_null(False))
    )
    if rows.height < 2:
        raise InputProblem(Problem(found=f"{rows.height} rows of motion", allowed="two or more, all finite"))
    span = float(rows["t"][-1] - rows["t"][0])
    most = max(2, min(MOST_ROWS, math.ceil(span * ROWS_PER_SECOND) + 1))
    rows = rows.gather_every(max(1, math.ceil(rows.height / most)))
    at = {body.name: dict(zip(COORDINATES, body.position, strict=False)) for body in model.bodies}
    return {
        "kind": "run",
        "title": title,
        "t": [round(value, 4) for value in rows["t"].to_list()],
        "bodies": {
            body: {
                # lengthwise the bodies travel: x, where there is one, is against the moving frame already
                name: [
                    round(value - (at[body].get(name, 0.0) if name in ("y", "z") else 0.0), _DIGITS)
                    for value in rows[f"{body}.{name}"].to_list()
                ]
                for name in names
            }
            for body, names in moving.items()
        },
    }


def _arms(model: Model, name: str) -> list[tuple[float, float, float]]:
    """Corners of a body's bounding box from its centre of mass, m."""
    [body] = [one for one in model.bodies if one.name == name]
    points = [vertex for shape in shapes(model)[name] for vertex in shape.solid().vertices]
    least = [min(point[i] for point in points) - body.position[i] for i in range(3)]
    most = [max(point[i] for point in points) - body.position[i] for i in range(3)]
    return [(x, y, z) for x in (least[0], most[0]) for y in (least[1], most[1]) for z in (least[2], most[2])]


def _travel(q: Sequence[complex], arm: tuple[float, float, float]) -> float:
    """How far a point moves at most, small rotations, m."""
    x, y, z, phi, theta, psi = q
    ax, ay, az = arm
    moves = (x + theta * az - psi * ay, y + psi * ax - phi * az, z + phi * ay - theta * ax)
    return math.sqrt(sum(abs(move) ** 2 for move in moves))
