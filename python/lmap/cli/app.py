"""The command line: `lmap COMMAND ...`, one file per command.

Exit codes: 0 everything passes, 1 a criterion fails or waits for a person or for data, 2 bad input or
something that could not be judged, 130 stopped by Ctrl-C. Data goes to stdout, the rest to stderr.
"""

from __future__ import annotations

import os
import sys
import traceback
from typing import Annotated, NoReturn

import typer

from lmap.cli import cache, channels, check, contact, lint, list_, modes, new, run, schema, sweep, view
from lmap.errors import EXIT_ERROR, EXIT_INTERRUPTED, LmapError

# What frames leave behind goes back to the system at once: polars' allocator, which reads this when polars is loaded,
# keeps it otherwise, a tenth of the memory of a check.
os.environ.setdefault("_RJEM_MALLOC_CONF", "dirty_decay_ms:0,muzzy_decay_ms:0")

app = typer.Typer(
    name="lmap",
    help="Simulate railway locomotives and judge them by the locomotive model acceptance procedure.\n\n"
    "Example: lmap check hunting --report out/",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def _version(wanted: bool) -> None:
    if wanted:
        from lmap.check import version

        typer.echo(f"lmap {version()}")
        raise typer.Exit


@app.callback()
def _main(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


# Keep this list sorted by command.
app.command("cache")(cache.cache)
app.command("channels")(channels.channels)
app.command("check")(check.check)
app.command("contact")(contact.contact)
app.command("lint")(lint.lint)
app.command("list")(list_.list_)
app.command("modes")(modes.modes)
app.command("new")(new.new)
app.command("run")(run.run)
app.command("schema")(schema.schema)
app.command("sweep")(sweep.sweep)
app.command("view")(view.view)


def main() -> NoReturn:
    """Entry point of the `lmap` script."""
    try:
        code = app(standalone_mode=False)
        sys.stdout.flush()
        if code == EXIT_INTERRUPTED:
            raise KeyboardInterrupt  # typer turns it into a code
    except LmapError as error:
        _say(str(error))
        _leave(error.exit_code)
    except (KeyboardInterrupt, typer.Abort):
        _say("stopped")
        _leave(EXIT_INTERRUPTED)
    except BrokenPipeError:
        # whoever read stdout has left: nothing more to say, and nothing to flush at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        _leave(EXIT_ERROR)
    except OSError as error:
        if error.filename is not None:  # of a file, which whoever opens it tells about
            traceback.print_exc()
        else:
            _say(f"stdout: {error.strerror}")
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        _leave(EXIT_ERROR)
    except SystemExit:
        raise
    except BaseException as error:  # noqa: BLE001
        # usage errors show themselves; anything else is our fault (a panic in the core is no Exception) and
        # must not leave with the code of a criterion that fails
        show = getattr(error, "show", None)
        if show is not None:
            show()
        else:
            traceback.print_exc()
        _leave(EXIT_ERROR)
    _leave(code if isinstance(code, int) else 0)


def _say(text: str) -> None:
    for line in text.splitlines():
        print(f"lmap: {line}", file=sys.stderr)


def _leave(code: int) -> NoReturn:
    sys.exit(code)


if __name__ == "__main__":
    main()
