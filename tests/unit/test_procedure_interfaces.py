"""What a procedure may bring beside cases: numbers of its own, derived columns and cases, drawings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import ModuleType

import polars as pl
import pytest
from pydantic import BaseModel, ConfigDict

import lmap
from lmap import procedures
from lmap.errors import InputProblem, JudgementProblem
from lmap.procedures.base import CaseFigures, expand, settings
from lmap.spec.case import Case, VehicleData
from lmap.spec.model import Spec
from lmap.verdict import Drawing, DrawnCurve, Fact, Outcome

pytestmark = pytest.mark.usefixtures("toy")

CRITERION = """
[[criterion]]
name = "mean motion, doubled"
signal = "ws*.doubled"
chain = [{ maximum = {} }]
unit = "mm"
source = "none"
case = "both"
"""


class Settings(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)
    factor: float = 2.0
    refuse: bool = False
    derail: bool = False


def _module() -> ModuleType:
    def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
        found = expand(spec, vehicle)
        if not settings(spec, Settings).derail:
            return found
        run = {**found[1].data["run"], "test": "diverge"}
        return [found[0], Case(found[1].label, {**found[1].data, "run": run})]

    def quantities(
        spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
    ) -> Mapping[str, pl.DataFrame]:
        own = settings(spec, Settings)
        if own.refuse:
            raise JudgementProblem("the procedure says no")
        first = next(iter(frames.values()))
        doubled = pl.col("ws1.y") * own.factor
        return {**frames, "both": first.with_columns(doubled.alias("ws1.doubled"))}

    def derived(spec: Spec, channels: Mapping[str, str]) -> Mapping[str, str]:
        return {
            name.replace(".y", ".doubled"): unit
            for name, unit in channels.items()
            if name.startswith("ws") and name.endswith(".y")
        }

    def drawings(spec: Spec, quantities: Mapping[str, pl.DataFrame], vehicle: VehicleData) -> list[Drawing]:
        loop = DrawnCurve(name="the loop", x=[0.0, 1.0, 0.0], y=[0.0, 1.0, 0.5])
        return [Drawing(title="A loop", x_label="cant (mm)", y_label="roll (mrad)", curves=(loop,))]

    def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
        return []

    made = ModuleType("made")
    made.NAME, made.SUMMARY, made.UNITS, made.SETTINGS = "made", "for this test", {}, Settings  # type: ignore[attr-defined]
    made.cases, made.quantities, made.facts = cases, quantities, facts  # type: ignore[attr-defined]
    made.derived, made.drawings = derived, drawings  # type: ignore[attr-defined]
    return made


@pytest.fixture
def spec(monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setitem(procedures.BY_NAME, "made", _module())  # type: ignore[arg-type]
    path = Path("specs/made.toml")
    text = Path("specs/sway.toml").read_text().replace('procedure = "hunting"', 'procedure = "made"')
    head, *_ = text.partition("[[criterion]]")
    path.write_text(head + CRITERION)
    return path


def _with(spec: Path, table: str) -> None:
    spec.write_text(spec.read_text() + f"\n[test]\n{table}\n")


def test_derived_columns_and_cases_are_judged_and_drawings_shown(spec: Path, tmp_path: Path) -> None:
    _with(spec, "factor = 4.0")
    [found] = lmap.check(spec, report=tmp_path / "out").specs
    assert [(c.case, c.outcome) for c in found.criteria] == [("both", Outcome.PASS)]
    frame = found.cases[0].frame["ws1.y"]
    assert found.criteria[0].value == pytest.approx(4e3 * float(frame.max()))  # type: ignore[arg-type]
    page = (tmp_path / "out" / "index.html").read_text()
    assert "A loop" in page
    assert "roll (mrad)" in page


@pytest.mark.parametrize(
    ("table", "message"), [("factr = 1.0", "test.factr"), ('factor = "much"', "test.factor")]
)
def test_faults_of_its_own_numbers_name_the_key(spec: Path, table: str, message: str) -> None:
    _with(spec, table)
    with pytest.raises(InputProblem, match=message) as caught:
        lmap.check(spec)
    assert "made.toml" in str(caught.value)


def test_numbers_that_no_one_reads_are_refused() -> None:
    path = Path("specs/sway.toml")
    _with(path, "factor = 1.0")
    with pytest.raises(InputProblem, match="no numbers of its own"):
        lmap.check(path)


def test_what_the_procedure_refuses_is_an_error(spec: Path) -> None:
    _with(spec, "refuse = true")
    [found] = lmap.check(spec).specs
    assert found.outcome is Outcome.ERROR
    assert "the procedure says no" in str(found.criteria[0].message)


def test_a_criterion_for_no_case_is_an_error(spec: Path) -> None:
    spec.write_text(spec.read_text().replace('case = "both"', 'case = "neither"'))
    [found] = lmap.check(spec).specs
    assert found.outcome is Outcome.ERROR
    assert "no case is called neither" in str(found.criteria[0].message)


def test_a_run_that_ended_early_leaves_the_others_judged(spec: Path) -> None:
    _with(spec, "derail = true")
    spec.write_text(
        spec.read_text().replace('case = "both"', 'case = ["both", "worn"]').replace("ws*.doubled", "ws*.y")
    )
    [found] = lmap.check(spec).specs
    assert [(c.case, c.outcome) for c in found.criteria] == [("worn", Outcome.ERROR), ("both", Outcome.PASS)]
    assert "ended early" in str(found.criteria[0].message)
