"""A page of tables and figures that is no acceptance report: the same style and script, self-contained as well."""

from __future__ import annotations

import base64
import html
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from lmap.report.rendering import pieces, script_json


@dataclass(frozen=True, slots=True)
class Line:
    """One line or set of points of a plot."""

    name: str
    x: ArrayLike
    y: ArrayLike
    role: str = "1"
    """`raw`, `statistic`, `limit` or the number of a colour, from 1."""
    mode: str = "lines"
    """`lines`, `markers` or `lines+markers`."""
    dash: str = "solid"
    width: float = 1.8
    size: float = 6.0
    hover: str = ""
    """plotly.js template; default: name, x and y."""
    group: str = ""
    """Lines of one group have one entry in the legend."""
    texts: Sequence[str] = ()
    """For each point, as `%{text}` of the template."""


@dataclass(frozen=True, slots=True)
class Note:
    """A text in a plot."""

    x: float
    y: float
    text: str
    role: str = "raw"
    above: bool = True


@dataclass(frozen=True, slots=True)
class Plot:
    """One drawing of a figure."""

    x_title: str
    y_title: str
    lines: Sequence[Line]
    choice: str = ""
    """What the reader calls it where a figure has several."""
    caption: str = ""
    x_range: tuple[float, float] | None = None
    y_range: tuple[float, float] | None = None
    equal: bool = False
    """One length on both axes."""
    log: bool = False
    """Both axes logarithmic; the places of the points are written at the axis, powers of ten up the side."""
    y_down: bool = False
    """The vertical axis points down."""
    height: int = 340
    notes: Sequence[Note] = ()


@dataclass(frozen=True, slots=True)
class Sheet:
    """A page."""

    kind: str
    """What it is: "Contact of wheel and rail"."""
    title: str
    headline: str
    facts: Sequence[tuple[str, str]] = ()
    """Name and value."""
    tables: Sequence[tuple[str, Sequence[str], Sequence[Sequence[str]]]] = ()
    """Title, column heads, rows."""
    figures: Sequence[tuple[str, str, Sequence[Plot]]] = field(default=())
    """Title, caption, drawings."""
    messages: Sequence[str] = ()
    footer: str = ""


def render(sheet: Sheet) -> bytes:
    """The page, in UTF-8."""
    files = {"style": "style.css", "script": "page.js"}
    figures = [_figure(*figure) for figure in sheet.figures]
    return b"".join(pieces("sheet.html.j2", files=files, page=sheet, figures=figures))


def _figure(title: str, caption: str, plots: Sequence[Plot]) -> dict[str, Any]:
    choices = [plot.choice for plot in plots]
    views = [
        {"case": plot.choice, "stretch": "", "caption": plot.caption, "message": None, **plotted(plot)}
        for plot in plots
    ]
    return {"title": title, "caption": caption, "choices": choices, "json": script_json(views)}


def plotted(plot: Plot) -> dict[str, Any]:
    """`data` and `layout` for plotly.js, with roles in place of colours."""
    x: dict[str, Any] = {"title": {"text": escape(plot.x_title)}}
    y: dict[str, Any] = {"title": {"text": escape(plot.y_title)}}
    if plot.x_range is not None:
        x["range"] = list(plot.x_range)
    if plot.y_range is not None:
        y["range"] = list(plot.y_range)
    if plot.log:
        x["type"] = y["type"] = "log"
        places = np.unique(np.concatenate([np.ravel(np.asarray(line.x, dtype=float)) for line in plot.lines]))
        x |= {"tickmode": "array", "tickvals": places.tolist()}
        y["dtick"] = 1
    if plot.equal:
        y |= {"scaleanchor": "x", "scaleratio": 1}
    if plot.y_down:
        y["autorange"] = "reversed"
    notes = [
        {
            "x": note.x,
            "y": note.y,
            "text": escape(note.text),
            "showarrow": False,
            "yshift": 12 if note.above else -12,
            "role": note.role,
        }
        for note in plot.notes
    ]
    layout = {"rows": 1, "height": plot.height, "xaxis": x, "yaxis": y, "shapes": [], "annotations": notes}
    return {"data": [_trace(line) for line in plot.lines], "layout": layout}


def _trace(line: Line) -> dict[str, Any]:
    name = escape(line.name)
    trace: dict[str, Any] = {
        "type": "scatter",
        "mode": line.mode,
        "name": name,
        "x": packed(line.x),
        "y": packed(line.y),
        "line": {"width": line.width, "dash": line.dash},
        "hovertemplate": line.hover or "%{x:.4g}: %{y:.4g}<extra>" + name + "</extra>",
        "meta": {"role": line.role, "group": line.group or line.name},
    }
    if line.mode != "lines":
        trace["marker"] = {"size": line.size}
    if line.texts:
        trace["text"] = [escape(text) for text in line.texts]
    return trace


def packed(values: ArrayLike) -> dict[str, str]:
    """Single precision in base 64, little-endian: a fifth of the size of digits, and seven of them. NaN is a gap."""
    raw = np.asarray(values, dtype="<f4").tobytes()
    return {"dtype": "f4", "bdata": base64.b64encode(raw).decode("ascii")}


def escape(text: str) -> str:
    """plotly.js reads a part of HTML in its texts: none of it may come from a name."""
    return html.escape(text, quote=False)
