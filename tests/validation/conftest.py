"""`compare`: ours against a number that somebody else, or a closed form, gives; the table is printed after the run."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

Compare = Callable[..., None]
Row = tuple[str, float, float, float, str]
ROWS = pytest.StashKey[list[Row]]()


def pytest_configure(config: pytest.Config) -> None:
    config.stash.setdefault(ROWS, [])


@pytest.fixture
def compare(request: pytest.FixtureRequest) -> Compare:
    """`compare(what, ours, theirs, tolerance, source)` fails on NaN and beyond `tolerance` (in the unit of `what`)."""
    rows = request.config.stash[ROWS]

    def judge(what: str, ours: float, theirs: float, tolerance: float, source: str) -> None:
        rows.append((what, ours, theirs, tolerance, source))
        assert math.isfinite(ours), f"{what}: {ours}"
        assert abs(ours - theirs) <= tolerance, (
            f"{what}: ours {ours:.6g}, {source} {theirs:.6g}, allowed {tolerance:.3g}"
        )

    return judge


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    rows = config.stash[ROWS]
    if rows:
        terminalreporter.section("validation: ours, theirs, difference (allowed)")
        width = max(len(row[0]) for row in rows)
        for what, ours, theirs, tolerance, source in rows:
            terminalreporter.write_line(
                f"{what:<{width}}  {ours:>12.6g} {theirs:>12.6g} {ours - theirs:>+11.3g} ({tolerance:.3g})  {source}"
            )
