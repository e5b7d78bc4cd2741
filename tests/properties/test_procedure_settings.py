"""No number in `[test]` of a spec gives anything but a spec that is prepared or messages."""

from __future__ import annotations

import contextlib
import copy
import math
from pathlib import Path
from typing import Any

import pytest
from damage import places
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lmap import procedures, toml
from lmap.errors import InputProblem
from lmap.prepare import prepare
from lmap.procedures.base import Set
from lmap.spec import overrides

pytestmark = [pytest.mark.needs_core, pytest.mark.slow]
ROOT = Path(__file__).parents[2]
ALL = {path.stem: toml.load(path, "spec").data for path in sorted((ROOT / "specs").glob("*.toml"))}
NUMBERED = {name: data for name, data in ALL.items() if data.get("test")}
# One of each procedure, and of those whose settings ask for different things.
SPECS = sorted(
    {
        *{data["procedure"]: name for name, data in NUMBERED.items()}.values(),
        "sway_rig",
        "sway_curve",
        "coupler_forces",
        "vertical_hump",
    }
)
NUMBERS = st.one_of(
    st.sampled_from([0.0, -1.0, 1e-300, 1e-9, 5.0, 300.0, 1600.0, 1e9, 1e300, -1e300]),
    st.sampled_from([math.inf, -math.inf, math.nan, 0, 1, -1, 10**6, 2**53]),
    st.floats(allow_nan=False, allow_infinity=False),
    st.floats(0.0, 1e4),
)


def test_every_procedure_with_settings_is_among_them() -> None:
    found = {ALL[name]["procedure"] for name in SPECS}
    assert found >= {one.NAME for one in procedures.PROCEDURES if isinstance(one, Set)}


@pytest.mark.parametrize("name", SPECS)
@settings(
    max_examples=25,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(data=st.data())
def test_any_number_is_prepared_or_refused(
    name: str, data: st.DataObject, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    test = ALL[name]["test"]
    numbers = [place for place in places(test) if _is_number(_at(test, place))]
    spoiled = copy.deepcopy(test)
    for _ in range(data.draw(st.integers(1, 2))):
        *path, last = data.draw(st.sampled_from(numbers))
        _at(spoiled, tuple(path))[last] = data.draw(NUMBERS)
    changed = {f"test.{key}": value for key, value in spoiled.items() if repr(value) != repr(test[key])}
    with contextlib.suppress(InputProblem):
        prepare(ROOT / "specs" / f"{name}.toml", overrides.checked(changed))


def _at(node: Any, place: tuple[str | int, ...]) -> Any:
    for key in place:
        node = node[key]
    return node


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
