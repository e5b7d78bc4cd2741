"""Control laws of the user's."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from lmap import controller
from lmap.analyse import vehicle_case
from lmap.errors import InputProblem
from lmap.spec.case import Case
from lmap.vehicle import Vehicle


def short(**drive: Any) -> Case:
    vehicle = Vehicle.load("coco134")
    run = {
        "kind": "time",
        "speed": 10.0,
        "creep": {"kind": "polach", "k_a": 0.6, "k_s": 0.15},
        "integrator": {"kind": "ros2", "step": 0.001},
        "output_step": 0.01,
        "drive": {"resistance": False, "until": {"time": 0.2}, **drive},
    }
    return vehicle_case(vehicle.data, vehicle.document.path, run, label="short")


@pytest.mark.parametrize("name", ["", "nothing", "no_such_module_at_all:f", "math:no_such", "math:pi"])
def test_a_name_that_is_no_function_is_one_message(name: str) -> None:
    with pytest.raises(InputProblem, match="controller"):
        controller.named(name)


@pytest.mark.needs_core
def test_a_law_sees_its_channels_and_its_torque_arrives() -> None:
    seen: list[tuple[float, dict[str, float]]] = []

    def law(t: float, channels: dict[str, float]) -> dict[str, list[float]]:
        seen.append((t, channels))
        return {"torque": [1000.0 * w for w in range(6)]}

    frame = controller.simulate(short(period=0.02), law, channels=["v", "ws1.slip"])
    assert [round(t, 9) for t, _ in seen] == [round(0.02 * k, 9) for k in range(11)]
    assert set(seen[0][1]) == {"v", "ws1.slip"}
    assert seen[0][1]["v"] == pytest.approx(10.0, abs=1e-3)
    # First-order lag of 0.05 s: 98 % after 0.2 s.
    for w in range(6):
        assert frame[f"ws{w + 1}.torque"][-1] == pytest.approx(1000.0 * w * (1.0 - math.exp(-4.0)), rel=1e-6)


@pytest.mark.needs_core
@pytest.mark.parametrize(
    ("answer", "message"),
    [
        ({"torque": [math.nan] * 6}, "NaN"),
        ({"torque": [0.0] * 5}, "5 torques for 6 wheelsets"),
        ({"independent_brake": -1.0}, "independent_brake = -1 Pa"),
        ({"ws9.torque": 1.0}, "`ws9.torque`"),
        ([0.0] * 6, "an answer of type list"),
        ({"notch": 8}, "`notch`"),
        ({"bogie1.torque": 1.0, "ws1.torque": 2.0}, "ws1.torque and bogie1.torque at once"),
        ({"torque": 1.0, "ws2.torque": 2.0}, "torque and ws2.torque, both of which set ws2.torque"),
        ({"torque": "full"}, "neither a number nor numbers"),
        ({"torque": "123456"}, "neither a number nor numbers"),
        ({"torque": 10**400}, "neither a number nor numbers"),
    ],
)
def test_a_bad_answer_is_one_message_that_names_the_law(answer: Any, message: str) -> None:
    def my_law(t: float, channels: dict[str, float]) -> Any:
        return answer

    with pytest.raises(InputProblem, match=f"(?s)my_law.*({message})"):
        controller.simulate(short(), my_law, channels=[])


@pytest.mark.needs_core
def test_a_law_that_raises_is_one_message_that_names_it() -> None:
    def my_law(t: float, channels: dict[str, float]) -> Any:
        raise RuntimeError("no torque today")

    with pytest.raises(InputProblem, match=r"my_law.*no torque today"):
        controller.simulate(short(), my_law, channels=[])


@pytest.mark.needs_core
@pytest.mark.parametrize("answer", [None, {}])
def test_a_law_that_never_sets_anything_is_one_message(answer: Any) -> None:
    """A forgotten `return`: the vehicle's own controllers would have driven."""

    def my_law(t: float, channels: dict[str, float]) -> Any:
        return answer

    with pytest.raises(
        InputProblem, match=r"my_law, which set nothing in the whole run; allowed: .*return"
    ) as one:
        controller.simulate(short(), my_law)
    assert len(one.value.problems) == 1


@pytest.mark.needs_core
def test_a_law_may_act_late_and_only_once() -> None:
    def law(t: float, channels: dict[str, float]) -> dict[str, float] | None:
        return {"ws1.torque": 1000.0} if abs(t - 0.15) < 1e-6 else None

    assert controller.simulate(short(), law).height == 21


@pytest.mark.needs_core
def test_a_law_sets_what_it_likes_by_name() -> None:
    def law(t: float, channels: dict[str, float]) -> dict[str, float]:
        return {"ws1.torque": 1000.0, "bogie2.torque": 2000.0}

    frame = controller.simulate(short(notch=8, effort_limit=30e3), law)
    lagged = 1.0 - math.exp(-4.0)
    for w, torque in ((1, 1000.0), (4, 2000.0), (5, 2000.0), (6, 2000.0)):
        assert frame[f"ws{w}.torque"][-1] == pytest.approx(torque * lagged, rel=1e-6)
    # The rest stays with the vehicle's own controllers: 5 kN at a rim of 0.5335 m.
    assert frame["ws2.torque"][-1] == pytest.approx(5e3 * 0.5335 * lagged, rel=1e-3)


@pytest.mark.needs_core
def test_a_case_names_its_law_and_a_function_its_parameters(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = "def all_alike(t, seen, torque):\n    return {'torque': torque * (1.0 if 'v' in seen else 0.0)}\n"
    (tmp_path / "laws.py").write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    case = short()
    case.data["run"]["controller"] = {"law": "laws:all_alike", "parameters": {"torque": 500.0}}
    frame = controller.simulate(case)
    assert frame["ws5.torque"][-1] == pytest.approx(500.0 * (1.0 - math.exp(-4.0)), rel=1e-6)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["laws.py"]


@pytest.mark.needs_core
@pytest.mark.parametrize(
    ("change", "found"), [({"drive": None}, r"without \[run.drive\]"), ({"kind": "modal"}, "of kind modal")]
)
def test_a_law_needs_a_driven_run_in_time(change: dict[str, Any], found: str) -> None:
    run = {**short().data["run"], "controller": "math:cos", **change}
    case = Case(
        "still", {**short().data, "run": {key: value for key, value in run.items() if value is not None}}
    )
    with pytest.raises(InputProblem, match=f"run.controller: found .*{found}"):
        controller.simulate(case)


@pytest.mark.needs_core
def test_a_channel_that_is_none_is_refused() -> None:
    with pytest.raises(InputProblem, match="ws9"):
        controller.simulate(short(), lambda t, seen: None, channels=["ws9.slip"])
