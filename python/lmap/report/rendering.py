"""A template of this package as a page that needs nothing beside it: style, script and plotly.js are in it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from importlib import resources
from typing import Any

_PLOTLY = "<script>/* plotly.js */</script>"
"""Where a template wants the library; no text from a file can look so, its `<` being escaped."""


def pieces(template: str, *, files: dict[str, str], **values: Any) -> Iterator[bytes]:
    """The page piece by piece, in UTF-8, so that it is never in memory as a whole.

    `files` are those of the templates' folder that go in as they are, by the name that the template has for them.
    """
    # Only here: what `lmap --help` does not need is not imported for it.
    from jinja2 import Environment, StrictUndefined
    from markupsafe import Markup

    folder = resources.files("lmap.report") / "templates"
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    as_they_are = {name: Markup((folder / file).read_text(encoding="utf-8")) for name, file in files.items()}
    made = environment.from_string((folder / template).read_text(encoding="utf-8"))
    missing = True
    # plotly.js goes in as bytes: as text, with the few wide characters in it, it would take 20 MB per copy.
    for piece in made.generate(**values, **as_they_are):
        before, library, after = piece.partition(_PLOTLY)
        yield before.encode()
        if library:
            missing = False
            yield b"<script>"
            yield plotly_js()
            yield b"</script>"
            yield after.encode()
    if missing:
        raise ValueError(f"{template} has no {_PLOTLY}")


def script_json(value: Any) -> Any:
    """JSON that may stand in a script element: nothing in it can end the element or open a comment."""
    from markupsafe import Markup

    text = json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    for character in "<>&\u2028\u2029":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)


def plotly_js() -> bytes:
    """The library as the plotly package brings it, without importing that package's Python."""
    library = (resources.files("plotly") / "package_data" / "plotly.min.js").read_bytes()
    return library.replace(b"</script", b"<\\/script") if b"</script" in library else library
