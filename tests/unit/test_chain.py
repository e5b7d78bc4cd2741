"""The criterion contract, on hand-made frames."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from lmap import signals
from lmap.criteria import chain_problems, expand, judge, signal_problems, trace
from lmap.criteria.chain import Criterion
from lmap.criteria.units import STANDARD_GRAVITY, UNITS, comparable, factor
from lmap.errors import JudgementProblem
from lmap.verdict import Outcome

UNITS_OF_FRAME = {"t": "s", "s": "m", "a": "m/s2", "b": "m/s2", "ws1.left.LV": "1", "ws2.left.LV": "1"}


def criterion(**changes: Any) -> Criterion:
    fields: dict[str, Any] = {
        "name": "a",
        "signal": "a",
        "chain": [{"max_abs": {}}],
        "unit": "m/s2",
        "max_abs": 2.0,
        "source": "test",
    }
    return Criterion(**{key: value for key, value in {**fields, **changes}.items() if value is not None})


def frame(**columns: Any) -> pl.DataFrame:
    rows = len(next(iter(columns.values())))
    t = np.arange(rows) / 200.0
    return pl.DataFrame({"t": t, "s": 30.0 * t, **columns})


# ---- limits


@pytest.mark.parametrize(
    ("limit", "value", "margin"),
    [
        ({"max_abs": 2.0}, -1.5, 0.5),
        ({"max_abs": None, "max": 2.0}, 1.5, 0.5),
        ({"max_abs": None, "max": -2.0}, -1.5, -0.5),
        ({"max_abs": None, "min": 2.0}, 1.5, -0.5),
        ({"max_abs": None, "min": -1.0, "max": 3.0}, -0.5, 0.5),
    ],
)
def test_margin_is_the_distance_to_the_nearest_limit(
    limit: dict[str, Any], value: float, margin: float
) -> None:
    found = criterion(**limit).margin(value)
    assert found is not None
    assert found[0] == pytest.approx(margin)


@given(st.floats(-1e6, 1e6), st.floats(1e-6, 1e6))
def test_the_margin_changes_sign_exactly_at_the_limit(value: float, limit: float) -> None:
    one = criterion(max_abs=limit)
    margin = one.margin(value)
    assert margin is not None
    assert (margin[0] >= 0.0) == (abs(value) <= limit) == one.passes(value)


@pytest.mark.parametrize(("strict", "passes"), [(False, True), (True, False)])
@pytest.mark.parametrize(
    "limit", [{"max_abs": 2.0}, {"max_abs": None, "max": 2.0}, {"max_abs": None, "min": 2.0}]
)
def test_reaching_the_limit_passes_unless_strict(limit: dict[str, Any], strict: bool, passes: bool) -> None:
    one = criterion(strict=strict, **limit)
    assert one.passes(2.0) is passes
    assert one.passes(math.nextafter(2.0, 3.0)) is ("min" in limit)
    assert one.passes(math.nextafter(2.0, 1.0)) is ("min" not in limit)


def test_nan_never_passes() -> None:
    assert not criterion().passes(math.nan)
    assert not criterion(max_abs=None).passes(math.nan)


def test_margin_in_per_cent_is_of_the_limit() -> None:
    assert criterion(max_abs=2.0).margin(0.5) == (1.5, 75.0)
    assert criterion(max_abs=None, max=0.0).margin(-1.0) == (1.0, None)


@pytest.mark.parametrize(
    ("limit", "text"),
    [
        ({"max_abs": 0.35, "strict": True}, "|x| < 0.35"),
        ({"max_abs": 0.5}, "|x| <= 0.5"),
        ({"max_abs": None, "max": 1.0}, "<= 1"),
        ({"max_abs": None, "min": -1.0, "max": 1.0}, ">= -1 and <= 1"),
        ({"max_abs": None}, ""),
    ],
)
def test_limits_read_well(limit: dict[str, Any], text: str) -> None:
    assert criterion(**limit).limit_text == text


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"max": 1.0}, "max_abs alone"),
        ({"max_abs": None, "max": 1.0, "min": 1.0}, "a min below max"),
        ({"source": "assumed"}, "a reason"),
        ({"signal": []}, "at least 1 item"),
        ({"chain": []}, "at least 1 item"),
        ({"max_abs": -1.0}, "greater than or equal to 0"),
        ({"max_abs": math.inf}, "finite"),
    ],
)
def test_contradictions_are_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        criterion(**changes)


@pytest.mark.parametrize(
    "changes", [{"max_abs": True}, {"max_abs": "0.3"}, {"strict": 1}, {"strict": "yes"}, {"name": 3}]
)
def test_values_of_another_type_are_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        criterion(**changes)


def test_whole_numbers_are_numbers() -> None:
    one = criterion(max_abs=2, published={"new": 1}, chain=[{"sliding_rms": {"window_s": 2}}])
    assert (one.max_abs, one.published) == (2.0, {"new": 1.0})
    assert chain_problems(one) == []


@pytest.mark.parametrize(
    "parameters", [{"window_s": True}, {"window_s": "2"}, {"window_s": 2.0, "about_mean": 1}]
)
def test_parameters_of_another_type_are_refused(parameters: dict[str, Any]) -> None:
    [problem] = chain_problems(criterion(chain=[{"sliding_rms": parameters}]))
    assert problem.key == ("chain", 0, "sliding_rms", list(parameters)[-1])


# ---- judging


def test_the_worst_of_the_signals_is_judged() -> None:
    verdict = judge(criterion(signal=["a", "b"]), frame(a=[0.0, 1.0], b=[0.0, -1.5]), UNITS_OF_FRAME)
    assert (verdict.outcome, verdict.signal, verdict.value) == (Outcome.PASS, "b", 1.5)
    assert verdict.margin == 0.5
    assert verdict.at == {"t": 0.005, "s": 0.15}
    assert verdict.signals == ("a", "b")


def test_just_passes_and_just_fails() -> None:
    assert judge(criterion(), frame(a=[2.0]), UNITS_OF_FRAME).outcome is Outcome.PASS
    assert judge(criterion(strict=True), frame(a=[2.0]), UNITS_OF_FRAME).outcome is Outcome.FAIL
    assert judge(criterion(), frame(a=[2.0000001]), UNITS_OF_FRAME).outcome is Outcome.FAIL


@pytest.mark.parametrize("bad", [math.nan, math.inf, None])
def test_a_value_that_is_none_is_an_error(bad: float | None) -> None:
    verdict = judge(criterion(), frame(a=[0.0, bad, 0.0]), UNITS_OF_FRAME)
    assert verdict.outcome is Outcome.ERROR
    assert verdict.message == "a is not finite in 1 of 3 samples, first at t = 0.005 s"
    assert verdict.value is None


@pytest.mark.parametrize("lost", [1, 7, slice(3, 5)])
def test_missing_rows_are_an_error(lost: Any) -> None:
    whole = frame(a=np.zeros(20))
    some = whole.filter(~pl.int_range(pl.len()).is_in(np.arange(20)[lost]))
    assert judge(criterion(), whole, UNITS_OF_FRAME).outcome is Outcome.PASS
    verdict = judge(criterion(), some, UNITS_OF_FRAME)
    assert verdict.outcome is Outcome.ERROR
    assert (verdict.message or "").startswith("t is not evenly spaced")


@pytest.mark.parametrize("values", [["0.0", "x"], ["0.0", "1.0"], [True, False], [None, None]])
def test_a_column_that_holds_no_numbers_is_an_error(values: list[Any]) -> None:
    verdict = judge(criterion(), frame(a=values), UNITS_OF_FRAME)
    assert verdict.outcome is Outcome.ERROR
    assert (verdict.message or "").startswith("a holds no numbers but ")


def test_a_nan_on_one_of_several_signals_is_an_error() -> None:
    verdict = judge(criterion(signal=["a", "b"]), frame(a=[0.0], b=[math.nan]), UNITS_OF_FRAME)
    assert verdict.outcome is Outcome.ERROR


def test_a_missing_signal_is_an_error_even_beside_a_present_one() -> None:
    verdict = judge(criterion(signal=["a", "c"]), frame(a=[0.0]), UNITS_OF_FRAME)
    assert (verdict.outcome, verdict.message) == (Outcome.ERROR, "the frame has no channel c")


def test_an_empty_frame_and_an_empty_window_are_errors() -> None:
    assert judge(criterion(), frame(a=[]), UNITS_OF_FRAME).outcome is Outcome.ERROR
    windowed = criterion(chain=[{"sustained": {"window_m": 2.0}}])
    verdict = judge(windowed, frame(a=[0.0, 0.0]), UNITS_OF_FRAME)
    assert verdict.outcome is Outcome.ERROR
    assert verdict.message == "the record of 0.15 m is shorter than the window of 2 m"


def test_a_run_that_ended_early_is_an_error_whatever_it_recorded() -> None:
    verdict = judge(criterion(), frame(a=[0.0]), UNITS_OF_FRAME, ended="the run ended early: ws1 derailed")
    assert (verdict.outcome, verdict.message) == (Outcome.ERROR, "the run ended early: ws1 derailed")


def test_a_unit_of_another_quantity_is_an_error() -> None:
    verdict = judge(criterion(unit="mm"), frame(a=[0.0]), UNITS_OF_FRAME)
    assert (verdict.outcome, verdict.message) == (Outcome.ERROR, "a is in m/s2, which is no mm")


def test_g_is_the_standard_gravity() -> None:
    verdict = judge(criterion(unit="g"), frame(a=[STANDARD_GRAVITY]), UNITS_OF_FRAME)
    assert verdict.value == pytest.approx(1.0, rel=1e-15)


def test_without_a_limit_the_value_is_shown_and_not_judged() -> None:
    verdict = judge(criterion(max_abs=None), frame(a=[-7.0]), UNITS_OF_FRAME)
    assert (verdict.outcome, verdict.judged, verdict.value, verdict.margin) == (
        Outcome.PASS,
        False,
        7.0,
        None,
    )
    assert verdict.bounds == ()


def test_the_published_figure_is_that_of_the_case() -> None:
    one = criterion(published={"new": 1.0})
    assert judge(one, frame(a=[0.0]), UNITS_OF_FRAME, label="new").published == 1.0
    assert judge(one, frame(a=[0.0]), UNITS_OF_FRAME, label="worn").published is None
    assert judge(criterion(published=3.0), frame(a=[0.0]), UNITS_OF_FRAME, label="x").published == 3.0


# ---- names and units


def test_patterns_stand_for_every_channel_that_they_match() -> None:
    assert expand(["ws*.left.LV"], UNITS_OF_FRAME) == ["ws1.left.LV", "ws2.left.LV"]
    assert expand(["a", "ws?.left.LV", "a"], UNITS_OF_FRAME) == ["a", "ws1.left.LV", "ws2.left.LV"]
    assert expand(["ws*.right.LV", "c"], UNITS_OF_FRAME) == []


def test_an_unknown_channel_is_bad_input_with_the_nearest_name() -> None:
    [problem] = signal_problems(criterion(signal=["a", "ws1.left.LW"], unit="m/s2"), UNITS_OF_FRAME)
    assert problem.key == ("signal", 1)
    assert (problem.found, problem.hint) == ('"ws1.left.LW"', 'did you mean "ws1.left.LV"?')


def test_a_unit_that_does_not_compare_is_bad_input() -> None:
    [problem] = signal_problems(criterion(unit="mm"), UNITS_OF_FRAME)
    assert problem.key == ("unit",)
    assert problem.allowed == "a unit of a: g, m/s2"


def test_factors_between_units_undo_each_other() -> None:
    for given_unit in UNITS:
        for wanted in comparable(given_unit):
            there, back = factor(given_unit, wanted), factor(wanted, given_unit)
            assert there is not None
            assert back is not None
            assert there * back == pytest.approx(1.0, rel=1e-12)
    assert factor("N", "m") is None
    assert factor("parsec", "m") is None
    assert list(UNITS) == sorted(UNITS)


# ---- chains


@pytest.mark.parametrize(
    ("chain", "key", "found", "hint"),
    [
        ([{"lowpas": {}}], ("chain", 0), '"lowpas"', 'did you mean "lowpass"?'),
        ([{"remove_mean": {}}], ("chain", 0), "the filter remove_mean", None),
        ([{"max_abs": {}}, {"max_abs": {}}], ("chain", 0), "the statistic max_abs", None),
        ([{}], ("chain", 0), "an empty table", None),
        (
            [{"sustained": {"windw_s": 1.0, "window_m": 1.0}}],
            ("chain", 0, "sustained", "windw_s"),
            'an unknown key "windw_s"',
            'did you mean "window_s"?',
        ),
        ([{"average_peak": {"window_s": -1.0}}], ("chain", 0, "average_peak", "window_s"), "-1.0", None),
        ([{"average_peak": {}}], ("chain", 0, "average_peak", "window_s"), "nothing", None),
    ],
)
def test_faults_of_a_chain_name_the_link(
    chain: list[dict[str, Any]], key: tuple[Any, ...], found: str, hint: str | None
) -> None:
    problem = chain_problems(criterion(chain=chain))[0]
    assert (problem.key, problem.found, problem.hint) == (key, found, hint)


NO_LIMIT: dict[str, Any] = {"max_abs": None, "max": None, "min": None}


@pytest.mark.parametrize(
    "statistic",
    [
        {"maximum": {}},
        {"minimum": {}},
        {"sustained": {"window_s": 1.0}},
        {"sliding_mean": {"window_m": 2.0}},
        {"percentile": {"percent": 99.85}},
    ],
)
def test_max_abs_of_a_one_sided_statistic_is_refused(statistic: dict[str, Any]) -> None:
    [problem] = chain_problems(criterion(chain=[statistic]))
    assert problem.key == ("max_abs",)
    assert problem.allowed == "max or min, absolute = true, or max_abs = {} as statistic"
    assert chain_problems(criterion(**(NO_LIMIT | {"max": 2.0}), chain=[statistic])) == []


@pytest.mark.parametrize(
    "statistic",
    [
        {"sustained": {"window_s": 1.0, "absolute": True}},
        {"sliding_mean": {"window_m": 2.0, "absolute": True}},
        {"percentile": {"percent": 99.85, "absolute": True}},
        {"percentile": {"percent": 99.85, "both_ends": True}},
        {"median": {}},
        {"average_peak": {"window_s": 5.0}},
        {"sliding_rms": {"window_s": 2.0}},
        {"max_abs": {}},
        {"last": {}},
        {"mean": {}},
        {"rms": {}},
        {"peak_to_peak": {}},
    ],
)
def test_max_abs_of_a_statistic_that_sees_both_sides_is_taken(statistic: dict[str, Any]) -> None:
    assert chain_problems(criterion(chain=[statistic])) == []


def test_every_statistic_stands_in_one_of_the_two_lists_above() -> None:
    names = {name for name, kind in signals.BY_NAME.items() if issubclass(kind, signals.Statistic)}
    one_sided = {name for name in names if signals.BY_NAME[name].one_sided}  # type: ignore[attr-defined]
    assert one_sided == {"maximum", "minimum", "sustained", "sliding_mean", "percentile"}
    joint = {name for name in names if issubclass(signals.BY_NAME[name], signals.Joint)}
    assert joint == {"mean_comfort", "vibration_total"}
    both_sides = {
        "average_peak",
        "sliding_rms",
        "max_abs",
        "last",
        "mean",
        "median",
        "rms",
        "peak_to_peak",
        "sperling",
    }
    assert names - one_sided - joint == both_sides


@pytest.mark.parametrize("link", ["sustained", "sliding_mean"])
@pytest.mark.parametrize("absolute", [True, False])
def test_a_least_value_of_the_largest_window_is_refused(link: str, absolute: bool) -> None:
    chain = [{link: {"window_s": 1.0, "absolute": absolute}}]
    [problem] = chain_problems(criterion(**(NO_LIMIT | {"min": 0.5}), chain=chain))
    assert (problem.key, problem.allowed) == (("min",), "max, or minimum = {} as statistic")
    assert chain_problems(criterion(**(NO_LIMIT | {"min": 0.5}), chain=[{"minimum": {}}])) == []


def test_a_criterion_can_be_written_back() -> None:
    one = criterion(signal=["a", "b"], chain=[{"lowpass": {"cutoff_hz": 10.0, "order": 4}}, {"max_abs": {}}])
    written = one.written()
    assert written["chain"] == [{"lowpass": {"cutoff_hz": 10.0}}, {"max_abs": {}}]
    assert Criterion(**written).links() == one.links()


def test_a_trace_shows_every_stage_in_the_criterions_unit() -> None:
    t = np.arange(4001) / 200.0
    one = criterion(chain=[{"lowpass": {"cutoff_hz": 10.0}}, {"average_peak": {"window_s": 5.0}}], unit="g")
    data = frame(a=STANDARD_GRAVITY * np.sin(2.0 * math.pi * t))
    stages = trace(data, one.chain, "a", given="m/s2", wanted="g")
    assert [stage.name for stage in stages] == ["signal", "lowpass", "average_peak"]
    assert stages[0].values.max() == pytest.approx(1.0, rel=1e-6)
    assert stages[2].values.max() == judge(one, data, UNITS_OF_FRAME).value
    with pytest.raises(JudgementProblem, match="has no channel c"):
        trace(data, one.chain, "c")
