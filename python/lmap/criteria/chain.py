"""Criteria as specs write them: signals, a chain of filters with a statistic at its end, a limit.

    [[criterion]]
    name = "lateral acceleration at the bogie centres"
    signal = ["carbody.lead_pivot.ay", "carbody.trail_pivot.ay"]
    chain = [{ lowpass = { cutoff_hz = 10.0 } }, { average_peak = { window_s = 5.0 } }]
    unit = "g"
    max_abs = 0.35
    strict = true
    source = "AS 7509.1"

A signal may be a pattern: `ws*.left.LV` stands for that channel of every wheelset.
"""

from __future__ import annotations

import fnmatch
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any, NamedTuple, Self

import numpy as np
import numpy.typing as npt
import polars as pl
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    FiniteFloat,
    ValidationError,
    model_validator,
)

from lmap import signals
from lmap.criteria import units
from lmap.errors import (
    JudgementProblem,
    KeyPath,
    Problem,
    listed,
    nearest_hint,
    problems_of_validation,
)
from lmap.signals import Filter, Joint, Link, Reading, Statistic, signal_of
from lmap.verdict import CriterionVerdict, Outcome

ASSUMED = "assumed"
"""A `source` that says: no public source gives this limit, `reason` says why it was chosen."""


def _listed_names(value: Any) -> Any:
    """One name is a list of one."""
    return [value] if isinstance(value, str) else value


def _by_label(value: Any) -> Any:
    """One figure is the figure of every case."""
    return {"": value} if isinstance(value, int | float) and not isinstance(value, bool) else value


