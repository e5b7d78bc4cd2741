"""From a spec file to cases that are ready to run: what can be wrong is found here, before anything runs."""

from __future__ import annotations

import functools
import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lmap import contact, controller, files, procedures, toml
from lmap.analyse import first_place, vehicle_case
from lmap.criteria.chain import signal_problems
from lmap.errors import InputProblem, KeyPath, Problem, SimulationProblem, listed, nearest_hint
from lmap.procedures.base import (
    CONICITY_AMPLITUDE,
    CaseFigures,
    Deriving,
    Look,
    Looking,
    Procedure,
    Rewriting,
    Set,
)
from lmap.procedures.base import settings as checked_settings
from lmap.simulate import Channel, case_of, channels, check_case, track_extremes
from lmap.spec.case import Case, merged
from lmap.spec.load import LoadedSpec, load
from lmap.spec.measured import record_paths, with_records
from lmap.spec.model import Spec
from lmap.vehicle import Vehicle, located
from lmap.verdict import Fact, InputFile

if TYPE_CHECKING:
    from lmap.execute.store import Store


@dataclass(frozen=True, slots=True, kw_only=True)
class Prepared:
    """A spec with its cases, checked."""

    loaded: LoadedSpec
    spec: Spec
    """With the base track under its `[track]`."""
    vehicle: Vehicle
    procedure: Procedure
    cases: tuple[Case, ...]
    channels: Mapping[str, Channel]
    """What the criteria can judge, by name."""
    facts: tuple[Fact, ...]
    inputs: tuple[InputFile, ...]
    look: Look | None = None
    """What a procedure without cases sees in the vehicle."""
    key: str | None = None
    """Hash of everything that judging hangs on beside the core; none where nothing is simulated."""

    def locate(self, label: str, problem: Problem) -> Problem:
        """A problem of the case of this label, keys from the case on, with file and line where the spec writes it."""
        return self.loaded.locate(_as_written(self.procedure, self.spec, label, problem))


@dataclass(frozen=True, slots=True)
class _Sources:
    """Which file holds which part of a case."""

    loaded: LoadedSpec
    vehicle: Vehicle
    base: toml.Document | None
    profiles: Mapping[str, tuple[Path, str]]
    """Path and text by name."""

    def locate(self, problem: Problem) -> Problem:
        """A problem whose key starts at the case, with the file and line where that part is written."""
        part, rest = (str(problem.key[0]) if problem.key else ""), problem.key[1:]
        if part == "vehicle" and rest:
            found = located(problem, rest, self.vehicle.document, self.loaded.parameters)
            return found if found.file is not None else self.loaded.locate(found)
        if part == "track" and rest and not _is_written(self.loaded, problem.key) and self.base is not None:
            base_key: KeyPath = problem.key if isinstance(self.base.data.get("track"), dict) else rest
            return self.base.locate(problem, base_key)
        if problem.key == ("run", "speed") and not _is_written(self.loaded, problem.key):
            return self.loaded.locate(
                Problem(key=("run", "speed_kmh"), found=problem.found, allowed=problem.allowed)
            )
        if part == "profiles" and rest and rest[0] in self.profiles:
            return problem.at(file=files.shown(self.profiles[str(rest[0])][0]))
        return self.loaded.locate(problem)


def _as_written(procedure: Procedure, spec: Spec, label: str, problem: Problem) -> Problem:
    """A fault of a case under the key that the spec writes."""
    if isinstance(procedure, Rewriting):
        return replace(problem, key=procedure.origin(spec, label, problem.key))
    return problem


