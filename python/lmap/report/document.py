"""The check as one JSON object: `lmap check --json` and `verdicts.json` in a report folder.

Only what the same input gives again goes in: no clock, no wall time, no NaN (null stands for a number that is
not there).
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from lmap.report.runs import without_clocks
from lmap.verdict import Acceptance, CaseResult, CriterionVerdict, SpecVerdict


def document(acceptance: Acceptance) -> dict[str, Any]:
    """Plain data of an acceptance, in a fixed order of keys."""
    return {
        "version": acceptance.version,
        "core": acceptance.core,
        "verdict": str(acceptance.outcome),
        "exit_code": acceptance.exit_code,
        "specs": [_spec(spec) for spec in acceptance.specs],
    }


def to_json(acceptance: Acceptance) -> str:
    """The document as text, ending in a newline."""
    return dumps(document(acceptance)) + "\n"


def dumps(value: Any) -> str:
    """Indented JSON without NaN."""
    return json.dumps(plain(value), indent=2, ensure_ascii=False, allow_nan=False)


def plain(value: Any) -> Any:
    """The value as JSON knows it, copied; numbers that are not finite become null."""
    match value:
        case bool() | None | int():
            return value
        case str():
            return str(value)
        case float():
            return float(value) if math.isfinite(value) else None
        case Mapping():
            return {str(key): plain(item) for key, item in value.items()}
        case Sequence():
            return [plain(item) for item in value]
        case _:
            return str(value)


def _spec(spec: SpecVerdict) -> dict[str, Any]:
    return {
        "id": spec.id,
        "title": spec.title,
        "file": spec.file,
        "verdict": str(spec.outcome),
        "procedure": spec.procedure,
        "vehicle": spec.vehicle,
        "condition": spec.condition,
        "assumed": spec.assumed,
        "overrides": dict(spec.overrides),
        "criteria": [_criterion(criterion) for criterion in spec.criteria],
        "facts": [
            {"name": fact.name, "case": fact.case, "value": fact.value, "published": fact.published}
            for fact in spec.facts
        ],
        "cases": [_case(case) for case in spec.cases],
        "inputs": [{"role": file.role, "path": file.path, "sha256": file.sha256} for file in spec.inputs],
    }


def _criterion(criterion: CriterionVerdict) -> dict[str, Any]:
    return {
        "name": criterion.name,
        "case": criterion.case,
        "case_hash": criterion.case_hash,
        "value": criterion.value,
        "unit": criterion.unit,
        "limit": criterion.limit,
        "margin": criterion.margin,
        "margin_percent": criterion.margin_percent,
        "judged": criterion.judged,
        "verdict": str(criterion.outcome),
        "source": criterion.source,
        "reason": criterion.reason,
        "published": criterion.published,
        "signal": criterion.signal,
        "signals": list(criterion.signals),
        "chain": [dict(link) for link in criterion.chain],
        "at": None if criterion.at is None else dict(criterion.at),
        "message": criterion.message,
    }


def _case(case: CaseResult) -> dict[str, Any]:
    return {
        "label": case.label,
        "hash": case.hash,
        "ended": dict(case.ended),
        "statistics": without_clocks(case.statistics),
    }
