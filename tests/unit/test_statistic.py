"""Statistics against closed forms."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import numpy.typing as npt
import polars as pl
import pytest

from lmap.errors import JudgementProblem
from lmap.signals import BY_NAME, LINKS
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

RATE = 200.0


def signal(x: npt.ArrayLike, speed: float = 10.0) -> pl.DataFrame:
    values = np.asarray(x, dtype=float)
    t = np.arange(len(values)) / RATE
    return pl.DataFrame({"t": t, "s": speed * t, "x": values})


def times(seconds: float) -> npt.NDArray[np.float64]:
    return np.arange(round(seconds * RATE) + 1) / RATE


def pulse(samples: int, height: float = 2.0, total: int = 2000) -> npt.NDArray[np.float64]:
    x = np.zeros(total)
    x[700 : 700 + samples] = height
    return x


# ---- average peak


def test_average_peak_of_a_sine_is_its_amplitude() -> None:
    # each half-wave's highest sample lies at most half a step from its top: 1 - cos(pi f / rate) = 2e-4 at 1.3 Hz
    reading = AveragePeak(window_s=5.0).read(signal(0.7 * np.sin(2.0 * math.pi * 1.3 * times(30.0))))
    assert reading.value == pytest.approx(0.7, rel=4e-4)
    assert reading.window_s == 5.0


def test_average_peak_removes_the_mean() -> None:
    t = times(30.0)
    wave = np.sin(2.0 * math.pi * 1.3 * t)
    plain, raised = (AveragePeak(window_s=5.0).read(signal(x)).value for x in (wave, wave + 40.0))
    assert raised == pytest.approx(plain, rel=1e-9)


def test_average_peak_takes_the_loudest_window_and_says_where_it_is() -> None:
    t = times(60.0)
    x = np.sin(2.0 * math.pi * 2.0 * t) * np.where((t >= 30.0) & (t < 36.0), 3.0, 1.0)
    reading = AveragePeak(window_s=5.0).read(signal(x))
    assert reading.value == pytest.approx(3.0, rel=2e-3)
    assert 32.4 <= reading.t <= 33.6
    assert reading.s == pytest.approx(10.0 * reading.t)


def test_average_peak_thins_a_single_transient_among_ordinary_peaks() -> None:
    t = times(60.0)
    x = np.sin(2.0 * math.pi * 2.0 * t)
    lone = (t > 30.0) & (t < 30.25)
    reading = AveragePeak(window_s=5.0).read(signal(np.where(lone, 9.0 * x, x)))
    # 20 half-waves in 5 s, 19 of height 1 and one of 9
    assert reading.value == pytest.approx((19.0 + 9.0) / 20.0, rel=0.03)


def test_average_peak_of_a_chirp_with_hand_counted_peaks() -> None:
    # half-waves of heights 1, 2, 3, 4, 5 and 0.25 s each, then silence just off zero: in any 0.75 s stand at most
    # four peaks, so the best window holds 3, 4, 5 or 2, 3, 4, 5; the first and last half-wave are not counted
    heights = [1.0, -2.0, 3.0, -4.0, 5.0, -1.0]
    x = np.concatenate([h * np.sin(math.pi * (np.arange(50) + 0.5) / 50) for h in heights])
    x -= x.mean()
    reading = AveragePeak(window_s=0.5).read(signal(x))
    assert reading.value == pytest.approx(4.5, rel=0.02)


def test_average_peak_of_silence_is_zero() -> None:
    assert AveragePeak(window_s=5.0).read(signal(np.zeros(4000))).value == 0.0


def test_average_peak_refuses_a_record_shorter_than_its_window() -> None:
    with pytest.raises(JudgementProblem, match="shorter than the window of 5 s"):
        AveragePeak(window_s=5.0).read(signal(np.sin(times(4.9))))


def test_average_peak_refuses_a_record_without_a_whole_half_wave() -> None:
    with pytest.raises(JudgementProblem, match="no complete half-wave"):
        AveragePeak(window_s=5.0).read(signal(times(10.0)))


# ---- sustained


@pytest.mark.parametrize(("samples", "held"), [(10, False), (11, True), (12, True)])
def test_a_pulse_is_sustained_for_50_ms_from_eleven_samples_of_5_ms(samples: int, held: bool) -> None:
    # eleven samples span ten steps of 5 ms
    reading = Sustained(window_s=0.05).read(signal(pulse(samples)))
    assert reading.value == (2.0 if held else 0.0)


@pytest.mark.parametrize(("speed", "samples"), [(10.0, 41), (20.0, 21), (35.0, 12)])
def test_a_pulse_is_sustained_for_2_m_by_the_samples_within_2_m(speed: float, samples: int) -> None:
    # window of 2 m: floor(2 / (speed * 5 ms)) steps, one more sample than steps
    assert Sustained(window_m=2.0).read(signal(pulse(samples), speed)).value == 2.0
    assert Sustained(window_m=2.0).read(signal(pulse(samples - 1), speed)).value == 0.0


def test_sustained_says_the_middle_of_the_window() -> None:
    reading = Sustained(window_s=0.05).read(signal(pulse(11)))
    assert reading.t == pytest.approx(705 / RATE)
    assert reading.s == pytest.approx(10.0 * 705 / RATE)


def test_sustained_is_an_erosion_and_no_mean() -> None:
    x = pulse(40)
    x[720] = 0.5
    assert Sustained(window_s=0.1).read(signal(x)).value == 0.5
    assert SlidingMean(window_s=0.1).read(signal(x)).value == pytest.approx((20 * 2.0 + 0.5) / 21)


def test_sustained_judges_the_sign_unless_told_otherwise() -> None:
    assert Sustained(window_s=0.05).read(signal(-pulse(30))).value == 0.0
    assert Sustained(window_s=0.05, absolute=True).read(signal(-pulse(30))).value == 2.0


def test_windows_that_reach_over_an_end_are_left_out() -> None:
    x = np.zeros(2000)
    x[:5] = 9.0
    x[-5:] = 9.0
    assert Sustained(window_s=0.05).read(signal(x)).value == 0.0


def test_sustained_refuses_a_record_shorter_than_its_window() -> None:
    with pytest.raises(JudgementProblem, match="shorter than the window of 2 m"):
        Sustained(window_m=2.0).read(signal(np.ones(20)))


def test_sustained_refuses_a_distance_that_goes_back() -> None:
    frame = signal(np.ones(2000)).with_columns(s=-pl.col("s"))
    with pytest.raises(JudgementProblem, match="s goes back"):
        Sustained(window_m=2.0).read(frame)


@pytest.mark.parametrize("parameters", [{}, {"window_s": 1.0, "window_m": 2.0}])
def test_a_window_is_either_of_time_or_of_distance(parameters: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="exactly one of window_s and window_m"):
        Sustained(**parameters)


# ---- the plain ones


def test_plain_statistics_of_a_ramp() -> None:
    ramp = signal(np.arange(-30, 11))
    assert Maximum().read(ramp).value == 10.0
    assert Minimum().read(ramp).value == -30.0
    assert Last().read(signal(np.arange(11, -31, -1))).value == -30.0
    assert Last().read(ramp).t == 40 / RATE
    assert MaxAbs().read(ramp).value == 30.0
    assert MaxAbs().read(ramp).t == 0.0
    assert PeakToPeak().read(ramp).value == 40.0
    assert Mean().read(ramp).value == -10.0
    assert Percentile(percent=50.0).read(ramp).value == -10.0
    assert Percentile(percent=97.5).read(ramp).value == pytest.approx(9.0)


def test_rms_of_a_sine_is_its_amplitude_over_root_two_whatever_its_mean() -> None:
    x = 5.0 + 2.0 * np.sin(2.0 * math.pi * np.arange(2000) / 100.0)
    assert Rms().read(signal(x)).value == pytest.approx(math.sqrt(2.0))
    assert Rms(about_mean=False).read(signal(x)).value == pytest.approx(math.sqrt(25.0 + 2.0))


def test_sliding_rms_is_that_of_the_loudest_window_less_its_own_mean() -> None:
    t = times(20.0)
    loud = (t >= 8.0) & (t < 11.0)
    # whole periods fit into the window of 2 s (401 samples, both ends counted: 1 in 400 off)
    x = 7.0 + np.where(loud, 3.0, 1.0) * np.sin(2.0 * math.pi * 4.0 * t)
    reading = SlidingRms(window_s=2.0).read(signal(x))
    assert reading.value == pytest.approx(3.0 / math.sqrt(2.0), rel=4e-3)
    assert 9.0 <= reading.t <= 10.0
    whole = SlidingRms(window_s=2.0, about_mean=False).read(signal(x - 7.0))
    assert whole.value == pytest.approx(3.0 / math.sqrt(2.0), rel=4e-3)


def test_median_and_the_larger_end_of_two_percentiles() -> None:
    x = signal(np.concatenate((np.full(600, -3.0), np.full(401, 5.0), np.full(1, -70.0))))
    assert Median().read(x).value == -3.0
    assert Median(absolute=True).read(x).value == 3.0
    ramp = signal(np.arange(-3000, 1001) * 0.01)
    assert Percentile(percent=99.85).read(ramp).value == pytest.approx(10.0 - 0.06)
    assert Percentile(percent=0.15).read(ramp).value == pytest.approx(-30.0 + 0.06)
    assert Percentile(percent=99.85, both_ends=True).read(ramp).value == pytest.approx(30.0 - 0.06)
    with pytest.raises(ValueError, match="not both"):
        Percentile(percent=99.85, both_ends=True, absolute=True)


def test_sliding_rms_steps_along_the_track() -> None:
    # EN 14363's instability: 100 m, every 10 m; at 10 m/s the run is 400 m long, so 31 windows
    x = np.where(times(40.0) >= 20.0, 2.0, 1.0) * np.sin(2.0 * math.pi * 4.0 * times(40.0))
    reading = SlidingRms(window_m=100.0, step_m=10.0, about_mean=False).read(signal(x))
    assert reading.curve is not None
    assert reading.curve.height == 31
    assert reading.value == pytest.approx(2.0 / math.sqrt(2.0), rel=1e-3)
    assert reading.s in [pytest.approx(s) for s in range(250, 351, 10)]


@pytest.mark.parametrize("link", [Sustained, SlidingMean, SlidingRms])
def test_a_window_that_holds_one_sample_is_refused(link: type[Sustained | SlidingMean | SlidingRms]) -> None:
    # its r.m.s. about its mean would be 0, and pass
    with pytest.raises(JudgementProblem, match="holds less than two samples"):
        link(window_s=0.004).read(signal(np.sin(times(10.0))))


# ---- the list


def test_the_list_of_links_is_sorted_and_its_names_are_unique() -> None:
    names = [link.name for link in LINKS]
    assert names == sorted(set(names))
    assert list(BY_NAME) == names


def test_every_link_documents_itself() -> None:
    assert all(link.__doc__ for link in LINKS)


def test_the_page_on_signals_names_every_link() -> None:
    page = Path(__file__).parents[2] / "docs" / "concepts" / "signals.md"
    text = page.read_text(encoding="utf-8")
    assert [name for name in BY_NAME if f"`{name}`" not in text] == []
