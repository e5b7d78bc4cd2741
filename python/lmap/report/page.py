"""The report folder: one self-contained page, the verdicts as JSON and JUnit XML, every case and its frame.

    out/index.html  verdicts.json  junit.xml  cases/<hash>.json  cases/<hash>.parquet  view-<id>.html

The page works without a network: plotly.js, style and data are inside. Each file is written under a temporary
name and then renamed, so that a reader never meets half a file; the page comes last.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from lmap import files
from lmap.report import runs, words
from lmap.report.document import dumps, to_json
from lmap.report.junit import junit
from lmap.report.numbers import NOTHING, given, number, percent, quantity, signed, with_unit
from lmap.report.parquet import write_parquet
from lmap.report.rendering import pieces, script_json
from lmap.report.scene import file_name, render_scene
from lmap.verdict import Acceptance, CaseResult, CriterionVerdict, SpecVerdict

_FEW = 6
"""Tests on a page whose curves are drawn in full detail."""

_LONG_LIST = 8
"""Lists of lists longer than this are folded on the page: profile points."""


def write_report(acceptance: Acceptance, folder: str | os.PathLike[str]) -> None:
    """Writes the whole report; the folder is made where it is missing, other files in it stay."""
    root = Path(folder)
    cases = root / "cases"
    cases.mkdir(parents=True, exist_ok=True)
    written: set[str] = set()
    for spec in acceptance.specs:
        for case in spec.cases:
            if case.hash not in written:
                written.add(case.hash)
                files.write(cases / f"{case.hash}.json", case.case_json.encode())
                files.put(cases / f"{case.hash}.parquet", partial(write_parquet, case))
    for spec, name in _drawings(acceptance):
        files.write(root / name, render_scene(spec.drawing or {}))
    files.put(root / "index.html", partial(_write_page, acceptance))
    files.write(root / "junit.xml", junit(acceptance).encode())
    files.write(root / "verdicts.json", to_json(acceptance).encode())


def render(acceptance: Acceptance) -> bytes:
    """The page, in UTF-8."""
    return b"".join(_parts(acceptance))


def _write_page(acceptance: Acceptance, file: Path) -> None:
    with file.open("wb") as stream:
        for part in _parts(acceptance):
            stream.write(part)


def _parts(acceptance: Acceptance) -> Iterator[bytes]:
    """The page piece by piece, so that it is never in memory as a whole."""
    as_they_are = {"style": "style.css", "script": "page.js"}
    return pieces("index.html.j2", files=as_they_are, page=_page(acceptance))


def _drawings(acceptance: Acceptance) -> list[tuple[SpecVerdict, str]]:
    """Specs with a drawing, and the file that holds it; two of one id are told apart by their place."""
    found: dict[str, SpecVerdict] = {}
    for position, spec in enumerate(acceptance.specs):
        if spec.drawing is not None:
            name = file_name(spec.id)
            found[name if name not in found else file_name(f"{spec.id}-{position}")] = spec
    return [(spec, name) for name, spec in found.items()]


@dataclass(frozen=True, slots=True)
class _Row:
    """A line of the table of criteria."""

    first: bool
    name: str
    case: str
    value: str
    limit: str
    assumed: bool
    margin: str
    percent: str
    published: str
    verdict: str
    verdict_class: str
    signal: str
    place: str
    source: str


def _page(acceptance: Acceptance) -> dict[str, Any]:
    title = ", ".join(f"{spec.id} {spec.title}" for spec in acceptance.specs[:3]) or "nothing checked"
    if len(acceptance.specs) > 3:
        title += f" and {len(acceptance.specs) - 3} more"
    drawings = {id(spec): name for spec, name in _drawings(acceptance)}
    count = len(acceptance.specs)
    return {
        "title": title,
        "verdict": words.VERDICTS[acceptance.outcome],
        "verdict_class": _class(str(acceptance.outcome)),
        "headline": words.headline(words.all_criteria(acceptance)),
        "version": acceptance.version,
        "core": acceptance.core,
        "coarse": count > _FEW,
        "index": [_entry(position, spec) for position, spec in enumerate(acceptance.specs)],
        # one at a time: its frames and plots are let go before the next
        "specs": (
            _spec(position, spec.held(), of=count, drawing=drawings.get(id(spec)))
            for position, spec in enumerate(acceptance.specs)
        ),
    }


def _entry(position: int, spec: SpecVerdict) -> dict[str, str]:
    """A line of the page's index."""
    return {
        "anchor": f"spec-{position}",
        "id": spec.id,
        "title": spec.title,
        "verdict": words.VERDICTS[spec.outcome],
        "verdict_class": _class(str(spec.outcome)),
        "assumed": "yes" if spec.assumed else "",
    }


