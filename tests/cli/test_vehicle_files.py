"""The vehicle language on the real core: bad input key by key, includes, `lmap schema`, `lmap new`."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from commands import Ran, spoil

from lmap import files, vehicle
from lmap.errors import InputProblem

pytestmark = pytest.mark.needs_core
ROOT = Path(__file__).parents[2]
BOBO = "models/vehicles/bobo86.toml"
WAGON = "models/vehicles/wagon2.toml"
COACH = "models/vehicles/manchester1.toml"
RIG = "models/vehicles/suspended_wheelset.toml"


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the models, to be spoiled."""
    shutil.copytree(ROOT / "models", tmp_path / "models")
    monkeypatch.chdir(tmp_path)
    return tmp_path


Run = Callable[..., tuple[int, str, list[str]]]


@pytest.fixture
def lmap(lmap: Callable[..., Ran]) -> Run:
    """Runs a command: exit code, stdout, lines of stderr."""

    def run(*arguments: str) -> tuple[int, str, list[str]]:
        code, out, err = lmap(*arguments)
        return code, out, err.splitlines()

    return run


SHEAR = 'kind = "shear_spring"'
BAD = [
    # file, what is written, what stands there instead, key, found, allowed
    (WAGON, 'force = "$leaf.friction"', "force = -1.0", "force", "-1.0", ">= 0 N"),
    (WAGON, 'stiffness = "$leaf.stick"', "stiffness = 0", "stiffness", "0", "> 0 N/m"),
    (WAGON, 'stiffness = "$leaf.stick"', "", "stiffness", "nothing", "> 0 N/m"),
    (WAGON, 'kind = "friction"', 'kind = "frictoin"', "kind", "frictoin", "did you mean friction?"),
    (WAGON, 'along = "z"', 'along = "w"', "along", '"w"', '"line", "x", "y", "z"'),
    (WAGON, 'along = "z"', 'along = "line"', "position", "0.0000 m apart", "1 mm apart"),
    (WAGON, 'coefficient = "$link.coefficient"', "coefficient = -0.1", "coefficient", "-0.1", ">= 0"),
    (WAGON, 'load = "$link.load"', "load = -1", "load", "-1", ">= 0 N"),
    (WAGON, 'load = "$link.load"', "normal_stiffness = 1e6", "kind", "no load", "preload"),
    (WAGON, 'load = "$link.load"', 'normal = "xy"', "normal", '"xy"', '"x", "y", "z"'),
    (WAGON, 'clearance = "$axle_guard.along"', "clearance = -0.01", "clearance", "-0.01", ">= 0 m"),
    (WAGON, 'side = "both"', 'side = "left"', "side", '"left"', '"both", "pressed", "pulled"'),
    (WAGON, 'side = "both"', "", "position", "coincide", "positions"),
    (
        WAGON,
        'force = "$leaf.friction"',
        'force = "$leaf.friction"\npreload = [0.0, 0.0, 5.0]',
        "preload",
        "5 N",
        "carries",
    ),
    (
        WAGON,
        'force = "$leaf.friction"',
        'force = "$leaf.friction"\ncarries_weight = true',
        "carries_weight",
        "friction",
        "false",
    ),
    (COACH, 'axial = "$secondary.axial"', "axial = -1", "axial", "-1", ">= 0 N/m"),
    (COACH, 'shear = "$secondary.shear"', 'shear = "soft"', "shear", '"soft"', "a number >= 0 N/m"),
    (
        COACH,
        'bending = "$secondary.bending"',
        "bending = 1.0\nshear_centre = 2.0",
        "shear_centre",
        "2.0",
        "<= 1",
    ),
    (
        COACH,
        'bending = "$secondary.bending"',
        "bending = 1.0\ntorsion = -2.0",
        "torsion",
        "-2.0",
        ">= 0 N m/rad",
    ),
    (
        COACH,
        '[0.0, "$secondary.y", "$secondary.upper"]]',
        '[0.5, "$secondary.y", "$secondary.upper"]]',
        "positions",
        "0.500",
        "one above the other",
    ),
    (COACH, 'stiffness = "$anti_roll_bar.k"', "stiffness = -1", "stiffness", "-1", ">= 0 N m/rad"),
    (
        COACH,
        "f = [0.0, 600.0, 1760.0,",
        "f = [0.0, 600.0, 500.0,",
        "table.f[2]",
        "500 after 600",
        "never fall",
    ),
    (COACH, "x = [0.0, 0.005,", "x = [0.0, 0.0,", "table.x[1]", "0 after 0", "rising"),
    (COACH, "x = [0.0, 0.005,", "x = [0.001, 0.005,", "table.x", "no x = 0", "x = 0"),
    (COACH, "f = [0.0, 600.0,", "f = [600.0,", "table.f", "8 values", "one for each x"),
    (COACH, "x = [0.0, 0.005,", "y = [0.0, 0.005,", "table.y", "unknown key", "interpolation"),
    (BOBO, 'stiffness = "$yaw_damper.k"', "stiffness = 0.0", "stiffness", "0.0", "> 0 N/m"),
    (
        BOBO,
        "f = [0.0, 8000.0, 12000.0]",
        "f = [0.0, 8000.0, 8000.0]",
        "table.f[2]",
        "8000 after 8000",
        "rising",
    ),
    (BOBO, 'stiffness = "$traction_rod.k"', "", "stiffness", "nothing", "or a table"),
    (BOBO, 'damping = "$traction_rod.c"', "free_length = -1.0", "free_length", "-1", "> 0 m"),
    (
        BOBO,
        'damping = "$traction_rod.c"',
        "table = { x = [0, 1], f = [0, 1] }",
        "table",
        "stiffness and table",
        "one of",
    ),
    (BOBO, 'damping = "$traction_rod.c"', "axes = [0.0, 0.1]", "axes", "a list of 2", "a list of 3"),
    (BOBO, 'kind = "box"', 'kind = "ball"', "kind", '"ball"', '"box", "cylinder", "line"'),
    (BOBO, "size = [18.0, 2.9, 2.8]", "size = [18.0, 0.0, 2.8]", "shape[0].size[1]", "0.0", "> 0 m"),
    (
        BOBO,
        'name = "transformer"\nbody = "carbody"',
        'name = "transformer"\nbody = "car"',
        "body",
        '"car"',
        "carbody",
    ),
    (
        BOBO,
        "[outline]",
        '[[load_case.lifted]]\nbody = "no"\nmass = 1.0\nposition = [0, 0, 0]\n[outline]',
        "body",
        '"no"',
        "carbody",
    ),
    (
        BOBO,
        "[outline]",
        '[[load_case.lifted]]\nbody = "carbody"\nmass = 0\nposition = [0, 0, 0]\n[outline]',
        "mass",
        "0",
        "> 0 kg",
    ),
    (
        BOBO,
        "section = [[0.0, -4.0],",
        "section = [[0.0],",
        "outline.section[0]",
        "a list of 1",
        "a list of 2",
    ),
    (RIG, "guided = true", "guided = 1", "guided", "1", "true or false"),
    (RIG, 'kind = "bushing"', 'kind = "bushing_matrix"', "stiffness", "a list of 3", "a list of 6"),
]


