"""Fixtures that all tests share."""

from __future__ import annotations

import importlib.util
import os
import shutil
import sys
from pathlib import Path
from types import ModuleType

import pytest

import lmap

TESTS = Path(__file__).parent
ROOT = TESTS.parent
for helpers in ("cli", "properties", "unit"):
    sys.path.insert(0, str(TESTS / helpers))


def has_core() -> bool:
    """Whether the compiled core is installed."""
    return importlib.util.find_spec("lmap._railsim") is not None


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "needs_core: needs the compiled core")
    config.addinivalue_line("markers", "slow: takes more than a few seconds")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    if has_core():
        return
    for item in items:
        if item.get_closest_marker("needs_core"):
            item.add_marker(pytest.mark.skip(reason="the compiled core is not built"))


@pytest.fixture(autouse=True)
def _own_cache(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """No test finds results of another one, nor of the user's."""
    monkeypatch.setenv("LMAP_CACHE_DIR", str(tmp_path_factory.mktemp("cache")))


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder with reference data that is not the project's to give away: `LMAP_SHARED`, else `../shared`.

    Skips where there is none.
    """
    folder = Path(os.environ.get("LMAP_SHARED") or ROOT.parent / "shared").resolve() / "data"
    if not folder.is_dir():
        pytest.skip("no reference data: neither ../shared/data nor LMAP_SHARED/data exists")
    return folder


@pytest.fixture(scope="session")
def fetched(shared: Path) -> Path:
    """Profiles and tables from public repositories (sources and licences in their heads): read there, never copied.

    Skips where the folder is absent.
    """
    folder = shared / "fetched"
    if not folder.is_dir():
        pytest.skip("no fetched reference data: shared/data/fetched does not exist")
    return folder


@pytest.fixture
def fake_core(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The stand-in for the core, in place of the compiled one."""
    import fake_railsim

    monkeypatch.setitem(sys.modules, "lmap._railsim", fake_railsim)
    monkeypatch.setattr(lmap, "_railsim", fake_railsim, raising=False)
    return fake_railsim


@pytest.fixture
def toy(tmp_path: Path, fake_core: ModuleType, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder with a toy vehicle, track, profiles and a spec, on the stand-in core."""
    folder = tmp_path / "toy"
    shutil.copytree(TESTS / "fixtures" / "toy", folder)
    monkeypatch.chdir(folder)
    return folder
