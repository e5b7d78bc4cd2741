"""A case's frame as parquet that explains itself: units, meanings and the case's hash as file metadata.

polars keeps no metadata of columns, so it stands in the file itself: `lmap.channels`, a JSON list of name,
unit and meaning of every column, and `lmap.case`, the hash. Nothing in it depends on when it was written.
"""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from pathlib import Path

from lmap.verdict import CaseResult

CHANNELS_KEY = "lmap.channels"
CASE_KEY = "lmap.case"


ROWS_AT_ONCE = 8192
"""Rows of a row group: what the writer holds encoded in memory at a time."""


def to_parquet(case: CaseResult) -> bytes:
    """The file's bytes."""
    buffer = io.BytesIO()
    write_parquet(case, buffer)
    return buffer.getvalue()


def write_parquet(case: CaseResult, file: Path | io.BytesIO) -> None:
    """The file itself, without a copy of it in memory."""
    frame = case.frame
    frame.write_parquet(
        file,
        compression="zstd",
        row_group_size=ROWS_AT_ONCE,
        metadata={CASE_KEY: case.hash, CHANNELS_KEY: _channels_json(case, frame.columns)},
    )


def channels_json(case: CaseResult) -> str:
    """Name, unit and meaning of every column of the frame, in its order."""
    return _channels_json(case, case.frame.columns)


def _channels_json(case: CaseResult, columns: Sequence[str]) -> str:
    channels = [
        {"name": name, "unit": case.units.get(name, ""), "meaning": case.meanings.get(name, "")}
        for name in columns
    ]
    return json.dumps(channels, ensure_ascii=False)
