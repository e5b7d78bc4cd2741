"""`lmap new`: a file to start from."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class Kind(StrEnum):
    """Files that can be started from one that ships."""

    VEHICLE = "vehicle"


def new(
    kind: Annotated[Kind, typer.Argument(metavar="KIND", help="What kind of file: vehicle.")],
    name: Annotated[str, typer.Argument(metavar="NAME", help="Its name; it is written to NAME.toml.")],
    like: Annotated[
        str, typer.Option("--like", metavar="VEHICLE", help="The vehicle to copy: one that ships, or a file.")
    ] = "bobo86",
) -> None:
    """Write a starter file: a copy of a vehicle that ships, under its new name. Never overwrites.

    Example: lmap new vehicle mine --like coco134
    """
    from lmap.errors import InputProblem, Problem
    from lmap.files import shown
    from lmap.vehicle import starter

    assert kind is Kind.VEHICLE
    name = name.removesuffix(".toml")
    text = starter(name, like)
    path = Path(f"{name}.toml")
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise InputProblem(
            Problem(file=shown(path), found="a file", allowed="a name that is not taken")
        ) from None
    except OSError as error:
        raise InputProblem(
            Problem(
                file=shown(path),
                found=f"a place that cannot be written ({error.strerror})",
                allowed="a folder",
            )
        ) from None
    typer.echo(f"lmap: wrote {shown(path)}", err=True)
