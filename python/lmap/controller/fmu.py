"""A control law that is an FMU: FMI 2.0 or 3.0 for co-simulation, through fmpy (`pip install 'lmap[fmu]'`).

At every sample its inputs are set, it does one step of the period, and its outputs act from that sample on: an FMU
whose step is one pass of a sampled law gives the numbers of the same law in Python; one that integrates over its step
gives what it has at the end of the period.
"""

from __future__ import annotations

import contextlib
import os
import tempfile
import xml.etree.ElementTree as ET
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from lmap.controller.ports import LawFailed, Layout, Targets
from lmap.errors import InputProblem, Problem, listed, nearest_hint

_ALLOWED = "an FMU of FMI 2.0 or 3.0 for co-simulation"
_FLOATS = ("Real", "Float64")
"""Type of a number in FMI 2 and 3."""
_ROUNDING = 1e-9
"""Share of a step that is none."""


@dataclass(frozen=True, slots=True)
class Unit:
    """An FMU, read."""

    path: Path
    name: str
    """As the spec writes it."""
    description: Any
    """fmpy's `ModelDescription`."""

    @property
    def version(self) -> int:
        """Major version of FMI."""
        return int(str(self.description.fmiVersion).split(".")[0])

    def variables(self, *causalities: str) -> dict[str, Any]:
        """fmpy's scalar numbers of these causalities, by name."""
        return {
            one.name: one
            for one in self.description.modelVariables
            if one.causality in causalities and one.type in _FLOATS and not getattr(one, "dimensions", None)
        }

    def inputs_of(self, written: Any) -> Any:
        """Inputs as the spec writes them; by default each of the FMU's, by its own name."""
        return list(self.variables("input")) if written is None else written

    def outputs_of(self, written: Any, known: Targets) -> Any:
        """The same for outputs: those that are called as something that can be set."""
        if written is not None:
            return written
        own = self.variables("output")
        found = [name for name in own if name in known]
        if not found:
            names = listed(own) or "no output"
            allowed = f"an FMU with an output called as {listed(known, 20)}; or outputs = {{ NAME = ... }}"
            raise InputProblem(Problem(key=("outputs",), found=f"{names} in {self.name}", allowed=allowed))
        return found

    def check(self, layout: Layout, parameters: Mapping[str, float]) -> None:
        """That the FMU has the variables; an `InputProblem` with each that it has not."""
        problems = []
        for key, causality, names in (
            ("inputs", "input", [name for name, _ in layout.inputs]),
            ("outputs", "output", list(layout.targets)),
            ("parameters", "parameter", list(parameters)),
        ):
            own = self.variables(causality)
            for name in names:
                if name not in own:
                    allowed = (
                        f"an {causality} of {self.name}"
                        if causality != "parameter"
                        else f"a parameter of {self.name}"
                    )
                    allowed += f" that is one number: {listed(own) or 'it has none'}"
                    problems.append(
                        Problem(
                            key=(key, name), found=f'"{name}"', allowed=allowed, hint=nearest_hint(name, own)
                        )
                    )
        if problems:
            raise InputProblem(problems)


def found(name: str, beside: Path) -> Path:
    """The file that the path of an FMU means, seen from the folder `beside`."""
    path = beside / name
    if not path.is_file():
        raise InputProblem(Problem(key=("law",), found=f'"{name}", which is no file', allowed=_ALLOWED))
    return path


def read(path: Path, name: str) -> Unit:
    """An FMU with everything about it that can be wrong before it runs; an `InputProblem` that names it."""
    root, members = _opened(path, name)
    version = str(root.get("fmiVersion"))
    if version.split(".", maxsplit=1)[0] not in ("2", "3"):
        raise _problem(name, f"of FMI {version}")
    if root.find("CoSimulation") is None:
        raise _problem(name, "without co-simulation")
    fmpy = _fmpy(name)
    try:
        description = fmpy.read_model_description(str(path))
    except Exception as error:  # noqa: BLE001 -- what fmpy raises
        raise _problem(name, f"whose modelDescription.xml is not valid: {_line(error)}") from None
    unit = Unit(path, name, description)
    platform = fmpy.platform if unit.version == 2 else fmpy.platform_tuple
    identifier = description.coSimulation.modelIdentifier
    binary = f"binaries/{platform}/{identifier}{fmpy.sharedLibraryExtension}"
    if binary not in members:
        has = sorted(
            {one.split("/")[1] for one in members if one.startswith("binaries/") and one.count("/") > 1}
        )
        raise _problem(name, f"without {binary}: it has binaries for {listed(has) or 'nothing'}")
    return unit


def _opened(path: Path, name: str) -> tuple[ET.Element, list[str]]:
    try:
        with zipfile.ZipFile(path) as archive:
            return ET.fromstring(archive.read("modelDescription.xml")), archive.namelist()
    except (zipfile.BadZipFile, OSError):
        raise _problem(name, "which is no zip archive") from None
    except KeyError:
        raise _problem(name, "without modelDescription.xml") from None
    except ET.ParseError as error:
        raise _problem(name, f"whose modelDescription.xml cannot be read: {error}") from None
    except (zlib.error, RuntimeError) as error:  # damaged; encrypted or packed in an unknown way
        raise _problem(name, f"whose modelDescription.xml cannot be unpacked: {_line(error)}") from None


