"""What a check found: outcomes with margins, and the results they were read from.

A criterion is judged in each case on the worst of its signals; a spec's verdict is its worst criterion, an
acceptance's the worst of its specs. Nothing here computes: these are the plain results that terminal, report
and JSON read.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    import polars as pl


class Outcome(StrEnum):
    """How a criterion, a spec or a whole check ended."""

    PASS = "pass"
    FAIL = "fail"
    ERROR = "error"
    MANUAL = "manual"
    NOT_ASSESSED = "not assessed"

    @property
    def severity(self) -> int:
        """Order from best (0) to worst: pass, not assessed, manual, fail, error."""
        return _SEVERITY.index(self)

    @property
    def exit_code(self) -> int:
        """0 passed, 1 something fails or waits for a person or for data, 2 it could not be judged."""
        match self:
            case Outcome.PASS:
                return 0
            case Outcome.ERROR:
                return 2
            case _:
                return 1

    @staticmethod
    def worst(outcomes: Iterable[Outcome]) -> Outcome:
        """The worst of them; nothing at all is an error, never a pass."""
        return max(outcomes, key=lambda outcome: outcome.severity, default=Outcome.ERROR)


_SEVERITY = [Outcome.PASS, Outcome.NOT_ASSESSED, Outcome.MANUAL, Outcome.FAIL, Outcome.ERROR]


@dataclass(frozen=True, slots=True, kw_only=True)
class CriterionVerdict:
    """One criterion in one case.

    `value`, `bounds` and `margin` are in `unit`. A criterion without a limit is printed, not judged: `judged`
    is false, its outcome is a pass and its limit and margin are empty.
    """

    index: int
    """Position among the spec's `[[criterion]]` tables, from 0."""
    name: str
    case: str
    """Label of the case."""
    case_hash: str
    signals: tuple[str, ...]
    """Every channel that was looked at."""
    signal: str | None
    """The one it was judged on: the worst."""
    chain: tuple[Mapping[str, Any], ...]
    """Links as written in the spec, for `lmap.criteria.chain.trace`."""
    value: float | None
    unit: str
    limit: str
    """For people, e.g. `|x| < 0.35`; empty without a limit."""
    bounds: tuple[float, ...]
    """Where limit lines stand, e.g. (-0.35, 0.35)."""
    margin: float | None
    """Distance to the limit, positive inside."""
    margin_percent: float | None
    """The same in per cent of the limit."""
    judged: bool
    outcome: Outcome
    source: str
    reason: str | None = None
    """Why an assumed limit was chosen."""
    published: float | None = None
    """The figure that the source prints for this case; shown beside ours, never judged."""
    at: Mapping[str, float] | None = None
    """Where the extreme is: `t` (s), `s` (m) and, where the statistic has one, `window_s` or `window_m`."""
    message: str | None = None
    """Why it could not be judged."""


def outcome_of(criteria: Iterable[CriterionVerdict]) -> Outcome:
    """A spec's outcome: the worst of its criteria; where none of them has a limit, nothing was assessed."""
    criteria = list(criteria)
    worst = Outcome.worst(criterion.outcome for criterion in criteria)
    if worst is Outcome.PASS and not any(criterion.judged for criterion in criteria):
        return Outcome.NOT_ASSESSED
    return worst


@dataclass(frozen=True, slots=True, kw_only=True)
class Fact:
    """Something shown beside the verdicts and never judged, e.g. the irregularity's extremes."""

    name: str
    value: str
    published: str | None = None
    case: str | None = None
    """Label of the case it belongs to; none: the whole spec."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DrawnCurve:
    """One line, or a set of points, of a drawing."""

    name: str
    x: Sequence[float]
    y: Sequence[float]
    role: Literal["line", "limit", "points", "outline"] = "line"
    """An `outline` is closed by itself; a `limit` is dashed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawing:
    """A plot of one quantity against another that is no time: a loop, an outline, a figure over speed."""

    title: str
    x_label: str
    """With the unit: `cant (mm)`."""
    y_label: str
    curves: tuple[DrawnCurve, ...]
    caption: str = ""
    equal_axes: bool = False
    """A metre is as long across as up."""
    y_down: bool = False
    """The vertical axis points down, as z does."""


@dataclass(frozen=True, slots=True, kw_only=True)
class InputFile:
    """A file that went into a check."""

    role: str
    """spec, vehicle, track or profile."""
    path: str
    sha256: str


@dataclass(frozen=True, kw_only=True)
class CaseResult:
    """One simulated case: what was asked and what came back."""

    label: str
    hash: str
    """SHA-256 of the case's JSON with sorted keys."""
    case: Mapping[str, Any]
    """The case as handed to the core."""
    case_json: str
    """The very text whose hash is `hash`."""
    frame: pl.DataFrame
    """Channels as the core recorded them."""
    quantities: pl.DataFrame
    """What the criteria judged: the frame, or what the procedure computed from it. Plot from this one."""
    ended: Mapping[str, Any]
    """How the run ended: `kind` (`end_of_track`, `complete` or `diverged`), `t`, `s`, `message`."""
    statistics: Mapping[str, Any]
    units: Mapping[str, str]
    """Unit by column of `quantities`."""
    meanings: Mapping[str, str]
    wall_s: float

    @property
    def complete(self) -> bool:
        """Whether the run reached its end."""
        return self.ended.get("kind") in ("end_of_track", "complete")


@dataclass(frozen=True, kw_only=True)
class SpecVerdict:
    """One spec: its criteria in all of its cases."""

    id: str
    title: str
    file: str
    procedure: str
    vehicle: str
    condition: str
    outcome: Outcome
    criteria: tuple[CriterionVerdict, ...]
    facts: tuple[Fact, ...] = ()
    cases: tuple[CaseResult, ...] = ()
    inputs: tuple[InputFile, ...] = ()
    overrides: Mapping[str, Any] = field(default_factory=dict)
    """What `[set]` and `--set` changed."""
    drawing: Mapping[str, Any] | None = None
    """Plain data of the vehicle's 3D page, where the procedure draws one."""
    drawings: tuple[Drawing, ...] = ()
    """Plots that the procedure makes of what was judged."""


@dataclass(frozen=True, kw_only=True)
class Acceptance:
    """Everything that one `lmap check` found."""

    specs: tuple[SpecVerdict, ...]
    version: str
    """Of the package."""
    core: str
    """Version and fingerprint of the compiled core."""
    wall_s: float = 0.0

    @property
    def outcome(self) -> Outcome:
        """The worst of the specs."""
        return Outcome.worst(spec.outcome for spec in self.specs)

    @property
    def exit_code(self) -> int:
        """0 all pass, 1 something fails or waits, 2 something could not be judged."""
        return self.outcome.exit_code
