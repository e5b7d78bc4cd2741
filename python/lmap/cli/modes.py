"""`lmap modes`: eigenvalues and named mode shapes of a vehicle, and its root locus."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from lmap.cli.options import Condition, Parameters, VehicleName

if TYPE_CHECKING:
    import polars as pl

    from lmap.vehicle import Vehicle

MOST_SPEEDS = 1000
"""Speeds of a root locus; more is a slip of the pen."""

GROWS = 1e-6
"""Real parts up to this (1/s) are rounding of a motion that does not change."""

MOVES = 0.3
"""Coordinates that move by this share of the most moved one are named in the table."""


def modes(
    vehicle: VehicleName,
    speed_kmh: Annotated[
        str | None,
        typer.Option(
            "--speed-kmh",
            metavar="SPEEDS",
            help="km/h: numbers and FROM:TO:STEP, with commas between; 0 stands. Default: 0 and the design "
            "speed; with --out a root locus to twice the design speed.",
        ),
    ] = None,
    condition: Condition = None,
    settings: Parameters = None,
    friction: Annotated[float, typer.Option(metavar="MU", help="Between wheel and rail.")] = 0.4,
    below_hz: Annotated[
        float, typer.Option("--below-hz", metavar="HZ", help="The table shows modes up to this frequency.")
    ] = 30.0,
    as_json: Annotated[
        bool, typer.Option("--json", help="One JSON object on stdout, shapes with it.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="DIR", help="Write root_locus.html, modes.json and modes.parquet to this folder."
        ),
    ] = None,
) -> None:
    """Show the modes of a vehicle: frequency, damping, what moves; standing with sticking wheels, or rolling.

    Exit code: 0, or 2 for bad input or a vehicle without balance.

    Example: lmap modes coco134 --speed-kmh 0,115 --set secondary.kz=5e5
    """
    from lmap.spec import overrides
    from lmap.vehicle import Vehicle

    loaded = Vehicle.load(vehicle, overrides=overrides.parse(settings or []), condition=condition)
    default = None if out is None else f"5:{round(2 * 3.6 * loaded.data.design_speed)}:5"
    usual = f"0,{3.6 * loaded.data.design_speed:g}" if default is None else default
    speeds = speeds_of(usual if speed_kmh is None else speed_kmh)
    folder = None if out is None else _folder(out)
    frame = loaded.modes([v / 3.6 for v in speeds], friction=friction)
    if folder is not None:
        _write(folder, loaded, frame, below_hz)
    if as_json:
        import json

        typer.echo(json.dumps(_document(loaded, frame), ensure_ascii=False, allow_nan=False))
    else:
        _tables(loaded, frame, speeds, below_hz)


def speeds_of(text: str) -> list[float]:
    """The speeds that a text lists, km/h."""
    from lmap.errors import InputProblem, Problem

    def refuse(part: str) -> InputProblem:
        allowed = f"km/h from 0 up, as 0,115 or 20:240:10, at most {MOST_SPEEDS}"
        return InputProblem(Problem(key=("--speed-kmh",), found=f'"{part}"', allowed=allowed))

    speeds: list[float] = []
    for part in text.split(","):
        try:
            numbers = [float(number) for number in part.split(":")]
        except ValueError:
            raise refuse(part) from None
        if not all(0.0 <= number < 1e4 for number in numbers):
            raise refuse(part)
        if len(numbers) == 1:
            speeds += numbers
        elif len(numbers) == 3 and numbers[2] > 0.0 and numbers[1] >= numbers[0]:
            low, high, step = numbers
            if (high - low) / step > MOST_SPEEDS:
                raise refuse(part)
            speeds += [low + k * step for k in range(int((high - low) / step + 1e-9) + 1)]
        else:
            raise refuse(part)
    if len(speeds) > MOST_SPEEDS:
        raise refuse(text)
    return speeds


def _folder(out: Path) -> Path:
    """The folder for the files, made; refused before the work where that cannot be."""
    from lmap.check import report_folder
    from lmap.errors import LmapError

    folder = report_folder(out)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LmapError(f"{out} cannot be written: {error.strerror or error}") from error
    return folder


def _moving(row: dict[str, Any]) -> str:
    """Coordinates that move most, the most moved first."""
    sizes = {
        name.removeprefix("re."): (value * value + row["im." + name.removeprefix("re.")] ** 2) ** 0.5
        for name, value in row.items()
        if name.startswith("re.")
    }
    # More than 1 is an axle's angle, whose rim travels less: it only rolls along.
    most = sorted(((name, size) for name, size in sizes.items() if size < 1.001), key=lambda item: -item[1])[
        :3
    ]
    return ", ".join(f"{name} {size:.2f}" for name, size in most if size >= MOVES)


def _tables(vehicle: Vehicle, frame: pl.DataFrame, speeds: list[float], below_hz: float) -> None:
    import polars as pl
    from rich.console import Console
    from rich.table import Table

    console = Console()
    console.print(f"{vehicle.data.title} ({vehicle.data.name})", style="bold", highlight=False)
    seen = frame.filter(
        (pl.col("frequency") > 0.0) | (pl.col("real") > GROWS), pl.col("frequency") <= below_hz
    )
    for speed in dict.fromkeys(speeds):
        rows = seen.filter((pl.col("v") * 3.6 - speed).abs() < 1e-6)
        title = "standing, wheels stick" if speed == 0.0 else f"rolling at {speed:g} km/h"
        table = Table(title=title, title_justify="left", box=None, pad_edge=False, header_style="bold")
        for heading in ("mode", "Hz", "damping %"):
            table.add_column(heading, justify="left" if heading == "mode" else "right")
        table.add_column("moves (m, rad)")
        for row in rows.iter_rows(named=True):
            style = "bold red" if row["real"] > GROWS else None
            damping = f"{100.0 * row['damping_ratio']:.1f}"
            table.add_row(row["name"], f"{row['frequency']:.3f}", damping, _moving(row), style=style)
        console.print(table)
        hidden = frame.filter((pl.col("v") * 3.6 - speed).abs() < 1e-6).height - rows.height
        if hidden:
            console.print(f"and {hidden} above {below_hz:g} Hz or without oscillation", style="dim")


def _document(vehicle: Vehicle, frame: pl.DataFrame) -> dict[str, Any]:
    modes = []
    for row in frame.iter_rows(named=True):
        shape = {
            name.removeprefix("re."): [value, row["im." + name.removeprefix("re.")]]
            for name, value in row.items()
            if name.startswith("re.")
        }
        modes.append(
            {
                "speed_kmh": row["v"] * 3.6,
                "name": row["name"],
                "branch": int(row["branch"]),
                "frequency_hz": row["frequency"],
                "natural_frequency_hz": row["natural_frequency"],
                "damping_ratio": row["damping_ratio"],
                "real": row["real"],
                "imag": row["imag"],
                "shape": shape,
            }
        )
    return {
        "vehicle": vehicle.data.name,
        "condition": vehicle.data.condition or vehicle.data.design_condition,
        "modes": modes,
    }


def _write(folder: Path, vehicle: Vehicle, frame: pl.DataFrame, below_hz: float) -> None:
    import json

    from lmap.errors import LmapError
    from lmap.report.figures.root_locus import page

    document = json.dumps(_document(vehicle, frame), ensure_ascii=False, allow_nan=False)
    try:
        (folder / "modes.json").write_text(document, encoding="utf-8")
        frame.write_parquet(folder / "modes.parquet")
        title = f"{vehicle.data.title}: root locus"
        (folder / "root_locus.html").write_text(page(frame, title, below_hz), encoding="utf-8")
    except OSError as error:
        raise LmapError(f"{folder} cannot be written: {error.strerror or error}") from error
    typer.echo(f"root locus: {folder / 'root_locus.html'}", err=True)
