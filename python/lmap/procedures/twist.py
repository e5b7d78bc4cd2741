"""Wheel unloading on twisted track (LMAP 2C.4a).

The track under each axle is turned about the rails' middle, in steps, to the prescribed twist and one step beyond, to
the other side and back again, the vehicle rolling so slowly that only creep lets its wheels give way sideways. What is
turned is the spec's `loops`:

- `bogies level`: the two bogies against each other by `twist_body` times the distance of their centres;
- `bogie`: the leading bogie's axles evenly by `twist_bogie`;
- `bogie and body`: both;
- `axle`: the leading axle alone, by `twist_bogie` times the bogie's wheelbase;
- `axle on ramp`: the same, all axles standing on an even ramp of `twist_body`, which is turned with it.

At each twist the wheel loads of the raising and of the lowering branch are averaged, which takes friction out:
`<axle>.<side>.average_unloading`, of the load on level track. Beside it `<axle>.<side>.unloading` of either branch and
`level`, the share of the prescribed twist.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from lmap.errors import InputProblem, Problem
from lmap.formulas import CANT_BASE, en_twist
from lmap.procedures.axles import two_bogies
from lmap.procedures.base import CaseFigures, expand, settings, unloading_units, wheelsets, with_unloading
from lmap.spec.case import Case, VehicleData, build
from lmap.spec.model import Spec
from lmap.verdict import Drawing, DrawnCurve, Fact
from lmap.view.model import resolved

if TYPE_CHECKING:
    import polars as pl

NAME = "twist"
SUMMARY = "wheel unloading over the twist of the track, raised and lowered in steps; friction averaged out"
UNITS: Mapping[str, str] = {"level": "1"}

EN = "EN 14363"
Loop = Literal["bogies level", "bogie", "bogie and body", "axle", "axle on ramp"]


class Settings(BaseModel):
    """`[test]`."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    twist_body: Literal["EN 14363"] | float
    """Between the bogie centres, height over length; EN 14363: 15/2a + 2 per mille."""
    twist_bogie: Literal["EN 14363"] | float
    """Within the bogie's outer wheelbase; EN 14363: 7 - 5/2a per mille."""
    loops: list[Loop] = Field(min_length=1)
    """What is twisted, a case each."""
    steps: int = Field(ge=1, le=50)
    """From level track to the prescribed twist."""
    beyond: float = Field(gt=0.0, le=1.0)
    """Share by which one more step goes beyond it, so that the twist has two branches: as much as reverses friction."""


SETTINGS = Settings


def _path(steps: int) -> list[int]:
    """Numbers of the levels: up to the one beyond the twist, down to the one beyond it on the other side, up again."""
    most = steps + 1
    return [*range(most), *range(most, -most, -1), *range(-most, most + 1)]


def levels(test: Settings) -> list[float]:
    """Shares of the twist along the path."""
    beyond = {test.steps + 1: 1.0 + test.beyond, -test.steps - 1: -1.0 - test.beyond}
    return [beyond.get(k, k / test.steps) for k in _path(test.steps)]


def angles(spec: Spec, vehicle: VehicleData) -> dict[str, dict[str, float]]:
    """Angle by which the track under each axle is turned at the full twist, rad, for each loop; + right rail lower."""
    test = settings(spec, Settings)
    front, rear = two_bogies(resolved(vehicle))
    distance = front.centre - rear.centre
    middle = (front.centre + rear.centre) / 2.0
    bogie = en_twist(front.wheelbase, bogie=True) if isinstance(test.twist_bogie, str) else test.twist_bogie
    body = en_twist(distance, bogie=False) if isinstance(test.twist_body, str) else test.twist_body
    level = {
        axle.name: body * (one.centre - middle) / CANT_BASE for one in (front, rear) for axle in one.axles
    }
    even = {axle.name: bogie * (axle.position[0] - front.centre) / CANT_BASE for axle in front.axles}
    leading = {front.axles[0].name: bogie * front.wheelbase / CANT_BASE}
    ramp = {
        axle.name: body * (axle.position[0] - middle) / CANT_BASE
        for one in (front, rear)
        for axle in one.axles
    }
    every: dict[str, dict[str, float]] = {
        "bogies level": level,
        "bogie": even,
        "bogie and body": _sum(level, even),
        "axle": leading,
        "axle on ramp": _sum(ramp, leading),
    }
    return {loop: every[loop] for loop in dict.fromkeys(test.loops)}


