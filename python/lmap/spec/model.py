"""What a spec is, as written: the keys that a procedure expands, checked; all other keys of `[track]` and
`[run]` go through as plain data and are checked by the core, which owns their kinds.
"""

from __future__ import annotations

import datetime
import math
import re
from typing import Annotated, Any, Self

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    ValidatorFunctionWrapHandler,
    WithJsonSchema,
    WrapValidator,
    model_validator,
)

from lmap.criteria.chain import Criterion

_PER_CENT = re.compile(r"^\s*([0-9]+(?:\.[0-9]+)?)\s*%\s*design\s*$")


class Speed(BaseModel):
    """One speed, as written: a part of the vehicle's design speed, or m/s."""

    model_config = ConfigDict(frozen=True)
    metres_per_second: float | None = None
    of_design: float | None = None

    def resolve(self, design_speed: float) -> float:
        """In m/s."""
        if self.metres_per_second is not None:
            return self.metres_per_second
        assert self.of_design is not None  # one of the two is always given
        return self.of_design * design_speed


def _many(value: Any) -> list[Any]:
    return list(value) if isinstance(value, list | tuple) else [value]


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _speeds(value: Any) -> list[Speed]:
    """Speeds as `run.speed` writes them."""
    speeds = []
    for item in _many(value):
        if isinstance(item, Speed):
            speeds.append(item)
            continue
        match = _PER_CENT.match(item) if isinstance(item, str) else None
        if match is not None and float(match[1]) > 0.0:
            speeds.append(Speed(of_design=float(match[1]) / 100.0))
        elif _is_number(item) and item > 0.0:
            speeds.append(Speed(metres_per_second=float(item)))
        else:
            raise ValueError('a number > 0 (m/s), "110% design", or a list of these')
    if not speeds:
        raise ValueError("at least one speed")
    return speeds


def _speeds_kmh(value: Any) -> list[Speed]:
    """Speeds as `run.speed_kmh` writes them."""
    speeds = []
    for item in _many(value):
        if isinstance(item, Speed):
            speeds.append(item)
        elif _is_number(item) and item > 0.0:
            speeds.append(Speed(metres_per_second=float(item) / 3.6))
        else:
            raise ValueError("a number > 0 (km/h), or a list of these")
    if not speeds:
        raise ValueError("at least one speed")
    return speeds


def _names(value: Any) -> list[str]:
    names = _many(value)
    if not names or not all(isinstance(name, str) and name for name in names):
        raise ValueError("a name in quotes, or a list of names")
    if len(set(names)) != len(names):
        raise ValueError("names that differ from each other")
    return names


def _friction(value: Any, number: ValidatorFunctionWrapHandler) -> Any:
    """A number; or a table (per rail, along the track, with the slip velocity), which is the core's to check."""
    return value if isinstance(value, dict) else number(value)


def _one_or_many(*kinds: dict[str, Any]) -> dict[str, Any]:
    """The JSON schema of a value or a list of such."""
    return {"anyOf": [*kinds, {"type": "array"}]}


class RunPart(BaseModel):
    """`[run]`: what procedures expand; the rest is the core's and kept as it is."""

    model_config = ConfigDict(extra="allow", frozen=True)

    speed: Annotated[
        list[Speed] | None,
        BeforeValidator(lambda v: None if v is None else _speeds(v)),
        WithJsonSchema(
            _one_or_many({"type": "number", "exclusiveMinimum": 0, "unit": "m/s"}, {"type": "string"})
        ),
    ] = None
    """A speed, or a part of the vehicle's design speed (`"110% design"`): a case for each."""
    speed_kmh: Annotated[
        list[Speed] | None,
        BeforeValidator(lambda v: None if v is None else _speeds_kmh(v)),
        WithJsonSchema(_one_or_many({"type": "number", "exclusiveMinimum": 0, "unit": "km/h"})),
    ] = None
    """The same in km/h; one of the two."""
    wheel_profile: Annotated[
        list[str] | None,
        BeforeValidator(lambda v: None if v is None else _names(v)),
        WithJsonSchema(_one_or_many({"type": "string"})),
    ] = None
    """A profile that ships, or a file: a case for each; the vehicle's own if absent."""
    friction: Annotated[
        float | None,
        Field(ge=0.0, allow_inf_nan=False, strict=True),
        WrapValidator(_friction),
        PlainSerializer(lambda value: value, return_type=Any),
        WithJsonSchema({"anyOf": [{"type": "number", "minimum": 0}, {"type": "object"}]}),
    ] = None
    """Between wheel and rail: a number, or a table as a case has it (per rail, along the track, falling with slip)."""

    @model_validator(mode="after")
    def _one_speed(self) -> Self:
        if self.speed is not None and self.speed_kmh is not None:
            raise ValueError("one of speed and speed_kmh")
        return self

    @property
    def speeds(self) -> list[Speed] | None:
        """The speeds, however they are written."""
        return self.speed if self.speed is not None else self.speed_kmh

    @property
    def rest(self) -> dict[str, Any]:
        """Keys for the core: all but speed and wheel profile, which a case has one of."""
        kept = dict(self.model_extra or {})
        if self.friction is not None:
            kept["friction"] = self.friction
        return kept


