"""Reference pages made from a JSON schema: every table of a file with its keys, units, ranges and meanings."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from typing import Any

Schema = Mapping[str, Any]

HEAD = """# The vehicle file

Made by `lmap schema vehicle --markdown` from the schema that the file is checked against. How the parts work together
(parameters, templates, conditions) stands in `models/README.md`; formulas of the connections stand in
`crates/railsim/src/connection/`, one file for each kind.

Axes x forward, y right, z down, origin at the vehicle's centre at top of rail. SI units. Wherever a number stands, a
reference as `"$group.key"` or `"-$group.key"` may stand.
"""


def page(schema: Schema) -> str:
    """The reference page of a vehicle file."""
    definitions: Schema = schema.get("$defs", {})
    lines = [HEAD, "## Top of the file\n", *table(schema, definitions)]
    for name in ("WrittenBody", "WrittenWheelset", "WrittenConnection"):
        part = definitions[name]
        key = name.removeprefix("Written").lower()
        lines += [f"\n## `[[{key}]]`\n", _meaning(part), "", *table(part, definitions)]
    for title, law in _kinds(definitions["WrittenConnection"], definitions):
        lines += [f"\n### `{title}`\n", _meaning(law), "", *table(law, definitions)]
    laws = {_reference(law) for law in definitions["WrittenConnection"].get("oneOf", [])}
    lines += _others(definitions, {"WrittenBody", "WrittenWheelset", "WrittenConnection", "Law", *laws})
    return joined(lines)


CASE_HEAD = """# The tables `[track]` and `[run]` of a case

Made by `lmap schema case --markdown` from the schema that a case is checked against. A spec writes the same keys; what
it writes in its own way stands in `docs/reference/spec.md`. `docs/concepts/analyses.md` says which keys of `[run]` go
with which kind of run. SI units, axes x forward, y right, z down.
"""


def case_page(schemas: Mapping[str, Schema]) -> str:
    """The reference page of a case's tables, of their schemas by name."""
    lines = [CASE_HEAD]
    for name, schema in schemas.items():
        lines += [f"\n## `[{name}]`\n", *table(schema, schema.get("$defs", {}))]
    definitions = {key: part for schema in schemas.values() for key, part in schema.get("$defs", {}).items()}
    return joined([*lines, *_others(definitions, set())])


CHANNELS_HEAD = """# Channels

Made by `lmap schema channels --markdown` from the table that runs take units and meanings from. A name is a place and
one of these parts, `ws3.left.Q`, or the part alone, `t`. `lmap channels VEHICLE` lists those that a vehicle's run
records.

| part | unit | meaning |
|---|---|---|
"""


def channels_page(parts: Sequence[tuple[str, str, str]]) -> str:
    """The reference page of channels, of the parts of their names with unit and meaning."""
    rows = [f"| `{part}` | {unit} | {_escaped(meaning)} |" for part, unit, meaning in parts]
    return CHANNELS_HEAD + "\n".join(rows) + "\n"


def joined(lines: Iterable[str]) -> str:
    """A page of its lines."""
    return "\n".join(lines).replace("\n\n\n", "\n\n").rstrip() + "\n"


def _others(definitions: Schema, shown: AbstractSet[str]) -> Iterator[str]:
    """All tables but those that are shown already, sorted by name."""
    for name in sorted(definitions):
        part = definitions[name]
        if name in shown or not _is_table(part):
            continue
        yield from (f"\n## {_title(name)}\n", _meaning(part), "")
        if "oneOf" not in part:
            yield from table(part, definitions)
            continue
        for title, own in _kinds(part, definitions):
            yield from (f"\n### {_title(name)}, `{title}`\n", _meaning(own), "")
            yield from table(own, definitions)


def _title(name: str) -> str:
    words = "".join(
        f" {letter.lower()}" if letter.isupper() else letter for letter in name.removeprefix("Written")
    )
    return words.strip().capitalize()


def _is_table(part: Schema) -> bool:
    own = part.get("oneOf", [])
    return "properties" in part or any("properties" in item for item in own)


def _reference(part: Schema) -> str:
    return str(part.get("$ref", "")).rsplit("/", maxsplit=1)[-1]


def _kinds(part: Schema, definitions: Schema) -> Iterator[tuple[str, Schema]]:
    """The alternatives of a tagged table: the tag as it is written, `kind = "friction"`, and what belongs to it."""
    for own in part.get("oneOf", []):
        tag = next(key for key in ("kind", "method") if key in own["properties"])
        law = definitions.get(_reference(own), {})
        keys = {key: value for key, value in own["properties"].items() if key != tag} | law.get(
            "properties", {}
        )
        required = [*own.get("required", []), *law.get("required", [])]
        yield (
            f'{tag} = "{own["properties"][tag]["const"]}"',
            {
                "description": own.get("description") or law.get("description", ""),
                "properties": keys,
                "required": required,
            },
        )


def table(part: Schema, definitions: Schema) -> list[str]:
    """The keys of a table, those that are needed first."""
    keys: Schema = part.get("properties", {})
    if not keys:
        return []
    required = set(part.get("required", []))
    lines = ["| key | value | meaning |", "|---|---|---|"]
    for key in sorted(keys, key=lambda key: (key not in required, key)):
        own = keys[key]
        default = own.get("default")
        value = _value(own, definitions)
        if key in required:
            value += ", needed"
        elif default not in (None, [], {}):
            value += f"; {_default(default)} if left out"
        lines.append(f"| `{key}` | {value} | {_meaning(own)} |")
    return lines


def _default(value: Any) -> str:
    if isinstance(value, list) and not any(json.dumps(value).strip("[], 0.")):
        return "zeros"
    return f"`{json.dumps(value)}`"


def _meaning(part: Schema) -> str:
    return _escaped(str(part.get("description", "")))


def _escaped(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


_BOUNDS = (("exclusiveMinimum", ">"), ("minimum", ">="), ("exclusiveMaximum", "<"), ("maximum", "<="))


def _value(part: Schema, definitions: Schema) -> str:
    """What may stand there, in words."""
    if "const" in part:
        return f'`"{part["const"]}"`'
    if "enum" in part:
        return ", ".join(f'`"{word}"`' for word in part["enum"])
    alternatives = part.get("anyOf") or part.get("oneOf")
    if alternatives:
        own = [item for item in alternatives if item.get("type") != "null" and not _is_number_reference(item)]
        if all("properties" in item for item in own):
            return "a table"
        return ", ".join(dict.fromkeys(_value(item, definitions) for item in own))
    if "$ref" in part:
        return _value(definitions[_reference(part)], definitions)
    kinds = part.get("type", "a value")
    kind = next((word for word in kinds if word != "null"), "null") if isinstance(kinds, list) else kinds
    if kind in ("number", "integer"):
        bounds = " and ".join(f"{sign} {part[key]}" for key, sign in _BOUNDS if key in part)
        return " ".join(
            filter(None, ["number" if kind == "number" else "whole number", bounds, part.get("unit", "")])
        )
    if kind == "array":
        items = part.get("items", {})
        least, most = part.get("minItems"), part.get("maxItems")
        count = f"list of {least}" if least and least == most else "list"
        inner = _value(items, definitions) if isinstance(items, Mapping) and items else ""
        return f"{count}: {inner}" if inner else count
    return {"string": "text", "boolean": "true or false", "object": "a table"}.get(kind, str(kind))


def _is_number_reference(part: Schema) -> bool:
    return part.get("type") == "string" and "pattern" in part
