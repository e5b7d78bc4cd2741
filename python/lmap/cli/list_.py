"""`lmap list`: every test that can be called by name."""

from __future__ import annotations

import typer


def list_() -> None:
    """List every test: id, name, procedure, title and criteria.

    Example: lmap list
    """
    from rich.console import Console
    from rich.table import Table

    from lmap.check import in_order, shipped
    from lmap.errors import EXIT_ERROR, InputProblem
    from lmap.spec.load import load

    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading in ("id", "name", "procedure", "title", "criteria"):
        table.add_column(heading)
    trouble: list[str] = []
    for path in in_order(shipped()):
        try:
            spec = load(path).spec
        except InputProblem as error:
            trouble += str(error).splitlines()
            continue
        criteria = [
            f"{criterion.name}: {criterion.limit_text} {criterion.unit}".removesuffix(" 1")
            if criterion.bounds
            else criterion.name
            for criterion in spec.criterion
        ]
        table.add_row(spec.id, path.stem, spec.procedure, spec.title, "\n".join(criteria))
    Console().print(table)
    for line in trouble:
        typer.echo(f"lmap: {line}", err=True)
    if trouble:
        raise typer.Exit(EXIT_ERROR)
