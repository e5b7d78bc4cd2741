"""Progress of running cases, on stderr: bars on a terminal, plain lines elsewhere, nothing when quiet."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from types import TracebackType
from typing import TYPE_CHECKING, NamedTuple, Self

if TYPE_CHECKING:
    from rich.progress import Progress as RichBars
    from rich.progress import TaskID

LINES_PER_CASE = 4
"""Plain lines while a case runs, where there are few cases."""
FEW = 8
"""So many cases have lines, each, while they run; of more only the ends are told."""


class Entry(NamedTuple):
    """A case that is about to run."""

    name: str
    length: float | None
    """m."""
    cost: float = 1.0
    """Roughly the seconds that it takes."""


class Progress:
    """Hears how cases go; this one says nothing."""

    def begin(self, cases: Sequence[Entry], jobs: int, known: int = 0, about: int = 0) -> None:
        """Cases are about to run on `jobs` threads; `known` more need no run.

        Where `about` so many will run, `cases` grows while they do: a case is in it before anything is heard of it.
        """

    def update(self, index: int, fraction: float, distance: float, factor: float) -> None:
        """A case has come so far (part of the run, m) at so many times real time."""

    def done(self, index: int, wall_s: float, trouble: str | None) -> None:
        """A case has ended, with what went wrong if anything did."""

    def end(self) -> None:
        """No case runs any more."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.end()


class Suite:
    """How far all cases together are, by their costs."""

    def __init__(self, cases: Sequence[Entry], about: int = 0) -> None:
        self._cases, self._about = cases, about
        self._on_way: dict[int, float] = {}
        self._done = 0.0
        self._ended = 0
        self._start = time.perf_counter()

    @property
    def total(self) -> int:
        """Cases in all."""
        return max(self._about, len(self._cases))

    def update(self, index: int, fraction: float) -> None:
        """A case has come so far."""
        self._on_way[index] = min(max(fraction, 0.0), 1.0)

    def done(self, index: int) -> None:
        """A case has ended."""
        self._on_way.pop(index, None)
        self._done += _cost(self._cases[index])
        self._ended += 1

    @property
    def fraction(self) -> float:
        """Share of the work that is done; cases that are not made yet count as the mean of the others."""
        known = [_cost(case) for case in self._cases]
        if not known:
            return 0.0
        on_way = sum(known[index] * part for index, part in self._on_way.items())
        return (self._done + on_way) * len(known) / (sum(known) * self.total)

    @property
    def remaining_s(self) -> float | None:
        """Seconds that the rest will take at the pace so far; none at the start."""
        fraction = self.fraction
        if fraction < 0.02:
            return None
        return (time.perf_counter() - self._start) * (1.0 - fraction) / fraction

    @property
    def text(self) -> str:
        """`3 of 40 cases, 25 s left`."""
        total = self.total
        text = f"{self._ended} of {total} {'case' if total == 1 else 'cases'}"
        left = self.remaining_s
        if left is None or self._ended == total:
            return text
        return f"{text}, {_duration(left)} left"


def _cost(case: Entry) -> float:
    return max(case.cost, 1e-9)


def _duration(seconds: float) -> str:
    whole = round(seconds)
    return f"{whole} s" if whole < 100 else f"{whole // 60} min {whole % 60:02d} s"


class Lines(Progress):
    """A few plain lines per case, for logs; one, when it ends, where there are many cases."""

    def __init__(self) -> None:
        self._cases: Sequence[Entry] = []
        self._said: dict[int, int] = {}
        self._suite = Suite([])

    def begin(self, cases: Sequence[Entry], jobs: int, known: int = 0, about: int = 0) -> None:
        """Says how many there are."""
        self._cases = cases
        self._said = {}
        self._suite = Suite(cases, about)
        noun = "case" if self._suite.total == 1 else "cases"
        found = f", {known} known from before" if known else ""
        self._say(f"running {self._suite.total} {noun} on {jobs} thread{'' if jobs == 1 else 's'}{found}")

    def update(self, index: int, fraction: float, distance: float, factor: float) -> None:
        """Says something every quarter of the way."""
        self._suite.update(index, fraction)
        step = int(fraction * LINES_PER_CASE)
        if self._suite.total <= FEW and self._said.get(index, 0) < step < LINES_PER_CASE:
            self._said[index] = step
            case = self._cases[index]
            self._say(f"{case.name}: {_distance(distance, case.length)}, {factor:.1f} times real time")

    def done(self, index: int, wall_s: float, trouble: str | None) -> None:
        """Says how it ended."""
        self._suite.done(index)
        many = f"; {self._suite.text}" if self._suite.total > FEW else ""
        self._say(f"{self._cases[index].name}: {trouble or 'done'} ({wall_s:.1f} s){many}")

    @staticmethod
    def _say(text: str) -> None:
        sys.stderr.write(f"{text}\n")
        sys.stderr.flush()


class Bars(Progress):
    """A bar for the whole, and one for each case that is on its way, with distance and real-time factor."""

    def __init__(self) -> None:
        self._bars: RichBars | None = None
        self._all: TaskID | None = None
        self._tasks: dict[int, TaskID] = {}
        self._cases: Sequence[Entry] = []
        self._suite = Suite([])

    def begin(self, cases: Sequence[Entry], jobs: int, known: int = 0, about: int = 0) -> None:
        """Draws the bar of the whole."""
        from rich.console import Console
        from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeElapsedColumn
        from rich.progress import Progress as RichBars

        self._bars = RichBars(
            TextColumn("{task.description}"),
            BarColumn(),
            TaskProgressColumn(),
            TextColumn("{task.fields[state]}"),
            TimeElapsedColumn(),
            console=Console(stderr=True),
        )
        self._cases = cases
        self._suite = Suite(cases, about)
        found = f", {known} known from before" if known else ""
        self._all = self._bars.add_task("all", total=1.0, state=f"{self._suite.text}{found}")
        self._bars.start()

    def update(self, index: int, fraction: float, distance: float, factor: float) -> None:
        """Moves a case's bar, drawn when it is heard of first, and that of the whole."""
        if self._bars is None:
            return
        case = self._cases[index]
        if index not in self._tasks:
            self._tasks[index] = self._bars.add_task(case.name, total=1.0, state="")
        state = f"{_distance(distance, case.length)}, {factor:.1f} x real time"
        self._bars.update(self._tasks[index], completed=fraction, state=state)
        self._suite.update(index, fraction)
        self._move()

    def done(self, index: int, wall_s: float, trouble: str | None) -> None:
        """Takes a case's bar away; what went wrong stays to be read."""
        if self._bars is None:
            return
        task = self._tasks.pop(index, None)
        if task is not None:
            self._bars.remove_task(task)
        if trouble is not None:
            self._bars.console.print(f"{self._cases[index].name}: {trouble}", markup=False, highlight=False)
        self._suite.done(index)
        self._move()

    def end(self) -> None:
        """Leaves the bars as they are."""
        if self._bars is not None:
            self._bars.stop()
            self._bars = None

    def _move(self) -> None:
        assert self._bars is not None
        assert self._all is not None
        self._bars.update(self._all, completed=self._suite.fraction, state=self._suite.text)


def _distance(distance: float, length: float | None) -> str:
    return f"{distance:.0f} m" if length is None else f"{distance:.0f} of {length:.0f} m"


def choose(*, quiet: bool) -> Progress:
    """What suits stderr."""
    if quiet:
        return Progress()
    return Bars() if sys.stderr.isatty() else Lines()
