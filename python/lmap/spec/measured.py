"""Measured tracks: the one part of a case that stays outside it, by path and SHA-256.

The core opens no file. An irregularity `{ kind = "measured", file = "line.csv" }` is read here, CSV as it is and
parquet made CSV, and its text goes to the core beside the case.
"""

from __future__ import annotations

import hashlib
import io
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from lmap import files
from lmap.errors import InputProblem, KeyPath, Problem
from lmap.spec.case import Case

NOUN = "CSV or parquet"


def with_records(case: Case, beside: Path) -> Case:
    """The case with the SHA-256 of every measured track that it names, and their texts beside it.

    A file is seen from the file or folder `beside`. Raises `InputProblem` for one that is not there, that is neither
    CSV nor parquet, or whose SHA-256 is not the one that is written.
    """
    track = case.data.get("track")
    written = track.get("irregularity") if isinstance(track, Mapping) else None
    if track is None or written is None:
        return case
    alone = isinstance(written, Mapping)
    texts: dict[str, str] = {}
    problems: list[Problem] = []
    found: list[Any] = []
    for index, entry in enumerate([written] if alone else written if isinstance(written, list) else []):
        key: KeyPath = ("track", "irregularity") if alone else ("track", "irregularity", index)
        if not (isinstance(entry, Mapping) and entry.get("kind") == "measured" and _is_file(entry)):
            found.append(entry)
            continue
        try:
            sha256, text = _read(entry, beside)
        except InputProblem as error:
            problems += [problem.at(prefix=key) for problem in error.problems]
            continue
        texts[str(entry["file"])] = text
        found.append({**entry, "sha256": sha256})
    if problems:
        raise InputProblem(problems)
    if not texts:
        return case
    irregularity = found[0] if alone else found
    return replace(case, data={**case.data, "track": {**track, "irregularity": irregularity}}, texts=texts)


def record_paths(case: Case, beside: Path) -> dict[str, Path]:
    """The files of the measured tracks that a case has the texts of, by what the case calls them."""
    return {name: _path(name, beside) for name in case.texts}


def _is_file(entry: Mapping[str, Any]) -> bool:
    return isinstance(entry.get("file"), str) and "text" not in entry


def _path(name: str, beside: Path) -> Path:
    return (beside if beside.is_dir() else beside.parent) / name


def _read(entry: Mapping[str, Any], beside: Path) -> tuple[str, str]:
    """SHA-256 of the bytes, and the text as CSV."""
    path = _path(str(entry["file"]), beside)
    try:
        data = path.read_bytes()
    except OSError as error:
        reason = "which is no file" if not path.exists() else f"which cannot be read ({error.strerror})"
        found = f'"{entry["file"]}", {reason}'
        raise InputProblem(Problem(key=("file",), found=found, allowed=f"a {NOUN} file")) from None
    sha256 = hashlib.sha256(data).hexdigest()
    if entry.get("sha256", sha256) != sha256:
        found = f'"{entry["sha256"]}" where {files.shown(path)} has {sha256}'
        raise InputProblem(
            Problem(key=("sha256",), found=found, allowed="the hash of the file, or no such key")
        )
    return sha256, _parquet(data, entry) if path.suffix == ".parquet" else _csv(data, entry)


def _csv(data: bytes, entry: Mapping[str, Any]) -> str:
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        found = f'"{entry["file"]}", with bytes that are no UTF-8 text (at {error.start})'
        raise InputProblem(Problem(key=("file",), found=found, allowed=f"a {NOUN} file")) from None


def _parquet(data: bytes, entry: Mapping[str, Any]) -> str:
    import polars as pl

    try:
        return pl.read_parquet(io.BytesIO(data)).write_csv()
    except (pl.exceptions.PolarsError, OSError):
        found = f'"{entry["file"]}", which is no parquet'
        raise InputProblem(Problem(key=("file",), found=found, allowed=f"a {NOUN} file")) from None