def prepare(path: Path, settings: Mapping[str, Any] | None = None, store: Store | None = None) -> Prepared:
    """A spec ready to run; an `InputProblem` with everything that is wrong with it.

    What the core says about cases that it has found good before is taken from the `store`.
    """
    loaded = load(path, settings)
    procedure = _procedure(loaded)
    vehicle = _vehicle(loaded)
    spec, base = _with_base_track(loaded, vehicle)
    spec, outline = _with_outline(loaded, spec)
    _check_settings(loaded, spec, procedure)
    if isinstance(procedure, Looking):
        return _looked_at(loaded, spec, vehicle, procedure, base)
    if spec.sign_off is not None:
        allowed = f"none: procedure {procedure.NAME} waits for nobody"
        raise InputProblem(loaded.locate(Problem(key=("sign_off",), found="a sign-off", allowed=allowed)))
    try:
        cases = procedure.cases(spec, vehicle.data)
    except InputProblem as error:
        raise InputProblem([loaded.locate(problem) for problem in error.problems]) from None
    labels = [case.label for case in cases]
    if len(set(labels)) != len(labels):
        twice = sorted({label for label in labels if labels.count(label) > 1})
        found = f"cases with the same label: {listed(twice)}"
        raise InputProblem(
            loaded.locate(Problem(key=("run",), found=found, allowed="speeds and profiles that differ"))
        )
    profiles, data = _profiles(cases, loaded, vehicle, base)
    try:
        cases = [with_records(case.with_profiles(data), loaded.document.path) for case in cases]
    except InputProblem as error:
        raise InputProblem([loaded.locate(problem) for problem in error.problems]) from None
    sources = _Sources(loaded, vehicle, base, profiles)
    cases = _with_laws(cases, loaded, spec, procedure)
    key = _key(spec, cases)
    noted = None if store is None else _noted(store, key)
    if noted is None:
        known = _checked(spec, cases, sources, procedure)
        _check_signals(loaded, spec, known, vehicle)
        facts = tuple(procedure.facts(spec, [_Figures(case) for case in cases]))
        if store is not None:
            store.write_note(key, [list(known.values()), [asdict(fact) for fact in facts]])
    else:
        known, facts = noted
    return Prepared(
        loaded=loaded,
        spec=spec,
        vehicle=vehicle,
        procedure=procedure,
        cases=tuple(cases),
        channels=known,
        facts=(*facts, *_law_facts(cases)),
        inputs=(
            *_inputs(sources),
            *_outline_input(outline),
            *_records(cases, loaded.document.path),
            *_law_inputs((case, _beside_law(case, loaded, spec, procedure)) for case in cases),
        ),
        key=key,
    )


def _key(spec: Spec, cases: Sequence[Case]) -> str:
    """Hash of spec, cases and the code that reads them."""
    written = [code_fingerprint(), spec.model_dump(mode="json"), [case.hash for case in cases]]
    return files.sha256(json.dumps(written, sort_keys=True))


def _noted(store: Store, key: str) -> tuple[dict[str, Channel], tuple[Fact, ...]] | None:
    """Channels and facts of a spec that was prepared before, word for word."""
    plain = store.note(key)
    if plain is None:
        return None
    channels_, facts = plain
    return {name: Channel(name, unit, meaning) for name, unit, meaning in channels_}, tuple(
        Fact(**fact) for fact in facts
    )


@functools.cache
def code_fingerprint() -> str:
    """Hash of this package's Python and of the libraries that it computes with."""
    package = Path(__file__).parent
    sums = [
        f"{path.relative_to(package).as_posix()} {hashlib.sha256(path.read_bytes()).hexdigest()}"
        for path in sorted(package.rglob("*.py"))
    ]
    sums += [f"{name} {metadata.version(name)}" for name in ("numpy", "polars", "scipy")]
    return files.sha256("\n".join(sums))


def _looked_at(
    loaded: LoadedSpec, spec: Spec, vehicle: Vehicle, procedure: Looking, base: toml.Document | None
) -> Prepared:
    """A spec whose procedure simulates nothing."""
    look = procedure.look(spec, vehicle.data, loaded.parameters)
    known = {name: Channel(name, unit, "") for name, unit in look.units.items()}
    _check_signals(loaded, spec, known, vehicle)
    return Prepared(
        loaded=loaded,
        spec=spec,
        vehicle=vehicle,
        procedure=procedure,
        cases=(),
        channels=known,
        facts=tuple(procedure.facts(spec, [])),
        inputs=_inputs(_Sources(loaded, vehicle, base, {})),
        look=look,
    )


def _procedure(loaded: LoadedSpec) -> Procedure:
    name = loaded.spec.procedure
    procedure = procedures.BY_NAME.get(name)
    if procedure is None:
        hint = nearest_hint(name, procedures.BY_NAME)
        allowed = listed(sorted(procedures.BY_NAME), 40)
        raise InputProblem(
            loaded.locate(Problem(key=("procedure",), found=f'"{name}"', allowed=allowed, hint=hint))
        )
    return procedure


