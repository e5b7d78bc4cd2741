"""Progress of running cases, on stderr: bars on a terminal, plain lines elsewhere, nothing when quiet."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from rich.progress import Progress as RichBars
    from rich.progress import TaskID

LINES_PER_CASE = 4
"""Plain lines while a case runs."""


class Progress:
    """Hears how cases go; this one says nothing."""

    def begin(self, cases: Sequence[tuple[str, float | None]], jobs: int) -> None:
        """Cases by label and length (m) are about to run on `jobs` threads."""

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


class Lines(Progress):
    """A few plain lines per case, for logs."""

    def __init__(self) -> None:
        self._cases: list[tuple[str, float | None]] = []
        self._said: list[int] = []

    def begin(self, cases: Sequence[tuple[str, float | None]], jobs: int) -> None:
        """Says how many there are."""
        self._cases = list(cases)
        self._said = [0] * len(cases)
        noun = "case" if len(cases) == 1 else "cases"
        self._say(f"running {len(cases)} {noun} on {jobs} thread{'' if jobs == 1 else 's'}")

    def update(self, index: int, fraction: float, distance: float, factor: float) -> None:
        """Says something every quarter of the way."""
        step = int(fraction * LINES_PER_CASE)
        if self._said[index] < step < LINES_PER_CASE:
            self._said[index] = step
            label, length = self._cases[index]
            self._say(f"{label}: {_distance(distance, length)}, {factor:.1f} times real time")

    def done(self, index: int, wall_s: float, trouble: str | None) -> None:
        """Says how it ended."""
        self._say(f"{self._cases[index][0]}: {trouble or 'done'} ({wall_s:.1f} s)")

    @staticmethod
    def _say(text: str) -> None:
        sys.stderr.write(f"{text}\n")
        sys.stderr.flush()


class Bars(Progress):
    """One bar per case, with distance and real-time factor."""

    def __init__(self) -> None:
        self._bars: RichBars | None = None
        self._tasks: list[TaskID] = []
        self._lengths: list[float | None] = []

    def begin(self, cases: Sequence[tuple[str, float | None]], jobs: int) -> None:
        """Draws a bar for each."""
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
        self._lengths = [length for _, length in cases]
        self._tasks = [
            self._bars.add_task(label, total=1.0, start=False, state="waiting") for label, _ in cases
        ]
        self._bars.start()

    def update(self, index: int, fraction: float, distance: float, factor: float) -> None:
        """Moves a bar."""
        if self._bars is None:
            return
        task = self._tasks[index]
        if not self._bars.tasks[index].started:
            self._bars.start_task(task)
        state = f"{_distance(distance, self._lengths[index])}, {factor:.1f} x real time"
        self._bars.update(task, completed=fraction, state=state)

    def done(self, index: int, wall_s: float, trouble: str | None) -> None:
        """Stops a bar."""
        if self._bars is None:
            return
        task = self._tasks[index]
        if not self._bars.tasks[index].started:
            self._bars.start_task(task)
        if trouble is None:
            self._bars.update(task, completed=1.0)
        else:
            self._bars.update(task, state=trouble)
        self._bars.stop_task(task)

    def end(self) -> None:
        """Leaves the bars as they are."""
        if self._bars is not None:
            self._bars.stop()
            self._bars = None


def _distance(distance: float, length: float | None) -> str:
    return f"{distance:.0f} m" if length is None else f"{distance:.0f} of {length:.0f} m"


def choose(*, quiet: bool) -> Progress:
    """What suits stderr."""
    if quiet:
        return Progress()
    return Bars() if sys.stderr.isatty() else Lines()
