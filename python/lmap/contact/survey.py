"""What is asked of a pair of profiles, all at once: the figures behind `lmap contact`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from lmap.contact.convergence import GRIDDED, Convergence, grid_convergence
from lmap.contact.core import POSITIVE, Array, refuse
from lmap.contact.laws import CreepForces, creep_forces, law_of
from lmap.contact.pair import FLANGE, Contacts, Pair
from lmap.contact.patch import NonElliptic
from lmap.errors import InputProblem, Problem, SimulationProblem

AMPLITUDES = np.arange(1.0, 7.01, 0.1) * 1e-3
"""Amplitudes of the conicity, m."""

FALLING: Mapping[str, tuple[float, dict[str, Any], dict[str, float]]] = {
    "dry": (0.47, {"kind": "polach", "k_a": 0.6, "k_s": 0.15}, {"ratio": 0.44, "decay": 0.7}),
    "wet": (0.30, {"kind": "polach", "k_a": 0.29, "k_s": 0.09}, {"ratio": 0.38, "decay": 0.1}),
}
"""Friction at standstill, law and falling friction: Spiryagin et al., Proc. IMechE F 227 (2013), Table 4."""


@dataclass(frozen=True, slots=True, eq=False)
class CreepCurve:
    """Creep force over creepage, one law."""

    law: str
    longitudinal: Array
    """-Fx/N over `Survey.creepage`."""
    lateral: Array
    """-Fy/N over `Survey.creepage`."""
    spin: Array
    """-Fy/N over `Survey.spin`."""


@dataclass(frozen=True, slots=True, eq=False)
class Survey:
    """A pair examined; SI."""

    pair: Pair
    load: float
    """Normal force of a wheel, N."""
    friction: float
    speed: float
    """m/s."""
    flange_play: tuple[float, float]
    """Shifts at which the flanges bear, m."""
    shift: Array
    """m."""
    level: Array
    """Rolling radius difference over `shift` with the axle level, m."""
    free: Array
    """The same with the axle rolling until both wheels touch, m."""
    amplitude: Array
    """m."""
    conicity: Mapping[str, Array]
    """Over `amplitude`, by method."""
    contacts: Contacts
    """Rigid, at shifts of whole half millimetres."""
    patches: Contacts
    """Of both wheels of the centred wheelset under the load."""
    non_elliptic: NonElliptic | None
    """Of the right wheel of the centred wheelset; none where its gap gives none."""
    creepage: Array
    spin: Array
    """1/m."""
    curves: tuple[CreepCurve, ...]
    traction_creepage: Array
    traction: Mapping[str, Array]
    """-Fx/N over `traction_creepage`, by rail condition or law."""
    convergence: tuple[Convergence, ...]
    """FASTSIM, FaStrip and every other law asked for that has a grid, in the patch of the right wheel."""

    @property
    def centred(self) -> Contacts:
        """The first contact of the right wheel of the centred wheelset."""
        found = self.contacts
        return found.where((found.y == 0.0) & (found.side == 1.0) & (found.rank == 0.0))

    @property
    def flange_angle(self) -> float:
        """Greatest contact angle on the flange within the shifts examined, rad; NaN without flange contact."""
        on_flange = self.contacts.angle[(self.contacts.part == FLANGE) & (self.contacts.rank == 0.0)]
        return float(on_flange.max()) if len(on_flange) else float("nan")

    def at(self, amplitude: float, method: str = "integration") -> float:
        """Conicity at an amplitude (m) among those examined."""
        return float(self.conicity[method][int(np.argmin(np.abs(self.amplitude - amplitude)))])


def survey(
    pair: Pair,
    *,
    laws: Sequence[str] = ("fastsim", "polach", "kalker_linear"),
    friction: float = 0.3,
    load: float = 1e5,
    speed: float = 22.0 / 3.6,
) -> Survey:
    """Everything about a pair: `load` is the vertical force of a wheel (N), `speed` (m/s) that of the traction
    curves.
    """
    written = {law: law_of(law, pair.poisson) for law in laws}
    given = {"friction": friction, "load": load, "speed": speed}
    rules = {"friction": POSITIVE, "load": POSITIVE, "speed": POSITIVE}
    refuse({name: np.asarray(value, dtype=np.float64) for name, value in given.items()}, rules)
    play = pair.flange_play()
    reach = float(np.nanmax(np.abs(play))) if np.isfinite(play).any() else 0.008
    shift = _shifts(reach + 0.0015, 1e-4)
    half = _shifts(reach + 0.001, 5e-4)
    patches = pair.contacts(0.0, load=load)
    right = _main(patches)
    creepage, spin = np.linspace(0.0, 0.02, 161), np.linspace(0.0, 4.0, 81)
    traction_creepage = np.concatenate([np.linspace(0.0, 0.02, 81), np.linspace(0.0225, 0.3, 112)])
    return Survey(
        pair=pair,
        load=load,
        friction=friction,
        speed=speed,
        flange_play=play,
        shift=shift,
        level=pair.rolling_radius_difference(shift),
        free=pair.rolling_radius_difference(shift, roll="free"),
        amplitude=AMPLITUDES,
        conicity={
            method: pair.conicity(AMPLITUDES, method=method) for method in ("integration", "regression")
        },
        contacts=pair.contacts(half),
        patches=patches,
        non_elliptic=_non_elliptic(pair, load),
        creepage=creepage,
        spin=spin,
        curves=tuple(_curve(law, written[law], right, creepage, spin, friction, pair) for law in laws),
        traction_creepage=traction_creepage,
        traction=_traction(
            right, traction_creepage, pair, speed, friction, written[laws[0]] if laws else None
        ),
        convergence=_convergence(laws, right, friction, pair),
    )


def _shifts(reach: float, step: float) -> Array:
    """Whole multiples of a step to either side, 0 among them exactly."""
    count = math.ceil(reach / step)
    return np.arange(-count, count + 1, dtype=np.float64) * step


def _main(patches: Contacts) -> Contacts:
    """The most loaded patch of the right wheel."""
    rows = np.flatnonzero(patches.side == 1.0)
    if not len(rows):
        raise InputProblem(
            Problem(
                key=("load",),
                found="a load under which the centred wheelset does not stand",
                allowed="a smaller one",
            )
        )
    best = rows[int(np.argmax(patches.normal[rows]))]
    return patches.where(np.arange(len(patches)) == best)


def _non_elliptic(pair: Pair, load: float) -> NonElliptic | None:
    try:
        return pair.patch(0.0, load=load)
    except (InputProblem, SimulationProblem):
        return None  # two patches far apart, or an end of a profile within the patch: the figures of Hertz stand alone


def _forces(
    law: Mapping[str, Any], patch: Contacts, mu: float, pair: Pair, *creepage: Any, **more: Any
) -> CreepForces:
    a, b, n = (float(values[0]) for values in (patch.a, patch.b, patch.normal))
    shear_modulus = pair.youngs_modulus / (2.0 * (1.0 + pair.poisson))
    return creep_forces(
        law, *creepage, a=a, b=b, n=n, mu=mu, shear_modulus=shear_modulus, poisson=pair.poisson, **more
    )


def _curve(
    name: str, law: Mapping[str, Any], patch: Contacts, creepage: Array, spin: Array, mu: float, pair: Pair
) -> CreepCurve:
    n = float(patch.normal[0])
    return CreepCurve(
        law=name,
        longitudinal=-_forces(law, patch, mu, pair, creepage).fx / n,
        lateral=-_forces(law, patch, mu, pair, 0.0, creepage).fy / n,
        spin=-_forces(law, patch, mu, pair, 0.0, 0.0, spin).fy / n,
    )


def _convergence(laws: Sequence[str], patch: Contacts, mu: float, pair: Pair) -> tuple[Convergence, ...]:
    a, b, n = (float(values[0]) for values in (patch.a, patch.b, patch.normal))
    shear_modulus = pair.youngs_modulus / (2.0 * (1.0 + pair.poisson))
    names = dict.fromkeys(["fastsim", "fastrip", *(law for law in laws if law in GRIDDED)])
    return tuple(
        grid_convergence(name, a=a, b=b, n=n, mu=mu, shear_modulus=shear_modulus, poisson=pair.poisson)
        for name in names
    )


def _traction(
    patch: Contacts, creepage: Array, pair: Pair, speed: float, mu: float, law: Mapping[str, Any] | None
) -> dict[str, Array]:
    n = float(patch.normal[0])
    out = {}
    for name, (mu0, polach, falling) in FALLING.items():
        forces = _forces(polach, patch, mu0, pair, creepage, falling=falling, speed=speed)
        out[f"{name}: Polach, falling friction"] = -forces.fx / n
    if law is not None:
        out[f"{law['kind']}, constant {mu:g}"] = -_forces(law, patch, mu, pair, creepage).fx / n
    return out
