"""Results on disk: what is found again, what is made again."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import lmap
from lmap.check import open_store
from lmap.execute.store import LostFrame, Store, StoredFrame, clear, default_folder, limit_bytes, usage
from lmap.report.document import to_json
from lmap.verdict import Acceptance

pytestmark = pytest.mark.usefixtures("toy")


@pytest.fixture
def ran(fake_core: ModuleType, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Labels of the cases that the core was given, in their order."""
    labels: list[str] = []
    really = fake_core.run_cases

    def counted(cases: Iterable[str], *others: Any) -> None:
        texts = list(cases)
        labels.extend(json.loads(case)["label"] for case in texts)
        really(texts, *others)

    monkeypatch.setattr(fake_core, "run_cases", counted)
    return labels


def stored(suffix: str) -> list[Path]:
    return sorted(default_folder().rglob(f"*{suffix}"))


def test_a_second_check_runs_nothing_and_says_the_same(ran: list[str]) -> None:
    first = lmap.check("sway")
    assert sorted(ran) == ["round", "worn"]
    ran.clear()
    second = lmap.check("sway")
    assert ran == []
    assert to_json(second) == to_json(first)
    assert [spec.criteria for spec in second.specs] == [spec.criteria for spec in first.specs]
    for one, other in zip(first.specs[0].cases, second.specs[0].cases, strict=True):
        assert other.frame.equals(one.frame)
        assert (other.extent, other.wall_s, other.ended) == (one.extent, one.wall_s, one.ended)


def test_what_is_judged_as_it_ends_is_judged_alike_from_disk(ran: list[str]) -> None:
    from_memory = lmap.check("sway")
    for note in stored(".note"):
        note.unlink()
    ran.clear()
    from_disk = lmap.check("sway")
    assert ran == []
    assert to_json(from_disk) == to_json(from_memory)


def test_a_frame_that_is_held_is_not_read_back() -> None:
    source = lmap.check("sway").specs[0].cases[0]
    outcome = open_store(cache=True).outcome(source.hash)
    assert outcome is not None
    frame = outcome.source
    assert isinstance(frame, StoredFrame)
    known = frame.read()
    frame.path.unlink()
    with frame.store.holding(source.hash, known):
        assert frame.read() is known
    with pytest.raises(LostFrame):
        frame.read()


def test_only_what_changed_runs_again(ran: list[str]) -> None:
    lmap.check("sway")
    ran.clear()
    both = lmap.check("sway", set={"run.wheel_profile": ["round", "flat"]})
    assert ran == ["flat"]
    assert [case.label for case in both.specs[0].cases] == ["round", "flat"]
    ran.clear()
    lmap.check("sway", set={"yaw_damper.cx": 0})
    assert sorted(ran) == ["round", "worn"]


def test_another_limit_is_judged_without_running(ran: list[str]) -> None:
    assert lmap.check("sway").exit_code == 0
    ran.clear()
    path = Path("specs/sway.toml")
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("max_abs = 0.35", "max_abs = 0.001"), encoding="utf-8")
    assert text != path.read_text(encoding="utf-8")
    assert lmap.check("sway").exit_code == 1
    assert ran == []


