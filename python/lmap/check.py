"""The one line: specs -> cases -> frames -> verdicts -> report."""

from __future__ import annotations

import builtins
import contextlib
import os
import re
import shutil
import tempfile
import threading
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lmap import files
from lmap.errors import InputProblem, LmapError, Problem, listed, nearest_hint
from lmap.verdict import Acceptance, SpecVerdict

if TYPE_CHECKING:
    from lmap.execute.local import CaseOutcome
    from lmap.execute.progress import Progress
    from lmap.execute.store import Store
    from lmap.prepare import Prepared


def check(
    specs: str | Path | Iterable[str | Path],
    *,
    set: Mapping[str, Any] | None = None,  # noqa: A002 -- named as in specs
    jobs: int | None = None,
    report: str | Path | None = None,
    progress: Progress | None = None,
    cache: bool | str | Path = True,
) -> Acceptance:
    """Simulates and judges specs: files, folders, names (`hunting`) or ids (`2C.1`) of tests that ship.

    `set` overrides keys of the specs and named parameters of their vehicles, `jobs` is the number of threads
    (default: all processors), `report` a folder to write. Every spec is read, expanded and checked before the
    first one runs; an `InputProblem` carries everything that is wrong with any of them. Results are kept in
    `LMAP_CACHE_DIR` or the user's cache folder, or in the folder that `cache` names, and found there the next time;
    with `cache=False` everything runs. Frames stay on disk until a case's `frame` or `quantities` is asked for.
    """
    begun = time.perf_counter()
    given = [specs] if isinstance(specs, str | Path) else list(specs)
    folder = None if report is None else report_folder(report)
    from lmap.spec import overrides

    store = open_store(cache)
    prepared = _prepare_all(given, overrides.checked(set or {}), store)
    verdicts = judge_all(prepared, store, jobs=jobs, progress=progress)
    acceptance = Acceptance(
        specs=tuple(verdicts), version=version(), core=_core(), wall_s=time.perf_counter() - begun
    )
    if folder is not None:
        write_report(acceptance, folder)
    return acceptance


def open_store(cache: bool | str | Path) -> Store:
    """Where results are kept: the user's cache, a folder, or with `False` one that is forgotten afterwards."""
    from lmap.execute.store import Store, default_folder

    if cache is False:
        return Store.temporary(_core())
    store = Store(default_folder() if cache is True else Path(cache), _core())
    store.make_room()
    return store


def judge_all(
    prepared: Iterable[Prepared],
    store: Store,
    *,
    jobs: int | None = None,
    progress: Progress | None = None,
    ahead: int | None = None,
    about: int = 1,
    tolerant: bool = False,
) -> list[SpecVerdict]:
    """Runs what is not in the store, all cases of all specs in one pool; each spec is judged as its last case ends.

    Verdicts stand in the order of the specs. With `ahead` so many cases are at hand at a time, and `prepared` is asked
    for the next spec, of `about` that it will give, when a thread is free. Control laws that fail are an `InputProblem`
    in the end; with `tolerant` their cases could not be judged, and that is all.
    """
    from lmap import judge
    from lmap.execute.local import Named, Queue, run_queue

    outcomes: dict[str, CaseOutcome] = {}
    taken: list[Prepared] = []
    waiting: list[builtins.set[str]] = []
    verdicts: dict[int, SpecVerdict] = {}
    several = about > 1 or (isinstance(prepared, Sequence) and len(prepared) > 1)

    def missing() -> Iterator[Named]:
        asked: builtins.set[str] = set()
        for one in prepared:
            new = {case.hash: case for case in one.cases if case.hash not in asked}
            asked |= new.keys()
            for case_hash, case in list(new.items()):
                # what a control law does hangs on code that the case does not hold
                found = None if case.control is not None else store.outcome(case_hash)
                if found is not None:
                    outcomes[case_hash] = found
                    del new[case_hash]
            taken.append(one)
            waiting.append({case.hash for case in one.cases if case.hash not in outcomes})
            for case in new.values():
                yield Named(case, f"{one.spec.id} {case.label}" if several else case.label)

    def settle(position: int) -> None:
        verdicts[position] = _settled(taken[position], outcomes, store)

    def ended(case_hash: str, outcome: CaseOutcome) -> None:
        outcomes[case_hash] = outcome
        for position, left in enumerate(waiting):
            if case_hash in left:
                left.discard(case_hash)
                if not left:
                    settle(position)

    queue = Queue(missing(), ahead=ahead, about=about if ahead is not None else 0)
    if queue.about:
        threading.Thread(target=judge.load).start()  # while the first cases run
    run_queue(queue, jobs=jobs, progress=progress, store=store, known=len(outcomes), heard=ended)
    failed = [
        one.locate(case.label, problem)
        for one in taken
        for case in one.cases
        for problem in outcomes[case.hash].problems
    ]
    if failed and not tolerant:
        raise InputProblem(failed)
    for position in range(len(taken)):
        if position not in verdicts:
            settle(position)
    return [verdicts[position] for position in range(len(taken))]


