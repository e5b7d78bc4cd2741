"""The specs that ship: a test of the procedure without one, or a number without a source, is red."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

SPECS = sorted((Path(__file__).parents[2] / "specs").glob("*.toml"))
STAGE_1 = ("1.1", "1.2", "1.3a", "1.3b", "1.4", "1.5", "1.6")
STAGE_2 = (
    *("2A.1", "2A.2a", "2A.2b", "2A.2c"),
    *("2B.1a", "2B.1b", "2B.2", "2B.2 run", "2B.3", "2B.4a", "2B.4b"),
    *("2C.1", "2C.2", "2C.3 horizontal", "2C.3 hump", "2C.3 dip", "2C.4a", "2C.4b", "2C.4c", "2C.5"),
    *("2C.6a", "2C.6b kink", "2C.6b dip", "2C.6c", "2C.7a", "2C.7b", "2C.7c", "2C.8", "2C.8 run"),
)
STAGE_3 = ("3T.1", "3T.2", "3T.3", "3T.4", "3T.5", "3B.1", "3B.2", "3B.3", "3B.4")
ALL_OF_LMAP = ("1.1", "1.2", "1.3a", "1.3b", "1.4")
"""Tests whose doing is the procedure's word for word; of all others something is ours."""
PUBLIC = ("LMAP ", "Nadal 1896")
"""How the source of a limit begins that anybody can look up."""


def read(path: Path) -> dict[str, Any]:
    return tomllib.loads(path.read_text(encoding="utf-8"))


def is_judged(criterion: dict[str, Any]) -> bool:
    return any(key in criterion for key in ("max", "max_abs", "min"))


def test_every_test_of_the_procedure_has_a_spec_and_no_two_share_an_id() -> None:
    ids = [str(read(path)["id"]) for path in SPECS]
    assert len(set(ids)) == len(ids)
    assert {*STAGE_1, *STAGE_2, *STAGE_3} <= set(ids)


@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
def test_what_no_public_source_gives_is_marked(path: Path) -> None:
    """The comments of a file do not reach the report; `assumed` and a limit's `source` do."""
    spec = read(path)
    text = path.read_text(encoding="utf-8")
    said = re.findall(r"#.*\b(?:assumed|invented|general knowledge)\b", text, re.IGNORECASE)
    assert "assumed" in spec or (not said and spec["id"] in ALL_OF_LMAP), said
    for criterion in filter(is_judged, spec["criterion"]):
        source = criterion["source"]
        assert source == "assumed" or source.startswith(PUBLIC), (criterion["name"], source)
        assert len(criterion.get("reason", "")) > 20 or source != "assumed", criterion["name"]
