"""What a figure is, and its form for plotly.js.

A figure has views (one for each case, and for each stretch of the run); the page draws one of them at a time.
Colours are roles here (`raw`, `1`, `limit`): the page gives them their value, light, dark or on paper.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import polars as pl

from lmap.criteria import units
from lmap.report.figures.envelope import Array, envelope
from lmap.report.sheet import escape, packed
from lmap.verdict import CaseResult

TIME_AXIS = "time t (s)"
"""What figures have below, but for those of an analysis; hovering tells the value."""

BUCKETS = 1200
"""Stretches of a curve in a whole run: more than a screen has columns for it."""

FAINT_BUCKETS = 500
"""The same for the curves that stand behind."""

COARSE = 1.0 / 3.0
"""Share of these on a page of many tests: 55 MB, not 110, and still two points for each three columns of a screen."""

_SHOWN_IN = {"m": "mm", "N": "kN", "m/s": "km/h", "rad": "mrad"}


@dataclass(frozen=True, slots=True)
class Curve:
    """One line of a plot."""

    name: str
    t: Array
    values: Array
    role: str
    """`raw`, `statistic`, `limit` or the number of a signal's colour, from 1."""
    unit: str = ""
    row: int = 0
    width: float = 1.4
    dash: str = "solid"
    group: str = ""
    """Curves of one group have one entry in the legend."""
    hidden: bool = False
    """Not drawn until the legend asks for it."""
    faint: bool = False
    buckets: int = BUCKETS


@dataclass(frozen=True, slots=True)
class Mark:
    """The place of an extreme, with its value."""

    t: float
    value: float
    text: tuple[str, ...]
    """Lines of the label."""


@dataclass(frozen=True, slots=True)
class View:
    """One drawing: a case, a stretch of its run."""

    case: str
    stretch: str
    rows: tuple[str, ...]
    """Title of each row's vertical axis, with the unit."""
    curves: tuple[Curve, ...] = ()
    limits: tuple[tuple[float, str], ...] = ()
    """Value and label."""
    mark: Mark | None = None
    window: tuple[float, float] | None = None
    """Shaded: the window that the extreme is the value of, s."""
    message: str | None = None
    """Why there is nothing, or not everything, to see."""
    caption: str = ""
    along: str = TIME_AXIS
    """Title of the horizontal axis."""
    raw: Mapping[str, Any] | None = None
    """`data` and `layout` as they are, where the plot is not over time."""


@dataclass(frozen=True, slots=True)
class Figure:
    """A plot with its views."""

    title: str
    caption: str
    views: tuple[View, ...]
    badge: str | None = None
    """A verdict to stand beside the title."""
    criterion: int | None = None
    """Index of the criterion that is read in it."""
    notes: tuple[str, ...] = field(default=())


def samples(case: CaseResult) -> pl.DataFrame:
    """What is plotted: the quantities that were judged, else what the core recorded."""
    return case.quantities if case.quantities.width else case.frame


def shown(case: CaseResult, channel: str) -> tuple[Array, str]:
    """A channel in the unit in which engineers read it."""
    given = case.units.get(channel, "")
    wanted = _SHOWN_IN.get(given, given)
    factor = units.factor(given, wanted) or 1.0
    values = samples(case).get_column(channel).cast(pl.Float64).to_numpy()
    return values * factor, wanted


def time(case: CaseResult) -> Array:
    """The samples' times, s."""
    return samples(case).get_column("t").cast(pl.Float64).to_numpy()


def wheelsets(case: CaseResult) -> list[str]:
    """Names of bodies that have a left and a right wheel, in the frame's order."""
    names = dict.fromkeys(
        name.split(".")[0] for name in samples(case).columns if name.endswith((".left.Q", ".left.LV"))
    )
    return list(names)


def plotly(view: View, detail: float = 1.0) -> dict[str, Any]:
    """`data` and `layout` for plotly.js, with roles for colours; a curve gets the share `detail` of its points."""
    if view.raw is not None:
        return dict(view.raw)
    axes = _axes(len(view.rows))
    data = [_trace(curve, view.along, detail) for curve in view.curves]
    span = _span(view.curves)
    for value, label in view.limits:
        data.append(_limit(span, value, label))
    layout: dict[str, Any] = {"shapes": [], "annotations": [], "rows": len(view.rows)}
    for row, (title, domain) in enumerate(zip(view.rows, axes, strict=True)):
        axis: dict[str, Any] = {"title": {"text": escape(title)}, "domain": domain}
        if row > 0:
            axis["matches"] = "y"
        limits = _range(view) if row == 0 else None
        if limits is not None:
            axis["range"] = limits
        layout[_axis("yaxis", row)] = axis
    layout["xaxis"] = {"title": {"text": view.along}, "anchor": _axis("y", len(view.rows) - 1), "range": span}
    if view.window is not None:
        layout["shapes"].append(
            {
                "type": "rect",
                "xref": "x",
                "yref": "y domain",
                "x0": view.window[0],
                "x1": view.window[1],
                "y0": 0,
                "y1": 1,
                "role": "window",
                "layer": "below",
            }
        )
    for value, label in view.limits:
        layout["annotations"].append(_limit_label(value, label))
    if view.mark is not None and span is not None:
        data.append(_mark(view.mark))
        layout["annotations"].append(_mark_label(view, view.mark, span))
    return {"data": data, "layout": layout}


