"""A wheelset on its track: where it touches, and what follows from that."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, fields, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from lmap import files, toml
from lmap.contact.core import POISSON, POSITIVE, Array, broadcast, call, columns, refuse
from lmap.contact.patch import POISSON_RATIO, YOUNGS_MODULUS, NonElliptic, hertz, non_elliptic
from lmap.contact.profile import Kind, Profile, profile_of, read_profile
from lmap.errors import InputProblem, Problem, SimulationProblem, listed, nearest_hint

Roll = Literal["level", "free"]
"""Whether a shifted wheelset stays level or rolls until both wheels touch."""

METHODS = {
    "integration": "the wavelength of the kinematic motion, by integrating twice (EN 15302)",
    "regression": "two-step linear regression of the rolling radius difference (EN 15302)",
    "harmonic": "first harmonic of the rolling radius difference",
}
"""How an equivalent conicity is found."""

Normal = Literal["hertz", "kik_piotrowski"]
"""How a patch is found from its gap."""

NORMALS: tuple[Normal, ...] = ("hertz", "kik_piotrowski")

TREAD, FLANGE, FLANGE_BACK = 0, 1, 2
"""Parts of a wheel, as in `Contacts.part`."""

_FAR = 0.02
"""No flange lies further from its rail, m."""


@dataclass(frozen=True, slots=True, eq=False)
class Contacts:
    """Contacts of both wheels, a row each: arrays of one shape (k,).

    Side coordinates: y outward from the track centre, z down; for both sides.
    """

    y: Array
    """Shift of the wheelset to the right, m."""
    side: Array
    """-1 left, 1 right."""
    rank: Array
    """0 the first, by gap (rigid) or from the field side (under load)."""
    part: Array
    """`TREAD`, `FLANGE` or `FLANGE_BACK`."""
    roll: Array
    """Of the wheelset, right side down, rad."""
    z: Array
    """Depth of the axle's centre below its nominal height, m."""
    gap: Array
    """Along the common normal, m; 0 where it touches, negative under load."""
    y_rail: Array
    """On the rail, from its origin, m."""
    z_rail: Array
    """On the rail, below its top, m."""
    y_wheel: Array
    """On the wheel, from its running circle, m."""
    z_wheel: Array
    """On the wheel, below its running circle, m."""
    x: Array
    """Ahead of the axle, m."""
    angle: Array
    """Contact angle, rad, positive on the flange side."""
    radius: Array
    """Rolling radius, m."""
    k_xx: Array
    """Relative curvature along the rail, 1/m."""
    k_yy: Array
    """Relative curvature across, of the points that touch, 1/m."""
    normal: Array
    """Normal force, N; NaN without a load."""
    a: Array
    """Semi-axis of the patch along rolling, m; NaN without a load."""
    b: Array
    """Semi-axis across, m; NaN without a load."""
    curvature: Array
    """Relative curvature across that the patch was computed with, 1/m; NaN without a load."""
    spread: Array
    """How far from an ellipse: 0 for Hertz, beyond 0.5 it is none; NaN without a load."""

    def __len__(self) -> int:
        return len(self.y)

    def where(self, mask: Array) -> Contacts:
        """The rows that a boolean array of shape (k,) chooses."""
        return Contacts(**{part.name: getattr(self, part.name)[mask] for part in fields(self)})


