"""What README, docs and the help print can be typed: commands with specs and settings that exist; Python runs."""

from __future__ import annotations

import json
import re
import shlex
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import typer
from commands import ROOT, Ran

from lmap.check import find_specs
from lmap.cli.app import app
from lmap.cli.schema import Kind
from lmap.prepare import prepare
from lmap.procedures import BY_NAME as PROCEDURES
from lmap.signals import BY_NAME as LINKS
from lmap.spec import overrides
from lmap.sweep import variation

pytestmark = pytest.mark.needs_core
PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])
GROUP: Any = typer.main.get_command(app)


def commands() -> list[tuple[str, str]]:
    """Where it stands, and the command as it is printed, less what a shell and a reader make of it."""
    found = []
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        lines = re.findall(r"^ {4}(?:\$ )?(lmap .*)$", text, re.MULTILINE)
        lines += re.findall(r"`(lmap (?:check|sweep) [a-z/][^`]*)`", text)
        found += [(page.relative_to(ROOT).as_posix(), line) for line in lines]
    for name, command in GROUP.commands.items():
        example = re.search(r"Example: (lmap .*)", command.help)
        assert example is not None, name
        found.append((f"lmap {name} --help", example[1]))
    return [(where, re.split(r"\s#|\s>|\s;", " ".join(line.split()))[0]) for where, line in found]


COMMANDS = sorted(set(commands()))


def parsed(command: str) -> dict[str, Any]:
    """The command's values by name; fails where its own parser would refuse it."""
    _, name, *arguments = shlex.split(command)
    context = GROUP.commands[name].make_context(name, arguments)
    return {"command": name, **context.params}


def test_they_are_found() -> None:
    assert {where for where, _ in COMMANDS} >= {"README.md", "docs/how-to/sweep.md", "docs/how-to/stage1.md"}
    assert {command.split()[1] for where, command in COMMANDS if where == "README.md"} >= {
        *("cache", "channels", "check", "contact", "lint", "list", "modes", "run", "sweep", "view")
    }


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A clone, with the files of the reader's own that the pages speak of."""
    for folder in ("examples", "models", "specs"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    shutil.copytree(ROOT / "tests" / "twins", tmp_path / "tests" / "twins")
    shutil.copytree(ROOT / "specs", tmp_path / "my_specs")
    for name in ("mine", "my_vehicle"):
        shutil.copy(ROOT / "models" / "vehicles" / "coco134.toml", tmp_path / f"{name}.toml")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.usefixtures("place")
@pytest.mark.parametrize(("where", "command"), COMMANDS, ids=[f"{where}: {line}" for where, line in COMMANDS])
def test_a_printed_command_is_one_and_its_spec_takes_its_settings(where: str, command: str) -> None:
    """As far as a check goes before it runs; what runs has tests of its own."""
    values = parsed(command)
    settings = overrides.parse(values.get("settings") or [])
    if values["command"] == "check":
        for given in values["specs"]:
            prepare(find_specs(given)[0], settings)  # of a folder the first: all of it is checked elsewhere
    elif values["command"] == "sweep":
        varied = [variation(text, values["samples"]) for text in values["vary"]]
        for end in (0, -1):
            prepare(find_specs(values["spec"])[0], settings | {one.key: one.values[end] for one in varied})


BLOCKS = [
    (page.relative_to(ROOT).as_posix(), block)
    for page in PAGES
    for block in re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
]


@pytest.mark.slow
@pytest.mark.usefixtures("place")
@pytest.mark.parametrize(("where", "block"), BLOCKS, ids=[where for where, _ in BLOCKS])
def test_printed_python_runs(where: str, block: str) -> None:
    if "lmap.sweep.sweep" in block:  # six runs of 3 km: the same over 300 m
        short = '{"track.length": 300.0, "track.irregularity.period": 150.0}'
        assert block.rstrip().endswith("})")
        block = block.rstrip()[:-1] + f", set={short})"
    exec(compile(block, where, "exec"), {})


@pytest.mark.parametrize("kind", list(Kind))
def test_a_reference_page_is_what_the_code_says_and_says_what_every_key_is(
    kind: Kind, lmap: Callable[..., Ran]
) -> None:
    asked = ("schema", str(kind), "--markdown")
    page = (ROOT / "docs" / "reference" / f"{kind}.md").read_text(encoding="utf-8")
    assert lmap(*asked).out == page, f"lmap {' '.join(asked)} > docs/reference/{kind}.md"
    rows = re.findall(r"^\| `([^`]+)` \| (.*) \| (.*) \|$", page, re.MULTILINE)
    assert len(rows) > 40
    assert not [key for key, _, meaning in rows if len(meaning) < 4]
    json.loads(lmap("schema", str(kind)).out)


def test_the_reference_has_every_link_procedure_and_key_of_the_run() -> None:
    """Read off the registries again, not off what made the pages."""
    spec, case = (
        (ROOT / "docs" / "reference" / f"{kind}.md").read_text(encoding="utf-8") for kind in ("spec", "case")
    )
    assert set(re.findall(r"^### `(\w+)`", spec, re.MULTILINE)) == {*LINKS, *PROCEDURES}
    run = case.partition("## `[run]`")[2].partition("\n## ")[0]
    allowed = "contact, couplers, creep, disturbance, drive, friction, integrator, output_step, speed, train"
    assert set(re.findall(r"^\| `(\w+)`", run, re.MULTILINE)) >= set(allowed.split(", "))
    signals = (ROOT / "docs" / "concepts" / "signals.md").read_text(encoding="utf-8")
    assert not [name for name in LINKS if f"`{name}`" not in signals]
