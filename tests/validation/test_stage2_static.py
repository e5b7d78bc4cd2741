"""Static and quasi-static tests of stage 2 against closed forms and published figures."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import lmap
from lmap.analyse import vehicle_case
from lmap.simulate import simulate
from lmap.vehicle import Vehicle

Compare = Callable[..., None]
pytestmark = pytest.mark.needs_core

SPECS = Path(__file__).parents[2] / "specs"
G = 9.80665
WHEEL_LOAD = 134_000.0 * G / 12.0
# coco134
PRIMARY_KZ, SECONDARY_KZ, SPRING_Y = 4.0e6, 5.8e5, 1.05
AXLE_ROLL = 2.0 * PRIMARY_KZ * SPRING_Y**2
SECONDARY_ROLL = 4.0 * SECONDARY_KZ * SPRING_Y**2
BODY_TWIST, BOGIE_TWIST = 15e-3 / 13.2 + 2e-3, 7e-3 - 5e-3 / 3.8
ANNEX_E = "[calc] of the standards' digest"
# Contact without guidance or friction: what the springs alone do.
ROLLERS: dict[str, Any] = {
    "kind": "textbook",
    "conicity": 0.0,
    "f11": 1e7,
    "f22": 1e7,
    "f23": 0.0,
    "stiffness": 1e9,
    "damping": 0.0,
}


def ran(run: dict[str, Any], track: dict[str, Any] | None = None, name: str = "coco134") -> pl.DataFrame:
    vehicle = Vehicle.load(name)
    return simulate(vehicle_case(vehicle.data, vehicle.document.path, run, label="x", track=track))


def series(*stiffnesses: float) -> float:
    return 1.0 / sum(1.0 / one for one in stiffnesses)


def turned(angles: dict[int, float]) -> list[dict[str, Any]]:
    return [
        {
            "kind": "displacement",
            "coordinate": f"ws{axle}.track_phi",
            "path": [0.0, angles.get(axle, 0.0)],
        }
        for axle in range(1, 7)
    ]


def judged(name: str, **settings: Any) -> dict[tuple[str, str], float]:
    """Values of a spec's criteria, by criterion and case, in their units."""
    [spec] = lmap.check(SPECS / f"{name}.toml", set=settings).specs
    return {(one.name, one.case): float(one.value) for one in spec.criteria if one.value is not None}


def test_axle_loads_are_the_weight(compare: Compare) -> None:
    frame = ran({"kind": "equilibrium", "speed": 0.0})
    loads = [frame[f"ws{w}.left.Q"][0] + frame[f"ws{w}.right.Q"][0] for w in range(1, 7)]
    compare("sum of the axle loads, kN", sum(loads) / 1e3, 134.0 * G, 0.01, "134 t")
    compare("wheel load, kN", loads[0] / 2e3, 109.508, 0.005, ANNEX_E)


def test_twist_of_springs_alone(compare: Compare) -> None:
    """Springs of both stages and contacts in series and parallel, less what the weight on a tilted axle gives back.

    The axle is held above the middle of the track: P r phi. The lean of the frame is left out: 0.5 %.
    """
    half = BOGIE_TWIST * 1.9 / 1.5
    contact = 2.0 * ROLLERS["stiffness"] * 0.75**2
    lean = (2.0 * WHEEL_LOAD - 2850.0 * G) * 0.5335
    axle = series(AXLE_ROLL, contact)
    frame = ran(_rollers({1: half, 3: -half}))
    ours = 100.0 * abs(frame["ws1.left.Q"][-1] / WHEEL_LOAD - 1.0)
    theirs = 100.0 * (axle - lean) * half / 1.5 / WHEEL_LOAD
    compare("twist on rollers, bogie evenly, % of Q0", ours, theirs, 0.15, "springs in series")

    other_bogie = series(SECONDARY_ROLL, 3.0 * axle)
    rest = 2.0 * axle + series(SECONDARY_ROLL, other_bogie)
    frame = ran(_rollers({1: 2.0 * half}))
    ours = 100.0 * abs(frame["ws1.left.Q"][-1] / WHEEL_LOAD - 1.0)
    theirs = 100.0 * (series(axle, rest) - lean) * 2.0 * half / 1.5 / WHEEL_LOAD
    compare("twist on rollers, axle 1 alone, % of Q0", ours, theirs, 0.6, "springs in series")


def _rollers(angles: dict[int, float]) -> dict[str, Any]:
    return {
        "kind": "quasi_static",
        "speed": 0.0,
        "contact": ROLLERS,
        "load": turned(angles),
        "load_steps": 1,
        "hold": [f"ws{w}.y" for w in range(1, 7)],
    }


