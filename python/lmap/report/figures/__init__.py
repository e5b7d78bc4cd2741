"""The plots of the report: one file each, every one a function from a spec's results to figures."""

from __future__ import annotations

from collections.abc import Callable

from lmap.report.figures import criterion, drawing, speed, track_irregularity, wheel_load, wheelset_lateral
from lmap.report.figures.plot import Figure
from lmap.verdict import SpecVerdict

# Keep this list sorted by module; the page shows the figures in this order.
FIGURES: tuple[Callable[[SpecVerdict], list[Figure]], ...] = (
    criterion.draw,
    drawing.draw,
    speed.draw,
    track_irregularity.draw,
    wheel_load.draw,
    wheelset_lateral.draw,
)
"""Every plot. A figure that finds none of its channels gives an empty list."""

__all__ = ["FIGURES", "Figure"]
