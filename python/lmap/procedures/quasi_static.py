"""A slow push (LMAP 1.3): the car body is displaced step by step, and everything else finds its balance.

One case for each wheel profile and speed; `run.load` says what is pushed, its first displacement is what the figures
refer to. `speed = 0` stands; a rolling vehicle steers by creep. Judged are the columns of the frame without the first
row (nothing pushed yet) and, where the push is along z or y of a body that stands on bogies:

- `stiffness`: reaction to the push for each metre of it, N/m;
- `stiffness_error`: change of all wheel loads, for each metre, against secondary and primary springs in series (z);
- `nonlinearity`: the reaction against a straight line through its last value, as a share of that;
- `bogie_difference`: front against rear bogie along the push, as a share of the larger motion; `yaw_difference` their
  yaw (y);
- `load_difference`: changes of the wheel loads against their mirror images, left/right and front/rear, as a share of
  their mean size (z).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from lmap.errors import InputProblem, JudgementProblem, Problem
from lmap.procedures import suspension
from lmap.procedures.base import CaseFigures
from lmap.spec.case import Case, VehicleData, build
from lmap.spec.model import Spec
from lmap.verdict import Drawing, DrawnCurve, Fact
from lmap.view.model import Model, resolved

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt
    import polars as pl

    Array = npt.NDArray[np.float64]

NAME = "quasi_static"
SUMMARY = "the car body pushed down or aside in steps, at rest or rolling: wheel loads, bogies"
UNITS: Mapping[str, str] = {
    "bogie_difference": "1",
    "load_difference": "1",
    "nonlinearity": "1",
    "stiffness": "N/m",
    "stiffness_error": "1",
    "yaw_difference": "1",
}


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """A case for every wheel profile and speed; without a speed it stands."""
    _pushed(spec)
    speeds = [0.0] if spec.run.speeds is None else [v.resolve(vehicle.design_speed) for v in spec.run.speeds]
    profiles = spec.run.wheel_profile or [vehicle.wheel_profile or ""]
    found = []
    for profile in profiles:
        for speed in speeds:
            parts = [profile] if spec.run.wheel_profile else []
            if len(speeds) > 1 or not parts:
                parts.append(f"{speed * 3.6:.6g} km/h" if speed > 0.0 else "at rest")
            run: dict[str, Any] = {"kind": "quasi_static", **spec.run.rest, "speed": speed}
            if profile:
                run["wheel_profile"] = profile
            found.append(build(label=" ".join(parts), vehicle=vehicle, track=spec.track, run=run))
    return found


def quantities(
    spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
) -> Mapping[str, pl.DataFrame]:
    """The frames without their first row, with the figures of the push."""
    body, axis = _pushed(spec)
    found = {}
    for label, frame in frames.items():
        if {f"{body}.{axis}", f"{body}.{axis}.reaction"} <= set(frame.columns) and frame.height > 1:
            found[label] = _with_figures(frame, resolved(vehicle), body, axis)
        else:  # its criteria then say which channel is missing
            found[label] = frame
    return found


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """None."""
    return []


def drawings(spec: Spec, quantities: Mapping[str, pl.DataFrame], vehicle: VehicleData) -> list[Drawing]:
    """The reaction, and the bogies' yaw, against the push."""
    body, axis = _pushed(spec)
    push = f"{body}.{axis}"
    bogies = suspension.bogies(resolved(vehicle), body)
    forces, turns = [], []
    for label, frame in quantities.items():
        x = [value * 1e3 for value in frame[push].to_list()]
        reaction = [value * 1e-3 for value in frame[f"{push}.reaction"].to_list()]
        forces.append(DrawnCurve(name=label, x=x, y=reaction))
        for bogie in bogies:
            y = [value * 1e3 for value in frame[f"{bogie}.psi"].to_list()]
            turns.append(DrawnCurve(name=f"{bogie}, {label}", x=x, y=y))
    where = f"{push} (mm)"
    drawn = [
        Drawing(title="Reaction to the push", x_label=where, y_label="reaction (kN)", curves=tuple(forces))
    ]
    if turns and axis == "y":
        drawn.append(
            Drawing(title="Yaw of the bogies", x_label=where, y_label="yaw (mrad)", curves=tuple(turns))
        )
    return drawn


def _pushed(spec: Spec) -> tuple[str, str]:
    """Body and axis of the displacement that figures refer to."""
    loads = spec.run.rest.get("load", [])
    for load in loads if isinstance(loads, list) else []:
        name = load.get("coordinate") if isinstance(load, Mapping) else None
        if isinstance(name, str):
            body, _, axis = name.rpartition(".")
            if body and axis in ("y", "z"):
                return body, axis
    allowed = (
        '[{ kind = "displacement", coordinate = "carbody.z", path = [0.0, 0.05] }], along y or z of a body'
    )
    raise InputProblem(Problem(key=("run", "load"), found="no displacement of a body", allowed=allowed))


def _with_figures(frame: pl.DataFrame, model: Model, body: str, axis: str) -> pl.DataFrame:
    import numpy as np
    import polars as pl

    def change(name: str) -> Array:
        values = frame[name].to_numpy()
        return np.asarray(values[1:] - values[0], dtype=np.float64)

    push, reaction = change(f"{body}.{axis}"), change(f"{body}.{axis}.reaction")
    if not bool(np.all(push != 0.0)):
        raise JudgementProblem(f"{body}.{axis} comes back to where it was: figures of the push need one way")
    straight = reaction[-1] / push[-1] * push
    added = {
        "stiffness": reaction / push,
        "nonlinearity": np.abs(reaction - straight) / abs(reaction[-1]),
    }
    pair = suspension.bogies(model, body)
    if len(pair) == 2:
        added["bogie_difference"] = _difference(*(change(f"{name}.{axis}") for name in pair))
        if axis == "y":
            added["yaw_difference"] = _difference(*(change(f"{name}.psi") for name in pair))
    if axis == "z":
        loads = {
            (wheelset.position[0], side): change(f"{wheelset.name}.{side}.Q")
            for wheelset in model.wheelsets
            for side in ("left", "right")
        }
        total = np.sum(list(loads.values()), axis=0)
        added["stiffness_error"] = total / push / suspension.vertical_stiffness(model, body) - 1.0
        added["load_difference"] = _against_mirror(loads)
    return frame.slice(1).with_columns(**{name: pl.Series(values) for name, values in added.items()})


def _difference(first: Array, second: Array) -> Array:
    """By how much two motions differ, as a share of the larger; 0 where neither moves."""
    import numpy as np

    larger = np.maximum(np.abs(first), np.abs(second))
    return np.divide(np.abs(first - second), larger, out=np.zeros_like(larger), where=larger > 0.0)


def _against_mirror(loads: Mapping[tuple[float, str], Array]) -> Array:
    """Largest difference of a wheel's change of load to its mirror images', as a share of the mean size."""
    import numpy as np

    other = {"left": "right", "right": "left"}
    mean = np.mean([np.abs(values) for values in loads.values()], axis=0)
    worst = np.zeros_like(mean)
    for (x, side), values in loads.items():
        images = [loads[x, other[side]]]
        nearest = min(loads, key=lambda place: (abs(place[0] + x), place[1] != side))
        images.append(loads[nearest])
        for image in images:
            worst = np.maximum(worst, np.abs(values - image))
    return np.asarray(worst / mean, dtype=np.float64)
