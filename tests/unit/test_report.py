"""JSON, JUnit XML, the terminal's table and parquet."""

from __future__ import annotations

import io
import json
import math
import xml.etree.ElementTree as ET
from dataclasses import replace
from typing import Any

import polars as pl
import pytest
import report_sample as sample
from rich.console import Console

from lmap.report import document, junit, numbers, runs, to_json, words
from lmap.report.parquet import to_parquet
from lmap.report.terminal import table
from lmap.verdict import Acceptance, CriterionVerdict, Held, Outcome


def with_first(acceptance: Acceptance, **changes: Any) -> Acceptance:
    """The acceptance with its first criterion changed."""
    spec = acceptance.specs[0]
    criteria = (replace(spec.criteria[0], **changes), *spec.criteria[1:])
    return replace(acceptance, specs=(replace(spec, criteria=criteria),))


def printed(acceptance: Acceptance, width: int = 80) -> str:
    """What a log file would get."""
    out = io.StringIO()
    table(acceptance, Console(file=out, width=width, no_color=True, force_terminal=False))
    return out.getvalue()


def first(acceptance: Acceptance) -> CriterionVerdict:
    return acceptance.specs[0].criteria[0]


def test_document_has_the_keys_of_the_contract() -> None:
    data = document(sample.passing())
    assert set(data) >= {"version", "specs"}
    (spec,) = data["specs"]
    assert set(spec) >= {"id", "title", "file", "verdict", "criteria"}
    wanted = {"name", "case", "value", "unit", "limit", "margin", "verdict", "source", "published"}
    assert all(set(criterion) >= wanted for criterion in spec["criteria"])
    assert spec["verdict"] == "pass"
    assert spec["criteria"][0]["published"] == 0.055
    assert spec["criteria"][0]["verdict"] == "pass"


def test_json_has_no_nan_and_no_clock() -> None:
    acceptance = with_first(sample.passing(), value=math.nan, margin=math.inf, at={"t": math.nan})

    def refuse(text: str) -> None:
        raise AssertionError(text)

    data = json.loads(to_json(acceptance), parse_constant=refuse)
    criterion = data["specs"][0]["criteria"][0]
    assert criterion["value"] is None
    assert criterion["margin"] is None
    assert criterion["at"] == {"t": None}
    assert "wall" not in to_json(acceptance)


def test_json_depends_on_nothing_that_a_clock_gave() -> None:
    acceptance = sample.passing()
    spec = acceptance.specs[0]
    cases = tuple(
        replace(case, wall_s=9.9, statistics={**case.statistics, "wall_s": 9.9}) for case in spec.cases
    )
    slower = replace(acceptance, wall_s=99.0, specs=(replace(spec, cases=cases),))
    assert to_json(slower) == to_json(acceptance)
    assert junit(slower) == junit(acceptance)


@pytest.mark.parametrize(
    ("acceptance", "outcome", "counts"),
    [
        (sample.passing(), Outcome.PASS, ("6", "0", "0", "0")),
        (sample.failing(), Outcome.FAIL, ("3", "1", "0", "0")),
        (sample.diverged(), Outcome.ERROR, ("3", "0", "3", "0")),
        (sample.waiting(Outcome.MANUAL), Outcome.MANUAL, ("4", "0", "0", "1")),
        (sample.waiting(Outcome.NOT_ASSESSED), Outcome.NOT_ASSESSED, ("4", "0", "0", "1")),
    ],
)
def test_junit_counts_follow_the_outcomes(
    acceptance: Acceptance, outcome: Outcome, counts: tuple[str, str, str, str]
) -> None:
    assert acceptance.outcome is outcome
    root = ET.fromstring(junit(acceptance))
    (suite,) = root.findall("testsuite")
    for element in (root, suite):
        assert tuple(element.get(key) for key in ("tests", "failures", "errors", "skipped")) == counts
    assert suite.get("name") == "2C.1 Hunting"
    assert len(suite.findall("testcase")) == int(counts[0])
    names = [test.get("name") or "" for test in suite.iter("testcase")]
    assert len(set(names)) == len(names)


def test_junit_failure_tells_value_limit_and_margin() -> None:
    root = ET.fromstring(junit(sample.failing()))
    message = next(root.iter("failure")).get("message") or ""
    criterion = first(sample.failing())
    assert numbers.quantity(criterion.value, "g") in message
    assert "limit |x| < 0.35 g" in message
    assert "margin -" in message


def test_junit_survives_characters_that_xml_cannot_carry() -> None:
    acceptance = with_first(sample.diverged(), message='<a> & "b" \x00\x1b[31m')
    root = ET.fromstring(junit(acceptance))
    assert '<a> & "b"' in (next(root.iter("error")).get("message") or "")


def test_junit_of_a_spec_without_criteria_is_an_error() -> None:
    spec = replace(sample.passing().specs[0], criteria=(), outcome=Outcome.ERROR)
    assert ET.fromstring(junit(sample.acceptance(spec))).get("errors") == "1"


