"""Finding what ships by name: vehicles, tracks, profiles and specs; and reading text files.

A name is looked for beside the file that names it and upwards (`models/vehicles/<name>.toml`), then in the
package's own data, then, in a source checkout, below the repository's root. What has a slash in it or ends in
the file's suffix is a path, seen from the file that names it.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from lmap.errors import InputProblem, Problem, listed, nearest_hint

_PACKAGE = Path(__file__).resolve().parent


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of file that has names."""

    noun: str
    folder: str
    suffix: str

    def is_path(self, name: str) -> bool:
        """Whether a name is a path."""
        return "/" in name or "\\" in name or name.endswith(self.suffix)


OUTLINE = Kind("reference outline", "models/outlines", ".toml")
PROFILE = Kind("profile", "models/profiles", ".csv")
SPEC = Kind("spec", "specs", ".toml")
TRACK = Kind("track", "models/tracks", ".toml")
VEHICLE = Kind("vehicle", "models/vehicles", ".toml")


def shipped_roots() -> list[Path]:
    """Where the package's own models and specs are: in the wheel, and in a source checkout."""
    roots = [_PACKAGE / "data"]
    checkout = _PACKAGE.parent.parent
    if (checkout / "Cargo.toml").is_file() and (checkout / "models").is_dir():
        roots.append(checkout)
    return [root for root in roots if root.is_dir()]


def _places(kind: Kind, beside: Path) -> Iterator[Path]:
    """Folders that may hold files of a kind, nearest first."""
    folder = beside if beside.is_dir() else beside.parent
    folder = folder.resolve()
    if kind is not SPEC:
        yield folder
    for above in (folder, *folder.parents):
        yield above / kind.folder
    for root in shipped_roots():
        yield root / kind.folder


def find(kind: Kind, name: str, beside: Path) -> Path:
    """The file that a name means, seen from the file or folder `beside`; else an `InputProblem`."""
    if kind.is_path(name):
        folder = beside if beside.is_dir() else beside.parent
        path = folder / name
        if path.is_file():
            return path
        raise InputProblem(Problem(found=f'"{name}", which is no file', allowed=f"a {kind.noun} file"))
    for folder in _places(kind, beside):
        path = folder / f"{name}{kind.suffix}"
        if path.is_file():
            return path
    known = names(kind, beside)
    hint = nearest_hint(name, known)
    allowed = (
        f"a {kind.noun} that ships ({listed(known)}) or a path" if known else f"a path of a {kind.noun} file"
    )
    raise InputProblem(Problem(found=f'"{name}"', allowed=allowed, hint=hint))


def names(kind: Kind, beside: Path) -> list[str]:
    """Every name of a kind that would be found from `beside`, sorted."""
    found: set[str] = set()
    for folder in _places(kind, beside):
        if folder.name == kind.folder.rsplit("/", maxsplit=1)[-1] and folder.is_dir():
            found.update(path.stem for path in folder.glob(f"*{kind.suffix}"))
    return sorted(found)


def shown(path: Path) -> str:
    """A path as messages show it, with forward slashes: seen from the working folder, `../specs/x.toml`.

    What ships is `<lmap>/specs/x.toml` where the working folder lies elsewhere; what has nothing but the root in common
    with it is shown as it is.
    """
    here, there = Path.cwd(), path.resolve()
    below = there.is_relative_to(here)
    for root in shipped_roots():
        # an environment below the working folder is no place that anybody knows
        if (
            there.is_relative_to(root)
            and not here.is_relative_to(root)
            and (_PACKAGE in root.parents or not below)
        ):
            return f"<lmap>/{there.relative_to(root).as_posix()}"
    if not below and there.parts[:2] != here.parts[:2]:
        return path.as_posix()
    return Path(os.path.relpath(there, here)).as_posix()


def recorded(path: Path) -> str:
    """A path as reports keep it: as messages show it, but with nothing of this machine: at worst the file's name."""
    text = shown(path)
    return path.name if Path(text).is_absolute() else text


def read_text(path: Path, noun: str) -> str:
    """The text of a file; an `InputProblem` where there is none."""
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError:
        found, allowed = "no such file", f"a {noun} file"
    except IsADirectoryError:
        found, allowed = "a folder", f"a {noun} file"
    except UnicodeDecodeError as error:
        found, allowed = f"bytes that are no UTF-8 text (at {error.start})", f"a {noun} file in UTF-8"
    except OSError as error:
        found, allowed = f"a file that cannot be read ({error.strerror})", f"a readable {noun} file"
    raise InputProblem(Problem(file=shown(path), found=found, allowed=allowed))


def sha256(text: str) -> str:
    """SHA-256 of a text as UTF-8, in hexadecimal."""
    return hashlib.sha256(text.encode()).hexdigest()


def write(path: Path, content: bytes) -> None:
    """Writes a file whole or not at all."""
    put(path, lambda temporary: temporary.write_bytes(content))


def put(path: Path, write: Callable[[Path], object]) -> None:
    """Lets a file be written under a temporary name, then renames it: never half a file, not on a full disk either."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        write(temporary)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
