"""`lmap lint`: what looks wrong in a vehicle's description (LMAP 1.1)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from lmap.cli.options import Condition, Parameters, VehicleName

if TYPE_CHECKING:
    from lmap.lint import Finding


def lint(
    vehicle: VehicleName,
    condition: Condition = None,
    settings: Parameters = None,
    select: Annotated[
        list[str] | None, typer.Option(metavar="CODES", help="Tell these only, as LM4,LM701.")
    ] = None,
    ignore: Annotated[list[str] | None, typer.Option(metavar="CODES", help="Do not tell these.")] = None,
    integrator: Annotated[
        str,
        typer.Option(metavar="KIND", help="The scheme that the step is for: heun, rk4, ros2."),
    ] = "rk4",
    step: Annotated[
        float, typer.Option(metavar="S", help="The time step that the vehicle is to be run with, s.")
    ] = 0.001,
    as_json: Annotated[bool, typer.Option("--json", help="A JSON object on stdout.")] = False,
) -> None:
    """Tell what looks wrong in a vehicle: names, connections, units, inertia, symmetry, suspension, balance, step.

    docs/reference/lint.md explains every code, with an example. Exit code: 0 no errors, 1 errors found, 2 bad
    input.

    Example: lmap lint coco134 --ignore LM6
    """
    from lmap.errors import EXIT_FAIL, EXIT_PASS
    from lmap.lint import ERROR
    from lmap.lint import lint as find
    from lmap.spec import overrides

    found = find(
        vehicle,
        overrides=overrides.parse(settings or []),
        condition=condition,
        select=_codes(select),
        ignore=_codes(ignore),
        run={"integrator": {"kind": integrator, "step": step}},
    )
    errors = sum(one.severity == ERROR for one in found)
    if as_json:
        import json
        from dataclasses import asdict

        document = {
            "vehicle": vehicle,
            "condition": condition,
            "errors": errors,
            "warnings": len(found) - errors,
            "findings": [asdict(one) for one in found],
        }
        typer.echo(json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False))
    else:
        _table(found, errors)
    raise typer.Exit(EXIT_FAIL if errors else EXIT_PASS)


def _codes(given: list[str] | None) -> list[str]:
    return [code.strip() for text in given or [] for code in text.split(",")]


def _table(found: list[Finding], errors: int) -> None:
    from rich.console import Console
    from rich.table import Table

    console = Console()
    if found:
        table = Table(box=None, pad_edge=False, header_style="bold")
        for heading in ("code", "severity", "line", "key", "found", "usual"):
            table.add_column(heading, justify="right" if heading == "line" else "left", overflow="fold")
        for one in found:
            what = f"{one.subject}: {one.found}" if one.subject else one.found
            style = "red" if one.severity == "error" else "yellow"
            line = "" if one.line is None else str(one.line)
            code = f"{one.code} {one.rule}"
            table.add_row(
                code, f"[{style}]{one.severity}[/]", line, _plain(one.key), _plain(what), _plain(one.usual)
            )
        console.print(table)
    counts = f"{errors} error{'' if errors == 1 else 's'}, {len(found) - errors} warning"
    console.print(counts + ("" if len(found) - errors == 1 else "s"), highlight=False)


def _plain(text: str) -> str:
    """Brackets of keys are no markup."""
    return text.replace("[", "\\[")