class Pair:
    """A wheelset on a track, by direct search: rigid and elastic contact at any shift.

    `wheel` and `rail` are a `Profile`, points ([y, z] in mm, shape (k, 2)), a path or a name that ships;
    lengths in m:

    - `gauge`, measured `gauge_point_depth` below the top of the rail;
    - `inclination` of the rails towards the track centre, as a slope (0.05 for 1:20, 0 where the profile is
      drawn inclined);
    - `flange_back`, between the backs of the flanges, and from there to the running circle
      `tape_from_flange_back`;
    - `radius` of the running circle.

    `left` (`{"wheel": ..., "rail": ..., "radius": ...}`, any of them) sets the left side apart. `InputProblem`
    for a profile of the wrong side or in another unit, one that crosses itself, and a gauge that lets the
    wheelset fall in or that it does not fit.
    """

    def __init__(
        self,
        wheel: Profile | ArrayLike | str,
        rail: Profile | ArrayLike | str,
        *,
        gauge: float = 1.435,
        gauge_point_depth: float = 0.014,
        inclination: float = 0.0,
        flange_back: float = 1.360,
        tape_from_flange_back: float = 0.070,
        radius: float = 0.460,
        left: dict[str, Any] | None = None,
        smoothing: float = 1e-3,
        youngs_modulus: float = YOUNGS_MODULUS,
        poisson: float = POISSON_RATIO,
    ) -> None:
        self.wheel = _profile(wheel, "wheel")
        """Of the right side."""
        self.rail = _profile(rail, "rail")
        """Of the right side, upright."""
        self.radius = radius
        self.gauge = gauge
        self.inclination = inclination
        self.youngs_modulus, self.poisson = youngs_modulus, poisson
        numbers = {
            "gauge": gauge,
            "gauge_point_depth": gauge_point_depth,
            "rail_inclination": inclination,
            "flange_back_distance": flange_back,
            "tape_from_flange_back": tape_from_flange_back,
            "smoothing": smoothing,
            "youngs_modulus": youngs_modulus,
            "poisson": poisson,
        }
        other = left or {}
        for key in other.keys() - {"wheel", "rail", "radius"}:
            hint = nearest_hint(key, ("wheel", "rail", "radius"))
            raise InputProblem(
                Problem(key=("left", key), found="an unknown key", allowed="wheel, rail, radius", hint=hint)
            )
        arrays, _ = broadcast({**numbers, "radius": radius, "left.radius": other.get("radius", radius)})
        positive = dict.fromkeys(
            ("radius", "left.radius", "gauge", "flange_back_distance", "smoothing"), POSITIVE
        )
        refuse(arrays, {**positive, "youngs_modulus": POSITIVE, "poisson": POISSON})
        sides = {
            "left": (
                _profile(other.get("wheel", self.wheel), "wheel"),
                _profile(other.get("rail", self.rail), "rail"),
            )
        }
        radii = {"left": other.get("radius", radius), "right": radius}
        if other:
            sides["right"] = (self.wheel, self.rail)
        self._mirrored = not other
        self._profiles = {
            (side, kind): profile
            for side, pair in sides.items()
            for kind, profile in zip(("wheel", "rail"), pair, strict=True)
        }
        written = {
            side: {"wheel": wheel.points.tolist(), "rail": rail.points.tolist(), "radius": radii[side]}
            for side, (wheel, rail) in sides.items()
        }
        self.json = json.dumps({**numbers, **written})
        """As the core has it."""
        self._stands()

    def rolling_radius_difference(self, y: ArrayLike, *, roll: Roll = "level") -> Array:
        """Rolling radius of the right wheel less that of the left (m) at shifts to the right (m, any shape).

        NaN where a wheel would stand beside its rail or on the end of a profile. `roll="level"` keeps the axle
        level, as the reference curves of EN 15302 do; `"free"` lets it roll until both wheels touch, which
        gives 3 to 5 % more on round heads.
        """
        arrays, shape = broadcast({"y": y})
        refuse(arrays, {})
        found = self._call(toml.core().rolling_radius_difference, arrays["y"].ravel().tolist(), _free(roll))
        return _numbers(found, shape)

    def conicity(self, amplitude: ArrayLike, *, method: str = "integration", roll: Roll = "level") -> Array:
        """Equivalent conicity tan(gamma_e) by EN 15302 at lateral amplitudes (m, any shape, half of peak to
        peak).

        `method` is one of `METHODS`. NaN where there is no oscillation of that amplitude.
        """
        _known(method)
        arrays, shape = broadcast({"amplitude": amplitude})
        refuse(arrays, {"amplitude": POSITIVE})
        amplitudes = arrays["amplitude"].ravel().tolist()
        found = self._call(toml.core().pair_conicity, amplitudes, method, _free(roll))
        return _numbers(found, shape)

    def contacts(
        self,
        y: ArrayLike,
        *,
        yaw: float = 0.0,
        roll: Roll = "free",
        load: float | None = None,
        rail_shift: tuple[float, float] = (0.0, 0.0),
        rail_roll: tuple[float, float] = (0.0, 0.0),
    ) -> Contacts:
        """Every contact of both wheels at shifts to the right (m, any shape), a row each.

        Without `load` rigid: up to three closest places of a wheel, the first of which touches. With it (N,
        vertical, of each wheel) elastic: up to three patches, Hertz each. `yaw` in rad, right-handed.
        `rail_shift` (m, outward) and `rail_roll` (rad, field side down) move the left and the right rail.
        Shifts at which a wheel does not stand have no rows.
        """
        arrays, _ = broadcast({"y": y})
        given = {**arrays, "yaw": np.float64(yaw), **({} if load is None else {"load": np.float64(load)})}
        refuse({name: np.asarray(value) for name, value in given.items()}, {"load": POSITIVE})
        shifts = arrays["y"].ravel().tolist()
        frame = self._call(
            toml.core().contact_map,
            shifts,
            yaw,
            _free(roll),
            load,
            tuple(rail_shift),
            tuple(rail_roll),
        )
        return Contacts(**columns(frame, (part.name for part in fields(Contacts))))

    def flange_play(self) -> tuple[float, float]:
        """Shifts (m) at which the left and the right flange come to bear: the first negative, the second positive.

        The first contact of that wheel, rigid and with the axle rolling until both wheels touch, is none of its tread
        from there on (contact angle 0.35 rad and more). NaN where there is no such place within 20 mm.
        """
        right = self._bears(1.0)
        return -(right if self._mirrored else self._bears(-1.0)), right

    def patch(
        self,
        y: float = 0.0,
        *,
        side: Literal["left", "right"] = "right",
        load: float = 1e5,
        normal: Normal = "kik_piotrowski",
    ) -> NonElliptic:
        """The patch of one wheel at a shift (m) under a normal force `load` (N): outline, pressure, area, approach.

        `normal="kik_piotrowski"` takes the gap itself about the place that touches first, in the pose of the rigid
        wheelset, rolled until both wheels touch (`non_elliptic`); `"hertz"` the ellipse of the curvature that the most
        loaded patch of `contacts` has. For analysis: runs know Hertz alone.
        """
        values, _ = broadcast({"y": y, "load": load})
        refuse(values, {"load": POSITIVE})
        for key, word, known in (("side", side, ("left", "right")), ("normal", normal, NORMALS)):
            if word not in known:
                raise InputProblem(
                    Problem(
                        key=(key,), found=f'"{word}"', allowed=listed(known), hint=nearest_hint(word, known)
                    )
                )
        if normal == "hertz":
            return self._hertz(y, -1.0 if side == "left" else 1.0, load)
        gap = columns(self._call(toml.core().contact_gap, y, side == "right", 0.03, 2e-5))
        return non_elliptic(
            gap["s"],
            gap["gap"],
            curvature=float(gap["k_xx"][int(np.argmin(np.abs(gap["s"])))]),
            force=load,
            youngs_modulus=self.youngs_modulus,
            poisson=self.poisson,
        )

    def _hertz(self, y: float, side: float, load: float) -> NonElliptic:
        found = self.contacts(y, load=load)
        found = found.where(found.side == side)
        if not len(found):
            allowed = "a shift at which both wheels stand"
            raise InputProblem(
                Problem(key=("y",), found=f"{y:g} m, where a wheel leaves its rail", allowed=allowed)
            )
        main = int(np.argmax(found.normal))
        k_x, k_y = float(found.k_xx[main]), float(found.curvature[main])
        ellipse = hertz(load, k_x, k_y, youngs_modulus=self.youngs_modulus, poisson=self.poisson)
        a, b = float(ellipse.a), float(ellipse.b)
        across = b * np.sin(np.linspace(-0.5 * np.pi, 0.5 * np.pi, 181))
        return NonElliptic(
            approach=float(ellipse.approach),
            force=load,
            max_pressure=float(ellipse.max_pressure),
            area=math.pi * a * b,
            origin=0.0,
            a=a,
            b=b,
            y=across,
            half_length=a * np.sqrt(np.maximum(1.0 - (across / b) ** 2, 0.0)),
        )

    def _call(self, function: Any, *arguments: Any) -> Any:
        """A function of the core on this pair; what is wrong with a profile is said of its file."""
        try:
            return call(function, self.json, *arguments)
        except InputProblem as error:
            raise InputProblem([self._placed(problem) for problem in error.problems]) from None

    def _placed(self, problem: Problem) -> Problem:
        profile = (
            self._profiles.get((str(problem.key[0]), str(problem.key[1]))) if len(problem.key) > 1 else None
        )
        if profile is None:
            # the core calls the rest as a case does: track.gauge
            inside_case = problem.key[:1] in (("track",), ("vehicle",))
            return replace(problem, key=problem.key[-1:]) if inside_case else problem
        if profile.path is None:
            return replace(problem, key=(profile.name, *problem.key[2:]))
        return replace(problem, file=files.shown(profile.path), key=problem.key[2:])

    def _bears(self, direction: float) -> float:
        # a level axle is found fast, and bears later than one that rolls
        _, high = self._bracket(direction, 0.0, _FAR, "level", 1e-4)
        _, high = self._bracket(direction, 0.0, high + 5e-4, "free", 1e-6)
        return high

    def _bracket(
        self, direction: float, low: float, high: float, roll: Roll, width: float
    ) -> tuple[float, float]:
        """Shifts around the first flange contact of a side, as close as asked; NaN where there is none."""
        while high - low > width:
            shifts = np.linspace(low, high, 21)
            found = self.contacts(direction * shifts, roll=roll)
            first = found.where((found.side == direction) & (found.rank == 0.0) & (found.part != TREAD))
            if not len(first):
                return math.nan, math.nan
            at = int(np.argmin(np.abs(shifts - float(np.abs(first.y).min()))))
            low, high = float(shifts[max(at - 1, 0)]), float(shifts[at])
        return low, high

    def _stands(self) -> None:
        """Refuses a gauge between which, or on which, the centred wheelset does not stand on its treads."""
        try:
            found = self.contacts(0.0, roll="level")
        except SimulationProblem as error:
            raise InputProblem(
                Problem(found=str(error), allowed="a wheelset that stands on its rails")
            ) from None
        shown = f"{1e3 * self.gauge:.6g} mm"
        if len(found) == 0:
            raise InputProblem(
                Problem(
                    key=("gauge",),
                    found=f"{shown}, at which the wheelset does not stand: it falls in between the rails, "
                    "or a profile ends first",
                    allowed="a gauge at which both wheels stand on their rails",
                    hint="see flange back, wheel profile width and the unit",
                )
            )
        first = found.part[found.rank == 0]
        if len(first) == 2 and bool((first != TREAD).all()):
            raise InputProblem(
                Problem(
                    key=("gauge",),
                    found=f"{shown}, at which both flanges stand on the rails",
                    allowed="a gauge between which the flanges have room",
                    hint="see flange back and gauge",
                )
            )