class Criterion(BaseModel):
    """One `[[criterion]]` table."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    name: str = Field(min_length=1)
    """What tables and pages call it; no two of a spec alike."""
    signal: Annotated[list[str], BeforeValidator(_listed_names)] = Field(min_length=1)
    """A channel, a pattern of channels (`ws*.left.LV`), or a list of these; the worst of them is judged."""
    chain: list[dict[str, dict[str, Any]]] = Field(min_length=1)
    """Filters, then one statistic, as `{ lowpass = { cutoff_hz = 10.0 } }`."""
    case: Annotated[list[str] | None, BeforeValidator(_listed_names)] = Field(default=None, min_length=1)
    """Labels, or patterns of them, of the cases that it is judged in, all without it; `!` before one leaves out."""
    needs: str | None = None
    """Dotted key of the vehicle's file without which there are no data to judge: then it is not assessed."""
    unit: str
    """Of the value and its limit; `1` for a ratio."""
    max_abs: FiniteFloat | None = Field(default=None, ge=0.0)
    """Largest size allowed; without any limit the value is shown, not judged."""
    max: FiniteFloat | None = None
    """Largest value allowed."""
    min: FiniteFloat | None = None
    """Least value allowed."""
    strict: bool = False
    """Whether reaching the limit fails."""
    source: str = Field(min_length=1)
    """Where the limit is from; `assumed` where no public source gives it."""
    reason: str | None = None
    """Why an assumed limit is what it is."""
    published: Annotated[dict[str, FiniteFloat], BeforeValidator(_by_label)] = Field(default_factory=dict)
    """Printed by the source: one figure for all cases (key ""), or one by case label."""

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.max_abs is not None and (self.max is not None or self.min is not None):
            raise ValueError("max_abs alone, or max and min")
        if self.max is not None and self.min is not None and self.min >= self.max:
            raise ValueError("a min below max")
        if self.source == ASSUMED and not self.reason:
            raise ValueError('a reason where the source is "assumed"')
        return self

    def applies_to(self, label: str) -> bool:
        """Whether it is judged in the case of this label."""
        named = self.case or []
        wanted = [pattern for pattern in named if not pattern.startswith("!")]
        unwanted = [pattern[1:] for pattern in named if pattern.startswith("!")]

        def any_of(patterns: list[str]) -> bool:
            return any(fnmatch.fnmatchcase(label, pattern) for pattern in patterns)

        return (not wanted or any_of(wanted)) and not any_of(unwanted)

    @property
    def bounds(self) -> tuple[float, ...]:
        """Where limit lines stand; empty without a limit."""
        if self.max_abs is not None:
            return (-self.max_abs, self.max_abs)
        return tuple(bound for bound in (self.min, self.max) if bound is not None)

    @property
    def limit_text(self) -> str:
        """The limit for people, e.g. `|x| < 0.35`."""
        less, more = ("<", ">") if self.strict else ("<=", ">=")
        if self.max_abs is not None:
            return f"|x| {less} {self.max_abs:g}"
        parts = [f"{less} {self.max:g}"] if self.max is not None else []
        if self.min is not None:
            parts.insert(0, f"{more} {self.min:g}")
        return " and ".join(parts)

    def margin(self, value: float) -> tuple[float, float | None] | None:
        """Distance to the nearest limit, positive inside, and in per cent of it; nothing without a limit."""
        candidates: list[tuple[float, float]] = []
        if self.max_abs is not None:
            candidates.append((self.max_abs - abs(value), self.max_abs))
        if self.max is not None:
            candidates.append((self.max - value, self.max))
        if self.min is not None:
            candidates.append((value - self.min, self.min))
        if not candidates:
            return None
        margin, limit = min(candidates, key=lambda candidate: candidate[0])
        return margin, (100.0 * margin / abs(limit) if limit != 0.0 else None)

    def passes(self, value: float) -> bool:
        """Whether a value keeps the limit; NaN never does, without a limit every number does."""
        if math.isnan(value):
            return False
        margin = self.margin(value)
        if margin is None:
            return True
        return margin[0] > 0.0 if self.strict else margin[0] >= 0.0

    def published_for(self, label: str) -> float | None:
        """The printed figure for a case."""
        return self.published.get(label, self.published.get(""))

    def links(self) -> list[Link]:
        """The chain's links; those with faults (see `chain_problems`) are left out."""
        return [link for link, _ in (_link(table) for table in self.chain) if link is not None]

    @property
    def signal_unit(self) -> str:
        """The unit that its signals are read in."""
        return _units(self.chain, self.unit)[0]

    def written(self) -> dict[str, Any]:
        """The criterion as plain data for TOML, defaults left out."""
        data = self.model_dump(exclude_defaults=True, exclude_none=True)
        data["chain"] = [link.written() for link in self.links()]
        return data


def _link(table: Mapping[str, Any]) -> tuple[Link | None, list[Problem]]:
    """A link from its table `{lowpass = {cutoff_hz = 10.0}}`, or what is wrong with it."""
    if len(table) != 1:
        found = f"a table with {listed(table)}" if table else "an empty table"
        return None, [Problem(found=found, allowed="one link, e.g. { max_abs = {} }")]
    [(name, parameters)] = table.items()
    kind = signals.BY_NAME.get(name)
    if kind is None:
        hint = nearest_hint(name, signals.BY_NAME)
        return None, [Problem(found=f'"{name}"', allowed=listed(signals.BY_NAME, 30), hint=hint)]
    try:
        return kind.model_validate(parameters), []
    except ValidationError as error:
        known: dict[KeyPath, list[str]] = {(): list(kind.model_fields)}
        found_ = problems_of_validation(error.errors(include_url=False), known)
        return None, [problem.at(prefix=(name,)) for problem in found_]


def _units(chain: Sequence[Mapping[str, Any]], unit: str) -> tuple[str, str]:
    """Units that the chain's statistic takes its signal in and gives its number in; by default the criterion's."""
    name = next(iter(chain[-1]), "")
    kind = signals.BY_NAME.get(name)
    if kind is None or not issubclass(kind, Statistic):
        return unit, unit
    return kind.reads or unit, kind.gives or unit


