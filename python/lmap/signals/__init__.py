"""Filters and statistics: the links of the chains that criteria are written as."""

from __future__ import annotations

from lmap.signals.base import COUNTED, Filter, Joint, Link, Reading, Statistic, counted, signal_of
from lmap.signals.comfort import MeanComfort, Sperling, VibrationTotal, Weight
from lmap.signals.filters import Bandpass, BandpassDominant, Lowpass, MovingMean, RemoveMean, Section, Skip
from lmap.signals.statistic import (
    AveragePeak,
    Last,
    MaxAbs,
    Maximum,
    Mean,
    Median,
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
    Bandpass,
    BandpassDominant,
    Last,
    Lowpass,
    MaxAbs,
    Maximum,
    Mean,
    MeanComfort,
    Median,
    Minimum,
    MovingMean,
    PeakToPeak,
    Percentile,
    RemoveMean,
    Rms,
    Section,
    Skip,
    SlidingMean,
    SlidingRms,
    Sperling,
    Sustained,
    VibrationTotal,
    Weight,
)
"""Every link that a chain may name."""

BY_NAME: dict[str, type[Link]] = {link.name: link for link in LINKS}

__all__ = [
    "BY_NAME",
    "COUNTED",
    "LINKS",
    "Filter",
    "Joint",
    "Link",
    "Reading",
    "Statistic",
    "counted",
    "signal_of",
]
