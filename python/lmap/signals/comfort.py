"""Ride comfort: frequency weightings, Sperling's index, mean comfort of EN 12299.

Weightings are analogue filters. A filter with a corner at 100 Hz cannot be had at 200 samples/s: signals are raised
to some 2000 samples/s first, where the bilinear transform is true to 0.1 % up to 35 Hz, and read at their own samples
again.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, Self

import numpy as np
import numpy.typing as npt
import polars as pl
from pydantic import Field, model_validator

from lmap.errors import JudgementProblem
from lmap.signals.base import Filter, Joint, NotNegative, Positive, Reading, Statistic, sample_step

Array = npt.NDArray[np.float64]
Polynomials = list[tuple[list[float], list[float]]]
"""Numerators and denominators in s, highest power first."""

_RAISED_HZ = 2000.0


@dataclass(frozen=True, slots=True)
class Weighting:
    """A frequency weighting of ISO 2631 and ISO 8041: corners in Hz, as the standards name them.

    Band limits f1 and f2 are 2-pole Butterworth; f3 to Q4 turn from acceleration to velocity, f5 to Q6 step up. An f3
    of infinity leaves the zero out.
    """

    f3: float | None = None
    f4: float | None = None
    q4: float | None = None
    f5: float | None = None
    q5: float | None = None
    f6: float | None = None
    q6: float | None = None
    gain: float = 1.0
    f1: float = 0.4
    f2: float = 100.0

    def sections(self) -> Polynomials:
        """The transfer function."""
        w1, w2 = 2.0 * math.pi * self.f1, 2.0 * math.pi * self.f2
        sections = [
            ([1.0, 0.0, 0.0], [1.0, math.sqrt(2.0) * w1, w1**2]),
            ([self.gain * w2**2], [1.0, math.sqrt(2.0) * w2, w2**2]),
        ]
        if self.f4 is not None and self.q4 is not None:
            w4 = 2.0 * math.pi * self.f4
            zero = [1.0] if self.f3 is None else [0.5 / (math.pi * self.f3), 1.0]
            sections.append((zero, [w4**-2, 1.0 / (self.q4 * w4), 1.0]))
        if self.f5 is not None and self.f6 is not None and self.q5 is not None and self.q6 is not None:
            w5, w6 = 2.0 * math.pi * self.f5, 2.0 * math.pi * self.f6
            step = (w5 / w6) ** 2
            sections.append(
                (
                    [step * w5**-2, step / (self.q5 * w5), step],
                    [w6**-2, 1.0 / (self.q6 * w6), 1.0],
                )
            )
        return sections


# ISO 8041:2005 as printed in the reference manual of the HVM200 (Larson Davis), Table 3.1; Wb there is of ISO 2631-4.
# EN 12299 has its vertical curve from BS 6841, with quality factors of its own and a gain of 0.4 before the step.
WEIGHTINGS = {
    "Wb": Weighting(16.0, 16.0, 0.55, 2.5, 0.9, 4.0, 0.95, gain=1.024),
    "Wb_EN12299": Weighting(16.0, 16.0, 0.63, 2.5, 0.8, 4.0, 0.8, gain=0.4 * (4.0 / 2.5) ** 2),
    "Wc": Weighting(8.0, 8.0, 0.63),
    "Wd": Weighting(2.0, 2.0, 0.63),
    "We": Weighting(1.0, 1.0, 0.63),
    "Wf": Weighting(None, 0.25, 0.86, 0.0625, 0.8, 0.1, 0.8, f1=0.08, f2=0.63),
    "Wj": Weighting(f5=3.75, q5=0.91, f6=5.32, q6=0.91),
    "Wk": Weighting(12.5, 12.5, 0.63, 2.37, 0.91, 3.35, 0.91),
}
"""By name: Wk seat z, Wd seat x and y, Wc seat back x, We rotation, Wj recumbent head, Wf motion sickness."""

Curve = Literal["Wb", "Wb_EN12299", "Wc", "Wd", "We", "Wf", "Wj", "Wk"]


def analogue(values: Array, sections: Polynomials, rate: float) -> Array:
    """A signal through an analogue filter; it is taken to have stood at its first value before."""
    from scipy.signal import bilinear, resample_poly, sosfilt, sosfilt_zi, tf2sos

    raised = max(1, math.ceil(_RAISED_HZ / rate))
    # a window of more attenuation than scipy's: 1e-4 of ripple instead of 2e-3, flat to three quarters of half the rate
    fine = values if raised == 1 else resample_poly(values, raised, 1, window=("kaiser", 8.0), padtype="line")
    steps: Any = np.concatenate([tf2sos(*bilinear(*section, fs=rate * raised)) for section in sections])
    filtered, _ = sosfilt(steps, fine, zi=sosfilt_zi(steps) * fine[0])
    return np.asarray(filtered[::raised])


def _rate(signal: pl.DataFrame, least: float, name: str) -> float:
    rate = 1.0 / sample_step(signal)
    if rate < least * (1.0 - 1e-6):
        raise JudgementProblem(
            f"sampled at {rate:.4g} per second, {name} asks for {least:g} or more: "
            f"set run.output_step to {1.0 / least:g} s or less"
        )
    return rate


def _weighted(signal: pl.DataFrame, curve: str, least: float, name: str, settle_s: float) -> pl.DataFrame:
    rate = _rate(signal, least, name)
    settle = round(settle_s * rate)
    if signal.height <= settle:
        raise JudgementProblem(
            f"the record of {signal.height / rate:.4g} s is not longer than settle_s, {settle_s:g} s"
        )
    values = analogue(signal.get_column("x").to_numpy(), WEIGHTINGS[curve].sections(), rate)
    return signal.with_columns(x=pl.Series(values)).slice(settle)


class Weight(Filter):
    """Frequency weighting of ISO 2631-1 and ISO 8041: `Wk` for the vertical, `Wd` for x and y of a seated person.

    The first `settle_s` are left out: the high-pass at 0.4 Hz forgets its past at 1.8 per second.
    """

    name: ClassVar[str] = "weighting"
    curve: Curve
    settle_s: NotNegative = 2.0
    min_rate_hz: Positive = 200.0

    def apply(self, signal: pl.DataFrame) -> pl.DataFrame:
        """The weighted signal."""
        return _weighted(signal, self.curve, self.min_rate_hz, self.name, self.settle_s)


def _blocks(signal: pl.DataFrame, block_s: float, rate: float) -> tuple[Array, Array, Array]:
    """Whole blocks, one a row, with the time and place of their middles; what is left over at the end is dropped."""
    samples = round(block_s * rate)
    count = signal.height // samples if samples > 1 else 0
    if count == 0:
        raise JudgementProblem(
            f"the record of {signal.height / rate:.4g} s is shorter than the block of {block_s:g} s"
            if samples > 1
            else f"a block of {block_s:g} s holds less than two samples"
        )
    x, t, s = (
        signal.get_column(name).to_numpy()[: count * samples].reshape(count, samples) for name in "xts"
    )
    return x, t.mean(axis=1), s.mean(axis=1)


class Sperling(Statistic):
    """Sperling's ride index Wz of an acceleration, in blocks of `block_s`, the largest or the mean over the blocks.

    `harmonic`: Wz = (sum of Wz_i^10)^(1/10) with Wz_i = 0.896 (A^3 F(f) / f)^(1/10) of every line of the block's
    spectrum (mean removed, no taper), A in cm/s2, within `band_hz`. `filter`: Wz = a^0.3, a being sqrt(2) times the
    r.m.s. in cm/s2 behind the comfort filter B(f): the weighted *amplitude* of a sinusoid, not its r.m.s. A^3 is not
    proportional to power, so that longer blocks, with more and lower lines, read less: the spec states their length.
    Source: Sperling and Betzhold 1956 as in GB/T 5599 and Garg and Dukkipati 1984.
    """

    name: ClassVar[str] = "sperling"
    never_negative: ClassVar[bool] = True
    largest: ClassVar[bool] = True
    reads: ClassVar[str | None] = "m/s2"
    gives: ClassVar[str | None] = "1"
    form: Literal["harmonic", "filter"]
    direction: Literal["vertical", "lateral"]
    block_s: Positive
    over: Literal["max", "mean"] = "max"
    band_hz: list[Positive] = Field(default=[0.5, 40.0], min_length=2, max_length=2)
    settle_s: NotNegative = 2.0
    min_rate_hz: Positive = 200.0

    @model_validator(mode="after")
    def _a_band(self) -> Self:
        if self.band_hz[0] >= self.band_hz[1]:
            raise ValueError("a band_hz that rises")
        return self

    def read(self, signal: pl.DataFrame) -> Reading:
        """The index and the middle of its block."""
        rate = _rate(signal, self.min_rate_hz, self.name)
        x, t, s = _blocks(self._heard(signal, rate), self.block_s, rate)
        index = self._harmonic(x, rate) if self.form == "harmonic" else self._filtered(x)
        curve = pl.DataFrame({"t": t, "x": index})
        if self.over == "mean":
            return Reading(float(index.mean()), float(t.mean()), float(s.mean()), self.block_s, curve=curve)
        best = int(index.argmax())
        return Reading(float(index[best]), float(t[best]), float(s[best]), self.block_s, curve=curve)

    def _heard(self, signal: pl.DataFrame, rate: float) -> pl.DataFrame:
        if self.form == "harmonic":
            return signal
        settle = round(self.settle_s * rate)
        values = analogue(signal.get_column("x").to_numpy(), _sperling_filter(self.direction), rate)
        return signal.with_columns(x=pl.Series(values)).slice(settle)

    def _harmonic(self, x: Array, rate: float) -> Array:
        n = x.shape[1]
        lines = np.fft.rfft(x - x.mean(axis=1, keepdims=True), axis=1)
        f: Array = np.fft.rfftfreq(n, 1.0 / rate).astype(np.float64)
        inside = (f >= self.band_hz[0] * (1.0 - 1e-9)) & (f <= self.band_hz[1] * (1.0 + 1e-9))
        if not bool(inside.any()):
            raise JudgementProblem(
                f"a block of {self.block_s:g} s has no line of its spectrum within band_hz"
            )
        amplitude: Array = 100.0 * 2.0 / n * np.abs(lines[:, inside])
        part = amplitude**3 * sperling_factor(f[inside], self.direction) / f[inside]
        total: Array = 0.896 * part.sum(axis=1) ** 0.1
        return total

    @staticmethod
    def _filtered(x: Array) -> Array:
        weighted: Array = (100.0 * np.sqrt(2.0 * (x**2).mean(axis=1))) ** 0.3
        return weighted


def sperling_factor(f: Array, direction: str) -> Array:
    """F(f) of Sperling's index, f in Hz."""
    low, high, rise, fall = (5.9, 20.0, 0.325, 400.0) if direction == "vertical" else (5.4, 26.0, 0.8, 650.0)
    return np.where(f < low, rise * f**2, np.where(f <= high, fall / f**2, 1.0))