def _with_outline(loaded: LoadedSpec, spec: Spec) -> tuple[Spec, toml.Document | None]:
    """The spec with the reference outline that its `[test]` names in the name's place."""
    name = spec.test.get("outline")
    if not isinstance(name, str):
        return spec, None
    try:
        document = toml.load(files.find(files.OUTLINE, name, loaded.document.path), "outline")
    except InputProblem as error:
        key: KeyPath = ("test", "outline")
        raise InputProblem(
            [p if p.file is not None else loaded.locate(p.at(prefix=key)) for p in error.problems]
        ) from None
    return spec.model_copy(update={"test": {**spec.test, "outline": document.data}}), document


def _check_settings(loaded: LoadedSpec, spec: Spec, procedure: Procedure) -> None:
    """`[test]` against what the procedure knows."""
    try:
        if isinstance(procedure, Set):
            checked_settings(spec, procedure.SETTINGS)
        elif spec.test:
            allowed = f"none: procedure {procedure.NAME} has no numbers of its own"
            raise InputProblem(Problem(key=("test",), found=listed(spec.test), allowed=allowed))
    except InputProblem as error:
        raise InputProblem([loaded.locate(problem) for problem in error.problems]) from None


def _vehicle(loaded: LoadedSpec) -> Vehicle:
    spec = loaded.spec
    try:
        # a path is seen from where it is written: the spec's folder, or the caller's
        from_caller = "vehicle" in loaded.given and files.VEHICLE.is_path(spec.vehicle)
        beside = Path.cwd() if from_caller else loaded.written_in("vehicle")
        vehicle = Vehicle.load(spec.vehicle, beside=beside, overrides=loaded.parameters)
        known = vehicle.data.conditions
        if spec.condition is None:
            return vehicle
        if known and spec.condition not in known:
            hint = nearest_hint(spec.condition, known)
            found, allowed = (
                f'"{spec.condition}"',
                f"a condition of {vehicle.document.shown}: {listed(known)}",
            )
            raise InputProblem(Problem(key=("condition",), found=found, allowed=allowed, hint=hint))
        return vehicle.resolve(loaded.parameters, spec.condition)
    except InputProblem as error:
        # what has no file yet is about a key of the spec: the vehicle's name, an override, the condition
        raise InputProblem(
            [
                problem
                if problem.file is not None
                else loaded.locate(problem.at(prefix=() if problem.key else ("vehicle",)))
                for problem in error.problems
            ]
        ) from None


def _with_base_track(loaded: LoadedSpec, vehicle: Vehicle) -> tuple[Spec, toml.Document | None]:
    """The spec with the base track (`track.base`, else the vehicle's) laid under its own `[track]`."""
    own = dict(loaded.spec.track)
    named_here = "base" in own
    name = own.pop("base", vehicle.data.track)
    if name is None:
        return loaded.spec.model_copy(update={"track": own}), None
    # a path is seen from where it is written: the spec's folder, the caller's, or the vehicle's
    in_spec = Path.cwd() if "track.base" in loaded.given else loaded.document.path
    beside = in_spec if named_here else vehicle.document.path
    key: KeyPath = ("track", "base") if named_here else ("track",)
    owner = loaded if named_here else vehicle.document
    if not isinstance(name, str):
        raise InputProblem(
            owner.locate(Problem(key=key, found=str(name), allowed="the name of a track, in quotes"))
        )
    try:
        document = toml.load(files.find(files.TRACK, name, beside), "track")
    except InputProblem as error:
        raise InputProblem(
            [p if p.file is not None else owner.locate(p.at(prefix=key)) for p in error.problems]
        ) from None
    written = document.data.get("track", document.data)
    return loaded.spec.model_copy(update={"track": merged(written, own)}), document


def _profiles(
    cases: Sequence[Case], loaded: LoadedSpec, vehicle: Vehicle, base: toml.Document | None
) -> tuple[dict[str, tuple[Path, str]], dict[str, Any]]:
    """Path and text, and the data for the case, of every profile that the cases name."""
    found: dict[str, tuple[Path, str]] = {}
    data: dict[str, Any] = {}
    problems: list[Problem] = []
    for case in cases:
        for name, key in case.profile_names.items():
            if name in data:
                continue
            from_caller = ".".join(map(str, key)) in loaded.given and files.PROFILE.is_path(name)
            places = _places(key, loaded, vehicle, base)
            try:
                path = first_place(name, [Path.cwd(), *places] if from_caller else places)
                text = files.read_text(path, "profile")
            except InputProblem as error:
                problems += [p if p.file else loaded.locate(p.at(prefix=key)) for p in error.problems]
                continue
            found[name] = (path, text)
            try:
                points = contact.profile_points(text, name)
            except InputProblem as error:
                problems += [problem.at(file=files.shown(path)) for problem in error.problems]
                continue
            data[name] = {"kind": "wheel" if key[-1] == "wheel_profile" else "rail", **points}
    if problems:
        raise InputProblem(problems)
    return found, data