def chain_problems(criterion: Criterion) -> list[Problem]:
    """What is wrong with a criterion's chain and unit; keys start at the criterion."""
    problems: list[Problem] = []
    links: list[Link] = []
    for position, table in enumerate(criterion.chain):
        link, faults = _link(table)
        problems += [fault.at(prefix=("chain", position)) for fault in faults]
        if link is not None:
            links.append(link)
            last = position == len(criterion.chain) - 1
            if last and not isinstance(link, Statistic):
                statistics = [name for name, kind in signals.BY_NAME.items() if issubclass(kind, Statistic)]
                allowed = f"a statistic at the end: {listed(statistics, 30)}"
                problems.append(
                    Problem(found=f"the filter {link.name}", allowed=allowed, key=("chain", position))
                )
            if not last and not isinstance(link, Filter):
                allowed = "filters, with one statistic at the end"
                problems.append(
                    Problem(found=f"the statistic {link.name}", allowed=allowed, key=("chain", position))
                )
            if last and isinstance(link, Statistic):
                problems += _limit_problems(criterion, link)
    if criterion.unit not in units.UNITS:
        hint = nearest_hint(criterion.unit, units.UNITS)
        problems.append(
            Problem(found=f'"{criterion.unit}"', allowed=listed(units.UNITS, 40), key=("unit",), hint=hint)
        )
    elif units.factor(given := _units(criterion.chain, criterion.unit)[1], criterion.unit) is None:
        allowed = f"a unit of what the chain gives: {listed(units.comparable(given))}"
        problems.append(Problem(found=f'"{criterion.unit}"', allowed=allowed, key=("unit",)))
    return problems


def _limit_problems(criterion: Criterion, statistic: Statistic) -> list[Problem]:
    """Limits that a statistic's number can keep whatever the signal does on its other side."""
    problems = []
    if criterion.max_abs is not None and statistic.one_sided and not statistic.is_magnitude:
        allowed = "max or min, absolute = true, or max_abs = {} as statistic"
        found = f"max_abs with the one-sided statistic {statistic.name}"
        problems.append(Problem(found=found, allowed=allowed, key=("max_abs",)))
    if criterion.min is not None and statistic.largest:
        found = f"min with {statistic.name}, which gives the largest"
        problems.append(Problem(found=found, allowed="max, or minimum = {} as statistic", key=("min",)))
    return problems


def expand(patterns: Sequence[str], channels: Iterable[str]) -> list[str]:
    """Channels that the patterns stand for, in the channels' order within each pattern, none twice."""
    known = list(channels)
    found: dict[str, None] = {}
    for pattern in patterns:
        if any(mark in pattern for mark in "*?["):
            found.update(dict.fromkeys(name for name in known if fnmatch.fnmatchcase(name, pattern)))
        elif pattern in known:
            found[pattern] = None
    return list(found)


def signal_problems(criterion: Criterion, channels: Mapping[str, str]) -> list[Problem]:
    """Signals that no channel has and units that do not compare; keys start at the criterion.

    `channels` gives the unit by name.
    """
    problems: list[Problem] = []
    wanted = criterion.signal_unit
    last = next(iter(criterion.links()[-1:]), None)
    count = len(expand(criterion.signal, channels))
    if isinstance(last, Joint) and 0 < count != last.count:
        allowed = f"{last.count} signals for {last.name}: x, y and z"
        problems.append(Problem(found=f"{count} signals", allowed=allowed, key=("signal",)))
    for position, pattern in enumerate(criterion.signal):
        key: KeyPath = ("signal",) if len(criterion.signal) == 1 else ("signal", position)
        names = expand([pattern], channels)
        if not names:
            allowed = "a channel of the vehicle (`lmap channels VEHICLE` lists them)"
            hint = nearest_hint(pattern, channels)
            problems.append(Problem(found=f'"{pattern}"', allowed=allowed, key=key, hint=hint))
        wrong = [name for name in names if units.factor(channels[name], wanted) is None]
        if wrong and wanted != criterion.unit:
            problems.append(
                Problem(found=f"{wrong[0]} in {channels[wrong[0]]}", allowed=f"a signal in {wanted}", key=key)
            )
        elif wrong and criterion.unit in units.UNITS and not any(one.key == ("unit",) for one in problems):
            allowed = f"a unit of {wrong[0]}: {listed(units.comparable(channels[wrong[0]]))}"
            problems.append(Problem(found=f'"{criterion.unit}"', allowed=allowed, key=("unit",)))
    return problems


