"""What a driven run looks like: effort over speed, adhesion over slip, slip, stops, brakes, parking, motors.

Each drawing is made where the frames have its channels, of all cases that have them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from lmap.formulas import falling_friction, notch_effort, polach_adhesion
from lmap.procedures.base import wheelsets
from lmap.spec.case import VehicleData
from lmap.verdict import Drawing, DrawnCurve
from lmap.view.model import table

if TYPE_CHECKING:
    import polars as pl

Frames = Mapping[str, "pl.DataFrame"]
Runs = Mapping[str, Mapping[str, Any]]
"""`[run]` of every case, by label."""
Stops = Mapping[str, float]
"""Time that the paper prints for the stop of a case, s."""

POINTS = 500
"""Of a curve, at most."""
STANDS = 0.5
"""m; a run that moves less is that of a parked vehicle."""
PAPER_PEAKS = {"dry": (0.08, 0.343), "wet": (0.19, 0.263)}
"""Slip and adhesion of the peaks of the paper's Figure 5."""
PAPER_SPEED = 22.0 / 3.6
"""m/s, of the same."""
WHEEL_LOAD = 109.5e3
"""N; of the paper's mean wheel force, for which the patch was worked out."""
PATCH = 80.77e9 * 7.7463e-3 * 5.4550e-3 * 4.30
"""G a b C11 (N) of Hertz's patch of the reference wheel on its rail at that load: where the formula is drawn."""


def drawings(quantities: Frames, runs: Runs, vehicle: VehicleData, published: Stops) -> list[Drawing]:
    """Everything that the frames have channels for."""
    frames = {label: _thinned(frame) for label, frame in quantities.items()}
    found = [
        _effort(_with(frames, "traction.effort", "v"), runs, vehicle),
        _adhesion(_with(frames, "traction.effort", "v"), runs),
        _slip(_with(frames, "traction.effort", "v"), runs, vehicle),
        _stop(_with(frames, "v"), published),
        _pressures(_with(frames, "brake.cylinder")),
        _blocks(_with(frames, "brake.block_force")),
        _parked(_with(frames, "s")),
        _motors(frames),
    ]
    return [one for one in found if one is not None]


