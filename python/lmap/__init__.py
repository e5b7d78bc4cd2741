"""LMAP: locomotive models, simulated and judged.

    import lmap

    acceptance = lmap.check("hunting", set={"run.speed_kmh": 126.5})
    print(acceptance.outcome)
    locomotive = lmap.Vehicle.load("coco134")

Importing this is cheap: polars, pydantic and scipy are imported where they are used.
"""

from __future__ import annotations

from lmap.check import check
from lmap.errors import InputProblem, JudgementProblem, LmapError, SimulationProblem
from lmap.simulate import simulate
from lmap.vehicle import Vehicle
from lmap.verdict import Acceptance, CriterionVerdict, Outcome, SpecVerdict

__all__ = [
    "Acceptance",
    "CriterionVerdict",
    "InputProblem",
    "JudgementProblem",
    "LmapError",
    "Outcome",
    "SimulationProblem",
    "SpecVerdict",
    "Vehicle",
    "check",
    "simulate",
]
