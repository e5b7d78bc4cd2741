"""Figures of a simulated case: how far, how long, how fast, with which scheme."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from lmap.report.numbers import NOTHING, number
from lmap.verdict import CaseResult

_CLOCKS = ("wall", "real_time", "elapsed", "seconds", "ns_per", "per_second")
"""Parts of names of statistics that a clock made: they differ from run to run."""


@dataclass(frozen=True, slots=True)
class RunFigures:
    """What a case's run was, as text."""

    case: str
    distance: str
    simulated: str
    wall: str
    real_time_factor: str
    scheme: str
    step: str
    output_step: str
    ended: str
    """In words: end of track, diverged."""
    message: str
    """Why it ended early."""
    complete: bool
    rows: int


def figures(case: CaseResult) -> RunFigures:
    """Read from the case and what its run recorded."""
    extent = case.extent
    simulated = extent.simulated
    run = case.case.get("run", {})
    run = run if isinstance(run, Mapping) else {}
    integrator = run.get("integrator", {})
    integrator = integrator if isinstance(integrator, Mapping) else {}
    factor = simulated / case.wall_s if simulated is not None and case.wall_s > 0.0 else None
    return RunFigures(
        case=case.label,
        distance=_with(None if simulated is None else extent.distance, "m"),
        simulated=_with(simulated, "s"),
        wall=_with(case.wall_s, "s", 3) if case.wall_s > 0.0 else NOTHING,
        real_time_factor=NOTHING if factor is None else number(factor, 3),
        scheme=str(integrator.get("kind", NOTHING)),
        step=_milliseconds(integrator.get("step")),
        output_step=_milliseconds(run.get("output_step")),
        ended=str(case.ended.get("kind", "unknown")).replace("_", " "),
        message=str(case.ended.get("message") or ""),
        complete=case.complete,
        rows=extent.rows,
    )


def without_clocks(statistics: Mapping[str, Any]) -> dict[str, Any]:
    """Counts of work, which the same case gives again; times of the clock left out."""
    return {name: value for name, value in statistics.items() if not any(part in name for part in _CLOCKS)}


def _with(value: float | None, unit: str, digits: int = 4) -> str:
    return NOTHING if value is None else f"{number(value, digits)} {unit}"


def _milliseconds(value: object) -> str:
    return f"{float(value) * 1e3:g} ms" if isinstance(value, int | float) else NOTHING
