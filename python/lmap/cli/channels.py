"""`lmap channels`: what a vehicle's runs record."""

from __future__ import annotations

from typing import Annotated

import typer

from lmap.cli.options import VehicleName


def channels(
    vehicle: VehicleName,
    as_json: Annotated[bool, typer.Option("--json", help="A JSON list on stdout.")] = False,
) -> None:
    """List the channels of a vehicle with unit and meaning.

    Example: lmap channels coco134
    """
    import json

    from lmap.prepare import vehicle_channels

    found = vehicle_channels(vehicle)
    if as_json:
        typer.echo(json.dumps([channel._asdict() for channel in found], indent=2, ensure_ascii=False))
        return
    width = max((len(channel.name) for channel in found), default=0)
    unit = max((len(channel.unit) for channel in found), default=0)
    for channel in found:
        typer.echo(f"{channel.name:<{width}}  {channel.unit:<{unit}}  {channel.meaning}".rstrip())
