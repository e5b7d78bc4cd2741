"""Links that turn a signal into one number, with the place where it is."""

from __future__ import annotations

from typing import ClassVar, Self

import numpy as np
import polars as pl
from pydantic import Field, model_validator

from lmap.errors import JudgementProblem
from lmap.signals.base import Positive, Reading, Statistic
from lmap.signals.windows import Windowed


class AveragePeak(Statistic):
    """Largest mean height of the peaks within a sliding window.

    The run's mean is removed, the largest |x| of each half-wave between two zero crossings is a peak, and the
    mean of the peaks is taken over every window of `window_s` that lies within the record. The largest window
    counts. The half-waves cut off by the record's ends have no peak of their own. Windows with fewer than
    `min_peaks` are left out: the limit is meant for repeated motion, single transients excluded.
    """

    name: ClassVar[str] = "average_peak"
    window_s: Positive
    min_peaks: int = Field(default=2, ge=1)

    @property
    def is_magnitude(self) -> bool:
        """A mean of heights."""
        return True

    def read(self, signal: pl.DataFrame) -> Reading:
        """Value of the largest window, at its middle."""
        begin, end = (float(signal.get_column("t")[i]) for i in (0, -1))
        if end - begin < self.window_s * (1.0 - 1e-9):
            raise JudgementProblem(
                f"the record of {end - begin:.4g} s is shorter than the window of {self.window_s:g} s"
            )
        peaks = half_wave_peaks(signal)
        if peaks.is_empty():
            if signal.select((pl.col("x") == pl.col("x").first()).all()).item():
                return Reading(0.0, (begin + end) / 2.0, float(signal.get_column("s").to_numpy().mean()))
            raise JudgementProblem("the record has no complete half-wave, so no peak")
        t, height = peaks.get_column("t").to_numpy(), peaks.get_column("x").to_numpy()
        # The set of peaks in [a, a + w] changes only where a passes a peak or a peak less w: these and the
        # points between them meet every set that a sliding window can hold.
        last = max(end - self.window_s, begin)
        edges = np.unique(np.clip(np.concatenate((t, t - self.window_s, [begin, last])), begin, last))
        starts = np.sort(np.concatenate((edges, (edges[1:] + edges[:-1]) / 2.0)))
        slack = 1e-9 * self.window_s
        first = np.searchsorted(t, starts - slack, side="left")
        after = np.searchsorted(t, starts + self.window_s + slack, side="right")
        count = after - first
        total = np.concatenate(([0.0], np.cumsum(height)))
        enough = count >= self.min_peaks
        if not bool(enough.any()):
            raise JudgementProblem(f"no window of {self.window_s:g} s holds {self.min_peaks} peaks")
        mean = (total[after] - total[first])[enough] / count[enough]
        middle = starts[enough] + self.window_s / 2.0
        best = int(np.argmax(mean))
        place = float(np.interp(middle[best], signal.get_column("t"), signal.get_column("s")))
        curve = pl.DataFrame({"t": middle, "x": mean})
        return Reading(float(mean[best]), float(middle[best]), place, window_s=self.window_s, curve=curve)


def half_wave_peaks(signal: pl.DataFrame) -> pl.DataFrame:
    """`t`, `s`, `x` of the largest |x - mean| of every complete half-wave of a signal."""
    waves = (
        signal.with_columns(x=pl.col("x") - pl.col("x").mean())
        .with_columns(wave=(pl.col("x") > 0.0).rle_id())
        .group_by("wave", maintain_order=True)
        .agg(pl.col("t", "s").get(pl.col("x").abs().arg_max()), pl.col("x").abs().max())
    )
    return waves.slice(1, max(waves.height - 2, 0)).select("t", "s", "x")


class _Windowed(Windowed, Statistic):
    """A statistic over a sliding window."""

    def _largest(self, curve: pl.DataFrame) -> Reading:
        t, s, x = (curve.get_column(name).to_numpy() for name in ("t", "s", "x"))
        best = int(x.argmax())
        return Reading(
            float(x[best]),
            float(t[best]),
            float(s[best]),
            self.window_s,
            self.window_m,
            curve=curve.select("t", "x"),
        )


class Sustained(_Windowed):
    """Largest level that is held without break over a window: maximum of the sliding minimum (an erosion).

    The window is the samples within it, so a level that is held for the window less almost one sample already
    counts: the error is on the safe side. `absolute` judges |x|, which is what a limit on both signs means.
    """

    name: ClassVar[str] = "sustained"
    one_sided: ClassVar[bool] = True
    largest: ClassVar[bool] = True
    absolute: bool = False

    @property
    def is_magnitude(self) -> bool:
        """Only of |x|."""
        return self.absolute

    def read(self, signal: pl.DataFrame) -> Reading:
        """Value and the middle of its window."""
        if self.absolute:
            signal = signal.with_columns(pl.col("x").abs())
        return self._largest(self.slide(signal, "min"))


class SlidingMean(_Windowed):
    """Largest mean over a window (EN 14363 and UIC 518 read L/V so); `absolute` takes the mean's size."""

    name: ClassVar[str] = "sliding_mean"
    one_sided: ClassVar[bool] = True
    largest: ClassVar[bool] = True
    absolute: bool = False

    @property
    def is_magnitude(self) -> bool:
        """Only of |mean|."""
        return self.absolute

    def read(self, signal: pl.DataFrame) -> Reading:
        """Value and the middle of its window."""
        curve = self.slide(signal, "mean")
        return self._largest(curve.with_columns(pl.col("x").abs()) if self.absolute else curve)


