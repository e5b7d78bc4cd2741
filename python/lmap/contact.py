"""Wheel and rail in contact: figures of a profile pair, from the compiled core."""

from __future__ import annotations

import json
from typing import Any

from lmap import toml
from lmap.errors import InputProblem, SimulationProblem
from lmap.spec.case import Case


def read_profile(text: str, name: str) -> dict[str, Any]:
    """A profile's points (mm) from the text of its file, as a case holds them."""
    railsim = toml.core()
    try:
        profile: dict[str, Any] = json.loads(railsim.read_profile(text, name))
    except railsim.InputError as error:
        full = ("profiles", name)
        raise InputProblem(
            [p if p.key[:2] == full else p.at(prefix=full) for p in toml.problems_of_core(error)]
        ) from None
    return profile


def equivalent_conicity(case: Case, amplitude: float = 0.003) -> float:
    """Equivalent conicity (EN 15302) of a case's wheel on its rail at a lateral amplitude in m."""
    railsim = toml.core()
    try:
        return float(railsim.equivalent_conicity(case.json, amplitude))
    except railsim.RailsimError as error:
        raise SimulationProblem(str(error)) from None
