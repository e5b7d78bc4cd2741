"""The procedures that specs may name."""

from __future__ import annotations

from lmap.procedures import hunting, lint
from lmap.procedures.base import CaseFigures, Procedure

# Keep this list sorted by name.
PROCEDURES: tuple[Procedure, ...] = (hunting, lint)

BY_NAME: dict[str, Procedure] = {procedure.NAME: procedure for procedure in PROCEDURES}

__all__ = ["BY_NAME", "PROCEDURES", "CaseFigures", "Procedure"]
