"""The one line: specs -> cases -> frames -> verdicts -> report."""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
import time
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lmap import files
from lmap.errors import InputProblem, JudgementProblem, LmapError, Problem, listed, nearest_hint
from lmap.verdict import Acceptance, CaseResult, CriterionVerdict, Drawing, SpecVerdict, outcome_of

if TYPE_CHECKING:
    import polars as pl

    from lmap.execute.local import CaseOutcome
    from lmap.execute.progress import Progress
    from lmap.prepare import Prepared


def check(
    specs: str | Path | Iterable[str | Path],
    *,
    set: Mapping[str, Any] | None = None,  # noqa: A002 -- named as in specs
    jobs: int | None = None,
    report: str | Path | None = None,
    progress: Progress | None = None,
) -> Acceptance:
    """Simulates and judges specs: files, folders, names (`hunting`) or ids (`2C.1`) of tests that ship.

    `set` overrides keys of the specs and named parameters of their vehicles, `jobs` is the number of threads
    (default: all processors), `report` a folder to write. Every spec is read, expanded and checked before the
    first one runs; an `InputProblem` carries everything that is wrong with any of them.
    """
    begun = time.perf_counter()
    given = [specs] if isinstance(specs, str | Path) else list(specs)
    folder = None if report is None else report_folder(report)
    from lmap.spec import overrides

    prepared = _prepare_all(given, overrides.checked(set or {}))

    from lmap.execute.local import run_cases

    outcomes = run_cases([case for one in prepared for case in one.cases], jobs=jobs, progress=progress)
    verdicts = []
    for one in prepared:
        own, outcomes = outcomes[: len(one.cases)], outcomes[len(one.cases) :]
        verdicts.append(_judge(one, own))
    acceptance = Acceptance(
        specs=tuple(verdicts), version=version(), core=_core(), wall_s=time.perf_counter() - begun
    )
    if folder is not None:
        write_report(acceptance, folder)
    return acceptance


def version() -> str:
    """Of the installed package; `0` where it runs from its sources."""
    from importlib.metadata import PackageNotFoundError
    from importlib.metadata import version as installed

    try:
        return installed("lmap")
    except PackageNotFoundError:
        return "0"


def find_specs(given: str | Path) -> list[Path]:
    """The files that a SPEC argument means: a file, every spec of a folder, or a test by name or id."""
    text, path = str(given), Path(given)
    if path.is_dir() and not path.is_symlink():
        found = sorted(path.glob("*.toml"))
        if not found:
            raise InputProblem(
                Problem(file=files.shown(path), found="a folder without specs", allowed="*.toml in it")
            )
        return found
    if files.SPEC.is_path(text) or isinstance(given, Path):
        if path.is_file():
            return [path]
        raise InputProblem(
            Problem(file=files.shown(path), found="no such file", allowed="a spec file or folder")
        )
    known = shipped()
    for one in known:
        if text == one.stem:
            return [one]
    ids = {spec_id(one): one for one in known}
    if text in ids:
        return [ids[text]]
    words = sorted({one.stem for one in known} | {word for word in ids if word})
    allowed = f"a spec file, a folder, or a test that ships: {listed(words, 40)}"
    raise InputProblem(Problem(found=f'"{text}"', allowed=allowed, hint=nearest_hint(text, words)))


def shipped() -> list[Path]:
    """Every spec that can be called by name from the working folder, sorted; the nearest of a name wins."""
    by_name = {name: files.find(files.SPEC, name, Path.cwd()) for name in files.names(files.SPEC, Path.cwd())}
    return [by_name[name] for name in sorted(by_name)]


def spec_id(path: Path) -> str:
    """The `id` that a spec file says it has; empty where it cannot be read."""
    from lmap import toml

    try:
        return str(toml.load(path, "spec").data.get("id", ""))
    except InputProblem:
        return ""


def _prepare_all(given: Sequence[str | Path], settings: Mapping[str, Any]) -> list[Prepared]:
    from lmap.prepare import prepare

    paths: dict[Path, Path] = {}
    problems: list[Problem] = []
    for one in given:
        try:
            for path in find_specs(one):
                paths.setdefault(path.resolve(), path)
        except InputProblem as error:
            problems += error.problems
    prepared = []
    for path in paths.values():
        try:
            prepared.append(prepare(path, settings))
        except InputProblem as error:
            problems += error.problems
    if problems:
        raise InputProblem(problems)
    if not prepared:
        raise InputProblem(Problem(found="no spec", allowed="at least one SPEC"))
    return prepared


def _judge(prepared: Prepared, outcomes: Sequence[CaseOutcome]) -> SpecVerdict:
    """The spec's verdict on what its cases gave."""
    import polars as pl

    from lmap.procedures import Illustrated

    spec, procedure = prepared.spec, prepared.procedure
    results = {case.label: outcome for case, outcome in zip(prepared.cases, outcomes, strict=True)}
    frames = {
        label: pl.DataFrame() if outcome.frame is None else outcome.frame
        for label, outcome in results.items()
    }
    quantities, troubles = _quantities(prepared, results, frames)
    units = {name: channel.unit for name, channel in prepared.channels.items()}
    criteria = _judged(prepared, quantities, troubles, units)
    drawings: Sequence[Drawing] = ()
    if isinstance(procedure, Illustrated) and not troubles:
        drawings = procedure.drawings(spec, quantities, prepared.vehicle.data)
    cases = tuple(
        CaseResult(
            label=case.label,
            hash=case.hash,
            case=case.data,
            case_json=case.json,
            frame=frames[case.label],
            quantities=quantities.get(case.label, frames[case.label]),
            ended=outcome.ended,
            statistics=outcome.statistics,
            units=units,
            meanings={name: channel.meaning for name, channel in prepared.channels.items()},
            wall_s=outcome.wall_s,
        )
        for case, outcome in zip(prepared.cases, outcomes, strict=True)
    )
    look = prepared.look
    return SpecVerdict(
        id=spec.id,
        title=spec.title,
        file=prepared.loaded.document.shown,
        procedure=spec.procedure,
        vehicle=prepared.vehicle.data.name,
        condition=spec.condition or "",
        outcome=outcome_of(criteria),
        criteria=criteria,
        facts=prepared.facts,
        cases=cases,
        inputs=prepared.inputs,
        overrides=prepared.loaded.settings,
        drawing=None if look is None else look.drawing,
        drawings=tuple(drawings),
    )


