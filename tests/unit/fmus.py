"""FMUs that tests build from `tests/fmu` with the system's C compiler."""

from __future__ import annotations

import os
import shutil
import subprocess
import zipfile
from pathlib import Path

import pytest

SOURCES = Path(__file__).parents[1] / "fmu"
NAME = "slip"


def compiler() -> str:
    """The C compiler; skips where there is none."""
    found = shutil.which(os.environ.get("CC", "cc"))
    if found is None:
        pytest.skip("no C compiler (cc): the test FMU cannot be built")
    return found


def build(folder: Path, version: int) -> Path:
    """`slip.fmu` of FMI 2 or 3 in a folder."""
    fmpy = pytest.importorskip("fmpy", reason="fmpy is not installed (pip install 'lmap[fmu]')")
    library = folder / f"{NAME}{fmpy.sharedLibraryExtension}"
    command = [
        compiler(),
        "-std=c11",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-O1",
        "-ffp-contract=off",
        "-shared",
        "-fPIC",
    ]
    command += [str(SOURCES / f"fmi{version}.c"), "-lm", "-o", str(library)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=100)
    assert done.returncode == 0, done.stderr
    platform = fmpy.platform if version == 2 else fmpy.platform_tuple
    members = {
        "modelDescription.xml": (SOURCES / f"modelDescription{version}.xml").read_bytes(),
        f"binaries/{platform}/{library.name}": library.read_bytes(),
    }
    library.unlink()
    return pack(folder / f"{NAME}.fmu", members)


def pack(path: Path, members: dict[str, bytes]) -> Path:
    """A zip archive."""
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return path


def members(path: Path) -> dict[str, bytes]:
    """What is in it."""
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}