@pytest.mark.slow
def test_twist_of_the_reference_locomotive_beside_the_digest(compare: Compare) -> None:
    """Rolling, so that wheels give way sideways. The digest's figures lie between wheels that are free (38.7 and 52.7 %
    by springs alone) and wheels that stick (54 and 76 %, the primary's lateral stiffness at axle height): see
    docs/concepts/stage2_static.md. Body twist takes 6.6 % by springs, less what the bogie's own lean gives back."""
    body, half = BODY_TWIST * 13.2 / 1.5 / 2.0, BOGIE_TWIST * 1.9 / 1.5
    level = {w: (body if w < 4 else -body) for w in range(1, 7)}
    loops: dict[str, tuple[dict[int, float], float, float]] = {
        "bogies level": (level, 6.0, 1.0),
        "bogie evenly": ({1: half, 3: -half}, 43.0, 3.0),
        "bogie and body": ({**level, 1: body + half, 3: body - half}, 49.0, 4.0),
        "axle 1 alone": ({1: 2.0 * half}, 60.0, 7.0),
    }
    for name, (angles, theirs, tolerance) in loops.items():
        run = {"kind": "quasi_static", "speed": 0.5, "load": turned(angles), "load_steps": 4}
        frame = ran(run)
        ours = 100.0 * max(abs(frame[f"ws1.{side}.Q"][-1] / WHEEL_LOAD - 1.0) for side in ("left", "right"))
        compare(f"twist, {name}, % of Q0", ours, theirs, tolerance, ANNEX_E)


@pytest.mark.parametrize(("radius", "x"), [(160.0, 0.057), (100.0, 0.091), (80.0, 0.114)])
def test_x_factor_of_a_linear_bogie(radius: float, x: float, compare: Compare) -> None:
    """1.1475 MN m/rad of the secondary springs, turned by 6.6 m over the radius, without the dampers."""
    angle = 6.6 / radius
    held = [f"carbody.{part}" for part in ("x", "y", "z", "phi", "theta", "psi")]
    load = [{"kind": "displacement", "coordinate": "bogie1.psi", "path": [0.0, angle]}]
    frame = ran(
        {
            "kind": "quasi_static",
            "speed": 0.0,
            "load": load,
            "load_steps": 1,
            "hold": held,
            "contact": ROLLERS,
        }
    )
    moment = abs(frame["bogie1.psi.reaction_moment"][-1])
    compare(f"X factor, R {radius:g} m", moment / (3.8 * 2.0 * WHEEL_LOAD), x, 0.001, ANNEX_E)


def test_the_moment_in_the_curve_is_that_of_the_springs_and_of_the_loop(compare: Compare) -> None:
    """2C.4b (a): what all connections put on the frame in the curve, beside the springs and the loop at that angle."""
    found = judged("bogie_rotation", **{"test.rate": 0.0})
    for condition, load in (("tare", 126.0), ("full", 134.0)):
        curve = f"curve, 40 km/h, {condition}"
        moment, angle = found["moment", curve], found["angle of the bogie under the body", curve]
        compare(
            f"moment, {condition}, kN m",
            moment,
            1.1475 * angle,
            0.15,
            "the secondary springs, times the angle",
        )
        loop = found["moment of the standing loop at the angle in the curve", curve]
        compare(f"moment, {condition}, beside the loop, kN m", moment, loop, 0.15, "the loop at the angle")
        x = moment / (3.8 * load * G / 6.0)
        compare(f"X factor, {condition}", found["X factor, in the curve", curve], x, 1e-9, "M/(2a 2Q0)")


def test_the_moment_on_a_turned_bogie_is_what_holds_it_there() -> None:
    """`yaw_moment` by its sign: springs turn back what the reaction holds."""
    held = [f"carbody.{part}" for part in ("x", "y", "z", "phi", "theta", "psi")]
    load = [{"kind": "displacement", "coordinate": "bogie1.psi", "path": [0.0, 0.04]}]
    run = {
        "kind": "quasi_static",
        "speed": 0.0,
        "contact": ROLLERS,
        "load": load,
        "load_steps": 1,
        "hold": held,
    }
    frame = ran(run)
    assert frame["bogie1.yaw_moment"][-1] == pytest.approx(-1.1475e6 * 0.04, rel=1e-3)
    assert frame["bogie1.yaw_moment"][-1] == pytest.approx(-frame["bogie1.psi.reaction_moment"][-1], rel=1e-4)
    assert abs(frame["bogie2.yaw_moment"][-1]) < 50.0


