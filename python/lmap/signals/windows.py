"""Sliding windows over time or distance: what a statistic sees at once.

A window is the samples within it, both ends counted. Windows that reach over an end of the record are left
out: a record shorter than the window has none, which is an error.
"""

from __future__ import annotations

from typing import Literal, Self

import numpy as np
import polars as pl
from pydantic import model_validator

from lmap.errors import JudgementProblem
from lmap.signals.base import Link, Positive

_TICKS = 1e9
"""Ticks per second or metre: windows are counted in whole nanoseconds or nanometres, so that rounding of
t = k * step does not drop a sample at a window's end."""


def slide(
    signal: pl.DataFrame,
    function: Literal["min", "max", "mean", "std"],
    *,
    over: Literal["t", "s"],
    length: float,
    step: float | None = None,
) -> pl.DataFrame:
    """`t`, `s`, `x` of every full window: its middle, and the function of its samples.

    A window ends at every sample, or with `step` at the first sample after every so many s or m. One that holds a
    single sample says nothing about a stretch and is refused.
    """
    at = signal.get_column(over).to_numpy()
    unit = "s" if over == "t" else "m"
    gaps = np.diff(at)
    if bool((gaps < 0.0).any()):
        raise JudgementProblem(f"{over} goes back, so a window of {length:g} {unit} has no meaning")
    span = float(at[-1] - at[0])
    ticks = round(length * _TICKS)
    if round(span * _TICKS) < ticks:
        raise JudgementProblem(
            f"the record of {span:.4g} {unit} is shorter than the window of {length:g} {unit}"
        )
    if gaps.max(initial=0.0) > length * (1.0 + 1e-9):
        raise JudgementProblem(
            f"a window of {length:g} {unit} holds less than two samples: set run.output_step lower"
        )
    tick = np.rint((at - at[0]) * _TICKS).astype(np.int64)
    other = "s" if over == "t" else "t"
    rolling = {
        "min": pl.col("x").rolling_min_by("tick", f"{ticks}i", closed="both"),
        "max": pl.col("x").rolling_max_by("tick", f"{ticks}i", closed="both"),
        "mean": pl.col("x").rolling_mean_by("tick", f"{ticks}i", closed="both"),
        "std": pl.col("x").rolling_std_by("tick", f"{ticks}i", closed="both", ddof=0),
    }[function]
    middle = pl.col(other).rolling_mean_by("tick", f"{ticks}i", closed="both")
    rolled = pl.DataFrame(
        {"tick": tick, other: signal.get_column(other), "x": signal.get_column("x")}
    ).select(rolling, middle)
    full = tick >= ticks
    if step is not None:
        number = (tick - ticks) // max(1, round(step * _TICKS))
        full &= np.diff(number, prepend=-1) > 0
    found = {over: at - length / 2.0, **{name: rolled.get_column(name).to_numpy() for name in (other, "x")}}
    return pl.DataFrame({name: found[name][full] for name in ("t", "s", "x")})


class Windowed(Link):
    """A link with a sliding window of time or of distance, at every sample or every `step_s` or `step_m`."""

    window_s: Positive | None = None
    window_m: Positive | None = None
    step_s: Positive | None = None
    step_m: Positive | None = None

    @model_validator(mode="after")
    def _one_window(self) -> Self:
        if (self.window_s is None) == (self.window_m is None):
            raise ValueError("exactly one of window_s and window_m")
        if (self.window_s is None and self.step_s is not None) or (
            self.window_m is None and self.step_m is not None
        ):
            raise ValueError("step_s with window_s, step_m with window_m")
        return self

    def slide(self, signal: pl.DataFrame, function: Literal["min", "max", "mean", "std"]) -> pl.DataFrame:
        """The function of every window, at its middle."""
        if self.window_s is not None:
            return slide(signal, function, over="t", length=self.window_s, step=self.step_s)
        assert self.window_m is not None  # the validator's other branch
        return slide(signal, function, over="s", length=self.window_m, step=self.step_m)
