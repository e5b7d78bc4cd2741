"""The vehicle in 3D as one self-contained page, from the plain data that `lmap.view.scene` makes."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from lmap.report.rendering import pieces, script_json


def file_name(name: str) -> str:
    """Of the page that draws what has this name or id: `view-1.2.html`."""
    return f"view-{re.sub(r'[^A-Za-z0-9._-]+', '-', name)}.html"


def render_scene(scene: Mapping[str, Any]) -> bytes:
    """The page, in UTF-8: works without a network, on a phone, and by keyboard."""
    files = {"style": "style.css", "own_style": "scene.css", "script": "scene.js"}
    return b"".join(pieces("scene.html.j2", files=files, scene=scene, json=script_json(scene)))
