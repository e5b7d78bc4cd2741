"""Links that turn a signal into a signal."""

from __future__ import annotations

import functools
import math
from typing import Any, ClassVar, Literal, Self

import polars as pl
from pydantic import Field, model_validator

from lmap.errors import JudgementProblem
from lmap.signals.base import Filter, NotNegative, Positive, sample_step
from lmap.signals.windows import Windowed

_HALF_POWER = math.sqrt(2.0) - 1.0
"""(f / corner)^(2 n) of an n-pole Butterworth filter where two of them in a row are -3 dB."""


class _Butterworth(Filter):
    """What the Butterworth filters share: order, direction, ends, least rate."""

    order: int = Field(default=4, ge=1, le=12)
    zero_phase: bool = True
    trim_s: NotNegative = 1.0
    min_rate_hz: Positive = 200.0

    @model_validator(mode="after")
    def _even_order(self) -> Self:
        if self.zero_phase and self.order % 2:
            raise ValueError("an even order with zero_phase: half of it runs each way")
        return self

    @property
    def _poles(self) -> int:
        return self.order // 2 if self.zero_phase else self.order

    def _rate(self, signal: pl.DataFrame) -> float:
        rate = 1.0 / sample_step(signal)
        if rate < self.min_rate_hz * (1.0 - 1e-6):
            raise JudgementProblem(
                f"sampled at {rate:.4g} per second, the {self.name} asks for {self.min_rate_hz:g} or more: "
                f"set run.output_step to {1.0 / self.min_rate_hz:g} s or less"
            )
        return rate

    def _run(self, signal: pl.DataFrame, sections: Any, rate: float, pad: int) -> pl.DataFrame:
        """The signal through the filter, without its ends; `pad` samples are made up beyond either of them."""
        from scipy.signal import sosfilt, sosfilt_zi, sosfiltfilt

        values = signal.get_column("x").to_numpy()
        trim = round(self.trim_s * rate)
        # a signal no longer than its padding, or than both ends, leaves nothing
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


class Lowpass(_Butterworth):
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

    def apply(self, signal: pl.DataFrame) -> pl.DataFrame:
        """The filtered signal without its two ends."""
        rate = self._rate(signal)
        raised = _HALF_POWER ** (-1.0 / self.order) if self.zero_phase else 1.0
        corner = rate / math.pi * math.atan(raised * math.tan(math.pi * self.cutoff_hz / rate))
        if not self.cutoff_hz < corner * 1.000001 < rate / 2.0:
            raise JudgementProblem(
                f"a cut-off of {self.cutoff_hz:g} Hz is too high for {rate:.4g} samples per second"
            )
        sections = _designed(self._poles, "low", (corner,), rate)
        return self._run(signal, sections, rate, _padding(sections))


class Bandpass(_Butterworth):
    """Butterworth band-pass, -3 dB at `low_hz` and `high_hz`; `order` poles at either side of the band.

    EN 14363 reads ride accelerations between 0.4 and 10 Hz. With `zero_phase` a filter of half the order runs
    forward and back; each half's band is widened by 1/(sqrt 2 - 1)^(1/order) about the same centre (of pre-warped
    frequencies), so that the pair is -3 dB at both ends. The rest is as of `lowpass`; two periods of `low_hz` are
    made up beyond the ends, and `trim_s` has to be of that size for the ends to be forgotten.
    """

    name: ClassVar[str] = "bandpass"
    low_hz: Positive
    high_hz: Positive

    @model_validator(mode="after")
    def _a_band(self) -> Self:
        if self.low_hz >= self.high_hz:
            raise ValueError("a low_hz below high_hz")
        return self

    def apply(self, signal: pl.DataFrame) -> pl.DataFrame:
        """The filtered signal without its two ends."""
        return self._between(signal, self.low_hz, self.high_hz)

    def _between(self, signal: pl.DataFrame, low_hz: float, high_hz: float) -> pl.DataFrame:
        rate = self._rate(signal)
        if high_hz >= rate / 2.0:
            raise JudgementProblem(
                f"a band up to {high_hz:g} Hz is too high for {rate:.4g} samples per second"
            )
        low, high = (math.tan(math.pi * f / rate) for f in (low_hz, high_hz))
        width = (high - low) * (_HALF_POWER ** (-1.0 / self.order) if self.zero_phase else 1.0)
        upper = (width + math.sqrt(width**2 + 4.0 * low * high)) / 2.0
        low_corner, high_corner = (rate / math.pi * math.atan(x) for x in (low * high / upper, upper))
        sections = _designed(self._poles, "band", (low_corner, high_corner), rate)
        return self._run(signal, sections, rate, max(_padding(sections), round(2.0 * rate / low_hz)))


