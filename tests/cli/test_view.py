"""`lmap view` and the check of test 1.2 on the real core, as a user runs them."""

from __future__ import annotations

import json
import re
from pathlib import Path

import polars as pl
import pytest
from commands import run

import lmap

pytestmark = pytest.mark.needs_core

ROOT = Path(__file__).parents[2]


def scene_of(page: Path) -> dict[str, object]:
    text = page.read_text(encoding="utf-8")
    found = re.search(r'<script type="application/json" id="scene">(.*?)</script>', text, re.DOTALL)
    assert found is not None
    scene: dict[str, object] = json.loads(found[1])
    return scene


@pytest.mark.slow
def test_view_writes_one_page_with_modes_and_a_run(tmp_path: Path) -> None:
    frame = {"t": [0.0, 0.1, 0.2], "carbody.y": [0.0, 0.01, 0.0], "carbody.z": [-1.95] * 3}
    pl.DataFrame(frame).write_parquet(tmp_path / "r.parquet")
    done = run(tmp_path, "view", "coco134", "--out", "out/deep", "--run", "r.parquet", "--speed-kmh", "0")
    assert (done.returncode, done.stderr) == (0, "")
    page = tmp_path / "out" / "deep" / "view-coco134.html"
    assert [path.name for path in page.parent.iterdir()] == [page.name]
    assert done.stdout.startswith("out/deep/view-coco134.html: model ")
    motions = scene_of(page)["motions"]
    assert isinstance(motions, list)
    assert [one["kind"] for one in motions].count("run") == 1
    assert len([one for one in motions if one["kind"] == "mode"]) > 5
    assert "http://" not in re.sub(
        r"<script>.*?</script>", "", page.read_text(encoding="utf-8"), flags=re.DOTALL
    )


@pytest.mark.slow
def test_view_says_what_it_finds_and_leaves_with_one(tmp_path: Path) -> None:
    done = run(tmp_path, "view", "coco134", "--set", "wheelset.tape_half_distance=0.85")
    assert done.returncode == 1
    assert (
        "off_rail: the left tape circle of ws1 is 60.5 mm off its rail head; allowed: 0.001 m" in done.stdout
    )
    assert (tmp_path / "view-coco134.html").is_file()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("nowhere",), 'found "nowhere"'),
        (("coco134", "--condition", "wet"), "condition"),
        (("coco134", "--run", "none.parquet"), "none.parquet: --run: found no such file"),
        (("coco134", "--run", "text.parquet"), "text.parquet: --run: found what is no parquet"),
        (("coco134", "--out", "text.parquet"), "--out: found text.parquet, a file; allowed: a folder"),
        (("coco134", "--speed-kmh", "fast"), '--speed-kmh: found "fast"'),
    ],
)
def test_bad_input_is_one_message_and_no_page(
    tmp_path: Path, arguments: tuple[str, ...], message: str
) -> None:
    (tmp_path / "text.parquet").write_text("not columns", encoding="utf-8")
    done = run(tmp_path, "view", *arguments)
    assert (done.returncode, done.stdout) == (2, "")
    [line] = done.stderr.splitlines()
    assert line.startswith("lmap: ")
    assert message in line
    assert [path.name for path in tmp_path.iterdir()] == ["text.parquet"]


@pytest.mark.slow
def test_the_check_waits_for_a_person_and_passes_with_the_lines_that_it_printed(tmp_path: Path) -> None:
    done = run(tmp_path, "check", "view", "--json", "--report", "out")
    assert done.returncode == 1
    [spec] = json.loads(done.stdout)["specs"]
    assert (spec["id"], spec["verdict"]) == ("1.2", "manual")
    assert [one["verdict"] for one in spec["criteria"]] == ["pass", "pass", "pass", "manual"]
    message = spec["criteria"][-1]["message"]
    assert "lmap view coco134 --condition full" in message
    assert (tmp_path / "out" / "view-1.2.html").is_file()
    assert 'href="view-1.2.html"' in (tmp_path / "out" / "index.html").read_text(encoding="utf-8")

    # a copy, signed by nobody: only a person signs the spec that ships
    lines = (
        message[message.index("[sign_off]") :]
        .replace("YOUR NAME", "Nobody")
        .replace("YYYY-MM-DD", "2026-01-31")
    )
    signed = tmp_path / "signed.toml"
    text = (ROOT / "specs" / "view.toml").read_text(encoding="utf-8")
    signed.write_text(f"{text}\n{lines}\n", encoding="utf-8")
    done = run(tmp_path, "check", "./signed.toml")
    assert (done.returncode, done.stderr.count("lmap:")) == (0, 0)
    assert "signed by Nobody on 2026-01-31" in done.stdout

    done = run(tmp_path, "check", "./signed.toml", "--set", "secondary.kz=5.9e5", "--json")
    assert done.returncode == 1
    [spec] = json.loads(done.stdout)["specs"]
    assert spec["verdict"] == "manual"
    assert "the sign-off of Nobody (2026-01-31) is void" in spec["criteria"][-1]["message"]


def test_the_spec_that_ships_is_unsigned_or_signed_for_the_vehicle_that_ships() -> None:
    from lmap.spec.load import load
    from lmap.view import model_hash

    spec = load(ROOT / "specs" / "view.toml").spec
    if spec.sign_off is None:
        return
    assert spec.sign_off.model == model_hash(lmap.Vehicle.load(spec.vehicle, condition=spec.condition).data)