def _sum(*parts: Mapping[str, float]) -> dict[str, float]:
    names = dict.fromkeys(name for part in parts for name in part)
    return {name: sum(part.get(name, 0.0) for part in parts) for name in names}


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """A case for each loop."""
    test = settings(spec, Settings)
    [rolling, *others] = expand(spec, vehicle, kind="quasi_static")
    if others:
        raise InputProblem(Problem(key=("run",), found="several", allowed="one speed and one wheel profile"))
    axles = [axle.name for axle in resolved(vehicle).wheelsets]
    found = []
    for loop, turned in angles(spec, vehicle).items():
        loads = [
            {
                "kind": "displacement",
                "coordinate": f"{axle}.track_phi",
                "path": [level * turned.get(axle, 0.0) for level in levels(test)],
            }
            for axle in axles
        ]
        run: dict[str, Any] = {**rolling.data["run"], "load": loads, "load_steps": 1}
        found.append(build(label=loop, vehicle=vehicle, track=spec.track, run=run))
    return found


def derived(spec: Spec, channels: Mapping[str, str]) -> Mapping[str, str]:
    """Unloading of each wheel, and its average."""
    own = unloading_units(channels)
    return own | {name.replace(".unloading", ".average_unloading"): unit for name, unit in own.items()}


def quantities(
    spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
) -> Mapping[str, pl.DataFrame]:
    """The frames with unloading, branch by branch and averaged."""
    import polars as pl

    test = settings(spec, Settings)
    steps, shares = test.steps, pl.Series("level", levels(test))
    found = {}
    for label, frame in frames.items():
        if frame.height != len(shares):
            found[label] = frame  # its criteria then say which channel is missing
            continue
        loaded = with_unloading(frame, frame).with_columns(shares)
        means = [
            pl.Series(
                f"{name}.{side}.average_unloading",
                averaged(loaded[f"{name}.{side}.unloading"].to_list(), steps),
            )
            for name in wheelsets(frame.columns)
            for side in ("left", "right")
        ]
        found[label] = loaded.with_columns(means)
    return found


def averaged(values: Sequence[float], steps: int) -> list[float]:
    """At each level of the path the mean of the falling and the second rising branch; beyond the twist that at it."""
    most = steps + 1
    falling = values[most : 3 * most + 1][::-1]
    rising = values[3 * most : 5 * most + 1]
    mean = [(a + b) / 2.0 for a, b in zip(falling, rising, strict=True)]
    within = {k: mean[min(max(k, -steps), steps) + most] for k in range(-most, most + 1)}
    return [within[k] for k in _path(steps)]


def drawings(spec: Spec, quantities: Mapping[str, pl.DataFrame], vehicle: VehicleData) -> list[Drawing]:
    """Unloading of the leading axle over its angle, loop by loop."""
    steps = settings(spec, Settings).steps
    leading = two_bogies(resolved(vehicle))[0].axles[0].name
    found = []
    for loop, turned in angles(spec, vehicle).items():
        frame = quantities.get(loop)
        if frame is None or "level" not in frame.columns:
            continue
        x = [1e3 * turned[leading] * level for level in frame["level"].to_list()]
        inside = slice(3 * (steps + 1) + 1, 5 * (steps + 1))
        curves = []
        for side in ("left", "right"):
            y = [100.0 * v for v in frame[f"{leading}.{side}.unloading"].to_list()]
            mean = [100.0 * v for v in frame[f"{leading}.{side}.average_unloading"].to_list()]
            curves.append(DrawnCurve(name=f"{leading}.{side}", x=x, y=y))
            curves.append(
                DrawnCurve(name=f"{leading}.{side}, average", x=x[inside], y=mean[inside], role="points")
            )
        curves += [
            DrawnCurve(name=f"limit {one.max:g} %", x=[min(x), max(x)], y=[one.max, one.max], role="limit")
            for one in spec.criterion
            if one.max is not None and one.unit == "%" and one.applies_to(loop)
        ]
        found.append(
            Drawing(
                title=f"Twist: {loop}",
                x_label=f"angle of the track under {leading} (mrad)",
                y_label="wheel unloading (%)",
                curves=tuple(curves),
                caption="Raised, lowered and raised again; without friction all branches are one line.",
            )
        )
    return found


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """Nothing beside the verdicts."""
    return []