def curve_conicity(
    y: ArrayLike, difference: ArrayLike, amplitude: ArrayLike, *, method: str = "integration"
) -> Array:
    """Equivalent conicity at amplitudes (m, any shape) of a rolling radius difference given by points (m,
    shape (k,), y rising).

    As `Pair.conicity`, for curves from elsewhere: measured, or of a standard.
    """
    _known(method)
    curve, _ = broadcast({"y": y, "difference": difference})
    amplitudes, shape = broadcast({"amplitude": amplitude})
    refuse({**curve, **amplitudes}, {"amplitude": POSITIVE})
    lists = (array.ravel().tolist() for array in (curve["y"], curve["difference"], amplitudes["amplitude"]))
    return _numbers(call(toml.core().curve_conicity, *lists, method), shape)


def _profile(source: Profile | ArrayLike | str, kind: Kind) -> Profile:
    from pathlib import Path

    if isinstance(source, str | Path):
        return read_profile(source, kind=kind)
    profile = profile_of(source, kind, name=kind)
    if profile.kind not in (None, kind):
        raise InputProblem(
            Problem(key=(kind,), found=f"the profile of a {profile.kind}", allowed=f"that of a {kind}")
        )
    return profile


def _free(roll: str) -> bool:
    if roll not in ("level", "free"):
        raise InputProblem(
            Problem(
                key=("roll",),
                found=f'"{roll}"',
                allowed="level, free",
                hint=nearest_hint(roll, ("level", "free")),
            )
        )
    return roll == "free"


def _known(method: str) -> None:
    if method not in METHODS:
        hint = nearest_hint(method, METHODS)
        raise InputProblem(Problem(key=("method",), found=f'"{method}"', allowed=listed(METHODS), hint=hint))


def _numbers(values: list[float | None], shape: tuple[int, ...]) -> Array:
    """What the core has no number for is NaN."""
    return np.array([np.nan if value is None else value for value in values], dtype=np.float64).reshape(shape)