def _sperling_filter(direction: str) -> Polynomials:
    """The comfort filter, p = jf: B(f) = k |(sqrt(1.911) p + 0.25 p^2) / (1 + 1.563 p + 0.277 p^2 + 0.0368 p^3)|."""
    k = 0.588 if direction == "vertical" else 0.737
    p = 0.5 / math.pi  # s = j 2 pi f
    numerator = [k * 0.25 * p**2, k * math.sqrt(1.911) * p, 0.0]
    return [(numerator, [0.0368 * p**3, 0.277 * p**2, 1.563 * p, 1.0])]


class MeanComfort(Joint):
    """Mean comfort N_MV of EN 12299 (standard method): accelerations x, y and z of the floor, in this order.

    N_MV = 6 sqrt(ax^2 + ay^2 + az^2), each the 95th percentile of the r.m.s. over blocks of 5 s behind Wd, Wd and
    its own Wb. The standard takes 5 minutes, 60 blocks; fewer than `blocks` are refused. Below 1.5 very comfortable,
    2.5 comfortable, 3.5 medium, 4.5 uncomfortable, else very uncomfortable (EN 12299:2009, 6.7.2 and its Annex).
    """

    name: ClassVar[str] = "mean_comfort"
    never_negative: ClassVar[bool] = True
    largest: ClassVar[bool] = True
    reads: ClassVar[str | None] = "m/s2"
    gives: ClassVar[str | None] = "1"
    blocks: int = Field(default=60, ge=1)
    block_s: Positive = 5.0
    percent: float = Field(default=95.0, ge=0.0, le=100.0)
    settle_s: NotNegative = 2.0
    min_rate_hz: Positive = 200.0

    def read_together(self, signals: Sequence[pl.DataFrame]) -> Reading:
        """The index, placed in the middle of the record."""
        total = 0.0
        places: list[tuple[Array, Array]] = []
        for signal, curve in zip(signals, ("Wd", "Wd", "Wb_EN12299"), strict=True):
            weighted = _weighted(signal, curve, self.min_rate_hz, self.name, self.settle_s)
            x, t, s = _blocks(weighted, self.block_s, _rate(weighted, self.min_rate_hz, self.name))
            if len(x) < self.blocks:
                raise JudgementProblem(
                    f"{len(x)} blocks of {self.block_s:g} s in the record, {self.blocks} are asked for"
                )
            total += float(np.percentile(np.sqrt((x**2).mean(axis=1)), self.percent)) ** 2
            places.append((t, s))
        t, s = places[0]
        return Reading(6.0 * math.sqrt(total), float(t.mean()), float(s.mean()))


