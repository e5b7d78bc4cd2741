"""The vehicle as drawn: geometry, the checks on it, motions, the hash and the sign-off."""

from __future__ import annotations

import dataclasses
import math
import tomllib
from pathlib import Path
from typing import Any

import polars as pl
import pytest

from lmap.errors import InputProblem
from lmap.report.scene import file_name, render_scene
from lmap.spec.case import VehicleData
from lmap.spec.load import load
from lmap.spec.model import SignOff
from lmap.vehicle import Vehicle
from lmap.verdict import Outcome
from lmap.view import (
    Mode,
    findings,
    mode_motions,
    model_hash,
    modes_of,
    resolved,
    run_motion,
    scene,
    sign_off,
)
from lmap.view.checks import LIMITS, measures
from lmap.view.model import Body
from lmap.view.shapes import Box, Cylinder, Line, box_of_inertia, outside, shapes

pytestmark = pytest.mark.needs_core
ROOT = Path(__file__).parents[2]
GAUGE = 1.435

SMALL = """
name = "small"
title = "Two axles"
design_speed_kmh = 108.0
wheel_profile = "s1002"
design_condition = "full"
[contact]
youngs_modulus = 2.1e11
poisson = 0.28
damping = 1e5
[parameters.car]
mass = 12000.0
length = 8.0
[parameters.spring]
y = 1.0
x = 3.0
kz = 5.0e5
back = "-$spring.x"
[condition.full]
[condition.tare]
"car.mass" = 8000
[[body]]
name = "carbody"
mass = "$car.mass"
inertia = [14000.0, 68000.0, 68000.0]
position = [0.0, 0.0, -1.5]
[[use]]
template = "axle"
at = ["$spring.x", 0.0, 0.0]
with = { axle = "ws1", sign = "" }
[[use]]
template = "axle"
at = ["$spring.back", 0.0, 0.0]
with = { axle = "ws2", sign = "-" }
[[template.axle.wheelset]]
name = "{axle}"
mass = 1200.0
inertia = [700.0, 100.0, 700.0]
radius = 0.5
tape_half_distance = 0.75
position = [0.0, 0.0]
[[template.axle.connection]]
name = "spring_{axle}"
kind = "bushing"
between = ["{axle}", "carbody"]
position = [0.0, "$spring.y", -0.6]
mirror = true
carries_weight = true
stiffness = [1e6, 1e6, "$spring.kz"]
[[template.axle.connection]]
name = "rod_{axle}"
kind = "traction_rod"
between = ["{axle}", "carbody"]
positions = [[0.0, 0.0, -0.5], ["{sign}$spring.y", 0.0, -0.7]]
stiffness = 1e7
[[sensor]]
name = "seat"
body = "carbody"
position = [3.0, 1.0, -1.2]
"""


def vehicle(text: str = SMALL, condition: str | None = None) -> VehicleData:
    return Vehicle.of(text, condition=condition).data


def found(text: str) -> list[tuple[str, str]]:
    return [(one.kind, one.element) for one in findings(resolved(vehicle(text)), GAUGE)]


def test_templates_references_and_mirrors_are_resolved() -> None:
    model = resolved(vehicle())
    assert [(body.name, body.position) for body in model.bodies] == [
        ("carbody", (0.0, 0.0, -1.5)),
        ("ws1", (3.0, 0.0, -0.5)),
        ("ws2", (-3.0, 0.0, -0.5)),
    ]
    points = {one.name: one.points for one in model.connections}
    assert points["spring_ws1_right"] == ((3.0, 1.0, -0.6),) * 2
    assert points["spring_ws2_left"] == ((-3.0, -1.0, -0.6),) * 2
    # a sign given as a word of the template: -$spring.y
    assert points["rod_ws1"] == ((3.0, 0.0, -0.5), (4.0, 0.0, -0.7))
    assert points["rod_ws2"] == ((-3.0, 0.0, -0.5), (-4.0, 0.0, -0.7))
    [spring] = [one for one in model.connections if one.name == "spring_ws1_left"]
    assert spring.values == {"stiffness": [1e6, 1e6, 5e5]}
    assert spring.mirrored
    assert [sensor.name for sensor in model.sensors] == ["carbody.seat"]


