"""`lmap` as a user runs it: in this process or as one of its own, on files that are spoiled."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import lmap

ROOT = Path(__file__).parents[2]


class Ran(NamedTuple):
    """What a command came to."""

    code: int
    out: str
    err: str


def spoil(path: str | Path, old: str, new: str) -> int:
    """Replaces the first occurrence in a file; the line where it is."""
    file = Path(path)
    text = file.read_text(encoding="utf-8")
    assert old in text, f"{old} is not in {path}"
    file.write_text(text.replace(old, new, 1), encoding="utf-8")
    return text[: text.index(old)].count("\n") + 1


def environment() -> dict[str, str]:
    """Of a process that is to find this package, and the test's own cache."""
    return {**os.environ, "PYTHONPATH": str(Path(lmap.__file__).parent.parent)}


def command(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "lmap", *arguments]


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """A process to its end."""
    return subprocess.run(
        command(*arguments),
        cwd=folder,
        env=environment(),
        capture_output=True,
        text=True,
        check=False,
        timeout=200,
    )


def stopped_by_ctrl_c(folder: Path, arguments: Sequence[str], *, after_s: float = 0.0) -> Ran:
    """A process that is interrupted once it runs two cases; the rest of what it says.

    Alone it stops in a tenth of a second; a loaded machine takes what it takes, but not what the run would.
    """
    pipe = subprocess.PIPE
    with subprocess.Popen(
        arguments, cwd=folder, env=environment(), stdout=pipe, stderr=pipe, text=True
    ) as process:
        assert process.stderr is not None
        assert process.stdout is not None
        assert process.stderr.readline().startswith("running 2 cases")
        time.sleep(after_s)
        process.send_signal(signal.SIGINT)
        code = process.wait(timeout=30)
        return Ran(code, process.stdout.read(), process.stderr.read())


STOPPED = Ran(130, "", "lmap: stopped\n")


def contents(folder: Path) -> Mapping[str, bytes]:
    """Every file below a folder and what is in it."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }
