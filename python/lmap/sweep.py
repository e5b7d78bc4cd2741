"""One spec over a grid of settings: how criteria and margins move with parameters."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lmap.check import find_specs, judge_all, open_store
from lmap.errors import InputProblem, Problem
from lmap.spec import overrides
from lmap.verdict import CriterionVerdict, Outcome, SpecVerdict

if TYPE_CHECKING:
    import polars as pl

    from lmap.execute.progress import Progress
    from lmap.prepare import Prepared

SAMPLES = 5
"""Values of a range, unless told otherwise."""

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"

AT_ONCE = 256
"""Variants that are held until the last of them has run: a case's text takes 100 kB and more."""
AHEAD = 8
"""Cases that are at hand at a time, of which the longest begins: variants are prepared while others run."""


@dataclass(frozen=True, slots=True)
class Variation:
    """A key and the values that it takes."""

    key: str
    values: tuple[Any, ...]


def variation(text: str, samples: int = SAMPLES) -> Variation:
    """`KEY=A..B` as `samples` values from A to B, `KEY=V1,V2,...` as these; an `InputProblem` where it is neither."""
    key, equals, written = text.partition("=")
    key, written = key.strip(), written.strip()
    if not equals or not key or not written:
        allowed = "KEY=A..B or KEY=V1,V2,..., e.g. secondary.kz=4e5..8e5"
        raise InputProblem(Problem(key=("--vary",), found=f'"{text}"', allowed=allowed))
    span = re.fullmatch(rf"\s*({_NUMBER})\s*\.\.\s*({_NUMBER})\s*", written)
    if span is not None:
        return Variation(key, _between(key, float(span[1]), float(span[2]), samples))
    if ".." in written and "," not in written:
        raise InputProblem(
            Problem(key=(f"--vary {key}",), found=f'"{written}"', allowed="two finite numbers: A..B")
        )
    origin = f"--vary {key}"
    listed = overrides.value(f"[{written}]", origin)
    values = (
        listed
        if isinstance(listed, list)
        else [overrides.value(one.strip(), origin) for one in written.split(",")]
    )
    if "" in values:
        raise InputProblem(
            Problem(key=(f"--vary {key}",), found=f'"{written}"', allowed="a value between commas")
        )
    return Variation(key, tuple(values))


def _between(key: str, first: float, last: float, samples: int) -> tuple[float, ...]:
    if samples < 2 or first == last or not (math.isfinite(first) and math.isfinite(last)):
        found = f"{samples} samples from {first:g} to {last:g}"
        allowed = "2 samples or more, of a range with two ends"
        raise InputProblem(Problem(key=(f"--vary {key}",), found=found, allowed=allowed))
    step = (last - first) / (samples - 1)
    # 12 digits: 0.1 * 3 is written as 0.3, and asked for again it is the same case
    inner = (float(f"{first + step * k:.12g}") for k in range(1, samples - 1))
    return (first, *inner, last)


def grid(variations: Sequence[Variation]) -> list[dict[str, Any]]:
    """Settings of every variant: each value of each key with each of the others, the last key fastest."""
    keys = [one.key for one in variations]
    twice = sorted({key for key in keys if keys.count(key) > 1})
    if twice:
        raise InputProblem(Problem(key=("--vary",), found=f"{twice[0]} twice", allowed="each key once"))
    return [
        dict(zip(keys, values, strict=True))
        for values in itertools.product(*(one.values for one in variations))
    ]


