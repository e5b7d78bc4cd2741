"""Vehicle files that take in other files: `include = ["bogie.toml"]`.

Tables are merged key by key, and the including file's value wins; the lists at the top (`[[body]]`, `[[use]]`, ...) are
joined, the included file's items first. An included file may include others. What comes out is one document, in which
every key still knows the file and line where it is written.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lmap import files, toml
from lmap.errors import InputProblem, KeyPath, Problem

_DEEPEST = 8


@dataclass(frozen=True, slots=True)
class Merged(toml.Document):
    """A document with its included files in its data."""

    parts: tuple[toml.Document, ...]
    """The included files, then the file itself."""
    items: Mapping[str, tuple[tuple[toml.Document, int], ...]]
    """Of each joined list the file of every item, and its index there."""

    @property
    def sha256(self) -> str:
        """Hash of all texts."""
        return files.sha256("\0".join(part.text for part in self.parts))

    def locate(self, problem: Problem, key: KeyPath | None = None) -> Problem:
        """The problem with the file and line where its key is written."""
        key = problem.key if key is None else key
        if len(key) > 1 and isinstance(key[1], int) and key[1] < len(self.items.get(str(key[0]), ())):
            document, index = self.items[str(key[0])][key[1]]
            return document.locate(problem, (key[0], index, *key[2:]))
        # The file that has most of the key; of several the one that wins.
        document = max(reversed(self.parts), key=lambda part: _depth(part.data, key))
        return document.locate(problem, key)


def load(path: Path) -> toml.Document:
    """A vehicle file with all that it includes; an `InputProblem` with file and line where that cannot be."""
    document = toml.load(path, "vehicle")
    if "include" not in document.data:
        return document
    parts = _parts(document, (path.resolve(),))
    data: dict[str, Any] = {}
    items: dict[str, tuple[tuple[toml.Document, int], ...]] = {}
    for part in parts:
        for key, value in part.data.items():
            if key == "include":
                continue
            if _is_list_of_tables(value):
                before = data.get(key, [])
                data[key] = [*(before if isinstance(before, list) else []), *value]
                items[key] = (*items.get(key, ()), *((part, index) for index in range(len(value))))
            else:
                data[key] = _over(data.get(key), value)
    return Merged(document.path, document.text, data, parts, items)


def _parts(document: toml.Document, within: tuple[Path, ...]) -> tuple[toml.Document, ...]:
    """All files that a document includes, innermost first, and itself."""
    names = document.data.get("include", [])
    allowed = "a list of vehicle files"
    if not isinstance(names, list):
        raise InputProblem(
            document.locate(Problem(key=("include",), found=_shown(names), allowed=f"{allowed}, in brackets"))
        )
    parts: list[toml.Document] = []
    for index, name in enumerate(names):
        key: KeyPath = ("include", index)
        if not isinstance(name, str):
            raise InputProblem(document.locate(Problem(key=key, found=_shown(name), allowed=allowed)))
        try:
            path = files.find(files.VEHICLE, name, document.path)
        except InputProblem as error:
            raise InputProblem([document.locate(problem, key) for problem in error.problems]) from None
        if path.resolve() in within:
            found = f'"{name}", which includes this file'
            raise InputProblem(document.locate(Problem(key=key, found=found, allowed="no such ring")))
        if len(within) == _DEEPEST:
            found = f"files within files, {_DEEPEST + 1} deep"
            raise InputProblem(document.locate(Problem(key=key, found=found, allowed=f"{_DEEPEST} at most")))
        parts += _parts(toml.load(path, "vehicle"), (*within, path.resolve()))
    return (*parts, document)


def _shown(value: Any) -> str:
    return f'"{value}"' if isinstance(value, str) else str(value)


def _is_list_of_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(item, Mapping) for item in value)


def _over(below: Any, above: Any) -> Any:
    if not (isinstance(below, Mapping) and isinstance(above, Mapping)):
        return above
    return {**below, **{key: _over(below.get(key), value) for key, value in above.items()}}


def _depth(data: Any, key: KeyPath) -> int:
    """How much of a key a document has."""
    for depth, part in enumerate(key):
        if isinstance(data, Mapping) and part in data:
            data = data[str(part)]
        elif isinstance(data, list) and isinstance(part, int) and part < len(data):
            data = data[part]
        else:
            return depth
    return len(key)