def _spec(position: int, spec: SpecVerdict, *, of: int, drawing: str | None = None) -> dict[str, Any]:
    from lmap.report.figures.plot import COARSE

    return {
        **_entry(position, spec),
        "file": spec.file,
        "procedure": spec.procedure,
        "vehicle": spec.vehicle,
        "condition": spec.condition,
        # With one spec the page's head has said it.
        "headline": "" if of == 1 else f"{_sentence(words.headline(spec.criteria))}.",
        "criteria": _rows(spec),
        "messages": words.messages(spec),
        "assumptions": words.assumptions(spec),
        "figures": _figures(position, spec, COARSE if of > _FEW else 1.0),
        "drawing": drawing,
        "facts": spec.facts,
        "overrides": [(key, value) for key, value in spec.overrides.items()],
        "inputs": spec.inputs,
        "runs": [_run(case) for case in spec.cases],
    }


def _rows(spec: SpecVerdict) -> list[_Row]:
    rows: list[_Row] = []
    previous = None
    for criterion in sorted(spec.criteria, key=lambda criterion: criterion.index):
        rows.append(_row(criterion, first=criterion.index != previous))
        previous = criterion.index
    return rows


def _row(criterion: CriterionVerdict, *, first: bool) -> _Row:
    unit = criterion.unit
    verdict = words.verdict(criterion)
    return _Row(
        first=first,
        name=criterion.name,
        case=criterion.case,
        value=quantity(criterion.value, unit, criterion.published),
        limit=with_unit(criterion.limit, unit) or "none",
        assumed=criterion.source == words.ASSUMED,
        margin=signed(criterion.margin, unit),
        percent="" if criterion.margin_percent is None else percent(criterion.margin_percent),
        published=given(criterion.published, unit),
        verdict=verdict,
        verdict_class=_class(verdict),
        signal=criterion.signal or NOTHING,
        place=words.place(criterion.at) if words.placed(criterion) else "",
        source=criterion.source,
    )


def _figures(position: int, spec: SpecVerdict, detail: float) -> list[dict[str, Any]]:
    from lmap.report.figures import FIGURES
    from lmap.report.figures.criterion import NEAR
    from lmap.report.figures.plot import plotly

    shown: list[dict[str, Any]] = []
    for figure in (figure for draw in FIGURES for figure in draw(spec)):
        views = [
            {
                "case": view.case,
                "stretch": view.stretch,
                "caption": view.caption,
                "message": view.message,
                **plotly(view, 1.0 if view.stretch == NEAR else detail),
            }
            for view in figure.views
        ]
        shown.append(
            {
                "id": f"figure-{position}-{len(shown)}",
                "title": figure.title,
                "caption": figure.caption,
                "badge": figure.badge.upper() if figure.badge else None,
                "badge_class": _class(figure.badge or ""),
                "cases": list(dict.fromkeys(view.case for view in figure.views)),
                "stretches": list(dict.fromkeys(view.stretch for view in figure.views)),
                "json": script_json(views),
            }
        )
    return shown


def _run(case: CaseResult) -> dict[str, Any]:
    counts = runs.without_clocks(case.statistics)
    clocks = {name: value for name, value in case.statistics.items() if name not in counts}
    return {
        "figures": runs.figures(case),
        "hash": case.hash,
        "statistics": _listed(counts),
        "clock": _listed({**({"wall_s": case.wall_s} if case.wall_s > 0.0 else {}), **clocks}),
        "json": dumps(_folded(case.case)),
    }


def _listed(values: Mapping[str, Any]) -> str:
    return ", ".join(
        f"{name.replace('_', ' ')} {number(value) if isinstance(value, float) else value}"
        for name, value in values.items()
    )


def _folded(value: Any) -> Any:
    """The case without its long lists of points: their number stands for them."""
    if isinstance(value, Mapping):
        return {key: _folded(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        if len(value) > _LONG_LIST and all(isinstance(item, list | tuple | int | float) for item in value):
            return f"({len(value)} points)"
        return [_folded(item) for item in value]
    return value


def _class(verdict: str) -> str:
    """A class of the style sheet: `not-assessed`."""
    return verdict.lower().replace(" ", "-")


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]
