"""Hunting (LMAP 2C.1): smooth straight track at 110 % of the design speed, tare, worn wheels.

One case for every wheel profile and speed of the spec; the criteria judge the frames as they are. Beside the
verdicts stand what the figures hang on: the track's extremes and longest wavelength, and the profiles'
equivalent conicity.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from lmap.procedures.base import CONICITY_AMPLITUDE, CaseFigures, expand
from lmap.spec.case import Case, VehicleData
from lmap.spec.model import Spec
from lmap.verdict import Fact

if TYPE_CHECKING:
    import polars as pl

NAME = "hunting"
SUMMARY = "straight track with small irregularities, one run for each wheel profile and speed"
UNITS: Mapping[str, str] = {}

# Spiryagin et al. 2013, Table 6: (largest, least) of the class 6 sample, mm; gauge as printed.
_TABLE_6 = {"lateral": (4.553, -4.842), "vertical": (5.631, -5.940), "cross_level": (4.114, -4.504)}
_TABLE_6_GAUGE = "1430.496 to 1439.114 mm"
_SHOWN = {"lateral": "lateral", "vertical": "vertical", "cross_level": "cant"}


def cases(spec: Spec, vehicle: VehicleData) -> list[Case]:
    """A case for every wheel profile and speed."""
    return expand(spec, vehicle)


def quantities(
    spec: Spec, frames: Mapping[str, pl.DataFrame], vehicle: VehicleData
) -> Mapping[str, pl.DataFrame]:
    """The frames as they are."""
    return frames


def facts(spec: Spec, figures: Sequence[CaseFigures]) -> list[Fact]:
    """The track's extremes beside the paper's, its longest wavelength, and each profile's conicity."""
    found: list[Fact] = []
    for number, figure in enumerate(figures):
        shared = all(other.track_extremes == figures[0].track_extremes for other in figures)
        if number == 0 or not shared:
            found += _track(figure, None if shared else figure.case.label)
    band = [part["wavelengths"] for part in _irregularities(spec.track) if "wavelengths" in part]
    if band:
        longest = max(max(pair) for pair in band)
        shortest = min(min(pair) for pair in band)
        found.append(Fact(name="irregularity, wavelengths", value=f"{shortest:g} to {longest:g} m"))
    seen: set[str] = set()
    for figure in figures:
        profile = str(figure.case.data["run"].get("wheel_profile"))
        if figure.conicity is not None and profile not in seen:
            seen.add(profile)
            name = f"equivalent conicity at {CONICITY_AMPLITUDE * 1e3:g} mm, {profile}"
            found.append(Fact(name=name, value=f"{figure.conicity:.4f}"))
    return found


def _irregularities(track: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """The written irregularities, one table or a list of them."""
    written = track.get("irregularity", [])
    return [
        part for part in (written if isinstance(written, list) else [written]) if isinstance(part, Mapping)
    ]


def _track(figure: CaseFigures, case: str | None) -> list[Fact]:
    paper = _is_paper_class(figure.case.data["track"])
    found = []
    for name, shown in _SHOWN.items():
        if name in figure.track_extremes:
            least, most = figure.track_extremes[name]
            published = "{:+.3f} / {:+.3f} mm".format(*_TABLE_6[name]) if paper else None
            value = f"{most * 1e3:+.3f} / {least * 1e3:+.3f} mm"
            found.append(Fact(name=f"irregularity, {shown}", value=value, published=published, case=case))
    gauge = figure.case.data["track"].get("gauge")
    if "gauge" in figure.track_extremes and isinstance(gauge, int | float):
        least, most = figure.track_extremes["gauge"]
        value = f"{(gauge + least) * 1e3:.3f} to {(gauge + most) * 1e3:.3f} mm"
        published = _TABLE_6_GAUGE if paper else None
        found.append(Fact(name="irregularity, gauge", value=value, published=published, case=case))
    return found


def _is_paper_class(track: Mapping[str, Any]) -> bool:
    """Whether the track is of the class whose sample the paper prints."""
    return any(part.get("kind") == "psd" and part.get("class") == 6 for part in _irregularities(track))