class Stage(NamedTuple):
    """A signal on its way through a chain."""

    name: str
    """`signal`, then the name of the link that made it."""
    t: npt.NDArray[np.float64]
    values: npt.NDArray[np.float64]


def trace(
    frame: pl.DataFrame,
    chain: Sequence[Mapping[str, Any]],
    signal: str,
    *,
    given: str = "1",
    wanted: str = "1",
) -> list[Stage]:
    """The signal, what each filter makes of it and, where there is one, the statistic's curve; for plots.

    Values are converted from the unit `given` (of the channel) to `wanted` (of the criterion). Raises what
    judging would raise, a `JudgementProblem`.
    """
    read_in, given_in = _units(chain, wanted)
    stages, reading = _run(frame, chain, signal, _factor(signal, given, read_in))
    if given_in != wanted or read_in != wanted:
        # the number is another quantity than the signal: its own curve stands alone
        stages = []
    if reading.curve is not None:
        curve, factor = reading.curve, _factor(_statistic(chain), given_in, wanted)
        stages.append(Stage(_statistic(chain), curve["t"].to_numpy(), curve["x"].to_numpy() * factor))
    return stages


def _statistic(chain: Sequence[Mapping[str, Any]]) -> str:
    return str(next(iter(chain[-1])))


def _factor(signal: str, given: str, wanted: str) -> float:
    factor = units.factor(given, wanted)
    if factor is None:
        raise JudgementProblem(f"{signal} is in {given}, which is no {wanted}")
    return factor


def _filtered(
    frame: pl.DataFrame, chain: Sequence[Mapping[str, Any]], name: str, factor: float
) -> tuple[list[Stage], pl.DataFrame, Statistic]:
    """The signal on its way through the filters, what comes out, and the statistic that reads it."""
    signal = signal_of(frame, name, factor)
    stages = [Stage("signal", signal["t"].to_numpy(), signal["x"].to_numpy())]
    for table in chain:
        link, problems = _link(table)
        if isinstance(link, Filter):
            signal = link.apply(signal)
            stages.append(Stage(link.name, signal["t"].to_numpy(), signal["x"].to_numpy()))
        elif isinstance(link, Statistic):
            return stages, signal, link
        else:
            raise JudgementProblem("; ".join(str(problem) for problem in problems))
    raise JudgementProblem("the chain has no statistic at its end")


def _run(
    frame: pl.DataFrame, chain: Sequence[Mapping[str, Any]], name: str, factor: float
) -> tuple[list[Stage], Reading]:
    stages, signal, statistic = _filtered(frame, chain, name, factor)
    return stages, _finite(statistic.read(signal), statistic, name)


def _finite(reading: Reading, statistic: Statistic, name: str) -> Reading:
    if not math.isfinite(reading.value):
        raise JudgementProblem(f"{statistic.name} of {name} is {reading.value}")
    return reading


def _readings(
    criterion: Criterion, frame: pl.DataFrame, names: Sequence[str], channel_units: Mapping[str, str]
) -> list[tuple[str, Reading]]:
    """What the chain reads on each signal; of a joint statistic one reading, under the first signal's name."""
    read_in, given_in = _units(criterion.chain, criterion.unit)
    factors = [_factor(name, channel_units.get(name, "unknown"), read_in) for name in names]
    last = next(iter(criterion.links()[-1:]), None)
    if isinstance(last, Joint):
        if len(names) != last.count:
            raise JudgementProblem(f"{last.name} joins {last.count} signals, here are {len(names)}")
        parts = [_filtered(frame, criterion.chain, *one)[1] for one in zip(names, factors, strict=True)]
        found = [(names[0], _finite(last.read_together(parts), last, listed(names)))]
    else:
        found = [
            (name, _run(frame, criterion.chain, name, factor)[1])
            for name, factor in zip(names, factors, strict=True)
        ]
    factor = _factor(_statistic(criterion.chain), given_in, criterion.unit)
    return [(name, replace(reading, value=reading.value * factor)) for name, reading in found]


