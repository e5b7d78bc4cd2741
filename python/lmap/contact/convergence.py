"""How a creep law that divides the patch into a grid settles as the grid gets finer."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lmap.contact.core import Array
from lmap.contact.laws import PUBLISHED, SHEAR_MODULUS, creep_forces
from lmap.contact.patch import POISSON_RATIO, kalker
from lmap.errors import InputProblem, Problem, listed, nearest_hint

GRIDDED = ("fastrip", "fastsim", "modified_fastsim")
"""Laws with a grid."""

GRIDS = (5, 7, 10, 14, 20, 28, 40, 57)
"""Elements along and across."""

FINEST = 200
"""Elements either way of the grid that the others are measured against."""

_LEVELS = (0.1, 0.3, 1.0, 3.0)
"""Creepage over that at which Kalker's linear force is three times friction: stick nearly everywhere to full slip."""
_DIRECTIONS = np.radians((0.0, 22.5, 45.0, 67.5, 90.0))
_SPINS = (0.3, 1.0)
"""The same for spin."""


@dataclass(frozen=True, slots=True, eq=False)
class Convergence:
    """Largest distance of the force from that of the finest grid over 20 creepages, in parts of mu N."""

    law: str
    grids: Array
    """Elements along and across, (k,)."""
    without_spin: Array
    """(k,)"""
    with_spin: Array
    """The same creepages with two spins each, (k,)."""


def grid_convergence(
    law: str,
    *,
    a: float,
    b: float,
    n: float,
    mu: float,
    shear_modulus: float = SHEAR_MODULUS,
    poisson: float = POISSON_RATIO,
    grids: Sequence[int] = GRIDS,
) -> Convergence:
    """The distance from a grid of 200 x 200: a law of `GRIDDED` in a patch of semi-axes `a`, `b` (m) under `n` (N)."""
    if law not in GRIDDED:
        hint = nearest_hint(law, GRIDDED)
        raise InputProblem(Problem(key=("law",), found=f'"{law}"', allowed=listed(GRIDDED), hint=hint))
    c11, _, c23, _ = (float(c[0]) for c in kalker(np.array([a / b]), poisson))
    slide = 3.0 * mu * n / (shear_modulus * a * b * c11)
    turn = 3.0 * mu * n / (shear_modulus * (a * b) ** 1.5 * c23)
    plain = [
        (slide * level * np.cos(way), slide * level * np.sin(way), 0.0)
        for level, way in itertools.product(_LEVELS, _DIRECTIONS)
    ]
    spun = [(xi, eta, turn * spin) for (xi, eta, _), spin in itertools.product(plain, _SPINS)]
    creepage = np.array(plain + spun).T

    def forces(size: int) -> Array:
        written = {"kind": law, **PUBLISHED.get(law, {}), "nx": size, "ny": size}
        found = creep_forces(
            written, *creepage, a=a, b=b, n=n, mu=mu, shear_modulus=shear_modulus, poisson=poisson
        )
        return np.stack([found.fx, found.fy])

    finest = forces(FINEST)
    away = np.array([np.hypot(*(forces(size) - finest)) for size in grids]) / (mu * n)
    return Convergence(
        law=law,
        grids=np.asarray(grids, dtype=np.float64),
        without_spin=away[:, : len(plain)].max(axis=1),
        with_spin=away[:, len(plain) :].max(axis=1),
    )
