"""A spec's own control law, as a user runs it: what it gives, and one message for all that can be wrong with it."""

from __future__ import annotations

import json
import shutil
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import fmus
import pytest
from commands import STOPPED, Ran, command, spoil, stopped_by_ctrl_c

import lmap
from lmap.errors import InputProblem
from lmap.verdict import SpecVerdict

pytestmark = pytest.mark.needs_core
ROOT = Path(__file__).parents[2]
SPEC = "slip_pi.toml"
SHORT = ("--set", "run.drive.until.time=0.1")
EXAMPLE = ROOT / "examples" / "controller"


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The example, to be spoiled."""
    for name in (SPEC, "slip_pi.py"):
        shutil.copy(EXAMPLE / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def message(place: Path, refused: Callable[..., list[str]]) -> Callable[..., str]:
    """The one line that a bad check says."""

    def run() -> str:
        [line] = refused("check", SPEC, *SHORT, "--quiet", "--report", "out")
        return line

    return run


def one(name: str) -> SpecVerdict:
    [spec] = lmap.check(EXAMPLE / name, jobs=2).specs
    return spec


@pytest.mark.slow
def test_the_example_gives_what_the_vehicles_own_controller_gives() -> None:
    spec = one(SPEC)
    own, theirs = spec.cases
    assert spec.outcome == "pass"
    for name in own.frame.columns:
        difference = (own.frame[name] - theirs.frame[name]).abs().max()
        scale = max(float(theirs.frame[name].abs().max()), 1.0)  # type: ignore[arg-type]
        assert float(difference) < 1e-9 * scale, (name, difference)  # type: ignore[arg-type]


@pytest.mark.usefixtures("place")
def test_it_says_that_nothing_is_kept_and_keeps_nothing_of_it(lmap: Callable[..., Ran]) -> None:
    for running in ("running 2 cases on 2 threads", "running 1 case on 1 thread, 1 known from before"):
        code, out, err = lmap(
            "check", SPEC, "--json", "--jobs", "2", *SHORT, "--set", "run.drive.period=0.02"
        )
        assert code in (0, 1, 2)
        assert running in err
        [spec] = json.loads(out)["specs"]
        [fact] = [one for one in spec["facts"] if one["name"] == "control law"]
        assert fact["case"] == "slip_pi.py"
        assert "slip_pi:SlipPI" in fact["value"]
        assert "never kept" in fact["value"]
        assert any(one["role"] == "control law" and one["path"] == "slip_pi.py" for one in spec["inputs"])


def test_a_law_beside_the_spec_is_read_anew(place: Path) -> None:
    settings = {"run.drive.until.time": 0.2}

    def effort() -> float:
        [spec] = lmap.check(place / SPEC, set=settings).specs
        return float(spec.cases[0].frame["traction.effort"][-1])

    whole = effort()
    spoil(place / "slip_pi.py", "return min(max(", "return 0.5 * min(max(")
    assert effort() == pytest.approx(0.5 * whole, rel=0.05)


def test_a_law_that_is_set_is_seen_from_here_and_that_of_a_case_from_its_spec(
    place: Path,
) -> None:
    """One message: the other case has a law of its own."""
    (place / "laws").mkdir()
    shutil.move(place / SPEC, place / "laws")
    shutil.move(place / "slip_pi.py", place / "laws")
    settings = {"run.drive.until.time": 0.1, "run.controller": {"law": "here:law", "inputs": []}}
    with pytest.raises(InputProblem) as raised:
        lmap.check(place / "laws" / SPEC, set=settings)
    [problem] = raised.value.problems
    assert 'found "here:law": no here.py' in str(problem)
    (place / "here.py").write_text("def law(t, seen):\n    return {'torque': 0.0}\n", encoding="utf-8")
    [spec] = lmap.check(place / "laws" / SPEC, set=settings).specs
    assert {one.path for one in spec.inputs if one.role == "control law"} == {"laws/slip_pi.py", "here.py"}


def test_jobs_change_no_bit(place: Path) -> None:
    settings = {"run.drive.until.time": 0.3}
    alone, beside = (lmap.check(place / SPEC, set=settings, jobs=jobs).specs[0] for jobs in (1, 2))
    for one, other in zip(alone.cases, beside.cases, strict=True):
        assert one.frame.equals(other.frame)


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
def test_ctrl_c_stops_a_law_and_leaves_nothing(place: Path) -> None:
    before = sorted(place.rglob("*"))
    long = command("check", SPEC, "--report", "out", "--set", "run.drive.until.time=3000")
    long += ["--set", "track.length=90000"]
    assert stopped_by_ctrl_c(place, long, after_s=1.0) == STOPPED
    assert sorted(place.rglob("*")) == before


SPOILED_SPECS = {
    "no module": (
        'law = "slip_pi:SlipPI"',
        'law = "slip_po:SlipPI"',
        'run.controller.law: found "slip_po:SlipPI": no slip_po.py',
    ),
    "no function": ('law = "slip_pi:SlipPI"', 'law = "slip_pi:SlipPi"', "no SlipPi in slip_pi.py"),
    "a hint": ('law = "slip_pi:SlipPI"', 'law = "slip_pi:SlipPi"', 'did you mean "SlipPI"?'),
    "no callable": (
        'law = "slip_pi:SlipPI"',
        'law = "slip_pi:BOGIES"',
        "BOGIES in slip_pi.py is no function",
    ),
    "no name at all": (
        'law = "slip_pi:SlipPI"',
        'law = "slip_pi"',
        'found "slip_pi"; allowed: "module:function"',
    ),
    "unknown key": ("inputs = [", "input = [", 'unknown key "input"'),
    "unknown channel": (
        '"ws*.slip", "period"',
        '"ws*.slop", "period"',
        'run.controller.inputs[0]: found "ws*.slop"',
    ),
    "unknown output": ('"bogie2.torque"]', '"bogie3.torque"]', 'did you mean "bogie2.torque"?'),
    "one thing twice": (
        'outputs = ["bogie1.torque", "bogie2.torque"]',
        'outputs = ["torque", "ws1.torque"]',
        "run.controller.outputs: found torque and ws1.torque, both of which set ws1.torque",
    ),
    "a parameter that it does not take": (
        "kp = 2.0e5",
        "kq = 2.0e5",
        "TypeError: SlipPI.__init__() got an unexpected keyword",
    ),
}


@pytest.mark.parametrize("what", SPOILED_SPECS)
def test_a_spoiled_spec_is_one_message(what: str, place: Path, message: Callable[..., str]) -> None:
    old, new, expected = SPOILED_SPECS[what]
    spoil(place / SPEC, old, new)
    said = message()
    assert said.startswith(f"lmap: {SPEC}:"), said
    assert "test.case[0].run.controller" in said, said
    assert expected in said, said


SPOILED_LAWS = {
    "raises": (
        "        proportional = self.kp * error\n",
        '        proportional = self.kp * error\n        raise RuntimeError("no torque today")\n',
        "RuntimeError: no torque today (slip_pi.py, line 27)",
    ),
    "sees what was not declared": ('seen["period"]', 'seen["v"]', "KeyError: 'v' (slip_pi.py, line"),
    "gives NaN": (
        "return min(max(proportional +",
        "return float('nan') + min(max(proportional +",
        "bogie1.torque = NaN N m",
    ),
    "gives no number": (
        "return {f",
        'return {"bogie1.torque": "full"} or {f',
        "bogie1.torque = 'full', neither a number nor numbers",
    ),
    "gives too many": (
        "return {f",
        'return {"bogie1.torque": [1.0, 2.0, 3.0]} or {f',
        "3 bogie1.torques",
    ),
    "gives another key": ("return {f", 'return {"notch": 8} or {f', "an answer with `notch`"),
    "leaves one out": (
        "return {f",
        'return {"bogie1.torque": 1.0} or {f',
        "an answer without bogie2.torque, declared as an output",
    ),
    "gives a list": ("return {f", "return [1.0] or {f", "an answer of type list"),
    "gives nothing": ("return {f", "return None and {f", "nothing; allowed: a dict"),
    "leaves": ("return {f", "raise SystemExit(3) or {f", "SystemExit: 3 (slip_pi.py, line"),
    "is no Python": ("def __call__", "de __call__", "SyntaxError"),
    "cannot be imported": (
        "from collections",
        "import no_such_module\nfrom collections",
        "No module named 'no_such_module' (slip_pi.py, line 6)",
    ),
}


@pytest.mark.parametrize("what", SPOILED_LAWS)
def test_a_law_that_fails_is_one_message_that_names_it_and_its_line(
    what: str, place: Path, message: Callable[..., str]
) -> None:
    old, new, expected = SPOILED_LAWS[what]
    spoil(place / "slip_pi.py", old, new)
    said = message()
    assert said.startswith(f"lmap: {SPEC}:"), said
    assert "test.case[0].run.controller" in said, said
    assert "slip_pi:SlipPI" in said, said
    assert expected in said, said


@pytest.mark.parametrize("quiet", [(), ("--quiet",)])
def test_a_law_that_fails_is_told_once(
    quiet: tuple[str, ...], place: Path, refused: Callable[..., list[str]]
) -> None:
    spoil(
        place / "slip_pi.py",
        "        error =",
        '        raise RuntimeError("no torque today")\n        error =',
    )
    said = refused("check", SPEC, *SHORT, *quiet)
    assert [line for line in said if "no torque today" in line] == [said[-1]]
    assert said[-1].startswith(f"lmap: {SPEC}:")
    assert quiet or any(line.startswith("slip_pi.py: its control law failed (") for line in said), said


# ---- FMUs


@pytest.fixture
def with_fmu(place: Path) -> Callable[..., Path]:
    """The example with an FMU for its law."""

    def make(version: int, parameters: str = "") -> Path:
        path = fmus.build(place, version)
        spoil(place / SPEC, 'law = "slip_pi:SlipPI"', 'law = "slip.fmu"')
        spoil(place / SPEC, 'inputs = ["ws*.slip", "period"]\n', "")
        spoil(place / SPEC, 'outputs = ["bogie1.torque", "bogie2.torque"]\n', "")
        spoil(place / SPEC, "torque_limit = 26675.0", f"torque_limit = 26675.0{parameters}")
        return path

    return make


@pytest.mark.slow
@pytest.mark.parametrize(
    ("version", "parameters"),
    [(2, ""), (3, ""), pytest.param(3, ", early_parts = 3.0", id="3, returns early")],
)
def test_an_fmu_gives_what_the_same_law_in_python_and_the_vehicles_own_gives(
    version: int, parameters: str, place: Path, with_fmu: Callable[..., Path]
) -> None:
    with_fmu(version, parameters)
    theirs = one(SPEC)
    [spec] = lmap.check(place / SPEC, jobs=2).specs
    assert spec.outcome == "pass"
    ours, own = spec.cases
    python = theirs.cases[0]
    assert ours.frame.height == 201
    for name in ours.frame.columns:
        scale = max(float(own.frame[name].abs().max()), 1.0)  # type: ignore[arg-type]
        for other in (own.frame, python.frame):
            difference = float((ours.frame[name] - other[name]).abs().max())  # type: ignore[arg-type]
            assert difference < 1e-9 * scale, (name, difference)


FAILING = {
    "fails in doStep": (
        ", fail_at = 0.05",
        'slip.fmu at t = 0.050 s: fmi{}DoStep failed with status 3 (error) ("the inverter tripped")',
    ),
    "gives NaN": (", nan_at = 0.05", "slip.fmu at t = 0.050 s: bogie1.torque = NaN N m"),
    "has no such parameter": (
        ", gain = 1.0",
        'run.controller.parameters.gain: found "gain"; allowed: a parameter of slip.fmu',
    ),
}


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("what", FAILING)
def test_an_fmu_that_fails_is_one_message(
    what: str, version: int, with_fmu: Callable[..., Path], message: Callable[..., str]
) -> None:
    parameters, expected = FAILING[what]
    with_fmu(version, parameters)
    assert expected.format(version) in message()


def test_an_fmu_that_returns_early_and_gets_nowhere_is_one_message(
    with_fmu: Callable[..., Path], message: Callable[..., str]
) -> None:
    with_fmu(3, ", early_parts = 2.0, stuck_at = 0.05")
    assert "slip.fmu at t = 0.050 s: it returned early from doStep, at 0.05 s of 0.05 to 0.06 s" in message()


def _without_binary(members: dict[str, bytes]) -> dict[str, bytes]:
    return {
        name.replace("linux64", "win64").replace("x86_64-linux", "x86_64-windows"): content
        for name, content in members.items()
    }


def _description(old: str, new: str) -> Callable[[dict[str, bytes]], dict[str, bytes]]:
    def change(members: dict[str, bytes]) -> dict[str, bytes]:
        text = members["modelDescription.xml"]
        assert old.encode() in text
        return {**members, "modelDescription.xml": text.replace(old.encode(), new.encode())}

    return change


SPOILED_FMUS: dict[str, tuple[int, Callable[[dict[str, bytes]], dict[str, bytes]], str]] = {
    "FMI 1.0": (2, _description('fmiVersion="2.0"', 'fmiVersion="1.0"'), '"slip.fmu", of FMI 1.0'),
    "no co-simulation": (
        2,
        _description("CoSimulation", "ModelExchange"),
        '"slip.fmu", without co-simulation',
    ),
    "no description": (2, lambda members: {"readme.txt": b""}, "without modelDescription.xml"),
    "no XML": (
        3,
        lambda members: {"modelDescription.xml": b"<fmi"},
        "whose modelDescription.xml cannot be read",
    ),
    "not valid": (3, _description("instantiationToken", "token"), "whose modelDescription.xml is not valid"),
    "another platform": (2, _without_binary, "it has binaries for win64"),
    "another platform, FMI 3": (3, _without_binary, "it has binaries for x86_64-windows"),
    "a library that is none": (
        2,
        lambda members: {
            name: (b"no library" if name.endswith(".so") else content) for name, content in members.items()
        },
        "which cannot be started",
    ),
    "another token": (
        3,
        _description("{slip-law-3}", "{other}"),
        "which cannot be started: Failed to instantiate FMU",
    ),
    "an input that is no channel": (
        2,
        _description("ws1.slip", "ws1.slop"),
        'run.controller.inputs[0]: found "ws1.slop"',
    ),
    "no output that can be set": (
        3,
        _description(".torque", ".force"),
        "bogie1.force, bogie2.force in slip.fmu",
    ),
}


@pytest.mark.skipif(sys.platform != "linux", reason="names of Linux binaries")
@pytest.mark.parametrize("what", SPOILED_FMUS)
def test_an_fmu_that_is_none_is_one_message(
    what: str, with_fmu: Callable[..., Path], message: Callable[..., str]
) -> None:
    version, change, expected = SPOILED_FMUS[what]
    path = with_fmu(version)
    fmus.pack(path, change(fmus.members(path)))
    said = message()
    assert said.startswith(f"lmap: {SPEC}:"), said
    assert expected in said, said


def test_an_fmu_that_is_missing_or_no_archive_is_one_message(
    place: Path, message: Callable[..., str]
) -> None:
    spoil(place / SPEC, 'law = "slip_pi:SlipPI"', 'law = "slip.fmu"')
    assert '"slip.fmu", which is no file' in message()
    (place / "slip.fmu").write_text("no zip")
    assert '"slip.fmu", which is no zip archive' in message()
    with zipfile.ZipFile(place / "slip.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", "<fmiModelDescription/>")
    sealed = bytearray((place / "slip.fmu").read_bytes())
    sealed[6] |= 1  # encrypted, say its local and its central header
    sealed[sealed.find(b"PK\x01\x02") + 8] |= 1
    (place / "slip.fmu").write_bytes(sealed)
    assert "whose modelDescription.xml cannot be unpacked" in message()


def test_an_fmu_without_fmpy_says_how_to_get_it(
    with_fmu: Callable[..., Path], message: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    with_fmu(2)
    monkeypatch.setitem(sys.modules, "fmpy", None)
    said = message()
    assert '"slip.fmu", and fmpy is not installed' in said
    assert "pip install 'lmap[fmu]'" in said
