"""One rule for `--set`, `[set]` and Python's `set=`.

A dotted key whose first part is `track`, `run`, `test`, `vehicle` or `condition` is a key of the spec; any other is a
named parameter of the vehicle. Applied before anything is expanded, `[set]` first, then what the caller
gives. `run.speed_kmh` replaces `run.speed` and the other way round.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from lmap import toml
from lmap.errors import InputProblem, Problem, nearest_hint

SPEC_KEYS = ("condition", "run", "test", "track", "vehicle")
"""First parts of a key that mean the spec."""

_EXAMPLES = {"run": "run.speed_kmh", "test": "test.dip_angle", "track": "track.length"}
"""Tables of the spec, with one of their keys."""

_SAME: dict[tuple[str, ...], tuple[str, ...]] = {
    ("run", "speed"): ("run", "speed_kmh"),
    ("run", "speed_kmh"): ("run", "speed"),
}


def parse(settings: Iterable[str]) -> dict[str, Any]:
    """`KEY=VALUE` texts as keys and values; a value that is no TOML is a text: `run.speed=110% design`."""
    parsed: dict[str, Any] = {}
    problems: list[Problem] = []
    for setting in settings:
        key, equals, text = setting.partition("=")
        key, text = key.strip(), text.strip()
        if not equals or not key or not text:
            found = f'"{setting}"'
            problems.append(Problem(key=("--set",), found=found, allowed="KEY=VALUE, e.g. secondary.kz=5e5"))
            continue
        again = next((one for one in (key, _other_speed(key)) if one in parsed), None)
        if again is not None:
            found = f'"{setting}" after {again}'
            problems.append(
                Problem(key=("--set",), found=found, allowed="each key once, one way of writing it")
            )
            continue
        try:
            parsed[key] = value(text, f"--set {key}")
        except InputProblem as error:
            problems += error.problems
    if problems:
        raise InputProblem(problems)
    return parsed


def _other_speed(key: str) -> str:
    """The other way to write the speed; empty for any other key."""
    return ".".join(_SAME.get(tuple(key.split(".")), ()))


def checked(settings: Any) -> dict[str, Any]:
    """Settings as Python gives them; an `InputProblem` with the key of those that a spec could not write."""
    if not isinstance(settings, Mapping):
        found = f"{type(settings).__name__}"
        raise InputProblem(Problem(key=("set",), found=found, allowed="a mapping of keys to values"))
    found_: dict[str, Any] = toml.plain(settings, "settings", ("set",))
    for key in found_:
        other = _other_speed(key)
        if other and other > key and other in found_:
            allowed = f"one way of writing it: {key} or {other}"
            raise InputProblem(Problem(key=("set", key), found=f'"{key}" and "{other}"', allowed=allowed))
    return found_


def value(text: str, origin: str) -> Any:
    """A value as TOML writes it, else the text itself.

    An `InputProblem`, keys from `origin` on, for what TOML has and a case has not: numbers that are not finite, dates.
    """
    try:
        data = toml.loads(f"value = {text}\n")
    except InputProblem as error:
        if all(one.key[:1] == ("value",) for one in error.problems):
            told = [replace(one, key=(origin, *one.key[1:]), line=None) for one in error.problems]
            raise InputProblem(told) from None
        return text
    return data["value"] if list(data) == ["value"] else text


def is_spec_key(key: str) -> bool:
    """Whether a key means the spec, not a named parameter of the vehicle."""
    return key.partition(".")[0] in SPEC_KEYS


def split(settings: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Settings of the spec, and named parameters of the vehicle."""
    own = {key: value for key, value in settings.items() if is_spec_key(key)}
    return own, {key: value for key, value in settings.items() if key not in own}


def apply(document: Mapping[str, Any], settings: Mapping[str, Any]) -> tuple[dict[str, Any], list[Problem]]:
    """A spec's document with keys of the spec set, and the keys that cannot be."""
    changed: dict[str, Any] = copy.deepcopy(dict(document))
    problems: list[Problem] = []
    for key, setting in settings.items():
        path = tuple(key.split("."))
        if path[0] in ("vehicle", "condition") and len(path) > 1:
            allowed = f'"{path[0]}" alone, or the name of a parameter of the vehicle'
            problems.append(Problem(key=("set", key), found=f'"{key}"', allowed=allowed))
            continue
        if path[0] in _EXAMPLES and (len(path) == 1 or not all(path)):
            allowed = f'a key of [{path[0]}], e.g. "{_EXAMPLES[path[0]]}"'
            hint = nearest_hint(key, ())
            problems.append(Problem(key=("set", key), found=f'"{key}"', allowed=allowed, hint=hint))
            continue
        table = changed
        for step in path[:-1]:
            below = table.setdefault(step, {})
            if not isinstance(below, dict):
                problems.append(
                    Problem(
                        key=("set", key),
                        found=f'"{key}", where "{step}" is no table',
                        allowed="a key in a table",
                    )
                )
                break
            table = below
        else:
            table[path[-1]] = setting
            other = _SAME.get(path)
            if other is not None:
                table.pop(other[-1], None)
    return changed, problems
