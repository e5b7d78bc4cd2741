"""Cases: one fully resolved simulation each, as plain data, with a hash as identity."""

from __future__ import annotations

import copy
import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Protocol

FORMAT = 1
"""Of the case's JSON; the core refuses another."""


@dataclass(frozen=True, slots=True, kw_only=True)
class VehicleData:
    """A vehicle as procedures see it: resolved for a condition, as plain data."""

    file: str
    document: Mapping[str, Any]
    """As written, overrides applied: what goes into a case."""
    name: str
    title: str
    design_speed: float
    """m/s."""
    wheel_radius: float
    """m."""
    wheel_profile: str | None
    """The profile that the vehicle names."""
    track: str | None
    """The base track that the vehicle names."""
    condition: str | None
    conditions: tuple[str, ...]
    design_condition: str | None
    """The condition that a spec which names none is run in."""
    mass: float | None
    """kg, in the condition."""
    bodies: tuple[Any, ...]
    model: Mapping[str, Any] = field(default_factory=dict)
    """In the condition, with templates copied, references replaced and mirrored elements made: the core's
    `resolve_summary`. `lmap.view.model` gives it types."""

    def declares(self, key: str | None) -> bool:
        """Whether the vehicle's file has a dotted key; nothing is always there."""
        below: Any = self.document
        for part in (key or "").split(".") if key else ():
            if not isinstance(below, Mapping) or part not in below:
                return False
            below = below[part]
        return True


class Sampler(Protocol):
    """A control law in one run."""

    def sample(self, t: float, period: float, seen: list[float]) -> Sequence[float | None]:
        """Values of the outputs at time `t` (s), held for `period` (s)."""

    def close(self) -> None:
        """The run has ended."""


@dataclass(frozen=True, slots=True)
class Control:
    """A control law of the user's: code that stays outside the case, and is run where the case is run."""

    name: str
    """What messages call it."""
    channels: tuple[str, ...]
    """What it sees."""
    outputs: tuple[str, ...]
    """What it sets, as the core calls it."""
    start: Callable[[], Sampler]
    """A law for one run; raises an `InputProblem`."""


@dataclass(frozen=True)
class Case:
    """One simulation.

    Complete but for the profiles' points until `with_profiles` puts them in, and for measured tracks and control laws,
    which it names with their SHA-256.
    """

    label: str
    """What varies within the spec: `anzr1_worn_1`, `23 km/h`."""
    data: Mapping[str, Any]
    texts: Mapping[str, str] = field(default_factory=dict)
    """Measured tracks as CSV, by the name of the file."""
    control: Control | None = field(default=None, compare=False)
    """The control law that `run.controller` names."""

    @cached_property
    def core_json(self) -> str:
        """The same for the core, which opens no file: the texts of measured tracks in it, the control law not."""
        if not self.texts and self.control is None:
            return self.json
        data = copy.deepcopy(dict(self.data))
        if self.control is not None:
            data["run"].pop("controller", None)
        irregularity = data["track"].get("irregularity", [])
        for entry in irregularity if isinstance(irregularity, list) else [irregularity]:
            if entry.get("kind") == "measured" and entry.get("file") in self.texts:
                entry["text"] = self.texts[entry["file"]]
        return json.dumps(data, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)

    @cached_property
    def json(self) -> str:
        """The case for the core: keys sorted, numbers as they round-trip, NaN refused."""
        return json.dumps(
            self.data, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False
        )

    @cached_property
    def hash(self) -> str:
        """SHA-256 of the JSON: same hash, same bytes of result."""
        return hashlib.sha256(self.json.encode()).hexdigest()

    @property
    def profile_names(self) -> dict[str, tuple[str | int, ...]]:
        """Names of the profiles that the case needs, with the key that names each."""
        names: dict[str, tuple[str | int, ...]] = {}
        for part, key in (("track", "rail_profile"), ("run", "wheel_profile")):
            name = self.data.get(part, {}).get(key)
            if isinstance(name, str):
                names.setdefault(name, (part, key))
        return names

    def with_profiles(self, profiles: Mapping[str, Any]) -> Case:
        """The case with the points of the profiles that it names in it."""
        needed = {name: profiles[name] for name in sorted(self.profile_names) if name in profiles}
        return replace(self, data={**self.data, "profiles": needed})


def build(*, label: str, vehicle: VehicleData, track: Mapping[str, Any], run: Mapping[str, Any]) -> Case:
    """A case from its parts."""
    data: dict[str, Any] = {
        "format": FORMAT,
        "label": label,
        "vehicle": vehicle.document,
        "track": dict(track),
        "run": dict(run),
    }
    condition = vehicle.condition or vehicle.design_condition
    if condition is not None:
        data["condition"] = condition
    return Case(label, data)


def merged(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """A base's tables with the keys of `over` on top; a table of another `kind` replaces, a list too."""
    result = copy.deepcopy(dict(base))
    for key, value in over.items():
        below = result.get(key)
        if isinstance(below, dict) and isinstance(value, Mapping):
            same_kind = value.get("kind", below.get("kind")) == below.get("kind")
            result[key] = merged(below, value) if same_kind else copy.deepcopy(dict(value))
        else:
            result[key] = copy.deepcopy(value)
    return result
