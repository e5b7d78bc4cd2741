"""LMAP 1.1: what looks wrong in a vehicle's description, with codes, files and lines."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lmap import files, include, toml
from lmap.analyse import vehicle_case
from lmap.errors import InputProblem, Problem, key_text, listed, nearest_hint
from lmap.simulate import simulate
from lmap.spec.case import VehicleData
from lmap.vehicle import Vehicle, lint_codes, located, unreadable

ERROR = "error"


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One thing that looks wrong."""

    code: str
    rule: str
    """The code in words."""
    severity: str
    """`error` cannot be right, `warning` may be meant."""
    subject: str
    """The element, by name."""
    key: str
    file: str | None
    line: int | None
    """From 1; none where it is in no file."""
    found: str
    usual: str


def lint(
    name: str | Path,
    *,
    beside: str | Path | None = None,
    overrides: Mapping[str, Any] | None = None,
    condition: str | None = None,
    select: Iterable[str] = (),
    ignore: Iterable[str] = (),
    run: Mapping[str, Any] | None = None,
) -> list[Finding]:
    """Everything that looks wrong with a vehicle on straight track of its own base track, errors first.

    `select` and `ignore` are codes or beginnings of codes (`LM4`); `run` are keys of the run that it is to stand
    (`{"integrator": {"kind": "heun", "step": 1e-3}}`). Raises `InputProblem` for a file that is missing or no
    TOML, a track or profile that is missing, and for codes that do not exist.
    """
    select, ignore = list(select), list(ignore)
    _check_codes(select, ignore)
    changes = dict(overrides or {})
    place = Path.cwd() if beside is None else Path(beside)
    document = include.load(files.find(files.VEHICLE, str(name), place))
    rows: Sequence[Mapping[str, Any]] = unreadable(document, changes, condition)
    if not rows:
        vehicle = Vehicle.load(document.path, overrides=changes, condition=condition)
        rows = _rows(vehicle.data, document.path, run or {})
    found = [_finding(row, document, changes) for row in rows]
    return [one for one in found if _wanted(one.code, select, ignore)]


def _rows(vehicle: VehicleData, path: Path, run: Mapping[str, Any]) -> list[dict[str, Any]]:
    """What the core finds in a vehicle that can be read."""
    whole = {"kind": "lint", "speed": vehicle.design_speed, **run}
    frame = simulate(vehicle_case(vehicle, path, whole, label="lint"))
    words = {1.0: "warning", 2.0: ERROR}
    return [
        {**row, "severity": words[row["severity"]], "path": json.loads(row["path"])}
        for row in frame.iter_rows(named=True)
    ]


def _finding(row: Mapping[str, Any], document: toml.Document, overrides: Mapping[str, Any]) -> Finding:
    """A row of the core with the file and line that a person has to change."""
    key = tuple(row["path"])
    own = key[1:] if key[:1] == ("vehicle",) else key
    at = Problem(found=row["found"], allowed=row["usual"], key=own)
    if key[:1] == ("vehicle",) and own:
        at = located(at, own, document, overrides)
    elif key[:1] == ("vehicle",):
        at = Problem(found=at.found, allowed=at.allowed, file=document.shown)
    return Finding(
        code=row["code"],
        rule=row["rule"],
        severity=row["severity"],
        subject=row["subject"],
        key=key_text(at.key),
        file=at.file,
        line=at.line,
        found=row["found"],
        usual=row["usual"],
    )


def _wanted(code: str, select: Sequence[str], ignore: Sequence[str]) -> bool:
    """The longest beginning that names the code decides, as ruff does it; without `select` all are wanted."""
    selected = max((len(one) for one in select if code.startswith(one)), default=-1 if select else 0)
    ignored = max((len(one) for one in ignore if code.startswith(one)), default=-1)
    return selected > ignored


def _check_codes(select: Sequence[str], ignore: Sequence[str]) -> None:
    known = [row["code"] for row in lint_codes()]
    problems = [
        Problem(
            key=(option,),
            found=f'"{code}"',
            allowed=f"codes or beginnings of codes: {listed(known, 8)}",
            hint=nearest_hint(code, known),
        )
        for option, codes in (("--select", select), ("--ignore", ignore))
        for code in codes
        if not code or not any(one.startswith(code) for one in known)
    ]
    if problems:
        raise InputProblem(problems)