_HASH = re.compile(r"[0-9a-f]{64}")


def _iso_date(value: Any) -> str:
    try:
        if not isinstance(value, str) or len(value) != 10:
            raise ValueError
        datetime.date.fromisoformat(value)
    except ValueError:
        raise ValueError('a day as "2026-01-31", in quotes') from None
    return value


def _a_hash(value: Any) -> str:
    if not isinstance(value, str) or _HASH.fullmatch(value) is None:
        raise ValueError("the model's hash, 64 hexadecimal digits: a check without sign-off prints it")
    return value


def _a_person(value: Any) -> str:
    if not isinstance(value, str) or not value.strip() or value.strip() == "YOUR NAME":
        raise ValueError("the name of the person who looked, in quotes")
    return value.strip()


class SignOff(BaseModel):
    """`[sign_off]`: a person has looked at what no criterion can say, of this very model."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: Annotated[str, BeforeValidator(_a_person)]
    """Of the person."""
    date: Annotated[str, BeforeValidator(_iso_date)]
    """The day, as 2026-01-31."""
    model: Annotated[str, BeforeValidator(_a_hash)]
    """Hash of the vehicle in the spec's condition, which a check without sign-off prints; for another it is void."""


class Spec(BaseModel):
    """One spec file."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    id: str = Field(min_length=1)
    """Of the test, as `2C.1`: what it is called by, and sorted."""
    title: str = Field(min_length=1)
    """One line for people."""
    procedure: str
    """What is done: one of those below."""
    vehicle: str = Field(min_length=1)
    """A vehicle that ships, or a file seen from this one."""
    condition: str | None = None
    """Of the vehicle's operating conditions; its design condition if absent."""
    track: dict[str, Any] = Field(default_factory=dict)
    """Laid over the base track: `base`, or else the one that the vehicle names."""
    run: RunPart = Field(default_factory=RunPart)
    """How it is run."""
    test: dict[str, Any] = Field(default_factory=dict)
    """The procedure's own numbers."""
    set: dict[str, Any] = Field(default_factory=dict)
    """Named parameters of the vehicle and keys of the spec that are otherwise, as `--set` has them."""
    assumed: str | None = Field(default=None, min_length=1)
    """What of the test itself, beside its limits, no public source gives, and why it is as it is: a shape, a radius, a
    twist."""
    sign_off: SignOff | None = None
    """For procedures that wait for a person."""
    criterion: list[Criterion] = Field(min_length=1)
    """What is judged, and what is shown beside it."""


SPEC_KEYS_OF_RUN = frozenset({"controller", "speed_kmh"})
"""Keys of `[run]` that the core, which knows cases, has not; a case within a spec (`[[test.case]]`) writes its speed
beside its `run`."""

KNOWN_KEYS: dict[tuple[str | int, ...], list[str]] = {
    (): list(Spec.model_fields),
    ("run",): list(RunPart.model_fields),
    ("sign_off",): list(SignOff.model_fields),
    ("criterion", 0): list(Criterion.model_fields),
}
"""Keys allowed in each table, for the nearest known one."""
