"""Reading a spec file: overrides applied, every fault collected with file, key and line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from lmap import files, toml
from lmap.criteria.chain import chain_problems
from lmap.errors import InputProblem, KeyPath, Problem, listed, nearest_hint, problems_of_validation
from lmap.spec import overrides
from lmap.spec.model import KNOWN_KEYS, SPEC_KEYS_OF_RUN, Spec


@dataclass(frozen=True, slots=True)
class LoadedSpec:
    """A spec with the file it came from and what was set otherwise."""

    document: toml.Document
    spec: Spec
    settings: Mapping[str, Any]
    """`[set]` and the caller's settings together, by key."""
    given: frozenset[str]
    """Keys that the caller set, not the file."""
    variant: toml.Document | None = None
    """The file that was asked for, where it is another spec with some keys set otherwise."""

    @property
    def asked(self) -> toml.Document:
        """The file that was asked for."""
        return self.document if self.variant is None else self.variant

    def written_in(self, key: str) -> Path:
        """The file that a key is set or written in."""
        varied = self.variant is not None and key in self.variant.data.get("set", {})
        return self.asked.path if varied else self.document.path

    @property
    def parameters(self) -> dict[str, Any]:
        """Named parameters of the vehicle that are set."""
        return overrides.split(self.settings)[1]

    @property
    def recorded_settings(self) -> dict[str, Any]:
        """The settings as reports keep them: files by paths that hold nothing of this machine."""
        return {
            key: files.recorded(Path(value))
            if isinstance(value, str) and Path(value).is_absolute()
            else value
            for key, value in self.settings.items()
        }

    def locate(self, problem: Problem) -> Problem:
        """A problem whose key starts at the spec, with file and line, or with `--set` as its origin."""
        problem = _with_spec_keys(problem)
        return _locate(problem, self.document, self.settings, self.given, self.variant)


def load(path: Path, settings: Mapping[str, Any] | None = None) -> LoadedSpec:
    """The spec in a file; an `InputProblem` with everything that is wrong with it."""
    given = dict(settings or {})
    document, variant = _documents(path)
    written = document.data.get("set", {})
    if variant is not None and isinstance(written, dict):
        written = {**written, **variant.data["set"]}
    both = {**(written if isinstance(written, dict) else {}), **given}
    if isinstance(written, dict):
        # a caller's speed replaces the file's, whichever of the two keys either of them uses
        for key, other in (("run.speed", "run.speed_kmh"), ("run.speed_kmh", "run.speed")):
            varied = variant is not None and key in variant.data["set"] and other not in variant.data["set"]
            if (key in given or (varied and other not in given)) and other in both:
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
        raise InputProblem(
            [_locate(problem, document, both, frozenset(given), variant) for problem in problems]
        )
    return LoadedSpec(document, spec, both, frozenset(given), variant)


VARIANT = frozenset({"spec", "set", "must_fail", "no_value"})
"""Keys of a file that is another spec with some keys set otherwise, e.g. a bad twin (`must_fail`: what it fails in,
`no_value`: what then cannot be said)."""


def _documents(path: Path) -> tuple[toml.Document, toml.Document | None]:
    """The spec's document; and the variant's, where the file names another spec."""
    asked = toml.load(path, "spec")
    if "spec" not in asked.data:
        return asked, None
    problems = []
    for key in asked.data:
        if key not in VARIANT:
            hint = nearest_hint(key, VARIANT)
            allowed = f"{listed(sorted(VARIANT))}: the rest stands in the spec that it names"
            problems.append(Problem(key=(key,), found=f'an unknown key "{key}"', allowed=allowed, hint=hint))
    if not isinstance(asked.data.get("set", {}), dict):
        problems.append(Problem(key=("set",), found="no table", allowed="keys and values, as for --set"))
    name, base = asked.data["spec"], None
    try:
        if not isinstance(name, str):
            raise InputProblem(Problem(found=str(name), allowed="the name or path of a spec, in quotes"))
        base = toml.load(files.find(files.SPEC, name, asked.path), "spec")
        if "spec" in base.data:
            raise InputProblem(Problem(found=f'"{name}", a variant itself', allowed="a whole spec"))
    except InputProblem as error:
        problems += [one if one.file is not None else one.at(prefix=("spec",)) for one in error.problems]
    if base is None or problems:
        raise InputProblem([one if one.file is not None else asked.locate(one) for one in problems])
    return base, replace(asked, data={"set": {}, **asked.data})


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


def _with_spec_keys(problem: Problem) -> Problem:
    """An unknown key of a run, which the core has found, with the keys that only specs have among the allowed ones."""
    if problem.key[-2:-1] != ("run",) or not problem.found.startswith("an unknown key"):
        return problem
    own = SPEC_KEYS_OF_RUN if len(problem.key) == 2 else SPEC_KEYS_OF_RUN - {"speed_kmh"}
    known = sorted({*problem.allowed.split(", "), *own})
    hint = nearest_hint(str(problem.key[-1]), known)
    return replace(problem, allowed=", ".join(known), hint=hint)


def _locate(
    problem: Problem,
    document: toml.Document,
    settings: Mapping[str, Any],
    given: frozenset[str],
    variant: toml.Document | None,
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
    if variant is not None and origin in variant.data["set"]:
        document = variant
    return document.locate(problem, ("set", origin))
