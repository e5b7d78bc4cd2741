"""The scripts in `examples/` run, from any folder, and print what they say."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import lmap

pytestmark = pytest.mark.needs_core
ROOT = Path(__file__).parents[2]
SCRIPTS = sorted((ROOT / "examples").glob("*.py"))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_the_script_runs(script: Path, tmp_path: Path) -> None:
    done = run(script, tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip()
    assert not done.stderr
    assert not list(tmp_path.iterdir())
    if script.stem == "first_vehicle":
        bounces_on_its_springs(done.stdout)


@pytest.mark.slow
def test_the_adhesion_curve_is_drawn_and_peaks_as_in_the_paper() -> None:
    """Figure 5 of the paper: 0.343 dry, 0.263 wet, within 3 %; the last point of each is beyond the peak."""
    [spec] = lmap.check(ROOT / "examples" / "adhesion_curve.toml").specs
    assert spec.outcome == "pass"
    [drawing] = [one for one in spec.drawings if one.title == "Adhesion over slip"]
    curves = {curve.name: curve for curve in drawing.curves}
    for rail, peak in (("dry", 0.343), ("wet", 0.263)):
        ran = curves[f"{rail}, ws1"]
        assert max(ran.y) == pytest.approx(peak, rel=0.03)
        assert ran.x[-1] == pytest.approx(0.30, rel=0.1)
        assert ran.y[-1] < max(ran.y)
        assert list(curves[f"peak in the paper, {rail}"].y) == [peak]


def bounces_on_its_springs(printed: str) -> None:
    """sqrt(k/m)/(2 pi) with 4 springs of 1.2 and 0.6 MN/m under 12 t, less what rail and contact give way."""
    found = re.search(r"^bounce: ([0-9.]+) Hz, with soft springs ([0-9.]+) Hz$", printed, re.MULTILINE)
    assert found is not None, printed
    stiff, soft = (float(text) for text in found.groups())
    assert stiff == pytest.approx(3.183, rel=0.03)
    assert soft == pytest.approx(2.251, rel=0.04)


def run(script: Path, folder: Path) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(Path(lmap.__file__).parent.parent)}
    return subprocess.run(
        [sys.executable, str(script)],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=200,
    )
