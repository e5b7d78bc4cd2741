"""`compare`: ours against a number that somebody else, or a closed form, gives; the table is printed after the run."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

Compare = Callable[..., None]
PROPERTY = "compared"
"""Under this name each comparison travels with its test's report, from another process too."""


@pytest.fixture
def compare(request: pytest.FixtureRequest) -> Compare:
    """`compare(what, ours, theirs, tolerance, source)` fails on NaN and beyond `tolerance` (in the unit of `what`)."""
    rows = request.node.user_properties

    def judge(what: str, ours: float, theirs: float, tolerance: float, source: str) -> None:
        # plain numbers: they may have to leave this process
        rows.append((PROPERTY, (what, float(ours), float(theirs), float(tolerance), source)))
        assert math.isfinite(ours), f"{what}: {ours}"
        assert abs(ours - theirs) <= tolerance, (
            f"{what}: ours {ours:.6g}, {source} {theirs:.6g}, allowed {tolerance:.3g}"
        )

    return judge


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    reports = [one for kind in ("passed", "failed") for one in terminalreporter.stats.get(kind, [])]
    rows = sorted(
        (report.nodeid, number, row)
        for report in reports
        if getattr(report, "when", "") == "call"
        for number, (name, row) in enumerate(report.user_properties)
        if name == PROPERTY
    )
    if rows:
        terminalreporter.section("validation: ours, theirs, difference (allowed)")
        width = max(len(row[0]) for *_, row in rows)
        for *_, (what, ours, theirs, tolerance, source) in rows:
            terminalreporter.write_line(
                f"{what:<{width}}  {ours:>12.6g} {theirs:>12.6g} {ours - theirs:>+11.3g} ({tolerance:.3g})  {source}"
            )
