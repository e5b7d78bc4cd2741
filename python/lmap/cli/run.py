"""`lmap run`: one case to parquet."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from lmap.cli.options import Quiet


def run(
    case: Annotated[
        Path,
        typer.Argument(
            metavar="CASE", help="A case: JSON as in a report's cases/, or the same keys in TOML."
        ),
    ],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="FILE", help="Default: CASE with .parquet, here.")
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Run one case and write its channels to a parquet file.

    The file carries the channels' units and meanings as metadata. Exit code: 0 the run reached its end, 2 it
    did not (what it recorded is not written) or the case is none, 130 stopped by Ctrl-C.

    Example: lmap run out/cases/0f3a....json --output run.parquet
    """
    from lmap.errors import LmapError, SimulationProblem
    from lmap.execute.local import run_cases
    from lmap.execute.progress import choose
    from lmap.prepare import load_case
    from lmap.report.parquet import to_parquet
    from lmap.simulate import channels
    from lmap.verdict import CaseResult, Held

    target = Path(f"{case.stem}.parquet") if output is None else output
    loaded = load_case(case)
    _check_target(target, case)
    known = channels(loaded)
    [outcome] = run_cases([loaded], jobs=1, progress=choose(quiet=quiet))
    if outcome.frame is None or outcome.trouble is not None:
        raise SimulationProblem(outcome.trouble or "the core gave no result")
    result = CaseResult(
        label=loaded.label,
        hash=loaded.hash,
        case=loaded.data,
        case_json=loaded.json,
        frames=Held(outcome.frame, outcome.frame),
        ended=outcome.ended,
        statistics=outcome.statistics,
        units={channel.name: channel.unit for channel in known},
        meanings={channel.name: channel.meaning for channel in known},
        wall_s=outcome.wall_s,
    )
    partial = target.with_name(f".{target.name}.partial")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            partial.write_bytes(to_parquet(result))
            partial.replace(target)
        finally:
            partial.unlink(missing_ok=True)
    except OSError as error:
        raise LmapError(f"{target} cannot be written: {error.strerror or error}") from error
    typer.echo(f"{target}: {outcome.frame.height} rows, {outcome.frame.width} channels", err=True)


def _check_target(target: Path, case: Path) -> None:
    """Refuses before the run a file that could not be written after it."""
    from lmap.errors import InputProblem, Problem

    nearest = target.absolute().parent
    try:
        while not nearest.exists():
            nearest = nearest.parent
        if target.is_dir():
            fault = "a folder"
        elif target.exists() and target.samefile(case):
            fault = "the case itself"
        elif not nearest.is_dir():
            fault = f"below the file {nearest.name}"
        elif not os.access(nearest, os.W_OK | os.X_OK):
            fault = "where nothing can be written"
        else:
            return
    except OSError as error:
        fault = f"which cannot be written: {error.strerror}"
    raise InputProblem(
        Problem(key=("--output",), found=f"{target.as_posix()}, {fault}", allowed="a file to write")
    )
