"""Filters against closed forms."""

from __future__ import annotations

import math

import numpy as np
import polars as pl
import pytest

from lmap.errors import JudgementProblem
from lmap.signals.filters import Bandpass, BandpassDominant, Lowpass, MovingMean, RemoveMean, Section, Skip


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


def test_skip_keeps_what_comes_after_wherever_the_vehicle_rolls() -> None:
    t = [0.0, 1.0, 2.0, 3.0, 4.0]
    signal = pl.DataFrame({"t": t, "s": [5.0, 4.0, 3.0, 4.0, 5.0], "x": t})
    assert Skip(start_s=1.0).apply(signal)["x"].to_list() == [1.0, 2.0, 3.0, 4.0]
    assert Skip(start_m=2.0).apply(signal)["x"].to_list() == [2.0, 3.0, 4.0]


@pytest.mark.parametrize("zero_phase", [True, False])
@pytest.mark.parametrize(("low", "high"), [(0.4, 10.0), (2.0, 6.0), (8.0, 40.0)])
def test_bandpass_is_3_db_down_at_both_ends(low: float, high: float, zero_phase: bool) -> None:
    # trim_s: two periods of the lower end and more
    band = Bandpass(low_hz=low, high_hz=high, zero_phase=zero_phase, trim_s=10.0)
    for end in (low, high):
        amplitude, _ = amplitude_and_phase(band.apply(sine(end, seconds=60.0)), end)
        assert amplitude == pytest.approx(math.sqrt(0.5), rel=1e-3)


@pytest.mark.parametrize("frequency", [0.6, 2.0, 5.0, 15.0])
def test_zero_phase_bandpass_follows_the_butterworth_closed_form_without_delay(frequency: float) -> None:
    amplitude, phase = amplitude_and_phase(
        Bandpass(low_hz=1.0, high_hz=10.0, trim_s=10.0).apply(sine(frequency, seconds=60.0)), frequency
    )
    # two 2-pole band-passes: |H| = 1/(1 + (sqrt 2 - 1) q^4), q = (w^2 - w1 w2)/(w (w2 - w1)), w = tan(pi f / rate)
    low, high, w = (math.tan(math.pi * f / 200.0) for f in (1.0, 10.0, frequency))
    q = (w**2 - low * high) / (w * (high - low))
    assert amplitude == pytest.approx(1.0 / (1.0 + (math.sqrt(2.0) - 1.0) * q**4), rel=2e-3)
    assert phase == pytest.approx(0.0, abs=2e-3)


def test_bandpass_takes_the_mean_away_and_refuses_what_lowpass_refuses() -> None:
    band = Bandpass(low_hz=0.4, high_hz=10.0)
    flat = band.apply(sine(1.0).with_columns(x=pl.lit(3.0)))
    assert flat["x"].to_numpy() == pytest.approx(0.0, abs=1e-9)
    with pytest.raises(JudgementProblem, match="the bandpass asks for 200"):
        band.apply(sine(1.0, rate=100.0))
    with pytest.raises(JudgementProblem, match="too few"):
        band.apply(sine(1.0, seconds=4.0))
    with pytest.raises(JudgementProblem, match="too high"):
        Bandpass(low_hz=0.4, high_hz=100.0).apply(sine(1.0))
    with pytest.raises(ValueError, match="low_hz below high_hz"):
        Bandpass(low_hz=10.0, high_hz=1.0)


def test_bandpass_dominant_finds_the_strongest_frequency_and_keeps_2_hz_about_it() -> None:
    both = sine(4.0, amplitude=2.0, seconds=60.0).with_columns(pl.col("x") + sine(9.0, seconds=60.0)["x"])
    band = BandpassDominant(trim_s=5.0)
    assert band.dominant(both) == pytest.approx(4.0, abs=0.1)
    filtered = band.apply(both)
    assert amplitude_and_phase(filtered, 4.0)[0] == pytest.approx(2.0, rel=2e-3)
    # q = (81 - 12)/(9 * 4), two 2-pole filters
    assert amplitude_and_phase(filtered, 9.0)[0] == pytest.approx(0.15, abs=0.01)
    with pytest.raises(JudgementProblem, match="shorter than the block of 5 s"):
        band.dominant(sine(4.0, seconds=4.0))


def test_moving_mean_of_a_ramp_is_the_ramp_at_every_half_metre() -> None:
    # 10 m/s: a sample every 0.05 m
    ramp = sine(1.0).with_columns(x=pl.col("s"))
    means = MovingMean(window_m=2.0, step_m=0.5).apply(ramp)
    assert means["x"].to_numpy() == pytest.approx(means["s"].to_numpy(), abs=1e-9)
    assert means["s"].to_list() == pytest.approx([1.0 + 0.5 * k for k in range(means.height)], abs=1e-9)
    assert means["s"][-1] == pytest.approx(299.0)
    every = MovingMean(window_s=0.2).apply(ramp)
    assert every.height == ramp.height - 40


def test_moving_mean_over_whole_waves_is_nothing() -> None:
    # 41 samples, both ends counted, of a wave of 40: the one too much weighs 1/41
    means = MovingMean(window_s=0.2).apply(sine(5.0))
    assert means["x"].abs().max() == pytest.approx(1.0 / 41.0, rel=1e-6)


def test_a_window_longer_than_the_run_or_with_a_single_sample_is_refused() -> None:
    with pytest.raises(JudgementProblem, match="shorter than the window of 400 m"):
        MovingMean(window_m=400.0).apply(sine(1.0))
    with pytest.raises(JudgementProblem, match=r"a window of 0\.004 s holds less than two samples"):
        MovingMean(window_s=0.004).apply(sine(1.0))


@pytest.mark.parametrize(
    "parameters", [{"window_s": 1.0, "step_m": 1.0}, {"window_m": 1.0, "step_s": 1.0}, {}]
)
def test_a_step_is_of_what_the_window_is(parameters: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=r"step_s with window_s|exactly one"):
        MovingMean(**parameters)


def test_section_keeps_what_lies_between_and_refuses_what_the_run_does_not_reach() -> None:
    part = Section(from_m=50.0, to_m=100.0).apply(sine(1.0))
    assert (part["s"][0], part["s"][-1]) == (pytest.approx(50.0), pytest.approx(100.0))
    assert Section(from_s=20.0).apply(sine(1.0))["t"][0] == pytest.approx(20.0)
    # the run ends at 300 m, to within one step of 0.05 m
    assert Section(to_m=300.04).apply(sine(1.0)).height == sine(1.0).height
    with pytest.raises(JudgementProblem, match="the run ends at 300 m, before 301 m"):
        Section(to_m=301.0).apply(sine(1.0))
    with pytest.raises(JudgementProblem, match="no sample lies within the section"):
        Section(from_m=301.0).apply(sine(1.0))
    with pytest.raises(JudgementProblem, match="no sample lies within the section"):
        Section(from_m=50.01, to_m=50.02).apply(sine(1.0))
    with pytest.raises(ValueError, match="a begin before its end"):
        Section(from_m=50.0, to_m=50.0)
    with pytest.raises(ValueError, match="one of from_m"):
        Section()