@pytest.mark.parametrize(("file", "old", "new", "key", "found", "allowed"), BAD)
def test_bad_input_has_its_message(
    file: str, old: str, new: str, key: str, found: str, allowed: str, place: Path, lmap: Run
) -> None:
    spoil(file, old, new)
    code, out, messages = lmap("channels", file)
    assert (code, out) == (2, ""), messages
    assert all(message.startswith(f"lmap: {file}:") for message in messages), messages
    fitting = [m for m in messages if key in m.split(": found ")[0] and found in m and allowed in m]
    assert fitting, messages
    # one fault of a template used twice is said once
    assert len(messages) == len(set(messages))


@pytest.mark.parametrize("name", ["bobo86", "coco134", "manchester1", "suspended_wheelset", "wagon2"])
def test_what_ships_has_channels(name: str, lmap: Run) -> None:
    code, out, _ = lmap("channels", name)
    assert code == 0
    assert "ws1.left.Q" in out


def test_include_gives_the_same_vehicle_and_faults_keep_their_file(place: Path, lmap: Run) -> None:
    text = Path(WAGON).read_text(encoding="utf-8")
    cut = text.index("[[template.axle.wheelset]]")
    end = text.index("# ----", cut)
    Path("models/vehicles/parts").mkdir()
    part = "models/vehicles/parts/axle.toml"
    Path(part).write_text(text[cut:end], encoding="utf-8")
    own = "models/vehicles/joined.toml"
    whole = text[:cut] + text[end:]
    Path(own).write_text(
        whole.replace('title = "', 'include = ["parts/axle.toml"]\ntitle = "', 1), encoding="utf-8"
    )
    assert lmap("channels", own)[:2] == lmap("channels", WAGON)[:2]
    assert vehicle.Vehicle.load(own).data.document == vehicle.Vehicle.load(WAGON).data.document

    spoil(part, "mirror = true", "miror = true")
    line = Path(part).read_text(encoding="utf-8").split("miror")[0].count("\n") + 1
    _, _, messages = lmap("channels", own)
    assert messages[0].startswith(f"lmap: {part}:{line}: "), messages
    spoil(part, "miror = true", "mirror = true")
    spoil(own, "kz = 9.0e5", "kz = -9.0e5")
    _, _, messages = lmap("channels", own)
    assert all(message.startswith(f"lmap: {own}:") for message in messages), messages


