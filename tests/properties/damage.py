"""Damage to plain data: any value at any place replaced by another or taken out."""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from typing import Any

import polars as pl
from hypothesis import strategies as st

from lmap.errors import InputProblem
from lmap.execute.local import run_cases
from lmap.simulate import channels, check_case
from lmap.spec.case import Case

Place = tuple[str | int, ...]


def places(node: Any, at: Place = ()) -> list[Place]:
    """Every key and index of the data, as paths from its root."""
    found = [at] if at else []
    if isinstance(node, dict):
        for key, value in node.items():
            found += places(value, (*at, key))
    elif isinstance(node, list):
        for index, value in enumerate(node):
            found += places(value, (*at, index))
    return found


VALUES = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False),
    st.sampled_from(
        [
            0,
            -1,
            1,
            1e-300,
            1e300,
            -0.0,
            True,
            None,
            [],
            {},
            [0.0],
            [[0.0, 0.0, 0.0]],
            {"x": [0, 1], "f": [0, 1]},
        ]
    ),
    st.integers(-(2**53), 2**53),
)


def damaged(data: st.DataObject, good: Any, where: Sequence[Place], words: Sequence[str]) -> Any:
    """A copy of `good` with one to three places spoiled; `words` are texts that the format knows."""
    spoiled = copy.deepcopy(good)
    for _ in range(data.draw(st.integers(1, 3))):
        *path, last = data.draw(st.sampled_from(where))
        node: Any = spoiled
        try:
            for step in path:
                node = node[step]
            if data.draw(st.booleans()):
                # mostly off by a factor, which leaves what can be run
                off = isinstance(node[last], int | float) and data.draw(st.booleans())
                factor = data.draw(st.sampled_from([-1.0, 1e-3, 0.5, 2.0, 1e3])) if off else 0.0
                node[last] = node[last] * factor if off else data.draw(VALUES | st.sampled_from(list(words)))
            else:
                del node[last]
        except (KeyError, IndexError, TypeError):
            continue
    return spoiled


MAY_BE_NAN = ("LV", "contact_y", "sum_LV")
"""Last parts of channels that have no number where a wheel carries nothing."""


def runs_or_is_refused(case: dict[str, Any]) -> bool:
    """Runs a case, where the core takes it: every number of the result is finite, or a message says what went wrong."""
    whole = Case("damaged", case)
    try:
        check_case(whole)
        known = channels(whole)
    except InputProblem:
        return False
    [outcome] = run_cases([whole], jobs=1)
    if not outcome.complete:
        assert outcome.trouble
        assert "internal error" not in outcome.trouble, outcome.trouble
        return False
    assert outcome.frame is not None
    assert len({channel.name for channel in known}) == len(known)
    for name in outcome.frame.select(pl.selectors.float()).columns:
        if name.rpartition(".")[2] not in MAY_BE_NAN:
            bad = [value for value in outcome.frame[name] if not math.isfinite(value)]
            assert not bad, f"{name}: {bad[0]}"
    return True
