"""Critical speed of the reference locomotive beside the paper's 135 km/h, and what the reading hangs on."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import lmap
from lmap.analyse import vehicle_case
from lmap.execute.local import run_cases
from lmap.spec.case import Case

pytestmark = [pytest.mark.needs_core, pytest.mark.slow]

Compare = Callable[..., None]
DOCUMENTED = "ours: docs/how-to/stage1.md"


def case(label: str, **run: Any) -> Case:
    vehicle = lmap.Vehicle.load("coco134")
    whole = {
        "kind": "critical_speed",
        "output_step": 0.01,
        "integrator": {"kind": "ros2", "step": 0.001},
        **run,
    }
    return vehicle_case(vehicle.data, vehicle.document.path, whole, label=label)


def ramp(rate_kmh_s: float, step: float = 0.001) -> Case:
    """400 to 80 km/h, the car body set 20 mm aside at the start."""
    return case(
        f"{rate_kmh_s} km/h/s, {step} s",
        speed=400 / 3.6,
        integrator={"kind": "ros2", "step": step},
        disturbance={"carbody.y": 0.02},
        search={
            "method": "ramp_down",
            "end_speed": 80 / 3.6,
            "deceleration": rate_kmh_s / 3.6,
        },
    )


def readings(cases: list[Case]) -> list[float]:
    outcomes = run_cases(cases)
    assert all(outcome.complete for outcome in outcomes), [outcome.trouble for outcome in outcomes]
    return [3.6 * float(outcome.statistics["critical_speed"]) for outcome in outcomes]


def test_the_papers_ramp_down_and_what_it_hangs_on(compare: Compare) -> None:
    """Spiryagin et al. 2013 read 135 km/h at 5 km/h/s. The slower the ramp, the higher the reading: hunting dies away
    slowly below the speed at which its limit cycle ends, and a fast ramp is long past that by then."""
    linear = case("linear", speed=30.0, search={"method": "linear", "range": [5.0, 120.0], "spacing": 5.0})
    del linear.data["run"]["integrator"], linear.data["run"]["output_step"]
    found = readings([ramp(10.0), ramp(5.0), ramp(5.0, 0.0005), ramp(2.5), linear])
    compare("ramp-down at 5 km/h/s, km/h", found[1], 135.0, 8.0, "Spiryagin et al. 2013, 1.6")
    compare("the same at half the step, km/h", found[1], found[2], 0.01 * found[2], "ours, 0.5 ms")
    assert found[0] < found[1] < found[3] < found[4]
    compare("ramp-down at 10 km/h/s, km/h", found[0], 122.0, 1.0, DOCUMENTED)
    compare("ramp-down at 2.5 km/h/s, km/h", found[3], 149.5, 1.0, DOCUMENTED)
    compare("linear, km/h", found[4], 184.0, 1.0, DOCUMENTED)


def test_limit_cycles_end_between_the_ramps_and_the_linear_critical_speed(compare: Compare) -> None:
    """Stepped down from hunting, the limit cycle ends a little below the linear critical speed; what a ramp reads
    lower still is the time that it takes to die away."""
    diagram = case(
        "bifurcation",
        speed=250 / 3.6,
        disturbance={"carbody.y": 0.02},
        search={
            "method": "bifurcation",
            "end_speed": 150 / 3.6,
            "speed_step": 10 / 3.6,
        },
    )
    ramp_reading, fold = readings([ramp(2.5), diagram])
    assert ramp_reading < fold < 184.0
    compare("end of the limit cycles, to a step of 10 km/h", fold, 170.0, 10.0, DOCUMENTED)