class SlidingRms(_Windowed):
    """Largest root mean square within a window; with `about_mean` less the window's own mean (FRA: 2 s)."""

    name: ClassVar[str] = "sliding_rms"
    never_negative: ClassVar[bool] = True
    about_mean: bool = True

    def read(self, signal: pl.DataFrame) -> Reading:
        """Value and the middle of its window."""
        if self.about_mean:
            return self._largest(self.slide(signal, "std"))
        squares = self.slide(signal.with_columns(pl.col("x") ** 2), "mean")
        return self._largest(squares.with_columns(pl.col("x").sqrt()))


class MaxAbs(Statistic):
    """Largest |x|."""

    name: ClassVar[str] = "max_abs"
    never_negative: ClassVar[bool] = True

    def read(self, signal: pl.DataFrame) -> Reading:
        """Value and its sample."""
        return _extreme(signal.with_columns(pl.col("x").abs()))


class Maximum(Statistic):
    """Largest x."""

    name: ClassVar[str] = "maximum"
    one_sided: ClassVar[bool] = True

    def read(self, signal: pl.DataFrame) -> Reading:
        """Value and its sample."""
        return _extreme(signal)


class Minimum(Statistic):
    """Smallest x."""

    name: ClassVar[str] = "minimum"
    one_sided: ClassVar[bool] = True

    def read(self, signal: pl.DataFrame) -> Reading:
        """Value and its sample."""
        at = signal.row(int(signal.select(pl.col("x").arg_min()).item()), named=True)
        return Reading(at["x"], at["t"], at["s"])


class Last(Statistic):
    """x at the end of the run, or of a section: what has become of it."""

    name: ClassVar[str] = "last"

    def read(self, signal: pl.DataFrame) -> Reading:
        """Value and its sample."""
        at = signal.row(-1, named=True)
        return Reading(at["x"], at["t"], at["s"])


class Mean(Statistic):
    """Mean over the run."""

    name: ClassVar[str] = "mean"

    def read(self, signal: pl.DataFrame) -> Reading:
        """Value, placed in the middle of the record."""
        return _whole(signal, float(signal.select(pl.col("x").mean()).item()))


class Median(Statistic):
    """The value that half of the samples stay below: a quasi-static force of EN 14363; `absolute` of |x|."""

    name: ClassVar[str] = "median"
    absolute: bool = False

    @property
    def is_magnitude(self) -> bool:
        """Only of |x|."""
        return self.absolute

    def read(self, signal: pl.DataFrame) -> Reading:
        """Value, placed in the middle of the record."""
        x = pl.col("x").abs() if self.absolute else pl.col("x")
        return _whole(signal, float(signal.select(x.median()).item()))


class Rms(Statistic):
    """Root mean square over the run; with `about_mean` the standard deviation (population)."""

    name: ClassVar[str] = "rms"
    never_negative: ClassVar[bool] = True
    about_mean: bool = True

    def read(self, signal: pl.DataFrame) -> Reading:
        """Value, placed in the middle of the record."""
        x = pl.col("x") - pl.col("x").mean() if self.about_mean else pl.col("x")
        return _whole(signal, float(signal.select((x**2).mean().sqrt()).item()))


class Percentile(Statistic):
    """The value that `percent` of the samples stay below, interpolated; `absolute` of |x|.

    With `both_ends` the one of larger size of the percentiles `percent` and 100 - `percent`: EN 14363 and UIC 518
    read 99.85 and 0.15 %.
    """

    name: ClassVar[str] = "percentile"
    one_sided: ClassVar[bool] = True
    percent: float = Field(ge=0.0, le=100.0)
    absolute: bool = False
    both_ends: bool = False

    @model_validator(mode="after")
    def _one_reading(self) -> Self:
        if self.absolute and self.both_ends:
            raise ValueError("absolute or both_ends, not both")
        return self

    @property
    def is_magnitude(self) -> bool:
        """Of |x|, and of the larger end."""
        return self.absolute or self.both_ends

    def read(self, signal: pl.DataFrame) -> Reading:
        """Value, placed in the middle of the record."""
        x = pl.col("x").abs() if self.absolute else pl.col("x")
        value = float(signal.select(x.quantile(self.percent / 100.0, "linear")).item())
        if self.both_ends:
            other = float(signal.select(x.quantile(1.0 - self.percent / 100.0, "linear")).item())
            value = max(abs(value), abs(other))
        return _whole(signal, value)


class PeakToPeak(Statistic):
    """Largest less smallest x."""

    name: ClassVar[str] = "peak_to_peak"
    never_negative: ClassVar[bool] = True

    def read(self, signal: pl.DataFrame) -> Reading:
        """Value, placed at the largest x."""
        high, low = _extreme(signal), float(signal.select(pl.col("x").min()).item())
        return Reading(high.value - low, high.t, high.s)


def _arg_max(signal: pl.DataFrame) -> int:
    return int(signal.select(pl.col("x").arg_max()).item())


def _extreme(signal: pl.DataFrame) -> Reading:
    at = signal.row(_arg_max(signal), named=True)
    return Reading(at["x"], at["t"], at["s"])


def _whole(signal: pl.DataFrame, value: float) -> Reading:
    middle = signal.row(signal.height // 2, named=True)
    return Reading(value, middle["t"], middle["s"])
