"""Measured tracks: read beside the spec, named in the case by path and SHA-256, handed to the core as text."""

from __future__ import annotations

import hashlib
import json
import math
from pathlib import Path

import polars as pl
import pytest

from lmap.errors import InputProblem
from lmap.prepare import prepare
from lmap.simulate import track_extremes
from lmap.spec.case import Case
from lmap.spec.measured import with_records

ROOT = Path(__file__).parents[2]
PLACES = [0.25 * i for i in range(1700)]
FRAME = pl.DataFrame(
    {
        "s_m": PLACES,
        "vertical_mm": [5.0 * math.sin(math.tau * s / 20.0) for s in PLACES],
        "gauge_mm": [2.0 for _ in PLACES],
    }
)


def case_of(**irregularity: object) -> Case:
    return Case("test", {"track": {"length": 400.0, "irregularity": {"kind": "measured", **irregularity}}})


def told(case: Case, beside: Path) -> str:
    with pytest.raises(InputProblem) as error:
        with_records(case, beside)
    return str(error.value)


def test_the_hash_of_the_file_is_in_the_case_and_its_text_beside_it(tmp_path: Path) -> None:
    (tmp_path / "line.csv").write_text(FRAME.write_csv())
    case = with_records(case_of(file="line.csv"), tmp_path / "spec.toml")
    sha256 = hashlib.sha256((tmp_path / "line.csv").read_bytes()).hexdigest()
    assert case.data["track"]["irregularity"]["sha256"] == sha256
    assert "vertical_mm" not in case.json
    assert json.loads(case.core_json)["track"]["irregularity"]["text"] == FRAME.write_csv()
    # Another content is another case, though the name is the same.
    (tmp_path / "line.csv").write_text(FRAME.head(900).write_csv())
    assert with_records(case_of(file="line.csv"), tmp_path).hash != case.hash


def test_parquet_is_the_same_track_as_csv(tmp_path: Path) -> None:
    (tmp_path / "line.csv").write_text(FRAME.write_csv())
    FRAME.write_parquet(tmp_path / "line.parquet")
    csv = with_records(case_of(file="line.csv"), tmp_path)
    parquet = with_records(case_of(file="line.parquet"), tmp_path)
    assert list(csv.texts.values()) == list(parquet.texts.values())


def test_what_is_wrong_with_the_file_is_told_at_its_key(tmp_path: Path) -> None:
    assert told(case_of(file="no.csv"), tmp_path) == (
        'track.irregularity.file: found "no.csv", which is no file; allowed: a CSV or parquet file'
    )
    (tmp_path / "bad.parquet").write_text("s_m,vertical_mm\n")
    assert "which is no parquet" in told(case_of(file="bad.parquet"), tmp_path)
    (tmp_path / "latin.csv").write_bytes("s_m;hoehe_mm;ü\n".encode("latin-1"))
    assert "no UTF-8" in told(case_of(file="latin.csv"), tmp_path)
    (tmp_path / "line.csv").write_text(FRAME.write_csv())
    message = told(case_of(file="line.csv", sha256="00"), tmp_path)
    assert message.startswith('track.irregularity.sha256: found "00" where')


def spec(folder: Path, entry: str) -> Path:
    lines = (ROOT / "specs" / "hunting.toml").read_text().splitlines()
    written = [f"irregularity = {entry}" if line.startswith("irregularity =") else line for line in lines]
    written = ["length = 400.0" if line.startswith("length =") else line for line in written]
    path = folder / "measured.toml"
    path.write_text("\n".join(written))
    return path


def test_a_spec_runs_over_its_measured_track(tmp_path: Path) -> None:
    (tmp_path / "line.csv").write_text(FRAME.write_csv())
    prepared = prepare(spec(tmp_path, '{ kind = "measured", file = "line.csv", scale = 2.0 }'))
    assert [file.role for file in prepared.inputs].count("measured track") == 1
    extremes = track_extremes(prepared.cases[0])
    assert extremes["vertical"] == pytest.approx((-0.010, 0.010), rel=1e-3)
    assert extremes["gauge"] == pytest.approx((0.0, 0.004), rel=1e-9)


def test_the_cores_own_words_about_a_record_stand_at_the_specs_line(tmp_path: Path) -> None:
    (tmp_path / "line.csv").write_text("s_m,profile_mm\n0,1\n500,1\n")
    with pytest.raises(InputProblem) as error:
        prepare(spec(tmp_path, '{ kind = "measured", file = "line.csv" }'))
    message = str(error.value)
    assert "track.irregularity.file: found" in message
    assert "line 1: no column of a channel: s_m,profile_mm" in message
    assert "measured.toml:" in message
