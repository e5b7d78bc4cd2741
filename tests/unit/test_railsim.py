"""The binding: text in and out, Arrow frames, and the door through which long work goes."""

import json
import signal
import subprocess
import sys
import textwrap
import time
from collections.abc import Iterator
from pathlib import Path

import polars as pl
import pytest

from lmap import _railsim
from lmap.prepare import prepare

pytestmark = pytest.mark.timeout(60)


def run_probes(*deeds: str, jobs: int = 2) -> list[_railsim.Frame | _railsim.RailsimError | None]:
    """The result of each deed, in its place."""
    results: list[_railsim.Frame | _railsim.RailsimError | None] = [None] * len(deeds)
    _railsim._run_probes(list(deeds), jobs, lambda *_: None, results.__setitem__)
    return results


def test_version_is_that_of_the_package() -> None:
    from importlib.metadata import version

    assert _railsim.version() == version("lmap")


def test_fingerprint_is_a_sha256() -> None:
    assert len(_railsim.fingerprint()) == 64
    int(_railsim.fingerprint(), 16)


# TOML

DOCUMENT = """\
title = "x"

[track]
length = 3000.0
irregularity = { kind = "psd", wavelengths = [
    1.5,
    40.0,
] }
layout.cant = -0.0

[[criterion]]
name = "a"

[[criterion]]
name = "b"
chain = [{ lowpass = { cutoff_hz = 10 } }]

[vehicle.body]
mass = 1e3
"""


def test_toml_becomes_json() -> None:
    data = json.loads(_railsim.toml_to_json(DOCUMENT))
    assert data["track"]["irregularity"] == {"kind": "psd", "wavelengths": [1.5, 40.0]}
    assert data["track"]["layout"] == {"cant": 0.0}
    assert [c["name"] for c in data["criterion"]] == ["a", "b"]
    cutoff = data["criterion"][1]["chain"][0]["lowpass"]["cutoff_hz"]
    assert cutoff == 10
    assert isinstance(cutoff, int)
    assert isinstance(data["vehicle"]["body"]["mass"], float)


def test_toml_floats_keep_every_bit() -> None:
    numbers = [0.1, 1 / 3, 5e-324, 1.7976931348623157e308, 123456789.12345679, 2.5e-4]
    text = "x = [" + ", ".join(map(repr, numbers)) + "]"
    assert json.loads(_railsim.toml_to_json(text))["x"] == numbers


@pytest.mark.parametrize(
    ("key", "line"),
    [
        (["title"], 1),
        (["track"], 3),
        (["track", "length"], 4),
        (["track", "length", "deeper"], 4),
        (["track", "missing"], 3),
        (["track", "irregularity", "kind"], 5),
        (["track", "irregularity", "wavelengths", 1], 7),
        (["track", "irregularity", "wavelengths", 2], 5),
        (["track", "layout", "cant"], 9),
        (["criterion", 0, "name"], 12),
        (["criterion", 1], 14),
        (["criterion", 1, "name"], 15),
        (["criterion", 1, "chain", 0, "lowpass", "cutoff_hz"], 16),
        (["vehicle", "body", "mass"], 19),
        (["nowhere"], None),
        ([], None),
        ([0], None),
    ],
)
def test_toml_line_is_that_of_the_deepest_part_that_exists(key: list[str | int], line: int | None) -> None:
    assert _railsim.toml_line(DOCUMENT, key) == line


@pytest.mark.parametrize(
    ("text", "line"),
    [("a = 1\nb = = 2\n", 2), ("a = 1\na = 2\n", 2), ("[a\n", 1), ('x = "é\n', 1), ("é = 1\n", 1)],
)
def test_toml_syntax_error_names_its_line(text: str, line: int) -> None:
    with pytest.raises(_railsim.InputError, match=rf"^line {line}, column \d+: not TOML: ") as caught:
        _railsim.toml_to_json(text)
    (fault,) = caught.value.faults
    assert fault["line"] == line
    assert fault["key"] == []
    assert text.splitlines()[line - 1].strip() in fault["found"]


