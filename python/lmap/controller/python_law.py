"""A control law that is a Python callable, and where `module:function` finds it."""

from __future__ import annotations

import functools
import hashlib
import importlib
import inspect
import sys
import sysconfig
import traceback
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from lmap import files
from lmap.controller.ports import LawFailed, Layout
from lmap.errors import InputProblem, Problem, nearest_hint

Controller = Callable[[float, dict[str, float]], Mapping[str, float | Sequence[float]] | None]
"""`controller(t, seen)` gives `torque` (N m, a number for each wheelset, or one for all), that of single wheelsets and
bogies (`ws1.torque`) and `independent_brake` (Pa), or nothing."""

_ALLOWED = '"module:function": a module.py beside the spec or a module that Python finds, and a function or class in it'


class Running:
    """A callable as the core asks it."""

    def __init__(self, law: Controller, layout: Layout) -> None:
        self._law, self._layout = law, layout

    def sample(self, t: float, period: float, seen: list[float]) -> list[float | None]:
        """The law's answer; a `LawFailed` where it is none."""
        try:
            answer = self._law(t, self._layout.seen(period, seen))
        except (Exception, SystemExit) as error:  # noqa: BLE001 -- whatever a user's code does
            raise LawFailed(told(error)) from None
        return self._layout.arranged(answer)

    def close(self) -> None:
        """Nothing to let go."""


def named(name: str, beside: Path | None = None, parameters: Mapping[str, float] | None = None) -> Controller:
    """The callable that `module:function` names, made anew; an `InputProblem` where there is none.

    A file in the folder `beside` is read afresh at every call, so that two runs share nothing. A class is instantiated
    with the parameters, a function gets them at every call.
    """
    module, function = _split(name)
    path = source(name, beside)
    try:
        holder = importlib.import_module(module) if path is None else _executed(path)
    except (Exception, SystemExit) as error:  # noqa: BLE001 -- whatever a module does
        missing = isinstance(error, ModuleNotFoundError) and error.name in (module, module.split(".")[0])
        why = (
            f"no {module.replace('.', '/')}.py beside the spec and no such module" if missing else told(error)
        )
        raise _problem(name, why) from None
    if not hasattr(holder, function):
        known = [key for key, value in vars(holder).items() if callable(value) and not key.startswith("_")]
        raise _problem(name, f"no {function} in {_shown(path, module)}", nearest_hint(function, known))
    found = getattr(holder, function)
    if not callable(found):
        raise _problem(name, f"{function} in {_shown(path, module)} is no function")
    if not inspect.isclass(found):
        return functools.partial(found, **parameters) if parameters else found
    try:
        law: Any = found(**(parameters or {}))
    except (Exception, SystemExit) as error:  # noqa: BLE001 -- whatever a user's code does
        raise _problem(name, told(error)) from None
    if not callable(law):
        raise _problem(name, f"a {function} cannot be called: it has no __call__")
    made: Controller = law
    return made


def source(name: str, beside: Path | None) -> Path | None:
    """The file beside a spec that `module:function` means; none where Python has to find the module."""
    module, _ = _split(name)
    if beside is None:
        return None
    path = beside.joinpath(*module.split(".")).with_suffix(".py")
    return path if path.is_file() else None


def told(error: BaseException) -> str:
    """An exception in one line: its type, its message, and where in the user's code it was raised."""
    text = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    text = " ".join(text.split())
    if isinstance(error, SyntaxError):  # says where itself
        return text
    libraries = [
        str(Path(__file__).parent),
        *(sysconfig.get_path(kind) for kind in ("stdlib", "purelib", "platlib")),
    ]
    theirs = [
        frame
        for frame in traceback.extract_tb(error.__traceback__)
        if not frame.filename.startswith(("<", *libraries))
    ]
    return f"{text} ({Path(theirs[-1].filename).name}, line {theirs[-1].lineno})" if theirs else text


def _split(name: str) -> tuple[str, str]:
    module, _, function = name.partition(":")
    if not all(part.isidentifier() for part in (*module.split("."), function)):
        raise InputProblem(Problem(found=f'"{name}"', allowed=_ALLOWED))
    return module, function


def _executed(path: Path) -> ModuleType:
    """A module of its own from a file; nothing is written beside it."""
    code = compile(path.read_bytes(), str(path), "exec")
    name = f"lmap_law_{path.stem}_{hashlib.sha256(str(path.resolve()).encode()).hexdigest()[:8]}"
    module = ModuleType(name)
    module.__file__ = str(path)
    sys.modules[name] = module  # dataclasses look there for their module
    exec(code, vars(module))  # the user's own code
    return module


def _shown(path: Path | None, module: str) -> str:
    return module if path is None else files.shown(path)


def _problem(name: str, why: str, hint: str | None = None) -> InputProblem:
    return InputProblem(Problem(found=f'"{name}": {why}', allowed=_ALLOWED, hint=hint))
