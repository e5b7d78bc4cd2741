"""`lmap sweep`: one spec over a grid of settings."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from lmap.cli.options import Jobs, Quiet


def sweep(
    spec: Annotated[str, typer.Argument(metavar="SPEC", help="A file, or a test that ships: name or id.")],
    vary: Annotated[
        list[str],
        typer.Option(
            metavar="KEY=A..B",
            help="Vary a key as --set does: a range (secondary.kz=4e5..8e5) or a list (run.speed_kmh=80,100,115). "
            "Several keys make a grid.",
        ),
    ],
    samples: Annotated[int, typer.Option(min=2, metavar="N", help="Values of each range.")] = 5,
    out: Annotated[
        Path, typer.Option("--out", "-o", metavar="DIR", help="Folder for sweep.parquet and sweep.html.")
    ] = Path("sweep"),
    settings: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Override a key for all variants.")
    ] = None,
    jobs: Jobs = None,
    no_cache: Annotated[
        bool, typer.Option("--no-cache", help="Run everything, keep nothing for the next sweep.")
    ] = False,
    quiet: Quiet = False,
) -> None:
    """Judge a spec for every combination of values: sweep.parquet, one row for each variant, criterion and case.

    sweep.html, which needs no network, shows each criterion over the parameters, its limit and what fails. A variant
    that cannot be judged is a row with the verdict "error". Exit code: 0 every variant passes, 1 some fail, 2 some
    cannot be judged or bad input, 130 stopped by Ctrl-C.

    Example: lmap sweep hunting --vary run.speed_kmh=100..160 --samples 9 --vary yaw_damper.cx=0,1.5e5 --out out/
    """
    from lmap import files
    from lmap.check import report_folder, write_page
    from lmap.errors import LmapError
    from lmap.execute.progress import choose
    from lmap.report.sweep import page, summary
    from lmap.spec import overrides
    from lmap.sweep import sweep as run_sweep
    from lmap.sweep import variation

    folder = report_folder(out, "--out")
    variations = [variation(text, samples) for text in vary]
    keys = [one.key for one in variations]
    frame = run_sweep(
        spec,
        {one.key: one.values for one in variations} if len(set(keys)) == len(keys) else _twice(keys),
        set=overrides.parse(settings or []),
        jobs=jobs,
        progress=choose(quiet=quiet),
        cache=not no_cache,
    )
    typer.echo(summary(frame, keys))
    name = files.recorded(Path(spec)) if files.SPEC.is_path(spec) else spec
    write_page(folder / "sweep.html", page(name, frame, keys))
    try:
        files.put(folder / "sweep.parquet", frame.write_parquet)
    except OSError as error:
        raise LmapError(f"{folder / 'sweep.parquet'} cannot be written: {error.strerror or error}") from error
    print(f"{frame.height} rows: {folder / 'sweep.parquet'}, {folder / 'sweep.html'}", file=sys.stderr)
    verdicts = set(frame.get_column("verdict"))
    raise typer.Exit(2 if "error" in verdicts else 1 if verdicts - {"pass", "shown"} else 0)


def _twice(keys: list[str]) -> dict[str, tuple[object, ...]]:
    """Refuses a key that is varied twice."""
    from lmap.errors import InputProblem, Problem

    again = next(key for key in keys if keys.count(key) > 1)
    raise InputProblem(Problem(key=("--vary",), found=f"{again} twice", allowed="each key once"))
