"""Exceptions of the package, and the exit codes that the command line makes of them.

Messages about input name the file, the key path, the line where the file gives one, what was found and what
is allowed. All faults of an input are collected before anything is raised.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

EXIT_PASS = 0
"""Everything passed."""
EXIT_FAIL = 1
"""A criterion failed, or waits for a person or for data."""
EXIT_ERROR = 2
"""Bad input, or something could not be judged."""
EXIT_INTERRUPTED = 130
"""Stopped by Ctrl-C (128 + SIGINT, as shells count)."""

KeyPath = tuple[str | int, ...]
"""Keys and indices from the root of a document."""


def key_text(key: Sequence[str | int]) -> str:
    """A key path as people write it: `criterion[1].chain[0].lowpass`, `set."secondary.kz"`."""
    text = ""
    for step in key:
        if isinstance(step, int):
            text += f"[{step}]"
        elif not text:
            text = step
        else:
            text += f'."{step}"' if "." in step else f".{step}"
    return text


def nearest(word: str, known: Iterable[str]) -> str | None:
    """The known word most like `word`, if any is like it at all."""
    close = difflib.get_close_matches(word, list(known), n=1, cutoff=0.6)
    return close[0] if close else None


def nearest_hint(word: str, known: Iterable[str]) -> str | None:
    """`did you mean "x"?`, or nothing."""
    best = nearest(word, known)
    return None if best is None else f'did you mean "{best}"?'


def listed(words: Iterable[str], most: int = 12) -> str:
    """Words in a row, cut after `most` of them."""
    words = list(words)
    shown = ", ".join(words[:most])
    return shown if len(words) <= most else f"{shown}, ... ({len(words)} in all)"


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """One fault in what the user wrote."""

    found: str
    allowed: str
    file: str | None = None
    key: KeyPath = ()
    line: int | None = None
    hint: str | None = None

    def __str__(self) -> str:
        where = self.file or ""
        if self.line is not None:
            where += f":{self.line}" if where else f"line {self.line}"
        place = ": ".join(part for part in (where, key_text(self.key)) if part)
        text = f"found {self.found}; allowed: {self.allowed}"
        if place:
            text = f"{place}: {text}"
        return f"{text} ({self.hint})" if self.hint else text

    def at(self, *, file: str | None = None, prefix: KeyPath = (), line: int | None = None) -> Problem:
        """The same fault seen from further out: file, keys in front, line."""
        return replace(
            self,
            file=self.file if file is None else file,
            key=(*prefix, *self.key),
            line=self.line if line is None else line,
        )


class LmapError(Exception):
    """Base of everything that this package raises on purpose."""

    exit_code = EXIT_ERROR


class InputProblem(LmapError):
    """Bad input: every fault that was found, one per line."""

    def __init__(self, problems: Problem | Iterable[Problem]) -> None:
        self.problems: tuple[Problem, ...] = (
            (problems,) if isinstance(problems, Problem) else tuple(dict.fromkeys(problems))
        )
        super().__init__("\n".join(str(problem) for problem in self.problems))


class SimulationProblem(LmapError):
    """A case that the core could not run, with the core's own message."""


class JudgementProblem(LmapError):
    """A signal that cannot be judged: NaN, too short, missing, sampled too slowly."""


class CoreMissing(LmapError):
    """The compiled module `lmap._railsim` is not there."""


def problems_of_validation(
    errors: Iterable[Mapping[str, Any]], known: Mapping[KeyPath, Sequence[str]] | None = None
) -> list[Problem]:
    """Faults from pydantic's `ValidationError.errors()`, in our words.

    `known` names the keys allowed in a table, by the table's key path (indices as 0); it gives the nearest
    known key.
    """
    problems = []
    for error in errors:
        key: KeyPath = tuple(error["loc"])
        kind, context = error["type"], error.get("ctx", {})
        found = _shown(error.get("input"))
        allowed = str(error["msg"]).removeprefix("Value error, ").removeprefix("Assertion failed, ")
        hint = None
        if kind == "extra_forbidden":
            table = tuple(0 if isinstance(step, int) else step for step in key[:-1])
            names = sorted((known or {}).get(table, ()))
            found, allowed = f'an unknown key "{key[-1]}"', listed(names, 30) or "no such key"
            hint = nearest_hint(str(key[-1]), names)
        elif kind == "missing":
            found, allowed = "nothing", "a value: the key is required"
        elif kind in ("greater_than", "greater_than_equal", "less_than", "less_than_equal"):
            sign = {
                "greater_than": ">",
                "greater_than_equal": ">=",
                "less_than": "<",
                "less_than_equal": "<=",
            }[kind]
            limit = context.get("gt", context.get("ge", context.get("lt", context.get("le"))))
            allowed = f"a number {sign} {limit:g}" if isinstance(limit, int | float) else allowed
        else:
            allowed = _PLAIN.get(kind, allowed[:1].lower() + allowed[1:])
        problems.append(Problem(found=found, allowed=allowed, key=key, hint=hint))
    return problems


_PLAIN = {
    "string_type": "a text in quotes",
    "float_type": "a number",
    "float_parsing": "a number",
    "int_type": "a whole number",
    "int_parsing": "a whole number",
    "bool_type": "true or false",
    "dict_type": "a table",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "list_type": "a list",
    "tuple_type": "a list",
    "finite_number": "a finite number",
}


def _shown(value: object) -> str:
    """A found value as the user would recognise it."""
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Mapping):
        return f"a table with {listed(map(str, value), 6)}" if value else "an empty table"
    if isinstance(value, list | tuple):
        return (
            f"a list of {len(value)}" if len(value) > 4 else f"[{', '.join(_shown(item) for item in value)}]"
        )
    return "nothing" if value is None else str(value)
