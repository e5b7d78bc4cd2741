"""What a check found: outcomes with margins, and the results they were read from.

A criterion is judged in each case on the worst of its signals; a spec's verdict is its worst criterion, an
acceptance's the worst of its specs. Nothing here computes: these are the plain results that terminal, report
and JSON read.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Literal, Protocol

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
    role: Literal["line", "limit", "points", "mark", "outline", "reference"] = "line"
    """An `outline` is closed by itself; a `limit` is dashed; a `reference` stands behind, grey; a `mark` is a point
    that is seen among others."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawing:
    """A plot of one quantity against another: a loop, an outline, a figure over speed, cases over time."""

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
    """spec, vehicle, track, outline, profile, measured track or control law."""
    path: str
    sha256: str


class Frames(Protocol):
    """Where the frames of a spec's cases are; reading them may take long and much memory."""

    def frame(self, label: str) -> pl.DataFrame:
        """Channels as the core recorded them."""

    def quantities(self, label: str) -> pl.DataFrame:
        """What the criteria judged."""

    def held(self) -> Mapping[str, Frames]:
        """All of them by label, each read once or, where they are judged as they are, one at a time."""


@dataclass(frozen=True, slots=True)
class Held:
    """Frames of one case, in memory."""

    recorded: pl.DataFrame
    judged: pl.DataFrame

    def frame(self, label: str) -> pl.DataFrame:
        """Channels as the core recorded them."""
        return self.recorded

    def quantities(self, label: str) -> pl.DataFrame:
        """What the criteria judged."""
        return self.judged

    def held(self) -> Mapping[str, Frames]:
        """Nothing to read."""
        return {}


@dataclass(frozen=True, slots=True)
class Extent:
    """How much a run recorded."""

    rows: int
    simulated: float | None
    """s, from the first to the last row; none without a column `t`."""
    distance: float | None
    """m; none where nothing runs in time: a vehicle that is pushed gives way along the track too."""

    @staticmethod
    def of(frame: pl.DataFrame) -> Extent:
        """Read off a frame."""
        simulated = _span(frame, "t")
        return Extent(frame.height, simulated, None if simulated is None else _span(frame, "s"))


NO_EXTENT = Extent(0, None, None)


def _span(frame: pl.DataFrame, name: str) -> float | None:
    """From the first to the last value of a column; none where there is none."""
    if name not in frame.columns or frame.height == 0:
        return None
    first, last = frame.get_column(name)[0], frame.get_column(name)[-1]
    return None if first is None or last is None else float(last) - float(first)


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
    frames: Frames
    """Where its frames are: in memory, or on disk until somebody asks."""
    ended: Mapping[str, Any]
    """How the run ended: `kind` (`end_of_track`, `complete`, `diverged` or `refused`), `t`, `s`, `message`."""
    statistics: Mapping[str, Any]
    units: Mapping[str, str]
    """Unit by column of `quantities`."""
    meanings: Mapping[str, str]
    wall_s: float
    known_extent: Extent | None = None
    """Of the frame, where it is known without reading it."""

    @property
    def frame(self) -> pl.DataFrame:
        """Channels as the core recorded them."""
        return self.frames.frame(self.label)

    @property
    def quantities(self) -> pl.DataFrame:
        """What the criteria judged: the frame, or what the procedure computed from it. Plot from this one."""
        return self.frames.quantities(self.label)

    @property
    def extent(self) -> Extent:
        """How much the run recorded."""
        return Extent.of(self.frame) if self.known_extent is None else self.known_extent

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
    assumed: str = ""
    """What of the test itself, beside its limits, is assumed, and why."""
    drawing: Mapping[str, Any] | None = None
    """Plain data of the vehicle's 3D page, where the procedure draws one."""
    drawings: tuple[Drawing, ...] = ()
    """Plots that the procedure makes of what was judged."""

    def held(self) -> SpecVerdict:
        """The same with the frames of its cases in memory, each read once: for as long as they are plotted."""
        read: dict[int, Mapping[str, Frames]] = {}
        cases = []
        for case in self.cases:
            if isinstance(case.frames, Held):
                cases.append(case)
                continue
            if id(case.frames) not in read:
                read[id(case.frames)] = case.frames.held()
            cases.append(replace(case, frames=read[id(case.frames)].get(case.label, case.frames)))
        return replace(self, cases=tuple(cases))


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
