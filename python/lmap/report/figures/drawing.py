"""The plots that a procedure makes itself: loops, outlines, a figure over speed."""

from __future__ import annotations

import numpy as np

from lmap.report.figures.plot import Figure, View
from lmap.report.sheet import Line, Plot, plotted
from lmap.verdict import Drawing, DrawnCurve, SpecVerdict

_HEIGHT = 420
_EQUAL_HEIGHT = 560
"""Of a drawing with equal axes, which is mostly a cross-section, pixels."""


_ROLES = {"limit": "limit", "reference": "raw"}
"""Colours of what is no curve of its own."""


def draw(spec: SpecVerdict) -> list[Figure]:
    """A figure for each drawing."""
    return [
        Figure(
            title=drawing.title,
            caption=drawing.caption,
            views=(View("", "", (drawing.y_label,), raw=plotted(_plot(drawing))),),
        )
        for drawing in spec.drawings
    ]


def _plot(drawing: Drawing) -> Plot:
    lines: list[Line] = []
    for curve in drawing.curves:
        number = 1 + sum(line.role not in _ROLES.values() for line in lines)
        lines.append(_line(curve, _ROLES.get(curve.role, str(number))))
    return Plot(
        x_title=drawing.x_label,
        y_title=drawing.y_label,
        lines=lines,
        equal=drawing.equal_axes,
        y_down=drawing.y_down,
        height=_EQUAL_HEIGHT if drawing.equal_axes else _HEIGHT,
    )


def _line(curve: DrawnCurve, role: str) -> Line:
    x, y = np.asarray(curve.x, dtype=np.float64), np.asarray(curve.y, dtype=np.float64)
    if curve.role == "outline" and len(x):
        x, y = np.append(x, x[0]), np.append(y, y[0])
    return Line(
        name=curve.name,
        x=x,
        y=y,
        role=role,
        mode="markers" if curve.role in ("points", "mark") else "lines",
        size=12.0 if curve.role == "mark" else 6.0,
        dash="dash" if curve.role == "limit" else "solid",
    )
