"""Vertical wheel forces Q, left and right."""

from __future__ import annotations

from lmap.report.figures.channels import stacked
from lmap.report.figures.plot import Figure, samples, wheelsets
from lmap.verdict import CaseResult, SpecVerdict


def draw(spec: SpecVerdict) -> list[Figure]:
    """A row for each wheelset, both of its wheels in it."""
    caption = "Vertical wheel force Q of each wheelset, positive pressing on the rail."
    return stacked(spec, "Wheel loads", caption, {case.hash: _rows(case) for case in spec.cases})


def _rows(case: CaseResult) -> dict[str, list[str]]:
    columns = set(samples(case).columns)
    rows = {}
    for wheelset in wheelsets(case):
        channels = [f"{wheelset}.{side}.Q" for side in ("left", "right") if f"{wheelset}.{side}.Q" in columns]
        if channels:
            rows[f"{wheelset} Q"] = channels
    return rows