def _fmpy(name: str) -> ModuleType:
    try:
        import fmpy
    except ImportError:
        found = f'"{name}", and fmpy is not installed'
        allowed = "an FMU where fmpy is: pip install 'lmap[fmu]'"
        raise InputProblem(Problem(key=("law",), found=found, allowed=allowed)) from None
    module: ModuleType = fmpy
    return module


class Running:
    """An instance of an FMU, unpacked into a folder of its own."""

    def __init__(self, unit: Unit, layout: Layout, parameters: Mapping[str, float]) -> None:
        from fmpy.simulation import instantiate_fmu

        self._unit, self._layout = unit, layout
        self._said = ""
        try:
            self._folder = tempfile.TemporaryDirectory(prefix="lmap.fmu.")
        except OSError as error:
            raise _problem(unit.name, f"which cannot be unpacked: {_line(error)}") from None
        self._instance: Any = None
        of = unit.variables("input", "output", "parameter")
        self._inputs = [of[name].valueReference for name, _ in layout.inputs]
        self._outputs = [of[name].valueReference for name in layout.targets]
        at = Path.cwd()  # fmpy leaves it while it loads the library
        try:
            with zipfile.ZipFile(unit.path) as archive:
                archive.extractall(self._folder.name)
            self._instance = instantiate_fmu(
                self._folder.name, unit.description, fmi_type="CoSimulation", logger=self._heard
            )
            self._begin([of[name].valueReference for name in parameters], list(parameters.values()))
        except Exception as error:  # noqa: BLE001 -- what fmpy raises
            self.close()
            raise _problem(unit.name, f"which cannot be started: {self._why(error)}") from None
        finally:
            os.chdir(at)

    def _begin(self, references: Sequence[int], values: Sequence[float]) -> None:
        if self._unit.version == 2:
            self._set(references, values)
            self._instance.setupExperiment(startTime=0.0)
            self._instance.enterInitializationMode()
        else:
            self._instance.enterInitializationMode(startTime=0.0)
            self._set(references, values)
        self._instance.exitInitializationMode()

    def sample(self, t: float, period: float, seen: list[float]) -> list[float | None]:
        """One step of the FMU."""
        given = self._layout.seen(period, seen)
        try:
            self._set(self._inputs, list(given.values()))
            self._step(t, period)
            values = self._get(self._outputs)
        except LawFailed:
            raise
        except Exception as error:  # noqa: BLE001 -- what fmpy raises
            raise LawFailed(self._why(error)) from None
        return self._layout.arranged(dict(zip(self._layout.targets, values, strict=True)))

    def _step(self, t: float, step: float) -> None:
        """A whole step. One of FMI 3 may return early: it goes on from where it says that it has come to."""
        end, nearly = t + step, _ROUNDING * step
        while step > nearly:
            done = self._instance.doStep(t, step)
            if self._unit.version == 2:
                return
            _, terminate, early, reached = done
            if terminate:
                raise LawFailed(f"it asks to end the simulation{self._says()}")
            if not early:
                return
            if not t + nearly < reached <= end + nearly:
                raise LawFailed(f"it returned early from doStep, at {reached:g} s of {t:g} to {end:g} s")
            t, step = reached, end - reached

    def _set(self, references: Sequence[int], values: Sequence[float]) -> None:
        if references:
            write = self._instance.setReal if self._unit.version == 2 else self._instance.setFloat64
            write(list(references), list(values))

    def _get(self, references: Sequence[int]) -> list[float]:
        ask = self._instance.getReal if self._unit.version == 2 else self._instance.getFloat64
        return list(ask(list(references)))

    def _heard(self, *words: Any) -> None:
        """What the FMU logs; its last words go into a message. (The text is the last argument in FMI 2 and 3.)"""
        text = words[-1]
        self._said = " ".join(
            (text.decode(errors="replace") if isinstance(text, bytes) else str(text)).split()
        )

    def _says(self) -> str:
        return f' ("{self._said}")' if self._said else ""

    def _why(self, error: Exception) -> str:
        return f"{_line(error)}{self._says()}"

    def close(self) -> None:
        """Frees the instance and removes the folder."""
        instance, self._instance = self._instance, None
        if instance is not None:
            # one that has failed need not be terminated any more
            with contextlib.suppress(Exception):
                instance.terminate()
            with contextlib.suppress(Exception):
                instance.freeInstance()
        self._folder.cleanup()


def _line(error: Exception) -> str:
    """The first line of an exception."""
    return next(iter(str(error).splitlines()), type(error).__name__).rstrip(".")


def _problem(name: str, why: str) -> InputProblem:
    return InputProblem(Problem(key=("law",), found=f'"{name}", {why}', allowed=_ALLOWED))
