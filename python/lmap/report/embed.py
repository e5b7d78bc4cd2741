"""What self-contained pages share: data and libraries inside the file, files written whole or not at all."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any


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


def write_bytes(path: Path, content: bytes) -> None:
    """A file with this content."""
    put(path, lambda temporary: temporary.write_bytes(content))


def put(path: Path, write: Callable[[Path], object]) -> None:
    """All of it or nothing, also when the disk is full or the program is stopped."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        write(temporary)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
