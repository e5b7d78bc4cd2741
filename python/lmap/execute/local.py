"""Running cases on this machine's threads."""

from __future__ import annotations

import contextlib
import functools
import heapq
import itertools
import os
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any, NamedTuple

import polars as pl

from lmap import toml
from lmap.errors import InputProblem, Problem
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

    @property
    def progress(self) -> str | None:
        """`trouble` as progress says it: what a control law did is told in the end, once, with file and line."""
        return "its control law failed" if self.ended.get("kind") == REFUSED else self.trouble


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
    store: Store | None = None,
) -> list[CaseOutcome]:
    """Runs cases on `jobs` threads, the longest first; outcomes stand in the order of the cases.

    Each distinct case runs once. A case that cannot run becomes an outcome with its message; Ctrl-C raises
    `KeyboardInterrupt`. With a `store` every frame goes there as soon as it is there, but for those of control laws of
    the user's, which are never kept.
    """
    distinct = {case.hash: case for case in cases}
    outcomes: dict[str, CaseOutcome] = {}
    queue = Queue(Named(case, case.label) for case in distinct.values())
    run_queue(queue, jobs=jobs, progress=progress, store=store, heard=outcomes.__setitem__)
    missing = CaseOutcome(None, {"kind": "error", "message": "the core gave no result"})
    return [outcomes.get(case.hash, missing) for case in cases]


class Named(NamedTuple):
    """A case and what progress calls it."""

    case: Case
    name: str


class Queue:
    """Cases in the order in which they begin: the longest of those at hand.

    Without `ahead` all are at hand from the start. With it so many are, and the next is taken from `cases` when a
    thread is free: threads share the work of making them too. `about` says how many there will be, as far as is known.
    """

    def __init__(self, cases: Iterable[Named], *, ahead: int | None = None, about: int = 0) -> None:
        self._left = iter(cases)
        self._ahead, self._about = ahead, about
        self._heap: list[tuple[float, int, Named]] = []
        self._taken = itertools.count()
        self.entries: list[Entry] = []
        """Of the cases that have been handed out, in that order, and without `ahead` of all."""
        self.handed: list[Case] = []
        """What has been handed out."""
        self._laws = contextlib.ExitStack()
        self._fill()
        if ahead is None:
            self.entries = [_entry(named, -cost) for cost, _, named in sorted(self._heap)]

    @property
    def about(self) -> int:
        """How many cases there will be."""
        return max(self._about, len(self.handed) + len(self._heap))

    def __enter__(self) -> None:
        self._laws.__enter__()

    def __exit__(self, *error: object) -> None:
        """Ends the control laws that were begun."""
        self._laws.close()

    def __iter__(self) -> Iterator[str | tuple[str, dict[str, Any]]]:
        """Each case as the core reads it, with its control law where it has one, begun for this run."""
        while self._heap:
            cost, _, named = heapq.heappop(self._heap)
            self.handed.append(named.case)
            if self._ahead is not None:
                self.entries.append(_entry(named, -cost))
            control = named.case.control
            yield named.case.core_json if control is None else (named.case.core_json, self._begin(control))
            self._fill()

    def _begin(self, control: Control) -> dict[str, Any]:
        law = {"name": control.name, "channels": control.channels, "outputs": control.outputs}
        try:
            running = control.start()
        except InputProblem as problem:
            # It began when the case was prepared: now it is this run's failure, told as any other of a law.
            return {**law, "sample": functools.partial(_refuse, str(problem.problems[0].found))}
        self._laws.callback(running.close)
        return {**law, "sample": running.sample}

    def _fill(self) -> None:
        while self._ahead is None or len(self._heap) < self._ahead:
            named = next(self._left, None)
            if named is None:
                self._about = 0  # now it is known
                return
            heapq.heappush(self._heap, (-estimate(named.case), next(self._taken), named))


def _refuse(why: str, *_: object) -> None:
    raise RuntimeError(why)


def _entry(named: Named, cost: float) -> Entry:
    return Entry(named.name, _length(named.case), cost)


def run_queue(
    queue: Queue,
    *,
    jobs: int | None = None,
    progress: Progress | None = None,
    store: Store | None = None,
    known: int = 0,
    heard: Callable[[str, CaseOutcome], None],
) -> None:
    """Runs what a queue hands out; `heard(hash, outcome)` is called as cases end, on the calling thread.

    `known` says how many more there are that need no run.
    """
    if not queue.about:
        return
    threads = max(1, min(jobs or default_jobs(), queue.about))
    begun: dict[int, float] = {}
    hears = Progress() if progress is None else progress
    railsim = toml.core()
    start = time.perf_counter()

    def on_progress(index: int, fraction: float, distance: float, factor: float) -> None:
        begun.setdefault(index, time.perf_counter())
        hears.update(index, fraction, distance, factor)

    def on_done(index: int, result: Any) -> None:
        wall_s = time.perf_counter() - begun.pop(index, start)
        case = queue.handed[index]
        outcome = _outcome(result, wall_s, railsim, case.control)
        if store is None or case.control is not None:
            tell(index, case, outcome)
        else:
            with store.holding(case.hash, outcome.frame):
                tell(index, case, store.keep(case.hash, outcome))

    def tell(index: int, case: Case, outcome: CaseOutcome) -> None:
        hears.done(index, outcome.wall_s, outcome.progress)
        heard(case.hash, outcome)

    with hears, queue:
        hears.begin(queue.entries, threads, known, queue.about)
        railsim.run_cases(queue, threads, on_progress, on_done, toml.tables())


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
