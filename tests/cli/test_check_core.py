"""`lmap check` on the real core, as a user runs it."""

from __future__ import annotations

import hashlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import lmap

pytestmark = [pytest.mark.needs_core, pytest.mark.skipif(sys.platform == "win32", reason="POSIX processes")]


def environment() -> dict[str, str]:
    """With the test's own cache in it."""
    return {**os.environ, "PYTHONPATH": str(Path(lmap.__file__).parent.parent)}


SHORT = ("--set", "track.length=400", "--set", "track.irregularity.period=200")
"""A run that is over soon, long enough for the windows of 5 s."""


def command(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "lmap", *arguments]


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command(*arguments),
        cwd=folder,
        env=environment(),
        capture_output=True,
        text=True,
        check=False,
        timeout=200,
    )


@pytest.mark.slow
def test_two_runs_on_one_and_two_threads_give_the_same_parquet_files(tmp_path: Path) -> None:
    hashes = []
    for name, jobs in (("a", "1"), ("b", "2")):
        done = run(tmp_path, "check", "hunting", "--quiet", "--report", name, "--jobs", jobs, *SHORT)
        assert done.returncode in (0, 1), done.stderr
        files = sorted((tmp_path / name / "cases").iterdir())
        assert len(files) == 4
        hashes.append({path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in files})
    assert hashes[0] == hashes[1]


def test_ctrl_c_stops_the_core_long_before_its_end_and_leaves_nothing(tmp_path: Path) -> None:
    long = command("check", "hunting", "--report", "out", "--set", "track.length=90000")
    with subprocess.Popen(
        long, cwd=tmp_path, env=environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stderr is not None
        assert process.stdout is not None
        assert process.stderr.readline().startswith("running 2 cases")
        time.sleep(1.0)
        process.send_signal(signal.SIGINT)
        # 90 km take minutes. Alone it stops in a tenth of a second; a loaded machine takes what it takes.
        code = process.wait(timeout=20)
        assert (code, process.stdout.read(), process.stderr.read()) == (130, "", "lmap: stopped\n")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_the_whole_check_stays_under_300_mebibytes(tmp_path: Path) -> None:
    arguments = command("check", "hunting", "--quiet", "--jobs", "1", "--report", "out")
    with (tmp_path / "log").open("w", encoding="utf-8") as log:
        process = subprocess.Popen(arguments, cwd=tmp_path, env=environment(), stdout=log, stderr=log)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0, (tmp_path / "log").read_text(encoding="utf-8")
    # KiB, but bytes on macOS
    peak = usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    assert peak < 300 * 2**20, f"{peak / 2**20:.0f} MiB"
