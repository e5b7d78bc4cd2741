"""Arguments and options that several commands have."""

from __future__ import annotations

from typing import Annotated

import typer

VehicleName = Annotated[str, typer.Argument(metavar="VEHICLE", help="A vehicle that ships, or a file.")]
Condition = Annotated[
    str | None, typer.Option(metavar="NAME", help="Operating condition; default: the design condition.")
]
Parameters = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Override a named parameter of the vehicle."),
]
Jobs = Annotated[int | None, typer.Option(min=1, metavar="N", help="Threads; default: all processors.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No progress.")]