def test_a_condition_changes_what_it_names() -> None:
    masses = [resolved(vehicle(condition=name)).bodies[0].mass for name in (None, "full", "tare")]
    assert masses == [12000.0, 12000.0, 8000.0]


def test_the_reference_locomotive_is_the_cores() -> None:
    import lmap

    for condition in ("full", "tare"):
        data = lmap.Vehicle.load("coco134", condition=condition).data
        model = resolved(data)
        assert tuple(body.name for body in model.bodies) == data.bodies
        assert data.mass is not None
        assert sum(body.mass for body in model.bodies) == pytest.approx(data.mass, rel=1e-12)
    assert len(model.connections) == 2 * (1 + 2 + 2 + 4 + 6)
    assert findings(model, GAUGE) == []


# ------------------------------------------------------------------------------------------------ shapes


def test_a_box_of_even_density_is_found_again_from_its_inertia() -> None:
    a, b, c, mass = 20.0, 3.0, 2.5, 40000.0
    inertia = (mass * (b * b + c * c) / 12, mass * (a * a + c * c) / 12, mass * (a * a + b * b) / 12)
    body = Body(name="x", mass=mass, inertia=inertia, position=(0.0, 0.0, 0.0))
    assert box_of_inertia(body) == pytest.approx((a, b, c))


def test_inertia_that_no_rigid_body_has_is_drawn_thin_and_not_refused() -> None:
    body = Body(name="x", mass=1.0, inertia=(1.0, 1.0, 9.0), position=(0.0, 0.0, 0.0))
    assert box_of_inertia(body)[2] == 0.1


def test_distances_from_shapes_are_those_of_geometry() -> None:
    box = Box((0.0, 0.0, 0.0), (2.0, 4.0, 6.0))
    assert outside([box], (0.5, 0.5, 0.5)) == (0.0, (0.5, 0.5, 0.5))
    assert outside([box], (4.0, 6.0, 3.0)) == (5.0, (1.0, 2.0, 3.0))
    drum = Cylinder((0.0, 0.0, 0.0), 1, 0.5, 2.0)
    assert outside([drum], (0.3, 0.9, 0.4)) == (pytest.approx(0.0), pytest.approx((0.3, 0.9, 0.4)))
    assert outside([drum], (3.5, 5.0, 0.0))[0] == pytest.approx(5.0)
    line = Line(((0.0, 0.0, 0.0), (2.0, 0.0, 0.0)))
    assert outside([line], (1.0, 3.0, 4.0)) == (5.0, (1.0, 0.0, 0.0))
    assert outside([box, line], (1.5, 0.0, 0.0))[0] == 0.0


@pytest.mark.parametrize(
    "shape", [Box((1.0, 2.0, 3.0), (2.0, 4.0, 6.0)), Cylinder((1.0, 2.0, 3.0), 0, 0.5, 2.0)]
)
def test_solids_are_closed(shape: Box | Cylinder) -> None:
    solid = shape.solid()
    sides: dict[tuple[int, int], int] = {}
    for a, b, c in solid.faces:
        for edge in ((a, b), (b, c), (c, a)):
            key = (min(edge), max(edge))
            sides[key] = sides.get(key, 0) + 1
    assert set(sides.values()) == {2}
    assert all(math.dist(shape.nearest(vertex), vertex) < 1e-12 for vertex in solid.vertices)


def test_declared_shapes_and_equipment_take_the_place_of_the_box() -> None:
    more = (
        '\n[[shape]]\nkind = "box"\nbody = "carbody"\nposition = [0.0, 0.0, -2.0]\nsize = [9.0, 2.0, 1.0]\n'
        '[[shape]]\nkind = "cylinder"\nbody = "carbody"\nposition = [0.0, 0.0, -1.0]\naxis = "x"\nradius = 0.4\n'
        'length = 2.0\n[[equipment]]\nname = "tank"\nbody = "carbody"\nposition = [1.0, 0.0, -1.0]\n'
        "size = [1.0, 1.0, 0.5]\n"
    )
    own = shapes(resolved(vehicle(SMALL + more)))["carbody"]
    assert [type(one).__name__ for one in own] == ["Box", "Cylinder", "Box"]


