"""Sweeps: which variants there are, what a row says, and that one bad variant stops no other."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from types import ModuleType
from typing import Any

import polars as pl
import pytest

from lmap.errors import InputProblem
from lmap.report.sweep import page, summary
from lmap.sweep import AHEAD, Variation, grid, sweep, variation


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("run.speed_kmh=80..120", (80.0, 90.0, 100.0, 110.0, 120.0)),
        ("a=-1e-3..1e-3", (-1e-3, -5e-4, 0.0, 5e-4, 1e-3)),
        ("a=.5..1.5", (0.5, 0.75, 1.0, 1.25, 1.5)),
        ("a=1,2,5", (1, 2, 5)),
        ("a=1.5", (1.5,)),
        ("run.wheel_profile=anzr1, s1002", ("anzr1", "s1002")),
        ('a="x,y","z"', ("x,y", "z")),
        ("a=true,false", (True, False)),
        ('run.wheel_profile=["a", "b"],["c"]', (["a", "b"], ["c"])),
    ],
)
def test_a_variation_is_a_range_or_a_list(text: str, values: tuple[Any, ...]) -> None:
    assert variation(text, 5).values == values


def test_a_range_has_both_ends_and_decimal_values_between() -> None:
    assert variation("a=0..1", 11).values[3] == 0.3
    assert variation("a=0.1..0.7", 7).values == (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7)
    assert variation("a=1..2", 2).values == (1.0, 2.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("secondary.kz", "--vary: found"),
        ("=1..2", "--vary: found"),
        ("a=1..", "two finite numbers"),
        ("a=1..x", "two finite numbers"),
        ("a=3..3", "a range with two ends"),
        ("a=1,,2", "a value between commas"),
        ("a=1,nan", r"--vary a\[1\]: found NaN; allowed: a finite number"),
    ],
)
def test_what_is_no_variation_is_refused(text: str, message: str) -> None:
    with pytest.raises(InputProblem, match=message):
        variation(text, 5)


def test_a_grid_has_every_combination_the_last_key_fastest() -> None:
    both = grid([Variation("a", (1, 2)), Variation("b", ("x", "y"))])
    assert both == [{"a": 1, "b": "x"}, {"a": 1, "b": "y"}, {"a": 2, "b": "x"}, {"a": 2, "b": "y"}]
    with pytest.raises(InputProblem, match="a twice"):
        grid([Variation("a", (1,)), Variation("a", (2,))])


@pytest.mark.usefixtures("toy")
class TestOnTheStandIn:
    def test_a_row_for_each_variant_criterion_and_case(self) -> None:
        frame = sweep("sway", {"yaw_damper.cx": [0.0, 1e5], "run.speed_kmh": [90, 100, 110]})
        assert frame.height == 2 * 3 * 3 * 2
        assert frame.columns[:3] == ["variant", "yaw_damper.cx", "run.speed_kmh"]
        assert frame["variant"].to_list() == sorted(frame["variant"].to_list())
        lateral = frame.filter(criterion="lateral acceleration")
        assert set(lateral.filter(pl.col("yaw_damper.cx") == 0.0)["verdict"]) == {"fail"}
        assert set(lateral.filter(pl.col("yaw_damper.cx") > 0.0)["verdict"]) == {"pass"}
        row = lateral.row(0, named=True)
        assert (row["unit"], row["limit"], row["limit_min"], row["limit_max"]) == (
            "g",
            "|x| < 0.35",
            -0.35,
            0.35,
        )
        assert row["margin"] == pytest.approx(0.35 - row["value"])

    def test_one_and_two_threads_cold_and_warm_give_the_same(self) -> None:
        vary = {"yaw_damper.cx": [0.0, 1e5], "run.wheel_profile": ["round", "flat"]}
        cold = sweep("sway", vary, jobs=1, cache=False)
        assert sweep("sway", vary, jobs=2).equals(cold)
        assert sweep("sway", vary, jobs=2).equals(cold)
        # alone in its run, the profile is a case of its own name
        assert set(cold["case"]) == {"round", "flat"}

    def test_a_second_sweep_runs_nothing(
        self, fake_core: ModuleType, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        first = sweep("sway", {"run.speed_kmh": [90, 100]})
        monkeypatch.setattr(fake_core, "run_cases", lambda *_: pytest.fail("nothing is new"))
        assert sweep("sway", {"run.speed_kmh": [90, 100]}).equals(first)

    def test_a_variant_is_prepared_when_it_is_about_to_run(
        self, fake_core: ModuleType, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        checked, begun = list[str](), list[int]()
        check, really = fake_core.check_case, fake_core.run_cases

        def run(cases: Iterable[str], *rest: Any) -> None:
            texts = []
            for text in cases:
                begun.append(len(checked))
                texts.append(text)
            really(texts, *rest)

        def checking(text: str, *rest: Any) -> None:
            checked.append(text)
            check(text, *rest)

        monkeypatch.setattr(fake_core, "check_case", checking)
        monkeypatch.setattr(fake_core, "run_cases", run)
        sweep("sway", {"run.speed_kmh": list(range(90, 110)), "run.wheel_profile": ["round"]})
        assert len(begun) == 20
        assert begun == [min(AHEAD + before, 20) for before in range(20)]

    def test_a_variant_that_is_no_model_or_diverges_is_a_row(self) -> None:
        frame = sweep("sway", {"run.speed_kmh": [100, -5]})
        bad = frame.filter(pl.col("run.speed_kmh") < 0)
        assert bad.height == 1
        row = bad.row(0, named=True)
        assert (row["verdict"], row["criterion"], row["value"]) == ("error", None, None)
        assert "run.speed_kmh: found -5" in row["message"]
        assert set(frame.filter(pl.col("run.speed_kmh") > 0)["verdict"]) == {"pass", "shown"}
        frame = sweep("sway", {"run.test": ["diverge", "raise", "none"]})
        by_test = {test: set(rows["verdict"]) for (test,), rows in frame.group_by("run.test")}
        assert by_test == {"diverge": {"error"}, "raise": {"error"}, "none": {"pass", "shown"}}
        assert "derailed" in str(frame.filter(pl.col("run.test") == "diverge")["message"][0])

    @pytest.mark.parametrize(
        ("vary", "settings", "message"),
        [
            ({"yaw_damper.xc": [1.0, 2.0]}, {}, "yaw_damper.xc"),
            ({"run.speed_kmh": [90]}, {"run.speed_kmh": 80}, "which is set"),
            ({"run.speed_kmh": []}, {}, "no values"),
            ({"run.speed_kmh": [90]}, {"run.speed": 80}, "one way of writing it"),
            ({"run.speed_kmh": [math.nan]}, {}, "a finite number"),
        ],
    )
    def test_a_sweep_of_nothing_valid_is_refused(
        self, vary: dict[str, Any], settings: dict[str, Any], message: str
    ) -> None:
        with pytest.raises(InputProblem, match=message):
            sweep("sway", vary, set=settings)

    def test_the_page_shows_each_criterion_with_its_limit(self) -> None:
        keys = ["run.speed_kmh", "run.wheel_profile"]
        frame = sweep("sway", {keys[0]: [90, 100, -1], keys[1]: ["round", "flat"]})
        text = page("sway", frame, keys).decode()
        for words in ("lateral acceleration", "wheel L/V", "run.speed_kmh", "|x| &lt; 0.35 g", "error"):
            assert words in text
        assert "http" not in text.partition("<script>")[0]
        said = summary(frame, keys)
        assert said.startswith("4 of 6 variants pass, 2 cannot be judged\n")
        assert "error at run.speed_kmh = -1" in said


def test_the_command_writes_parquet_and_page(
    toy: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from lmap.cli import app

    def run(*arguments: str) -> int:
        monkeypatch.setattr("sys.argv", ["lmap", "sweep", *arguments])
        with pytest.raises(SystemExit) as left:
            app.main()
        return int(left.value.code or 0)

    assert run("sway", "--vary", "run.speed_kmh=90..110", "--samples", "3", "-o", "out") == 0
    frame = pl.read_parquet(toy / "out" / "sweep.parquet")
    assert frame["run.speed_kmh"].unique().to_list() == [90.0, 100.0, 110.0]
    assert (toy / "out" / "sweep.html").stat().st_size > 1e6
    assert capsys.readouterr().out.startswith("3 of 3 variants pass\n")
    assert run("sway", "--vary", "yaw_damper.cx=0,1e5", "-q", "-o", "out") == 1
    assert run("sway", "--vary", "run.test=diverge,none", "-q", "-o", "out") == 2
    assert run("sway", "--vary", "a=1..2", "--vary", "a=1", "-o", "out2") == 2
    assert capsys.readouterr().err.endswith("lmap: --vary: found a twice; allowed: each key once\n")
    assert not (toy / "out2").exists()
