"""Filters against closed forms."""

from __future__ import annotations

import math

import numpy as np
import polars as pl
import pytest

from lmap.errors import JudgementProblem
from lmap.signals.filters import Lowpass, RemoveMean, Skip


def sine(
    frequency: float, *, rate: float = 200.0, seconds: float = 30.0, amplitude: float = 1.0
) -> pl.DataFrame:
    t = np.arange(round(seconds * rate) + 1) / rate
    return pl.DataFrame({"t": t, "s": 10.0 * t, "x": amplitude * np.sin(2.0 * math.pi * frequency * t)})


def amplitude_and_phase(signal: pl.DataFrame, frequency: float) -> tuple[float, float]:
    """Of the signal's component at a frequency; exact over whole periods."""
    t, x = signal["t"].to_numpy(), signal["x"].to_numpy()
    whole = math.floor((t[-1] - t[0]) * frequency) / frequency
    keep = t < t[0] + whole - 1e-9
    wave = 2.0 * np.mean(x[keep] * np.exp(-2j * math.pi * frequency * t[keep]))
    return abs(wave), math.remainder(np.angle(wave) + math.pi / 2.0, 2.0 * math.pi)


@pytest.mark.parametrize("zero_phase", [True, False])
@pytest.mark.parametrize("rate", [200.0, 1000.0])
def test_lowpass_is_3_db_down_at_the_cut_off(zero_phase: bool, rate: float) -> None:
    filtered = Lowpass(cutoff_hz=10.0, zero_phase=zero_phase).apply(sine(10.0, rate=rate))
    amplitude, _ = amplitude_and_phase(filtered, 10.0)
    assert amplitude == pytest.approx(math.sqrt(0.5), rel=2e-4)


@pytest.mark.parametrize("frequency", [0.5, 2.0, 5.0, 20.0])
def test_zero_phase_lowpass_follows_the_four_pole_closed_form_without_delay(frequency: float) -> None:
    rate = 1000.0
    amplitude, phase = amplitude_and_phase(
        Lowpass(cutoff_hz=10.0).apply(sine(frequency, rate=rate)), frequency
    )
    # two 2-pole Butterworths with the corner raised: |H| = 1/(1 + (sqrt 2 - 1) w^4), w the warped f / 10 Hz
    w = math.tan(math.pi * frequency / rate) / math.tan(math.pi * 10.0 / rate)
    assert amplitude == pytest.approx(1.0 / (1.0 + (math.sqrt(2.0) - 1.0) * w**4), rel=1e-3)
    assert phase == pytest.approx(0.0, abs=1e-3)


def test_lowpass_keeps_a_constant_and_cuts_one_second_at_each_end() -> None:
    signal = sine(1.0, seconds=10.0).with_columns(x=pl.lit(3.0))
    filtered = Lowpass(cutoff_hz=10.0).apply(signal)
    assert filtered["x"].to_numpy() == pytest.approx(3.0, abs=1e-12)
    assert (filtered["t"][0], filtered["t"][-1]) == (1.0, 9.0)


def test_lowpass_refuses_fewer_than_200_samples_per_second() -> None:
    with pytest.raises(
        JudgementProblem, match=r"sampled at 100 per second, .* 200 or more: set run.output_step"
    ):
        Lowpass(cutoff_hz=10.0).apply(sine(1.0, rate=100.0))
    Lowpass(cutoff_hz=10.0, min_rate_hz=50.0).apply(sine(1.0, rate=100.0))


def test_lowpass_refuses_uneven_sampling() -> None:
    signal = sine(1.0)
    t = signal["t"].to_numpy().copy()
    t[7] += 1e-4
    with pytest.raises(JudgementProblem, match="not evenly spaced"):
        Lowpass(cutoff_hz=10.0).apply(signal.with_columns(t=pl.Series(t)))


def test_lowpass_refuses_a_record_that_its_ends_use_up() -> None:
    with pytest.raises(JudgementProblem, match="too few"):
        Lowpass(cutoff_hz=10.0).apply(sine(1.0, seconds=1.9))


def test_lowpass_refuses_a_cut_off_beyond_half_the_rate() -> None:
    with pytest.raises(JudgementProblem, match="too high"):
        Lowpass(cutoff_hz=150.0).apply(sine(1.0))


def test_an_odd_order_does_not_run_both_ways() -> None:
    with pytest.raises(ValueError, match="even order"):
        Lowpass(cutoff_hz=10.0, order=3)
    Lowpass(cutoff_hz=10.0, order=3, zero_phase=False)


def test_remove_mean_leaves_none() -> None:
    signal = RemoveMean().apply(sine(1.0).with_columns(pl.col("x") + 5.0))
    assert signal["x"].mean() == pytest.approx(0.0, abs=1e-12)


def test_skip_drops_the_run_in_and_refuses_to_drop_everything() -> None:
    rest = Skip(start_m=50.0).apply(sine(1.0))
    assert rest["s"][0] == pytest.approx(50.0)
    with pytest.raises(JudgementProblem, match="nothing is left"):
        Skip(start_s=100.0).apply(sine(1.0))
