"""Profiles of wheels and rails: read, written, examined, smoothed. Millimetres, as their files are."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from lmap import files, toml
from lmap.contact.core import Array, call
from lmap.errors import InputProblem, Problem

Kind = Literal["wheel", "rail"]


@dataclass(frozen=True, slots=True)
class Finding:
    """Something remarkable about a profile."""

    code: str
    """`kink`, `gap`, `doubled_point`, `overhang`, `self_crossing`, `noise`, ..."""
    severity: str
    """`note`, `warning` or `error`."""
    text: str
    index: int | None = None
    """Of the point, where it is about one."""
    place: tuple[float, float] | None = None
    """y, z, mm."""


@dataclass(frozen=True, slots=True, eq=False)
class Profile:
    """A profile: points [y, z] in mm, shape (k, 2), y outward (flange or gauge corner negative), z down.

    A wheel's origin is its running circle, a rail's the top of its upright head.
    """

    points: Array
    kind: Kind | None = None
    name: str = "profile"
    path: Path | None = None
    findings: tuple[Finding, ...] = ()
    """What is remarkable about it, the most serious first."""
    detected: Mapping[str, Any] = field(default_factory=dict)
    """Format, unit, direction as found in the file, each with the reason."""

    @property
    def y(self) -> Array:
        """Positions across, mm."""
        return self.points[:, 0]

    @property
    def z(self) -> Array:
        """Depths, mm."""
        return self.points[:, 1]


@dataclass(frozen=True, slots=True, eq=False)
class Smoothed:
    """The curve that the contact sees; each an array of shape (k,)."""

    y: Array
    """mm."""
    z: Array
    """mm."""
    angle: Array
    """atan2(dz, dy), rad."""
    curvature: Array
    """1/m, positive where the curve turns down (z'' > 0)."""


def read_profile(
    source: str | Path,
    *,
    kind: Kind | None = None,
    format: str | None = None,  # noqa: A002
    unit: str | None = None,
    mirror_y: bool | None = None,
    mirror_z: bool | None = None,
) -> Profile:
    """A profile from a file, or one that ships, by its name.

    Formats: CSV, MiniProf (`.whl`, `.rail`, `.ban`, `.mpt`), SIMPACK and CONTACT (`.prw`, `.prr`), GENSYS
    (`.wheel`, `.rail`), VAMPIRE. Side, unit and direction are detected and said in `detected`; every option
    overrules one of them. `InputProblem` with file and line where it cannot be read, or is plainly of the
    other kind.
    """
    name = str(source)
    path = _find(source)
    options = {"kind": kind, "format": format, "unit": unit, "mirror_y": mirror_y, "mirror_z": mirror_z}
    given = json.dumps({key: value for key, value in options.items() if value is not None})
    try:
        read = json.loads(call(toml.core().inspect_profile, _text(path), path.name, given))
    except InputProblem as error:
        raise InputProblem(
            [_without_name(problem, path.name).at(file=files.shown(path)) for problem in error.problems]
        ) from None
    return Profile(
        points=np.array(read["points"], dtype=np.float64),
        kind=read["kind"],
        name=Path(name).stem if files.PROFILE.is_path(name) else name,
        path=path,
        findings=_findings(read["findings"]),
        detected=read["detected"],
    )


def profile_points(text: str, name: str) -> dict[str, Any]:
    """A profile's points (mm) from the text of its file, as a case holds them."""
    try:
        profile: dict[str, Any] = json.loads(call(toml.core().read_profile, text, name))
    except InputProblem as error:
        full = ("profiles", name)
        raise InputProblem([p if p.key[:2] == full else p.at(prefix=full) for p in error.problems]) from None
    return profile