def _quantities(
    prepared: Prepared, results: Mapping[str, CaseOutcome], frames: Mapping[str, pl.DataFrame]
) -> tuple[dict[str, pl.DataFrame], dict[str, str]]:
    """What is judged, by label, and why a label cannot be: its run ended early, or the procedure says so."""
    troubles = {label: outcome.trouble for label, outcome in results.items() if outcome.trouble is not None}
    complete = {label: frame for label, frame in frames.items() if label not in troubles}
    early = {label: frames[label] for label in troubles}
    if not complete:
        return early, troubles
    try:
        made = prepared.procedure.quantities(prepared.spec, complete, prepared.vehicle.data)
    except JudgementProblem as problem:
        return dict(frames), {label: str(problem) for label in complete} | troubles
    order = [*(label for label in frames if label in made or label in early), *made]
    return {label: made[label] if label in made else early[label] for label in order}, troubles


def _judged(
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
    judged = dict(quantities) if look is None else {look.label: look.frame}
    if look is not None:
        hashes = {look.label: look.hash}
    found = []
    for index, criterion in enumerate(prepared.spec.criterion):
        labels = [label for label in judged if criterion.applies_to(label)]
        for label in labels:
            if not prepared.vehicle.data.declares(criterion.needs):
                found.append(
                    not_assessed(criterion, index=index, label=label, case_hash=hashes.get(label, ""))
                )
                continue
            verdict = judge(
                criterion,
                judged[label],
                units,
                index=index,
                label=label,
                case_hash=hashes.get(label, ""),
                ended=troubles.get(label),
            )
            found.append(verdict)
        if not labels:
            why = f"no case is called {listed(criterion.case or ())}: there are {listed(judged, 40)}"
            why = next(iter(troubles.values()), why)
            found.append(judge(criterion, pl.DataFrame(), units, index=index, ended=why))
    if look is not None:
        found.append(look.by_person)
    return tuple(found)


def _core() -> str:
    from lmap.simulate import core_version

    return core_version()


def report_folder(given: str | Path, option: str = "--report") -> Path:
    """The folder for a report, if it is one or can become one; asked before anything runs."""
    folder = Path(given)
    nearest = folder.absolute()
    try:
        if folder.exists() and not folder.is_dir():
            raise InputProblem(
                Problem(key=(option,), found=f"{files.shown(folder)}, a file", allowed="a folder")
            )
        while not nearest.exists():
            nearest = nearest.parent
        writable = nearest.is_dir() and os.access(nearest, os.W_OK | os.X_OK)
    except OSError:
        writable = False
    if not writable:
        found = f"{files.shown(folder)}, where nothing can be written"
        raise InputProblem(Problem(key=(option,), found=found, allowed="a folder"))
    return folder


def write_page(path: Path, content: bytes) -> None:
    """One page, whole or not at all; its folder is made where it is missing."""
    created: list[Path] = []
    try:
        _make_folder(path.parent, created)
        files.write(path, content)
    except OSError as error:
        raise LmapError(
            f"the page cannot be written to {files.shown(path)}: {error.strerror or error}"
        ) from error
    finally:
        for one in reversed(created):
            with contextlib.suppress(OSError):  # what holds something stays
                one.rmdir()


def write_report(acceptance: Acceptance, folder: Path) -> None:
    """Writes the report into a folder within `folder`, then moves it up file by file, each whole or not at all.

    Within, not beside: `folder` may be a file system of its own, and what is above it not ours to write. An
    interrupted check leaves what was there before, no folder where there was none. The page comes last.
    """
    from lmap.report import write_report as write

    created: list[Path] = []
    try:
        _make_folder(folder, created)
        partial = Path(tempfile.mkdtemp(prefix=".report.", suffix=".partial", dir=folder))
        try:
            write(acceptance, partial)
            made = sorted(path for path in partial.rglob("*") if path.is_file())
            for path in sorted(made, key=lambda one: one.name == "index.html"):
                target = folder / path.relative_to(partial)
                _make_folder(target.parent, created)
                path.replace(target)
        finally:
            shutil.rmtree(partial, ignore_errors=True)
    except OSError as error:
        raise LmapError(
            f"the report cannot be written to {files.shown(folder)}: {error.strerror or error}"
        ) from error
    finally:
        for one in reversed(created):
            with contextlib.suppress(OSError):  # what holds something stays
                one.rmdir()


def _make_folder(folder: Path, created: list[Path]) -> None:
    """Makes a folder and those above it that are missing, and notes them, the outermost first."""
    missing = []
    while not folder.is_dir():
        missing.append(folder)
        folder = folder.parent
    for one in reversed(missing):
        one.mkdir()
        created.append(one)