def _places(key: KeyPath, loaded: LoadedSpec, vehicle: Vehicle, base: toml.Document | None) -> Sequence[Path]:
    """Where a profile is looked for: from the file that names it, then from the others."""
    written_in = [loaded.document.path, vehicle.document.path, *([base.path] if base is not None else [])]
    if _is_written(loaded, key):
        return written_in
    named_by = base if key[0] == "track" and base is not None else vehicle.document
    return list(dict.fromkeys([named_by.path, *written_in]))


def _checked(
    spec: Spec, cases: Sequence[Case], sources: _Sources, procedure: Procedure
) -> dict[str, Channel]:
    """The channels that any case gives and those that are derived, after the core has checked every case."""

    def told(case: Case, problem: Problem) -> Problem:
        """A fault of a case where the spec writes it, or the file that does."""
        return sources.locate(_as_written(procedure, spec, case.label, problem))

    known: dict[str, Channel] = {}
    problems: list[Problem] = []
    asked: set[str] = set()
    for case in cases:
        try:
            check_case(case)
            alike = _names_hang_on(case)
            if alike in asked:
                continue
            asked.add(alike)
            # compiles the model, and knows more: names of coordinates, of bodies
            for channel in channels(case):
                known.setdefault(channel.name, channel)
        except InputProblem as error:
            problems += [told(case, problem) for problem in error.problems]
    if problems:
        raise InputProblem(problems)
    added = dict(procedure.UNITS)
    if isinstance(procedure, Deriving):
        added |= procedure.derived(spec, {name: channel.unit for name, channel in known.items()})
    return known | {name: Channel(name, unit, "") for name, unit in added.items()}


def _names_hang_on(case: Case) -> str:
    """The case less its speed and irregularity: cases differ in them, the names of channels do not."""
    run = {key: value for key, value in case.data["run"].items() if key != "speed"}
    track = {key: value for key, value in case.data["track"].items() if key != "irregularity"}
    part = {key: value for key, value in case.data.items() if key not in ("label", "profiles")}
    return json.dumps({**part, "run": run, "track": track}, sort_keys=True)


def _check_signals(loaded: LoadedSpec, spec: Spec, known: Mapping[str, Channel], vehicle: Vehicle) -> None:
    units = {name: channel.unit for name, channel in known.items()}
    problems = [
        loaded.locate(problem.at(prefix=("criterion", index)))
        for index, criterion in enumerate(spec.criterion)
        if vehicle.data.declares(criterion.needs)
        for problem in signal_problems(criterion, units)
    ]
    if problems:
        raise InputProblem(problems)


class _Figures(CaseFigures):
    """What is shown beside the verdicts, asked of the core once a procedure asks; what it cannot say is left out."""

    def __init__(self, case: Case) -> None:
        object.__setattr__(self, "case", case)

    @functools.cached_property
    def track_extremes(self) -> Mapping[str, tuple[float, float]]:
        """Least and largest deviation by name, m."""
        try:
            return track_extremes(self.case)
        except SimulationProblem:
            return {}

    @functools.cached_property
    def conicity(self) -> float | None:
        """Equivalent conicity at `CONICITY_AMPLITUDE`."""
        try:
            return contact.equivalent_conicity(self.case, CONICITY_AMPLITUDE)
        except SimulationProblem:
            return None


def _inputs(sources: _Sources) -> tuple[InputFile, ...]:
    documents = [("spec", sources.loaded.asked), ("vehicle", sources.vehicle.document)]
    if sources.loaded.variant is not None:
        documents.insert(1, ("spec", sources.loaded.document))
    if sources.base is not None:
        documents.append(("track", sources.base))
    inputs = [InputFile(role=role, path=doc.recorded, sha256=doc.sha256) for role, doc in documents]
    for path, text in sources.profiles.values():
        inputs.append(InputFile(role="profile", path=files.recorded(path), sha256=files.sha256(text)))
    return tuple(inputs)