# ------------------------------------------------------------------------------------------------ checks


def test_a_sound_vehicle_has_no_findings() -> None:
    assert found(SMALL) == []


def test_a_spring_on_one_side_alone_is_asymmetric() -> None:
    text = SMALL.replace("mirror = true\n", "", 1)
    assert found(text) == [("asymmetry", "spring_ws1"), ("asymmetry", "spring_ws2")]
    [measure, _] = findings(resolved(vehicle(text)), GAUGE)
    assert measure.value == pytest.approx(2.0)  # to its own image


def test_a_body_off_the_middle_is_asymmetric_by_twice_its_offset() -> None:
    text = SMALL.replace("position = [0.0, 0.0, -1.5]", "position = [0.0, 0.002, -1.5]")
    [finding] = findings(resolved(vehicle(text)), GAUGE)
    assert (finding.kind, finding.element, finding.value) == ("asymmetry", "carbody", pytest.approx(0.004))


def test_an_attachment_far_off_is_found_with_its_body() -> None:
    text = SMALL.replace('["{sign}$spring.y", 0.0, -0.7]', '["{sign}$spring.y", 0.0, 3.0]')
    kinds = found(text)
    assert kinds == [("outside", "rod_ws1.carbody"), ("outside", "rod_ws2.carbody")]


def test_a_wheelset_beside_the_rails_is_found_by_wheel() -> None:
    text = SMALL.replace("tape_half_distance = 0.75", "tape_half_distance = 0.85")
    assert found(text) == [("off_rail", f"ws{n}.{side}") for n in (1, 2) for side in ("left", "right")]
    off = [one.value for one in measures(resolved(vehicle(text)), GAUGE) if one.kind == "off_rail"]
    assert off == pytest.approx([0.85 - 0.7175 - 0.072] * 4)
    assert not [one for one in measures(resolved(vehicle(text)), None) if one.kind == "off_rail"]


def test_the_shipped_spec_judges_by_the_limits_of_the_command() -> None:
    spec = load(ROOT / "specs" / "view.toml").spec
    factor = {"mm": 1e-3, "m": 1.0}
    written = {
        one.signal[0].rpartition(".")[2]: (one.max or 0.0) * factor[one.unit] for one in spec.criterion
    }
    assert written == pytest.approx(LIMITS)


# ------------------------------------------------------------------------------------------------ hash, sign-off


def test_the_hash_is_of_numbers_and_names_and_not_of_how_they_are_written() -> None:
    plain = model_hash(vehicle())
    assert model_hash(vehicle(condition="full")) == plain
    assert model_hash(vehicle(SMALL + "\n# a comment\n")) == plain
    assert model_hash(vehicle(SMALL.replace("mass = 12000.0", "mass = 12000"))) == plain
    assert model_hash(vehicle(SMALL.replace('back = "-$spring.x"', "back = -3.0"))) == plain
    assert model_hash(vehicle(SMALL.replace("length = 8.0", "width = 2.0"))) == plain  # nothing refers to it


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("kz = 5.0e5", "kz = 5.0001e5"),
        ("y = 1.0\n", "y = 1.001\n"),
        ('name = "rod_{axle}"', 'name = "bar_{axle}"'),
        ("radius = 0.5", "radius = 0.501"),
        ("position = [3.0, 1.0, -1.2]", "position = [3.0, 1.0, -1.3]"),
    ],
)
def test_any_change_of_the_model_changes_the_hash(old: str, new: str) -> None:
    assert SMALL.count(old) >= 1
    assert model_hash(vehicle(SMALL.replace(old, new))) != model_hash(vehicle())


def test_a_condition_is_a_model_of_its_own() -> None:
    assert model_hash(vehicle(condition="tare")) != model_hash(vehicle(condition="full"))


def judged(signed: SignOff | None, **settings: Any) -> tuple[Outcome, str]:
    verdict = sign_off.verdict(resolved(vehicle()), signed, index=3, vehicle="small", settings=settings)
    assert verdict.judged
    return verdict.outcome, verdict.message or ""