def write_profile(
    profile: Profile | ArrayLike,
    path: str | Path,
    *,
    kind: Kind | None = None,
    format: str | None = None,  # noqa: A002
    title: str | None = None,
) -> None:
    """Writes points ([y, z], mm) to a file, whole or not at all; the suffix says the format unless `format`
    does.
    """
    path = Path(path)
    points = profile_of(profile, kind)
    options = {"kind": points.kind, "format": format, "title": title}
    given = json.dumps({key: value for key, value in options.items() if value is not None})
    text = call(toml.core().write_profile, json.dumps(points.points.tolist()), path.name, given)
    try:
        files.write(path, text.encode())
    except OSError as error:
        found = f"a place where nothing can be written ({error.strerror})"
        raise InputProblem(
            Problem(file=files.shown(path), found=found, allowed="a file in a folder that exists")
        ) from None


def quality(profile: Profile | ArrayLike, kind: Kind | None = None) -> tuple[Finding, ...]:
    """What is remarkable about points: kinks, gaps, doubled points, overhangs, crossings; the most serious
    first.
    """
    points = profile_of(profile, kind)
    return _findings(
        json.loads(call(toml.core().profile_quality, json.dumps(points.points.tolist()), points.kind))
    )


def smooth(profile: Profile | ArrayLike, kind: Kind | None = None, half_width: float = 1.0) -> Smoothed:
    """The curve that the contact sees: local cubics by least squares over +-`half_width` mm (0.3 to 10).

    z is once continuously differentiable, the curvature continuous.
    """
    points = profile_of(profile, kind)
    if points.kind is None:
        raise InputProblem(Problem(key=("kind",), found="nothing", allowed="wheel, rail"))
    curve = json.loads(
        call(toml.core().smooth_profile, json.dumps(points.points.tolist()), points.kind, half_width)
    )
    return Smoothed(**{name: np.array(values, dtype=np.float64) for name, values in curve.items()})


def profile_of(profile: Profile | ArrayLike, kind: Kind | None = None, name: str = "points") -> Profile:
    """A `Profile` as it is, or points of shape (k, 2) as one."""
    if isinstance(profile, Profile):
        return profile
    try:
        points = np.asarray(profile, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputProblem(
            Problem(key=(name,), found=type(profile).__name__, allowed="points [y, z] in mm, shape (k, 2)")
        ) from None
    if points.ndim != 2 or points.shape[1] != 2:
        raise InputProblem(
            Problem(key=(name,), found=f"shape {points.shape}", allowed="points [y, z] in mm, shape (k, 2)")
        )
    bad = np.argwhere(~np.isfinite(points))
    if len(bad):
        index = tuple(int(i) for i in bad[0])
        raise InputProblem(
            Problem(key=(name, *index), found=f"{points[index]:g}", allowed="a finite number of millimetres")
        )
    return Profile(points=points, kind=kind, name=name)


def _find(source: str | Path) -> Path:
    """The file of a profile: a path, or a name that ships."""
    name = str(source)
    path = Path(name)
    if isinstance(source, Path) or files.PROFILE.is_path(name) or path.suffix or path.is_file():
        return path
    return files.find(files.PROFILE, name, Path.cwd())


def _text(path: Path) -> str:
    """Measuring machines write their notes in any code page: what is no UTF-8 is read as Latin-1, the numbers
    being ASCII.
    """
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return path.read_text(encoding="latin-1")
    except OSError:
        return files.read_text(path, "profile")  # says what is wrong


def _without_name(problem: Problem, name: str) -> Problem:
    """A message of the core says which profile it is about in its key: here the file says it."""
    rest = problem.key[2:] if problem.key[:2] == ("profiles", name) else problem.key
    return Problem(
        found=problem.found, allowed=problem.allowed, key=rest, line=problem.line, hint=problem.hint
    )


def _findings(found: Sequence[Mapping[str, Any]]) -> tuple[Finding, ...]:
    return tuple(
        Finding(
            code=one["code"],
            severity=one["severity"],
            text=one["text"],
            index=one["index"],
            place=None if one["place"] is None else (one["place"][0], one["place"][1]),
        )
        for one in found
    )
