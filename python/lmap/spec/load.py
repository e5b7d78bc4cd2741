"""Reading a spec file: overrides applied, every fault collected with file, key and line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from lmap import toml
from lmap.criteria.chain import chain_problems
from lmap.errors import InputProblem, KeyPath, Problem, problems_of_validation
from lmap.spec import overrides
from lmap.spec.model import KNOWN_KEYS, Spec


@dataclass(frozen=True, slots=True)
class LoadedSpec:
    """A spec with the file it came from and what was set otherwise."""

    document: toml.Document
    spec: Spec
    settings: Mapping[str, Any]
    """`[set]` and the caller's settings together, by key."""
    given: frozenset[str]
    """Keys that the caller set, not the file."""

    @property
    def parameters(self) -> dict[str, Any]:
        """Named parameters of the vehicle that are set."""
        return overrides.split(self.settings)[1]

    def locate(self, problem: Problem) -> Problem:
        """A problem whose key starts at the spec, with file and line, or with `--set` as its origin."""
        return _locate(problem, self.document, self.settings, self.given)


def load(path: Path, settings: Mapping[str, Any] | None = None) -> LoadedSpec:
    """The spec in a file; an `InputProblem` with everything that is wrong with it."""
    given = dict(settings or {})
    document = toml.load(path, "spec")
    written = document.data.get("set", {})
    both = {**(written if isinstance(written, dict) else {}), **given}
    if isinstance(written, dict):
        # a caller's speed replaces the file's, whichever of the two keys either of them uses
        for key, other in (("run.speed", "run.speed_kmh"), ("run.speed_kmh", "run.speed")):
            if key in given and other in written:
                both.pop(other, None)
    own, _ = overrides.split(both)
    data, problems = overrides.apply(document.data, own)
    spec: Spec | None = None
    try:
        spec = Spec.model_validate(data)
    except ValidationError as error:
        problems += problems_of_validation(error.errors(include_url=False), KNOWN_KEYS)
    if spec is not None:
        for index, criterion in enumerate(spec.criterion):
            problems += [problem.at(prefix=("criterion", index)) for problem in chain_problems(criterion)]
        problems += _repeated(spec)
    if spec is None or problems:
        raise InputProblem([_locate(problem, document, both, frozenset(given)) for problem in problems])
    return LoadedSpec(document, spec, both, frozenset(given))


def _repeated(spec: Spec) -> list[Problem]:
    """Criteria with the same name cannot be told apart in a table."""
    seen: set[str] = set()
    problems = []
    for index, criterion in enumerate(spec.criterion):
        if criterion.name in seen:
            key: KeyPath = ("criterion", index, "name")
            problems.append(Problem(key=key, found=f'"{criterion.name}" again', allowed="a name of its own"))
        seen.add(criterion.name)
    return problems


def _locate(
    problem: Problem, document: toml.Document, settings: Mapping[str, Any], given: frozenset[str]
) -> Problem:
    dotted = ".".join(map(str, problem.key))
    if problem.key[:1] == ("set",) and len(problem.key) > 1:
        dotted = str(problem.key[1])
    origin = next(
        (key for key in settings if dotted == key or dotted.startswith((f"{key}.", f"{key}["))), None
    )
    if origin is None:
        return document.locate(problem)
    if origin in given:
        return Problem(
            file=document.shown,
            key=(f"--set {dotted}",),
            found=problem.found,
            allowed=problem.allowed,
            hint=problem.hint,
        )
    return document.locate(problem, ("set", origin))