def test_unsigned_waits_and_says_what_to_look_at_and_what_to_write() -> None:
    outcome, message = judged(None, **{"spring.kz": 4e5})
    assert outcome is Outcome.MANUAL
    assert "lmap view small --condition full --set spring.kz=400000.0" in message
    lines = message[message.index("[sign_off]") :]
    written = tomllib.loads(lines.replace("YOUR NAME", "A. Person").replace("YYYY-MM-DD", "2026-01-31"))
    assert judged(SignOff.model_validate(written["sign_off"]))[0] is Outcome.PASS


def test_a_sign_off_of_another_model_is_void() -> None:
    signed = SignOff(name="A. Person", date="2026-01-31", model="0" * 64)
    outcome, message = judged(signed)
    assert outcome is Outcome.MANUAL
    assert message.startswith(
        "the sign-off of A. Person (2026-01-31) is void: it is for model 000000000000..."
    )


def test_a_sign_off_of_this_model_passes_and_says_whose_it_is() -> None:
    signed = SignOff(name="A. Person", date="2026-01-31", model=model_hash(vehicle()))
    assert judged(signed) == (Outcome.PASS, "signed by A. Person on 2026-01-31")


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ('date = "2026-01-31"\nmodel = "{hash}"', "sign_off.name: found nothing; allowed: a value"),
        (
            'name = "YOUR NAME"\ndate = "2026-01-31"\nmodel = "{hash}"',
            'sign_off.name: found "YOUR NAME"; allowed: the name of the person',
        ),
        (
            'name = "A"\ndate = "31.1.2026"\nmodel = "{hash}"',
            'sign_off.date: found "31.1.2026"; allowed: a day as "2026-01-31"',
        ),
        (
            'name = "A"\ndate = "2026-02-31"\nmodel = "{hash}"',
            'sign_off.date: found "2026-02-31"; allowed: a day as',
        ),
        (
            'name = "A"\ndate = "2026-01-31"\nmodel = "ccd1"',
            'sign_off.model: found "ccd1"; allowed: the model\'s hash, 64',
        ),
        (
            'name = "A"\ndate = "2026-01-31"\nmodle = "{hash}"\nmodel = "{hash}"',
            'found an unknown key "modle"; allowed: date, model, name (did you mean "model"?)',
        ),
    ],
)
def test_a_faulty_sign_off_is_one_message_with_key_and_line(
    tmp_path: Path, written: str, message: str
) -> None:
    path = tmp_path / "view.toml"
    text = (ROOT / "specs" / "view.toml").read_text(encoding="utf-8")
    path.write_text(f"{text}\n[sign_off]\n{written.replace('{hash}', 'a' * 64)}\n", encoding="utf-8")
    with pytest.raises(InputProblem) as caught:
        load(path)
    [problem] = caught.value.problems
    assert message in str(problem)
    assert problem.line is not None
    assert problem.line > text.count("\n")


def test_a_sign_off_is_refused_where_nobody_is_waited_for(toy: Path) -> None:
    from lmap.prepare import prepare

    path = toy / "specs" / "sway.toml"
    signed = f'\n[sign_off]\nname = "A"\ndate = "2026-01-31"\nmodel = "{"a" * 64}"\n'
    path.write_text(path.read_text(encoding="utf-8") + signed, encoding="utf-8")
    with pytest.raises(InputProblem, match="sign_off: found a sign-off; allowed: none: procedure hunting"):
        prepare(path)


# ------------------------------------------------------------------------------------------------ motions


def test_a_mode_is_drawn_so_that_its_farthest_point_moves_as_far_as_said() -> None:
    model = resolved(vehicle())
    bounce = [0.0, 0.0, 7.0 + 0.0j, 0.0, 0.0, 0.0]
    pitch = [0.0, 0.0, 0.0, 0.0, 2.0j, 0.0]
    motions = mode_motions(
        [
            Mode(name="bounce", frequency=1.1, damping_ratio=0.3, shape={"carbody": bounce}, speed=0.0),
            Mode(name="pitch", frequency=1.3, damping_ratio=-0.1, shape={"carbody": pitch}, speed=10.0),
            Mode(name="nothing", frequency=1.3, damping_ratio=0.1, shape={"carbody": [0.0] * 6}),
        ],
        model,
    )
    assert [one["title"] for one in motions] == [
        "bounce: 1.10 Hz, damping 30.0 %, standing",
        "pitch: 1.30 Hz, damping -10.0 %, 36 km/h",
    ]
    assert [one["grows"] for one in motions] == [False, True]
    assert motions[0]["bodies"]["carbody"][2] == [0.3, 0.0]
    length, _, height = shapes(model)["carbody"][0].size  # type: ignore[union-attr]
    assert motions[1]["bodies"]["carbody"][4] == [
        0.0,
        pytest.approx(0.3 / math.hypot(length / 2, height / 2), abs=1e-5),
    ]