class BandpassDominant(Bandpass):
    """Band-pass about the signal's own strongest frequency f0: f0 -/+ `half_width_hz`.

    EN 14363 reads instability so: the sum of guiding forces or the bogie frame's acceleration within f0 -/+ 2 Hz, then
    a sliding r.m.s. over 100 m. f0 is the largest line of Welch's spectrum (Hann blocks of `block_s`, half
    overlapping) between `low_hz` and `high_hz`; the band is kept above `low_hz` / 2.
    """

    name: ClassVar[str] = "bandpass_dominant"
    half_width_hz: Positive = 2.0
    low_hz: Positive = 1.0
    high_hz: Positive = 12.0
    block_s: Positive = 5.0

    def apply(self, signal: pl.DataFrame) -> pl.DataFrame:
        """The filtered signal without its two ends."""
        peak = self.dominant(signal)
        low = max(peak - self.half_width_hz, self.low_hz / 2.0)
        return self._between(signal, low, peak + self.half_width_hz)

    def dominant(self, signal: pl.DataFrame) -> float:
        """The strongest frequency, Hz."""
        from scipy.signal import welch

        rate = self._rate(signal)
        samples = round(self.block_s * rate)
        if signal.height < samples:
            raise JudgementProblem(
                f"the record of {signal.height / rate:.4g} s is shorter than the block of {self.block_s:g} s"
            )
        frequency, power = welch(signal.get_column("x").to_numpy(), fs=rate, nperseg=samples)
        inside = (frequency >= self.low_hz) & (frequency <= self.high_hz)
        if not bool(inside.any()):
            raise JudgementProblem(
                f"no line of the spectrum lies between {self.low_hz:g} and {self.high_hz:g} Hz"
            )
        return float(frequency[inside][power[inside].argmax()])


@functools.lru_cache(maxsize=64)
def _designed(poles: int, kind: Literal["low", "band"], corners: tuple[float, ...], rate: float) -> Any:
    """Second-order sections; a criterion asks for the same ones for every signal and case."""
    from scipy.signal import butter

    return butter(poles, corners if len(corners) > 1 else corners[0], btype=kind, output="sos", fs=rate)


def _padding(sections: Any) -> int:
    """scipy's own default, in samples."""
    return 3 * (2 * len(sections) + 1)


class MovingMean(Windowed, Filter):
    """The mean of every window, at its middle: EN 14363 and UIC 518 take 2 m, every 0.5 m, before percentiles.

    What comes out is shorter by a window; with a step it is no longer evenly spaced in time.
    """

    name: ClassVar[str] = "moving_mean"

    def apply(self, signal: pl.DataFrame) -> pl.DataFrame:
        """The means."""
        return self.slide(signal, "mean")


class Section(Filter):
    """The signal between two places on the track (m) or two times (s); a run that ends before is refused."""

    name: ClassVar[str] = "section"
    from_m: NotNegative | None = None
    to_m: NotNegative | None = None
    from_s: NotNegative | None = None
    to_s: NotNegative | None = None

    @model_validator(mode="after")
    def _some_part(self) -> Self:
        pairs = ((self.from_m, self.to_m), (self.from_s, self.to_s))
        if all(end is None for pair in pairs for end in pair):
            raise ValueError("one of from_m, to_m, from_s and to_s at least")
        if any(begin is not None and end is not None and begin >= end for begin, end in pairs):
            raise ValueError("a begin before its end")
        return self

    def apply(self, signal: pl.DataFrame) -> pl.DataFrame:
        """What lies between; nothing there is an error, and so is a run that does not reach its end."""
        part = signal
        for column, unit, begin, end in (
            ("s", "m", self.from_m, self.to_m),
            ("t", "s", self.from_s, self.to_s),
        ):
            last = float(signal.get_column(column)[-1])
            # an end of the track is reached to within a step
            slack = abs(last - float(signal.get_column(column)[-2])) if signal.height > 1 else 0.0
            if end is not None and last < end - slack * 1.000001:
                raise JudgementProblem(f"the run ends at {last:.6g} {unit}, before {end:g} {unit}")
            if begin is not None:
                part = part.filter(pl.col(column) >= begin - 1e-9)
            if end is not None:
                part = part.filter(pl.col(column) <= end + 1e-9)
        if part.is_empty():
            raise JudgementProblem("no sample lies within the section")
        return part


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
        t, s = (signal.get_column(name).to_numpy() for name in ("t", "s"))
        # from the first sample on that is beyond both: what follows counts wherever the vehicle rolls, back too
        beyond = (t - t[0] >= self.start_s) & (abs(s - s[0]) >= self.start_m)
        if not beyond.any():
            raise JudgementProblem("nothing is left after the part that is skipped")
        return signal.slice(int(beyond.argmax()))
