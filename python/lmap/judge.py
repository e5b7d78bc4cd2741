"""From what a spec's cases gave to its verdict."""

from __future__ import annotations

import functools
import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from lmap.errors import JudgementProblem, listed
from lmap.verdict import (
    CaseResult,
    CriterionVerdict,
    Drawing,
    Frames,
    Held,
    SpecVerdict,
    outcome_of,
)

if TYPE_CHECKING:
    import polars as pl
    from pydantic import TypeAdapter

    from lmap.execute.local import CaseOutcome
    from lmap.execute.store import Store
    from lmap.prepare import Prepared


@dataclass(frozen=True)
class _Judged:
    """What reading the frames came to: all that a second check needs."""

    criteria: tuple[CriterionVerdict, ...]
    drawings: tuple[Drawing, ...]


def judge_spec(
    prepared: Prepared, outcomes: Mapping[str, CaseOutcome], store: Store | None = None
) -> SpecVerdict:
    """The spec's verdict; `outcomes` by the hash of the case.

    Frames are read, judged and let go. What came of it is noted in the `store` under everything that it hangs on, and
    taken from there the next time.
    """
    results = {case.label: outcomes[case.hash] for case in prepared.cases}
    key = _key(prepared, results)
    judged = _noted(store, key)
    if judged is None:
        judged = _read(prepared, results)
        if store is not None and key is not None:
            store.write_note(key, _plain(judged))
    return _verdict(prepared, results, judged)


def load() -> None:
    """Imports what judging takes: a second's work, mostly scipy's, that need not wait for the first case to end."""
    import scipy.signal  # noqa: F401

    import lmap.criteria  # noqa: F401

    _adapter()


def _read(prepared: Prepared, results: Mapping[str, CaseOutcome]) -> _Judged:
    from lmap.procedures import Illustrated

    procedure = prepared.procedure
    quantities, troubles = _quantities(prepared, results)
    units = {name: channel.unit for name, channel in prepared.channels.items()}
    criteria = _criteria(prepared, quantities, troubles, units)
    drawings: Sequence[Drawing] = ()
    if isinstance(procedure, Illustrated) and not troubles:
        drawings = procedure.drawings(prepared.spec, quantities, prepared.vehicle.data)
    return _Judged(criteria, tuple(drawings))


class _Frames(Mapping[str, "pl.DataFrame"]):
    """Frames of cases by label, each read when it is asked for; the last one stays at hand, the others are let go."""

    def __init__(self, results: Mapping[str, CaseOutcome]) -> None:
        self._results = results
        self._last: tuple[str, pl.DataFrame] | None = None

    def __getitem__(self, label: str) -> pl.DataFrame:
        import polars as pl

        outcome = self._results[label]
        if self._last is None or self._last[0] != label:
            self._last = None  # before the next one is read
            frame = outcome.frame
            self._last = (label, pl.DataFrame() if frame is None else frame)
        return self._last[1]

    def __iter__(self) -> Iterator[str]:
        return iter(self._results)

    def __len__(self) -> int:
        return len(self._results)


@dataclass(frozen=True, slots=True)
class _AsTheyAre:
    """Frames that are judged as the core recorded them."""

    frames: _Frames

    def frame(self, label: str) -> pl.DataFrame:
        """Channels as the core recorded them."""
        return self.frames[label]

    def quantities(self, label: str) -> pl.DataFrame:
        """The same."""
        return self.frames[label]

    def held(self) -> Mapping[str, Frames]:
        """Nothing to read ahead."""
        return {}


class _Stored:
    """Frames of a spec's cases that are read when somebody asks, and judged quantities made of them."""

    def __init__(self, prepared: Prepared, results: Mapping[str, CaseOutcome]) -> None:
        self._prepared, self._results = prepared, results

    def frame(self, label: str) -> pl.DataFrame:
        """Channels as the core recorded them."""
        return _Frames(self._results)[label]

    def quantities(self, label: str) -> pl.DataFrame:
        """What the criteria judged; takes the frames of all cases."""
        return self.held()[label].quantities(label)

    def held(self) -> Mapping[str, Frames]:
        """All of them, read once, by label; those that are judged as they are one at a time."""
        quantities, _ = _quantities(self._prepared, self._results)
        if isinstance(quantities, _Frames):
            return dict.fromkeys(self._results, _AsTheyAre(quantities))
        frames = _Frames(self._results)
        return {label: Held(frame, quantities.get(label, frame)) for label, frame in frames.items()}


