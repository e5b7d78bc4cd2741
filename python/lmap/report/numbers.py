"""How numbers are written for people: in the terminal, on the page and in JUnit messages alike."""

from __future__ import annotations

import math

NOTHING = "-"
"""What stands where there is no number."""

_DIGITS = 4
"""Significant digits: a value at 99.9 % of its limit must not look like the limit."""


def number(value: float | None, digits: int = _DIGITS) -> str:
    """`digits` significant digits, without an exponent between 1e-4 and 1e7."""
    if value is None:
        return NOTHING
    if not math.isfinite(value):
        return "not a number" if math.isnan(value) else ("infinite" if value > 0 else "-infinite")
    if value == 0.0:
        return "0"
    power = math.floor(math.log10(abs(value)))
    if not -4 <= power < 7:
        return f"{value:.{digits - 1}e}"
    return f"{value:.{max(digits - 1 - power, 0)}f}"


def quantity(value: float | None, unit: str, beside: float | None = None) -> str:
    """A number with its unit; the unit `1` is not written.

    `beside` is a number that somebody else wrote: ours has as many digits as that where they are more.
    """
    theirs = 0 if beside is None else len(f"{abs(beside):g}".partition("e")[0].replace(".", "").lstrip("0"))
    text = number(value, max(_DIGITS, theirs))
    return text if value is None or unit in ("", "1") else f"{text} {unit}"


def signed(value: float | None, unit: str) -> str:
    """A quantity that shows its sign: a margin."""
    text = quantity(value, unit)
    return text if value is None or not value > 0.0 else f"+{text}"


def percent(value: float | None) -> str:
    """One decimal, with its sign."""
    if value is None or not math.isfinite(value):
        return NOTHING
    return f"{value:+.1f} %"


def given(value: float | None, unit: str) -> str:
    """A number that somebody else wrote, with the digits that they wrote, and its unit."""
    return NOTHING if value is None else with_unit(f"{value:g}", unit)


def with_unit(text: str, unit: str) -> str:
    """A text with the unit, where it has one."""
    return text if not text or unit in ("", "1") else f"{text} {unit}"
