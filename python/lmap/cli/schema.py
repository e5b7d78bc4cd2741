"""`lmap schema`: what a file may hold, for editors and for people."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, Any

import typer


class Kind(StrEnum):
    """What has a schema and a reference page."""

    CASE = "case"
    CHANNELS = "channels"
    SPEC = "spec"
    VEHICLE = "vehicle"


def schema(
    kind: Annotated[
        Kind,
        typer.Argument(
            metavar="KIND", help="vehicle, spec, case (its tables track and run), or channels (of any run)."
        ),
    ],
    markdown: Annotated[
        bool, typer.Option("--markdown", help="The reference page instead of the JSON.")
    ] = False,
) -> None:
    """Print the JSON schema of a kind of file, with which an editor completes and checks it, or its reference page.

    Example: lmap schema vehicle > vehicle.schema.json
    """
    import json

    found, page = _asked(kind)
    typer.echo(page.rstrip("\n") if markdown else json.dumps(found, indent=2))


def _asked(kind: Kind) -> tuple[Any, str]:
    """The data and the page."""
    from lmap import reference, spec_reference, vehicle
    from lmap.simulate import case_schema, channel_parts
    from lmap.spec.model import Spec

    match kind:
        case Kind.CASE:
            schemas = case_schema()
            return schemas, reference.case_page(schemas)
        case Kind.CHANNELS:
            parts = channel_parts()
            rows = [{"part": part, "unit": unit, "meaning": meaning} for part, unit, meaning in parts]
            return rows, reference.channels_page(parts)
        case Kind.SPEC:
            return Spec.model_json_schema(), spec_reference.page()
        case Kind.VEHICLE:
            found = vehicle.schema()
            return found, reference.page(found)