def _thinned(frame: pl.DataFrame) -> pl.DataFrame:
    every = max(1, -(-frame.height // POINTS))
    rows = [*range(0, frame.height - 1, every), frame.height - 1]
    return frame[rows]


def _with(frames: Frames, *names: str) -> dict[str, pl.DataFrame]:
    return {label: one for label, one in frames.items() if set(names) <= set(one.columns)}


def _numbers(frame: pl.DataFrame, name: str, factor: float = 1.0) -> list[float]:
    return [factor * value for value in frame[name].to_list()]


def _curve(name: str, x: Sequence[float], y: Sequence[float], role: Any = "line") -> DrawnCurve:
    return DrawnCurve(name=name, x=list(x), y=list(y), role=role)


def _moves(frame: pl.DataFrame) -> bool:
    return float(frame["s"][-1] - frame["s"][0]) > STANDS


# ---- traction


def _effort(frames: Frames, runs: Runs, vehicle: VehicleData) -> Drawing | None:
    """Tractive effort over speed: what each notch gives, and the way that the runs took."""
    pulling = {
        label: one
        for label, one in frames.items()
        if _moves(one) and max(_numbers(one, "traction.effort")) > 0.0
    }
    data = table(vehicle, "traction")
    if not pulling or not data:
        return None
    fastest = 1.15 * max(max(_numbers(one, "v")) for one in pulling.values())
    speeds = [fastest * i / 120 for i in range(121)]
    curves = []
    for notch in range(1, int(data["notches"]) + 1):
        efforts = [1e-3 * _notch(data, notch, v) for v in speeds]
        curves.append(_curve(f"notch {notch}", [3.6 * v for v in speeds], efforts, "reference"))
    if not data.get("notch_curves"):
        most = 1.1 * max(max(curve.y) for curve in curves)
        shown = [v for v in speeds[1:] if 1e-3 * data["power_at_rail"] / v <= most]
        power = [1e-3 * data["power_at_rail"] / v for v in shown]
        if shown:
            curves.append(_curve("power at the rail", [3.6 * v for v in shown], power, "limit"))
    limits = {run["drive"]["effort_limit"] for run in runs.values() if "effort_limit" in run.get("drive", {})}
    curves += [
        _curve(f"effort limit {1e-3 * limit:g} kN", [0.0, 3.6 * fastest], [1e-3 * limit] * 2, "limit")
        for limit in sorted(limits)
    ]
    for label, one in pulling.items():
        curves.append(_curve(label, _numbers(one, "v", 3.6), _numbers(one, "traction.effort", 1e-3)))
    return Drawing(
        title="Tractive effort over speed",
        x_label="speed (km/h)",
        y_label="effort of all motors at the rims (kN)",
        curves=tuple(curves),
        caption="Grey: what each notch of the vehicle asks for. The runs lie below it by the inverter's lag, the "
        "effort limit and what the slip control takes off.",
    )


def _notch(data: Mapping[str, Any], notch: int, speed: float) -> float:
    curves = data.get("notch_curves")
    if curves:
        speeds, efforts = np.array(curves[notch - 1], dtype=float).T
        return float(np.interp(speed, speeds, efforts))
    return notch_effort(notch / data["notches"], speed, data["max_effort"], data["power_at_rail"])


def _adhesion(frames: Frames, runs: Runs) -> Drawing | None:
    """Creep force over load of the leading wheelset over its slip, and the formula with the friction of the run."""
    curves = [_shares(label, one) for label, one in frames.items() if _moves(one)]
    if not curves:
        return None
    sign = -1.0 if sum(sum(curve.y) for curve in curves) < 0.0 else 1.0
    farthest = min(0.4, max(0.25, 1.15 * max(max(map(abs, curve.x), default=0.0) for curve in curves)))
    slips = [farthest * i / 250 for i in range(251)]
    rails = {repr(law): (name, law) for run in runs.values() for name, law in _rails(run)}
    for name, law in rails.values():
        values = [sign * _polach(law, slip) for slip in slips]
        curves.append(_curve(f"Polach, {name}", [sign * slip for slip in slips], values, "limit"))
    for name in dict.fromkeys(name for name, _ in rails.values()):
        if name in PAPER_PEAKS and sign > 0.0:
            where, peak = PAPER_PEAKS[name]
            curves.append(_curve(f"peak in the paper, {name}", [where], [peak], "mark"))
    return Drawing(
        title="Adhesion over slip",
        x_label="slip of the leading wheelset",
        y_label="longitudinal creep force over wheel load",
        curves=tuple(curves),
        caption="Points: the run, above 1 m/s. Dashed: Polach's formula with the run's friction at 22 km/h, the "
        "paper's speed, for Hertz's patch of the reference wheel at 109.5 kN. Friction falls with the slip "
        "velocity: slower runs lie above it, faster ones below.",
    )


def _shares(label: str, frame: pl.DataFrame) -> DrawnCurve:
    """Creep force of the leading wheelset over its load, over its slip, while it rolls."""
    first = wheelsets(frame.columns)[0]
    channels = [f"{first}.{side}.{what}" for what in ("Fx", "Q") for side in ("left", "right")]
    slip, share = [], []
    for v, found, *forces in frame.select("v", f"{first}.slip", *channels).iter_rows():
        load = forces[2] + forces[3]
        if v > 1.0 and load > 0.0:
            slip.append(found)
            share.append((forces[0] + forces[1]) / load)
    return _curve(f"{label}, {first}", slip, share, "points")


def _rails(run: Mapping[str, Any]) -> Iterator[tuple[str, dict[str, float]]]:
    """Name and law of each rail condition that a run meets: Table 4's are known by their friction."""
    creep, friction = run.get("creep", {}), run.get("friction")
    if creep.get("kind") != "polach" or not isinstance(friction, Mapping) or "value" not in friction:
        return
    for written in (friction, *friction.get("along", ())):
        falling = written.get("falling", friction.get("falling", {}))
        reduced = {**creep, **written.get("reduction", {})}
        law = {
            "friction": float(written["value"]),
            "ratio": float(falling.get("ratio", 1.0)),
            "decay": float(falling.get("decay", 0.0)),
            "k_a": float(reduced.get("k_a", 1.0)),
            "k_s": float(reduced.get("k_s", 1.0)),
        }
        name = {0.47: "dry", 0.30: "wet"}.get(law["friction"], f"friction {law['friction']:g}")
        yield name, law


def _polach(law: Mapping[str, float], slip: float) -> float:
    friction = falling_friction(law["friction"], law["ratio"], law["decay"], slip * PAPER_SPEED)
    return polach_adhesion(slip, friction, law["k_a"], law["k_s"], PATCH, WHEEL_LOAD)


def _slip(frames: Frames, runs: Runs, vehicle: VehicleData) -> Drawing | None:
    """Slip of the fastest wheelset over time, with the set-point and the limiter."""
    moving = {label: one for label, one in frames.items() if _moves(one)}
    if not moving:
        return None
    data = table(vehicle, "traction")
    sign = -1.0 if all(sum(_numbers(one, "traction.effort")) < 0.0 for one in moving.values()) else 1.0
    curves = []
    for label, one in moving.items():
        names = [name for name in one.columns if name.endswith(".slip")]
        rows = zip(*(one[name].to_list() for name in names), strict=True)
        curves.append(
            _curve(
                f"{label}, fastest" if sign > 0.0 else f"{label}, slowest",
                _numbers(one, "t"),
                [sign * max(sign * v for v in row) for row in rows],
            )
        )
    end = max(max(curve.x) for curve in curves)
    drives = [run.get("drive", {}) for label, run in runs.items() if label in moving]
    controlled = [drive for drive in drives if drive.get("slip_control", True)]
    for demand in _distinct(drive.get("slip_reference", data.get("slip_reference")) for drive in controlled):
        x, y = _steps(demand, end)
        curves.append(_curve("set-point", x, [sign * one for one in y], "limit"))
    limits = _distinct(drive.get("slip_limit", data.get("slip_limit")) for drive in controlled)
    curves += [_curve("limiter", [0.0, end], [sign * float(limit)] * 2, "limit") for limit in limits]
    return Drawing(
        title="Slip over time",
        x_label="time t (s)",
        y_label="slip of a wheelset",
        curves=tuple(curves),
        caption="The wheelset that slips most, at each instant. At low speed slip is taken over 1 m/s.",
    )


def _distinct(values: Iterator[Any]) -> list[Any]:
    found: list[Any] = []
    for value in values:
        if value is not None and value not in found:
            found.append(value)
    return found


def _steps(demand: Any, end: float) -> tuple[list[float], list[float]]:
    """A demand of a run as a stair over time."""
    if isinstance(demand, int | float):
        return [0.0, end], [float(demand)] * 2
    x: list[float] = []
    y: list[float] = []
    for (begin, value), (until, _) in pairwise([*demand, (end, 0.0)]):
        x += [begin, until]
        y += [value, value]
    return x, y


# ---- brakes


def _stop(frames: Frames, published: Stops) -> Drawing | None:
    """Speed over time of what is braked; the paper's Table 8 where it prints a time."""
    stops = {label: one for label, one in frames.items() if _moves(one) and one["v"][-1] < 0.6 * one["v"][0]}
    if not stops:
        return None
    curves = [_curve(label, _numbers(one, "t"), _numbers(one, "v", 3.6)) for label, one in stops.items()]
    for label, one in stops.items():
        if label in published:
            end = 3.6 * float(one["v"][-1])
            name = f"printed, {label}: {published[label]:g} s"
            curves.append(_curve(name, [published[label]], [end], "mark"))
    return Drawing(
        title="Speed over time",
        x_label="time t (s)",
        y_label="speed (km/h)",
        curves=tuple(curves),
        caption="Points: the times that the paper prints (its Table 8)." if published else "",
    )


def _pressures(frames: Frames) -> Drawing | None:
    return _over_time(frames, "brake.cylinder", 1e-3, "Brake cylinder pressure", "pressure (kPa)")


def _blocks(frames: Frames) -> Drawing | None:
    return _over_time(frames, "brake.block_force", 1e-3, "Block force", "all blocks of a wheelset (kN)")


def _parked(frames: Frames) -> Drawing | None:
    """Way of a vehicle that stands, from its start, mm."""
    standing = {label: one for label, one in frames.items() if not _moves(one) and "v" in one.columns}
    if not standing:
        return None
    curves = [
        _curve(label, _numbers(one, "t"), [1e3 * (s - float(one["s"][0])) for s in one["s"].to_list()])
        for label, one in standing.items()
    ]
    return Drawing(
        title="Movement of the parked vehicle",
        x_label="time t (s)",
        y_label="movement of the car body (mm)",
        curves=tuple(curves),
        caption="At the start suspension, blocks and contacts give way elastically, until they carry; then it stands.",
    )


def _motors(frames: Frames) -> Drawing | None:
    """Temperature rise of each bogie's motors, where the vehicle declares a rating."""
    curves = [
        _curve(f"{label}, {name.split('.')[1]}", _numbers(one, "t"), _numbers(one, name))
        for label, one in frames.items()
        for name in one.columns
        if name.startswith("traction.") and name.endswith(".temperature")
    ]
    if not curves:
        return None
    end = max(max(curve.x) for curve in curves)
    curves.append(_curve("limit", [0.0, end], [1.0, 1.0], "limit"))
    return Drawing(
        title="Temperature rise of the traction motors",
        x_label="time t (s)",
        y_label="share of what the continuous rating gives",
        curves=tuple(curves),
    )


def _over_time(frames: Frames, channel: str, factor: float, title: str, y_label: str) -> Drawing | None:
    """A channel over time, in the cases in which it is ever more than nothing."""
    curves = [
        _curve(label, _numbers(one, "t"), _numbers(one, channel, factor))
        for label, one in frames.items()
        if max(_numbers(one, channel)) > 0.0
    ]
    if not curves:
        return None
    return Drawing(title=title, x_label="time t (s)", y_label=y_label, curves=tuple(curves))
