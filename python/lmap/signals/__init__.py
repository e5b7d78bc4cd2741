"""Filters and statistics: the links of the chains that criteria are written as."""

from __future__ import annotations

from lmap.signals.base import Filter, Link, Reading, Statistic, signal_of
from lmap.signals.filters import Lowpass, RemoveMean, Skip
from lmap.signals.statistic import (
    AveragePeak,
    MaxAbs,
    Maximum,
    Mean,
    Minimum,
    PeakToPeak,
    Percentile,
    Rms,
    SlidingMean,
    SlidingRms,
    Sustained,
)

# Keep this list sorted by name.
LINKS: tuple[type[Link], ...] = (
    AveragePeak,
    Lowpass,
    MaxAbs,
    Maximum,
    Mean,
    Minimum,
    PeakToPeak,
    Percentile,
    RemoveMean,
    Rms,
    Skip,
    SlidingMean,
    SlidingRms,
    Sustained,
)
"""Every link that a chain may name."""

BY_NAME: dict[str, type[Link]] = {link.name: link for link in LINKS}

__all__ = ["BY_NAME", "LINKS", "Filter", "Link", "Reading", "Statistic", "signal_of"]
