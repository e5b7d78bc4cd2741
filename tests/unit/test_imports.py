"""What may import what (STYLE of the package: left to right only), read from the sources."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import lmap

PACKAGE = Path(lmap.__file__).parent

# A part may import parts of its own tier (without a circle) and of those before it.
TIERS: tuple[tuple[str, ...], ...] = (
    ("errors", "verdict", "files"),
    ("toml",),
    ("include", "reference", "formulas", "outline"),
    ("signals",),
    ("criteria",),
    ("spec",),
    ("view",),
    ("procedures",),
    ("simulate", "contact", "controller", "execute"),
    ("analyse",),
    ("vehicle",),
    ("lint", "spec_reference"),
    ("report",),
    ("prepare",),
    ("judge",),
    ("check",),
    ("sweep",),
    ("cli",),
)
TIER = {part: number for number, parts in enumerate(TIERS) for part in parts}
CORE = "_railsim"
TOP = ("__init__", "__main__")
MAY_IMPORT_THE_CORE = ("toml",)
"""Everything else asks `toml.core()`, and only these do."""
MAY_ASK_FOR_THE_CORE = ("toml", "vehicle", "contact", "controller", "simulate", "execute")


def sources() -> list[Path]:
    return sorted(path for path in PACKAGE.rglob("*.py") if "data" not in path.relative_to(PACKAGE).parts)


def part_of(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imported_parts(path: Path) -> set[str]:
    """Parts of the package that a file imports, type checking aside."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    skipped = {
        id(inner)
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        for inner in ast.walk(node)
    }
    found = set()
    for node in ast.walk(tree):
        if id(node) in skipped:
            continue
        if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "lmap":
            assert node.level == 0
            below = node.module.split(".")[1:]
            found.update([below[0]] if below else [alias.name for alias in node.names])
        if isinstance(node, ast.Import):
            found.update(alias.name.split(".")[1] for alias in node.names if alias.name.startswith("lmap."))
    return found


@pytest.mark.parametrize("path", sources(), ids=lambda path: path.relative_to(PACKAGE).as_posix())
def test_imports_point_left(path: Path) -> None:
    part = part_of(path)
    if part in TOP:
        return
    assert part in TIER, f"{part} has no tier yet"
    for other in imported_parts(path) - {part, CORE}:
        assert TIER[other] <= TIER[part], f"{part} imports {other}"


@pytest.mark.parametrize("path", sources(), ids=lambda path: path.relative_to(PACKAGE).as_posix())
def test_few_parts_know_the_core(path: Path) -> None:
    part = part_of(path)
    if CORE in imported_parts(path):
        assert part in MAY_IMPORT_THE_CORE
    if "toml.core()" in path.read_text(encoding="utf-8"):
        assert part in MAY_ASK_FOR_THE_CORE


@pytest.mark.parametrize(
    "path", sorted((PACKAGE / "report").rglob("*.py")), ids=lambda path: path.relative_to(PACKAGE).as_posix()
)
def test_the_report_reads_results_and_makes_none(path: Path) -> None:
    makers = {"simulate", "execute", "procedures", "vehicle", "contact", "spec"}
    assert imported_parts(path) & makers == set()


def test_nothing_imports_the_command_line() -> None:
    others = [path for path in sources() if part_of(path) not in ("cli", "__main__")]
    assert [path for path in others if "cli" in imported_parts(path)] == []


def test_importing_the_package_and_its_commands_is_cheap() -> None:
    heavy = ("polars", "scipy", "plotly", "pydantic", "numpy")
    code = f"import sys, lmap.cli.app; print([name for name in {heavy} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_names_of_the_package_are_functions_and_not_their_modules() -> None:
    code = "import lmap, lmap.check, lmap.simulate; print(callable(lmap.check), callable(lmap.simulate))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "True True"
