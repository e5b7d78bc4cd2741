"""Criteria: what is judged, how, and against which limit."""

from __future__ import annotations

from lmap.criteria.chain import (
    Criterion,
    Stage,
    chain_problems,
    expand,
    is_constant,
    judge,
    not_assessed,
    signal_problems,
    trace,
)

__all__ = [
    "Criterion",
    "Stage",
    "chain_problems",
    "expand",
    "is_constant",
    "judge",
    "not_assessed",
    "signal_problems",
    "trace",
]
