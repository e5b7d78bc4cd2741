"""Creep laws against CONTACT's curves, Kalker's table, a locomotive's traction curve and Polach's published points."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from scipy.interpolate import PchipInterpolator

from lmap import toml

pytestmark = pytest.mark.needs_core

Compare = Callable[..., None]
ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT / "crates/railsim/tests/data"
SHARED = Path(os.environ.get("LMAP_SHARED", ROOT.parent / "shared"))
CONTACT = "CONTACT v25.2"
MU, LOAD = 0.3, 1e5


def read(name: str) -> pl.DataFrame:
    return pl.read_csv(DATA / name, comment_prefix="#")


def forces(
    law: dict[str, Any], contacts: dict[str, Any], falling: dict[str, float] | None = None
) -> pl.DataFrame:
    text = None if falling is None else json.dumps(falling)
    return pl.DataFrame(toml.core().creep_forces(json.dumps(law), contacts, text))


def coefficients(ratios: list[float], poisson: float) -> pl.DataFrame:
    return pl.DataFrame(toml.core().kalker_coefficients(ratios, poisson))


def patch(a: float, b: float, load: float) -> dict[str, float]:
    row = coefficients([a / b], 0.28).row(0, named=True)
    return {"a": a, "b": b, "n": load, "shear_modulus": 82e9, **row}


@pytest.fixture(scope="module")
def table() -> pl.DataFrame:
    path = SHARED / "data/fetched/kalker_table_published.csv"
    if not path.exists():
        pytest.skip(f"{path.name} is not there: LMAP_SHARED says where the shared folder is")
    return pl.read_csv(path, comment_prefix="#")


@pytest.mark.parametrize("name", ["c11", "c22", "c23", "c33"])
@pytest.mark.parametrize("poisson", [0.0, 0.25, 0.5])
def test_kalkers_table(compare: Compare, table: pl.DataFrame, name: str, poisson: float) -> None:
    """Nodes exactly; between them within 1 % of the monotone cubic in ln C over ln(a/b), which scipy computes."""
    published = table[f"{name.upper()}_nu{poisson:g}"].to_numpy()
    ratio = table["a_over_b"].to_numpy()
    exact = np.where(ratio > 1.0, 1.0 / (np.round(10.0 / ratio) / 10.0), ratio)
    ours = coefficients(exact.tolist(), poisson)[name].to_numpy()
    compare(
        f"{name} nu {poisson:g} at 19 nodes, worst",
        np.abs(ours / published - 1.0).max(),
        0.0,
        1e-12,
        "Kalker 1990",
    )
    between = np.exp(np.linspace(math.log(0.1), math.log(10.0), 400))
    between = between[(between > 0.1) & (between < 10.0)]
    smooth = np.exp(PchipInterpolator(np.log(exact), np.log(published))(np.log(between)))
    ours = coefficients(between.tolist(), poisson)[name].to_numpy()
    compare(
        f"{name} nu {poisson:g} between, worst",
        np.abs(ours / smooth - 1.0).max(),
        0.0,
        0.01,
        "PCHIP of Kalker 1990",
    )


def curves(method: str) -> pl.DataFrame:
    return read("creep_force_curves_ab1.csv").filter(pl.col("method") == method)


def errors(law: dict[str, Any], rows: pl.DataFrame) -> np.ndarray:
    creepages = {
        "xi": rows["xi"].to_numpy(),
        "eta": rows["eta"].to_numpy(),
        "phi": 1e3 * rows["phi_per_mm"].to_numpy(),
    }
    ours = forces(law, {**patch(6e-3, 6e-3, LOAD), **creepages, "mu": MU}) / (MU * LOAD)
    return np.hypot(ours["fx"] - rows["Fx_rel"], ours["fy"] - rows["Fy_rel"])


FINE = {"nx": 200, "ny": 200}


@pytest.mark.parametrize("kind", ["xi", "eta", "phi"])
def test_fastsim_is_contacts_fastsim(compare: Compare, kind: str) -> None:
    rows = curves("FASTSIM_PAR").filter(pl.col("kind") == kind)
    worst = errors({"kind": "fastsim", **FINE}, rows).max()
    compare(
        f"FASTSIM pure {kind}, worst of {rows.height} (mu N)", worst, 0.0, 0.005, f"{CONTACT} FASTSIM n = 200"
    )


def test_laws_against_the_exact_theory(compare: Compare) -> None:
    """Mean and largest error; bounds are the methods' own errors, in the literature's order."""
    means = []
    for law, mean, largest in [
        ({"kind": "fastrip", "poisson": 0.28, **FINE}, 0.015, 0.075),
        ({"kind": "fastsim", **FINE}, 0.04, 0.16),
        ({"kind": "polach"}, 0.09, 0.4),
    ]:
        found = errors(law, curves("CONTACT"))
        compare(
            f"{law['kind']}: mean error of {len(found)} (mu N)", found.mean(), 0.0, mean, f"{CONTACT} exact"
        )
        compare(f"{law['kind']}: largest error (mu N)", found.max(), 0.0, largest, f"{CONTACT} exact")
        means.append(found.mean())
    assert means == sorted(means)


@pytest.mark.parametrize("law", ["fastsim", "fastrip"])
def test_slopes_at_small_creepage(compare: Compare, law: str) -> None:
    one = patch(6e-3, 6e-3, LOAD)
    scale = -82e9 * 36e-6 * 1e-9
    for name, creep, force in [("c11", "xi", "fx"), ("c22", "eta", "fy")]:
        contact = {**one, "xi": 0.0, "eta": 0.0, "phi": 0.0, "mu": MU, creep: 1e-9}
        found = forces({"kind": law, "nx": 100, "ny": 100}, contact)[force][0] / scale
        compare(f"{law}: slope over {name}", found / one[name], 1.0, 0.005, "Kalker 1990")


@pytest.mark.parametrize(
    ("law", "series", "bound"),
    [
        ({"kind": "fastsim", "nx": 42, "ny": 42}, 3, 0.015),
        ({"kind": "fastsim", "nx": 42, "ny": 42}, 1, 0.055),
        ({"kind": "modified_fastsim", "k0": 0.54, "alpha": 0.02, "beta": 0.62, "nx": 42, "ny": 42}, 4, 0.05),
        ({"kind": "polach", "k_a": 0.56, "k_s": 0.28}, 4, 0.03),
        ({"kind": "polach", "k_a": 0.28, "k_s": 0.26}, 2, 0.04),
    ],
)
def test_locomotive_traction_curve(compare: Compare, law: dict[str, Any], series: int, bound: float) -> None:
    """Series 1 exact Coulomb, 2 exact with a layer, 3 FASTSIM, 4 modified FASTSIM; Polach's factors are fitted."""
    rows = read("tractcurv.csv").filter(pl.col("series") == series)
    falls = series in (2, 4)
    mu = 0.36 if falls else 0.33
    contact = {
        **patch(6.307e-3, 12.615e-3, 106.7e3),
        "xi": rows["xi"].to_numpy(),
        "eta": 0.0,
        "phi": 0.0,
        "mu": mu,
    }
    falling = {"ratio": 0.38, "decay": math.log(2.0) / 0.99} if falls else None
    ours = -forces(law, {**contact, "speed": 10.0}, falling)["fx"].to_numpy() / 106.7e3
    worst = np.abs(ours - rows["adhesion_coefficient"].to_numpy()).max() / mu
    compare(f"{law['kind']} on series {series}, worst of {rows.height} (mu N)", worst, 0.0, bound, CONTACT)


