"""Outcomes and exit codes."""

from __future__ import annotations

import pytest

from lmap.verdict import Outcome


def test_the_worst_outcome_counts() -> None:
    assert Outcome.worst([Outcome.PASS, Outcome.FAIL, Outcome.MANUAL]) is Outcome.FAIL
    assert Outcome.worst([Outcome.ERROR, Outcome.FAIL]) is Outcome.ERROR


def test_nothing_judged_is_an_error() -> None:
    assert Outcome.worst([]) is Outcome.ERROR


@pytest.mark.parametrize(
    ("outcome", "code"),
    [
        (Outcome.PASS, 0),
        (Outcome.FAIL, 1),
        (Outcome.MANUAL, 1),
        (Outcome.NOT_ASSESSED, 1),
        (Outcome.ERROR, 2),
    ],
)
def test_exit_codes(outcome: Outcome, code: int) -> None:
    assert outcome.exit_code == code
