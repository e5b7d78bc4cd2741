"""Lateral displacement of the wheelsets: the eye sees hunting here first."""

from __future__ import annotations

from lmap.report.figures.channels import stacked
from lmap.report.figures.plot import Figure, samples, wheelsets
from lmap.verdict import SpecVerdict


def draw(spec: SpecVerdict) -> list[Figure]:
    """A row for each wheelset, all to one scale."""
    rows = {}
    for case in spec.cases:
        columns = set(samples(case).columns)
        rows[case.hash] = {f"{name} y": [f"{name}.y"] for name in wheelsets(case) if f"{name}.y" in columns}
    caption = (
        "Lateral displacement of each wheelset from the design centre line, positive to the right. "
        "Hunting shows as an oscillation that does not die away."
    )
    return stacked(spec, "Lateral displacement of the wheelsets", caption, rows)
