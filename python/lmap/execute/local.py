"""Running cases on this machine's threads."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import polars as pl

from lmap import toml
from lmap.execute.cost import estimate
from lmap.execute.progress import Entry, Progress
from lmap.execute.store import Store, StoredFrame
from lmap.spec.case import Case
from lmap.verdict import NO_EXTENT, Extent

END_OF_TRACK = "end_of_track"
COMPLETE = "complete"
"""An analysis gave all its rows."""


@dataclass(frozen=True, slots=True)
class CaseOutcome:
    """What came back for one case."""

    source: pl.DataFrame | StoredFrame | None
    """The channels, up to where the run ended, or where they lie; nothing where it never started."""
    ended: Mapping[str, Any]
    """`kind` (`end_of_track`, `complete`, `diverged` or `error`), `t`, `s`, `message`."""
    statistics: Mapping[str, Any] = field(default_factory=dict)
    wall_s: float = 0.0
    extent: Extent = NO_EXTENT
    stored: bool = False
    """Whether it was found, not run."""

    @property
    def frame(self) -> pl.DataFrame | None:
        """The channels; read from disk at every call where they lie there."""
        return self.source.read() if isinstance(self.source, StoredFrame) else self.source

    @property
    def complete(self) -> bool:
        """Whether the run reached its end."""
        return self.ended.get("kind") in (END_OF_TRACK, COMPLETE)

    @property
    def trouble(self) -> str | None:
        """Why the run ended before its end."""
        if self.complete:
            return None
        return f"the run ended early: {self.ended.get('message') or self.ended.get('kind')}"


def default_jobs() -> int:
    """The processors that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on macOS and Windows
        return os.cpu_count() or 1


def run_cases(
    cases: Sequence[Case],
    *,
    jobs: int | None = None,
    progress: Progress | None = None,
    names: Sequence[str] | None = None,
    store: Store | None = None,
    known: int = 0,
    heard: Callable[[str, CaseOutcome], None] | None = None,
) -> list[CaseOutcome]:
    """Runs cases on `jobs` threads, the longest first; outcomes stand in the order of the cases.

    Each distinct case runs once. A case that cannot run becomes an outcome with its message; Ctrl-C raises
    `KeyboardInterrupt`. With a `store` every frame goes there as soon as it is there. `heard(hash, outcome)` is called
    as cases end, on the calling thread; `names` are shown while they run (by default their labels), `known` says how
    many more there are that need no run.
    """
    shown = dict(zip((case.hash for case in cases), names or [case.label for case in cases], strict=True))
    distinct = list({case.hash: case for case in cases}.values())
    if not distinct:
        return []
    costs = {case.hash: estimate(case) for case in distinct}
    distinct.sort(key=lambda case: -costs[case.hash])
    threads = max(1, min(jobs or default_jobs(), len(distinct)))
    outcomes: list[CaseOutcome | None] = [None] * len(distinct)
    begun: list[float | None] = [None] * len(distinct)
    hears = Progress() if progress is None else progress
    railsim = toml.core()
    start = time.perf_counter()

    def on_progress(index: int, fraction: float, distance: float, factor: float) -> None:
        if begun[index] is None:
            begun[index] = time.perf_counter()
        hears.update(index, fraction, distance, factor)

    def on_done(index: int, result: Any) -> None:
        wall_s = time.perf_counter() - (begun[index] or start)
        outcome = _outcome(result, wall_s, railsim.RailsimError)
        case_hash = distinct[index].hash
        if store is not None:
            outcome = store.keep(case_hash, outcome)
        outcomes[index] = outcome
        hears.done(index, outcome.wall_s, outcome.trouble)
        if heard is not None:
            heard(case_hash, outcome)

    entries = [Entry(shown[case.hash], _length(case), costs[case.hash]) for case in distinct]
    with hears:
        hears.begin(entries, threads, known)
        railsim.run_cases([case.core_json for case in distinct], threads, on_progress, on_done, toml.tables())
    by_hash = {
        case.hash: outcome or CaseOutcome(None, {"kind": "error", "message": "the core gave no result"})
        for case, outcome in zip(distinct, outcomes, strict=True)
    }
    return [by_hash[case.hash] for case in cases]


def _outcome(result: Any, wall_s: float, error: type[Exception]) -> CaseOutcome:
    if isinstance(result, error):
        return CaseOutcome(None, {"kind": "error", "message": str(result)}, wall_s=wall_s)
    statistics = dict(result.statistics)
    ended = dict(result.ended)
    frame = pl.DataFrame(result)
    return CaseOutcome(frame, ended, statistics, float(getattr(result, "wall_s", wall_s)), Extent.of(frame))


def _length(case: Case) -> float | None:
    length = case.data.get("track", {}).get("length")
    return float(length) if isinstance(length, int | float) else None
