"""One case in, one frame out; and what the core says about a case without running it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from lmap import toml
from lmap.errors import InputProblem, Problem, SimulationProblem
from lmap.spec.case import Case
from lmap.spec.measured import with_records

if TYPE_CHECKING:
    import polars as pl


class Channel(NamedTuple):
    """One column of a frame."""

    name: str
    unit: str
    meaning: str


def simulate(case: Case | Mapping[str, Any] | str) -> pl.DataFrame:
    """The channels of one case: `t` (s), `s` (m), then dotted names.

    `case` is a case, its plain data or its JSON (as in a report's `cases/`). Raises `InputProblem` for a case
    that is none, `SimulationProblem` for a run that the core could not finish.
    """
    from lmap.execute.local import run_cases

    case = as_case(case)
    check_case(case)
    [outcome] = run_cases([case], jobs=1)
    if outcome.frame is None or not outcome.complete:
        raise SimulationProblem(outcome.ended.get("message") or "the run did not reach its end")
    return outcome.frame


def as_case(case: Case | Mapping[str, Any] | str) -> Case:
    """A case from its plain data or its JSON; an `InputProblem` where it is neither.

    Files of measured tracks that nobody has read yet are seen from the working folder.
    """
    if isinstance(case, Case):
        known = replace(case, data=toml.plain(case.data, "a case"))
        return known if known.texts else with_records(known, Path.cwd())
    data = toml.json_loads(case, "a case") if isinstance(case, str) else case
    return with_records(case_of(data, "case"), Path.cwd())


def case_of(data: Any, label: str) -> Case:
    """A case from plain data; `label` where it has none of its own."""
    if not isinstance(data, Mapping):
        raise InputProblem(Problem(found=f"no table but {type(data).__name__}", allowed="a case"))
    data = toml.plain(data, "a case")
    return Case(str(data.get("label", label)), data)


def check_case(case: Case) -> None:
    """Raises an `InputProblem` with everything that the core finds wrong; keys start at the case."""
    railsim = toml.core()
    try:
        railsim.check_case(case.core_json, toml.tables())
    except railsim.InputError as error:
        raise InputProblem(toml.problems_of_core(error)) from None


def channels(case: Case) -> list[Channel]:
    """The channels that a case gives."""
    railsim = toml.core()
    try:
        return [Channel(*channel) for channel in railsim.channels(case.core_json, toml.tables())]
    except railsim.InputError as error:
        raise InputProblem(toml.problems_of_core(error)) from None


def track_extremes(case: Case) -> dict[str, tuple[float, float]]:
    """Least and largest `lateral`, `vertical`, `cross_level` and `gauge` deviation of a case's track, m."""
    railsim = toml.core()
    try:
        extremes = railsim.track_extremes(case.core_json, toml.tables())
    except railsim.RailsimError as error:
        raise SimulationProblem(str(error)) from None
    return {name: (float(least), float(most)) for name, (least, most) in extremes.items()}


def case_schema() -> dict[str, Any]:
    """JSON schemas of a case's tables `track` and `run`, by name."""
    found: dict[str, Any] = json.loads(toml.core().case_schema())
    return found


def channel_parts() -> list[tuple[str, str, str]]:
    """Last part of the name, unit and meaning of every channel that a case may have."""
    parts: list[tuple[str, str, str]] = toml.core().channel_parts()
    return parts


def core_version() -> str:
    """Version and fingerprint of the compiled core."""
    railsim = toml.core()
    return f"{railsim.version()} ({railsim.fingerprint()})"
