"""The vehicle as drawn (LMAP 1.2): its geometry, what can be checked of it without a person, its motions.

Plain data throughout: `lmap.report.scene` makes the page of it.
"""

from __future__ import annotations

from lmap.view.checks import Finding, findings
from lmap.view.model import Model, model_hash, resolved
from lmap.view.motion import Mode, mode_motions, modes_of, run_motion
from lmap.view.scene import scene

__all__ = [
    "Finding",
    "Mode",
    "Model",
    "findings",
    "mode_motions",
    "model_hash",
    "modes_of",
    "resolved",
    "run_motion",
    "scene",
]
