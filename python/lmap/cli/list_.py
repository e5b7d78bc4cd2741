"""`lmap list`: every test that can be called by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from lmap.criteria.chain import Criterion


def list_() -> None:
    """List every test: id, name, procedure and title; below each what it judges and shows.

    Example: lmap list
    """
    from lmap.check import in_order, shipped
    from lmap.errors import EXIT_ERROR, InputProblem
    from lmap.spec.load import load

    found, trouble = [("id", "name", "procedure", "title")], []
    criteria: list[list[str]] = [[]]
    for path in in_order(shipped()):
        try:
            spec = load(path).spec
        except InputProblem as error:
            trouble += str(error).splitlines()
            continue
        found.append((spec.id, path.stem, spec.procedure, spec.title))
        criteria.append([_told(criterion) for criterion in spec.criterion])
    widths = [max(len(row[column]) for row in found) for column in range(3)]
    for row, below in zip(found, criteria, strict=True):
        cells = [f"{cell:<{width}}" for cell, width in zip(row, widths, strict=False)]
        typer.echo("  ".join([*cells, row[-1]]))
        for line in below:
            typer.echo(f"    {line}")
    for line in trouble:
        typer.echo(f"lmap: {line}", err=True)
    if trouble:
        raise typer.Exit(EXIT_ERROR)


def _told(criterion: Criterion) -> str:
    """Name and limit."""
    if not criterion.bounds:
        return f"{criterion.name} (shown)"
    return f"{criterion.name}: {criterion.limit_text} {criterion.unit}".removesuffix(" 1")
