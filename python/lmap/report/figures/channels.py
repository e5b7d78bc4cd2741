"""Figures that show channels as they are: a row for each group, a view for each case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from lmap.report.figures.plot import Curve, Figure, View, samples, shown, time
from lmap.verdict import CaseResult, SpecVerdict

Rows = Mapping[str, Sequence[str]]
"""Channels of each row, by the row's title without the unit."""


def stacked(spec: SpecVerdict, title: str, caption: str, rows: Mapping[str, Rows]) -> list[Figure]:
    """A figure whose views are the cases with rows (`rows` is by hash); none where no case has any."""
    views = [
        _view(case, rows[case.hash])
        for case in spec.cases
        if rows.get(case.hash) and "t" in samples(case).columns
    ]
    return [Figure(title, caption, tuple(views))] if views else []


def _view(case: CaseResult, rows: Rows) -> View:
    titles, curves = [], []
    colours: dict[str, str] = {}
    t = time(case)
    for row, (title, channels) in enumerate(rows.items()):
        unit = ""
        for channel in channels:
            values, unit = shown(case, channel)
            # In a row of several curves the channels differ in their side: a colour and a legend entry each.
            group = channel.split(".")[-2] if len(channels) > 1 else ""
            colour = colours.setdefault(group, str(len(colours) + 1))
            curves.append(Curve(channel, t, values, colour, unit, row=row, width=1.0, group=group or channel))
        titles.append(f"{title} ({unit or '?'})")
    return View(case.label, "whole run", tuple(titles), tuple(curves))
