"""From `run.controller` in a case to a law that is ready: what can be wrong is found here, before anything runs."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from lmap.controller import fmu, ports, python_law
from lmap.errors import InputProblem, KeyPath, Problem, problems_of_validation
from lmap.simulate import channels
from lmap.spec.case import Case, Control, Sampler

_T = TypeVar("_T")

KEY: KeyPath = ("run", "controller")
_DEFAULT_INPUTS = ("v", "*.slip", ports.PERIOD)
"""What the vehicle's own slip control sees."""


def _names(value: Any) -> Any:
    texts = value.values() if isinstance(value, Mapping) else value
    if not isinstance(value, Mapping | list | tuple) or not all(
        isinstance(one, str) and one for one in texts
    ):
        raise ValueError("a list of names, or a table from the law's own names to them")
    return value


_Names = Annotated[Any, BeforeValidator(_names)]


class Written(BaseModel):
    """`run.controller`; a text alone is its `law`."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    law: str = Field(min_length=1)
    """`module:function`, or the path of an FMU; both seen from the file that names it."""
    inputs: _Names | None = None
    """Channels that it sees."""
    outputs: _Names | None = None
    """What it sets, at every sample; if absent, what it likes."""
    parameters: dict[str, Annotated[float, Field(allow_inf_nan=False)]] = Field(default_factory=dict)
    """Numbers for the law: arguments of the function, parameters of the FMU."""
    sha256: str | None = None
    """Of its file; written by a check."""

    @property
    def is_fmu(self) -> bool:
        """Whether the law is an FMU."""
        return self.law.lower().endswith(".fmu")


def with_controller(case: Case, beside: Path) -> Case:
    """The case with the control law that it names, read and tried; files are seen from the folder `beside`.

    Raises an `InputProblem` whose keys start at the case. A case that is no good itself is left for who checks it.
    """
    run = case.data.get("run")
    written = run.get("controller") if isinstance(run, Mapping) else None
    if not isinstance(run, Mapping) or written is None:
        return case
    try:
        return _bound(case, run, _read(written), beside)
    except InputProblem as error:
        text = isinstance(written, str)
        raise InputProblem(
            [
                one.at(prefix=KEY) if not text or one.key[:1] != ("law",) else replace(one, key=KEY)
                for one in error.problems
            ]
        ) from None


def law_file(case: Case, beside: Path) -> Path | None:
    """The file of the law that a case names; none where Python finds it as a module."""
    return None if case.control is None else _file(_read(case.data["run"]["controller"]), beside)


def _read(written: Any) -> Written:
    try:
        return Written.model_validate({"law": written} if isinstance(written, str) else written)
    except ValidationError as error:
        known: dict[KeyPath, list[str]] = {(): [name for name in Written.model_fields if name != "sha256"]}
        raise InputProblem(problems_of_validation(error.errors(include_url=False), known)) from None


def _bound(case: Case, run: Mapping[str, Any], written: Written, beside: Path) -> Case:
    kind = run.get("kind", "time")
    if kind != "time" or not isinstance(run.get("drive"), Mapping):
        where = "a run without [run.drive]" if kind == "time" else f"a run of kind {kind}"
        allowed = "a control law in a driven run in time: [run.drive], an empty one at least"
        raise InputProblem(Problem(found=f'"{written.law}" in {where}', allowed=allowed))
    named = {**written.model_dump(exclude_none=True), **_sha256(written, beside)}
    nothing = Control(written.law, (), (), _no_start)
    bound = replace(case, data={**case.data, "run": {**run, "controller": named}}, control=nothing)
    try:
        known = [channel.name for channel in channels(bound)]
    except InputProblem:
        return bound  # told by who checks the case
    control = _fmu(written, known, beside) if written.is_fmu else _python(written, known, beside)
    control.start().close()
    return replace(bound, control=control)


def _sha256(written: Written, beside: Path) -> dict[str, str]:
    """Of the law's file, for the case; nothing where Python finds it as a module."""
    path = _file(written, beside)
    try:
        found = None if path is None else hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        why = f'"{written.law}", whose file cannot be read ({error.strerror})'
        raise InputProblem(Problem(key=("law",), found=why, allowed="a readable file")) from None
    if written.sha256 not in (None, found):
        why, allowed = (
            f'"{written.sha256}", not that of {written.law}',
            "the hash of the file, or no such key",
        )
        raise InputProblem(Problem(key=("sha256",), found=why, allowed=allowed))
    return {} if found is None else {"sha256": found}


def _file(written: Written, beside: Path) -> Path | None:
    return (
        fmu.found(written.law, beside)
        if written.is_fmu
        else _at_law(lambda: python_law.source(written.law, beside))
    )


def _at_law(read: Callable[[], _T]) -> _T:
    try:
        return read()
    except InputProblem as error:
        raise InputProblem([one.at(prefix=("law",)) for one in error.problems]) from None


def _python(written: Written, known: Sequence[str], beside: Path) -> Control:
    seen = _DEFAULT_INPUTS if written.inputs is None else written.inputs
    every = ports.targets(known)
    layout = ports.Layout(
        inputs=ports.inputs(seen, known),
        targets=every if written.outputs is None else ports.chosen(written.outputs, every),
        declared=written.outputs is not None,
    )

    def start() -> Sampler:
        return python_law.Running(
            _at_law(lambda: python_law.named(written.law, beside, written.parameters)), layout
        )

    return Control(written.law, layout.channels, layout.outputs, start)


def _fmu(written: Written, known: Sequence[str], beside: Path) -> Control:
    unit = fmu.read(fmu.found(written.law, beside), written.law)
    seen = unit.inputs_of(written.inputs)
    set_ = unit.outputs_of(written.outputs, ports.targets(known))
    layout = ports.Layout(
        inputs=ports.inputs(seen, known), targets=ports.chosen(set_, ports.targets(known)), declared=True
    )
    unit.check(layout, written.parameters)
    return Control(
        written.law, layout.channels, layout.outputs, lambda: fmu.Running(unit, layout, written.parameters)
    )


def _no_start() -> Sampler:
    raise InputProblem(
        Problem(key=KEY, found="a control law that was never read", allowed="a case that was checked")
    )
