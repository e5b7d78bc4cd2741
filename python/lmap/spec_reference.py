"""The reference page of a spec, from the code itself: its keys, the links of chains, the procedures' own numbers."""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from lmap import reference
from lmap.controller.bind import Written
from lmap.criteria.chain import Criterion
from lmap.procedures import PROCEDURES, Set
from lmap.signals import LINKS, Filter
from lmap.spec.model import RunPart, SignOff, Spec

HEAD = """# The spec file

Made by `lmap schema spec --markdown` from the models that a spec is checked against. `docs/reference/case.md` has the
keys of `[track]` and `[run]` that the simulator reads, `docs/reference/vehicle.md` those of the vehicle, whose named
parameters `[set]` changes, `docs/reference/channels.md` what a criterion's `signal` may be.
"""


LINK_KEYS = {
    "about_mean": "Of the signal less its mean.",
    "absolute": "Of the size, whatever the sign.",
    "band_hz": "Lines of the spectrum that count, lowest and highest.",
    "block_s": "Length of a block.",
    "blocks": "How many there are to be at least.",
    "both_ends": "The larger of this percentile and the size of its counterpart.",
    "curve": "Which weighting.",
    "curves": "Weighting along x, y and z.",
    "cutoff_hz": "Corner, -3 dB.",
    "direction": "Which way the acceleration is.",
    "form": "By lines of the spectrum, or behind the comfort filter.",
    "from_m": "From this place on.",
    "from_s": "From this time on.",
    "half_width_hz": "Of the band, to either side.",
    "high_hz": "Upper corner; of a search the highest frequency looked at.",
    "k": "Factors along x, y and z.",
    "low_hz": "Lower corner; of a search the lowest frequency looked at.",
    "min_peaks": "A window with fewer has no average.",
    "min_rate_hz": "Samples a second that the signal has to have.",
    "order": "Poles at a corner.",
    "over": "Which of the blocks is taken.",
    "percent": "Share of the samples below it, per cent.",
    "settle_s": "Left out at the start, where the filter settles.",
    "start_m": "Left out at the start.",
    "start_s": "Left out at the start.",
    "step_m": "From one window to the next; every sample if absent.",
    "step_s": "From one window to the next; every sample if absent.",
    "to_m": "Up to this place.",
    "to_s": "Up to this time.",
    "trim_s": "Cut off at both ends, where the filter has no past or future.",
    "window_m": "Length of the window along the track; this or `window_s`.",
    "window_s": "Length of the window in time.",
    "zero_phase": "Forward and back, so that peaks stay in place.",
}
"""What a key of links means, which is the same in all of them."""


def page() -> str:
    """The page, in Markdown."""
    lines = [HEAD, "## Top of the file\n", *keys(Spec)]
    lines += ["\n## `[run]`\n", "What a spec writes in its own way; all other keys are the simulator's.\n"]
    lines += [
        *keys(RunPart),
        "\n## `[run.controller]`\n",
        _first_part(Written),
        "",
        *keys(Written),
        "\n## `[[criterion]]`\n",
        *keys(Criterion),
        "\n## `[sign_off]`\n",
        *keys(SignOff),
    ]
    lines.append("\n## Links of a chain\n\nFilters, then one statistic.")
    for link in sorted(LINKS, key=lambda link: (not issubclass(link, Filter), link.name)):
        kind = "filter" if issubclass(link, Filter) else "statistic"
        lines += [f"\n### `{link.name}`, {kind}\n", _first_part(link), "", *keys(link)]
    lines.append("\n## Procedures and their `[test]`")
    for procedure in PROCEDURES:
        lines += [
            f"\n### `{procedure.NAME}`\n",
            f"{procedure.SUMMARY[:1].upper()}{procedure.SUMMARY[1:]}.",
            "",
        ]
        if isinstance(procedure, Set):
            lines += keys(procedure.SETTINGS)
            for title, part in _inner(procedure.SETTINGS):
                lines += [f"\n#### {title}\n", _first_part(part), "", *keys(part)]
    return reference.joined(lines)


def keys(model: type[BaseModel]) -> list[str]:
    """A table of a model's keys."""
    schema = model.model_json_schema()
    meanings = _meanings(model)
    properties = {
        key: {**own, "description": own.get("description") or meanings.get(key) or LINK_KEYS.get(key, "")}
        for key, own in schema.get("properties", {}).items()
    }
    return reference.table({**schema, "properties": properties}, schema.get("$defs", {}))


def _inner(model: type[BaseModel]) -> Iterator[tuple[str, type[BaseModel]]]:
    """The tables within a model, by their names."""
    names = set(model.model_json_schema().get("$defs", {}))
    module = inspect.getmodule(model)
    for name in sorted(names):
        found: Any = getattr(module, name, None)
        if isinstance(found, type) and issubclass(found, BaseModel):
            yield name, found


def _first_part(model: type[BaseModel]) -> str:
    """What a docstring says before its first empty line."""
    return " ".join((inspect.getdoc(model) or "").split("\n\n")[0].split())


def _meanings(model: type[BaseModel]) -> dict[str, str]:
    """The text below each key in the source."""
    found: dict[str, str] = {}
    for part in reversed(model.__mro__):
        if not issubclass(part, BaseModel) or part is BaseModel:
            continue
        tree = ast.parse(textwrap.dedent(inspect.getsource(part))).body[0]
        assert isinstance(tree, ast.ClassDef)
        for node, after in zip(tree.body, tree.body[1:], strict=False):
            if (
                isinstance(node, ast.AnnAssign)
                and isinstance(node.target, ast.Name)
                and isinstance(after, ast.Expr)
                and isinstance(after.value, ast.Constant)
            ):
                found[node.target.id] = str(after.value.value)
    return found
