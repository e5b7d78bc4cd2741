"""TOML with line numbers: a thin face of the compiled module's parser.

`tomllib` gives no lines; the core's parser keeps the span of every key, so that a message about
`run.friction` can name its line whoever found the fault.
"""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from lmap import files
from lmap.errors import CoreMissing, InputProblem, KeyPath, Problem


def core() -> ModuleType:
    """The compiled module, imported where it is used."""
    try:
        from lmap import _railsim
    except ImportError as error:
        raise CoreMissing(
            f"the compiled module lmap._railsim is missing ({error}): install the package"
        ) from error
    return _railsim


def tables() -> Any:
    """Contact tables that every call into the core shares: of this process, at most 16, without a say in results."""
    return _tables_of(core())


@functools.cache
def _tables_of(railsim: ModuleType) -> Any:
    return railsim.Tables()


@dataclass(frozen=True, slots=True)
class Document:
    """A TOML file: its data, and its text for line numbers."""

    path: Path
    text: str
    data: Mapping[str, Any]

    @property
    def shown(self) -> str:
        """The path as messages show it."""
        return files.shown(self.path)

    @property
    def recorded(self) -> str:
        """The path as reports keep it."""
        return files.recorded(self.path)

    @property
    def sha256(self) -> str:
        """Hash of the text."""
        return files.sha256(self.text)

    def line(self, key: Sequence[str | int]) -> int | None:
        """The line of a key, or of the nearest key above it that is written; none for one that is nowhere."""
        return line_of(self.text, key)

    def locate(self, problem: Problem, key: KeyPath | None = None) -> Problem:
        """The problem with this file's name and line; `key` where the file calls it something else."""
        key = problem.key if key is None else key
        return Problem(
            file=self.shown,
            key=key,
            line=self.line(key),
            found=problem.found,
            allowed=problem.allowed,
            hint=problem.hint,
        )


def loads(text: str) -> dict[str, Any]:
    """The data of a TOML text; an `InputProblem` with the line where it is none.

    With key and line of what TOML has and a case has not: numbers that are not finite, dates.
    """
    railsim = core()
    try:
        data: dict[str, Any] = json.loads(railsim.toml_to_json(text))
    except railsim.InputError as error:
        raise InputProblem(problems_of_core(error)) from None
    return data


def load(path: Path, noun: str) -> Document:
    """A TOML file; an `InputProblem` with file and line where it cannot be read."""
    text = files.read_text(path, noun)
    try:
        return Document(path, text, loads(text))
    except InputProblem as error:
        raise InputProblem([problem.at(file=files.shown(path)) for problem in error.problems]) from None


def json_loads(text: str, noun: str) -> Any:
    """The plain data of a JSON text; an `InputProblem` with the line where it is none."""
    try:
        data = json.loads(text)
    except json.JSONDecodeError as error:
        raise InputProblem(Problem(line=error.lineno, found=f"no JSON: {error.msg}", allowed=noun)) from None
    except RecursionError:
        raise InputProblem(Problem(found=_TOO_DEEP, allowed=noun)) from None
    except ValueError as error:  # a number of more digits than Python reads
        raise InputProblem(Problem(found=f"no JSON: {error}", allowed=noun)) from None
    return plain(data, noun)


def plain(data: Any, noun: str, key: KeyPath = ()) -> Any:
    """A copy of data that JSON can hold; an `InputProblem` with the key of everything that it cannot."""
    problems: list[Problem] = []
    try:
        copy = _plain(data, key, problems)
    except RecursionError:
        raise InputProblem(Problem(found=_TOO_DEEP, allowed=noun, key=key)) from None
    if problems:
        raise InputProblem(problems)
    return copy


_TOO_DEEP = "tables or lists too deep in each other"


def _plain(data: Any, key: KeyPath, problems: list[Problem]) -> Any:
    allowed = "a text, a finite number, true, false, a list or a table"
    if isinstance(data, Mapping):
        problems += [
            Problem(found=f"the key {name!r}", allowed="keys that are texts", key=key)
            for name in data
            if not isinstance(name, str)
        ]
        return {name: _plain(value, (*key, str(name)), problems) for name, value in data.items()}
    if isinstance(data, list | tuple):
        return [_plain(value, (*key, index), problems) for index, value in enumerate(data)]
    if isinstance(data, float):
        if not math.isfinite(data):
            problems.append(Problem(found=str(data), allowed="a finite number", key=key))
        return data
    if isinstance(data, str):
        try:
            data.encode()
        except UnicodeEncodeError:
            problems.append(Problem(found=ascii(data), allowed="a text in Unicode", key=key))
        return data
    if data is not None and not isinstance(data, int):
        problems.append(Problem(found=f"{data!r} of type {type(data).__name__}", allowed=allowed, key=key))
    return data


def line_of(text: str, key: Sequence[str | int]) -> int | None:
    """The 1-based line of the deepest part of a key path that a TOML text has."""
    if not key:
        return None
    line: int | None = core().toml_line(text, list(key))
    return line


def problems_of_core(error: Exception) -> list[Problem]:
    """The faults that a core's `InputError` carries."""
    faults: list[Mapping[str, Any]] = list(getattr(error, "faults", []))
    if not faults:
        return [Problem(found=str(error) or type(error).__name__, allowed="valid input")]
    return [
        Problem(
            found=str(fault["found"]),
            allowed=str(fault["allowed"]),
            key=tuple(fault.get("key") or ()),
            line=fault.get("line"),
            hint=fault.get("hint"),
        )
        for fault in faults
    ]
