"""Links that turn a signal into a signal."""

from __future__ import annotations

import math
from typing import ClassVar, Self

import polars as pl
from pydantic import Field, model_validator

from lmap.errors import JudgementProblem
from lmap.signals.base import Filter, NotNegative, Positive, sample_step


class Lowpass(Filter):
    """Butterworth low-pass, -3 dB at `cutoff_hz`.

    With `zero_phase` a filter of half the order runs forward and back, so that peaks stay where they are on
    the track. The pair is -3 dB at `cutoff_hz` when each half's corner is raised by 1/(sqrt 2 - 1)^(1/order),
    which is 1.247 for the 4-pole. The factor is applied to the pre-warped frequency tan(pi f / rate), so that
    it also holds where the cut-off is a sizeable part of the sampling rate. `trim_s` is cut at both ends,
    where the filter sees no past or no future. Refuses a signal sampled slower than `min_rate_hz` (FRA asks
    200 samples/s of the acceleration filter).
    """

    name: ClassVar[str] = "lowpass"
    cutoff_hz: Positive
    order: int = Field(default=4, ge=1, le=12)
    zero_phase: bool = True
    trim_s: NotNegative = 1.0
    min_rate_hz: Positive = 200.0

    @model_validator(mode="after")
    def _even_order(self) -> Self:
        if self.zero_phase and self.order % 2:
            raise ValueError("an even order with zero_phase: half of it runs each way")
        return self

    def apply(self, signal: pl.DataFrame) -> pl.DataFrame:
        """The filtered signal without its two ends."""
        from scipy.signal import butter, sosfilt, sosfilt_zi, sosfiltfilt

        rate = 1.0 / sample_step(signal)
        if rate < self.min_rate_hz * (1.0 - 1e-6):
            raise JudgementProblem(
                f"sampled at {rate:.4g} per second, the low-pass asks for {self.min_rate_hz:g} or more: "
                f"set run.output_step to {1.0 / self.min_rate_hz:g} s or less"
            )
        raised = 1.0 / (math.sqrt(2.0) - 1.0) ** (1.0 / self.order) if self.zero_phase else 1.0
        corner = rate / math.pi * math.atan(raised * math.tan(math.pi * self.cutoff_hz / rate))
        if not self.cutoff_hz < corner * 1.000001 < rate / 2.0:
            raise JudgementProblem(
                f"a cut-off of {self.cutoff_hz:g} Hz is too high for {rate:.4g} samples per second"
            )
        values = signal.get_column("x").to_numpy()
        poles = self.order // 2 if self.zero_phase else self.order
        sections = butter(poles, corner, btype="low", output="sos", fs=rate)
        trim = round(self.trim_s * rate)
        # scipy's own default padding; a signal no longer than this, or than both ends, leaves nothing
        pad = 3 * (2 * len(sections) + 1)
        if signal.height <= max(2 * trim, pad):
            raise JudgementProblem(
                f"{signal.height} samples ({signal.height / rate:.3g} s) are too few: "
                f"{self.trim_s:g} s are cut at each end"
            )
        if self.zero_phase:
            filtered = sosfiltfilt(sections, values, padlen=pad)
        else:
            filtered, _ = sosfilt(sections, values, zi=sosfilt_zi(sections) * values[0])
        return signal.with_columns(x=pl.Series(filtered)).slice(trim, signal.height - 2 * trim)


class RemoveMean(Filter):
    """The signal less its mean over the whole run."""

    name: ClassVar[str] = "remove_mean"

    def apply(self, signal: pl.DataFrame) -> pl.DataFrame:
        """The signal about zero."""
        return signal.with_columns(x=pl.col("x") - pl.col("x").mean())


class Skip(Filter):
    """The signal without its first `start_s` seconds or `start_m` metres: a run-in that a spec declares."""

    name: ClassVar[str] = "skip"
    start_s: NotNegative = 0.0
    start_m: NotNegative = 0.0

    def apply(self, signal: pl.DataFrame) -> pl.DataFrame:
        """What comes after; nothing left is an error."""
        rest = signal.filter(
            pl.col("t") - pl.col("t").first() >= self.start_s,
            pl.col("s") - pl.col("s").first() >= self.start_m,
        )
        if rest.is_empty():
            raise JudgementProblem("nothing is left after the part that is skipped")
        return rest