@pytest.mark.parametrize(
    ("column", "law", "mu", "falling"),
    [
        (1, {"kind": "polach", "k_a": 0.6, "k_s": 0.15}, 0.47, {"ratio": 0.44, "decay": 0.7}),
        (2, {"kind": "polach", "k_a": 0.29, "k_s": 0.09}, 0.30, {"ratio": 0.38, "decay": 0.1}),
    ],
)
def test_polachs_formula(
    compare: Compare, column: int, law: dict[str, Any], mu: float, falling: dict[str, float]
) -> None:
    """Dry and wet of Spiryagin et al. (2013), Table 4, at 22 km/h: friction at the slip velocity and formula."""
    rows = read("polach_table4_22kmh.csv")
    contact = {
        "a": 7.7463e-3,
        "b": 5.4550e-3,
        "n": 109.5e3,
        "c11": 4.30,
        "c22": 4.0,
        "c23": 1.9,
        "shear_modulus": 80.77e9,
        "xi": rows.to_series(0).to_numpy(),
        "eta": 0.0,
        "phi": 0.0,
        "mu": mu,
    }
    ours = -forces(law, {**contact, "speed": 22.0 / 3.6}, falling)["fx"].to_numpy() / 109.5e3
    worst = np.abs(ours - rows.to_series(column).to_numpy()).max()
    compare(
        f"Polach {'dry' if column == 1 else 'wet'}, worst of {rows.height} (load)",
        worst,
        0.0,
        1e-3,
        "Table 4",
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"xi": [0.0, math.nan]}, "xi[1]: found NaN; allowed: a finite number"),
        ({"n": -1.0}, "n: found -1; allowed: a normal force >= 0, N"),
        ({"mu": "dry"}, "mu: found str; allowed: a number, or numbers in an array or a list"),
    ],
)
def test_bad_contact_is_one_clear_error(change: dict[str, Any], message: str) -> None:
    contact = {**patch(6e-3, 6e-3, LOAD), "xi": 0.0, "eta": 0.0, "phi": 0.0, "mu": MU, **change}
    with pytest.raises(toml.core().InputError) as raised:
        forces({"kind": "fastsim"}, contact)
    assert str(raised.value) == message
