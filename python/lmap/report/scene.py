"""The vehicle in 3D as one self-contained page, from the plain data that `lmap.view.scene` makes."""

from __future__ import annotations

import re
from collections.abc import Mapping
from importlib import resources
from typing import Any

from lmap.report.sheet import plotly_js, script_json

_PLOTLY = "<script>/* plotly.js */</script>"


def file_name(name: str) -> str:
    """Of the page that draws what has this name or id: `view-1.2.html`."""
    return f"view-{re.sub(r'[^A-Za-z0-9._-]+', '-', name)}.html"


def render_scene(scene: Mapping[str, Any]) -> bytes:
    """The page, in UTF-8: works without a network, on a phone, and by keyboard."""
    from jinja2 import Environment, StrictUndefined
    from markupsafe import Markup

    templates = resources.files("lmap.report") / "templates"
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    template = environment.from_string((templates / "scene.html.j2").read_text(encoding="utf-8"))
    page = template.render(
        scene=scene,
        json=script_json(scene),
        style=Markup((templates / "style.css").read_text(encoding="utf-8")),
        own_style=Markup((templates / "scene.css").read_text(encoding="utf-8")),
        script=Markup((templates / "scene.js").read_text(encoding="utf-8")),
    )
    before, place, after = page.partition(_PLOTLY)
    if not place:
        raise ValueError(f"the page's template has no {_PLOTLY}")
    return b"".join((before.encode(), b"<script>", plotly_js(), b"</script>", after.encode()))
