"""What a link of a chain is: a frozen pydantic model with its parameters, named as in specs.

A signal is a frame with three columns: `t` (s), `s` (m) and `x` (the values). A filter turns a signal into a
signal, a statistic turns it into a reading.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar

import numpy as np
import numpy.typing as npt
import polars as pl
from pydantic import BaseModel, ConfigDict, Field

from lmap.errors import JudgementProblem

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
"""A finite number above zero."""
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
"""A finite number, zero or above."""

STEP_TOLERANCE = 1e-6
"""Relative unevenness of `t` that still counts as evenly sampled: rounding of t = k * step."""


@dataclass(frozen=True, slots=True)
class Reading:
    """A statistic's value and where it is."""

    value: float
    t: float
    """Time of the extreme, or the middle of its window, s."""
    s: float
    """Distance there, m."""
    window_s: float | None = None
    window_m: float | None = None
    curve: pl.DataFrame | None = field(default=None, compare=False)
    """Columns `t`, `x`: the statistic along the run, for plots, where it has one."""

    def at(self) -> dict[str, float]:
        """Where, as plain data."""
        place = {"t": self.t, "s": self.s}
        if self.window_s is not None:
            place["window_s"] = self.window_s
        if self.window_m is not None:
            place["window_m"] = self.window_m
        return place


class Link(BaseModel, ABC):
    """One link of a chain."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)
    name: ClassVar[str]

    def written(self) -> dict[str, Any]:
        """The link as a spec writes it: `{lowpass = {cutoff_hz = 10.0}}`, defaults left out."""
        return {self.name: self.model_dump(exclude_defaults=True, exclude_none=True)}


class Filter(Link):
    """A link that turns a signal into a signal."""

    @abstractmethod
    def apply(self, signal: pl.DataFrame) -> pl.DataFrame:
        """The filtered signal, with the columns `t`, `s`, `x`."""


class Statistic(Link):
    """A link that turns a signal into one number."""

    one_sided: ClassVar[bool] = False
    """Whether a signal's motion to one side alone gives the number: the other side then needs `absolute`."""
    largest: ClassVar[bool] = False
    """Whether the number is the largest of many levels: that it keeps a least value says little of the rest."""
    reads: ClassVar[str | None] = None
    """Unit that the signal must come in; none: the criterion's."""
    gives: ClassVar[str | None] = None
    """Unit of the number; none: the signal's."""
    never_negative: ClassVar[bool] = False
    """Whether that is so whatever its keys say."""

    @abstractmethod
    def read(self, signal: pl.DataFrame) -> Reading:
        """The number and where it is; a `JudgementProblem` where there is none."""

    @property
    def is_magnitude(self) -> bool:
        """Whether the value is never negative, so that a limit line stands on both sides of the signal."""
        return self.never_negative


class Joint(Statistic):
    """A statistic that makes one number of several signals: the directions x, y and z, in this order."""

    count: ClassVar[int] = 3

    def read(self, signal: pl.DataFrame) -> Reading:
        """One signal alone is not enough."""
        raise JudgementProblem(f"{self.name} joins {self.count} signals: they are shown as recorded")

    @abstractmethod
    def read_together(self, signals: Sequence[pl.DataFrame]) -> Reading:
        """The number; a `JudgementProblem` where there is none."""


COUNTED = ("step", "mode", "critical_speed")
"""A frame with one of these and without `t` is an analysis: its rows are counted."""


def counted(columns: Collection[str]) -> str | None:
    """What the rows of a frame with these columns count; none where they are moments of a run."""
    return None if "t" in columns else next((name for name in COUNTED if name in columns), None)


def signal_of(frame: pl.DataFrame, name: str, factor: float = 1.0) -> pl.DataFrame:
    """The channel `name` of a frame as a signal; refuses what is missing, empty, no number or not finite.

    Rows that are not evenly spaced in time are refused too: some are missing. Where rows are load steps, modes
    or speeds instead, their number stands for the time.
    """
    known = set(frame.columns)
    columns = {column: frame.get_column(column) for column in ("t", "s", name) if column in known}
    if counted(known) is not None:
        columns["t"] = pl.Series("t", range(frame.height), dtype=pl.Float64)
        columns.setdefault("s", pl.Series("s", [0.0] * frame.height, dtype=pl.Float64))
    for column in ("t", "s", name):
        if column not in columns:
            raise JudgementProblem(f"the frame has no channel {column}")
    for column in ("t", "s", name):
        if not columns[column].dtype.is_numeric():
            raise JudgementProblem(f"{column} holds no numbers but {columns[column].dtype}")
    if frame.is_empty():
        raise JudgementProblem(f"{name} has no samples")
    # numpy, not polars: a criterion reads a dozen wheels, and a query costs more than its thousand numbers
    t, s, x = (columns[column].cast(pl.Float64).to_numpy() for column in ("t", "s", name))
    x = x * factor
    bad = ~(np.isfinite(t) & np.isfinite(s) & np.isfinite(x))
    if bool(np.isnan(x).all()):
        raise JudgementProblem(f"{name} has no value in this run")
    if bool(bad.any()):
        when = t[bad.argmax()]
        place = f", first at t = {when:.3f} s" if math.isfinite(when) else ""
        raise JudgementProblem(f"{name} is not finite in {int(bad.sum())} of {frame.height} samples{place}")
    if len(t) > 1:
        _step_of(t)  # a missing row could have been the worst
    return pl.DataFrame({"t": t, "s": s, "x": x})


def sample_step(signal: pl.DataFrame) -> float:
    """The time between samples, s; refuses a signal that is not evenly sampled."""
    if signal.height < 2:
        raise JudgementProblem(f"{signal.height} sample is too few to filter")
    return _step_of(signal.get_column("t").to_numpy())


def _step_of(t: npt.NDArray[np.float64]) -> float:
    first, last = float(t[0]), float(t[-1])
    mean = (last - first) / (len(t) - 1)
    steps = np.diff(t)
    least, most = float(steps.min()), float(steps.max())
    slack = STEP_TOLERANCE * abs(mean) + 4.0 * 2.3e-16 * max(abs(first), abs(last))
    if mean <= 0.0 or most - mean > slack or mean - least > slack:
        raise JudgementProblem(f"t is not evenly spaced: steps from {least:.6g} to {most:.6g} s")
    return mean