def test_the_moment_in_a_curve_hangs_on_the_angle_alone(compare: Compare) -> None:
    """What (a) of 2C.4b rests on: 20 mm of sway beside 36 mrad of yaw leave the moment of the loop as it is."""
    angle = 0.036

    def moment(across: float) -> float:
        load = [
            {"kind": "displacement", "coordinate": f"bogie1.{part}", "path": [0.0, value]}
            for part, value in (("psi", angle), ("y", across))
        ]
        held = [f"carbody.{part}" for part in ("x", "y", "z", "phi", "theta", "psi")]
        run = {"kind": "quasi_static", "speed": 0.0, "contact": ROLLERS, "load": load, "load_steps": 1}
        return float(abs(ran(run | {"hold": held})["bogie1.psi.reaction_moment"][-1]))

    compare("moment with sway, kN m", moment(0.02) / 1e3, moment(0.0) / 1e3, 0.2, "the same without")
    compare("moment, kN m", moment(0.0) / 1e3, 1147.5 * angle, 0.3, "the secondary springs")


def test_yaw_dampers_add_their_share_at_a_degree_per_second(compare: Compare) -> None:
    slow = judged("bogie_rotation", **{"test.rate": 0.0})
    stated = judged("bogie_rotation")
    added = stated["moment", "standing, tare"] - slow["moment", "standing, tare"]
    # 6.8 kN m of the yaw dampers; the secondary springs' own damping is another 0.27
    compare("moment of the dampers at 1 deg/s, kN m", added, 6.84 + 0.27, 0.02, ANNEX_E)


def _sway(height: float) -> tuple[float, float]:
    """Roll and lateral place of coco134's body on a tilt of one, linear, in the plane; rails and axles rigid.

    Unknowns: lateral and roll of the bogie frames and of the body. Springs keep their preload, whose direction turns
    with the mean of both their ends and whose couple is shared between them.
    """
    bogies, body = 2.0 * 14860.0, 87180.0
    low, high = 0.75, height
    k = np.zeros((4, 4))

    def level(lower: int | None, upper: int, at: float, ky: float, kphi: float, load: float) -> None:
        heights = {0: low, 2: high}
        arm_b = at - heights[upper]
        shear = np.zeros(4)
        shear[upper], shear[upper + 1] = 1.0, arm_b
        mean, turn = np.zeros(4), np.zeros(4)
        mean[upper + 1], turn[upper + 1] = 0.5, 1.0
        arm_a = 0.0
        if lower is not None:
            arm_a = at - heights[lower]
            shear[lower], shear[lower + 1] = -1.0, -arm_a
            mean[lower + 1], turn[lower + 1] = 0.5, -1.0
        across = -ky * shear + load * mean  # force on the upper one
        k[upper] -= across
        k[upper + 1] -= arm_b * across - kphi * turn + load * 0.5 * shear
        k[upper + 1, upper + 1] += load * arm_b
        if lower is not None:
            k[lower] += across
            k[lower + 1] -= -arm_a * across + kphi * turn + load * 0.5 * shear
            k[lower + 1, lower + 1] -= load * arm_a

    level(None, 0, 0.5335, 12e7, 12.0 * PRIMARY_KZ * SPRING_Y**2, (bogies + body) * G)
    level(0, 2, 1.05, 8.0 * 1.5e5, 2.0 * SECONDARY_ROLL, body * G)
    level(0, 2, 0.80, 2.0 * 4e6, 0.0, 0.0)
    y, roll = np.linalg.solve(k, np.array([bogies * G, 0.0, body * G, 0.0]))[2:]
    return float(roll), float(y)


def test_sway_on_cant_against_the_linear_suspension(compare: Compare) -> None:
    """Body against axles on 160 mm of cant: the straight plane model of both suspensions."""
    roll, y = _sway(1.95)
    sine = 0.160 / 1.5
    values = judged("sway_standing")
    ours = values["roll of the body against its axles", "sound"]
    compare(
        "sway on 160 mm, roll, mrad", ours, 1e3 * roll * sine, 0.02 * 1e3 * roll * sine, "plane linear model"
    )
    layout = [{"kind": "tangent", "length": 200.0, "cant_mm": 160.0}]
    frame = ran({"kind": "equilibrium", "speed": 0.5}, {"layout": layout})
    axles = sum(frame[f"ws{w}.y"][0] for w in range(1, 7)) / 6.0
    moved = 1e3 * (frame["carbody.y"][0] - axles)
    compare("sway on 160 mm, lateral, mm", moved, 1e3 * y * sine, 0.04 * 1e3 * y * sine, "plane linear model")


