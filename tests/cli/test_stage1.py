"""Stage 1 as a folder of specs: 1 while test 1.2 waits for its sign-off, 0 with one. Only copies are signed here."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from commands import Ran

pytestmark = pytest.mark.needs_core
ROOT = Path(__file__).parents[2]
QUICK = ("lint", "modes", "view")
STAGE_1 = (*QUICK, "critical_speed", "lateral_push", "step", "vertical_push")

Check = Callable[..., tuple[int, list[dict[str, Any]]]]


@pytest.fixture
def check(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lmap: Callable[..., Ran]) -> Check:
    """`lmap check specs/` with copies of these specs in it: exit code and the specs' verdicts."""
    monkeypatch.chdir(tmp_path)

    def run(*names: str) -> tuple[int, list[dict[str, Any]]]:
        folder = tmp_path / "specs"
        folder.mkdir(exist_ok=True)
        for name in names:
            if not (folder / f"{name}.toml").exists():
                shutil.copy(ROOT / "specs" / f"{name}.toml", folder)
        code, out, _ = lmap("check", "specs/", "--json", "--quiet")
        verdicts: list[dict[str, Any]] = json.loads(out)["specs"]
        return code, verdicts

    return run


def sign(specs: list[dict[str, Any]]) -> None:
    """Writes the lines that the check printed into the copy of the spec, in nobody's name."""
    [waiting] = [one for one in specs if one["id"] == "1.2"]
    message = waiting["criteria"][-1]["message"]
    signed = message[message.index("[sign_off]") :]
    signed = signed.replace("YOUR NAME", "Nobody").replace("YYYY-MM-DD", "2026-01-31")
    copy = Path("specs/view.toml")
    copy.write_text(f"{copy.read_text(encoding='utf-8')}\n{signed}\n", encoding="utf-8")


def outcomes(specs: list[dict[str, Any]]) -> dict[str, str]:
    return {one["id"]: one["verdict"] for one in specs}


def test_a_folder_waits_for_the_sign_off_and_passes_with_one(check: Check) -> None:
    code, specs = check(*QUICK)
    assert (code, outcomes(specs)) == (1, {"1.1": "pass", "1.2": "manual", "1.4": "pass"})
    sign(specs)
    code, specs = check(*QUICK)
    assert (code, outcomes(specs)) == (0, {"1.1": "pass", "1.2": "pass", "1.4": "pass"})


@pytest.mark.slow
def test_all_of_stage_1_and_hunting_pass_but_for_the_sign_off(check: Check) -> None:
    _, specs = check("view")
    sign(specs)
    code, specs = check(*STAGE_1, "hunting")
    ids = ("1.1", "1.2", "1.3a", "1.3b", "1.4", "1.5", "1.6", "2C.1")
    assert (code, outcomes(specs)) == (0, dict.fromkeys(ids, "pass"))