def _records(cases: Sequence[Case], beside: Path) -> list[InputFile]:
    """The measured tracks of all cases."""
    found: dict[Path, str] = {}
    for case in cases:
        for path in record_paths(case, beside).values():
            found.setdefault(path, hashlib.sha256(path.read_bytes()).hexdigest())
    return [
        InputFile(role="measured track", path=files.recorded(path), sha256=sha) for path, sha in found.items()
    ]


def _beside_law(case: Case, loaded: LoadedSpec, spec: Spec, procedure: Procedure) -> Path:
    """The folder that a case's control law is seen from: that of the file that names it, or the caller's."""
    named = Problem(key=("run", "controller", "law"), found="", allowed="")
    key = _as_written(procedure, spec, case.label, named).key
    if key == named.key and loaded.given & {"run.controller", "run.controller.law"}:
        return Path.cwd()
    return loaded.written_in(".".join(map(str, key[:2]))).parent


def _with_laws(cases: Sequence[Case], loaded: LoadedSpec, spec: Spec, procedure: Procedure) -> list[Case]:
    """The cases with the control laws that they name."""
    found: list[Case] = []
    problems: list[Problem] = []
    for case in cases:
        try:
            found.append(controller.with_controller(case, _beside_law(case, loaded, spec, procedure)))
        except InputProblem as error:
            told = (_as_written(procedure, spec, case.label, problem) for problem in error.problems)
            problems += [loaded.locate(problem) for problem in told]
    if problems:
        raise InputProblem(problems)
    return found


def _law_facts(cases: Sequence[Case]) -> list[Fact]:
    value = "{}: run anew by every check, in this process; its result is never kept"
    return [
        Fact(name="control law", value=value.format(case.control.name), case=case.label)
        for case in cases
        if case.control is not None
    ]


def _law_inputs(cases: Iterable[tuple[Case, Path]]) -> list[InputFile]:
    """The files of all control laws, of cases and the folders that they are seen from."""
    found = {}
    for case, beside in cases:
        path = controller.law_file(case, beside)
        if path is not None:
            sha256 = case.data["run"]["controller"]["sha256"]
            found[path] = InputFile(role="control law", path=files.recorded(path), sha256=sha256)
    return list(found.values())


def _outline_input(outline: toml.Document | None) -> tuple[InputFile, ...]:
    if outline is None:
        return ()
    return (InputFile(role="outline", path=outline.recorded, sha256=outline.sha256),)


def _is_written(loaded: LoadedSpec, key: KeyPath) -> bool:
    """Whether the spec itself, or a setting, writes a key or the table's entry that it lies in."""
    dotted = ".".join(map(str, key[:2]))
    table = loaded.document.data.get(str(key[0]), {})
    if any(setting == dotted or setting.startswith(f"{dotted}.") for setting in loaded.settings):
        return True
    return isinstance(table, dict) and len(key) > 1 and key[1] in table


def load_case(path: Path) -> Case:
    """A case from a file, JSON or the same keys in TOML, checked by the core."""
    document = toml.load(path, "case") if path.suffix == ".toml" else None
    try:
        if document is not None:
            case = case_of(document.data, path.stem)
        else:
            case = case_of(toml.json_loads(files.read_text(path, "case"), "a case"), path.stem)
        case = controller.with_controller(with_records(case, path), path.parent)
        check_case(case)
    except InputProblem as error:
        raise InputProblem(
            [
                p
                if p.file is not None
                else (document.locate(p) if document is not None else p.at(file=files.shown(path)))
                for p in error.problems
            ]
        ) from None
    return case


def vehicle_channels(name: str) -> list[Channel]:
    """The channels that a vehicle's runs record: those of a short case on its own base track."""
    vehicle = Vehicle.load(name)
    run = {
        "kind": "time",
        "speed": vehicle.data.design_speed,
        "integrator": {"kind": "heun", "step": 0.001},
        "output_step": 0.005,
    }
    case = vehicle_case(vehicle.data, vehicle.document.path, run, label="channels", track={"length": 100.0})
    try:
        return channels(case)
    except InputProblem as error:
        raise InputProblem(
            [
                located(problem, problem.key[1:], vehicle.document, {})
                if problem.key[:1] == ("vehicle",)
                else problem
                for problem in error.problems
            ]
        ) from None