def test_toml_values_that_json_has_no_word_for_are_all_named() -> None:
    with pytest.raises(_railsim.InputError) as caught:
        _railsim.toml_to_json("[run]\nspeed = nan\nlist = [1.0, inf]\nday = 2026-01-01\n")
    faults = [(fault["path"], fault["line"], fault["found"]) for fault in caught.value.faults]
    assert faults == [
        ("run.speed", 2, "NaN"),
        ("run.list[1]", 3, "inf"),
        ("run.day", 4, "the date 2026-01-01"),
    ]
    assert len(str(caught.value).splitlines()) == 3


# Frames


def test_frame_becomes_a_polars_frame_with_the_same_bits() -> None:
    (frame,) = run_probes("rows")
    assert isinstance(frame, _railsim.Frame)
    table = pl.DataFrame(frame)
    assert table.columns == frame.names == ["t", "s", "carbody.y"]
    assert table.dtypes == [pl.Float64] * 3
    assert table.rows() == [(0.0, 0.0, 0.0), (0.25, 1.0, 1e-300), (0.5, 2.0, 0.1)]
    assert str(table["carbody.y"][0]) == "-0.0"
    assert frame.rows == 3
    assert "3 rows x 3 columns" in repr(frame)


def test_frame_is_handed_over_without_a_copy_and_outlives_its_handle() -> None:
    (frame,) = run_probes("rows")
    first, second = pl.DataFrame(frame), pl.DataFrame(frame)
    addresses = [
        table["t"].to_numpy(allow_copy=False).__array_interface__["data"][0] for table in (first, second)
    ]
    assert addresses[0] == addresses[1]
    del frame, second
    assert first["t"].to_list() == [0.0, 0.25, 0.5]


