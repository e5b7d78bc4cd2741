"""Where names are looked for."""

from __future__ import annotations

from pathlib import Path

import pytest

from lmap import files
from lmap.errors import InputProblem


def write(path: Path, text: str = "") -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


def test_a_name_is_found_beside_then_upwards(tmp_path: Path) -> None:
    spec = write(tmp_path / "a" / "b" / "specs" / "x.toml")
    far = write(tmp_path / "models" / "vehicles" / "loco.toml")
    assert files.find(files.VEHICLE, "loco", spec) == far
    near = write(tmp_path / "a" / "models" / "vehicles" / "loco.toml")
    assert files.find(files.VEHICLE, "loco", spec) == near
    beside = write(spec.parent / "loco.toml")
    assert files.find(files.VEHICLE, "loco", spec) == beside


def test_the_packages_own_data_comes_last(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shipped = tmp_path / "shipped"
    monkeypatch.setattr(files, "shipped_roots", lambda: [shipped])
    theirs = write(shipped / "models" / "profiles" / "round.csv")
    spec = write(tmp_path / "mine" / "x.toml")
    assert files.find(files.PROFILE, "round", spec) == theirs
    mine = write(tmp_path / "mine" / "models" / "profiles" / "round.csv")
    assert files.find(files.PROFILE, "round", spec) == mine


@pytest.mark.parametrize("name", ["sub/loco.toml", "./loco.toml", "loco.toml"])
def test_a_path_is_seen_from_the_file_that_names_it(name: str, tmp_path: Path) -> None:
    spec = write(tmp_path / "specs" / "x.toml")
    vehicle = write(tmp_path / "specs" / name)
    assert files.find(files.VEHICLE, name, spec).samefile(vehicle)
    with pytest.raises(InputProblem, match="which is no file"):
        files.find(files.VEHICLE, "other/" + name, spec)


def test_an_unknown_name_comes_with_the_nearest(tmp_path: Path) -> None:
    spec = write(tmp_path / "x.toml")
    write(tmp_path / "models" / "tracks" / "tangent_plain.toml")
    with pytest.raises(InputProblem, match='did you mean "tangent_plain"'):
        files.find(files.TRACK, "tangent_plane", spec)


def test_a_file_that_cannot_be_read_says_why(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputProblem, match=r"^gone.toml: found no such file; allowed: a spec file$"):
        files.read_text(Path("gone.toml"), "spec")
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(InputProblem, match="no UTF-8"):
        files.read_text(Path("bytes.toml"), "spec")
    with pytest.raises(InputProblem, match="a folder"):
        files.read_text(tmp_path, "spec")


def test_a_path_is_shown_from_the_working_folder_or_from_what_ships(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mine = tmp_path / "mine"
    checkout, package = tmp_path / "checkout", mine / ".venv" / "lmap"
    below, beside = write(mine / "specs" / "x.toml"), write(tmp_path / "other" / "x.toml")
    shipped = write(package / "data" / "specs" / "hunting.toml")
    checked_out = write(checkout / "specs" / "hunting.toml")
    monkeypatch.setattr(files, "_PACKAGE", package)
    monkeypatch.setattr(files, "shipped_roots", lambda: [package / "data", checkout])
    monkeypatch.chdir(mine)
    assert [files.shown(path) for path in (below, beside, shipped, checked_out, Path("gone.toml"))] == [
        "specs/x.toml",
        "../other/x.toml",
        "<lmap>/specs/hunting.toml",
        "<lmap>/specs/hunting.toml",
        "gone.toml",
    ]
    monkeypatch.chdir(tmp_path)
    assert files.shown(checked_out) == "checkout/specs/hunting.toml"
    assert files.shown(shipped) == "<lmap>/specs/hunting.toml"
    monkeypatch.chdir(checkout / "specs")
    assert files.shown(write(checkout / "models" / "x.toml")) == "../models/x.toml"


def test_a_report_keeps_nothing_of_the_machine(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    elsewhere = Path(Path.cwd().anchor) / "no-such-root" / "someone" / "x.toml"
    assert files.shown(elsewhere) == elsewhere.as_posix()
    assert files.recorded(elsewhere) == "x.toml"
    assert files.recorded(tmp_path / "specs" / "x.toml") == "specs/x.toml"