def _trace(curve: Curve, along: str, detail: float) -> dict[str, Any]:
    t, values = envelope(curve.t, curve.values, round(detail * curve.buckets))
    name, unit = escape(curve.name), escape(curve.unit)
    where = "%{x:.3f} s" if along == TIME_AXIS else f"{along} %{{x:.4g}}"
    trace: dict[str, Any] = {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": packed(t),
        "y": packed(values),
        "yaxis": _axis("y", curve.row),
        "line": {"width": curve.width, "dash": curve.dash},
        "hovertemplate": f"%{{y:.4g}} {unit} at {where}<extra>{name}</extra>",
        "meta": {"role": curve.role, "group": curve.group or curve.name},
        "visible": not curve.hidden,
    }
    if curve.faint:
        trace["opacity"] = 0.55
    return trace


def _limit(span: list[float] | None, value: float, label: str) -> dict[str, Any]:
    return {
        "type": "scatter",
        "mode": "lines",
        "name": escape(label),
        "x": span or [0.0, 1.0],
        "y": [value, value],
        "line": {"width": 1.6, "dash": "dash"},
        "hovertemplate": f"{escape(label)}<extra></extra>",
        "meta": {"role": "limit", "group": "limit"},
    }


def _limit_label(value: float, label: str) -> dict[str, Any]:
    return {
        "xref": "paper",
        "x": 0.0,
        "xanchor": "left",
        "y": value,
        "yanchor": "bottom" if value >= 0.0 else "top",
        "yshift": 2 if value >= 0.0 else -2,
        "text": escape(label),
        "showarrow": False,
        "role": "limit",
    }


def _mark(mark: Mark) -> dict[str, Any]:
    return {
        "type": "scatter",
        "mode": "markers",
        "name": "extreme",
        "x": [mark.t],
        "y": [mark.value],
        "marker": {"size": 9, "symbol": "circle-open", "line": {"width": 2.2}},
        "hovertemplate": "<br>".join(map(escape, mark.text)) + "<extra></extra>",
        "meta": {"role": "extreme", "group": "extreme"},
    }


_PLOT = (960.0, 288.0)
"""Pixels of a plot as it mostly is: a label is placed before the page knows."""
_LETTER, _LINE = 6.6, 16.0
"""Pixels that a letter and a line of a label take."""


def _mark_label(view: View, mark: Mark, span: list[float]) -> dict[str, Any]:
    """Beside the mark, where it covers least of the curves and lies within the plot; near rather than far."""
    low, high = _range(view) or (mark.value - 1.0, mark.value + 1.0)
    scale = _PLOT[0] / ((span[1] - span[0]) or 1.0), _PLOT[1] / ((high - low) or 1.0)
    size = _LETTER * max(map(len, mark.text)), _LINE * len(mark.text) + 6.0
    at = (mark.t - span[0]) * scale[0], (high - mark.value) * scale[1]
    points = [
        ((curve.t - span[0]) * scale[0], (high - curve.values) * scale[1])
        for curve in view.curves
        if not curve.hidden
    ]
    lines = [(high - value) * scale[1] for value, _ in view.limits]

    def hidden(place: tuple[int, int]) -> float:
        ax, ay = place
        left = at[0] + ax - (size[0] if ax < 0 else 0.0)
        top = at[1] + ay - size[1] / 2.0
        right, bottom = left + size[0], top + size[1]
        covered = 0.0
        for x, y in points:
            beside = (x >= left) & (x <= right)
            if beside.any():
                covered += float(np.mean((y[beside] >= top) & (y[beside] <= bottom)))
        covered += sum(top <= line <= bottom for line in lines)
        outside = left < 0.0 or right > _PLOT[0] or top < 0.0 or bottom > _PLOT[1]
        return covered + (10.0 if outside else 0.0)

    places = [(ax, ay) for ay in (-44, 44, -72, 72, -110, 110, -150, 150) for ax in (28, -28)]
    ax, ay = min(places, key=hidden)  # the first of equals
    return {
        "x": mark.t,
        "y": mark.value,
        "text": "<br>".join(map(escape, mark.text)),
        "align": "left",
        "showarrow": True,
        "arrowhead": 0,
        "ax": ax,
        "ay": ay,
        "xanchor": "right" if ax < 0 else "left",
        "yanchor": "middle",
        "borderpad": 3,
        "role": "extreme",
    }


def _span(curves: Sequence[Curve]) -> list[float] | None:
    drawn = [curve.t for curve in curves if len(curve.t)]
    if not drawn:
        return None
    first, last = float(min(t[0] for t in drawn)), float(max(t[-1] for t in drawn))
    return (
        [first, last] if last > first else [first - 0.5, last + 0.5]
    )  # one row: its limits are lines all the same


def _range(view: View) -> list[float] | None:
    """Of the first row: what is drawn, the limits and the mark, with room for their labels."""
    if len(view.rows) > 1:
        return None
    ends: list[float] = [value for value, _ in view.limits]
    if view.mark is not None:
        ends.append(view.mark.value)
    for curve in view.curves:
        finite = curve.values[np.isfinite(curve.values)]
        if len(finite) and not curve.hidden:
            ends += [float(finite.min()), float(finite.max())]
    if not ends:
        return None
    low, high = min(ends), max(ends)
    room = 0.12 * (high - low) or 0.1 * abs(high) or 1.0
    return [low - room, high + room]


def _axes(rows: int) -> list[list[float]]:
    """Domains from the top down, with a gap between the rows."""
    gap = 0.0 if rows == 1 else 0.18 / rows
    height = (1.0 - gap * (rows - 1)) / rows
    tops = [1.0 - row * (height + gap) for row in range(rows)]
    return [[max(top - height, 0.0), top] for top in tops]


def _axis(name: str, row: int) -> str:
    return name if row == 0 else f"{name}{row + 1}"