def test_frame_needs_no_pyarrow() -> None:
    code = """
        import sys
        sys.modules["pyarrow"] = None
        import polars
        from lmap import _railsim
        _railsim._run_probes(["rows"], 1, print, lambda _, frame: print(polars.DataFrame(frame).shape))
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, check=True, timeout=30
    )
    assert done.stdout == "(3, 3)\n"


def test_frame_says_how_its_run_ended() -> None:
    whole, broken = run_probes("rows", "diverge")
    assert isinstance(whole, _railsim.Frame)
    assert isinstance(broken, _railsim.Frame)
    assert whole.ended == {"kind": "end_of_track", "t": 0.5, "s": 2.0, "message": None}
    assert broken.ended["kind"] == "diverged"
    assert (broken.ended["t"], broken.ended["s"]) == (0.5, 2.0)
    assert broken.ended["message"] == "run ended at t = 0.5000 s, s = 2.00 m: ws1: wheel climb"
    assert whole.statistics == {"steps": 3}
    assert 0.0 <= whole.wall_s < 30.0


# The door


def test_a_panic_or_error_in_one_case_loses_no_other() -> None:
    rows, panic, refused, unknown, last = run_probes("rows", "panic", "refuse", "dance", "rows")
    assert isinstance(rows, _railsim.Frame)
    assert isinstance(last, _railsim.Frame)
    assert isinstance(panic, _railsim.InternalError)
    assert "a probe panicked" in str(panic)
    assert isinstance(refused, _railsim.DivergenceError)
    assert (refused.t, refused.s, refused.body, refused.cause) == (0.5, 2.0, "ws1", "wheel climb")
    assert isinstance(unknown, _railsim.InputError)
    assert unknown.faults[0]["key"] == ["probe", "deed"]
    assert unknown.faults[0]["found"] == "dance"


def test_every_exception_has_the_one_base() -> None:
    for name in ("InputError", "ConvergenceError", "DivergenceError", "Interrupted", "InternalError"):
        error = getattr(_railsim, name)
        assert issubclass(error, _railsim.RailsimError)
        assert error.__module__ == "lmap._railsim"
        assert error.__doc__


def test_no_cases_is_no_work() -> None:
    assert run_probes() == []


def test_no_jobs_is_refused() -> None:
    with pytest.raises(ValueError, match="zero"):
        run_probes("rows", jobs=0)


@pytest.mark.parametrize("callback", ["progress", "done"])
def test_an_exception_from_a_callback_stops_every_case_and_is_raised(callback: str) -> None:
    called: list[str] = []

    def fail(name: str) -> None:
        called.append(name)
        if name == callback:
            raise LookupError(name)

    deeds = ["endless", "endless"] if callback == "progress" else ["rows", "endless", "endless"]
    with pytest.raises(LookupError, match=callback):
        _railsim._run_probes(deeds, 2, lambda *_: fail("progress"), lambda *_: fail("done"))
    assert called.count(callback) == 1


def test_progress_comes_some_ten_times_a_second_and_grows() -> None:
    class Enough(Exception):
        pass

    distances: list[float] = []

    def on_progress(index: int, fraction: float, distance: float, factor: float) -> None:
        assert index == 0
        assert fraction == 0.5
        assert 0.0 < factor < 2.0
        distances.append(distance)
        if len(distances) == 5:
            raise Enough

    start = time.monotonic()
    with pytest.raises(Enough):
        _railsim._run_probes(["endless"], 1, on_progress, lambda *_: None)
    assert time.monotonic() - start > 0.3  # at most so often; how long it takes is the machine's affair
    assert distances == sorted(distances)


@pytest.mark.skipif(sys.platform == "win32", reason="signals to a process are sent otherwise there")
@pytest.mark.parametrize("jobs", [1, 2])
def test_ctrl_c_stops_what_has_no_end(jobs: int) -> None:
    code = f"""
        from lmap import _railsim
        try:
            _railsim._run_probes(["endless"] * 3, {jobs}, lambda *_: print("on", flush=True), print)
        except KeyboardInterrupt:
            print("interrupted", flush=True)
    """
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(code)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "on\n"
    process.send_signal(signal.SIGINT)
    rest, errors = process.communicate(timeout=10)
    assert rest.splitlines()[-1] == "interrupted"
    assert errors == ""
    assert process.returncode == 0


def test_other_threads_run_meanwhile() -> None:
    """The GIL is free while the workers work: a thread counts on."""
    import threading

    class Enough(Exception):
        pass

    counted = 0
    stop = threading.Event()

    def count() -> None:
        nonlocal counted
        while not stop.wait(0.001):
            counted += 1

    def on_progress(*_: float) -> None:
        if counted > 100:
            raise Enough

    thread = threading.Thread(target=count)
    thread.start()
    try:
        with pytest.raises(Enough):
            _railsim._run_probes(["endless"], 1, on_progress, lambda *_: None)
    finally:
        stop.set()
        thread.join()


# Cases of the real core

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def case() -> str:
    """The hunting test on new wheels and 60 m of track, as JSON."""
    settings = {"track.length": 60.0, "run.wheel_profile": "anzr1"}
    (case,) = prepare(ROOT / "specs/hunting.toml", settings).cases
    return case.json


def run_cases(*cases: str, jobs: int = 2) -> list[_railsim.Frame | _railsim.RailsimError | None]:
    results: list[_railsim.Frame | _railsim.RailsimError | None] = [None] * len(cases)
    _railsim.run_cases(list(cases), jobs, lambda *_: None, results.__setitem__)
    return results


def test_a_case_gives_the_channels_that_it_announces(case: str) -> None:
    _railsim.check_case(case)
    announced = _railsim.channels(case)
    (frame,) = run_cases(case)
    assert isinstance(frame, _railsim.Frame)
    assert frame.names == [name for name, _, _ in announced]
    assert all(unit and meaning for _, unit, meaning in announced)
    assert frame.ended["kind"] == "end_of_track"
    table = pl.DataFrame(frame)
    assert table.null_count().sum_horizontal().item() == 0
    assert table["t"].diff().drop_nulls().to_list() == pytest.approx([0.005] * (table.height - 1))
    assert frame.statistics["steps"] > 0


def test_any_number_of_threads_gives_the_same_bytes(case: str) -> None:
    def tables(jobs: int) -> list[bytes]:
        frames = run_cases(*[case] * 3, jobs=jobs)
        return [pl.DataFrame(frame).serialize() for frame in frames]

    one, many = tables(1), tables(3)
    assert one == many
    assert len(set(one)) == 1


def test_a_bad_case_among_good_ones_is_its_own_loss(case: str) -> None:
    data = json.loads(case)
    data["run"]["speed"] = 0.0
    data["track"]["length"] = "long"
    good, bad, not_json = run_cases(case, json.dumps(data), "{")
    assert isinstance(good, _railsim.Frame)
    assert isinstance(bad, _railsim.InputError)
    assert {fault["path"] for fault in bad.faults} == {"run.speed", "track.length"}
    assert isinstance(not_json, _railsim.InputError)
    with pytest.raises(_railsim.InputError) as caught:
        _railsim.check_case(json.dumps(data))
    assert caught.value.faults == bad.faults


def test_track_extremes_hold_what_a_run_meets(case: str) -> None:
    extremes = _railsim.track_extremes(case)
    assert set(extremes) == {"lateral", "vertical", "cross_level", "gauge"}
    assert all(low < 0.0 < high for low, high in extremes.values())


def test_equivalent_conicity_is_a_number_or_none(case: str) -> None:
    conicity = _railsim.equivalent_conicity(case, 0.003)
    assert conicity is not None
    assert 0.01 < conicity < 0.5
    assert _railsim.equivalent_conicity(case, 1.0) is None


def test_profile_points_keep_their_decimals() -> None:
    text = "# source\ny,z\n-46.1,3.3\n0,0\n12.123456,-0.000001\n"
    assert json.loads(_railsim.read_profile(text, "x")) == {
        "points": [[-46.1, 3.3], [0, 0], [12.123456, -1e-6]]
    }
    with pytest.raises(_railsim.InputError, match="no point"):
        _railsim.read_profile("# nothing", "x")


def test_vehicle_resolves_with_overrides(case: str) -> None:
    document = json.loads(case)["vehicle"]
    resolved = json.loads(_railsim.vehicle_resolve(json.dumps(document), "{}", "tare"))
    assert resolved["design_speed"] == pytest.approx(115.0 / 3.6)
    assert 120e3 < resolved["mass"] < 140e3
    assert "carbody" in resolved["bodies"]
    assert resolved["document"] == document
    with pytest.raises(_railsim.InputError) as caught:
        _railsim.vehicle_resolve(json.dumps(document), '{"no.such": 1.0}')
    assert caught.value.faults[0]["key"][0] == "set"


@pytest.mark.parametrize("broken", ["{", "[]", "1"])
def test_vehicle_that_is_no_object_is_bad_input(broken: str) -> None:
    with pytest.raises(_railsim.InputError):
        _railsim.vehicle_resolve(broken, "{}")
    with pytest.raises(_railsim.InputError):
        _railsim.vehicle_resolve("{}", broken)


def test_cases_are_taken_one_by_one_when_a_thread_is_free(case: str) -> None:
    made, ended = list[int](), list[int]()

    def make() -> Iterator[str]:
        for number in range(5):
            made.append(number)
            assert len(made) - len(ended) <= 2
            yield case

    _railsim.run_cases(make(), 2, lambda *_: None, lambda index, _: ended.append(index))
    assert sorted(ended) == made == [0, 1, 2, 3, 4]


def test_an_error_while_a_case_is_made_stops_every_run_and_is_raised_again(case: str) -> None:
    data = json.loads(case)
    data["track"]["length"] = 1e6

    def make() -> Iterator[str]:
        yield json.dumps(data)
        raise LookupError("no second one")

    with pytest.raises(LookupError, match="no second one"):
        _railsim.run_cases(make(), 2, lambda *_: None, lambda *_: None)


@pytest.mark.skipif(sys.platform == "win32", reason="signals to a process are sent otherwise there")
def test_ctrl_c_stops_a_real_run_within_a_second(case: str, tmp_path: Path) -> None:
    data = json.loads(case)
    data["track"]["length"] = 1e6
    (tmp_path / "case.json").write_text(json.dumps(data))
    code = """
        from pathlib import Path
        from lmap import _railsim
        try:
            cases = [Path("case.json").read_text()] * 2
            _railsim.run_cases(cases, 2, lambda *_: print("on", flush=True), print)
        except KeyboardInterrupt:
            print("interrupted", flush=True)
    """
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(code)], cwd=tmp_path, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "on\n"
    process.send_signal(signal.SIGINT)
    rest, _ = process.communicate(timeout=10)
    assert rest.splitlines()[-1] == "interrupted"
