"""Sliding windows over time or distance: what a statistic sees at once.

A window is the samples within it, both ends counted. Windows that reach over an end of the record are left
out: a record shorter than the window has none, which is an error.
"""

from __future__ import annotations

from typing import Literal

import polars as pl

from lmap.errors import JudgementProblem

_TICKS = 1e9
"""Ticks per second or metre: windows are counted in whole nanoseconds or nanometres, so that rounding of
t = k * step does not drop a sample at a window's end."""


def slide(
    signal: pl.DataFrame,
    function: Literal["min", "max", "mean", "std"],
    *,
    over: Literal["t", "s"],
    length: float,
) -> pl.DataFrame:
    """`t`, `s`, `x` of every full window: its middle, and the function of its samples."""
    column = signal.get_column(over)
    unit = "s" if over == "t" else "m"
    if not column.is_sorted():
        raise JudgementProblem(f"{over} goes back, so a window of {length:g} {unit} has no meaning")
    span = float(column[-1]) - float(column[0])
    ticks = round(length * _TICKS)
    if round(span * _TICKS) < ticks:
        raise JudgementProblem(
            f"the record of {span:.4g} {unit} is shorter than the window of {length:g} {unit}"
        )
    other = "s" if over == "t" else "t"
    rolling = {
        "min": pl.col("x").rolling_min_by("tick", f"{ticks}i", closed="both"),
        "max": pl.col("x").rolling_max_by("tick", f"{ticks}i", closed="both"),
        "mean": pl.col("x").rolling_mean_by("tick", f"{ticks}i", closed="both"),
        "std": pl.col("x").rolling_std_by("tick", f"{ticks}i", closed="both", ddof=0),
    }[function]
    middle = pl.col(other).rolling_mean_by("tick", f"{ticks}i", closed="both").alias(other)
    return (
        signal.with_columns(tick=((pl.col(over) - pl.col(over).first()) * _TICKS).round().cast(pl.Int64))
        .with_columns(rolling.alias("x"), middle)
        .filter(pl.col("tick") >= ticks)
        .with_columns(pl.col(over) - length / 2.0)
        .select("t", "s", "x")
    )
