"""The wheel: what is in it, and that a spec runs by its name from an empty folder."""

import os
import subprocess
import sys
import zipfile
from collections.abc import Mapping
from pathlib import Path

import pytest
from filelock import FileLock

pytestmark = [pytest.mark.slow, pytest.mark.timeout(1500)]

ROOT = Path(__file__).resolve().parents[2]
CLEAN = {
    k: v for k, v in os.environ.items() if k not in {"PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV", "PYO3_PYTHON"}
}


def run(*command: str | Path, cwd: Path, env: Mapping[str, str] | None = None) -> str:
    done = subprocess.run(
        command, cwd=cwd, env=CLEAN | dict(env or {}), capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, f"{command}: {done.returncode}\n{done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory, testrun_uid: str, worker_id: str) -> Path:
    """Built once, whatever the number of workers: two builds at a time would take each other's copies of the data."""
    base = tmp_path_factory.getbasetemp()
    folder = (base if worker_id == "master" else base.parent) / f"wheel-{testrun_uid}"
    with FileLock(f"{folder}.lock"):
        if not folder.exists():
            made = tmp_path_factory.mktemp("wheel")
            run(sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "-w", made, ROOT, cwd=made)
            made.rename(folder)
    (built,) = folder.glob("*.whl")
    return built


@pytest.fixture(scope="module")
def python(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The interpreter of a fresh environment with nothing but the wheel and what it asks for."""
    folder = tmp_path_factory.mktemp("venv")
    run(sys.executable, "-m", "venv", folder, cwd=folder)
    python = folder / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    run(python, "-m", "pip", "install", "--quiet", wheel, cwd=folder)
    return python


def files(*folders: str) -> set[str]:
    """What git would know of the folders: the working tree less what a build leaves."""
    return {
        path.relative_to(ROOT).as_posix()
        for folder in folders
        for path in (ROOT / folder).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }


def test_wheel_is_for_every_python_from_3_11(wheel: Path) -> None:
    assert "-cp311-abi3-" in wheel.name


def test_wheel_has_one_folder_at_its_top(wheel: Path) -> None:
    tops = {name.split("/")[0] for name in zipfile.ZipFile(wheel).namelist()}
    assert {top for top in tops if not top.endswith(".dist-info")} == {"lmap"}


def test_wheel_carries_specs_models_stubs_and_licences(wheel: Path) -> None:
    names = set(zipfile.ZipFile(wheel).namelist())
    carried = {name.removeprefix("lmap/data/") for name in names if name.startswith("lmap/data/")}
    assert carried == files("specs", "models")
    assert {"lmap/_railsim.pyi", "lmap/py.typed"} <= names
    assert {Path(name).name for name in names if "/licenses/" in name} == {"LICENSE-MIT", "LICENSE-APACHE"}


def test_build_leaves_no_copies_behind(wheel: Path) -> None:
    assert wheel.is_file()
    assert not (ROOT / "python/lmap/data").exists()


def test_a_spec_runs_by_name_from_an_empty_folder(python: Path, tmp_path: Path) -> None:
    empty = tmp_path / "empty"
    empty.mkdir()
    module = run(python, "-c", "import lmap; print(lmap.__file__)", cwd=empty)
    assert ROOT not in Path(module.strip()).parents
    lmap = python.with_name("lmap")
    run(lmap, "check", "hunting", "--report", tmp_path / "report", cwd=empty)
    assert (tmp_path / "report/index.html").is_file()
    assert list(empty.iterdir()) == []


def test_the_source_distribution_builds_the_same_wheel(wheel: Path, tmp_path: Path) -> None:
    code = f"import lmap_build; lmap_build.build_sdist({str(tmp_path)!r})"
    backend = {"PYTHONPATH": str(ROOT / "build_backend")}
    run(sys.executable, "-c", code, cwd=ROOT, env=backend)
    (source,) = tmp_path.glob("*.tar.gz")
    # The dependencies are compiled already.
    target = {"CARGO_TARGET_DIR": os.environ.get("CARGO_TARGET_DIR", str(ROOT / "target"))}
    run(
        sys.executable,
        "-m",
        "pip",
        "wheel",
        "--quiet",
        "--no-deps",
        "-w",
        tmp_path,
        source,
        cwd=tmp_path,
        env=target,
    )
    (built,) = tmp_path.glob("*.whl")
    assert set(zipfile.ZipFile(built).namelist()) == set(zipfile.ZipFile(wheel).namelist())
