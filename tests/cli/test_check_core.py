"""`lmap check` on the real core, as a user runs it."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import pytest
from commands import STOPPED, command, environment, run, stopped_by_ctrl_c

pytestmark = [pytest.mark.needs_core, pytest.mark.skipif(sys.platform == "win32", reason="POSIX processes")]


SHORT = ("--set", "track.length=400", "--set", "track.irregularity.period=200")
"""A run that is over soon, long enough for the windows of 5 s."""


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
    # 90 km take minutes
    assert stopped_by_ctrl_c(tmp_path, long, after_s=1.0) == STOPPED
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
