"""`lmap lint` on the real core: findings with file and line, exit codes, one message for each kind of bad input."""

from __future__ import annotations

import contextlib
import functools
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from commands import Ran
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lmap.errors import InputProblem
from lmap.lint import lint
from lmap.vehicle import lint_codes

pytestmark = pytest.mark.needs_core
ROOT = Path(__file__).parents[2]
VEHICLE = "models/vehicles/coco134.toml"
Run = Callable[..., Ran]


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the project's models, to be spoiled."""
    shutil.copytree(ROOT / "models", tmp_path / "models")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def run(place: Path, lmap: Run, monkeypatch: pytest.MonkeyPatch) -> Run:
    """`lmap lint ...`."""
    monkeypatch.setenv("COLUMNS", "200")
    return functools.partial(lmap, "lint")


def spoil(old: str, new: str) -> int:
    """Replaces a text that is there once; the line where it is."""
    text = Path(VEHICLE).read_text(encoding="utf-8")
    assert text.count(old) == 1, old
    Path(VEHICLE).write_text(text.replace(old, new), encoding="utf-8")
    return text[: text.index(old)].count("\n") + 1


def found(out: str) -> list[tuple[str, str, int | None]]:
    document: dict[str, Any] = json.loads(out)
    return [(one["code"], one["key"], one["line"]) for one in document["findings"]]


@pytest.mark.parametrize("condition", ["full", "tare"])
def test_the_reference_locomotive_is_clean(run: Run, condition: str) -> None:
    assert run("coco134", "--condition", condition) == (0, "0 errors, 0 warnings\n", "")


def test_an_error_points_at_the_parameter_that_gave_the_number(run: Run) -> None:
    line = spoil("kz = 5.8e5", "kz = 1.5e5")
    code, out, err = run(VEHICLE, "--json")
    assert (code, err) == (1, "")
    assert found(out) == [("LM702", "parameters.secondary.kz", line)]
    document = json.loads(out)
    assert (document["errors"], document["warnings"]) == (1, 0)
    assert document["findings"][0]["file"] == VEHICLE
    assert document["findings"][0]["subject"] == "secondary_bogie1_front_right and 7 more"


def test_a_warning_leaves_with_0_and_the_table_names_code_and_line(run: Run) -> None:
    line = spoil("cy = 4.0e4 ", "cy = 0.0 ")
    code, out, err = run(VEHICLE)
    assert (code, err) == (0, "")
    assert "LM204 no-effect" in out
    assert "lateral_damper_bogie1_right and 3 more" in out
    assert out.endswith("0 errors, 1 warning\n")
    assert str(line) not in out  # the connection is named, not its parameter


def test_an_override_is_named_as_such(run: Run) -> None:
    code, out, _ = run("coco134", "--set", "secondary.kz=1e5", "--json")
    assert code == 1
    assert found(out) == [("LM702", "set.secondary.kz", None)] or found(out) == [
        ("LM702", 'set."secondary.kz"', None)
    ]


def test_unknown_names_are_findings(run: Run) -> None:
    line = spoil('mass = "$car.mass"', 'mass = "$car.weight"')
    code, out, err = run(VEHICLE, "--json")
    assert (code, err) == (1, "")
    assert found(out) == [("LM002", "body[0].mass", line)]


def test_select_and_ignore(run: Run) -> None:
    spoil("kz = 5.8e5", "kz = 1.5e5")
    spoil("cy = 4.0e4 ", "cy = 0.0 ")
    assert [one[0] for one in found(run(VEHICLE, "--json")[1])] == ["LM702", "LM204"]
    assert [one[0] for one in found(run(VEHICLE, "--json", "--select", "LM2")[1])] == ["LM204"]
    assert [one[0] for one in found(run(VEHICLE, "--json", "--ignore", "LM2,LM5")[1])] == ["LM702"]
    assert run(VEHICLE, "--ignore", "LM702")[0] == 0


def test_a_step_that_is_too_large(run: Run) -> None:
    code, out, _ = run("coco134", "--integrator", "heun", "--step", "0.001", "--json")
    assert (code, [one[0] for one in found(out)]) == (1, ["LM901"])


def test_bad_input(run: Run) -> None:
    messages = {
        ("coco13",): 'lmap: found "coco13"; allowed: ',
        ("no/such.toml",): 'lmap: found "no/such.toml", which is no file; allowed: a vehicle file\n',
        (
            "coco134",
            "--select",
            "LM77",
        ): 'lmap: --select: found "LM77"; allowed: codes or beginnings of codes: ',
        ("coco134", "--step", "-1"): "lmap: ",
        ("coco134", "--set", "car.mas=3"): 'lmap: set."car.mas": found the unknown name car.mas; allowed: ',
        ("coco134", "--integrator", "euler"): "lmap: ",
    }
    for arguments, message in messages.items():
        code, out, err = run(*arguments)
        assert (code, out) == (2, ""), arguments
        assert err.startswith(message), err
        assert "Traceback" not in err
    spoil("[contact]", "[contact")
    code, out, err = run(VEHICLE)
    assert (code, out) == (2, "")
    assert err.startswith(f"lmap: {VEHICLE}:"), err


def test_codes_are_those_of_the_reference() -> None:
    text = (ROOT / "docs/reference/lint.md").read_text(encoding="utf-8")
    headings = [line.removeprefix("## ") for line in text.splitlines() if line.startswith("## ")]
    assert headings == [f"{one['code']} {one['rule']}" for one in lint_codes()]
    assert len(headings) >= 25


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_a_mutated_file_gives_findings_or_a_message(data: st.DataObject, place: Path) -> None:
    lines = (ROOT / VEHICLE).read_text(encoding="utf-8").splitlines()
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(lines) - 1))
        way = data.draw(st.sampled_from(["drop", "double", "number", "word"]))
        if way == "drop":
            lines[at] = ""
        elif way == "double":
            lines.insert(at, lines[at])
        elif "=" in lines[at]:
            key = lines[at].split("=")[0]
            values = ["0.0", "-1.0", "1e12", "1e-12", "[]", "true"] if way == "number" else ['"nothing"']
            lines[at] = f"{key}= {data.draw(st.sampled_from(values))}"
    file = place / "mutated.toml"
    file.write_text("\n".join(lines), encoding="utf-8")
    with contextlib.suppress(InputProblem):
        for one in lint(file):
            assert one.code.startswith("LM")
            assert "nan" not in one.found.lower()
