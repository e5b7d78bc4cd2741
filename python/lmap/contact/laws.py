"""Creep forces by any law of the simulator."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from lmap import toml
from lmap.contact.core import NOT_NEGATIVE, POSITIVE, Array, broadcast, call, columns, refuse
from lmap.contact.patch import POISSON_RATIO, kalker
from lmap.errors import InputProblem, Problem, listed, nearest_hint

LAWS = {
    "fastrip": "FaStrip: strip theory with the directions of FASTSIM",
    "fastsim": "FASTSIM, Kalker's simplified theory",
    "kalker_linear": "Kalker's linear theory, without limit",
    "modified_fastsim": "FASTSIM with a slope that falls with creepage",
    "polach": "Polach, with reduction factors",
    "shen_hedrick_elkins": "Shen, Hedrick and Elkins: linear theory, saturated",
    "vermeulen_johnson": "Vermeulen and Johnson, without spin",
}
"""Every law by the name that a case calls it."""

SHEAR_MODULUS = 82e9
"""Of steel, Pa."""

PUBLISHED: dict[str, dict[str, float]] = {
    "modified_fastsim": {"k0": 0.54, "alpha": 0.02, "beta": 0.62},
}
"""Parameters of a law without defaults, where its name alone is given: modified FASTSIM as Spiryagin, Polach and
Cole, Vehicle System Dynamics (2013), fitted it to a locomotive.
"""

_WITH_POISSON = ("fastrip", "vermeulen_johnson")


class CreepForces(NamedTuple):
    """Forces on the wheel; each an array of the broadcast shape."""

    fx: Array
    """Longitudinal, N."""
    fy: Array
    """Lateral, N."""
    mz: Array
    """About the normal, N m; NaN where the law gives none."""


def creep_forces(
    law: str | Mapping[str, Any],
    xi: ArrayLike,
    eta: ArrayLike = 0.0,
    phi: ArrayLike = 0.0,
    *,
    a: ArrayLike,
    b: ArrayLike,
    n: ArrayLike,
    mu: ArrayLike,
    shear_modulus: float = SHEAR_MODULUS,
    poisson: float = POISSON_RATIO,
    falling: Mapping[str, float] | None = None,
    speed: ArrayLike | None = None,
) -> CreepForces:
    """Creep forces on the wheel by a law: numbers and arrays of shapes that broadcast.

    - `law`: a name of `LAWS`, or a table as a case has it: `{"kind": "fastsim", "nx": 20, "ny": 20}`;
    - `xi`, `eta`: longitudinal and lateral creepage, `phi`: spin (1/m): speed of the wheel's surface less the
      rail's over the rolling speed, in contact axes (x rolling, y lateral, right-handed with the normal).
      Forces oppose it;
    - `a`, `b`: semi-axes along and across (m, > 0), `n`: normal force (N, >= 0), `mu`: coefficient of friction
      (>= 0);
    - `falling`: `{"ratio": A, "decay": B}` (s/m) lets `mu` fall with the slip velocity, (1 - A) exp(-B w) + A,
      w = `speed` (m/s) times the creepage without spin.

    Kalker's coefficients come from `kalker`. Papers and equations of each law:
    `crates/railsim/src/contact/creep/`. `InputProblem` names array and index of what is refused, and the
    nearest law to an unknown one.

    >>> creep_forces("fastsim", [0.0, 0.001, 0.01], a=0.006, b=0.006, n=1e5, mu=0.3).fx
    """
    written = law_of(law, poisson)
    given = {"xi": xi, "eta": eta, "phi": phi, "a": a, "b": b, "n": n, "mu": mu}
    if speed is not None:
        given["speed"] = speed
    arrays, shape = broadcast(given)
    rules = {"a": POSITIVE, "b": POSITIVE, "n": NOT_NEGATIVE, "mu": NOT_NEGATIVE, "speed": NOT_NEGATIVE}
    refuse(arrays, rules)
    refuse({"shear_modulus": np.asarray(shear_modulus, dtype=np.float64)}, {"shear_modulus": POSITIVE})
    ratio, position = np.unique(arrays["a"] / arrays["b"], return_inverse=True)
    coefficients = kalker(ratio, poisson)
    contacts: dict[str, Any] = {name: np.ascontiguousarray(array).ravel() for name, array in arrays.items()}
    for name, values in zip(("c11", "c22", "c23", "c33"), coefficients, strict=True):
        contacts[name] = np.ascontiguousarray(values[position.ravel()])
    contacts["shear_modulus"] = float(shear_modulus)
    frame = call(
        toml.core().creep_forces,
        json.dumps(written),
        contacts,
        None if falling is None else json.dumps(dict(falling)),
        shape=shape,
    )
    out = columns(frame)
    return CreepForces(*(out[name].reshape(shape) for name in CreepForces._fields))


def law_of(law: str | Mapping[str, Any], poisson: float = POISSON_RATIO) -> dict[str, Any]:
    """A law as a case writes it; an `InputProblem` with the nearest name for an unknown one."""
    written: dict[str, Any] = {"kind": law, **PUBLISHED.get(law, {})} if isinstance(law, str) else dict(law)
    kind = written.get("kind")
    if not isinstance(kind, str) or kind not in LAWS:
        found = "no kind" if kind is None else f'"{kind}"'
        hint = None if kind is None else nearest_hint(str(kind), LAWS)
        raise InputProblem(Problem(key=("law",), found=found, allowed=listed(LAWS), hint=hint))
    if kind in _WITH_POISSON:
        written.setdefault("poisson", poisson)
    return written
