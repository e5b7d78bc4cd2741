"""Wheel and rail in contact, by themselves: profiles, geometry, patches, creep forces. Arrays in, arrays out.

    from lmap import contact

    pair = contact.Pair("s1002", "uic60", inclination=1 / 40)
    pair.conicity([0.003, 0.006])
    patch = contact.hertz(1e5, 1 / 0.46, 1 / 0.3)
    contact.creep_forces("fastsim", [0.0, 0.001, 0.01], a=patch.a, b=patch.b, n=1e5, mu=0.3).fx

SI units; profiles alone are in millimetres, as their files are. x forward, y outward (side coordinates) or
right (wheelset), z down; creep forces act on the wheel in the axes of the contact. `InputProblem` for
everything that is refused.
"""

from __future__ import annotations

from lmap.contact.case import equivalent_conicity
from lmap.contact.convergence import GRIDDED, Convergence, grid_convergence
from lmap.contact.laws import LAWS, CreepForces, creep_forces
from lmap.contact.pair import METHODS, Contacts, Pair, curve_conicity
from lmap.contact.patch import Ellipse, Kalker, NonElliptic, hertz, kalker, non_elliptic
from lmap.contact.profile import (
    Finding,
    Profile,
    Smoothed,
    profile_points,
    quality,
    read_profile,
    smooth,
    write_profile,
)

__all__ = [
    "GRIDDED",
    "LAWS",
    "METHODS",
    "Contacts",
    "Convergence",
    "CreepForces",
    "Ellipse",
    "Finding",
    "Kalker",
    "NonElliptic",
    "Pair",
    "Profile",
    "Smoothed",
    "creep_forces",
    "curve_conicity",
    "equivalent_conicity",
    "grid_convergence",
    "hertz",
    "kalker",
    "non_elliptic",
    "profile_points",
    "quality",
    "read_profile",
    "smooth",
    "write_profile",
]
