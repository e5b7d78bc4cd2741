"""Units that channels and criteria are written in, and the factors between them."""

from __future__ import annotations

STANDARD_GRAVITY = 9.80665
"""m/s2 in one g: the unit, whatever gravity a run uses."""

# Keep this list sorted by unit. Unit: quantity, its value in SI.
UNITS: dict[str, tuple[str, float]] = {
    "%": ("ratio", 0.01),
    "1": ("ratio", 1.0),
    "1/m": ("per length", 1.0),
    "Hz": ("per time", 1.0),
    "J": ("energy", 1.0),
    "N": ("force", 1.0),
    "N m": ("moment", 1.0),
    "N/m": ("force per length", 1.0),
    "Pa": ("pressure", 1.0),
    "W": ("power", 1.0),
    "deg": ("angle", 0.017453292519943295),
    "deg/s": ("angular velocity", 0.017453292519943295),
    "g": ("acceleration", STANDARD_GRAVITY),
    "kN": ("force", 1e3),
    "kN m": ("moment", 1e3),
    "kN/mm": ("force per length", 1e6),
    "kPa": ("pressure", 1e3),
    "kW": ("power", 1e3),
    "km/h": ("velocity", 1.0 / 3.6),
    "m": ("length", 1.0),
    "m/s": ("velocity", 1.0),
    "m/s2": ("acceleration", 1.0),
    "mm": ("length", 1e-3),
    "mrad": ("angle", 1e-3),
    "ms": ("time", 1e-3),
    "per mille": ("ratio", 1e-3),
    "rad": ("angle", 1.0),
    "rad/s": ("angular velocity", 1.0),
    "rad/s2": ("angular acceleration", 1.0),
    "s": ("time", 1.0),
}


def factor(given: str, wanted: str) -> float | None:
    """What a value in `given` is multiplied with to be in `wanted`; nothing where the two do not compare."""
    if given == wanted:
        return 1.0
    from_, to = UNITS.get(given), UNITS.get(wanted)
    if from_ is None or to is None or from_[0] != to[0]:
        return None
    return from_[1] / to[1]


def comparable(unit: str) -> list[str]:
    """Every unit of the same quantity, itself included."""
    if unit not in UNITS:
        return [unit]
    return [name for name, (quantity, _) in UNITS.items() if quantity == UNITS[unit][0]]
