"""The speed that was run, to see that it was held."""

from __future__ import annotations

from lmap.report.figures.channels import stacked
from lmap.report.figures.plot import Figure, samples
from lmap.verdict import SpecVerdict


def draw(spec: SpecVerdict) -> list[Figure]:
    """Channel `v` of every case that has it."""
    rows = {case.hash: {"v": ["v"]} for case in spec.cases if "v" in samples(case).columns}
    return stacked(spec, "Speed", "Speed of the vehicle along the track.", rows)
