"""Running cases on this machine's threads."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any

import polars as pl

from lmap import toml
from lmap.errors import Problem
from lmap.execute.cost import estimate
from lmap.execute.progress import Entry, Progress
from lmap.execute.store import Store, StoredFrame
from lmap.spec.case import Case, Control
from lmap.verdict import NO_EXTENT, Extent

END_OF_TRACK = "end_of_track"
COMPLETE = "complete"
"""An analysis gave all its rows."""
REFUSED = "refused"
"""A control law of the user's failed: bad input that only the run brings out."""


@dataclass(frozen=True, slots=True)
class CaseOutcome:
    """What came back for one case."""

    source: pl.DataFrame | StoredFrame | None
    """The channels, up to where the run ended, or where they lie; nothing where it never started."""
    ended: Mapping[str, Any]
    """`kind` (`end_of_track`, `complete`, `diverged`, `refused` or `error`), `t`, `s`, `message`."""
    statistics: Mapping[str, Any] = field(default_factory=dict)
    wall_s: float = 0.0
    extent: Extent = NO_EXTENT
    stored: bool = False
    """Whether it was found, not run."""
    problems: tuple[Problem, ...] = ()
    """What is wrong with the control law of a case that was `refused`; keys start at the case."""

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
    `KeyboardInterrupt`. With a `store` every frame goes there as soon as it is there, but for those of control laws of
    the user's, which are never kept. `heard(hash, outcome)` is called as cases end, on the calling thread; `names` are
    shown while they run (by default their labels), `known` says how many more there are that need no run.
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
        outcome = _outcome(result, wall_s, railsim, distinct[index].control)
        case_hash = distinct[index].hash
        if store is not None and distinct[index].control is None:
            outcome = store.keep(case_hash, outcome)
        outcomes[index] = outcome
        hears.done(index, outcome.wall_s, outcome.trouble)
        if heard is not None:
            heard(case_hash, outcome)

    entries = [Entry(shown[case.hash], _length(case), costs[case.hash]) for case in distinct]
    with hears, _laws(distinct) as laws:
        hears.begin(entries, threads, known)
        cores = [case.core_json for case in distinct]
        railsim.run_cases(cores, threads, on_progress, on_done, toml.tables(), laws)
    by_hash = {
        case.hash: outcome or CaseOutcome(None, {"kind": "error", "message": "the core gave no result"})
        for case, outcome in zip(distinct, outcomes, strict=True)
    }
    return [by_hash[case.hash] for case in cases]


@contextlib.contextmanager
def _laws(cases: Sequence[Case]) -> Iterator[dict[int, Any]]:
    """Control laws as the core asks them, by the index of their case, each for one run.

    Begun here, on the calling thread, before any other runs: an FMU's library is loaded from its own folder, and the
    working folder is the whole process's.
    """
    with contextlib.ExitStack() as stack:
        laws = {}
        for index, case in enumerate(cases):
            if case.control is None:
                continue
            running = case.control.start()
            stack.callback(running.close)
            laws[index] = {
                "name": case.control.name,
                "channels": case.control.channels,
                "outputs": case.control.outputs,
                "sample": running.sample,
            }
        yield laws


def _outcome(result: Any, wall_s: float, railsim: ModuleType, control: Control | None) -> CaseOutcome:
    if isinstance(result, railsim.RailsimError):
        message = str(result)
        if control is None or not isinstance(result, railsim.InputError):
            return CaseOutcome(None, {"kind": "error", "message": message}, wall_s=wall_s)
        problems = tuple(
            problem.at(prefix=("run",)) if problem.key[:1] == ("controller",) else problem
            for problem in toml.problems_of_core(result)
        )
        return CaseOutcome(None, {"kind": REFUSED, "message": message}, wall_s=wall_s, problems=problems)
    statistics = dict(result.statistics)
    ended = dict(result.ended)
    frame = pl.DataFrame(result)
    return CaseOutcome(frame, ended, statistics, float(getattr(result, "wall_s", wall_s)), Extent.of(frame))


def _length(case: Case) -> float | None:
    length = case.data.get("track", {}).get("length")
    return float(length) if isinstance(length, int | float) else None
