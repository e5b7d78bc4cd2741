"""Contact patches: Hertz, Kalker's coefficients, and patches that are no ellipses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from lmap import toml
from lmap.contact.core import NOT_NEGATIVE, POISSON, POSITIVE, Array, broadcast, call, columns, refuse
from lmap.errors import InputProblem, Problem

YOUNGS_MODULUS = 210e9
"""Of steel, Pa."""
POISSON_RATIO = 0.28
"""Of steel: with it G = 82 GPa, the value of the reference cases."""


class Ellipse(NamedTuple):
    """Hertz's patch; each an array of the broadcast shape."""

    a: Array
    """Semi-axis along the rolling direction, m."""
    b: Array
    """Semi-axis across, m."""
    approach: Array
    """Approach of the bodies, m."""
    max_pressure: Array
    """Pressure in the middle, Pa."""


class Kalker(NamedTuple):
    """Kalker's creep coefficients; each an array of the shape of `a_over_b`."""

    c11: Array
    c22: Array
    c23: Array
    c33: Array


def hertz(
    n: ArrayLike,
    k_x: ArrayLike,
    k_y: ArrayLike,
    *,
    youngs_modulus: float = YOUNGS_MODULUS,
    poisson: float = POISSON_RATIO,
) -> Ellipse:
    """Elliptical contact of two bodies of one material.

    `n` (N, >= 0), and the relative curvatures `k_x` along and `k_y` across the rolling direction (1/m, > 0,
    the sum over both bodies, convex positive) broadcast. K. L. Johnson, Contact Mechanics (1985), section 4.2.
    `InputProblem` names array and index of what is refused.

    >>> patch = hertz(1e5, 1 / 0.46, 1 / 0.3)  # a wheel of 460 mm on a rail head of 300 mm
    """
    arrays, shape = broadcast({"n": n, "k_x": k_x, "k_y": k_y})
    refuse(arrays, {"n": NOT_NEGATIVE, "k_x": POSITIVE, "k_y": POSITIVE})
    _material(youngs_modulus, poisson)
    flat = [np.ascontiguousarray(array).ravel() for array in arrays.values()]
    out = columns(call(toml.core().hertz, *flat, youngs_modulus, poisson))
    return Ellipse(*(out[name].reshape(shape) for name in Ellipse._fields))


def kalker(a_over_b: ArrayLike, poisson: float = POISSON_RATIO) -> Kalker:
    """Kalker's coefficients of the linear theory for axis ratios (a along rolling over b across, > 0) of any
    shape.

    J. J. Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990), Table E.3, at its nodes exactly;
    between them monotone cubics in ln C over ln(a/b), over Poisson's ratio (0 to 0.5) the parabola through 1/C;
    asymptotes outside 0.1 to 10.
    """
    arrays, shape = broadcast({"a_over_b": a_over_b})
    refuse(arrays, {"a_over_b": POSITIVE})
    refuse({"poisson": np.asarray(poisson, dtype=np.float64)}, {"poisson": POISSON})
    out = columns(call(toml.core().kalker_coefficients, arrays["a_over_b"].ravel().tolist(), poisson))
    return Kalker(*(out[name].reshape(shape) for name in Kalker._fields))


@dataclass(frozen=True, slots=True)
class NonElliptic:
    """A patch symmetrical along the rolling direction and of any shape across."""

    approach: float
    """Approach of the bodies, m."""
    force: float
    """Normal force, N."""
    max_pressure: float
    """Largest pressure, Pa."""
    area: float
    """m2."""
    origin: float
    """Where the bodies touch first, m."""
    a: float
    """Along rolling: semi-axis of the ellipse of the same area and proportions, for creep laws, m."""
    b: float
    """Across, m."""
    y: Array
    """Outline: positions across, m, rising, shape (k,)."""
    half_length: Array
    """Outline: half-length along rolling at each, m, shape (k,)."""

    def pressure(self, x: ArrayLike, y: ArrayLike) -> Array:
        """Pressure (Pa) at points of the contact plane (m, broadcast): semi-elliptical along x, zero
        outside.
        """
        x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
        square = np.interp(y, self.y, self.half_length**2, left=0.0, right=0.0)
        inside: Array = np.sqrt(np.maximum(square - x * x, 0.0))
        return self.max_pressure / float(self.half_length.max()) * inside


def non_elliptic(
    y: ArrayLike,
    gap: ArrayLike,
    *,
    curvature: float,
    force: float | None = None,
    approach: float | None = None,
    youngs_modulus: float = YOUNGS_MODULUS,
    poisson: float = POISSON_RATIO,
) -> NonElliptic:
    """Patch by the virtual penetration of Kik and Piotrowski, at a normal force (N) or at an approach (m).

    `gap` (m, shape (k,)) is the distance of the undeformed surfaces at the positions `y` (m, shape (k,),
    rising) across the rolling direction; only differences count. `curvature` is the relative one along the
    rolling direction (1/m). J. Piotrowski, W. Kik, Vehicle System Dynamics 46 (2008) 27, eqs. 7 and 13,
    reduction factor 0.55. On an ellipse its area is 7 to 21 % large and its peak pressure 6 to 17 % low (axis
    ratio 1 to 7), its approach 1 to 3 % short.

    `InputProblem` for a gap that does not open to both sides, and for a patch that would reach the end of the
    gap.
    """
    arrays, shape = broadcast({"y": y, "gap": gap})
    if len(shape) != 1:
        raise InputProblem(Problem(key=("gap",), found=f"shape {shape}", allowed="shape (k,)"))
    refuse(arrays, {})
    _material(youngs_modulus, poisson)
    flat = [np.ascontiguousarray(array) for array in arrays.values()]
    figures, outline = call(
        toml.core().non_elliptic, *flat, curvature, youngs_modulus, poisson, force, approach
    )
    drawn = columns(outline)
    return NonElliptic(**figures, y=drawn["y"], half_length=drawn["half_length"])


def _material(youngs_modulus: float, poisson: float) -> None:
    values = {"youngs_modulus": youngs_modulus, "poisson": poisson}
    refuse(
        {name: np.asarray(value, dtype=np.float64) for name, value in values.items()},
        {"youngs_modulus": POSITIVE, "poisson": POISSON},
    )
