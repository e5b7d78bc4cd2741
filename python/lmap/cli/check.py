"""`lmap check`: simulate and judge."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lmap.cli.options import Jobs, Quiet

if TYPE_CHECKING:
    from lmap.verdict import Acceptance


def check(
    specs: Annotated[
        list[str],
        typer.Argument(metavar="SPEC...", help="A file, a folder, or a test that ships: name or id."),
    ],
    report: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Write the report to this folder.")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="One JSON object on stdout, nothing else there.")
    ] = False,
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Override a key of the spec (run.speed_kmh=130) or a named parameter of the vehicle.",
        ),
    ] = None,
    jobs: Jobs = None,
    no_cache: Annotated[
        bool, typer.Option("--no-cache", help="Run everything, keep nothing for the next check.")
    ] = False,
    quiet: Quiet = False,
) -> None:
    """Simulate and judge specs: a table of criteria with value, limit and margin.

    What has run before, unchanged, is not run again (lmap cache), but for runs under a control law of the spec's own
    (run.controller: Python or an FMU), which are never kept. Progress goes to stderr. Exit code: 0 everything
    passes, 1 something fails, waits or is not assessed, 2 bad input or not to be judged, 130 stopped by Ctrl-C.

    Example: lmap check hunting --report out/ --set secondary.kz=5e5 --jobs 2
    """
    from lmap.check import check as run_check
    from lmap.check import report_folder, write_report
    from lmap.execute.progress import choose
    from lmap.spec import overrides

    folder = None if report is None else report_folder(report)
    acceptance = run_check(
        specs,
        set=overrides.parse(settings or []),
        jobs=jobs,
        progress=choose(quiet=quiet),
        cache=not no_cache,
    )
    # the verdict first: it was long in coming, and a report that cannot be written must not take it along
    unread: BrokenPipeError | None = None
    try:
        _show(acceptance, as_json=as_json)
    except BrokenPipeError as error:
        unread = error
    if folder is not None:
        write_report(acceptance, folder)
        if not as_json:
            print(f"report: {folder / 'index.html'}", file=sys.stderr)
    if unread is not None:
        raise unread
    raise typer.Exit(acceptance.exit_code)


def _show(acceptance: Acceptance, *, as_json: bool) -> None:
    if as_json:
        from lmap.report import to_json

        sys.stdout.write(to_json(acceptance))
    else:
        from rich.console import Console

        from lmap.report.terminal import table

        table(acceptance, Console())
    sys.stdout.flush()
