"""`lmap contact`: what a wheel and a rail do to each other."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Annotated

import typer


def contact(
    wheel: Annotated[str, typer.Argument(metavar="WHEEL", help="A profile that ships, or a file.")],
    rail: Annotated[str, typer.Argument(metavar="RAIL", help="A profile that ships, or a file.")],
    gauge: Annotated[
        float, typer.Option(metavar="MM", help="Between the rails, at the gauge depth.")
    ] = 1435.0,
    gauge_depth: Annotated[
        float, typer.Option(metavar="MM", help="Below the top of the rail, where the gauge is measured.")
    ] = 14.0,
    inclination: Annotated[
        str, typer.Option(metavar="1:N", help="Of the rails; 0 where the profile is drawn inclined.")
    ] = "1:40",
    flange_back: Annotated[
        float, typer.Option(metavar="MM", help="Between the backs of the flanges.")
    ] = 1360.0,
    radius: Annotated[float, typer.Option(metavar="MM", help="Of the running circle.")] = 460.0,
    law: Annotated[
        list[str] | None, typer.Option(metavar="LAW", help="A creep law to draw; may be given again.")
    ] = None,
    friction: Annotated[float, typer.Option(help="Coefficient of friction.")] = 0.3,
    load: Annotated[float, typer.Option(metavar="KN", help="Vertical force of a wheel.")] = 100.0,
    speed: Annotated[float, typer.Option(metavar="KM/H", help="Speed of the traction curve.")] = 22.0,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Write the page with the figures to this folder.")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="One JSON object on stdout, nothing else there.")
    ] = False,
) -> None:
    """Contact of a wheel and a rail: conicity, flange play, contact points, patches, creep and traction curves.

    Example: lmap contact s1002 uic60 --inclination 1:40 --law fastsim --law polach --out out/
    """
    from lmap.check import report_folder, version
    from lmap.contact.laws import law_of
    from lmap.contact.pair import Pair
    from lmap.contact.survey import survey
    from lmap.report import contact_sheet

    folder = None if out is None else report_folder(out, option="--out")
    lengths = {
        "--gauge": gauge,
        "--gauge-depth": gauge_depth,
        "--flange-back": flange_back,
        "--radius": radius,
    }
    _positive({name: (value, "mm") for name, value in lengths.items()})
    _positive({"--friction": (friction, ""), "--load": (load, "kN"), "--speed": (speed, "km/h")})
    for name in law or ():
        law_of(name)
    pair = Pair(
        wheel,
        rail,
        gauge=round(1e-3 * gauge, 9),
        gauge_point_depth=round(1e-3 * gauge_depth, 9),
        inclination=_slope(inclination),
        flange_back=round(1e-3 * flange_back, 9),
        radius=round(1e-3 * radius, 9),
    )
    laws = {} if law is None else {"laws": law}
    found = survey(pair, friction=friction, load=1e3 * load, speed=speed / 3.6, **laws)
    if as_json:
        import json

        sys.stdout.write(json.dumps(contact_sheet.document(found), indent=1, allow_nan=False) + "\n")
    else:
        from rich.console import Console

        contact_sheet.table(found, Console())
    sys.stdout.flush()
    if folder is not None:
        from lmap import files
        from lmap.report.sheet import render

        folder.mkdir(parents=True, exist_ok=True)
        page = folder / "contact.html"
        files.write(page, render(contact_sheet.sheet(found, version())))
        if not as_json:
            print(f"figures: {page}", file=sys.stderr)


def _positive(given: dict[str, tuple[float, str]]) -> None:
    """Refuses options that are no numbers above zero, all at once, in the unit in which they were typed."""
    from lmap.errors import InputProblem, Problem

    problems = [
        Problem(key=(option,), found=f"{value:g} {unit}".strip(), allowed=f"a number > 0, {unit}".strip(", "))
        for option, (value, unit) in given.items()
        if not (math.isfinite(value) and value > 0.0)
    ]
    if problems:
        raise InputProblem(problems)


def _slope(text: str) -> float:
    """`1:40`, `1/40` or `0.025` as a slope."""
    from lmap.errors import InputProblem, Problem

    numerator, mark, denominator = text.replace("/", ":").partition(":")
    try:
        slope = float(numerator) / (float(denominator) if mark else 1.0)
    except (ValueError, ZeroDivisionError):
        slope = float("nan")
    if not 0.0 <= slope <= 0.2:
        raise InputProblem(
            Problem(key=("--inclination",), found=f'"{text}"', allowed="1:5 or flatter, as 1:40 or 0.025; 0")
        )
    return slope
