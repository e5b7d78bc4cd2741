"""Build backend: maturin, with `specs/` and `models/` laid into the package while a wheel is built.

Both folders stand at the root of the project, where people look for them, and must travel inside the
package, so that `lmap check hunting` works from any folder. maturin alone puts files that it includes where
they stand, which would be beside the package in site-packages.

An editable install gets no copy: a copy would go stale, and the package finds the folders at the root.
"""

from __future__ import annotations

import shutil
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import maturin

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

ROOT = Path(__file__).resolve().parent.parent
DATA = ROOT / "python" / "lmap" / "data"
FOLDERS = ("models", "specs")

get_requires_for_build_wheel = maturin.get_requires_for_build_wheel
get_requires_for_build_editable = maturin.get_requires_for_build_editable
get_requires_for_build_sdist = maturin.get_requires_for_build_sdist
prepare_metadata_for_build_wheel = maturin.prepare_metadata_for_build_wheel
prepare_metadata_for_build_editable = maturin.prepare_metadata_for_build_editable


def build_wheel(
    wheel_directory: str,
    config_settings: Mapping[str, Any] | None = None,
    metadata_directory: str | None = None,
) -> str:
    """Build a wheel that carries the specs and models."""
    with _data():
        return str(maturin.build_wheel(wheel_directory, config_settings, metadata_directory))


def build_editable(
    wheel_directory: str,
    config_settings: Mapping[str, Any] | None = None,
    metadata_directory: str | None = None,
) -> str:
    """Build a wheel that points to the sources."""
    _remove()
    return str(maturin.build_editable(wheel_directory, config_settings, metadata_directory))


def build_sdist(sdist_directory: str, config_settings: Mapping[str, Any] | None = None) -> str:
    """Build a source distribution: the folders at its root, as here."""
    _remove()
    return str(maturin.build_sdist(sdist_directory, config_settings))


@contextmanager
def _data() -> Iterator[None]:
    """Fresh copies of the folders inside the package, for as long as the build takes."""
    _remove()
    try:
        for folder in FOLDERS:
            if not (ROOT / folder).is_dir():
                raise FileNotFoundError(f"{ROOT / folder}: the package needs this folder")
            shutil.copytree(ROOT / folder, DATA / folder, ignore=shutil.ignore_patterns("__pycache__"))
        yield
    finally:
        _remove()


def _remove() -> None:
    if DATA.exists():
        shutil.rmtree(DATA)
