"""Numerical stability (LMAP 1.5): the same run with a fine and a coarse step, released out of balance.

One case for each integrator that `run.integrator` lists, wheel profile and speed. The start is disturbed
(`run.disturbance`), and the disturbance should die away alike with every step. Columns added to the frames, the same in
every row:

- `settle_time`: the last time, s, at which any wheel force is further from its mean over the run than `test.band`;
- `settle_spread`: the latest settle time over all cases against the earliest, as a share of this;
- `residual_leading`, `residual_trailing`: amplitude, N, that a wheel force of the front and rear half of the
  vehicle still has in the last `test.residual_s`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict, Field

from lmap.errors import InputProblem, JudgementProblem, KeyPath, Problem
from lmap.procedures.base import CaseFigures, expand, settings
from lmap.spec.case import Case, VehicleData
from lmap.spec.model import Spec
from lmap.verdict import Drawing, DrawnCurve, Fact
from lmap.view.model import resolved

if TYPE_CHECKING:
    import polars as pl

NAME = "step"
SUMMARY = "a disturbed start on ideal straight track with a fine and a coarse step: when it has settled"
UNITS: Mapping[str, str] = {
    "residual_leading": "N",
    "residual_trailing": "N",
    "settle_spread": "1",
    "settle_time": "s",
}


class Settings(BaseModel):
    """`[test]`."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    band: float = Field(gt=0.0, lt=1.0, allow_inf_nan=False)
    """Share of its mean that a settled wheel force keeps within."""
    residual_s: float = Field(gt=0.0, allow_inf_nan=False)
    """The last seconds of a run, in which nothing should move any more."""


SETTINGS = Settings


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """A case for every integrator, wheel profile and speed; the label says scheme and step, then what else varies."""
    written = spec.run.rest.get("integrator")
    integrators = written if isinstance(written, list) else [written]
    found = []
    for index, integrator in enumerate(integrators):
        if not isinstance(integrator, Mapping):
            allowed = '{ kind = "ros2", step = 0.001 }, or a list of such tables'
            key = ("run", "integrator", index) if isinstance(written, list) else ("run", "integrator")
            raise InputProblem(Problem(key=key, found=repr(integrator), allowed=allowed))
        run = spec.run.model_copy(update={"integrator": integrator})
        alike = expand(spec.model_copy(update={"run": run}), vehicle)
        found += [
            Case(_scheme(integrator) + (f" {case.label}" if len(alike) > 1 else ""), case.data)
            for case in alike
        ]
    return [Case(case.label, {**case.data, "label": case.label}) for case in found]


def origin(spec: Spec, label: str, key: KeyPath) -> KeyPath:
    """A key of the integrator is written in one table of a list."""
    written = spec.run.rest.get("integrator")
    if isinstance(written, list) and key[:2] == ("run", "integrator"):
        for index, integrator in enumerate(written):
            if label.startswith(_scheme(integrator)):
                return ("run", "integrator", index, *key[2:])
    return key


def _scheme(integrator: Mapping[str, Any]) -> str:
    step = integrator.get("step")
    size = f" {step * 1e3:g} ms" if isinstance(step, int | float) else ""
    return f"{integrator.get('kind', 'no scheme')}{size}"


def quantities(
    spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
) -> Mapping[str, pl.DataFrame]:
    """The frames with their settle times and what is left of the motion."""
    import polars as pl

    wheels = _wheels(vehicle)
    if not all({"t", *wheels} <= set(frame.columns) for frame in frames.values()):
        return frames  # its criteria then say which channel is missing
    own = settings(spec, Settings)
    times = {label: _settle_time(frame, list(wheels), own.band) for label, frame in frames.items()}
    spread = max(times.values()) / min(times.values()) - 1.0
    found = {}
    for label, frame in frames.items():
        late = frame.filter(pl.col("t") >= frame["t"][-1] - own.residual_s)
        found[label] = frame.with_columns(
            settle_time=pl.lit(times[label]),
            settle_spread=pl.lit(spread),
            residual_leading=pl.lit(_amplitude(late, [name for name, x in wheels.items() if x >= 0.0])),
            residual_trailing=pl.lit(_amplitude(late, [name for name, x in wheels.items() if x <= 0.0])),
        )
    return found


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """None."""
    return []


def drawings(spec: Spec, quantities: Mapping[str, pl.DataFrame], vehicle: VehicleData) -> list[Drawing]:
    """Vertical force of the first wheel in every case, with the band that it settles into."""
    wheel = next(iter(_wheels(vehicle)), None)
    if wheel is None:
        return []
    curves = []
    for label, frame in quantities.items():
        t, force = frame["t"].to_list(), [value * 1e-3 for value in frame[wheel].to_list()]
        curves.append(DrawnCurve(name=label, x=t, y=force))
    first = next(iter(quantities.values()))
    ends = [float(first["t"][0]), float(first["t"][-1])]
    band = settings(spec, Settings).band
    mean = 1e-3 * float(first[wheel].to_numpy().mean())
    for name, level in (("upper edge", mean * (1.0 + band)), ("lower edge", mean * (1.0 - band))):
        curves.append(DrawnCurve(name=name, x=ends, y=[level, level], role="limit"))
    title = "The start-up disturbance dies away"
    return [Drawing(title=title, x_label="t (s)", y_label=f"{wheel} (kN)", curves=tuple(curves))]


def _wheels(vehicle: VehicleData) -> dict[str, float]:
    """Channel of each vertical wheel force, from the front, with the wheelset's place along the vehicle, m."""
    wheelsets = sorted(resolved(vehicle).wheelsets, key=lambda one: -one.position[0])
    return {f"{one.name}.{side}.Q": one.position[0] for one in wheelsets for side in ("left", "right")}


def _settle_time(frame: pl.DataFrame, wheels: Sequence[str], band: float) -> float:
    import numpy as np

    force = frame.select(wheels).to_numpy()
    mean = force.mean(axis=0)
    outside = np.flatnonzero(np.any(np.abs(force - mean) > band * np.abs(mean), axis=1))
    if not outside.size or outside[-1] == 0:
        raise JudgementProblem(
            f"the start moves no wheel force by more than {band:g} of its mean: nothing settles"
        )
    return float(frame["t"][int(outside[-1])])


def _amplitude(frame: pl.DataFrame, wheels: Sequence[str]) -> float:
    """Half of the largest peak-to-peak of any of these forces."""
    import numpy as np

    return float(np.ptp(frame.select(wheels).to_numpy(), axis=0).max() / 2.0) if wheels else 0.0
