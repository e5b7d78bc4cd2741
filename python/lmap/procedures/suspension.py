"""What the suspension should do by its description alone: sums and series of springs, no simulation.

Written for vehicles of one car body on bogies on wheelsets, or straight on wheelsets. SI units.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from lmap.errors import JudgementProblem
from lmap.view.model import Connection, Model

_NOTHING = ("anti_roll_bar", "bump_stop", "coupler", "maxwell", "point_damper")
"""Kinds that give no slow vertical force where both ends move straight down and no stop is touched."""


def bogies(model: Model, car: str) -> list[str]:
    """Bodies between the car body and wheelsets, from the front: tied to both."""
    rolling = {body.name for body in model.wheelsets}
    tied = {name: _tied(model.connections, name) for name in (body.name for body in model.bodies)}
    found = [
        body
        for body in model.bodies
        if body.name not in rolling | {car} and car in tied[body.name] and tied[body.name] & rolling
    ]
    return [body.name for body in sorted(found, key=lambda body: -body.position[0])]


def vertical_stiffness(model: Model, car: str) -> float:
    """Force on the rails for each metre that the car body sinks, N/m: secondary and primary springs in series.

    Axles are taken to stand still. Raises `JudgementProblem` for springs of which this cannot be said.
    """
    rolling = {body.name for body in model.wheelsets}
    total = _between(model.connections, {car}, rolling)
    for bogie in bogies(model, car):
        above = _between(model.connections, {car}, {bogie})
        below = _between(model.connections, {bogie}, rolling)
        if above > 0.0 and below > 0.0:
            total += above * below / (above + below)
    if total <= 0.0:
        raise JudgementProblem(f"no vertical spring of the description holds {car}")
    return total


def _tied(connections: Iterable[Connection], name: str) -> set[str]:
    return {end for one in connections if name in one.between for end in one.between} - {name}


def _between(connections: Iterable[Connection], upper: set[str], lower: set[str]) -> float:
    """Vertical stiffness of all connections between two sets of bodies, N/m."""
    return sum(
        _vertical(one)
        for one in connections
        if (one.between[0] in upper and one.between[1] in lower)
        or (one.between[1] in upper and one.between[0] in lower)
    )


def _vertical(one: Connection) -> float:
    """Vertical stiffness of a connection in its design position, N/m."""
    values = one.values
    if one.kind in _NOTHING:
        return 0.0
    if "axes" in values:
        raise JudgementProblem(f"{one.name} has axes of its own: its vertical stiffness is not worked out")
    if one.kind == "bushing":
        return float(values.get("stiffness", (0.0, 0.0, 0.0))[2])
    if one.kind == "bushing_matrix":
        return float(values["stiffness"][2][2])
    if one.kind == "shear_spring":
        return float(values["axial"])
    along = _along_vertical(one)
    if one.kind in ("point_spring", "traction_rod") and (along == 0.0 or "stiffness" in values):
        return along * along * float(values.get("stiffness", 0.0))
    raise JudgementProblem(f"{one.name}, a {one.kind}: its vertical stiffness is not worked out")


def _along_vertical(one: Connection) -> float:
    """Cosine between the line of a connection and the vertical."""
    direction = one.values.get("along", "line")
    if direction != "line":
        return 1.0 if direction == "z" else 0.0
    between = [b - a for a, b in zip(*one.points, strict=True)]
    length = math.hypot(*between)
    return between[2] / length if length > 0.0 else 1.0