def _verdict(prepared: Prepared, results: Mapping[str, CaseOutcome], judged: _Judged) -> SpecVerdict:
    spec, look = prepared.spec, prepared.look
    units = {name: channel.unit for name, channel in prepared.channels.items()}
    meanings = {name: channel.meaning for name, channel in prepared.channels.items()}
    frames = _Stored(prepared, results)
    cases = tuple(
        CaseResult(
            label=case.label,
            hash=case.hash,
            case=case.data,
            case_json=case.json,
            frames=frames,
            ended=outcome.ended,
            statistics=outcome.statistics,
            units=units,
            meanings=meanings,
            wall_s=outcome.wall_s,
            known_extent=outcome.extent,
        )
        for case, outcome in ((case, results[case.label]) for case in prepared.cases)
    )
    return SpecVerdict(
        id=spec.id,
        title=spec.title,
        file=prepared.loaded.asked.recorded,
        procedure=spec.procedure,
        vehicle=prepared.vehicle.data.name,
        condition=spec.condition or "",
        assumed=spec.assumed or "",
        outcome=outcome_of(judged.criteria),
        criteria=judged.criteria,
        facts=prepared.facts,
        cases=cases,
        inputs=prepared.inputs,
        overrides=prepared.loaded.recorded_settings,
        drawing=None if look is None else look.drawing,
        drawings=judged.drawings,
    )


def _quantities(
    prepared: Prepared, results: Mapping[str, CaseOutcome]
) -> tuple[Mapping[str, pl.DataFrame], dict[str, str]]:
    """What is judged, by label, and why a label cannot be: its run ended early, or the procedure says so.

    Frames that are judged as they are stay where they are until somebody asks.
    """
    troubles = {label: outcome.trouble for label, outcome in results.items() if outcome.trouble is not None}
    good = {label: outcome for label, outcome in results.items() if label not in troubles}
    every = _Frames(results)
    if not good:
        return every, troubles
    complete = _Frames(good)
    try:
        made = prepared.procedure.quantities(prepared.spec, complete, prepared.vehicle.data)
    except JudgementProblem as problem:
        return every, {label: str(problem) for label in good} | troubles
    if made is complete:
        return every, troubles
    order = [*(label for label in results if label in made or label in troubles), *made]
    return {label: made[label] if label in made else every[label] for label in order}, troubles


def _criteria(
    prepared: Prepared,
    quantities: Mapping[str, pl.DataFrame],
    troubles: Mapping[str, str],
    units: Mapping[str, str],
) -> tuple[CriterionVerdict, ...]:
    """Every criterion in every case that it applies to."""
    import polars as pl

    from lmap.criteria import judge, not_assessed

    look = prepared.look
    hashes = {case.label: case.hash for case in prepared.cases}
    judged = quantities if look is None else {look.label: look.frame}
    if look is not None:
        hashes = {look.label: look.hash}
    found = []
    # Case by case, so that one frame at a time is needed; told criterion by criterion.
    for label in judged:
        of = hashes.get(label, "")
        for index, criterion in enumerate(prepared.spec.criterion):
            if not criterion.applies_to(label):
                continue
            if not prepared.vehicle.data.declares(criterion.needs):
                found.append(not_assessed(criterion, index=index, label=label, case_hash=of))
                continue
            why = troubles.get(label)
            verdict = judge(
                criterion, judged[label], units, index=index, label=label, case_hash=of, ended=why
            )
            found.append(verdict)
    for index, criterion in enumerate(prepared.spec.criterion):
        if not any(criterion.applies_to(label) for label in judged):
            why = f"no case is called {listed(criterion.case or ())}: there are {listed(judged, 40)}"
            why = next(iter(troubles.values()), why)
            found.append(judge(criterion, pl.DataFrame(), units, index=index, ended=why))
    found.sort(key=lambda verdict: verdict.index)
    if look is not None:
        found.append(look.by_person)
    return tuple(found)


# ---- notes


def _key(prepared: Prepared, results: Mapping[str, CaseOutcome]) -> str | None:
    """Of the note; none where there is nothing to save or a case gave no result that is kept."""
    from lmap.execute.store import StoredFrame

    if prepared.key is None or not all(isinstance(one.source, StoredFrame) for one in results.values()):
        return None
    return hashlib.sha256(f"judged {prepared.key}".encode()).hexdigest()


def _noted(store: Store | None, key: str | None) -> _Judged | None:
    from pydantic import ValidationError

    plain = None if store is None or key is None else store.note(key)
    if plain is None:
        return None
    try:
        return _adapter().validate_python(plain)
    except ValidationError:
        return None


def _plain(judged: _Judged) -> Any:
    return json.loads(json.dumps(_adapter().dump_python(judged), default=_as_list))


@functools.cache
def _adapter() -> TypeAdapter[_Judged]:
    from pydantic import TypeAdapter

    return TypeAdapter(_Judged)


def _as_list(value: Any) -> Any:
    """Arrays and numbers of numpy as Python's own."""
    return value.tolist()
