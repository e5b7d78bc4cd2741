"""`lmap view`: the vehicle in 3D."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from lmap.cli.options import Condition, Parameters, VehicleName

if TYPE_CHECKING:
    from lmap.vehicle import Vehicle
    from lmap.view.model import Model


def view(
    vehicle: VehicleName,
    out: Annotated[
        Path, typer.Option("--out", metavar="DIR", help="Folder of the page; default: the working folder.")
    ] = Path(),
    condition: Condition = None,
    settings: Parameters = None,
    speed_kmh: Annotated[
        str | None,
        typer.Option(
            "--speed-kmh",
            metavar="SPEEDS",
            help="Play the mode shapes at these speeds, km/h: numbers and FROM:TO:STEP, with commas between; 0 stands. "
            "Default: 0 and the design speed.",
        ),
    ] = None,
    below_hz: Annotated[
        float, typer.Option("--below-hz", metavar="HZ", help="Mode shapes up to this frequency.")
    ] = 30.0,
    run: Annotated[
        list[Path] | None,
        typer.Option(
            "--run", metavar="FILE", help="Play this run: parquet of `lmap run` or a report's cases/."
        ),
    ] = None,
) -> None:
    """Draw a vehicle in 3D with its mode shapes, as one page DIR/view-NAME.html that works offline.

    What can be measured of the drawing is: left against right, attachment points, wheels on the rails.

    Exit code: 0, 1 where something was found, 2 for bad input.

    Example: lmap view coco134 --condition tare --run out/cases/0f3a....parquet
    """
    from lmap.check import report_folder, write_page
    from lmap.cli.modes import speeds_of
    from lmap.report.scene import file_name, render_scene
    from lmap.spec import overrides
    from lmap.vehicle import Vehicle
    from lmap.view import findings, resolved, scene

    folder = report_folder(out, "--out")
    loaded = Vehicle.load(vehicle, overrides=overrides.parse(settings or []), condition=condition)
    model = resolved(loaded.data)
    speeds = speeds_of(speed_kmh or f"0,{3.6 * loaded.data.design_speed:g}")
    gauge = _gauge(loaded)
    motions = [_played(path, model) for path in run or []]
    motions += _modes(loaded, model, speeds, below_hz)
    found = findings(model, gauge)
    page = folder / file_name(model.name)
    write_page(page, render_scene(scene(model, gauge, found, motions)))
    typer.echo(f"{page}: model {model.hash}")
    for one in found:
        typer.echo(f"{one.kind}: {one.message}; allowed: {one.limit:g} m")
    if found:
        from lmap.errors import EXIT_FAIL

        raise typer.Exit(EXIT_FAIL)


def _modes(vehicle: Vehicle, model: Model, speeds: list[float], below_hz: float) -> list[dict[str, Any]]:
    """Mode shapes; a vehicle that cannot stand is drawn all the same, to see why."""
    from lmap.errors import LmapError
    from lmap.view import mode_motions, modes_of

    try:
        frame = vehicle.modes([speed / 3.6 for speed in speeds])
    except LmapError as error:
        typer.echo(f"lmap: no mode shapes: {error}", err=True)
        return []
    return mode_motions(modes_of(frame, below_hz), model)


def _gauge(vehicle: Vehicle) -> float | None:
    """The gauge of the vehicle's own base track, m."""
    from lmap import files, toml
    from lmap.procedures.view import gauge_of

    if vehicle.data.track is None:
        return None
    base = toml.load(files.find(files.TRACK, vehicle.data.track, vehicle.document.path), "track")
    return gauge_of(base.data.get("track", base.data))


def _played(path: Path, model: Model) -> dict[str, Any]:
    """The motion of a parquet file of channels."""
    import polars as pl

    from lmap import files
    from lmap.errors import InputProblem, Problem
    from lmap.view import run_motion

    allowed = "a parquet file of channels, as `lmap run` writes it"
    if not path.is_file():
        raise InputProblem(
            Problem(file=files.shown(path), key=("--run",), found="no such file", allowed=allowed)
        )
    try:
        frame = pl.read_parquet(path)
    except (pl.exceptions.PolarsError, OSError) as error:
        found = f"what is no parquet ({str(error).splitlines()[0]})"
        raise InputProblem(
            Problem(file=files.shown(path), key=("--run",), found=found, allowed=allowed)
        ) from None
    try:
        return run_motion(frame, model, f"run {path.stem[:40]}")
    except InputProblem as error:
        raise InputProblem(
            [problem.at(file=files.shown(path), prefix=("--run",)) for problem in error.problems]
        ) from None