def test_tilted_gravity_is_canted_track(compare: Compare) -> None:
    """The rig's forces against the same cant laid under the vehicle."""
    rig = judged("sway_rig", **{"test.step_mm": 160.0})
    standing = judged("sway_standing")
    name = "roll of the body against its axles"
    compare(
        "rig against canted track, mrad", rig[name, "full"], standing[name, "sound"], 1e-5, "canted layout"
    )


def test_cant_deficiency_is_what_was_asked_for(compare: Compare) -> None:
    from lmap.procedures.sway import cant_for

    speed, radius = 115.0 / 3.6, 800.0
    for deficiency, theirs in ((0.110, 0.719), (0.1595, 1.043)):
        cant = cant_for(speed, radius, deficiency, G)
        layout = [{"kind": "curve", "length": 200.0, "radius": radius, "cant_mm": 1e3 * cant}]
        frame = ran({"kind": "equilibrium", "speed": speed}, {"layout": layout})
        compare(
            f"unbalanced acceleration, {1e3 * deficiency:g} mm, m/s2",
            frame["unbalanced"][0],
            theirs,
            5e-4,
            ANNEX_E,
        )


def test_coupler_force_in_a_curve_by_hand(compare: Compare) -> None:
    """1 MN at 22/(2 160) rad: 68.70 kN, 41.22 kN off one rail, on three wheels 12.5 % of 109.5 kN."""
    values = judged("coupler_forces", condition="full")
    compare("lateral force, kN", values["lateral force at each coupler", "formula"], 68.70, 0.01, "by hand")
    compare("unloading, %", values["wheel unloading by the formula", "formula"], 12.55, 0.02, "by hand")


def test_coupler_force_moves_the_load_that_the_formula_says(compare: Compare) -> None:
    """On straight track: both ends' F_y h over the rails, and the weight of what moves sideways."""
    across, height = 2.0 * 20e3, 0.9
    load = [
        {
            "kind": "force",
            "body": "carbody",
            "axis": "y",
            "position": [0.0, 0.0, -height],
            "path": [0.0, across],
        }
    ]
    frame = ran({"kind": "quasi_static", "speed": 0.5, "load": load, "load_steps": 2})
    moved = sum(frame[f"ws{w}.right.Q"][-1] - frame[f"ws{w}.left.Q"][-1] for w in range(1, 7)) / 2.0
    masses = {"carbody": 87180.0, "bogie1": 14860.0, "bogie2": 14860.0} | {
        f"ws{w}": 2850.0 for w in range(1, 7)
    }
    leans = sum(mass * G * frame[f"{body}.y"][-1] for body, mass in masses.items())
    compare("load moved, kN", moved / 1e3, (across * height + leans) / 1.5e3, 0.5, "moments about the rails")


@pytest.mark.slow
def test_p2_of_a_run_beside_the_formula(compare: Compare) -> None:
    """The formula's dip has straight sides, the weld's are parabolas: read at 1/length = 0 from dips of 6 and 12 m.

    It has no suspension and no contact spring either; a tenth of the dynamic part is what they are worth.
    """
    found = []
    for length in (6.0, 12.0):
        values = judged("p2_run", **{"track.irregularity.length": length})
        found.append(values["P2 force, largest below 100 Hz", "115 km/h"])
    theirs = values["P2 force by the formula, with this track's numbers", "115 km/h"]
    ours = 2.0 * found[1] - found[0]
    dynamic = theirs - WHEEL_LOAD / 1e3
    compare("P2 over a weld of 20 mrad, kN", ours, theirs, 0.1 * dynamic, "Jenkins et al. 1974")


def test_friction_opens_the_loops(compare: Compare) -> None:
    """Horn guides of 4 kN: raising and lowering differ by their moment, 8 kN 1.05 m over 1.5 m and the wheel load."""
    half = BOGIE_TWIST * 1.9 / 1.5
    loads = turned({1: half, 3: -half})
    for load in loads:
        load["path"] = [0.0, load["path"][1], -load["path"][1], load["path"][1]]
    run = {"kind": "quasi_static", "speed": 0.5, "load": loads, "load_steps": 4}
    gap = {}
    for name in ("coco134", "coco134_friction"):
        q = ran(run, name=name)["ws1.left.Q"].to_list()
        gap[name] = abs(q[6] - q[10]) / WHEEL_LOAD * 100.0  # half-way down and up
    compare("loop without friction, % of Q0", gap["coco134"], 0.0, 0.01, "linear")
    theirs = 100.0 * 2.0 * 2.0 * 4.0e3 * SPRING_Y / 1.5 / WHEEL_LOAD
    compare("loop with friction, % of Q0", gap["coco134_friction"], theirs, 0.1 * theirs, "2 mu N y / (b Q0)")
