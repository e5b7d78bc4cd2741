"""The page, its figures, and the folder that it lies in."""

from __future__ import annotations

import base64
import json
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
import report_sample as sample

from lmap.report import write_report
from lmap.report.figures import FIGURES
from lmap.report.figures.criterion import NEAR, WHOLE
from lmap.report.figures.envelope import Array, envelope
from lmap.report.figures.plot import Figure, plotly
from lmap.report.page import render
from lmap.verdict import Acceptance, CaseResult, Held, Outcome, SpecVerdict

VOID = {"meta", "link", "br", "img", "hr", "input"}


class Page(HTMLParser):
    """Tags that match, text outside of scripts, and the figures' data."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.figures: list[list[dict[str, Any]]] = []
        self._json = False
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        self._json = tag == "script" and dict(attrs).get("type") == "application/json"
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self._json and data.strip():
            self.figures.append(json.loads(data))
        elif not self.open or self.open[-1] not in ("script", "style"):
            self.text += data


def page(acceptance: Acceptance) -> Page:
    """Rendered and parsed; every tag is closed."""
    parsed = Page(render(acceptance).decode())
    assert parsed.open == []
    return parsed


def figures(spec: SpecVerdict) -> list[Figure]:
    return [figure for draw in FIGURES for figure in draw(spec)]


def values(packed: dict[str, str]) -> np.ndarray[Any, Any]:
    """A packed array read back."""
    return np.frombuffer(base64.b64decode(packed["bdata"]), dtype="<f4")


SAMPLES: dict[str, Callable[[], Acceptance]] = {
    "pass": sample.passing,
    "fail": sample.failing,
    "error": sample.diverged,
    "manual": lambda: sample.waiting(Outcome.MANUAL),
    "not assessed": lambda: sample.waiting(Outcome.NOT_ASSESSED),
    "nothing": sample.acceptance,
    "no criterion": lambda: sample.acceptance(
        replace(sample.passing().specs[0], criteria=(), facts=(), cases=(), inputs=(), outcome=Outcome.ERROR)
    ),
    "two specs": lambda: sample.acceptance(*sample.passing().specs, *sample.failing().specs),
}


@pytest.mark.parametrize("name", SAMPLES)
def test_page_is_well_formed_and_says_the_verdict(name: str) -> None:
    acceptance = SAMPLES[name]()
    parsed = page(acceptance)
    assert str(acceptance.outcome).upper() in parsed.text
    for spec in acceptance.specs:
        assert f"{spec.id} {spec.title}" in parsed.text
        for criterion in spec.criteria:
            assert criterion.name in parsed.text
        for fact in spec.facts:
            assert fact.value in parsed.text


def test_page_is_complete_in_itself() -> None:
    tags = page(sample.passing()).tags
    for tag, attributes in tags:
        assert "src" not in attributes
        if tag == "link":
            assert attributes["href"] == "data:,"
        if tag == "a":
            assert (attributes["href"] or "").startswith("#")
    assert ("meta", {"name": "viewport", "content": "width=device-width, initial-scale=1"}) in tags
    ids = [attributes["id"] for _, attributes in tags if "id" in attributes]
    assert len(set(ids)) == len(ids)


def test_page_shows_values_inputs_and_the_paper() -> None:
    acceptance = sample.passing()
    text = page(acceptance).text
    spec = acceptance.specs[0]
    expected = [
        "0.055 g",
        "0.059 g",
        "assumed",
        "<Nadal> & friends",
        "secondary.kz = 500000.0",
        "specs/hunting.toml",
    ]
    expected += [
        spec.inputs[0].sha256,
        spec.cases[0].hash,
        "ros2",
        "0.5 ms",
        "0.1.0+abcdef",
        "tare",
        "(40 points)",
    ]
    for piece in expected:
        assert piece in text


def test_page_escapes_what_files_say() -> None:
    spec = sample.judged(sample.case("<b>case</b></script><script>alert(1)</script>"))
    evil = replace(spec, title="<img src=x onerror=alert(1)>", vehicle="a&b", overrides={"<i>": "</pre><i>"})
    parsed = page(sample.acceptance(evil))
    assert "<img src=x onerror=alert(1)>" in parsed.text
    assert not any(tag in ("img", "i") for tag, _ in parsed.tags)
    assert sum(tag == "script" for tag, _ in parsed.tags) == 2 + len(parsed.figures)
    names = [trace["name"] for views in parsed.figures for view in views for trace in view["data"]]
    assert not any("<" in name for name in names)


def test_figures_carry_units_on_both_axes() -> None:
    shown = page(sample.passing()).figures
    assert len(shown) == 3 + 3
    for views in shown:
        for view in views:
            layout = view["layout"]
            assert layout["xaxis"]["title"]["text"] == "time t (s)"
            axes = [key for key in layout if key.startswith("yaxis")]
            assert len(axes) == layout["rows"]
            for axis in axes:
                assert re.search(r"\((g|1|mm|kN|km/h)\)$", layout[axis]["title"]["text"])


def test_criterion_figure_shows_signals_limits_and_the_extreme() -> None:
    spec = sample.passing().specs[0]
    figure = figures(spec)[0]
    # The case with the smallest margin opens.
    worst = min(spec.criteria[:2], key=lambda criterion: criterion.margin or 0.0)
    assert figure.views[0].case == worst.case
    assert {(view.case, view.stretch) for view in figure.views} == {
        (case, stretch) for case in ("anzr1_worn_1", "anzr1_worn_2") for stretch in (WHOLE, NEAR)
    }
    view = figure.views[0]
    assert [curve.role for curve in view.curves] == ["raw", "2", "1", "statistic"]
    assert [limit for limit, _ in view.limits] == [-0.35, 0.35]
    assert [text for _, text in view.limits] == ["limit -0.35 g", "limit 0.35 g"]
    assert view.mark is not None
    assert view.mark.value == worst.value
    assert view.mark.text[0].endswith(" g")
    assert view.window is not None
    assert view.window[1] - view.window[0] == pytest.approx(5.0)
    # The mark lies on the statistic's curve, and on the page's single precision.
    curve = view.curves[-1]
    assert curve.values[np.abs(curve.t - view.mark.t).argmin()] == pytest.approx(view.mark.value)
    drawn = plotly(view)
    assert [trace["meta"]["role"] for trace in drawn["data"]][-3:] == ["limit", "limit", "extreme"]
    low, high = drawn["layout"]["yaxis"]["range"]
    assert low < -0.35
    assert high > 0.35


def test_criterion_figure_shades_a_window_of_distance() -> None:
    figure = figures(sample.passing().specs[0])[1]
    window = figure.views[0].window
    assert window is not None
    # 2 m at 35 m/s, to the sample.
    assert window[1] - window[0] == pytest.approx(2.0 / 35.0, abs=0.011)


def test_extreme_below_zero_is_marked_below_zero() -> None:
    case = sample.case("a")
    table = case.frame.with_columns(
        pl.when(pl.col("t") == 5.0).then(-0.02).otherwise(pl.col("ws2.y")).alias("ws2.y")
    )
    spec = sample.judged(replace(case, frames=Held(table, table)), criteria=(sample.SHIFT,))
    mark = figures(spec)[0].views[0].mark
    assert mark is not None
    assert mark.t == 5.0
    assert mark.value == pytest.approx(-20.0)
    assert mark.text[0] == "20.00 mm"


def test_statistic_of_the_whole_run_is_a_level_without_a_place() -> None:
    rms = sample.SHIFT.model_copy(update={"chain": [{"rms": {}}]})
    spec = sample.judged(sample.case("a"), criteria=(rms,))
    (view,) = figures(spec)[0].views
    assert view.mark is None
    assert view.window is None
    assert view.curves[-1].role == "statistic"
    assert set(view.curves[-1].values) == {spec.criteria[0].value}
    assert "t = " not in page(sample.acceptance(spec)).text


def test_criterion_without_limit_has_no_limit_line() -> None:
    figure = figures(sample.passing().specs[0])[2]
    assert figure.badge is None
    assert all(view.limits == () for view in figure.views)


def test_figure_of_a_run_that_diverged_shows_what_there_is_and_why() -> None:
    view = figures(sample.diverged().specs[0])[0].views[0]
    assert view.message == "diverged at t = 3 s: ws1 left the track"
    assert len(view.curves) == 2


@pytest.mark.parametrize("frame", [pl.DataFrame(), pl.DataFrame({"x": [1.0]})])
def test_case_without_channels_gives_messages_instead_of_figures(frame: pl.DataFrame) -> None:
    ended = {"kind": "error", "message": "the core refused it"}
    spec = sample.judged(sample.case("a", frames=Held(frame, frame), ended=ended))
    shown = figures(spec)
    assert [view.message for figure in shown for view in figure.views] == ["the core refused it"] * 3
    assert "the core refused it" in page(sample.acceptance(spec)).text


def test_missing_case_result_is_said() -> None:
    spec = replace(sample.passing().specs[0], cases=())
    assert all(view.message == "the case has no result" for figure in figures(spec) for view in figure.views)


def test_registry_of_figures_is_sorted() -> None:
    modules = [draw.__module__ for draw in FIGURES]
    assert modules == sorted(modules)
    folder = Path(__file__).parents[2] / "python" / "lmap" / "report" / "figures"
    kept = {"__init__", "channels", "envelope", "plot", "root_locus"}  # the last is a page of its own
    assert {module.rsplit(".", 1)[1] for module in modules} == {
        path.stem for path in folder.glob("*.py")
    } - kept


def test_track_irregularity_is_drawn_where_the_frame_has_it() -> None:
    case = sample.case("a")
    table = case.frame.with_columns((0.001 * pl.col("t").sin()).alias("track.cross_level"))
    spec = sample.judged(
        replace(case, frames=Held(table, table), units={**case.units, "track.cross_level": "m"})
    )
    (figure,) = [figure for figure in figures(spec) if figure.title == "Track irregularity"]
    assert figure.views[0].rows == ("cross level (mm)",)


def test_envelope_keeps_every_extreme_and_the_ends() -> None:
    random = np.random.default_rng(3)
    t: Array = np.arange(10_001, dtype=np.float64) * 0.005
    signal = random.standard_normal(len(t))
    kept_t, kept = envelope(t, signal, 100)
    assert len(kept) <= 2 * 100 + 2
    assert (np.diff(kept_t) > 0.0).all()
    assert (kept.min(), kept.max()) == (signal.min(), signal.max())
    assert (kept_t[0], kept_t[-1]) == (t[0], t[-1])
    assert np.isin(kept_t, t).all()
    # Every stretch keeps its own extremes.
    size = -(-len(t) // 100)
    for begin in range(0, len(t), size):
        stretch = signal[begin : begin + size]
        inside = kept[(kept_t >= t[begin]) & (kept_t <= t[min(begin + size, len(t)) - 1])]
        assert (inside.min(), inside.max()) == (stretch.min(), stretch.max())


def test_envelope_leaves_short_records_and_passes_over_nan() -> None:
    t = np.arange(50, dtype=np.float64)
    assert envelope(t, t, 24)[1] is t
    signal = np.arange(1000.0)
    signal[500] = np.nan
    assert np.isfinite(envelope(np.arange(1000.0), signal, 10)[1]).all()


def test_packed_curves_are_the_samples_in_single_precision() -> None:
    view = figures(sample.passing().specs[0])[3].views[0]
    trace = plotly(view)["data"][0]
    assert len(values(trace["x"])) == len(values(trace["y"]))
    assert values(trace["y"])[0] == pytest.approx(126.0, rel=1e-6)


def test_a_page_of_many_tests_has_a_third_of_the_points_and_says_so() -> None:
    one = sample.passing()
    few, many = (Page(render(replace(one, specs=one.specs * count)).decode()) for count in (1, 7))
    assert "three times as many" in many.text
    assert "three times as many" not in few.text

    def points(page: Page) -> list[int]:
        return [
            len(values(trace["y"])) for trace in page.figures[0][0]["data"] if isinstance(trace["y"], dict)
        ]

    longest = max(points(few))
    assert longest > 2000
    assert longest / 4 < max(points(many)) < longest / 2


def test_a_number_without_a_course_has_no_place_and_no_figure() -> None:
    alone = sample.case("lint", duration=0.0)
    assert alone.frame.height == 1
    spec = sample.judged(alone, criteria=(sample.SHIFT,))
    assert [(one.outcome, one.at) for one in spec.criteria] == [(Outcome.PASS, None)]
    assert [figure for figure in figures(spec) if figure.criterion is not None] == []


def folder_of(acceptance: Acceptance, folder: Path) -> dict[str, bytes]:
    write_report(acceptance, folder)
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def test_folder_holds_everything_and_no_leftovers(tmp_path: Path) -> None:
    acceptance = sample.passing()
    written = folder_of(acceptance, tmp_path / "new" / "out")
    hashes = [case.hash for case in acceptance.specs[0].cases]
    expected = {"index.html", "junit.xml", "verdicts.json"}
    expected |= {f"cases/{one}.{ending}" for one in hashes for ending in ("json", "parquet")}
    assert {name.replace("\\", "/") for name in written} == expected
    assert json.loads(written["verdicts.json"])["verdict"] == "pass"
    assert ET.fromstring(written["junit.xml"]).get("tests") == "6"
    case: CaseResult = acceptance.specs[0].cases[0]
    assert (tmp_path / "new" / "out" / "cases" / f"{case.hash}.json").read_text() == case.case_json


def test_same_input_gives_the_same_bytes(tmp_path: Path) -> None:
    assert folder_of(sample.passing(), tmp_path / "a") == folder_of(sample.passing(), tmp_path / "b")


def test_failed_writing_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_report(sample.passing(), tmp_path)
    before = (tmp_path / "index.html").read_bytes()

    def full(path: Path, content: bytes) -> int:
        with path.open("wb") as file:
            file.write(content[:10])
        raise OSError("no space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(OSError, match="no space"):
        write_report(sample.failing(), tmp_path)
    assert (tmp_path / "index.html").read_bytes() == before
    assert not list(tmp_path.rglob("*.tmp"))


def test_what_is_assumed_of_the_test_stands_beside_its_verdict() -> None:
    spec = replace(sample.passing().specs[0], assumed="the radius is ours")
    text = page(sample.acceptance(spec)).text
    assert "test assumed" in text
    assert "the radius is ours" in text
    assert "test assumed" not in page(sample.passing()).text
