"""The plot in which a criterion is read: signal, filtered signal, limit lines, and where the extreme is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from typing import Any

import numpy as np
import polars as pl

from lmap.criteria import Stage, is_constant, trace
from lmap.errors import JudgementProblem
from lmap.report import words
from lmap.report.figures.envelope import Array
from lmap.report.figures.plot import FAINT_BUCKETS, TIME_AXIS, Curve, Figure, Mark, View, samples, shown, time
from lmap.report.numbers import given, quantity, with_unit
from lmap.signals import counted
from lmap.verdict import CaseResult, CriterionVerdict, Outcome, SpecVerdict

WHOLE = "whole run"
NEAR = "around the extreme"

_NEAR_S = 4.0
"""Stretch about the extreme, s: some periods of anything that a rail vehicle does."""

_DRAWN_BEHIND = 3
"""So many other signals are drawn from the start; the legend shows more."""


def draw(spec: SpecVerdict) -> list[Figure]:
    """A figure for each criterion that reads signals, with a view of each of its cases."""
    cases = {case.hash: case for case in spec.cases}
    figures = []
    order = sorted(spec.criteria, key=lambda verdict: verdict.index)
    for index, group in groupby(order, key=lambda verdict: verdict.index):
        verdicts = sorted(group, key=_severity)
        views = [view for verdict in verdicts for view in _views(verdict, cases.get(verdict.case_hash))]
        if not views:
            continue
        first = verdicts[0]
        figures.append(
            Figure(
                title=first.name,
                caption=f"{chain_text(first)}. Source: {first.source}.",
                views=tuple(views),
                badge=str(Outcome.worst(v.outcome for v in verdicts)) if first.judged else None,
                criterion=index,
            )
        )
    return figures


def chain_text(verdict: CriterionVerdict) -> str:
    """The chain as a line: signal, links with their parameters, limit."""
    parts = [_link_text(link) for link in verdict.chain]
    parts.append(
        f"limit {with_unit(verdict.limit, verdict.unit)}" if verdict.limit else "no limit: shown, not judged"
    )
    return " → ".join(["signal", *parts])


def _link_text(link: Mapping[str, Any]) -> str:
    name, parameters = next(iter(link.items()))
    written = ", ".join(_parameter_text(key, value) for key, value in dict(parameters).items())
    return f"{name} ({written})" if written else str(name)


def _parameter_text(key: str, value: object) -> str:
    if isinstance(value, bool):
        return key if value else f"not {key}"
    return f"{key} {value:g}" if isinstance(value, float) else f"{key} {value}"


def _severity(verdict: CriterionVerdict) -> tuple[int, float]:
    """The case that decides comes first: the page opens with it."""
    margin = verdict.margin if verdict.margin is not None else np.inf
    return -verdict.outcome.severity, float(margin)


def _views(verdict: CriterionVerdict, case: CaseResult | None) -> list[View]:
    if case is None:
        if verdict.message is None:
            return []  # of a case that the procedure made of others: its drawings show it
        return [
            View(verdict.case, WHOLE, (_axis(verdict),), message=verdict.message or "the case has no result")
        ]
    if not verdict.signals:
        return [View(verdict.case, WHOLE, (_axis(verdict),), message=verdict.message or "no signal is read")]
    if verdict.value is not None and all(is_constant(samples(case), name) for name in verdict.signals):
        return []  # a number is no curve
    try:
        return _judged(verdict, case)
    except JudgementProblem as problem:
        return [_unjudged(verdict, case, verdict.message or str(problem))]


def _judged(verdict: CriterionVerdict, case: CaseResult) -> list[View]:
    worst = verdict.signal or verdict.signals[0]
    others = [name for name in verdict.signals if name != worst]
    stages = _stages(verdict, case, worst)
    # The worst signal in front (drawn last), what it is made from in grey behind everything.
    front = _curves(worst, stages, verdict.unit, colour=1)
    if verdict.value is not None and not words.placed(verdict):
        front.append(_level(verdict, stages))
    behind = []
    for position, name in enumerate(others):
        last = _filtered(_stages(verdict, case, name))
        behind.append(
            Curve(
                name=name,
                t=last.t,
                values=last.values,
                role=str(position + 2),
                unit=verdict.unit,
                width=1.0,
                hidden=position >= _DRAWN_BEHIND,
                faint=True,
                buckets=FAINT_BUCKETS,
            )
        )
    limits = _limits(verdict)
    mark = _mark(verdict, stages)
    window = _window(verdict, case) if mark is not None else None
    rows = (_axis(verdict),)
    raw = [curve for curve in front if curve.role == "raw"]
    rest = [curve for curve in front if curve.role != "raw"]
    whole = View(
        verdict.case,
        WHOLE,
        rows,
        (*raw, *behind, *rest),
        limits,
        mark,
        window,
        verdict.message,
        _caption(verdict),
        along=_along(case),
    )
    if mark is None or whole.along != TIME_AXIS:
        return [whole]
    reach = max(_NEAR_S, 1.5 * (window[1] - window[0]) if window else 0.0) / 2.0
    near = tuple(_cut(curve, mark.t - reach, mark.t + reach) for curve in (*raw, *rest))
    return [whole, replace(whole, stretch=NEAR, curves=near)]


def _along(case: CaseResult) -> str:
    """Title of the horizontal axis: rows of an analysis are no moments."""
    rows = counted(samples(case).columns)
    return TIME_AXIS if rows is None else {"step": "load step"}.get(rows, rows.replace("_", " "))


def _stages(verdict: CriterionVerdict, case: CaseResult, signal: str) -> list[Stage]:
    return trace(
        samples(case),
        verdict.chain,
        signal,
        given=case.units.get(signal, "unknown"),
        wanted=verdict.unit,
    )


def _curves(signal: str, stages: Sequence[Stage], unit: str, colour: int) -> list[Curve]:
    """The signal as recorded (grey and thin, where a filter follows), as filtered, the statistic's curve."""
    filtered = _filtered(stages)
    curves = []
    if filtered is not stages[0]:
        curves.append(
            Curve(
                f"{signal}, unfiltered", stages[0].t, stages[0].values, "raw", unit, width=0.7, dash="solid"
            )
        )
    label = f"{signal}, {filtered.name}" if filtered is not stages[0] else signal
    curves.append(Curve(label, filtered.t, filtered.values, str(colour), unit, width=1.5))
    last = stages[-1]
    if last is not filtered:
        curves.append(Curve(last.name.replace("_", " "), last.t, last.values, "statistic", unit, width=1.3))
    return curves