def test_results_of_another_core_are_not_taken(
    fake_core: ModuleType, ran: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    lmap.check("sway")
    monkeypatch.setattr(fake_core, "fingerprint", lambda: "another")
    lmap.check("sway")
    assert len(ran) == 4


def test_without_the_cache_everything_runs_and_nothing_is_left(ran: list[str]) -> None:
    first = lmap.check("sway", cache=False)
    second = lmap.check("sway", cache=False)
    assert len(ran) == 4
    assert to_json(second) == to_json(first)
    assert second.specs[0].cases[0].frame.height > 0
    assert stored("") == []


def test_a_folder_that_cannot_be_written_is_no_obstacle(ran: list[str], tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("no folder", encoding="utf-8")
    acceptance = lmap.check("sway", cache=blocked)
    assert acceptance.exit_code == 0
    assert acceptance.specs[0].cases[0].frame.height > 0
    lmap.check("sway", cache=blocked)
    assert len(ran) == 4


def shortened(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-20])


def emptied(path: Path) -> None:
    path.write_bytes(b"")


def one_bit(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def removed(path: Path) -> None:
    path.unlink()


@pytest.mark.parametrize("harm", [shortened, emptied, one_bit, removed])
@pytest.mark.parametrize("suffix", [".parquet", ".json", ".note"])
def test_what_is_harmed_is_made_again(suffix: str, harm: Callable[[Path], None]) -> None:
    first = lmap.check("sway")
    paths = stored(suffix)
    whole = [path.read_bytes() for path in stored(".parquet")]
    assert paths
    for path in paths:
        harm(path)
    if suffix == ".parquet":  # so that frames are read again
        for note in stored(".note"):
            note.unlink()
    second = lmap.check("sway")
    assert to_json(second) == to_json(first)
    assert second.specs[0].cases[0].frame.equals(first.specs[0].cases[0].frame)
    assert [path.read_bytes() for path in stored(".parquet")] == whole


def test_a_frame_that_is_gone_when_somebody_asks_for_it_is_an_error_that_says_so() -> None:
    acceptance = lmap.check("sway")
    for path in stored(".parquet"):
        one_bit(path)
    with pytest.raises(LostFrame, match="cannot be read any more: run the check again"):
        _ = acceptance.specs[0].cases[0].frame


def test_runs_that_fail_are_told_again_and_those_that_diverge_are_kept(ran: list[str]) -> None:
    for trouble, runs in (("raise", 4), ("diverge", 2)):
        ran.clear()
        first, second = (lmap.check("sway", set={"run.test": trouble}) for _ in range(2))
        assert len(ran) == runs
        assert to_json(second) == to_json(first)
        assert first.exit_code == 2


def test_room_is_made_by_what_was_asked_for_least_recently(monkeypatch: pytest.MonkeyPatch) -> None:
    lmap.check("sway")
    lmap.check("sway", set={"run.wheel_profile": "flat"})
    frames = stored(".parquet")
    size = sum(path.stat().st_size for path in stored("") if path.is_file())
    now = time.time()
    for path in stored(""):
        if path.is_file():
            os.utime(path, (now - 100.0, now - 100.0))
    kept = frames[1]
    os.utime(kept, (now, now))
    left_over = kept.with_name(".x.1.tmp")
    left_over.write_bytes(b"x")
    os.utime(left_over, (now - 1e5, now - 1e5))
    monkeypatch.setenv("LMAP_CACHE_GB", str(0.9 * size / 1e9))
    assert limit_bytes() == pytest.approx(0.9 * size)
    Store(default_folder(), "x").make_room()
    after = stored(".parquet")
    assert kept in after
    assert len(after) < len(frames)
    assert not left_over.exists()


def test_clear_removes_results_and_nothing_else() -> None:
    lmap.check("sway")
    mine = default_folder() / "mine.txt"
    mine.write_text("mine", encoding="utf-8")
    found = usage(default_folder())
    assert (found.cases, found.cores) == (2, 1)
    assert clear(default_folder()) == found
    assert list(default_folder().iterdir()) == [mine]
    assert usage(default_folder()).size == 0


@pytest.mark.skipif(sys.platform != "linux", reason="platformdirs has other variables elsewhere")
@pytest.mark.parametrize(
    ("variables", "folder"),
    [
        ({"XDG_CACHE_HOME": "/x"}, "/x/lmap"),
        ({"HOME": "/h"}, "/h/.cache/lmap"),
        ({"LMAP_CACHE_DIR": "/mine", "XDG_CACHE_HOME": "/x"}, "/mine"),
    ],
)
def test_the_folder_is_the_users_cache(
    variables: dict[str, str], folder: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("LMAP_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert default_folder() == Path(folder)


def test_frames_are_read_once_for_all_that_is_plotted_of_a_case(monkeypatch: pytest.MonkeyPatch) -> None:
    from lmap.execute.store import StoredFrame

    acceptance: Acceptance = lmap.check("sway")
    reads = []
    really = StoredFrame.read
    monkeypatch.setattr(StoredFrame, "read", lambda self: reads.append(self.case_hash) or really(self))
    held = acceptance.specs[0].held()
    for case in held.cases:  # judged as they are: one is in memory at a time
        for _ in range(3):
            assert case.frame.height == case.extent.rows
            assert case.quantities.height
    assert sorted(reads) == sorted(case.hash for case in held.cases)
    assert held.held().cases == held.cases