def test_modes_are_read_from_a_frame_and_those_that_do_not_oscillate_left_out() -> None:
    frame = pl.DataFrame(
        {
            "name": ["sway", "creep", "fast"],
            "v": [10.0, 10.0, 10.0],
            "frequency": [0.8, 0.0, 55.0],
            "damping_ratio": [0.2, 1.0, 0.1],
            "re.carbody.y": [1.0, 1.0, 1.0],
            "im.carbody.y": [0.5, 0.0, 0.0],
            "re.ws1.track_y": [1.0, 1.0, 1.0],
            "im.ws1.track_y": [0.5, 0.0, 0.0],
        }
    )
    [mode] = modes_of(frame)
    assert (mode.name, mode.shape) == ("sway", {"carbody": [0.0, 1.0 + 0.5j, 0.0, 0.0, 0.0, 0.0]})


def test_a_runs_motion_is_against_the_design_position_and_thinned_evenly() -> None:
    model = resolved(vehicle())
    n = 2001
    frame = pl.DataFrame(
        {
            "t": [i * 0.005 for i in range(n)],
            "carbody.z": [-1.5 + 0.001 * i for i in range(n)],
            "carbody.phi": [0.01] * n,
            "ws1.y": [0.003] * n,
            "carbody.seat.ay": [9.9] * n,
        }
    )
    motion = run_motion(frame, model, "run")
    assert sorted(motion["bodies"]) == ["carbody", "ws1"]
    assert motion["bodies"]["ws1"] == {"y": [0.003] * len(motion["t"])}
    assert motion["bodies"]["carbody"]["z"][:3] == pytest.approx([0.0, 0.008, 0.016])
    assert 240 <= len(motion["t"]) <= 252
    steps = {round(b - a, 6) for a, b in zip(motion["t"], motion["t"][1:], strict=False)}
    assert steps == {0.04}


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"s": [0.0, 1.0]}, "found no column t in s; allowed: t, carbody.y"),
        ({"t": [0.0, 1.0], "other.y": [0.0, 1.0]}, "no motion of any body of this vehicle in t, other.y"),
        ({"t": [0.0, 1.0], "carbody.y": [0.0, float("nan")]}, "found 1 rows of motion; allowed: two or more"),
    ],
)
def test_a_frame_without_motion_is_bad_input(columns: dict[str, list[float]], message: str) -> None:
    with pytest.raises(InputProblem, match=message):
        run_motion(pl.DataFrame(columns), resolved(vehicle()), "run")


# ------------------------------------------------------------------------------------------------ page


def test_the_scene_says_name_kind_and_values_of_every_connection() -> None:
    drawn = scene(resolved(vehicle()), GAUGE, [])
    [spring] = [one for one in drawn["connections"] if one["name"] == "spring_ws1_left"]
    assert spring["hover"] == [
        "spring_ws1_left",
        "bushing: ws1 to carbody",
        "stiffness 1e+06 / 1e+06 / 500000 N/m",
        "carries weight",
        "mirrored: values as on the right side",
        "x 3.000, y -1.000, z -0.600 m",
    ]
    assert drawn["groups"] == ["spring", "rod"]
    assert len(drawn["rails"]) == 6
    assert [body["glass"] for body in drawn["bodies"]] == [True, False, False]


def test_words_of_a_file_cannot_break_out_of_the_page() -> None:
    model = dataclasses.replace(resolved(vehicle()), title="</script><script>alert(1)</script>")
    page = render_scene(scene(model, GAUGE, [])).decode()
    assert "<script>alert(1)" not in page
    assert file_name("2C.6b kink/../x") == "view-2C.6b-kink-..-x.html"