def not_assessed(
    criterion: Criterion, *, index: int = 0, label: str = "", case_hash: str = ""
) -> CriterionVerdict:
    """The criterion in one case of a vehicle that declares no data for it."""
    message = f"the vehicle declares no {criterion.needs}"
    return _verdict(criterion, index, label, case_hash, (), Outcome.NOT_ASSESSED, message=message)


def judge(
    criterion: Criterion,
    frame: pl.DataFrame,
    channel_units: Mapping[str, str],
    *,
    index: int = 0,
    label: str = "",
    case_hash: str = "",
    ended: str | None = None,
) -> CriterionVerdict:
    """The criterion in one case, on the worst of its signals.

    `ended` says why a run ended before it should have: then nothing can be judged. A missing signal, a NaN,
    an empty window or a unit that does not compare is an error, never a pass.
    """
    names = expand(criterion.signal, frame.columns)
    missing = [pattern for pattern in criterion.signal if not expand([pattern], frame.columns)]
    readings: list[tuple[str, Reading]] = []
    message = ended
    if message is None and missing:
        message = f"the frame has no channel {listed(missing)}"
    if message is None and not names:
        message = "the criterion names no signal"
    if message is None:
        try:
            readings = _readings(criterion, frame, names, channel_units)
        except JudgementProblem as problem:
            message = str(problem)
    if message is not None:
        return _verdict(criterion, index, label, case_hash, tuple(names), Outcome.ERROR, message=message)
    name, reading = min(readings, key=lambda entry: _goodness(criterion, entry[1].value))
    outcome = Outcome.PASS if criterion.passes(reading.value) else Outcome.FAIL
    verdict = _verdict(criterion, index, label, case_hash, tuple(names), outcome, name, reading)
    if is_constant(frame, name):
        return replace(verdict, at=None)  # a number without a course is nowhere
    rows = signals.counted(frame.columns)
    # rows of an analysis are no moments: the number of the row says where
    return verdict if rows is None else replace(verdict, at={rows: reading.t})


def is_constant(frame: pl.DataFrame, name: str) -> bool:
    """Whether a channel is one number from end to end: a result of the run as a whole."""
    values = frame.get_column(name).to_numpy()
    return bool((values == values[0]).all())


def _goodness(criterion: Criterion, value: float) -> float:
    """Smallest is worst: the margin, or without a limit the size."""
    margin = criterion.margin(value)
    return -abs(value) if margin is None else margin[0]


def _verdict(
    criterion: Criterion,
    index: int,
    label: str,
    case_hash: str,
    names: tuple[str, ...],
    outcome: Outcome,
    signal: str | None = None,
    reading: Reading | None = None,
    message: str | None = None,
) -> CriterionVerdict:
    margin = criterion.margin(reading.value) if reading is not None else None
    return CriterionVerdict(
        index=index,
        name=criterion.name,
        case=label,
        case_hash=case_hash,
        signals=names,
        signal=signal,
        chain=tuple(criterion.chain),
        value=None if reading is None else reading.value,
        unit=criterion.unit,
        limit=criterion.limit_text,
        bounds=criterion.bounds,
        margin=None if margin is None else margin[0],
        margin_percent=None if margin is None else margin[1],
        judged=bool(criterion.bounds),
        outcome=outcome,
        source=criterion.source,
        reason=criterion.reason,
        published=criterion.published_for(label),
        at=None if reading is None else reading.at(),
        message=message,
    )
