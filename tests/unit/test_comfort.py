"""Weightings and ride indices against published factors and closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import polars as pl
import pytest

from lmap.criteria import Criterion, chain_problems, judge, signal_problems, trace
from lmap.errors import JudgementProblem
from lmap.signals.comfort import MeanComfort, Sperling, VibrationTotal, Weight, sperling_factor
from lmap.verdict import Outcome


def wave(
    frequency: float, amplitude: float = 1.0, *, rate: float = 200.0, seconds: float = 40.0, name: str = "x"
) -> pl.DataFrame:
    t = np.arange(round(seconds * rate) + 1) / rate
    return pl.DataFrame({"t": t, "s": 30.0 * t, name: amplitude * np.sin(2.0 * math.pi * frequency * t)})


def gain(curve: Any, frequency: float, rate: float) -> float:
    x = Weight(curve=curve, settle_s=20.0).apply(wave(frequency, rate=rate))["x"].to_numpy()
    whole = round(math.floor((len(x) - 1) / rate * frequency + 1e-9) / frequency * rate)
    return float(np.sqrt(2.0 * (x[:whole] ** 2).mean()))


FREQUENCIES = (0.5, 1.0, 2.0, 4.0, 5.0, 6.3, 8.0, 10.0, 16.0, 20.0, 31.5)
# ISO 2631-1:1997, Table 3
WK = (0.418, 0.482, 0.531, 0.967, 1.039, 1.054, 1.036, 0.988, 0.768, 0.636, 0.405)
WD = (0.853, 1.011, 0.890, 0.512, 0.409, 0.323, 0.253, 0.202, 0.125, 0.100, 0.063)


@pytest.mark.parametrize("rate", [200.0, 1000.0])
@pytest.mark.parametrize(("curve", "factors"), [("Wk", WK), ("Wd", WD)])
def test_weightings_are_the_factors_of_iso_2631_1(
    curve: str, factors: tuple[float, ...], rate: float
) -> None:
    ours = [gain(curve, frequency, rate) for frequency in FREQUENCIES]
    # three digits are printed
    assert ours == pytest.approx(factors, abs=7e-4)


# ISO 8041:2005, Table 1: factors at the reference frequency of 100 rad/s
@pytest.mark.parametrize(
    ("curve", "factor"),
    [("Wb", 0.8126), ("Wc", 0.5145), ("Wd", 0.1261), ("We", 0.06287), ("Wj", 1.019), ("Wk", 0.7718)],
)
def test_weightings_are_the_reference_factors_of_iso_8041(curve: str, factor: float) -> None:
    assert gain(curve, 100.0 / (2.0 * math.pi), 200.0) == pytest.approx(factor, rel=1e-3)


def wb_of_en_12299(f: float) -> float:
    """|H| by the formulas of EN 12299:2009 (annex on weightings): 0.4 and 100 Hz, 16 Hz, 2.5 and 4 Hz."""
    p = 2j * math.pi * f
    w1, w2, w3, w5, w6 = (2.0 * math.pi * corner for corner in (0.4, 100.0, 16.0, 2.5, 4.0))
    band = p**2 / (p**2 + math.sqrt(2.0) * w1 * p + w1**2) * w2**2 / (p**2 + math.sqrt(2.0) * w2 * p + w2**2)
    turn = (1.0 + p / w3) / (1.0 + p / (0.63 * w3) + (p / w3) ** 2)
    step = (1.0 + p / (0.8 * w5) + (p / w5) ** 2) / (1.0 + p / (0.8 * w6) + (p / w6) ** 2)
    return abs(0.4 * band * turn * step)


@pytest.mark.parametrize("frequency", FREQUENCIES)
def test_the_vertical_curve_of_en_12299_is_its_formula(frequency: float) -> None:
    assert gain("Wb_EN12299", frequency, 200.0) == pytest.approx(wb_of_en_12299(frequency), rel=2e-3)


def test_the_wb_of_iso_8041_is_another_curve() -> None:
    # both formulas by hand: 8.2 % more at 4 Hz, 11.8 % less at 16 Hz
    ratios = [gain("Wb", f, 200.0) / gain("Wb_EN12299", f, 200.0) for f in (4.0, 16.0)]
    assert ratios == pytest.approx([1.082, 0.882], abs=1e-3)


def test_wf_is_the_reference_factor_of_iso_8041() -> None:
    # at 0.4 rad/s times 2 pi: 0.3979 Hz is 2.5 rad/s
    x = Weight(curve="Wf", settle_s=200.0).apply(wave(2.5 / (2.0 * math.pi), seconds=400.0))["x"].to_numpy()
    assert np.sqrt(2.0) * x.std() == pytest.approx(0.3888, rel=5e-3)


def test_a_weighting_refuses_slow_sampling_and_a_record_that_settling_uses_up() -> None:
    with pytest.raises(JudgementProblem, match="weighting asks for 200 or more"):
        Weight(curve="Wk").apply(wave(1.0, rate=100.0))
    with pytest.raises(JudgementProblem, match="not longer than settle_s"):
        Weight(curve="Wk").apply(wave(1.0, seconds=1.9))


# ---- Sperling


def test_sperling_of_5_hz_and_half_a_metre_per_second_squared_is_3_04_in_both_forms() -> None:
    # 0.896 (50^3 0.325 25 / 5)^0.1 = 3.041; bare r.m.s. behind the filter instead of the amplitude gives 2.74
    signal = wave(5.0, 0.5)
    harmonic = Sperling(form="harmonic", direction="vertical", block_s=5.0).read(signal)
    filtered = Sperling(form="filter", direction="vertical", block_s=5.0, settle_s=5.0).read(signal)
    assert harmonic.value == pytest.approx(0.896 * (50.0**3 * 0.325 * 25.0 / 5.0) ** 0.1, rel=1e-6)
    assert harmonic.value == pytest.approx(3.04, abs=0.005)
    assert filtered.value == pytest.approx(3.04, abs=0.005)
    assert harmonic.window_s == 5.0


@pytest.mark.parametrize("direction", ["vertical", "lateral"])
@pytest.mark.parametrize("frequency", [1.0, 2.0, 4.0, 7.0, 10.0])
def test_the_two_forms_agree_within_0_08_from_1_to_10_hz(direction: Any, frequency: float) -> None:
    harmonic, filtered = (
        Sperling(form=form, direction=direction, block_s=5.0, settle_s=5.0).read(wave(frequency, 0.3)).value
        for form in ("harmonic", "filter")
    )
    assert abs(harmonic - filtered) < (0.08 if direction == "vertical" else 0.12)


@pytest.mark.parametrize("frequency", [0.8, 3.0, 8.0])
def test_the_filter_form_is_its_closed_form(frequency: float) -> None:
    f = frequency
    b = 0.737 * math.sqrt(
        (1.911 * f**2 + (0.25 * f**2) ** 2) / ((1.0 - 0.277 * f**2) ** 2 + (1.563 * f - 0.0368 * f**3) ** 2)
    )
    ours = Sperling(form="filter", direction="lateral", block_s=5.0, settle_s=5.0).read(wave(f, 0.2)).value
    assert ours == pytest.approx((20.0 * b) ** 0.3, rel=1e-3)


def test_sperling_joins_harmonics_by_the_tenth_power() -> None:
    one, other = wave(2.0, 0.3), wave(6.0, 0.2)
    link = Sperling(form="harmonic", direction="lateral", block_s=5.0)
    parts = [link.read(signal).value for signal in (one, other)]
    both = link.read(one.with_columns(pl.col("x") + other["x"])).value
    assert both == pytest.approx(sum(part**10 for part in parts) ** 0.1, rel=1e-6)


def test_sperling_factors_are_the_table() -> None:
    f = np.array([1.0, 5.0, 10.0, 30.0])
    assert sperling_factor(f, "vertical") == pytest.approx([0.325, 8.125, 4.0, 1.0])
    assert sperling_factor(f, "lateral") == pytest.approx([0.8, 20.0, 6.5, 1.0])


def test_sperling_takes_the_worst_block_or_the_mean_and_refuses_a_record_without_one() -> None:
    signal = wave(5.0, 0.5).with_columns(x=pl.when(pl.col("t") < 20.0).then(pl.col("x")).otherwise(0.0))
    worst = Sperling(form="harmonic", direction="vertical", block_s=5.0).read(signal)
    mean = Sperling(form="harmonic", direction="vertical", block_s=5.0, over="mean").read(signal)
    assert worst.value == pytest.approx(3.041, abs=1e-3)
    assert mean.value == pytest.approx(worst.value / 2.0, rel=1e-3)
    assert worst.t < 20.0
    with pytest.raises(JudgementProblem, match="shorter than the block of 5 s"):
        Sperling(form="harmonic", direction="vertical", block_s=5.0).read(wave(5.0, seconds=4.0))


# ---- indices of three directions


def test_mean_comfort_of_three_sines_is_its_closed_form() -> None:
    # behind Wd at 1 Hz 1.011 (ISO 2631-1, Table 3), behind Wb by its formula
    x, y = wave(1.0, 0.1, seconds=320.0), wave(1.0, 0.2, seconds=320.0)
    z = wave(100.0 / (2.0 * math.pi), 0.3, seconds=320.0)
    ours = MeanComfort().read_together([x, y, z]).value
    wb = wb_of_en_12299(100.0 / (2.0 * math.pi))
    theirs = 6.0 * math.sqrt(((1.011 * 0.1) ** 2 + (1.011 * 0.2) ** 2 + (wb * 0.3) ** 2) / 2.0)
    assert ours == pytest.approx(theirs, rel=2e-3)


def test_mean_comfort_refuses_less_than_five_minutes() -> None:
    short = wave(1.0, seconds=290.0)
    with pytest.raises(JudgementProblem, match="57 blocks of 5 s in the record, 60 are asked for"):
        MeanComfort().read_together([short, short, short])
    assert MeanComfort(blocks=50).read_together([short, short, short]).value > 0.0


def test_vibration_total_adds_squares_with_the_health_factor() -> None:
    x, z = wave(2.0, 1.0), wave(8.0, 2.0)
    still = x.with_columns(x=pl.lit(0.0))
    ours = VibrationTotal(k=[1.4, 1.4, 1.0], settle_s=10.0).read_together([x, still, z]).value
    theirs = math.sqrt(((1.4 * 0.890) ** 2 + (2.0 * 1.036) ** 2) / 2.0)
    assert ours == pytest.approx(theirs, rel=2e-3)


# ---- in a criterion


def criterion(**changes: Any) -> Criterion:
    written = {
        "name": "ride",
        "signal": "az",
        "chain": [{"sperling": {"form": "harmonic", "direction": "vertical", "block_s": 5.0}}],
        "unit": "1",
        "max": 4.0,
        "source": "a test",
    }
    return Criterion.model_validate(written | changes)


def test_an_index_reads_metres_per_second_squared_whatever_its_own_unit() -> None:
    units = {"az": "m/s2"}
    assert chain_problems(criterion()) == []
    assert signal_problems(criterion(), units) == []
    frame = wave(5.0, 0.5, name="az")
    verdict = judge(criterion(), frame, units)
    assert (verdict.outcome, verdict.value) == (Outcome.PASS, pytest.approx(3.041, abs=1e-3))
    # a channel in g is read in m/s2 too
    in_g = judge(criterion(), frame.with_columns(pl.col("az") / 9.80665), {"az": "g"})
    assert in_g.value == pytest.approx(verdict.value)
    # the plot shows the index alone, not the acceleration as if it were one
    [stage] = trace(frame, criterion().chain, "az", given="m/s2", wanted="1")
    assert stage.name == "sperling"


def test_an_index_in_a_wrong_unit_or_of_a_wrong_channel_is_refused() -> None:
    [problem] = chain_problems(criterion(unit="g"))
    assert (problem.key, problem.found) == (("unit",), '"g"')
    [problem] = signal_problems(criterion(), {"az": "N"})
    assert (problem.key, problem.found, problem.allowed) == (("signal",), "az in N", "a signal in m/s2")
    assert judge(criterion(), wave(5.0, name="az"), {"az": "N"}).outcome is Outcome.ERROR


def test_a_joint_statistic_reads_three_signals_together() -> None:
    frame = wave(1.0, 0.1, seconds=320.0, name="ax").with_columns(
        ay=pl.col("ax") * 2.0, az=pl.col("ax") * 0.0
    )
    units = dict.fromkeys(("ax", "ay", "az"), "m/s2")
    ride = criterion(signal=["ax", "ay", "az"], chain=[{"mean_comfort": {}}])
    assert chain_problems(ride) == signal_problems(ride, units) == []
    verdict = judge(ride, frame, units)
    assert verdict.value == pytest.approx(6.0 * 1.011 * math.sqrt(0.05 / 2.0), rel=2e-3)
    assert verdict.signals == ("ax", "ay", "az")
    two = criterion(signal=["ax", "ay"], chain=[{"mean_comfort": {}}])
    [problem] = signal_problems(two, units)
    assert (problem.key, problem.found) == (("signal",), "2 signals")
    assert judge(two, frame, units).outcome is Outcome.ERROR
    with pytest.raises(JudgementProblem, match="joins 3 signals"):
        trace(frame, ride.chain, "ax", given="m/s2", wanted="1")


def test_a_total_value_in_g() -> None:
    frame = wave(8.0, 2.0, name="az").with_columns(ax=pl.lit(0.0), ay=pl.lit(0.0))
    units = dict.fromkeys(("ax", "ay", "az"), "m/s2")
    ride = criterion(signal=["ax", "ay", "az"], chain=[{"vibration_total": {"settle_s": 10.0}}], unit="g")
    verdict = judge(ride, frame, units)
    assert verdict.value == pytest.approx(2.0 * 1.036 / math.sqrt(2.0) / 9.80665, rel=2e-3)