@pytest.mark.parametrize("width", [80, 100, 200])
def test_terminal_folds_and_truncates_nothing(width: int) -> None:
    text = printed(sample.passing(), width)
    assert "…" not in text
    assert "\x1b" not in text
    assert max(map(len, text.splitlines())) <= width
    criteria = sample.passing().specs[0].criteria
    for criterion in criteria:
        assert numbers.quantity(criterion.value, criterion.unit) in text
        assert criterion.limit in text
        assert numbers.percent(criterion.margin_percent) in text
    for words_ in (
        "PASS",
        "0.055",
        "0.059",
        "assumed",
        "Nadal",
        "secondary.kz",
        "ros2 0.5 ms",
        "16.0 x",
    ):
        assert words_ in text
    for fact in sample.passing().specs[0].facts:
        assert fact.value in text
        assert (fact.published or "-") in text


def test_terminal_of_a_diverged_run_says_why_once() -> None:
    text = " ".join(printed(sample.diverged(), 120).split())
    assert text.count("ws1 left the track") == 1
    assert "every criterion (anzr1_worn_1): diverged at t = 3 s" in text
    assert "PASS" not in text
    assert "3 could not be judged" in text


def test_terminal_of_a_fail_and_of_what_waits() -> None:
    assert "FAIL 2C.1 Hunting: 1 of 2 pass, 1 fail; smallest margin -" in " ".join(
        printed(sample.failing()).split()
    )
    waiting = printed(sample.waiting(Outcome.NOT_ASSESSED), 100)
    assert "NOT ASSESSED" in waiting
    assert "waits for a person's sign-off" in waiting


def test_terminal_without_margin_prints_a_dash() -> None:
    acceptance = with_first(sample.passing(), margin=None, margin_percent=None)
    assert "PASS" in printed(acceptance)


def test_terminal_takes_markup_in_names_as_text() -> None:
    acceptance = with_first(sample.passing(), name="[bold]rig[/bold] [x]")
    assert "[bold]rig[/bold] [x]" in printed(acceptance, 200)


def test_criterion_without_a_limit_is_shown_and_not_counted() -> None:
    criteria = sample.passing().specs[0].criteria
    assert [words.verdict(criterion) for criterion in criteria[-2:]] == ["shown", "shown"]
    assert words.headline(criteria).startswith("4 of 4 pass")


def test_no_criterion_is_no_pass() -> None:
    assert words.headline([]) == "no criterion was judged"


def test_smallest_margin_is_by_per_cent_and_a_zero_margin_counts() -> None:
    low = replace(first(sample.passing()), margin=0.0, margin_percent=0.0)
    assert words.least([first(sample.failing()), low]) == first(sample.failing())
    assert words.least([first(sample.passing()), low]) == low


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "-"),
        (math.nan, "not a number"),
        (-math.inf, "-infinite"),
        (0.0, "0"),
        (0.34996, "0.3500"),
        (-0.0123456, "-0.01235"),
        (109515.0, "109515"),
        (2.5e-7, "2.500e-07"),
        (3.2e9, "3.200e+09"),
    ],
)
def test_numbers_have_four_digits(value: float | None, text: str) -> None:
    assert numbers.number(value) == text


def test_numbers_with_units_and_signs() -> None:
    assert numbers.quantity(0.5, "1") == "0.5000"
    assert numbers.quantity(0.5, "g") == "0.5000 g"
    # as many digits as what is laid beside it
    assert numbers.quantity(109.50764, "kN", 109.515) == "109.508 kN"
    assert numbers.quantity(2.35, "s", 4.0) == "2.350 s"
    assert numbers.signed(0.0, "g") == "0 g"
    assert numbers.signed(0.2, "g") == "+0.2000 g"
    assert numbers.given(0.055, "g") == "0.055 g"
    assert numbers.percent(None) == "-"


def test_run_figures_of_an_empty_frame() -> None:
    empty = sample.case("a", frames=Held(pl.DataFrame(), pl.DataFrame()), wall_s=0.0, case={})
    run = runs.figures(empty)
    assert (run.distance, run.simulated, run.wall, run.real_time_factor) == ("-", "-", "-", "-")
    assert (run.scheme, run.step) == ("-", "-")


def test_parquet_carries_units_meanings_and_the_hash() -> None:
    case = sample.case("anzr1_worn_1")
    content = to_parquet(case)
    metadata = pl.read_parquet_metadata(io.BytesIO(content))
    assert metadata["lmap.case"] == case.hash
    channels = json.loads(metadata["lmap.channels"])
    assert [channel["name"] for channel in channels] == case.frame.columns
    assert {channel["name"]: channel["unit"] for channel in channels} == case.units
    assert all(channel["meaning"] == "a meaning" for channel in channels)
    assert pl.read_parquet(io.BytesIO(content)).equals(case.frame)


def test_parquet_of_the_same_frame_has_the_same_bytes() -> None:
    assert to_parquet(sample.case("a", wall_s=1.0)) == to_parquet(sample.case("a", wall_s=2.0))
