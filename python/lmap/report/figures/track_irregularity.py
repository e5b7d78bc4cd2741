"""The track's deviation from its design, where the frame has it."""

from __future__ import annotations

from lmap.report.figures.channels import stacked
from lmap.report.figures.plot import Figure, samples
from lmap.verdict import SpecVerdict


def draw(spec: SpecVerdict) -> list[Figure]:
    """A row for each channel `track.*`, of every case that has any."""
    rows = {
        case.hash: {
            name.removeprefix("track.").replace("_", " "): [name]
            for name in samples(case).columns
            if name.startswith("track.")
        }
        for case in spec.cases
    }
    return stacked(spec, "Track irregularity", "Deviation of the track from its design, as run over.", rows)
