"""Contact of a case: its vehicle's wheels on its track."""

from __future__ import annotations

from lmap import toml
from lmap.errors import SimulationProblem
from lmap.spec.case import Case


def equivalent_conicity(case: Case, amplitude: float = 0.003) -> float:
    """Equivalent conicity (EN 15302) of a case's wheel on its rail at a lateral amplitude in m."""
    railsim = toml.core()
    try:
        return float(railsim.equivalent_conicity(case.core_json, amplitude, toml.tables()))
    except railsim.RailsimError as error:
        raise SimulationProblem(str(error)) from None
