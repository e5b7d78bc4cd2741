"""Sentences that terminal and page share: the headline, marks and notes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from lmap.report.numbers import number, percent, signed
from lmap.signals import COUNTED
from lmap.verdict import Acceptance, CriterionVerdict, Outcome, SpecVerdict

ASSUMED = "assumed"
"""A criterion's `source` when no public source gives its limit."""

VERDICTS = {
    Outcome.PASS: "PASS",
    Outcome.FAIL: "FAIL",
    Outcome.ERROR: "ERROR",
    Outcome.MANUAL: "MANUAL",
    Outcome.NOT_ASSESSED: "NOT ASSESSED",
}


WHOLE_RUN = frozenset({"mean", "mean_comfort", "median", "percentile", "rms", "vibration_total"})
"""Statistics of a run as a whole: their value has no place in it."""


def placed(criterion: CriterionVerdict) -> bool:
    """Whether the value belongs to a place in the run."""
    return criterion.at is not None and not (criterion.chain and WHOLE_RUN & set(criterion.chain[-1]))


def place(at: Mapping[str, float] | None) -> str:
    """Where a value is: `t = 1.2 s, s = 40 m`, or the row of an analysis: `step 12`."""
    known = {} if at is None else at
    units = {"t": "s", "s": "m"}
    moments = [f"{name} = {number(known[name])} {unit}" for name, unit in units.items() if name in known]
    rows = [f"{name.replace('_', ' ')} {known[name]:.0f}" for name in COUNTED if name in known]
    return ", ".join(moments + rows)


def along(at: Mapping[str, float]) -> float | None:
    """The same on the axis of a plot: time, or the number of a row."""
    return next((at[name] for name in ("t", *COUNTED) if name in at), None)


def verdict(criterion: CriterionVerdict) -> str:
    """Its outcome; `shown` where there is no limit to judge by."""
    if criterion.outcome is Outcome.PASS and not criterion.judged:
        return "shown"
    return VERDICTS[criterion.outcome]


def headline(criteria: Iterable[CriterionVerdict]) -> str:
    """How many criteria passed or not, and which margin is the smallest."""
    judged = [verdict for verdict in criteria if verdict.judged or verdict.outcome is not Outcome.PASS]
    if not judged:
        return "no criterion was judged"
    counts = Counter(criterion.outcome for criterion in judged)
    parts = [f"{counts[Outcome.PASS]} of {len(judged)} pass"]
    for outcome, text in (
        (Outcome.FAIL, "fail"),
        (Outcome.ERROR, "could not be judged"),
        (Outcome.MANUAL, "wait for a person"),
        (Outcome.NOT_ASSESSED, "not assessed"),
    ):
        if counts[outcome]:
            parts.append(f"{counts[outcome]} {text}")
    smallest = least(judged)
    text = ", ".join(parts)
    if smallest is not None:
        margin = f"{signed(smallest.margin, smallest.unit)}, {percent(smallest.margin_percent)}"
        text += f"; smallest margin {margin} ({smallest.name}, {smallest.case})"
    return text


@dataclass(frozen=True, slots=True)
class SummaryLine:
    """One spec in the list of all."""

    id: str
    title: str
    outcome: Outcome
    margin: str
    """Smallest, in per cent of its limit."""
    decisive: str
    """The criterion that the verdict hangs on, with its case."""


def summary(acceptance: Acceptance) -> list[SummaryLine]:
    """A line for each spec, in the order in which they were given."""
    lines = []
    for spec in acceptance.specs:
        worst = [one for one in spec.criteria if one.outcome is spec.outcome]
        smallest = least(one for one in worst if one.judged) or next(iter(worst), None)
        known = smallest is not None and smallest.margin_percent is not None
        lines.append(
            SummaryLine(
                id=spec.id,
                title=spec.title,
                outcome=spec.outcome,
                margin=percent(smallest.margin_percent) if smallest is not None and known else "",
                decisive="" if smallest is None else f"{smallest.name}, {smallest.case}",
            )
        )
    return lines


def least(criteria: Iterable[CriterionVerdict]) -> CriterionVerdict | None:
    """The criterion with the smallest margin, by per cent of its limit."""
    known = [criterion for criterion in criteria if criterion.margin_percent is not None]
    return min(known, key=lambda criterion: criterion.margin_percent or 0.0, default=None)


def all_criteria(acceptance: Acceptance) -> list[CriterionVerdict]:
    """Of all specs."""
    return [criterion for spec in acceptance.specs for criterion in spec.criteria]


def assumptions(spec: SpecVerdict) -> list[tuple[str, str]]:
    """The test, where something in it is assumed, and criteria whose limit is, each once, with the reason."""
    test = [("the test itself", spec.assumed)] if spec.assumed else []
    return test + list(
        dict.fromkeys(
            (criterion.name, criterion.reason or "no reason is given")
            for criterion in spec.criteria
            if criterion.source == ASSUMED
        )
    )


def messages(spec: SpecVerdict) -> list[tuple[str, str]]:
    """What the criteria say for themselves, each thing once, with the criteria and cases it concerns."""
    found: dict[str, list[CriterionVerdict]] = {}
    for criterion in spec.criteria:
        if criterion.message:
            found.setdefault(criterion.message, []).append(criterion)
    return [(_concerned(spec, criteria), message) for message, criteria in found.items()]


def _concerned(spec: SpecVerdict, criteria: list[CriterionVerdict]) -> str:
    names = list(dict.fromkeys(criterion.name for criterion in criteria))
    cases = list(dict.fromkeys(criterion.case for criterion in criteria))
    every = {criterion.name for criterion in spec.criteria}
    what = "every criterion" if len(names) > 1 and every == set(names) else ", ".join(names)
    return f"{what} ({', '.join(cases)})"
