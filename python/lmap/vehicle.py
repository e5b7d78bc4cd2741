"""Vehicles: loaded by name or path, resolved with overrides and an operating condition."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from lmap import files, include, toml
from lmap.errors import InputProblem, KeyPath, Problem
from lmap.spec.case import VehicleData

if TYPE_CHECKING:
    import polars as pl


@dataclass(frozen=True, slots=True)
class Vehicle:
    """A vehicle file as written, with what the core reads out of it.

    locomotive = Vehicle.load("coco134")
    locomotive.data.design_speed           # m/s
    locomotive.modes(32.0)                 # frame of modes, rolling at 32 m/s
    soft = locomotive.resolve({"secondary.kz": 5e5}, condition="tare")
    soft.run({"kind": "equilibrium", "speed": 20.0})
    wagon = Vehicle.of({"name": "wagon", "body": [...], ...})
    """

    document: toml.Document
    data: VehicleData

    @classmethod
    def load(
        cls,
        name: str | Path,
        *,
        beside: str | Path | None = None,
        overrides: Mapping[str, Any] | None = None,
        condition: str | None = None,
    ) -> Self:
        """The vehicle with a name that ships, or a file.

        `beside` is the file or folder that names it, the working folder by default. Raises `InputProblem`.
        """
        place = Path.cwd() if beside is None else Path(beside)
        document = include.load(files.find(files.VEHICLE, str(name), place))
        return cls(document, _resolve(document, overrides or {}, condition))

    @classmethod
    def of(
        cls,
        data: Mapping[str, Any] | str,
        *,
        beside: str | Path | None = None,
        overrides: Mapping[str, Any] | None = None,
        condition: str | None = None,
    ) -> Self:
        """A vehicle from plain data with the keys of a vehicle file, or from TOML text.

        Its track and profiles are looked for from `beside`, the working folder by default. Raises `InputProblem`.
        """
        written = toml.loads(data) if isinstance(data, str) else toml.plain(data, "a vehicle")
        if "include" in written:
            raise InputProblem(Problem(key=("include",), found="files", allowed="a vehicle in one piece"))
        place = Path.cwd() if beside is None else Path(beside)
        text = data if isinstance(data, str) else json.dumps(written)
        document = _Given(place / "vehicle", text, written)
        return cls(document, _resolve(document, overrides or {}, condition))

    def run(self, run: Mapping[str, Any], *, track: Mapping[str, Any] | None = None) -> pl.DataFrame:
        """One run of any kind on the vehicle's own base track: its channels.

        `run` has the keys of `[run]` in a case (`docs/concepts/analyses.md`); `track` goes over the base track, 200 m
        of it by default. Friction is 0.4 and the wheel profile the vehicle's own where `run` names none. Raises
        `InputProblem` or `SimulationProblem`.
        """
        from lmap.analyse import vehicle_case
        from lmap.simulate import simulate

        label = str(run.get("kind", "run"))
        return simulate(vehicle_case(self.data, self.document.path, run, label=label, track=track))

    def modes(self, speed: float | Sequence[float] = 0.0, *, friction: float = 0.4) -> pl.DataFrame:
        """Eigenvalues, names and shapes of the vehicle's modes on its own base track at a speed or at several, m/s.

        A row for each mode at each speed, as `lmap.analyse.modes` says; 0 stands with wheels that stick.
        """
        from lmap.analyse import modes

        speeds = [float(speed)] if isinstance(speed, int | float) else [float(v) for v in speed]
        return modes(self.data, self.document.path, speeds, friction=friction)

    def resolve(self, overrides: Mapping[str, Any] | None = None, condition: str | None = None) -> Self:
        """The same file with named parameters overridden and an operating condition applied."""
        return type(self)(self.document, _resolve(self.document, overrides or {}, condition))


class _Given(toml.Document):
    """Data that no file holds: faults are told by their keys."""

    def locate(self, problem: Problem, key: KeyPath | None = None) -> Problem:
        """The problem at its key."""
        return replace(problem, key=problem.key if key is None else key)


def _resolve(document: toml.Document, overrides: Mapping[str, Any], condition: str | None) -> VehicleData:
    railsim = toml.core()
    try:
        text = railsim.vehicle_resolve(json.dumps(document.data), json.dumps(dict(overrides)), condition)
    except railsim.InputError as error:
        raise InputProblem(
            [_located(problem, document, overrides) for problem in toml.problems_of_core(error)]
        ) from None
    resolved = json.loads(text)
    return VehicleData(
        file=document.shown,
        document=resolved["document"],
        name=resolved["name"],
        title=resolved.get("title") or resolved["name"],
        design_speed=float(resolved["design_speed"]),
        wheel_radius=float(resolved["wheel_radius"]),
        wheel_profile=resolved.get("wheel_profile"),
        track=resolved.get("track"),
        condition=condition,
        conditions=tuple(resolved.get("conditions", ())),
        design_condition=resolved.get("design_condition"),
        mass=resolved.get("mass"),
        bodies=tuple(resolved.get("bodies", ())),
        model=resolved.get("model", {}),
    )


def schema() -> dict[str, Any]:
    """JSON schema of a vehicle file, with which an editor completes and checks it."""
    found: dict[str, Any] = json.loads(toml.core().vehicle_schema())
    return found


def starter(name: str, model: str) -> str:
    """The text of a vehicle that ships, under another name: what `lmap new vehicle` writes."""
    if re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) is None:
        raise InputProblem(
            Problem(found=f'the name "{name}"', allowed="a letter, then letters, digits and _")
        )
    path = files.find(files.VEHICLE, model, Path.cwd())
    text = files.read_text(path, "vehicle")
    toml.load(path, "vehicle")
    head = f"# A copy of {path.stem}, to be changed into {name}.\n"
    renamed, count = re.subn(r'(?m)^name = "[^"\n]*"', f'name = "{name}"', text, count=1)
    if count == 0:
        raise InputProblem(
            Problem(file=files.shown(path), found="no name at its head", allowed='name = "..."')
        )
    return head + renamed


def unreadable(
    document: toml.Document, overrides: Mapping[str, Any], condition: str | None
) -> list[dict[str, Any]]:
    """What keeps a document from being a vehicle, as findings of the core; empty for a vehicle."""
    railsim = toml.core()
    try:
        text = railsim.lint_vehicle(json.dumps(document.data), json.dumps(dict(overrides)), condition)
    except railsim.InputError as error:
        raise InputProblem(toml.problems_of_core(error)) from None
    found: list[dict[str, Any]] = json.loads(text)
    # What is wrong with an override is no fault of the file.
    given = [one for one in found if one["path"][:1] == ["set"]]
    if given:
        raise InputProblem(
            [Problem(key=tuple(one["path"]), found=one["found"], allowed=one["usual"]) for one in given]
        )
    return found


def lint_codes() -> list[dict[str, str]]:
    """Every code of `lmap lint`: `code`, `rule`, `severity`, `summary`."""
    codes: list[dict[str, str]] = json.loads(toml.core().lint_codes())
    return codes


def _located(problem: Problem, document: toml.Document, overrides: Mapping[str, Any]) -> Problem:
    """The fault with the vehicle's file and line; where an override is at fault, its name alone."""
    key = problem.key
    if key[:1] == ("vehicle",) and "vehicle" not in document.data:
        key = key[1:]
    tail = key[1:] if key[:1] in (("parameters",), ("overrides",), ("set",)) else key
    name = ".".join(map(str, tail))
    if name in overrides:
        return Problem(key=("set", name), found=problem.found, allowed=problem.allowed, hint=problem.hint)
    return located(problem, key, document, overrides)


def located(problem: Problem, key: KeyPath, document: toml.Document, overrides: Mapping[str, Any]) -> Problem:
    """A fault at a key of the vehicle's file; where a named parameter gave the number, at the parameter."""
    given = _FROM.search(problem.found)
    if given is None:
        return document.locate(problem, key)
    if given[1] in overrides:
        return Problem(key=("set", given[1]), found=problem.found, allowed=problem.allowed, hint=problem.hint)
    parameters = document.data.get("parameters", {})
    written = (given[1],) if given[1] in parameters else tuple(given[1].split("."))
    return document.locate(problem, ("parameters", *written))


_FROM = re.compile(r"\(from \$([^\s()]+)\)$")
"""How the core says that a number came through a reference."""
