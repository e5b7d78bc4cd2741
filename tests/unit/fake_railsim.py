"""A stand-in for the compiled core: the same interface, sinusoids for physics.

It lets the Python package be tested alone. Faults are worded like the core's, but what the core says is
tested with the core.
"""

from __future__ import annotations

import difflib
import json
import math
import re
import time
import tomllib
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

import polars as pl

WHEELSETS = 6
SLOW = 0.0
"""Seconds that a case takes at least; a test that interrupts a run sets it."""


class RailsimError(Exception):
    pass


class InputError(RailsimError):
    def __init__(self, faults: list[dict[str, Any]]) -> None:
        self.faults = faults
        super().__init__("\n".join(f"{fault['path']}: found {fault['found']}" for fault in faults))


class Tables:
    pass


class DivergenceError(RailsimError):
    pass


class ConvergenceError(RailsimError):
    pass


class Interrupted(RailsimError):
    pass


def _fault(key: Sequence[str | int], found: str, allowed: str, hint: str | None = None) -> dict[str, Any]:
    return {
        "key": list(key),
        "path": ".".join(map(str, key)),
        "found": found,
        "allowed": allowed,
        "hint": hint,
    }


def version() -> str:
    return "0.0.0"


def fingerprint() -> str:
    return "fake"


def toml_to_json(text: str) -> str:
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        at = re.search(r"line (\d+)", str(error))
        fault = _fault([], str(error), "TOML")
        fault["line"] = int(at[1]) if at else text.count("\n") + 1
        raise InputError([fault]) from None
    faults = [
        {**_fault(key, found, "a finite number"), "line": toml_line(text, key)}
        for key, found in _not_finite(data, ())
    ]
    if faults:
        raise InputError(faults)
    return json.dumps(data)


def _not_finite(data: Any, key: tuple[str | int, ...]) -> Iterator[tuple[tuple[str | int, ...], str]]:
    if isinstance(data, float) and not math.isfinite(data):
        yield key, "NaN" if math.isnan(data) else str(data)
    elif isinstance(data, dict | list):
        for step, value in data.items() if isinstance(data, dict) else enumerate(data):
            yield from _not_finite(value, (*key, step))


def toml_line(text: str, key: Sequence[str | int]) -> int | None:
    """Line of the deepest part of a key path, read off headers and `key =` lines."""
    lines: dict[tuple[str | int, ...], int] = {}
    table: tuple[str | int, ...] = ()
    counts: dict[str, int] = {}
    for number, line in enumerate(text.splitlines(), 1):
        many = re.match(r"\s*\[\[(.+?)\]\]", line)
        one = re.match(r"\s*\[([^\[].*?)\]", line)
        pair = re.match(r"\s*(\"[^\"]+\"|[\w-]+)\s*=", line)
        if many:
            counts[many[1]] = counts.get(many[1], -1) + 1
            table = (*many[1].split("."), counts[many[1]])
            lines[table] = number
        elif one:
            table = tuple(one[1].split("."))
            lines[table] = number
        elif pair:
            lines[(*table, pair[1].strip('"'))] = number
    for length in range(len(key), 0, -1):
        if tuple(key[:length]) in lines:
            return lines[tuple(key[:length])]
    return None


def vehicle_resolve(document_json: str, overrides_json: str, condition: str | None) -> str:
    document, overrides = json.loads(document_json), json.loads(overrides_json)
    parameters = document.setdefault("parameters", {})
    faults = []
    for name, value in overrides.items():
        if name not in parameters:
            near = difflib.get_close_matches(name, parameters, 1)
            hint = f'did you mean "{near[0]}"?' if near else None
            allowed = f"a named parameter: {', '.join(parameters)}"
            faults.append(_fault(["parameters", name], f'an unknown parameter "{name}"', allowed, hint))
        else:
            parameters[name] = value
    if faults:
        raise InputError(faults)
    return json.dumps(
        {
            "document": document,
            "name": document["name"],
            "title": document.get("title", document["name"]),
            "design_speed": document["design_speed_kmh"] / 3.6,
            "wheel_radius": 0.5,
            "wheel_profile": document["wheel_profile"],
            "track": document.get("track"),
            "conditions": sorted(document.get("condition", {})),
            "design_condition": "full",
            "mass": 134000.0,
            "bodies": ["carbody", "bogie1", "bogie2"],
        }
    )


def read_profile(text: str, name: str) -> str:
    lines = [
        line for line in text.splitlines() if line and not line.startswith("#") and not line[0].isalpha()
    ]
    points = [[float(word) for word in line.split(",")] for line in lines]
    if len(points) < 8:
        raise InputError([_fault(["profiles", name, "points"], f"{len(points)} points", "8 or more")])
    return json.dumps({"points": points})


_KNOWN = {
    "track": {"length", "gauge", "rail_profile", "irregularity", "fade_in"},
    "run": {"kind", "speed", "friction", "wheel_profile", "integrator", "output_step", "creep", "test"},
}


