"""`lmap schema`: what a file may hold, for editors and for people."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer


class Kind(StrEnum):
    """Files that have a schema."""

    VEHICLE = "vehicle"


def schema(
    kind: Annotated[Kind, typer.Argument(metavar="KIND", help="What kind of file: vehicle.")],
    markdown: Annotated[
        bool, typer.Option("--markdown", help="The reference page instead of the JSON schema.")
    ] = False,
) -> None:
    """Print the JSON schema of a kind of file, with which an editor completes and checks it.

    Example: lmap schema vehicle > vehicle.schema.json
    """
    import json

    from lmap import reference, vehicle

    assert kind is Kind.VEHICLE
    found = vehicle.schema()
    typer.echo(reference.page(found).rstrip("\n") if markdown else json.dumps(found, indent=2))
