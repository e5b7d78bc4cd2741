"""`lmap cache`: what is kept of runs."""

from __future__ import annotations

from typing import Annotated

import typer


def cache(
    clear: Annotated[bool, typer.Option("--clear", help="Remove all of it.")] = False,
) -> None:
    """Show where results of runs are kept and how much room they take.

    The folder is LMAP_CACHE_DIR, else the user's cache folder; LMAP_CACHE_GB is the most room that they may take (10):
    what was asked for least recently goes first. Results of another simulator are never used.

    Example: lmap cache --clear
    """
    from lmap.execute.store import clear as remove
    from lmap.execute.store import default_folder, limit_bytes, usage

    folder = default_folder()
    found = remove(folder) if clear else usage(folder)
    size = f"{found.size / 1e9:.2f} GB" if found.size >= 1e7 else f"{found.size / 1e6:.2f} MB"
    removed = "removed: " if clear else ""
    print(folder)
    print(f"{removed}{found.cases} cases, {size} of {limit_bytes() / 1e9:g} GB")