def _settled(one: Prepared, outcomes: dict[str, CaseOutcome], store: Store) -> SpecVerdict:
    """The verdict; a frame that cannot be read any more is made again."""
    from lmap.execute.local import run_cases
    from lmap.execute.store import LostFrame
    from lmap.judge import judge_spec

    for _ in one.cases:
        try:
            return judge_spec(one, outcomes, store)
        except LostFrame as lost:
            store.drop(lost.case_hash)
            [case] = [case for case in one.cases if case.hash == lost.case_hash][:1]
            [outcomes[case.hash]] = run_cases([case], jobs=1, store=store)
    return judge_spec(one, outcomes, store)


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
        found = in_order(path.glob("*.toml"))
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


def in_order(paths: Iterable[Path]) -> list[Path]:
    """By id, as the procedure has them: numbers count as numbers, so that 2C.10 follows 2C.9."""

    def key(path: Path) -> tuple[list[tuple[int, str]], str]:
        parts = re.findall(r"[0-9]+|[^0-9.]+", spec_id(path))
        return [(int(one), "") if one.isdigit() else (0, one) for one in parts], path.name

    return sorted(paths, key=key)


def spec_id(path: Path) -> str:
    """The `id` that a spec file says it has; empty where it cannot be read."""
    from lmap import toml

    try:
        return str(toml.load(path, "spec").data.get("id", ""))
    except InputProblem:
        return ""


def _prepare_all(
    given: Sequence[str | Path], settings: Mapping[str, Any], store: Store | None = None
) -> list[Prepared]:
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
            prepared.append(prepare(path, settings, store))
        except InputProblem as error:
            problems += error.problems
    if problems:
        raise InputProblem(problems)
    if not prepared:
        raise InputProblem(Problem(found="no spec", allowed="at least one SPEC"))
    return prepared


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
    with _new_folders(f"the page cannot be written to {files.shown(path)}") as created:
        _make_folder(path.parent, created)
        files.write(path, content)


@contextlib.contextmanager
def _new_folders(trouble: str) -> Iterator[list[Path]]:
    """A list for folders that are made, of which those that stay empty are removed; what fails is told as `trouble`."""
    created: list[Path] = []
    try:
        yield created
    except OSError as error:
        raise LmapError(f"{trouble}: {error.strerror or error}") from error
    finally:
        for one in reversed(created):
            with contextlib.suppress(OSError):  # what holds something stays
                one.rmdir()


def write_report(acceptance: Acceptance, folder: Path) -> None:
    """Writes the report into a folder within `folder`, then moves it up file by file, each whole or not at all.

    Within, not beside: `folder` may be a file system of its own, and what is above it not ours to write. A
    check that is interrupted before it is judged leaves what was there before, no folder where there was none. The page
    comes last. A folder holds one report: cases of an earlier one in it are removed, and nothing else.
    """
    from lmap.report import write_report as write

    with _new_folders(f"the report cannot be written to {files.shown(folder)}") as created:
        _make_folder(folder, created)
        partial = Path(tempfile.mkdtemp(prefix=".report.", suffix=".partial", dir=folder))
        try:
            write(acceptance, partial)
            made = sorted(path for path in partial.rglob("*") if path.is_file())
            for path in sorted(made, key=lambda one: one.name == "index.html"):
                target = folder / path.relative_to(partial)
                _make_folder(target.parent, created)
                path.replace(target)
            _remove_cases(folder / "cases", keep={path.name for path in made})
        finally:
            shutil.rmtree(partial, ignore_errors=True)


def _remove_cases(folder: Path, keep: builtins.set[str]) -> None:
    """Removes the cases that another report has left: files that are called by a hash."""
    for path in folder.glob("*.*") if folder.is_dir() else ():
        if path.name not in keep and re.fullmatch(r"[0-9a-f]{64}\.(json|parquet)", path.name):
            with contextlib.suppress(OSError):
                path.unlink()


def _make_folder(folder: Path, created: list[Path]) -> None:
    """Makes a folder and those above it that are missing, and notes them, the outermost first."""
    missing = []
    while not folder.is_dir():
        missing.append(folder)
        folder = folder.parent
    for one in reversed(missing):
        one.mkdir()
        created.append(one)
