"""200 short variants of one spec on one thread and on two, without cache: how much faster, and are the bytes the same?

    .venv/bin/python tests/benchmarks/variants.py [VARIANTS [METRES]]

Needs the release build (`pip install .`) and a machine that does nothing else. Every run is a process of its own.
Prints wall times, their ratio (at least 1.85 is asked for) and whether the tables agree to the last bit.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import polars as pl


def timed(jobs: int, variants: int, metres: float, folder: Path) -> tuple[float, bytes]:
    command = [sys.executable, "-m", "lmap", "sweep", "hunting", "--quiet", "--no-cache", "--jobs", str(jobs)]
    command += ["--set", f"track.length={metres}", "--set", "track.irregularity.period=50"]
    command += ["--set", "run.wheel_profile=anzr1_worn_1", "--vary", "run.speed_kmh=100..130"]
    command += ["--samples", str(variants), "--out", str(folder)]
    begun = time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    wall = time.perf_counter() - begun
    if done.returncode not in (0, 1, 2):
        raise SystemExit(done.stderr)
    frame = pl.read_parquet(folder / "sweep.parquet")
    return wall, frame.serialize()


def say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


def main() -> None:
    variants, metres = (int(sys.argv[1]) if len(sys.argv) > 1 else 200), float((sys.argv[2:] or ["300"])[0])
    say(f"{variants} variants of hunting over {metres:g} m, {os.cpu_count()} processors")
    with tempfile.TemporaryDirectory() as name:
        found = {jobs: timed(jobs, variants, metres, Path(name) / str(jobs)) for jobs in (1, 2)}
    for jobs, (wall, _) in found.items():
        say(f"--jobs {jobs}: {wall:.2f} s, {1e3 * wall / variants:.0f} ms a variant")
    say(f"ratio {found[1][0] / found[2][0]:.3f}, same bytes: {found[1][1] == found[2][1]}")


if __name__ == "__main__":
    main()