def test_joined_lists_keep_the_file_of_every_item(place: Path, lmap: Run) -> None:
    part, own = "models/vehicles/part.toml", "models/vehicles/joined.toml"
    sensor = '[[sensor]]\nname = "{}"\nbody = "{}"\nposition = [0.0, 0.0, -1.0]\n'
    Path(part).write_text(sensor.format("one", "body") + sensor.format("two", "nobody"), encoding="utf-8")
    text = (
        'include = ["part.toml"]\n' + Path(WAGON).read_text(encoding="utf-8") + sensor.format("three", "none")
    )
    Path(own).write_text(text, encoding="utf-8")
    _, _, messages = lmap("channels", own)
    # the part's second sensor, and the file's own first, each by its index there
    assert messages[0].startswith(f"lmap: {part}:7: sensor[1].body: found "), messages
    assert messages[1].startswith(f"lmap: {own}:{text.count(chr(10)) - 1}: sensor[0].body: found "), messages


@pytest.mark.parametrize(
    ("written", "found"),
    [
        ('"axle.toml"', "in brackets"),
        ("[3]", "found 3"),
        ('["gone.toml"]', "which is no file"),
        ('["wagon2.toml"]', "includes this file"),
    ],
)
def test_a_bad_include(written: str, found: str, place: Path, lmap: Run) -> None:
    spoil(WAGON, 'title = "', f'include = {written}\ntitle = "')
    code, _, [message] = lmap("channels", WAGON)
    assert code == 2
    assert message.startswith(f"lmap: {WAGON}:")
    assert found in message


def test_the_schema_is_one_and_says_what_every_key_means(lmap: Run) -> None:
    code, out, _ = lmap("schema", "vehicle")
    assert code == 0
    schema = json.loads(out)
    assert schema["type"] == "object"
    assert "include" in schema["properties"]
    for name, part in {"": schema, **schema["$defs"]}.items():
        for key, own in part.get("properties", {}).items():
            assert own.get("description") or "const" in own, f"{name}.{key}"


def test_a_new_vehicle_is_one_and_is_never_overwritten(
    place: Path, lmap: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    (place / "mine").mkdir()
    monkeypatch.chdir(place / "mine")
    code, out, messages = lmap("new", "vehicle", "shunter", "--like", "coco134")
    assert (code, out, messages) == (0, "", ["lmap: wrote shunter.toml"])
    made = vehicle.Vehicle.load("shunter.toml")
    assert made.data.name == "shunter"
    assert made.data.mass == vehicle.Vehicle.load("coco134").data.mass
    code, _, [message] = lmap("new", "vehicle", "shunter.toml")
    assert (code, message) == (2, "lmap: shunter.toml: found a file; allowed: a name that is not taken")
    code, _, [message] = lmap("new", "vehicle", "a b")
    assert code == 2
    assert "a letter, then letters" in message
    code, _, [message] = lmap("new", "vehicle", "other", "--like", "cocoo134")
    assert code == 2
    assert 'did you mean "coco134"' in message


RIG_RUN = {"kind": "equilibrium", "speed": 10.0}


def test_a_vehicle_from_data_is_the_vehicle_of_its_file() -> None:
    file = vehicle.Vehicle.load(RIG, beside=ROOT)
    text = (ROOT / RIG).read_text(encoding="utf-8")
    for given in (text, dict(file.document.data)):
        made = vehicle.Vehicle.of(given, beside=ROOT)
        assert made.data.document == file.data.document
        assert made.resolve({"suspension.ky": 3e5}).data.name == "suspended_wheelset"
    assert file.run(RIG_RUN).equals(vehicle.Vehicle.of(text, beside=ROOT).run(RIG_RUN))


@pytest.mark.parametrize(
    ("spoiled", "message"),
    [
        ({"design_speed_kmh": -3}, "design_speed_kmh: found -3; allowed: a number > 0 km/h"),
        ({"include": ["x.toml"]}, "include: found files; allowed: a vehicle in one piece"),
        ({"name": object()}, "of type object"),
        ({"design_speed_kmh": float("nan")}, "design_speed_kmh: found nan; allowed: a finite number"),
    ],
)
def test_faults_of_data_are_told_by_key(spoiled: dict[str, Any], message: str) -> None:
    data = dict(vehicle.Vehicle.load(RIG, beside=ROOT).document.data)
    with pytest.raises(InputProblem) as refused:
        vehicle.Vehicle.of(data | spoiled, beside=ROOT)
    assert message in str(refused.value)
    assert ".toml" not in str(refused.value)


def test_a_profile_is_the_one_beside_the_vehicle_that_names_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not the one of that name which ships with the spec."""
    from lmap.check import find_specs
    from lmap.prepare import prepare

    shutil.copytree(ROOT / "models", tmp_path / "models")
    mine = tmp_path / "models/profiles/anzr1.csv"
    shutil.copy(mine.with_name("anzr1_worn_1.csv"), mine)
    monkeypatch.chdir(ROOT)
    [spec] = find_specs("axle_loads")
    found = {
        one.role: one.sha256
        for one in prepare(spec, {"vehicle": str(tmp_path / "models/vehicles/coco134.toml")}).inputs
        if Path(one.path).name == "anzr1.csv"
    }
    ours, theirs = (
        files.sha256(files.read_text(path, "profile")) for path in (mine, ROOT / "models/profiles/anzr1.csv")
    )
    assert ours != theirs
    assert found == {"profile": ours}
