"""Many short variants of one spec on the real core: the same bytes on one thread and on two, shared tables or none."""

from __future__ import annotations

from pathlib import Path

import pytest

from lmap.check import judge_all, open_store
from lmap.execute.store import Store
from lmap.prepare import prepare

pytestmark = pytest.mark.needs_core
SPEC = Path(__file__).parents[2] / "specs" / "hunting.toml"


def frames(store: Store, jobs: int, speeds: list[float]) -> dict[str, bytes]:
    """Files of frames by case, of a batch that shares its contact tables."""
    settings = {
        "run.integrator.step": 0.0005,
        "track.length": 30.0,
        "track.irregularity.period": 20.0,
        "track.fade_in": 5.0,
    }
    specs = [prepare(SPEC, {**settings, "run.speed_kmh": speed}) for speed in speeds]
    judge_all(specs, store, jobs=jobs)
    return {path.stem: path.read_bytes() for path in sorted(store.folder.glob("*.parquet"))}


@pytest.mark.slow
def test_one_and_two_threads_together_and_alone_give_the_same_bytes() -> None:
    speeds = [100.0, 110.0, 120.0]
    one, two, first = open_store(cache=False), open_store(cache=False), open_store(cache=False)
    together = frames(one, 1, speeds)
    assert len(together) == 6
    assert frames(two, 2, speeds[::-1]) == together
    alone = frames(first, 1, speeds[:1])
    assert len(alone) == 2
    assert alone.items() <= together.items()
