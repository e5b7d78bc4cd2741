"""Which axles belong together: what tests ask of a vehicle's layout."""

from __future__ import annotations

from dataclasses import dataclass

from lmap.errors import InputProblem, Problem
from lmap.view.model import Body, Model


@dataclass(frozen=True, slots=True)
class Bogie:
    """A frame with its axles."""

    frame: Body
    axles: tuple[Body, ...]
    """Leading one first."""

    @property
    def centre(self) -> float:
        """Middle of its outer axles along the vehicle, m."""
        return (self.axles[0].position[0] + self.axles[-1].position[0]) / 2.0

    @property
    def wheelbase(self) -> float:
        """Between its outer axles, m."""
        return self.axles[0].position[0] - self.axles[-1].position[0]


def bogies(model: Model) -> list[Bogie]:
    """Frames that axles are connected to, the leading one first; a car body on its own axles is one of them."""
    by_name = {body.name: body for body in model.bodies}
    rolling = {axle.name for axle in model.wheelsets}
    held: dict[str, dict[str, Body]] = {}
    for connection in model.connections:
        for axle, frame in (connection.between, connection.between[::-1]):
            if axle in rolling and frame not in rolling:
                held.setdefault(frame, {})[axle] = by_name[axle]
    found = [
        Bogie(by_name[frame], tuple(sorted(axles.values(), key=lambda axle: -axle.position[0])))
        for frame, axles in held.items()
    ]
    return sorted(found, key=lambda bogie: -bogie.centre)


def two_bogies(model: Model) -> tuple[Bogie, Bogie]:
    """Leading and trailing bogie; an `InputProblem` for a vehicle that has not two."""
    found = bogies(model)
    if len(found) != 2 or any(len(bogie.axles) < 2 for bogie in found):
        text = f"{model.name} with {len(found)} frames on axles"
        raise InputProblem(Problem(key=("vehicle",), found=text, allowed="two bogies of two axles or more"))
    return found[0], found[1]