def check_case(case_json: str, tables: Tables | None = None) -> None:
    case = json.loads(case_json)
    faults = []
    for part, known in _KNOWN.items():
        for key in case[part]:
            if key not in known:
                near = difflib.get_close_matches(key, known, 1)
                hint = f'did you mean "{near[0]}"?' if near else None
                faults.append(_fault([part, key], f'an unknown key "{key}"', ", ".join(sorted(known)), hint))
    for index, body in enumerate(case["vehicle"].get("body", [])):
        if body["mass"] <= 0.0:
            faults.append(_fault(["vehicle", "body", index, "mass"], str(body["mass"]), "a number > 0 kg"))
    if "length" not in case["track"]:
        faults.append(_fault(["track", "length"], "nothing", "a number > 0 m"))
    if faults:
        raise InputError(faults)


def channels(case_json: str, tables: Tables | None = None) -> list[tuple[str, str, str]]:
    found = [("t", "s", "time"), ("s", "m", "distance along the track"), ("v", "m/s", "speed")]
    for pivot in ("lead_pivot", "trail_pivot"):
        found += [
            (f"carbody.{pivot}.ay", "m/s2", "lateral acceleration"),
            (f"carbody.{pivot}.az", "m/s2", "vertical acceleration"),
        ]
    for number in range(1, WHEELSETS + 1):
        found.append((f"ws{number}.y", "m", "lateral displacement"))
        for side in ("left", "right"):
            found += [
                (f"ws{number}.{side}.Q", "N", "vertical wheel force"),
                (f"ws{number}.{side}.Y", "N", "lateral wheel force"),
                (f"ws{number}.{side}.LV", "1", "ratio Y/Q"),
            ]
    return found


def track_extremes(case_json: str, tables: Tables | None = None) -> dict[str, tuple[float, float]]:
    return {
        "lateral": (-0.005, 0.0051),
        "vertical": (-0.006, 0.0058),
        "cross_level": (-0.004, 0.0041),
        "gauge": (-0.0038, 0.0039),
    }


def equivalent_conicity(case_json: str, amplitude: float, tables: Tables | None = None) -> float:
    return 0.15


class Frame:
    def __init__(self, frame: pl.DataFrame, ended: dict[str, Any]) -> None:
        self._frame = frame
        self.ended = ended
        self.statistics = {"steps": frame.height, "rhs": 2 * frame.height}

    @property
    def names(self) -> list[str]:
        return self._frame.columns

    @property
    def rows(self) -> int:
        return self._frame.height

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        return self._frame.__arrow_c_stream__(requested_schema)


def _simulate(case: dict[str, Any]) -> Frame | RailsimError:
    """Sinusoids; `run.test` asks for trouble: "diverge", "raise", "hole"."""
    run = case["run"]
    trouble = run.get("test")
    if trouble == "raise":
        return ConvergenceError("static equilibrium did not converge in 50 iterations")
    step, speed = run.get("output_step", 0.005), run["speed"]
    rows = int(case["track"]["length"] / speed / step) + 1
    if trouble == "diverge":
        rows //= 2
    # softer dampers, larger motion: the twin fails
    damper = case["vehicle"].get("parameters", {}).get("yaw_damper.cx", 1.0)
    size = 0.5 if damper > 0.0 else 6.0
    t = pl.Series("t", range(rows), dtype=pl.Float64) * step
    columns: dict[str, pl.Series] = {"t": t, "s": t * speed, "v": t * 0.0 + speed}
    phase = len(case["label"])
    for name, unit, _ in channels("")[3:]:
        phase += 1
        wave = (t * (2.0 * math.pi * 1.3) + phase).sin()
        offset, amplitude = {
            "m/s2": (0.0, size),
            "m": (0.0, 0.002 * size),
            "1": (0.1, 0.05),
            "N": (1.09e5, 5e3),
        }[unit]
        columns[name] = wave * amplitude + offset
    frame = pl.DataFrame(columns)
    if trouble == "hole":
        frame = frame.with_columns(
            pl.when(pl.int_range(pl.len()) == 400)
            .then(float("nan"))
            .otherwise(pl.col("carbody.lead_pivot.ay"))
            .alias("carbody.lead_pivot.ay")
        )
    end = frame.row(-1, named=True)
    if trouble == "diverge":
        message = f"run ended at t = {end['t']:.4f} s, s = {end['s']:.2f} m: ws1: derailed"
        return Frame(frame, {"kind": "diverged", "t": end["t"], "s": end["s"], "message": message})
    return Frame(frame, {"kind": "end_of_track", "t": end["t"], "s": end["s"], "message": None})


def run_cases(
    cases: Iterable[str],
    jobs: int,
    on_progress: Callable[[int, float, float, float], None],
    on_done: Callable[[int, Any], None],
    tables: Tables | None = None,
) -> None:
    texts = list(cases)
    # last first: results must find their own place
    for index in reversed(range(len(texts))):
        case = json.loads(texts[index])
        length = case["track"]["length"]
        for part in range(1, 11):
            time.sleep(SLOW / 10.0)
            on_progress(index, part / 10.0, length * part / 10.0, 25.0)
        on_done(index, _simulate(case))
