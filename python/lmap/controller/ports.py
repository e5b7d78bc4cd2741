"""What a control law sees and sets: names of its own, and what stands behind them."""

from __future__ import annotations

import fnmatch
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from lmap.errors import InputProblem, Problem, listed, nearest_hint

PERIOD = "period"
"""An input that is no channel: time between two samples, s."""
BRAKE = "independent_brake"
"""Pressure asked for in the vehicle's own cylinders, Pa."""
TORQUE = "torque"
"""N m, + forward: of all wheelsets, of one (`ws1.torque`), or of each of a bogie's (`bogie1.torque`)."""

Targets = Mapping[str, tuple[str, ...]]
"""Outputs of the core by the law's name for them."""


class LawFailed(Exception):
    """Why a law gave no usable answer, in words."""


@dataclass(frozen=True)
class Layout:
    """What a law sees and sets in one case."""

    inputs: tuple[tuple[str, str], ...]
    """Name in the law, channel."""
    targets: Targets
    declared: bool = False
    """Whether the law has to set all of them at every sample."""

    @property
    def channels(self) -> tuple[str, ...]:
        """What the core has to show."""
        return tuple(channel for _, channel in self.inputs if channel != PERIOD)

    @cached_property
    def outputs(self) -> tuple[str, ...]:
        """What the core is told, each once."""
        return tuple(dict.fromkeys(output for group in self.targets.values() for output in group))

    def seen(self, period: float, values: Sequence[float]) -> dict[str, float]:
        """What the law sees, by its own names."""
        given = iter(values)
        return {name: period if channel == PERIOD else next(given) for name, channel in self.inputs}

    def arranged(self, answer: Any) -> list[float | None]:
        """A law's answer for the core; a `LawFailed` where it is none."""
        if answer is None and not self.declared:
            return [None] * len(self.outputs)
        if not isinstance(answer, Mapping):
            found = "nothing" if answer is None else f"an answer of type {type(answer).__name__}"
            raise LawFailed(f"{found}; allowed: a dict with {listed(self.targets, 20)}")
        values: dict[str, float] = {}
        for key, value in answer.items():
            if key not in self.targets:
                raise LawFailed(f"an answer with `{key}`; allowed: {listed(self.targets, 20)}")
            group = self.targets[key]
            values |= dict(zip(group, _numbers(key, value, len(group)), strict=True))
        if clash := _twice({key: self.targets[key] for key in answer}):
            raise LawFailed(f"an answer with {clash}")
        missing = [name for name in self.targets if name not in answer] if self.declared else []
        if missing:
            raise LawFailed(f"an answer without {listed(missing)}, declared as an output")
        return [values.get(output) for output in self.outputs]


def _twice(targets: Targets) -> str | None:
    """Two names that set the same thing, in words. (What of a bogie and of its axles overlaps, the core knows.)"""
    first: dict[str, str] = {}
    for name, group in targets.items():
        for output in group:
            if first.setdefault(output, name) != name:
                return f"{first[output]} and {name}, both of which set {output}"
    return None


def _numbers(key: str, value: Any, count: int) -> list[float]:
    try:
        if not hasattr(value, "__iter__"):
            return [float(value)] * count
        numbers = [float(one) for one in value]
        if isinstance(value, str | bytes) or any(isinstance(one, str | bytes) for one in value):
            raise TypeError
    except (TypeError, ValueError, OverflowError):
        raise LawFailed(f"{key} = {value!r}, neither a number nor numbers") from None
    if len(numbers) != count or count == 1:
        noun = f"{key}, a single number" if count == 1 else f"{count} wheelsets"
        raise LawFailed(f"{len(numbers)} {key}s for {noun}")
    return numbers


def targets(channels: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """Everything that a law can set in a run that records these channels."""
    axles = tuple(name for name in channels if name.endswith(f".{TORQUE}"))
    bogies = [name.split(".")[1] for name in channels if fnmatch.fnmatchcase(name, "traction.*.effort")]
    found = {TORQUE: axles} | {name: (name,) for name in axles}
    found |= {f"{name}.{TORQUE}": (f"{name}.{TORQUE}",) for name in bogies}
    return found | ({BRAKE: (BRAKE,)} if "brake.cylinder" in channels else {})


def inputs(
    written: Sequence[str] | Mapping[str, str], channels: Sequence[str]
) -> tuple[tuple[str, str], ...]:
    """Inputs as a spec writes them: channels and patterns of them, or a table from the law's names to channels."""
    known = [*channels, PERIOD]
    allowed = f"{PERIOD}, a channel of the run (`lmap channels VEHICLE` lists them) or a pattern as ws*.slip"
    found: list[tuple[str, str]] = []
    problems = []
    pairs = written.items() if isinstance(written, Mapping) else enumerate(written)
    for key, pattern in pairs:
        matches = [name for name in known if fnmatch.fnmatchcase(name, pattern)]
        named = isinstance(key, str)
        if not matches or (named and matches != [pattern]):
            hint = nearest_hint(pattern, known)
            problems.append(Problem(key=("inputs", key), found=f'"{pattern}"', allowed=allowed, hint=hint))
        found += [(key if isinstance(key, str) else name, name) for name in matches]
    if problems:
        raise InputProblem(problems)
    return tuple(dict.fromkeys(found))


def chosen(written: Sequence[str] | Mapping[str, str], known: Targets) -> dict[str, tuple[str, ...]]:
    """Outputs as a spec writes them, among what can be set."""
    found: dict[str, tuple[str, ...]] = {}
    problems = []
    pairs = written.items() if isinstance(written, Mapping) else ((name, name) for name in written)
    for place, (key, name) in enumerate(pairs):
        if name in known:
            found[key] = known[name]
            continue
        at = key if isinstance(written, Mapping) else place
        hint = nearest_hint(name, known)
        allowed = listed(known, 20)
        problems.append(Problem(key=("outputs", at), found=f'"{name}"', allowed=allowed, hint=hint))
    if clash := _twice(found):
        problems.append(Problem(key=("outputs",), found=clash, allowed="what a wheelset gets once"))
    if problems:
        raise InputProblem(problems)
    return found
