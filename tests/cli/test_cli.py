"""The command line on the stand-in core: what goes where, and exit codes."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import polars as pl
import pytest
from commands import STOPPED, Ran, contents, environment, stopped_by_ctrl_c

from lmap import prepare

FAKE = Path(__file__).parent / "fake_cli.py"


pytestmark = pytest.mark.usefixtures("toy")


def test_cache_shows_and_clears(lmap: Callable[..., Ran]) -> None:
    assert "\n0 cases, 0.00 MB of 10 GB\n" in lmap("cache").out
    lmap("check", "sway")
    assert "\n2 cases, " in lmap("cache").out
    assert "removed: 2 cases" in lmap("cache", "--clear").out
    assert "running 2 cases" in lmap("check", "sway").err
    lmap("cache", "--clear")
    lmap("check", "sway", "--no-cache")
    assert "\n0 cases" in lmap("cache").out


@pytest.mark.parametrize("command", [[], ["cache"], ["check"], ["list"], ["run"], ["channels"], ["sweep"]])
def test_every_help_shows_an_example(lmap: Callable[..., Ran], command: list[str]) -> None:
    ran = lmap(*command, "--help")
    assert ran.code == 0
    assert f"Example: lmap {' '.join(command)}".rstrip() in ran.out


def test_help_answers_at_once() -> None:
    """It imports nothing that takes long (scipy.signal alone takes over a second)."""
    code = (
        "import sys; sys.argv = ['lmap', '--help']; from lmap.cli.app import main\n"
        "try: main()\nexcept SystemExit: pass\n"
        "print(*{name.partition('.')[0] for name in sys.modules}, file=sys.stderr)"
    )
    ran = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert "Usage" in ran.stdout
    slow = {"scipy", "plotly", "polars", "numpy", "pydantic", "jinja2"}
    assert not slow & set(ran.stderr.split())


def test_a_check_that_passes_leaves_with_0_and_prints_a_table(lmap: Callable[..., Ran]) -> None:
    ran = lmap("check", "sway")
    assert ran.code == 0
    assert "lateral acceleration" in ran.out
    assert "running 2 cases" in ran.err
    assert "running" not in ran.out


def test_a_check_that_fails_leaves_with_1(lmap: Callable[..., Ran]) -> None:
    assert lmap("check", "sway", "--set", "yaw_damper.cx=0").code == 1


def test_a_check_that_cannot_be_judged_leaves_with_2(lmap: Callable[..., Ran]) -> None:
    assert lmap("check", "sway", "--set", "run.test=diverge").code == 2


def test_quiet_says_nothing_on_stderr(lmap: Callable[..., Ran]) -> None:
    assert lmap("check", "sway", "--quiet").err == ""


def test_json_is_one_object_and_nothing_else(lmap: Callable[..., Ran]) -> None:
    ran = lmap("check", "sway", "--json")
    document = json.loads(ran.out)
    assert ran.code == 0
    assert {"version", "specs"} <= set(document)
    [spec] = document["specs"]
    assert {"id", "title", "file", "verdict", "criteria"} <= set(spec)
    keys = {"name", "case", "value", "unit", "limit", "margin", "verdict", "source", "published"}
    assert all(keys <= set(criterion) for criterion in spec["criteria"])
    assert len(spec["criteria"]) == 6


def test_one_and_two_threads_and_two_runs_give_the_same_json(lmap: Callable[..., Ran]) -> None:
    runs = [lmap("check", "sway", "--json", "--jobs", jobs).out for jobs in ("1", "2", "2")]
    assert runs[0] == runs[1] == runs[2]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["check", "gone.toml"], "lmap: gone.toml: found no such file; allowed: a spec file or folder\n"),
        (
            ["check", "sway", "--set", "run.speed_kmh=0"],
            "lmap: specs/sway.toml: --set run.speed_kmh: found 0; allowed: a number > 0 (km/h)",
        ),
        (
            ["check", "sway", "--set", "nonsense"],
            'lmap: --set: found "nonsense"; allowed: KEY=VALUE, e.g. secondary.kz=5e5\n',
        ),
        (["run", "gone.json"], "lmap: gone.json: found no such file; allowed: a case file\n"),
        (
            ["channels", "tyo"],
            'lmap: found "tyo"; allowed: a vehicle that ships (',
        ),
    ],
)
def test_bad_input_leaves_with_2_one_message_and_no_file(
    lmap: Callable[..., Ran], toy: Path, arguments: list[str], message: str
) -> None:
    before = sorted(toy.rglob("*"))
    extra = ["--report", "out"] if arguments[0] == "check" else []
    ran = lmap(*arguments, *extra)
    assert (ran.code, ran.out) == (2, "")
    assert ran.err.startswith(message)
    assert ran.err.count("\n") == 1
    assert sorted(toy.rglob("*")) == before


@pytest.mark.parametrize(
    ("output", "fault"),
    [
        ("models", "a folder"),
        ("specs/sway.toml/run.parquet", "below the file sway.toml"),
        ("case.json", "the case itself"),
        ("models/../case.json", "the case itself"),
    ],
)
def test_an_output_that_cannot_be_written_is_refused_before_the_run(
    lmap: Callable[..., Ran], toy: Path, output: str, fault: str
) -> None:
    case = prepare.prepare(toy / "specs" / "sway.toml").cases[0]
    Path("case.json").write_text(case.json, encoding="utf-8")
    before = sorted(toy.rglob("*"))
    ran = lmap("run", "case.json", "--output", output)
    assert (ran.code, ran.out) == (2, "")
    assert ran.err == f"lmap: --output: found {output}, {fault}; allowed: a file to write\n"
    assert sorted(toy.rglob("*")) == before
    assert Path("case.json").read_text(encoding="utf-8") == case.json


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('{"run": {"speed": NaN}}', "lmap: case.json: run.speed: found nan; allowed: a finite number\n"),
        ("[" * 100_000, "lmap: case.json: found tables or lists too deep in each other; allowed: a case\n"),
        ("{\n,", "lmap: case.json:2: found no JSON: "),
        ("3", "lmap: case.json: found no table but int; allowed: a case\n"),
    ],
    ids=["nan", "deep", "syntax", "number"],
)
def test_a_case_file_that_is_none_is_refused(lmap: Callable[..., Ran], text: str, message: str) -> None:
    Path("case.json").write_text(text, encoding="utf-8")
    ran = lmap("run", "case.json")
    assert (ran.code, ran.out) == (2, "")
    assert ran.err.startswith(message)
    assert ran.err.count("\n") == 1


@pytest.mark.parametrize(
    "arguments", [["check"], ["check", "sway", "--jobs", "0"], ["chekc"], ["check", "--nope"]]
)
def test_wrong_usage_leaves_with_2(lmap: Callable[..., Ran], arguments: list[str]) -> None:
    ran = lmap(*arguments)
    assert (ran.code, ran.out) == (2, "")
    assert "Error" in ran.err


def test_list_shows_tests_and_criteria(lmap: Callable[..., Ran]) -> None:
    ran = lmap("list")
    assert ran.code == 0
    assert "9.1" in ran.out
    head, *lines = ran.out.splitlines()
    assert head.split() == ["id", "name", "procedure", "title"]
    # names are whole, whatever the width: they are what one types
    place = next(number for number, line in enumerate(lines) if line.split()[:2] == ["9.1", "sway"])
    assert "    lateral acceleration: |x| < 0.35 g" in lines[place + 1 : place + 4]


def test_channels_have_unit_and_meaning(lmap: Callable[..., Ran]) -> None:
    assert "carbody.lead_pivot.ay" in lmap("channels", "toy").out
    listed = json.loads(lmap("channels", "toy", "--json").out)
    assert {"name": "t", "unit": "s", "meaning": "time"} in listed


def test_a_report_is_written_whole_and_leaves_what_was_there(lmap: Callable[..., Ran], toy: Path) -> None:
    (toy / "out").mkdir()
    (toy / "out" / "notes.txt").write_text("mine", encoding="utf-8")
    assert lmap("check", "sway", "--report", "out").code == 0
    made = {path.name for path in (toy / "out").iterdir()}
    assert {"index.html", "verdicts.json", "junit.xml", "cases", "notes.txt"} <= made
    assert [path.name for path in toy.iterdir() if path.name.startswith(".")] == []


def test_a_case_of_a_report_runs_again_to_the_same_frame(lmap: Callable[..., Ran], toy: Path) -> None:
    assert lmap("check", "sway", "--report", "out").code == 0
    case = next((toy / "out" / "cases").glob("*.json"))
    assert lmap("run", str(case), "--output", "again.parquet").code == 0
    assert pl.read_parquet("again.parquet").equals(pl.read_parquet(case.with_suffix(".parquet")))
    assert Path("again.parquet").read_bytes() == case.with_suffix(".parquet").read_bytes()
    metadata = pl.read_parquet_metadata("again.parquet")
    assert metadata["lmap.case"] == case.stem
    assert json.loads(metadata["lmap.channels"])[0] == {"name": "t", "unit": "s", "meaning": "time"}


def test_a_report_that_is_a_file_is_refused_before_anything_runs(lmap: Callable[..., Ran], toy: Path) -> None:
    (toy / "out").write_text("", encoding="utf-8")
    ran = lmap("check", "sway", "--report", "out")
    assert ran.code == 2
    assert ran.err == "lmap: --report: found out, a file; allowed: a folder\n"


def test_a_report_is_written_in_a_folder_whose_parent_is_not_ours(
    lmap: Callable[..., Ran], toy: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (toy / "above" / "out").mkdir(parents=True)
    access, mkdtemp = os.access, tempfile.mkdtemp
    inside: list[Path] = []

    def made(*, dir: Path, **more: str) -> str:  # noqa: A002 -- tempfile's name
        inside.append(Path(dir).resolve())
        return mkdtemp(dir=dir, **more)

    monkeypatch.setattr(os, "access", lambda path, mode: Path(path).name != "above" and access(path, mode))
    monkeypatch.setattr(tempfile, "mkdtemp", made)
    assert lmap("check", "sway", "--report", "above/out").code == 0
    assert inside == [(toy / "above" / "out").resolve()]
    assert [path.name for path in (toy / "above" / "out").glob(".*")] == []
    assert lmap("check", "sway", "--report", "above/other").code == 2


def test_a_report_goes_into_folders_that_are_not_there_yet(lmap: Callable[..., Ran], toy: Path) -> None:
    assert lmap("check", "sway", "--report", "a/b/out").code == 0
    assert (toy / "a" / "b" / "out" / "index.html").is_file()


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_a_report_that_cannot_be_written_leaves_the_table_and_no_folder(
    lmap: Callable[..., Ran], toy: Path, monkeypatch: pytest.MonkeyPatch, error: BaseException
) -> None:
    def full(_: object, folder: Path) -> None:
        (folder / "cases").mkdir()
        (folder / "cases" / "a.json").write_text("{}", encoding="utf-8")
        raise error

    monkeypatch.setattr("lmap.report.write_report", full)
    before = sorted(toy.rglob("*"))
    ran = lmap("check", "sway", "--report", "a/out")
    assert "lateral acceleration" in ran.out
    assert sorted(toy.rglob("*")) == before
    last = ran.err.splitlines()[-1]
    if isinstance(error, KeyboardInterrupt):
        assert (ran.code, last) == (130, "lmap: stopped")
    else:
        assert ran.code == 2
        assert last == "lmap: the report cannot be written to a/out: No space left on device"


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
@pytest.mark.parametrize("arguments", [["check", "sway", "-q"], ["check", "sway", "-q", "--json"], ["list"]])
def test_a_full_disk_behind_stdout_is_one_message(toy: Path, arguments: list[str]) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, str(FAKE), *arguments],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            env=environment(),
            check=False,
        )
    assert (done.returncode, done.stderr) == (2, "lmap: stdout: No space left on device\n")


@pytest.mark.slow
@pytest.mark.parametrize("place", [".", "sub", "../beside"])
def test_reports_of_two_clones_hold_the_same_paths_and_none_of_the_machine(
    lmap: Callable[..., Ran], toy: Path, monkeypatch: pytest.MonkeyPatch, place: str
) -> None:
    """The same check from the same place in each; a clone's own names appear nowhere."""
    reports = []
    for clone in ("first clone", "second clone"):
        root = toy.parent / clone / "root"
        shutil.copytree(toy, root)
        here = root / place
        here.mkdir(exist_ok=True)
        monkeypatch.chdir(here)
        spec = Path(os.path.relpath(root / "specs" / "sway.toml", here.resolve())).as_posix()
        vehicle = root / "models" / "vehicles" / "toy.toml"
        assert lmap("check", spec, "--report", "set", "--quiet", "--set", f"vehicle={vehicle}").code == 0
        for given, out in ((spec, "relative"), (str(root / "specs" / "sway.toml"), "absolute")):
            assert lmap("check", given, "--report", out, "--quiet").code == 0
            assert lmap("sweep", given, "--vary", "run.speed_kmh=90,no", "-o", f"{out} sweep", "-q").code == 2
        assert (
            json.loads(Path("relative/verdicts.json").read_text(encoding="utf-8"))["specs"][0]["file"] == spec
        )
        written = contents(Path())
        assert {"relative/index.html", "absolute/junit.xml", "absolute sweep/sweep.parquet"} < written.keys()
        for name, content in written.items():
            for word in (clone, str(toy.parent)):
                assert word.encode() not in content, (name, word)
        # the page has times of the clock in it
        reports.append({name: content for name, content in written.items() if not name.endswith(".html")})
    assert reports[0] == reports[1]
    assert reports[0]["relative/verdicts.json"] == reports[0]["absolute/verdicts.json"]


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT between processes")
def test_ctrl_c_stops_long_before_the_end_and_leaves_nothing(toy: Path) -> None:
    command = [sys.executable, str(FAKE), "--slow", "60", "check", "sway", "--report", "out"]
    before = sorted(toy.rglob("*"))
    assert stopped_by_ctrl_c(toy, command) == STOPPED
    assert sorted(toy.rglob("*")) == before


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
def test_a_check_that_was_killed_goes_on_where_it_was(toy: Path) -> None:
    def command(slow: str) -> list[str]:
        return [sys.executable, str(FAKE), "--slow", slow, "check", "sway"]

    # the stand-in runs one case after the other: the first is done after 2 s, the second would be after 4
    with subprocess.Popen(
        command("2"), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment()
    ) as process:
        assert process.stderr is not None
        for line in process.stderr:
            if ": done" in line:
                process.kill()
                break
    again = subprocess.run(command("0"), capture_output=True, text=True, env=environment(), check=False)
    assert again.returncode == 0
    assert again.stderr.startswith("running 1 case on 1 thread, 1 known from before\n")
    third = subprocess.run(command("60"), capture_output=True, text=True, env=environment(), check=False)
    assert (third.returncode, third.stdout, third.stderr) == (0, again.stdout, "")


def test_a_fault_of_ours_does_not_look_like_a_criterion_that_fails(
    lmap: Callable[..., Ran], monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: object, **__: object) -> None:
        raise RuntimeError("our fault")

    monkeypatch.setattr(sys.modules["lmap.prepare"], "prepare", broken)
    ran = lmap("check", "sway")
    assert ran.code == 2
    assert "our fault" in ran.err