def _level(verdict: CriterionVerdict, stages: Sequence[Stage]) -> Curve:
    """The value of a statistic of the whole run: a line along it."""
    ends = stages[0].t[[0, -1]]
    name = str(next(iter(verdict.chain[-1])))
    values = np.full(2, verdict.value, dtype=np.float64)
    return Curve(
        f"{name} {quantity(verdict.value, verdict.unit)}", ends, values, "statistic", verdict.unit, width=1.3
    )


def _filtered(stages: Sequence[Stage]) -> Stage:
    """The last stage that is still the signal: as long as the first, or made by a filter."""
    if len(stages) > 1 and stages[-1].name in _STATISTICS:
        return stages[-2]
    return stages[-1]


def _statistics() -> frozenset[str]:
    from lmap.signals import BY_NAME, Statistic

    return frozenset(name for name, kind in BY_NAME.items() if issubclass(kind, Statistic))


_STATISTICS = _statistics()


def _unjudged(verdict: CriterionVerdict, case: CaseResult, message: str) -> View:
    """The signals as recorded, in the channel's own unit, where there are any."""
    frame = samples(case)
    curves = []
    unit = ""
    for position, name in enumerate(verdict.signals):
        if name in frame.columns and "t" in frame.columns and frame.height:
            values, unit = shown(case, name)
            curves.append(
                Curve(
                    name,
                    time(case),
                    values,
                    str(position + 1),
                    unit,
                    width=1.0,
                    hidden=position > _DRAWN_BEHIND,
                    buckets=FAINT_BUCKETS,
                )
            )
    return View(verdict.case, WHOLE, (_quantity(verdict, unit),), tuple(curves), message=message)


def _axis(verdict: CriterionVerdict) -> str:
    return _quantity(verdict, verdict.unit)


def _quantity(verdict: CriterionVerdict, unit: str) -> str:
    """The last part of the signals' names, where it is the same, with the unit."""
    leaves = {name.rsplit(".", 1)[-1] for name in verdict.signals}
    return f"{leaves.pop() if len(leaves) == 1 else 'value'} ({unit or '?'})"


def _limits(verdict: CriterionVerdict) -> tuple[tuple[float, str], ...]:
    return tuple((bound, f"limit {given(bound, verdict.unit)}") for bound in verdict.bounds)


def _mark(verdict: CriterionVerdict, stages: Sequence[Stage]) -> Mark | None:
    if verdict.at is None or verdict.value is None or not words.placed(verdict):
        return None
    t, value = words.along(verdict.at), verdict.value
    if t is None:
        return None
    return Mark(t, _side(stages, t, value), (quantity(value, verdict.unit), words.place(verdict.at)))


def _side(stages: Sequence[Stage], t: float, value: float) -> float:
    """A statistic of |x| whose extreme is a sample below zero is marked below zero, on the curve."""
    filtered = _filtered(stages)
    if value > 0.0 and filtered is stages[-1] and len(filtered.t):
        sample = float(filtered.values[int(np.abs(filtered.t - t).argmin())])
        if np.isclose(sample, -value, rtol=1e-9):
            return sample
    return value


def _window(verdict: CriterionVerdict, case: CaseResult) -> tuple[float, float] | None:
    """From when to when the window of the extreme lies; a window of distance is looked up in the frame."""
    at = verdict.at
    if at is None:
        return None
    if "window_s" in at and "t" in at:
        half = at["window_s"] / 2.0
        return at["t"] - half, at["t"] + half
    if "window_m" in at and "s" in at:
        half = at["window_m"] / 2.0
        inside = samples(case).filter(pl.col("s").is_between(at["s"] - half, at["s"] + half)).get_column("t")
        if len(inside):
            return float(inside[0]), float(inside[-1])
    return None


def _cut(curve: Curve, begin: float, end: float) -> Curve:
    inside = (curve.t >= begin) & (curve.t <= end)
    kept: Array = curve.t[inside]
    return Curve(curve.name, kept, curve.values[inside], curve.role, curve.unit, width=curve.width)


def _caption(verdict: CriterionVerdict) -> str:
    """What the reader sees in this view."""
    if verdict.value is None:
        return verdict.message or ""
    text = f"{quantity(verdict.value, verdict.unit)} on {verdict.signal}"
    if verdict.published is not None:
        text += f"; published: {given(verdict.published, verdict.unit)}"
    return text
