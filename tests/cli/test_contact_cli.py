"""`lmap contact` on the real core: what it prints and writes; one message for each kind of bad input."""

from __future__ import annotations

import functools
import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from commands import Ran

pytestmark = pytest.mark.needs_core
ROOT = Path(__file__).parents[2]
PAIR = ("anzr1", "as60", "--inclination", "1:20", "--gauge-depth", "16")
Run = Callable[..., Ran]


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with two profiles."""
    for name in ("anzr1", "as60"):
        shutil.copy(ROOT / "models" / "profiles" / f"{name}.csv", tmp_path / f"{name}.csv")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def run(place: Path, lmap: Run) -> Run:
    """`lmap contact ...`."""
    return functools.partial(lmap, "contact")


@pytest.fixture
def message(place: Path, refused: Callable[..., list[str]]) -> Callable[..., str]:
    """The one line that bad input says."""

    def call(*arguments: str) -> str:
        [line] = refused("contact", *arguments, "--out", "out")
        return line

    return call


def spoil(name: str, change: Callable[[list[list[float]]], list[list[float]]]) -> str:
    """Another profile file, its points changed; its name."""
    lines = Path(f"{name}.csv").read_text(encoding="utf-8").splitlines()
    points = [[float(x) for x in line.split(",")] for line in lines if line and line[0] in "-0123456789"]
    path = Path("spoilt.csv")
    path.write_text("".join(f"{y},{z}\n" for y, z in change(points)), encoding="utf-8")
    return path.as_posix()


def test_the_table_has_conicity_play_angle_and_patches(run: Run) -> None:
    code, out, err = run(*PAIR)
    assert (code, err) == (0, "")
    for word in ("equivalent conicity at 3 mm", "flange play", "contact angle", "patch, left wheel", "7 mm"):
        assert word in out
    assert "0.0500" in out  # the 1:20 cone


def test_json_is_one_object_and_nothing_else(run: Run) -> None:
    code, out, err = run(*PAIR, "--json", "--law", "polach", "--law", "fastsim")
    assert (code, err) == (0, "")
    found = json.loads(out)
    at_3_mm = found["conicity"]["amplitude"].index(pytest.approx(0.003))
    assert found["conicity"]["integration"][at_3_mm] == pytest.approx(0.05, abs=5e-4)
    assert list(found["creep"]["laws"]) == ["polach", "fastsim"]
    assert found["flange_play"][1] == pytest.approx(-found["flange_play"][0], abs=1e-6)


def test_the_page_stands_alone(run: Run, place: Path) -> None:
    code, _, err = run(*PAIR, "--out", "out")
    assert code == 0
    assert err == "figures: out/contact.html\n"
    assert [path.name for path in (place / "out").iterdir()] == ["contact.html"]
    page = (place / "out" / "contact.html").read_text(encoding="utf-8")
    for title in (
        "Rolling radius difference",
        "Equivalent conicity",
        "Contact points",
        "Creep curves",
        "Traction curve",
        "Convergence with the grid",
    ):
        assert title in page
    head = page[: page.index("<script>")]
    assert "http" not in head.replace("http-equiv", "")
    assert page.count('<figure class="plot"') == 8


def test_a_rail_where_the_wheel_belongs(message: Callable[..., str]) -> None:
    line = message("as60.csv", "as60.csv")
    assert line.startswith("lmap: as60.csv: ")
    assert "rail" in line


def test_a_wheel_with_its_flange_outside_is_turned_or_refused(run: Run, place: Path) -> None:
    """The direction is detected: a mirrored wheel gives the same figures, and the page says that it was turned."""
    mirrored = spoil("anzr1", lambda points: [[-y, z] for y, z in points])
    code, out, _ = run(mirrored, *PAIR[1:])
    assert code == 0
    assert "0.0500" in out


def test_metres_instead_of_millimetres(message: Callable[..., str], run: Run) -> None:
    metres = spoil("anzr1", lambda points: [[1e-3 * y, 1e-3 * z] for y, z in points])
    code, out, err = run(metres, *PAIR[1:])
    # read as metres, and so said; or refused with the unit in the message
    assert (code == 0 and "0.0500" in out) or (code == 2 and " m" in err)


def test_a_profile_that_crosses_itself(message: Callable[..., str]) -> None:
    def crossing(points: list[list[float]]) -> list[list[float]]:
        middle = len(points) // 2
        return [*points[: middle + 40], *points[middle + 10 : middle - 10 : -1], *points[middle + 10 :]]

    line = message(spoil("anzr1", crossing), *PAIR[1:])
    assert line.startswith("lmap: spoilt.csv: ")
    assert "cross" in line


def test_a_gauge_that_lets_the_wheelset_fall_in(message: Callable[..., str]) -> None:
    line = message(*PAIR, "--gauge", "1700")
    assert line.startswith("lmap: gauge: found 1.7 m: ")
    assert "the wheelset falls in; allowed: 1." in line


def test_a_gauge_on_which_the_flanges_stand(message: Callable[..., str]) -> None:
    line = message(*PAIR, "--gauge", "1380")
    assert line.startswith("lmap: gauge: found 1.38 m: the flanges ")
    assert "too far apart for it; allowed: 1." in line


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("--load", "-100"), "lmap: --load: found -100 kN; allowed: a number > 0, kN"),
        (("--load", "nan"), "lmap: --load: found nan kN; allowed: a number > 0, kN"),
        (("--friction", "-0.3"), "lmap: --friction: found -0.3; allowed: a number > 0"),
        (("--gauge", "inf"), "lmap: --gauge: found inf mm; allowed: a number > 0, mm"),
        (("--radius", "0"), "lmap: --radius: found 0 mm; allowed: a number > 0, mm"),
        (
            ("--inclination", "steep"),
            'lmap: --inclination: found "steep"; allowed: 1:5 or flatter, as 1:40 or 0.025; 0',
        ),
        (
            ("--inclination", "1:0"),
            'lmap: --inclination: found "1:0"; allowed: 1:5 or flatter, as 1:40 or 0.025; 0',
        ),
    ],
)
def test_a_number_that_makes_no_sense(
    message: Callable[..., str], arguments: tuple[str, ...], expected: str
) -> None:
    assert message(*PAIR, *arguments) == expected


def test_an_unknown_law_with_the_nearest_known_one(message: Callable[..., str]) -> None:
    line = message(*PAIR, "--law", "polack")
    assert line.startswith('lmap: law: found "polack"; allowed: fastrip, fastsim, ')
    assert line.endswith('(did you mean "polach"?)')


def test_a_missing_file(message: Callable[..., str]) -> None:
    assert message("nowhere.csv", "as60") == "lmap: nowhere.csv: found no such file; allowed: a profile file"


def test_an_unknown_name_with_the_nearest_known_one(message: Callable[..., str]) -> None:
    line = message("anzr2", "as60")
    assert line.startswith('lmap: found "anzr2"; allowed: a profile that ships (')
    assert 'did you mean "anzr1' in line


def test_a_folder_that_is_a_file(run: Run, place: Path) -> None:
    code, out, err = run(*PAIR, "--out", "as60.csv")
    assert (code, out) == (2, "")
    assert err == "lmap: --out: found as60.csv, a file; allowed: a folder\n"
