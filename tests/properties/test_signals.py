"""Properties of the statistics over random signals."""

from __future__ import annotations

import itertools

import numpy as np
import numpy.typing as npt
import polars as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from lmap.errors import JudgementProblem
from lmap.signals.filters import Lowpass
from lmap.signals.statistic import AveragePeak, MaxAbs, SlidingMean, Sustained, half_wave_peaks

RATE = 200.0
values = arrays(np.float64, st.integers(60, 400), elements=st.floats(-1e3, 1e3, width=32))


def signal(x: npt.NDArray[np.float64], speed: float = 7.3) -> pl.DataFrame:
    t = np.arange(len(x)) / RATE
    return pl.DataFrame({"t": t, "s": speed * t, "x": x})


@settings(deadline=None)
@given(values, st.integers(1, 40))
def test_sustained_is_the_brute_force_maximum_of_window_minima(
    x: npt.NDArray[np.float64], steps: int
) -> None:
    ours = Sustained(window_s=steps / RATE).read(signal(x)).value
    assert ours == max(x[i : i + steps + 1].min() for i in range(len(x) - steps))


@pytest.mark.slow
@settings(deadline=None)
@given(values)
def test_sustained_falls_as_the_window_grows(x: npt.NDArray[np.float64]) -> None:
    read = [Sustained(window_s=steps / RATE).read(signal(x)).value for steps in (1, 5, 20, 50)]
    assert read == sorted(read, reverse=True)
    assert read[0] <= x.max()


@pytest.mark.slow
@settings(deadline=None)
@given(values)
def test_sustained_is_never_above_the_sliding_mean(x: npt.NDArray[np.float64]) -> None:
    frame = signal(x)
    mean = SlidingMean(window_m=1.0).read(frame).value if frame["s"][-1] >= 1.0 else np.inf
    held = Sustained(window_m=1.0).read(frame).value if frame["s"][-1] >= 1.0 else -np.inf
    assert held <= mean + 1e-9 * max(1.0, abs(mean))


@settings(deadline=None)
@given(values)
def test_half_wave_peaks_are_the_largest_sizes_between_crossings(x: npt.NDArray[np.float64]) -> None:
    frame = signal(x)
    about = (frame["x"] - frame["x"].mean()).to_list()
    waves = [list(wave) for _, wave in itertools.groupby(about, key=lambda one: one > 0.0)]
    assert half_wave_peaks(frame)["x"].to_list() == [max(map(abs, wave)) for wave in waves[1:-1]]


def brute_force_average_peak(
    k: list[int], height: npt.NDArray[np.float64], steps: int, last: int
) -> float | None:
    """The best mean over every set of two or more neighbouring peaks that is all that some window holds.

    In samples, so that every comparison is exact: a window is [a, a + steps] for any real 0 <= a <= last.
    """
    best = None
    for i, j in itertools.combinations(range(len(k)), 2):
        low, high = max(0, k[j] - steps), min(last, k[i])
        before = k[i - 1] if i > 0 else -1
        after = k[j + 1] - steps if j + 1 < len(k) else last + 1
        # the window begins within [low, high], after the peak before and early enough to miss the one after
        if low <= high and max(low, before) <= min(high, after) and before < min(high, after) and low < after:
            mean = float(height[i : j + 1].mean())
            best = mean if best is None else max(best, mean)
    return best


@settings(deadline=None)
@given(values, st.integers(20, 50))
def test_average_peak_is_the_brute_force_best_window(x: npt.NDArray[np.float64], steps: int) -> None:
    frame, link = signal(x), AveragePeak(window_s=steps / RATE)
    peaks = half_wave_peaks(frame)
    k = np.rint(peaks["t"].to_numpy() * RATE).astype(int).tolist()
    height = peaks["x"].to_numpy()
    best = brute_force_average_peak(k, height, steps, len(x) - 1 - steps)
    if best is None:
        if not k and (x == x[0]).all():
            assert link.read(frame).value == 0.0
            return
        with pytest.raises(JudgementProblem):
            link.read(frame)
        return
    ours = link.read(frame).value
    # nothing but the rounding of sums of up to 400 heights
    assert abs(ours - best) <= 1e-12 * height.sum()
    assert ours <= height.max() * (1.0 + 1e-12) + 1e-12 * height.sum()


@settings(deadline=None)
@given(
    arrays(np.float64, 600, elements=st.floats(-10, 10, width=32)),
    arrays(np.float64, 600, elements=st.floats(-10, 10, width=32)),
    st.floats(-3, 3),
)
def test_lowpass_is_linear(a: npt.NDArray[np.float64], b: npt.NDArray[np.float64], k: float) -> None:
    low = Lowpass(cutoff_hz=10.0)
    one, two, both = (low.apply(signal(x))["x"].to_numpy() for x in (a, b, a + k * b))
    # rounding of the recursion, some 1e-16 times its gain, on values of 10
    np.testing.assert_allclose(both, one + k * two, atol=1e-11)


@settings(deadline=None)
@given(arrays(np.float64, 600, elements=st.floats(-10, 10, width=32)))
def test_zero_phase_lowpass_of_a_reversed_signal_is_the_reversed_result(x: npt.NDArray[np.float64]) -> None:
    low = Lowpass(cutoff_hz=10.0)
    forward, back = (low.apply(signal(values))["x"].to_numpy() for values in (x, x[::-1].copy()))
    # forward-backward and backward-forward differ by what the padding leaves of the ends after 1 s, exp(-60)
    np.testing.assert_allclose(forward, back[::-1], atol=1e-9)


@settings(deadline=None)
@given(values)
def test_max_abs_is_the_largest_size(x: npt.NDArray[np.float64]) -> None:
    assert MaxAbs().read(signal(x)).value == np.abs(x).max()
