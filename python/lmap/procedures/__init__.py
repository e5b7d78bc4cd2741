"""The procedures that specs may name."""

from __future__ import annotations

from lmap.procedures import (
    axle_loads,
    bogie_rotation,
    coupler_forces,
    critical_speed,
    curves,
    drive,
    heights,
    hunting,
    lint,
    modes,
    p2,
    quasi_static,
    speed_range,
    step,
    sway,
    twist,
    view,
)
from lmap.procedures.base import (
    CaseFigures,
    Deriving,
    Illustrated,
    Look,
    Looking,
    Procedure,
    Rewriting,
    Set,
)

# Keep this list sorted by name.
PROCEDURES: tuple[Procedure, ...] = (
    axle_loads,
    bogie_rotation,
    coupler_forces,
    critical_speed,
    curves,
    drive,
    heights,
    hunting,
    lint,
    modes,
    p2,
    quasi_static,
    speed_range,
    step,
    sway,
    twist,
    view,
)

BY_NAME: dict[str, Procedure] = {procedure.NAME: procedure for procedure in PROCEDURES}

__all__ = [
    "BY_NAME",
    "PROCEDURES",
    "CaseFigures",
    "Deriving",
    "Illustrated",
    "Look",
    "Looking",
    "Procedure",
    "Rewriting",
    "Set",
]