class VibrationTotal(Joint):
    """Vibration total value of ISO 2631-1: sqrt of the sum of (k a_w)^2 over x, y and z, in this order.

    a_w is the r.m.s. of the whole record behind `curves`. For comfort k is 1, 1, 1, for health 1.4, 1.4, 1 (seated).
    """

    name: ClassVar[str] = "vibration_total"
    never_negative: ClassVar[bool] = True
    reads: ClassVar[str | None] = "m/s2"
    gives: ClassVar[str | None] = "m/s2"
    k: list[Positive] = Field(default=[1.0, 1.0, 1.0], min_length=3, max_length=3)
    curves: list[Curve] = Field(default=["Wd", "Wd", "Wk"], min_length=3, max_length=3)
    settle_s: NotNegative = 2.0
    min_rate_hz: Positive = 200.0

    def read_together(self, signals: Sequence[pl.DataFrame]) -> Reading:
        """Value, placed in the middle of the record."""
        total = 0.0
        for signal, k, curve in zip(signals, self.k, self.curves, strict=True):
            x = (
                _weighted(signal, curve, self.min_rate_hz, self.name, self.settle_s)
                .get_column("x")
                .to_numpy()
            )
            total += k**2 * float((x**2).mean())
        middle = signals[0].row(signals[0].height // 2, named=True)
        return Reading(math.sqrt(total), middle["t"], middle["s"])
