"""Hand-made acceptances for the tests of the report: no simulator, fixed numbers."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import polars as pl

from lmap.criteria import Criterion, judge
from lmap.verdict import Acceptance, CaseResult, CriterionVerdict, Fact, Held, InputFile, Outcome, SpecVerdict

LATERAL = Criterion.model_validate(
    {
        "name": "lateral acceleration at the bogie centres",
        "signal": ["carbody.lead_pivot.ay", "carbody.trail_pivot.ay"],
        "chain": [{"lowpass": {"cutoff_hz": 10.0, "order": 4}}, {"average_peak": {"window_s": 5.0}}],
        "unit": "g",
        "max_abs": 0.35,
        "strict": True,
        "source": "AS 7509.1",
        "published": {"anzr1_worn_1": 0.055, "anzr1_worn_2": 0.059},
    }
)
RATIO = Criterion.model_validate(
    {
        "name": "wheel L/V sustained over 2 m",
        "signal": "ws*.LV",
        "chain": [{"sustained": {"window_m": 2.0, "absolute": True}}],
        "unit": "1",
        "max": 1.0,
        "source": "assumed",
        "reason": "no public figure; <Nadal> & friends give 0.9 to 1.2",
    }
)
SHIFT = Criterion.model_validate(
    {
        "name": "lateral displacement of the wheelsets",
        "signal": "ws*.y",
        "chain": [{"max_abs": {}}],
        "unit": "mm",
        "source": "none",
    }
)

UNITS = {"t": "s", "s": "m", "v": "m/s"}


def frame(seed: int, scale: float = 1.0, duration: float = 20.0) -> pl.DataFrame:
    """Channels of two wheelsets and two pivots, 200 samples/s at 35 m/s."""
    random = np.random.default_rng(seed)
    t = np.arange(int(duration * 200) + 1) * 0.005
    columns: dict[str, Any] = {"t": t, "s": 35.0 * t, "v": 35.0 + 0.01 * np.sin(t)}
    for position, pivot in enumerate(("lead", "trail")):
        wave = 0.45 * scale * np.sin(2 * np.pi * (1.1 + 0.1 * position) * t) * (0.6 + 0.4 * np.sin(0.3 * t))
        columns[f"carbody.{pivot}_pivot.ay"] = wave + 0.2 * random.standard_normal(len(t))
    for wheelset in range(1, 7):
        y = 3e-3 * scale * np.sin(2 * np.pi * 0.9 * t + wheelset) + 2e-4 * random.standard_normal(len(t))
        columns[f"ws{wheelset}.y"] = y
        for side, sign in (("left", -1.0), ("right", 1.0)):
            columns[f"ws{wheelset}.{side}.Q"] = 109.5e3 + sign * 4e6 * y
            columns[f"ws{wheelset}.{side}.LV"] = 0.05 + 25.0 * sign * y
    return pl.DataFrame(columns)


def units(table: pl.DataFrame) -> dict[str, str]:
    """By the last part of the name."""
    by_leaf = {"ay": "m/s2", "y": "m", "Q": "N", "LV": "1", **UNITS}
    return {name: by_leaf[name.rsplit(".", 1)[-1]] for name in table.columns}


def case(label: str, seed: int = 1, scale: float = 1.0, duration: float = 20.0, **changes: Any) -> CaseResult:
    """One run to its end."""
    table = frame(seed, scale, duration)
    data = {
        "format": 1,
        "label": label,
        "run": {"kind": "time", "integrator": {"kind": "ros2", "step": 0.0005}, "output_step": 0.005},
        "profiles": {label: {"kind": "wheel", "points": [[float(k), 0.5 * k] for k in range(40)]}},
    }
    text = json.dumps(data, sort_keys=True)
    result = CaseResult(
        label=label,
        hash=hashlib.sha256(text.encode()).hexdigest(),
        case=data,
        case_json=text,
        frames=Held(table, table),
        ended={"kind": "end_of_track", "t": duration, "s": 35.0 * duration, "message": None},
        statistics={"rhs_evaluations": 80000, "steps": 40000, "wall_s": 1.25},
        units=units(table),
        meanings=dict.fromkeys(table.columns, "a meaning"),
        wall_s=1.25,
    )
    return replace(result, **changes)


def judged(*results: CaseResult, criteria: tuple[Criterion, ...] = (LATERAL, RATIO, SHIFT)) -> SpecVerdict:
    """A spec with every criterion judged in every case."""
    verdicts = tuple(
        judge(
            criterion,
            result.quantities,
            result.units,
            index=index,
            label=result.label,
            case_hash=result.hash,
            ended=None if result.complete else str(result.ended["message"]),
        )
        for index, criterion in enumerate(criteria)
        for result in results
    )
    return SpecVerdict(
        id="2C.1",
        title="Hunting",
        file="specs/hunting.toml",
        procedure="hunting",
        vehicle="coco134",
        condition="tare",
        outcome=Outcome.worst(verdict.outcome for verdict in verdicts),
        criteria=verdicts,
        facts=(
            Fact(name="lateral irregularity, extremes", value="+5.12/-4.98 mm", published="+4.553/-4.842 mm"),
            Fact(name="equivalent conicity at 3 mm", value="0.18", case="anzr1_worn_1"),
        ),
        cases=results,
        inputs=(InputFile(role="spec", path="specs/hunting.toml", sha256="0f" * 32),),
        overrides={"secondary.kz": 5e5},
    )


def acceptance(*specs: SpecVerdict) -> Acceptance:
    """With fixed versions."""
    return Acceptance(specs=specs, version="0.1.0", core="0.1.0+abcdef", wall_s=2.5)


@cache
def passing() -> Acceptance:
    """Two cases, everything passes."""
    return acceptance(judged(case("anzr1_worn_1"), case("anzr1_worn_2", seed=2, scale=1.1)))


@cache
def failing() -> Acceptance:
    """One case that hunts."""
    return acceptance(judged(case("anzr1_worn_2", seed=2, scale=12.0)))


@cache
def diverged() -> Acceptance:
    """A run that ended after 3 s."""
    end = {"kind": "diverged", "t": 3.0, "s": 105.0, "message": "diverged at t = 3 s: ws1 left the track"}
    return acceptance(judged(case("anzr1_worn_1", duration=3.0, ended=end)))


@cache
def waiting(outcome: Outcome) -> Acceptance:
    """A criterion that nothing measured can judge."""
    spec = judged(case("anzr1_worn_1"))
    verdict = CriterionVerdict(
        index=3,
        name="visual check",
        case="anzr1_worn_1",
        case_hash=spec.cases[0].hash,
        signals=(),
        signal=None,
        chain=(),
        value=None,
        unit="1",
        limit="",
        bounds=(),
        margin=None,
        margin_percent=None,
        judged=True,
        outcome=outcome,
        source="LMAP 1.2",
        message="waits for a person's sign-off",
    )
    criteria = (*spec.criteria, verdict)
    return acceptance(replace(spec, criteria=criteria, outcome=Outcome.worst(v.outcome for v in criteria)))