def sweep(
    spec: str | Path,
    vary: Mapping[str, Sequence[Any]],
    *,
    set: Mapping[str, Any] | None = None,  # noqa: A002 -- named as in specs
    jobs: int | None = None,
    progress: Progress | None = None,
    cache: bool | str | Path = True,
) -> pl.DataFrame:
    """Judges a spec for every combination of values: one row for each variant, criterion and case.

    `vary` gives the values by key, of the vehicle's named parameters, the track or the run, as `set` does. Columns:
    `variant` (from 0), the varied keys, `criterion`, `case`, `signal`, `value`, `unit`, `limit`, `limit_min`,
    `limit_max`, `margin` (positive inside the limit), `margin_percent`, `verdict`, `message`. A variant that is no
    valid model or that cannot be judged is a row with the verdict `error`. Raises `InputProblem` where no variant could
    be read at all.
    """
    [path, *others] = find_specs(spec)
    if others:
        raise InputProblem(Problem(found=f"{1 + len(others)} specs", allowed="one spec"))
    variants = grid([Variation(key, tuple(values)) for key, values in vary.items()])
    if not variants:
        raise InputProblem(
            Problem(key=("--vary",), found="no values", allowed="one value or more of each key")
        )
    fixed = overrides.checked(set or {})
    both = sorted(fixed.keys() & vary.keys())
    if both:
        raise InputProblem(
            Problem(key=("--vary",), found=f"{both[0]}, which is set", allowed="either of the two")
        )
    store = open_store(cache)
    faults: dict[int, InputProblem] = {}

    def prepared(numbers: Iterable[int], valid: list[int]) -> Iterator[Prepared]:
        from lmap.prepare import prepare

        for number in numbers:
            try:
                one = prepare(path, overrides.checked({**fixed, **variants[number]}), store)
            except InputProblem as problem:
                faults[number] = problem
            else:
                valid.append(number)
                yield one

    rows: dict[int, list[dict[str, Any]]] = {}
    for begin in range(0, len(variants), AT_ONCE):
        part, valid = range(begin, min(begin + AT_ONCE, len(variants))), list[int]()
        verdicts = judge_all(
            prepared(part, valid),
            store,
            jobs=jobs,
            progress=progress,
            ahead=AHEAD,
            about=len(part),
            tolerant=True,
        )
        for number, found in zip(valid, verdicts, strict=True):
            rows[number] = list(_rows(number, variants[number], found))
    if len(faults) == len(variants):
        raise faults[0]
    rows |= {number: [_fault(number, variants[number], fault)] for number, fault in faults.items()}
    return _table([row for number in sorted(rows) for row in rows[number]], variants)


def _rows(number: int, settings: Mapping[str, Any], spec: SpecVerdict) -> Iterator[dict[str, Any]]:
    for one in spec.criteria:
        yield {
            "variant": number,
            **settings,
            "criterion": one.name,
            "case": one.case,
            "signal": one.signal,
            "value": one.value,
            "unit": one.unit,
            "limit": one.limit,
            **_bounds(one),
            "margin": one.margin,
            "margin_percent": one.margin_percent,
            "verdict": str(one.outcome) if one.judged or one.outcome is not Outcome.PASS else "shown",
            "message": one.message,
        }


def _bounds(one: CriterionVerdict) -> dict[str, float]:
    """The limits as numbers; one alone is told apart by the sign in the limit's text."""
    match one.bounds:
        case (low, high):
            return {"limit_min": low, "limit_max": high}
        case (bound,):
            return {"limit_min" if one.limit.startswith(">") else "limit_max": bound}
        case _:
            return {}


def _fault(number: int, settings: Mapping[str, Any], problem: InputProblem) -> dict[str, Any]:
    return {"variant": number, **settings, "verdict": str(Outcome.ERROR), "message": str(problem)}


def _table(rows: Sequence[Mapping[str, Any]], variants: Sequence[Mapping[str, Any]]) -> pl.DataFrame:
    import polars as pl

    text, number = pl.String(), pl.Float64()
    schema: dict[str, pl.DataType] = {"variant": pl.Int64()}
    for key in variants[0]:
        plain = all(_is_number(settings[key]) for settings in variants)
        schema[key] = number if plain else text
    schema |= {"criterion": text, "case": text, "signal": text, "value": number, "unit": text, "limit": text}
    schema |= {"limit_min": number, "limit_max": number}
    schema |= {"margin": number, "margin_percent": number, "verdict": text, "message": text}
    columns = {
        name: pl.Series(name, [_cell(row.get(name), kind, text) for row in rows], dtype=kind)
        for name, kind in schema.items()
    }
    return pl.DataFrame(columns)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _cell(value: Any, kind: Any, text: Any) -> Any:
    return str(value) if kind == text and value is not None else value
